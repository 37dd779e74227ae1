"""Values on the command line: angles with units, formats of plots by file name, and refusals that name options."""

from __future__ import annotations

import json
import math
import os
import re
import struct
import subprocess
from pathlib import Path
from typing import Any, Tuple

import pytest

from harness import Api, CLI
from shapes import flat_grid, obj_text

CURVE = ("profile", "--task", "stress_strain", "--family", "IH67", "--parameters", "0.2,0.9", "--samples", "3")
POISSON = ("profile", "--task", "poisson", "--family", "IH67", "--parameters", "0.2,0.9")


class Program:
    """Runs `supple` with a server and a separate folder."""

    def __init__(self, url: str, folder: Path) -> None:
        self.url = url
        self.folder = folder
        (folder / "grid.obj").write_text(obj_text(flat_grid(3)))

    def run(self, *arguments: str, **environment: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([str(CLI), *arguments], cwd=self.folder, env={**os.environ, "SUPPLE_SERVER": self.url, **environment},
                              capture_output=True, text=True, timeout=60, check=False)

    def json(self, *arguments: str) -> Any:
        finished = self.run("--json", *arguments)
        assert finished.returncode == 0, finished.stderr
        return json.loads(finished.stdout)


@pytest.fixture
def supple(designs: Api, tmp_path: Path) -> Program:
    return Program(designs.server.url, tmp_path)


@pytest.mark.parametrize("text, radians", [
    ("45deg", math.pi / 4), ("-45deg", -math.pi / 4), ("45\u00b0", math.pi / 4), ("0.5rad", 0.5), ("0.5", 0.5), ("1e1deg", math.pi / 18),
])
def test_an_angle_may_have_a_unit(supple: Program, text: str, radians: float) -> None:
    assert supple.json(*CURVE, f"--direction={text}")["direction"] == pytest.approx(radians, abs=1e-15)


def test_lists_and_series_of_angles_may_have_units(supple: Program) -> None:
    assert supple.json(*POISSON, "-x", "0deg,45deg,1.5")["x"] == pytest.approx([0, math.pi / 4, 1.5])
    assert supple.json(*POISSON, "-x", "0deg:90deg:3")["x"] == pytest.approx([0, math.pi / 4, math.pi / 2])
    weave = supple.json("weave", "homogenize", "regular", "--strain", "0.02", "--directions", "0,30deg")
    assert weave["directions"] == pytest.approx([0, math.pi / 6])
    load = ("IH21", "--stretches", "1.01", "--mesh-size", "1", "--no-tangents")
    along = supple.json("simulate", *load, "--uniaxial", "90deg", "--frame", "material")["states"][0]["green_strain"]
    assert along[1] == pytest.approx((1.01**2 - 1) / 2, rel=1e-6)


def test_control_points_over_directions_may_be_in_degrees(supple: Program) -> None:
    wanted = ("design", "--task", "poisson", "--family", "IH67", "--starts", "1", "--missed-ok")
    assert supple.json(*wanted, "--target", "0deg,0.1;90deg,0.1")["profile"]["target"]
    (supple.folder / "target.csv").write_text("direction,ratio\n0deg,0.1\n90deg,0.1\n")
    read = supple.json(*wanted, "--target-points", "target.csv")
    assert read["profile"]["target"] == supple.json(*wanted, "--target", f"0,0.1;{math.pi / 2!r},0.1")["profile"]["target"]
    # A heading begins with a word. A first row of numbers with too many cells is no heading, and is not skipped.
    (supple.folder / "long.csv").write_text("0deg,0.1,1,0.1,7\n0deg,0.1\n90deg,0.1\n")
    refused = supple.run(*wanted, "--target-points", "long.csv")
    assert refused.returncode == 5 and "'0deg,0.1,1,0.1,7' is no control point" in refused.stderr
    # A strain with a unit is refused.
    refused = supple.run("design", "--task", "stress_strain", "--family", "IH67", "--target", "0deg,0;1deg,1")
    assert refused.returncode == 1 and "is no control point" in refused.stderr


UNITS = {
    "length": {"mm": 1, "cm": 10, "m": 1000, "um": 1e-3, "\u00b5m": 1e-3, "\u03bcm": 1e-3, "in": 25.4},
    "stress": {"MPa": 1, "Pa": 1e-6, "kPa": 1e-3, "GPa": 1e3, "N/mm2": 1, "N/mm^2": 1, "psi": 0.006894757293168361},
    "angle": {"deg": math.pi / 180, "\u00b0": math.pi / 180, "rad": 1},
    "duration": {"s": 1, "ms": 1e-3, "min": 60, "h": 3600},
    "ratio": {"%": 0.01},
    "density": {"g/cm3": 1, "g/cm^3": 1, "kg/m3": 1e-3},
    "area": {"mm2": 1, "cm2": 100},
}
"""Every unit, and its factor to the one of numbers without a unit."""
WAYS = ("{}{}", "{} {}", " {}  {} ")


@pytest.mark.parametrize("unit", UNITS["length"])
def test_every_unit_of_length_is_read(supple: Program, unit: str) -> None:
    for way in WAYS:
        text = way.format(f"{0.4 / UNITS['length'][unit]:.9g}", unit)
        assert supple.json("structure", "IH21", "--beam-width", text)["beam_width"] == pytest.approx(0.4, rel=1e-8), text


@pytest.mark.parametrize("unit", UNITS["stress"])
def test_every_unit_of_stress_is_read(supple: Program, unit: str) -> None:
    for way in WAYS:
        text = way.format(f"{40 / UNITS['stress'][unit]:.9e}", unit)
        assert supple.json(*CURVE, "--youngs-modulus", text)["material"]["youngs_modulus"] == pytest.approx(40, rel=1e-8), text


def test_ratios_densities_and_lists_are_read_with_units(supple: Program) -> None:
    assert supple.json(*POISSON, "--strain", "2.5 %")["strain"] == pytest.approx(0.025)
    curve = [argument for argument in CURVE if argument not in ("--samples", "3")]
    assert supple.json(*curve, "-x", "0%:10%:3")["x"] == pytest.approx([0, 0.05, 0.1])
    assert supple.json(*curve, "-x", "1%,0.02")["x"] == pytest.approx([0.01, 0.02])
    parts = [supple.json("part", "IH21", "--coupon", "20mm x 3cm", "--thickness", thickness, "--density", density)
             for thickness, density in (("2mm", "1240 kg/m3"), ("2", "1.24"))]
    assert parts[0]["size"] == parts[1]["size"] and parts[0]["mass"] == pytest.approx(parts[1]["mass"])
    assert supple.run(*CURVE, "--deadline", "2 min").returncode == 0
    load = ("simulate", "IH21", "--uniaxial", "0", "--frame", "material", "--mesh-size", "1", "--no-tangents", "--stretches")
    assert supple.json(*load, "102%")["states"][0]["green_strain"][0] == pytest.approx((1.02**2 - 1) / 2)


def test_control_points_may_have_units(supple: Program) -> None:
    wanted = ("design", "--task", "stress_strain", "--family", "IH67", "--starts", "1", "--missed-ok")
    plain = supple.json(*wanted, "--target", "0,0,1,0.01;0.1,0.06,2,0.02")["profile"]["target"]
    assert supple.json(*wanted, "--target", "0%,0,1,10kPa;10 %,60 kPa,2,0.02")["profile"]["target"] == pytest.approx(plain)
    (supple.folder / "target.csv").write_text("strain,stress\n0,0\n10%,0.06MPa\n")
    assert len(supple.json(*wanted, "--target-points", "target.csv")["profile"]["target"]) == len(plain)
    for faulty in ("0,0;10MPa,5%", "0,0,1MPa;0.1,0.06,1", "0,0;0.1,6mm"):
        refused = supple.run(*wanted, "--target", faulty)
        assert refused.returncode == 1 and "is no control point" in refused.stderr, refused.stderr


OPTIONS = {
    "length": (("structure", "IH21", "--beam-width"), ("part", "IH21", "--thickness"), ("part", "IH21", "--coupon"), ("part", "simulate", "IH21", "--gap"),
               ("design", "--cell-size"), ("weave", "layout", "regular", "--pitch"), ("curve", "x.csv", "--gauge-length")),
    "stress": (("design", "--youngs-modulus"), (*CURVE, "--youngs-modulus"), ("weave", "layout", "regular", "--youngs-modulus")),
    "angle": ((*CURVE, "--direction"), (*CURVE, "--orientation")),
    "duration": (("design", "--polish-seconds"), (*CURVE, "--deadline"), ("relax", "x.obj", "--deadline")),
    "ratio": ((*POISSON, "--strain"), ("part", "simulate", "IH21", "--strain"), ("design", "--relative-density"), ("design", "--polish-tolerance")),
    "density": (("design", "--density"), ("part", "IH21", "--density")),
    "area": (("curve", "x.csv", "--area"),),
}


@pytest.mark.parametrize("dimension", OPTIONS)
def test_a_unit_of_another_dimension_is_refused_with_the_option_and_what_is_expected(supple: Program, dimension: str) -> None:
    for command in OPTIONS[dimension]:
        for other, units in UNITS.items():
            if other == dimension:
                continue
            text = "3" + next(iter(units))
            refused = supple.run("--server", "http://127.0.0.1:1", *command, text)
            assert refused.returncode == 1, (command, text, refused.stderr)
            assert f"{command[-1]}: '{text}' is no {dimension} but a" in refused.stderr and "write for example" in refused.stderr


def test_a_number_before_a_unit_needs_one_too(supple: Program) -> None:
    """Nobody can know whether the 2 of 2x6cm is in millimetres."""
    refused = supple.run("part", "IH21", "--coupon", "2x6cm", "--stl", "coupon.stl")
    assert refused.returncode == 1 and "'2x6cm' is no length: write for example" in refused.stderr
    assert supple.run("uniaxial", "ih67", "-p", "0.2,0.9", "--direction", "0", "--green-strains", "0,5%").returncode == 0


@pytest.mark.parametrize("text", ["4furlong", "4 m m", "4mm5", "4MM"])
def test_an_unknown_unit_is_refused(supple: Program, text: str) -> None:
    refused = supple.run("--server", "http://127.0.0.1:1", "structure", "IH21", "--beam-width", text)
    assert refused.returncode == 1 and f"--beam-width: '{text}' is no length: write for example 4mm" in refused.stderr


def test_tables_have_numbers_as_people_write_them(supple: Program) -> None:
    """Stresses that vanish but for rounding are zeros, and no number has more digits than its column shows."""
    tables = [supple.run("uniaxial", "ih67", "-p", "0.2,0.9", "--direction", "0", "--green-strains", "0,5%,0.1").stdout,
              supple.run("simulate", "IH21", "--uniaxial", "0", "--stretches", "1.02,1.04", "--mesh-size", "1", "--no-tangents").stdout,
              supple.run("structure", "IH21").stdout, supple.run("weave", "layout", "regular").stdout,
              supple.run("weave", "deform", "regular", "-F", "1.02,0,0,1").stdout,
              supple.run("design", "--task", "stress_strain", "--family", "IH67", "--starts", "1", "--target", "0,0;0.1,0.05").stdout]
    for table in tables:
        rows = [line for line in table.splitlines() if not line.startswith(("residual", "limits"))]
        assert rows
        for number in re.findall(r"(?<![\w.])-?\d+\.?\d*(?:e[-+]\d+)?(?![\w.])", "\n".join(rows)):
            assert len(number) <= 14 and (not number.startswith("-") or float(number) != 0), (number, table)
            assert float(number) == 0 or abs(float(number)) > 1e-12, (number, table)


def test_what_is_no_angle_is_refused_and_degrees_without_a_unit_are_noticed(supple: Program) -> None:
    for text in ("45grad", "deg", "x", "45deg,3", "infdeg"):
        refused = supple.run(*CURVE, "--direction", text)
        assert refused.returncode == 1 and f"--direction: '{text}' is no angle" in refused.stderr and "45deg" in refused.stderr
    noticed = supple.run(*CURVE, "--direction", "45")
    assert noticed.returncode == 0 and "45 degrees are written 45deg" in noticed.stderr
    assert supple.run(*CURVE, "--direction", "400deg").stderr == "" == supple.run(*CURVE, "--direction", "6.28").stderr


def png_size(path: Path) -> Tuple[int, int]:
    content = path.read_bytes()
    assert content[:8] == b"\x89PNG\r\n\x1a\n" and content[12:16] == b"IHDR"
    width, height = struct.unpack(">II", content[16:24])
    return width, height


@pytest.mark.parametrize("arguments", [
    CURVE, ("design", "--task", "poisson", "--family", "IH67", "--starts", "1", "--missed-ok", "--target", "0,0.1;1,0.1"),
    ("weave", "homogenize", "regular", "--strain", "0.02", "--directions", "4"),
    ("relax", "grid.obj", "v0", "v5", "--spring", "0,1", "--fixed", "0"),
], ids=lambda arguments: arguments[0] if isinstance(arguments, tuple) else arguments)
def test_a_plot_is_what_the_ending_of_its_file_says(supple: Program, arguments: Tuple[str, ...]) -> None:
    assert supple.run(*arguments, "--plot", "plot.PNG").returncode == 0
    assert supple.run(*arguments, "--plot", "plot.svg").returncode == 0
    svg = (supple.folder / "plot.svg").read_text()
    width, height = png_size(supple.folder / "plot.PNG")
    assert svg.startswith("<svg") or svg.startswith("<?xml")
    assert f'width="{width // 2}"' in svg and f'height="{height // 2}"' in svg  # the PNG has two pixels for each pixel of the SVG


def test_plots_of_other_kinds_are_refused_before_anything_is_computed(supple: Program) -> None:
    for ending in ("pdf", "jpg", "PNG.gz"):
        refused = supple.run("--server", "http://127.0.0.1:1", *CURVE, "--plot", f"plot.{ending}")
        assert refused.returncode == 1 and "plots are written as .svg or .png" in refused.stderr


def test_where_nothing_makes_png_files_they_are_refused_with_the_reason(supple: Program, tmp_path: Path) -> None:
    (tmp_path / "libraries").mkdir()
    (tmp_path / "libraries" / "librsvg-2.so.2").write_bytes(b"")  # this file is found first, but is no library
    hidden = {"LD_LIBRARY_PATH": str(tmp_path / "libraries")}
    refused = supple.run("--server", "http://127.0.0.1:1", *CURVE, "--plot", "plot.png", **hidden)
    assert refused.returncode == 5 and "librsvg" in refused.stderr and "write the plot as .svg" in refused.stderr
    assert supple.run(*CURVE, "--plot", "plot.svg", **hidden).returncode == 0


@pytest.mark.parametrize("arguments, named", [
    ((*POISSON, "--strain", "9"), "--strain: must be"),
    (("profile", "--task", "poisson", "--family", "IH67", "--parameters", "0.2"), "--parameters"),
    (("geodesic", "grid.obj", "v0", "v1", "v2", "v999"), "points 'v999'"),
    (("karcher", "grid.obj", "v0", "v999", "v1"), "points 'v999'"),
    (("field", "grid.obj", "v999"), "sources 'v999'"),
    (("karcher", "grid.obj", "v0", "v1", "--weights", "1"), "--weights"),
    (("relax", "grid.obj", "v0", "v5", "--spring", "0,7"), "--spring"),
    (("relax", "grid.obj", "v0", "v5", "--spring", "0,1", "--fixed", "9"), "--fixed"),
    (("voronoi", "grid.obj", "v0", "v5", "--optimize", "centroid"), "--optimize"),
    (("simulate", "IH01", "--uniaxial", "0", "--stretches", "-1"), "--stretches at index 0: must be"),
    (("simulate", "IH01", "-p", "9,9,9,9", "--uniaxial", "0", "--stretches", "1.1"), "--parameters at index 3: must lie between"),
    (("design", "--task", "stress_strain", "--target", "0,0;1,1", "--verify", "--polish-tolerance", "7"), "--polish-tolerance: must be"),
    (("weave", "layout", "regular", "--sheet", "99999x3"), "--sheet: must be"),
    (("weave", "simulate", "regular", "--sheet", "4x4", "--hold", "c999"), "--hold or --move"),
    (("structure", "IH21", "--cells", "1000x1000", "--svg", "x.svg"), "--cells: must be"),
])
def test_a_refusal_names_the_option_and_not_the_field(supple: Program, arguments: Tuple[str, ...], named: str) -> None:
    refused = supple.run(*arguments)
    assert refused.returncode == 2 and named in refused.stderr, refused.stderr
    for word in ("/strain", "/parameters", "/pairs", "springs/", "/accuracy", "/weave/", "supports/", "openapi", "/v1/"):
        assert word not in refused.stderr


def test_a_sentence_is_said_once(supple: Program) -> None:
    assert supple.run(*POISSON, "--strain", "9").stderr.count("must be") == 1
    assert supple.run("karcher", "grid.obj", "v0", "v999").stderr.count("A point names a vertex") == 1


def test_what_is_refused_in_a_file_is_named_as_its_field(supple: Program) -> None:
    request = {"task": "poisson", "target": {"control_points": [[0, 0.1], [1, 0.2]]}, "accuracy": {"tolerance": -1}}
    (supple.folder / "request.json").write_text(json.dumps(request))
    assert "the field accuracy.tolerance: must be" in supple.run("design", "--request", "request.json").stderr
    # An option replaces the field of the file, and the refusal names the option.
    assert "--tolerance: must be" in supple.run("design", "--request", "request.json", "--tolerance", "5").stderr


def test_what_to_do_next_is_said_in_commands(supple: Program) -> None:
    assert "supple mesh list" in supple.run("mesh", "show", "0" * 64).stderr
    assert "supple job list" in supple.run("job", "show", "0" * 32).stderr
    assert "supple models" in supple.run("model", "ih99").stderr
