"""Quantities that are given as texts with units."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import supple
from supple.units import from_text, without_unit

FACTORS = {
    "length": {"um": 1e-3, "mm": 1, "cm": 10, "m": 1000, "in": 25.4},
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
                with pytest.raises(ValueError, match=f"^width is '4 .*no {dimension} but a {other}; expected"):
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


@pytest.mark.parametrize("make", [
    lambda: supple.Target("poisson", [(0, 0), (1, 1)], strain="5 mm"),
    lambda: supple.DesignRequest(supple.Target("poisson", [(0, 0), (1, 1)]), cell_size="4 MPa"),
    lambda: supple.parts.coupon("12", 30),
    lambda: supple.PartOptions(thickness="2 deg"),
    lambda: supple.Uniaxial("45", [1.1]),
])
def test_wrong_units_are_refused_when_a_request_is_made(make: Any) -> None:
    with pytest.raises(ValueError, match="expected"):
        make()
