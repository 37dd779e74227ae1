"""Quantities as text: numbers with units, such as "12 MPa", "4 mm" or "30 deg"."""

from __future__ import annotations

import math
import re
from typing import Any, Dict, Tuple, Union

_UNITS: Dict[str, Tuple[str, float]] = {
    **{name: ("length", factor) for name, factor in (
        ("um", 1e-3), ("\u00b5m", 1e-3), ("\u03bcm", 1e-3), ("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("in", 25.4))},
    **{name: ("stress", factor) for name, factor in (
        ("Pa", 1e-6), ("kPa", 1e-3), ("MPa", 1.0), ("GPa", 1e3), ("N/mm2", 1.0), ("N/mm^2", 1.0), ("N/mm\u00b2", 1.0),
        ("psi", 0.006894757293168361))},
    **{name: ("angle", factor) for name, factor in (("deg", math.pi / 180), ("\u00b0", math.pi / 180), ("rad", 1.0))},
    "%": ("ratio", 0.01),
    **{name: ("density", factor) for name, factor in (
        ("g/cm3", 1.0), ("g/cm^3", 1.0), ("g/cm\u00b3", 1.0), ("kg/m3", 1e-3), ("kg/m^3", 1e-3), ("kg/m\u00b3", 1e-3))},
}
"""The dimension of each unit, and its factor to the unit of numbers without one."""

_EXPECTED = {
    "length": "a number of mm, or a text with a unit such as '4 mm' or '0.4 cm'",
    "stress": "a number of MPa, or a text with a unit such as '12 MPa' or '1.2 GPa'",
    "angle": "an angle in radians, or a text with a unit such as '30 deg'",
    "ratio": "a number, or a text with a unit such as '5 %'",
    "density": "a number of g/cm^3, or a text with a unit such as '1.2 g/cm3'",
}
_TEXT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*")


def from_text(text: str, name: str, dimension: str) -> float:
    """The quantity in the unit of numbers without one. Raises `ValueError`, also if the text has no unit: it would leave open
    which one was meant."""
    found = _TEXT.fullmatch(text)
    unit = _UNITS.get(found.group(2)) if found else None
    if found is None or unit is None or unit[0] != dimension:
        of_another = f" and no {dimension} but a {unit[0]}" if unit is not None else ""
        raise ValueError(f"{name} is {text!r}{of_another}; expected {_EXPECTED[dimension]}")
    return float(found.group(1)) * unit[1]


def without_unit(value: Any, name: str, dimension: str) -> Any:
    """A text as a number, also in lists and tuples; everything else as it is. Raises `ValueError`."""
    if isinstance(value, str):
        return from_text(value, name, dimension)
    if isinstance(value, (list, tuple)) and any(isinstance(entry, str) for entry in value):
        return type(value)(without_unit(entry, name, dimension) for entry in value)
    return value


class Quantity:
    """The mark of a field that may be given as a text with a unit, or as a list or tuple of such."""

    def __init__(self, dimension: str) -> None:
        self.dimension = dimension


LENGTH, STRESS, ANGLE, RATIO, DENSITY = map(Quantity, ("length", "stress", "angle", "ratio", "density"))

Number = Union[float, str]
"""A number, or a text with a unit, which becomes a number when the request is made."""
Pair = Tuple[Number, Number]
