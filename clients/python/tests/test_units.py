"""Quantities that are given as texts with units."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any, Dict, Tuple

import numpy as np
import pytest

import supple
from supple.units import UNITS, from_text, without_unit

ROOT = Path(__file__).parents[3]
FACTORS = {
    "length": {"um": 1e-3, "mm": 1, "cm": 10, "m": 1000, "in": 25.4},
    "area": {"mm2": 1, "cm^2": 100},
    "force": {"N": 1, "mN": 1e-3, "kN": 1000},
    "duration": {"s": 1, "ms": 1e-3, "min": 60, "h": 3600},
    "stress": {"Pa": 1e-6, "kPa": 1e-3, "MPa": 1, "GPa": 1000, "N/mm2": 1, "psi": 0.00689476},
    "angle": {"deg": math.pi / 180, "\u00b0": math.pi / 180, "rad": 1},
    "ratio": {"%": 0.01},
    "density": {"g/cm3": 1, "kg/m3": 1e-3},
}
NUMBERS = ("4", "0.25", "-3.5", "1e3", "2.5e-2", ".5", "+7.")


@pytest.mark.parametrize("dimension", FACTORS)
def test_every_unit_is_read_with_every_way_to_write_a_number(dimension: str) -> None:
    for unit, factor in FACTORS[dimension].items():
        for number in NUMBERS:
            for text in (number + unit, f"{number} {unit}", f"  {number}  {unit} "):
                assert from_text(text, "x", dimension) == pytest.approx(float(number) * factor, rel=1e-5), text


@pytest.mark.parametrize("dimension", FACTORS)
def test_a_unit_of_another_dimension_is_refused_with_the_name_and_what_is_expected(dimension: str) -> None:
    for other, units in FACTORS.items():
        for unit in units:
            if other != dimension:
                with pytest.raises(ValueError, match=f"^width is '4 .*no {dimension} but an? {other}; expected"):
                    from_text(f"4 {unit}", "width", dimension)


@pytest.mark.parametrize("text", ["12", "", "MPa", "12 MPaa", "12 mpa", "1,2 MPa", "12 MPa 3", "nan MPa", "inf MPa"])
def test_a_text_without_a_number_and_a_unit_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="youngs_modulus is .*'12 MPa'"):
        supple.Material(text)


def test_what_is_no_text_stays_as_it_is() -> None:
    array = np.array([1.0, 2.0])
    assert without_unit(array, "x", "length") is array and without_unit(None, "x", "length") is None
    assert without_unit((1, "2 cm"), "x", "length") == (1, 20) and without_unit((1, 2), "x", "length") == (1, 2)


def test_requests_take_units() -> None:
    assert supple.Material("12 MPa").youngs_modulus == 12
    assert supple.Material(("1 GPa", 3500), "1240 kg/m3").to_wire() == {"youngs_modulus": [1000, 3500], "density": 1.24}
    target = supple.Target("poisson", [(0, 0.1), (1, 0.3)], strain="5 %")
    document = supple.DesignRequest(target, orientation=("0 deg", "90 deg"), cell_size="4 mm",
                                    limits=supple.Limits(("10 %", "30%"), beam_width=("400 um", 0.8))).to_wire()
    assert document["strain"] == 0.05 and document["cell_size"] == 4 and document["orientation"] == pytest.approx([0, math.pi / 2])
    assert document["limits"] == {"relative_density": pytest.approx([0.1, 0.3]), "beam_width": [0.4, 0.8]}
    assert supple.Uniaxial("30 deg", [1.1]).direction == pytest.approx(math.pi / 6)
    assert supple.StructureFileRequest("IH21", kind="stl", height="1 cm").height == 10
    assert supple.MeasuredCurveRequest("a,b\n", gauge_length="5 cm").gauge_length == 50


def test_durations_areas_forces_and_lists_take_units() -> None:
    target = supple.Target("stiffness", [("0 deg", "0.1 GPa"), ("90 deg", 20)], bands=["100 kPa", 0])
    assert target.control_points == [[0, 100], [pytest.approx(math.pi / 2), 20]] and target.bands == [0.1, 0]
    assert supple.Target("stress_strain", (("0 %", 0), ("5 %", "60 kPa"))).to_wire()["target"]["control_points"] == [[0, 0], [0.05, 0.06]]
    request = supple.DesignRequest(target, deadline="2 min", timeout="30s", options=supple.DesignOptions(
        polish_seconds="1.5 min", polish_tolerance="1 %", tolerance="0.01 %"))
    document = request.to_wire()
    assert document["deadline"] == 120 and request.timeout == 30 and "timeout" not in document
    assert document["accuracy"] == {"polish_seconds": 90, "polish_tolerance": 0.01, "tolerance": pytest.approx(1e-4)}
    assert supple.GeodesicsRequest("a" * 64, [(0, 1)], deadline="500 ms").to_wire()["deadline"] == 0.5
    measured = supple.MeasuredCurveRequest("a,b\n", area="0.2 cm2", limits=("0 %", "10%"))
    assert (measured.area, measured.limits) == (20, (0, 0.1))
    assert supple.ProfileRequest("poisson", [0.1], "IH29", x=["0 deg", "90 deg"]).to_wire()["x"] == pytest.approx([0, math.pi / 2])
    assert supple.ProfileRequest("stress_strain", [0.1], "IH29", limits=("-10 %", "20 %")).to_wire()["range"] == [-0.1, 0.2]
    assert supple.Uniaxial("30 deg", ["102 %", 1.1]).to_wire()["uniaxial"]["stretches"] == [1.02, 1.1]
    assert supple.GreenStrain([["5 %", 0, 0]]).to_wire() == {"green_strain": [[0.05, 0, 0]]}
    assert supple.UniaxialRequest("ih29", [0.1], 0, green_strains=["5 %"]).to_wire()["green_strains"] == [0.05]
    assert supple.DrawingRequest("<svg\n/>", width="5 cm", tolerance="50 um").to_wire()["width"] == 50
    load = supple.SimulationRequest("IH21", None, supple.Uniaxial(0, [1.1]), {"youngs_modulus": "1.2 GPa", "law": "neo_hookean"})
    assert load.to_wire()["material"] == {"youngs_modulus": 1200, "law": "neo_hookean"}


def test_weaves_and_prints_take_units() -> None:
    assert supple.Weave.regular(pitch="0.4 cm", radius="250 um", material={"youngs_modulus": "3.5 GPa"}).to_wire() == {
        "pattern": "regular", "pitch": 4, "radius": 0.25, "material": {"youngs_modulus": 3500}}
    squares = supple.Weave.squares(2, side="1.2 cm").slide(3, 0, forward="1 mm").to_wire()
    assert squares["side"] == 12 and squares["overrides"] == [{"crossing": 3, "slides": [0], "forward": 1}]
    assert supple.Place.strand(2, coordinate="1 cm").to_wire() == {"strand": 2, "coordinate": 10}
    assert supple.Place.box(("-1 mm", 0), ("2 cm", 3)).to_wire() == {"box": [[-1, 0], [20, 3]]}
    place = supple.Place.crossing(1)
    assert supple.Force(place, ("100 mN", 0, 0)).to_wire()["force"] == [0.1, 0, 0]
    moved = supple.Support(place, displacement=("1 cm", 0, 0), clamped=True, rotation=(0, 0, "90 deg")).to_wire()
    assert moved["displacement"] == [10, 0, 0] and moved["rotation"][2] == pytest.approx(math.pi / 2)
    weave = supple.WeaveHomogenizationRequest(supple.Weave.circles(2), "30 %", ["0 deg", "180 deg"], thickness="0.5 mm",
                                              options=supple.WeaveOptions(least_distance="200 um")).to_wire()
    assert weave["strain"] == 0.3 and weave["directions"] == pytest.approx([0, math.pi]) and weave["sliding"]["least_distance"] == 0.2
    options = supple.PrintOptions(overrun=("2.4 cm", 0), overruns={1: ("1 cm", 0)}, frame=(2, "16mm"), grips=[supple.Grip(("1 cm", 0), (2, 3), "5 mm")])
    assert options.to_wire() == {"overrun": {"start": 24, "end": 0}, "overruns": [{"strand": 1, "start": 10, "end": 0}],
                                 "frame": {"margin": 2, "lead_in": 16}, "grips": [{"from": [10, 0], "to": [2, 3], "width": 5}]}


def units_of_the_command_line() -> Dict[str, Tuple[str, float]]:
    """The units in the source of the command line client, by their names."""
    source = (ROOT / "clients" / "cli" / "src" / "units.cpp").read_text(encoding="utf-8")
    table = re.search(r"constexpr Unit units\[\] = \{(.*?)\};\n\n", source, re.DOTALL)
    assert table
    named = {"degree": math.pi / 180}
    for name, value in re.findall(r"constexpr double (\w+) = ([\d.]+);", source):
        named[name] = float(value)
    entries = re.findall(r'\{"([^"]+)", Dimension::(\w+)(?:, ([\w.+-]+))?\}', table.group(1))
    return {name.encode().decode("unicode_escape"): (dimension, named.get(factor) or float(factor or 1)) for name, dimension, factor in entries}


def test_the_command_line_and_this_package_have_the_same_units() -> None:
    found = units_of_the_command_line()
    assert set(found) == set(UNITS)
    for name, (dimension, factor) in UNITS.items():
        assert found[name] == (dimension, pytest.approx(factor, rel=1e-15)), name


def test_the_units_that_the_readme_of_the_command_line_lists_are_read() -> None:
    text = (ROOT / "clients" / "cli" / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| ([a-z][\w, '\u2019]+) \| ((?:`[^`]+`(?:, )?)+) \|$", text, re.MULTILINE)
    listed = {unit: row.split(",")[0] for row, units in rows for unit in re.findall(r"`([^`]+)`", units)}
    assert len({UNITS[unit][0] for unit in listed}) == len({dimension for dimension, _ in UNITS.values()})


@pytest.mark.parametrize("make", [
    lambda: supple.FieldRequest("a" * 64, [0], deadline="2 mm"),
    lambda: supple.FieldRequest("a" * 64, [0], timeout="2"),
    lambda: supple.Target("stress_strain", [("0 deg", 0), ("5 %", 1)]),
    lambda: supple.ProfileRequest("poisson", [0.1], "IH29", x=["1 mm"]),
    lambda: supple.Weave.regular(pitch="4 deg"),
    lambda: supple.Force(supple.Place.crossing(1), ("1 mm", 0, 0)),
    lambda: supple.Target("poisson", [(0, 0), (1, 1)], strain="5 mm"),
    lambda: supple.DesignRequest(supple.Target("poisson", [(0, 0), (1, 1)]), cell_size="4 MPa"),
    lambda: supple.parts.coupon("12", 30),
    lambda: supple.PartOptions(thickness="2 deg"),
    lambda: supple.Uniaxial("45", [1.1]),
])
def test_wrong_units_are_refused_when_a_request_is_made(make: Any) -> None:
    with pytest.raises(ValueError, match="expected"):
        make()
