"""Quantities as text: numbers with units, such as "12 MPa", "4 mm", "30 deg" or "2 min". The units are those of the command line."""

from __future__ import annotations

import math
import re
from typing import Any, Dict, Mapping, Sequence, Tuple, Union

UNITS: Dict[str, Tuple[str, float]] = {
    **{name: ("length", factor) for name, factor in (
        ("um", 1e-3), ("\u00b5m", 1e-3), ("\u03bcm", 1e-3), ("mm", 1.0), ("cm", 10.0), ("m", 1000.0), ("in", 25.4))},
    **{name: ("area", factor) for name, factor in (
        ("mm2", 1.0), ("mm^2", 1.0), ("mm\u00b2", 1.0), ("cm2", 100.0), ("cm^2", 100.0), ("cm\u00b2", 100.0))},
    **{name: ("stress", factor) for name, factor in (
        ("Pa", 1e-6), ("kPa", 1e-3), ("MPa", 1.0), ("GPa", 1e3), ("N/mm2", 1.0), ("N/mm^2", 1.0), ("N/mm\u00b2", 1.0),
        ("psi", 0.006894757293168361))},
    **{name: ("force", factor) for name, factor in (("mN", 1e-3), ("N", 1.0), ("kN", 1e3))},
    **{name: ("angle", factor) for name, factor in (("deg", math.pi / 180), ("\u00b0", math.pi / 180), ("rad", 1.0))},
    **{name: ("duration", factor) for name, factor in (("ms", 1e-3), ("s", 1.0), ("min", 60.0), ("h", 3600.0))},
    "%": ("ratio", 0.01),
    **{name: ("density", factor) for name, factor in (
        ("g/cm3", 1.0), ("g/cm^3", 1.0), ("g/cm\u00b3", 1.0), ("kg/m3", 1e-3), ("kg/m^3", 1e-3), ("kg/m\u00b3", 1e-3))},
}
"""The dimension of each unit, and its factor to the unit of numbers without one."""

_EXPECTED = {
    "length": "a number of mm, or a text with a unit such as '4 mm' or '0.4 cm'",
    "area": "a number of mm^2, or a text with a unit such as '24 mm2'",
    "stress": "a number of MPa, or a text with a unit such as '12 MPa' or '1.2 GPa'",
    "force": "a number of N, or a text with a unit such as '100 mN'",
    "angle": "an angle in radians, or a text with a unit such as '30 deg'",
    "duration": "a number of seconds, or a text with a unit such as '30 s' or '2 min'",
    "ratio": "a number, or a text with a unit such as '5 %'",
    "density": "a number of g/cm^3, or a text with a unit such as '1.2 g/cm3'",
}
_TEXT = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S*)\s*")
Dimensions = Union[str, Tuple[str, ...]]
"""The dimension of a quantity, or several that it may have: strains or angles."""


def from_text(text: str, name: str, dimensions: Dimensions) -> float:
    """The quantity in the unit of numbers without one. Raises `ValueError`, also if the text has no unit: it would leave open
    which one was meant."""
    allowed = (dimensions,) if isinstance(dimensions, str) else dimensions
    found = _TEXT.fullmatch(text)
    unit = UNITS.get(found.group(2)) if found else None
    if found is None or unit is None or unit[0] not in allowed:
        article = "" if unit is None else "an" if unit[0][0] in "aeiou" else "a"
        of_another = "" if unit is None else f" and no {' or '.join(allowed)} but {article} {unit[0]}"
        raise ValueError(f"{name} is {text!r}{of_another}; expected {', or '.join(_EXPECTED[one] for one in allowed)}")
    return float(found.group(1)) * unit[1]


def without_unit(value: Any, name: str, dimensions: Dimensions) -> Any:
    """A text as a number, also in lists and tuples of any depth; everything else as it is. Raises `ValueError`."""
    if isinstance(value, str):
        return from_text(value, name, dimensions)
    if isinstance(value, (list, tuple)) and any(isinstance(entry, (str, list, tuple)) for entry in value):
        return type(value)(without_unit(entry, name, dimensions) for entry in value)
    return value


def columns_without_units(rows: Any, name: str, columns: Sequence[Dimensions]) -> Any:
    """Rows of quantities as numbers, each column of a dimension of its own; everything else as it is. Raises `ValueError`."""
    if not isinstance(rows, (list, tuple)) or not any(isinstance(row, (list, tuple)) for row in rows):
        return rows
    return [[without_unit(entry, name, columns[min(place, len(columns) - 1)]) for place, entry in enumerate(row)]
            if isinstance(row, (list, tuple)) else row for row in rows]


def members_without_units(members: Mapping[str, Any], dimensions: Mapping[str, Dimensions]) -> Dict[str, Any]:
    """The members of an object, in which texts of those that have a dimension are numbers. Raises `ValueError`."""
    return {name: without_unit(value, name, dimensions[name]) if name in dimensions else value for name, value in members.items()}


class Quantity:
    """The mark of a field that may be given as a text with a unit, or as a list or tuple of such."""

    def __init__(self, *dimensions: str) -> None:
        self.dimensions = dimensions


LENGTH, AREA, STRESS, FORCE, ANGLE, DURATION, RATIO, DENSITY = map(
    Quantity, ("length", "area", "stress", "force", "angle", "duration", "ratio", "density"))
STRAIN_OR_ANGLE = Quantity("ratio", "angle")
"""The abscissa of a profile: strains, or directions of the load."""

Number = Union[float, str]
"""A number, or a text with a unit, which becomes a number when the request is made."""
Pair = Tuple[Number, Number]
