"""Defaults of parts: the contract's hold on the server, on the command line, in Python and on the page."""

from __future__ import annotations

import json
import re
import subprocess
from typing import Any, Dict

import pytest
import yaml

import supple
from harness import CLI, ROOT, Api

PARTS = "/v1/parts"
CONTRACT = yaml.safe_load((ROOT / "api" / "openapi.yaml").read_text())["components"]["schemas"]
FIELDS = CONTRACT["PartRequest"]["properties"]
ENDS = CONTRACT["PartOutline"]["properties"]

DEFAULTS: Dict[str, float] = {
    "grip": ENDS["coupon"]["properties"]["grip_length"]["default"],
    "plate": ENDS["block"]["properties"]["plate"]["default"],
    "beam width": CONTRACT["BeamWidth"]["default"],
    "thickness": CONTRACT["PartThickness"]["default"],
    "frame": CONTRACT["PartFrame"]["default"],
    "density": FIELDS["material"]["properties"]["density"]["default"],
}
"""What the contract says, mm and g/cm^3."""


def cli(api: Api, *arguments: str) -> str:
    done = subprocess.run([str(CLI), "--server", api.server.url, "part", *arguments], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return done.stdout


def expected(outline: str) -> Any:
    end = DEFAULTS["grip"] if outline == "coupon" else DEFAULTS["plate"]
    return pytest.approx([12, 30 + 2 * end, DEFAULTS["thickness"]])


def request(outline: str, **more: Any) -> Dict[str, Any]:
    size = {"coupon": {"width": 12, "length": 30}, "block": {"width": 12, "height": 30}}[outline]
    return {"outline": {outline: size}, "structure": {"family": "IH21"}, **more}


@pytest.mark.parametrize("outline", ["coupon", "block"])
def test_the_server_the_command_line_and_python_make_the_same_part_of_nothing_but_a_size(api: Api, outline: str) -> None:
    served = api.ok(PARTS, request(outline))
    assert served["size"] == expected(outline)
    given = request(outline, beam_width=DEFAULTS["beam width"], frame=DEFAULTS["frame"], thickness=DEFAULTS["thickness"], material={"density": DEFAULTS["density"]})
    told = api.ok(PARTS, given)
    asked = json.loads(cli(api, "IH21", f"--{outline}", "12x30", "--json"))
    with supple.Client(api.server.url) as client:
        part = client.part({"coupon": supple.parts.coupon, "block": supple.parts.block}[outline](12, 30), "IH21")
    for name in ("mass", "solid_area", "volume"):
        assert served[name] == told[name] == asked[name] == getattr(part, name), name
    assert asked["size"] == served["size"] == list(part.size)


def test_the_help_of_the_command_line_has_the_defaults_of_the_contract() -> None:
    text = " ".join(subprocess.run([str(CLI), "part", "--help"], capture_output=True, text=True, timeout=60, check=True).stdout.split())
    for option, name in (("--grip", "grip"), ("--plate", "plate"), ("--beam-width", "beam width"), ("--thickness", "thickness"), ("--frame", "frame"), ("--density", "density")):
        described = re.search(rf"{option} [^(]*\(([\d.]+)\)", text)
        assert described and float(described.group(1)) == DEFAULTS[name], option


def test_the_page_begins_with_the_defaults_of_the_contract() -> None:
    source = (ROOT / "clients" / "web" / "src" / "design" / "part.ts").read_text()
    initial = re.search(r"export const INITIAL_PART[^{]*\{(.*?)\n\}", source, re.DOTALL)
    assert initial
    shown = {name: float(value) for name, value in re.findall(r"(\w+): ([\d.]+),", initial.group(1))}
    for name, default in DEFAULTS.items():
        field = "beamWidth" if name == "beam width" else name
        assert shown[field] == default, field


def test_python_says_the_defaults_of_the_contract() -> None:
    said = " ".join(f"{supple.parts.coupon.__doc__} {supple.parts.block.__doc__} {supple.PartOptions.__doc__}".split())
    for sentence in (f"grips ({DEFAULTS['grip']:g} mm each)", f"plates ({DEFAULTS['plate']:g} mm each)", f"structure scales. {DEFAULTS['beam width']:g} mm.",
                     f"thickness of the part. {DEFAULTS['thickness']:g} mm.", f"g/cm^3. {DEFAULTS['density']:g}.", f"solid rim. {DEFAULTS['frame']:g}."):
        assert sentence in said, sentence


def test_the_command_line_shows_the_outer_size_beside_that_between_the_ends(api: Api) -> None:
    assert "size     12 x 32 x 1 mm; 12 x 30 mm between the plates" in cli(api, "IH21", "--block", "12x30")
    assert "size     12 x 60 x 1 mm; 12 x 30 mm between the grips" in cli(api, "IH21", "--coupon", "12x30")
    assert "between" not in cli(api, "IH21", "--rectangle", "12x30")
