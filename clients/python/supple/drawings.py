"""Drawings, SVG or DXF, that become outlines of parts."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional, Tuple

import numpy as np

from . import checks
from .answers import Array, Cost, cost_from_wire
from .jobs import Computation

UNITS = ("mm", "cm", "m", "in", "ft", "pt", "px")


@dataclass(frozen=True)
class DrawnPolygon:
    """A closed curve of a drawing.

    Attributes:
        points: its corners, shape (n, 2), mm, y upwards.
        names: what it can be chosen by: its id and label, then those of the groups around it; in DXF its layer.
    """

    points: Array
    names: Tuple[str, ...]


@dataclass(frozen=True)
class Drawing:
    """The closed curves of a drawing.

    Attributes:
        format: "svg" or "dxf".
        polygons: in the order of the file.
        size: width and height of all of them together, mm.
        unit: millimetres of one unit of the drawing; `unit_is_known` is False where it was guessed.
        open_curves: curves that stay open and were left out.
        chord_error: the largest distance of a chord from its curve, mm.
        warnings: what was left out or guessed.
        cost: what it took.
    """

    format: str
    polygons: Tuple[DrawnPolygon, ...]
    size: Tuple[float, float]
    unit: float
    unit_is_known: bool
    open_curves: int
    chord_error: float
    warnings: Tuple[str, ...]
    cost: Cost

    def named(self, name: str) -> Tuple[DrawnPolygon, ...]:
        """The polygons that are called so. Raises KeyError that lists the names where there are none."""
        found = tuple(polygon for polygon in self.polygons if name in polygon.names)
        if not found:
            names = sorted({own for polygon in self.polygons for own in polygon.names})
            raise KeyError(f"no closed curve is called {name!r}; the drawing has {', '.join(names) or 'no names'}")
        return found

    def outline(self, *names: str, without: Tuple[str, ...] = ()) -> Dict[str, Any]:
        """The outline of a part: the polygons of these names, or all of them, but for those in `without`."""
        left_out = [id(polygon) for name in without for polygon in self.named(name)]
        chosen = [polygon for name in names for polygon in self.named(name)] if names else self.polygons
        kept = [polygon.points.tolist() for polygon in chosen if id(polygon) not in left_out]
        if not kept:
            raise ValueError("every closed curve of the drawing is left out")
        return {"polygons": kept}


def drawing(
    text: str, width: Optional[float], unit: Optional[str], tolerance: Optional[float], deadline: Optional[float]
) -> Computation[Drawing]:
    checks.one_of(unit, "unit", UNITS)
    document: Dict[str, Any] = {"text": text}
    for name, value in (("width", width), ("unit", unit), ("deadline", deadline)):
        if value is not None:
            document[name] = value
    if tolerance is not None:
        document["accuracy"] = {"tolerance": tolerance}
    return Computation("/v1/outlines", document, lambda answer: drawing_from_wire(answer.json()))


def drawing_from_wire(answer: Mapping[str, Any]) -> Drawing:
    for warning in answer["warnings"]:
        warnings.warn(warning, stacklevel=5)
    width, height = answer["size"]
    return Drawing(
        format=answer["format"],
        polygons=tuple(
            DrawnPolygon(np.asarray(polygon["points"], dtype=np.float64), tuple(polygon["names"]))
            for polygon in answer["polygons"]
        ),
        size=(width, height),
        unit=answer["unit"],
        unit_is_known=answer["unit_is_known"],
        open_curves=answer["open_curves"],
        chord_error=answer["chord_error"],
        warnings=tuple(answer["warnings"]),
        cost=cost_from_wire(answer["cost"]),
    )
