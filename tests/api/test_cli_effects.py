"""Options of the command line client that have an effect only together with something else: without it they are refused."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Dict, List, Set, Tuple

import pytest

from cli_program import Program
from harness import CLI, Api
from test_cli_usage import run

POISSON = ("design", "--task", "poisson", "--target", "0,0.1;1,0.3")
CURVE = ("design", "--task", "stress_strain", "--target", "0,0;0.1,0.05")
MEASURED = "without a file of measurements"
UNVERIFIED = "without --verify or --polish on"

IDLE: List[Tuple[Tuple[str, ...], str]] = [
    (("part", "IH21", "--block", "12x30", "--grip", "8"), "--grip has no effect without --coupon"),
    (("part", "IH21", "--coupon", "12x30", "--plate", "8"), "--plate has no effect without --block"),
    (("part", "IH21", "--rectangle", "12x30", "--seam", "1"), "--seam has no effect without regions"),
    *((("part", "simulate", "IH21", "--block", "12x30", option, *value), f"{option} has no effect without a plate as --support")
      for option, value in (("--gap", ("1",)), ("--stick", ()))),
    *((("part", "simulate", "IH21", "--block", "12x30", option, "a"), f"{option} has no effect where the part is simulated")
      for option in ("--step", "--stl", "--3mf", "--dxf")),
    (("part", "simulate", "IH21", "--block", "12x30", "--density", "1"), "--density has no effect where the part is simulated"),
    (("part", "IH21", "--rectangle", "12x30", "--region", "heel=IH29"), "give it with --outline"),
    (("part", "IH21", "--rectangle", "12x30", "--unit", "cm"), "give it with --outline"),
    (("part", "IH21", "--rectangle", "12x30", "--resolution", "96"), "give it with --outline"),
    (("part", "IH21", "--rectangle", "12x30", "--width", "96"), "give it with --outline"),
    (("part", "IH21", "--rectangle", "12x30", "--tolerance", "0.1"), "give it with --outline"),
    (("structure", "IH21", "--cells", "2x2"), "--cells has no effect without --svg, --dxf or --stl"),
    (("structure", "IH21", "--height", "2", "--svg", "a.svg"), "--height has no effect without --stl"),
    *((("structure", "IH21", "--svg", "-", option, value), f"{option} has no effect where a file goes to the terminal")
      for option, value in (("--mesh-size", "1"), ("--corner-size", "1"), ("--mesh-region", "cell"))),
    (("simulate", "IH21", "--green-strain", "0.1,0,0", "--stretches", "1.1"), "--stretches has no effect without --uniaxial"),
    (("simulate", "IH21", "--uniaxial", "0", "--stretches", "1.1", "--orthogonal", "1"), "--orthogonal has no effect without --biaxial"),
    (("simulate", "IH21", "--green-strain", "0.1,0,0", "--frame", "space"), "--frame belongs to --uniaxial"),
    (("profile", "--task", "poisson", "--family", "IH67", "--parameters", "0.2,0.9", "--direction", "1"), "--direction has no effect over directions"),
    (("profile", "--task", "stress_strain", "--family", "IH67", "--parameters", "0.2,0.9", "--strain", "1%"), "--strain has no effect over strains"),
    ((*POISSON, "--direction", "30deg"), "--direction has no effect over directions"),
    ((*CURVE, "--strain", "1%"), "--strain has no effect over strains"),
    *(((*CURVE, option, value), f"{option} has no effect {MEASURED}") for option, value in (
        ("--columns", "0,1"), ("--units", "%,MPa"), ("--gauge-length", "50"), ("--area", "20"), ("--sense", "tension"),
        ("--decimal-separator", "comma"), ("--zero", "first"), ("--block", "1"), ("--loading", "on"), ("--rupture", "off"),
        ("--origin", "on"), ("--control-points", "5"))),
    *(((*CURVE, option, value), f"{option} has no effect {UNVERIFIED}") for option, value in (
        ("--verified-samples", "4"), ("--polish-tolerance", "1%"), ("--polish-rounds", "3"), ("--polish-seconds", "30"))),
    ((*CURVE, "--verify", "--polish", "off", "--polish-rounds", "3"), "--polish-rounds has no effect with --polish off"),
    (("--json", *CURVE, "--part", "coupon:20x60"), "--part has no effect without a file"),
    ((*CURVE, "--thickness", "2"), "--part"),
    *(((*CURVE, option, "file"), "--part") for option in ("--stl", "--3mf", "--dxf", "--step")),
    ((*CURVE, "--initial-orientation", "1"), "--initial"),
    *((("voronoi", "a.obj", "--random", "9", option, *value), f"{option} has no effect without --optimize") for option, value in (
        ("--continue", ("a.json",)), ("--fixed", ("0",)), ("--minimizer", ("lbfgs",)), ("--tolerance", ("1e-3",)),
        ("--max-iterations", ("5",)), ("--history", ()))),
    (("voronoi", "a.obj", "--random", "9", "--optimize", "centroidal", "--target-length", "1"), "--target-length has no effect without edge_length"),
    (("voronoi", "a.obj", "v0", "v1", "--seed", "3"), "--seed has no effect without --random"),
    (("voronoi", "a.obj", "--random", "9", "--obj", "b.obj", "--panel-scale", "3"), "--panel-scale has no effect without --svg or --csv"),
    (("relax", "a.obj", "v0", "v1", "--spring", "0,1", "--seed", "3"), "--seed has no effect without --poisson-disk"),
    *((("relax", "a.obj", "v0", "v1", "--spring", "0,1", option, "0.3"), f"{option} has no effect without --membrane")
      for option in ("--youngs-modulus", "--poisson-ratio", "--thickness", "--rest-scale")),
    *((("relax", "a.obj", "v0", "v1", "v2", "--triangle", "0,1,2", option, "0.3"), f"{option} has no effect without --spring")
      for option in ("--rest-length", "--weight")),
    (("relax", "a.obj", "v0", "v1", "--spring", "0,1", "--mollifier", "off", "--mollifier-length", "1e-5"), "--mollifier-length has no effect with --mollifier off"),
    *((("relax", "a.obj", "v0", "v1", "--spring", "0,1", option, *value), f"{option} needs --host-kind") for option, value in (
        ("--host-thickness", ("1",)), ("--host-youngs-modulus", ("1",)), ("--host-poisson-ratio", ("0.3",)), ("--volume-weight", ("1",)),
        ("--volume-scale", ("2",)), ("--no-bending", ()), ("--element-size", ("1",)), ("--region", ("0,0,0,1,1,1,2",)),
        ("--gravity", ("0,0,1",)), ("--fix-vertex", ("1",)), ("--move-vertex", ("1,0,0,0",)), ("--positions", ("b.obj",)))),
    (("field", "a.obj", "v0", "--output", "b.csv", "--bands", "3"), "--bands has no effect without --output FILE.ply"),
    (("mesh", "add", "a.obj", "--repair", "drop_degenerate", "--weld-tolerance", "1e-4"), "--weld-tolerance has no effect without --repair weld"),
    (("weave", "homogenize", "regular", "--deformed", "0"), "--deformed has no effect without --obj or --json"),
    (("weave", "homogenize", "regular", "--obj", "a.obj"), "--obj needs --deformed"),
    *((("weave", "simulate", "regular", "--sheet", "3x3", "--load", "load.json", option), f"{option} has no effect without --hold or --move")
      for option in ("--clamp", "--free-z")),
]

EQUILIBRIUM = """--segments --tolerance --max-iterations --load-steps --limit-tolerance --least-distance --barrier-range --sliding-stiffness
    --out-of-plane --buckling --deadline"""
WEAVE = """--type --sample --connections --pitch --side --overlap --circle-radius --distance --sheet --fused-border --radius --youngs-modulus
    --poisson-ratio --fuse --slide --sliding-share"""
"""The server refuses those that a pattern does not have."""
MEASUREMENT = """--columns --units --gauge-length --area --sense --decimal-separator --zero --block --loading --rupture --origin
    --control-points"""

FREE: Dict[str, str] = {
    "mesh add": "--repair", "mesh get": "--output", "job list": "--state",
    "geodesic": "--derivatives --path",
    "field": "--output --relative-error --max-distance --method",
    "karcher": "--weights --tolerance --max-iterations --method --start --starts --history",
    "exponential-map": "--tangent --path",
    "relax": """--network --per-face --poisson-disk --spring --adjacent-faces --voronoi-dual --triangle --membrane --fixed --host-kind
        --euclidean --method --tolerance --max-iterations --mollifier --kept-strips --deadline --history --obj --vtu --plot""",
    "voronoi": "--random --sites --method --relative-error --border-deviation --optimize --obj --vtu --svg --csv --deadline",
    "families": "--check",
    "families add": "--type --id",
    "families atlas": "--samples --mesh-size --error-samples --crossings --recompute --deadline --output",
    "families train": "--core-time --error --seed --deadline --plan",
    "structure": "--parameters --svg --dxf --stl --beam-width",
    "part": """--parameters --coupon --block --rectangle --outline --request --beam-width --orientation --direction --axis --from --design --frame
        --smallest-wall --thickness --density --whole --step --stl --3mf --dxf --svg""",
    "part simulate": """--support --load --strain --states --law --youngs-modulus --poisson-ratio --mesh-size --corner-size --pressure-length
        --residual --max-load-step --contact --buckling --deadline --error-estimate --csv --svg --obj --vtu --plot""",
    "outlines": "--unit --resolution --width --tolerance",
    "curve": "--task --out " + MEASUREMENT,
    "simulate": """--parameters --uniaxial --biaxial --green-strain --law --youngs-modulus --poisson-ratio --mesh-size --corner-size --mesh-region
        --discretization-error --tolerance --max-load-step --contact --patch --buckling --refinement --no-tangents --deadline --csv --vtu""",
    "evaluate": "--parameters --strain --derivatives --deadline --csv",
    "uniaxial": "--parameters --direction --stretches --green-strains --tolerance --deadline --csv",
    "profile": """--task --family --model --strain-measure --parameters --samples --equilibrium-tolerance --orientation --youngs-modulus
        --deadline --csv --plot""",
    "design": """--task --family --model --strain-measure --target --target-points --interpolation --request --regions --orientation
        --youngs-modulus --density --beam-width --cell-size --relative-density --beam-width-limits --cell-size-limits --samples --initial
        --fixed --verify --polish --ways-out --beam-width-sensitivity --tolerance --equilibrium-tolerance --max-iterations --starts --candidates --trust
        --multi-start --envelope --session --deadline --csv --plot --svg --missed-ok""",
    "weave layout": WEAVE + " --crossings --svg",
    "weave homogenize": WEAVE + " " + EQUILIBRIUM + " --error-estimate --strain --directions --shear --thickness --csv --plot",
    "weave deform": WEAVE + " " + EQUILIBRIUM + " --error-estimate --gradient --csv --obj",
    "weave simulate": WEAVE + " " + EQUILIBRIUM + " --error-estimate --hold --move --pull --load --states --csv --obj --vtu",
    "weave print": WEAVE + """ --output --svg --profile --options --origin --order --overrun --overrun-of --loop-overlap --frame --grip
        --chord-error --deadline""",
    "weave check": "--limits",
}
"""The options that have an effect in every command line, or are refused by the server where they have none."""


def program(*arguments: str) -> str:
    return subprocess.run([str(CLI), *arguments], capture_output=True, text=True, timeout=60, check=True).stdout


def options_by_command() -> Dict[str, Set[str]]:
    """The long options of each command without those of the program, as the completion for bash has them."""
    found = {}
    for line in program("completion", "bash").splitlines():
        entry = re.match(r" +'?supple *([a-z -]*)'?\) commands=.* options=(?:'([^']*)'|(\S*)) ;;$", line)
        if entry:
            found[entry.group(1)] = {word for word in (entry.group(2) or entry.group(3) or "").split() if word.startswith("--")}
    return {command: options - found[""] for command, options in found.items() if command}


@pytest.mark.parametrize("arguments, message", IDLE, ids=lambda value: " ".join(value) if isinstance(value, tuple) else "")
def test_an_option_without_effect_is_refused_before_anything_is_computed(tmp_path: Path, arguments: Tuple[str, ...], message: str) -> None:
    (tmp_path / "load.json").write_text('{"supports": [{"at": {"crossing": 0}}]}')
    refused = run(*arguments, folder=tmp_path)
    assert refused.returncode == 1 and message in refused.stderr and refused.stdout == "", refused.stderr


def test_what_each_option_needs_is_known() -> None:
    """A new option is either an entry of FREE, or has an entry in IDLE that shows how it is refused."""
    by_command = options_by_command()
    assert len(by_command) > 20 and "--grip" in by_command["part"]
    for command, options in by_command.items():
        words = tuple(command.split())
        lines = [" ".join(arguments) for arguments, _ in IDLE if tuple(word for word in arguments if word != "--json")[:len(words)] == words]
        idle = {option for option in options if any(re.search(rf"(^| ){option}( |$)", line) for line in lines)}
        free = set(FREE.get(command, "").split())
        assert free <= options, (command, free - options)
        assert options <= free | idle, (command, options - free - idle)


def test_the_lengths_of_solid_ends_are_set_in_a_request_too(api: Api, tmp_path: Path) -> None:
    supple = Program(api.server.url, tmp_path)
    (tmp_path / "part.json").write_text('{"structure": {"family": "IH21"}, "outline": {"coupon": {"width": 12, "length": 30}}}')
    assert "12 x 46 x 1 mm" in supple.ok("part", "--request", "part.json", "--grip", "8")
    assert supple.ok("part", "--request", "part.json", "--grip", "8") == supple.ok("part", "IH21", "--coupon", "12x30", "--grip", "8")


def test_a_structure_that_fills_nothing_is_refused(api: Api, tmp_path: Path) -> None:
    supple = Program(api.server.url, tmp_path)
    (tmp_path / "fields.svg").write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="15mm" viewBox="0 0 40 15"><rect id="heel" width="20" height="15"/>'
        '<rect id="toes" x="20" width="20" height="15"/></svg>')
    regions = ("part", "--outline", "fields.svg", "--region", "heel=IH29,0.4", "--region", "toes=IH21,0.4")
    assert supple.run(*regions, "--seam", "0.5", "--frame", "1", "--thickness", "2", "--whole").returncode == 0
    for more, named in ((["IH22"], "family"), (["--beam-width", "0.6"], "--beam-width"), (["--orientation", "1"], "--orientation"),
                        (["IH22", "--parameters", "0.1,0.2"], "family")):
        refused = supple.run("part", *more, *regions[1:])
        assert refused.returncode == 1, (more, refused.stderr)
        assert f"{named} has no effect where the part is the union of its regions" in refused.stderr
    one = ("part", "IH22", "--outline", "fields.svg", "--region", "heel=IH29,0.4", "--beam-width", "0.6", "--seam", "0.5")
    assert supple.run(*one).returncode == 0, "the rest is filled"
