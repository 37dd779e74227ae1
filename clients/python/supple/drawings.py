"""SVG and DXF drawings, and the outlines of parts in them."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Dict, Mapping, Optional, Tuple, Union

import numpy as np

from . import checks
from .answers import Array, Cost, cost_from_wire
from .jobs import Computation

_CODE_PAGE = re.compile(rb"\$DWGCODEPAGE\s+3\s+(?:ANSI_|DOS|dos)(\d+)")
UNITS = ("mm", "cm", "m", "in", "ft", "pt", "px")


@dataclass(frozen=True)
class DrawnPolygon:
    """A closed curve of a drawing.

    Attributes:
        points: its corners, shape (n, 2), mm, y upwards.
        names: names by which it can be chosen: its id and label, then those of the groups around it; in DXF its layer.
    """

    points: Array
    names: Tuple[str, ...]


@dataclass(frozen=True)
class LeftOut:
    """An element of a drawing that is no outline, and the reason."""

    element: str
    reason: str


@dataclass(frozen=True)
class Drawing:
    """The closed curves of a drawing.

    Attributes:
        format: "svg" or "dxf".
        polygons: in the order of the file.
        size: width and height of all of them together, mm.
        unit: millimetres in one unit of the drawing; `unit_is_known` is False if it was guessed.
        open_curves: number of curves that were omitted because they are open.
        chord_error: the largest distance of a chord from its curve, mm.
        warnings: a sentence for each fact that was guessed and each kind of element that was omitted.
        left_out: the first 1000 elements that are no outline, with the reasons.
        cost: the bill of the computation.
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
    left_out: Tuple[LeftOut, ...] = ()

    def named(self, name: str) -> Tuple[DrawnPolygon, ...]:
        """The polygons with this name. Raises KeyError, which lists the known names, if there are none."""
        found = tuple(polygon for polygon in self.polygons if name in polygon.names)
        if not found:
            names = sorted({own for polygon in self.polygons for own in polygon.names})
            raise KeyError(f"no closed curve is called {name!r}; the drawing has {', '.join(names) or 'no names'}")
        return found

    def outline(self, *names: str, without: Tuple[str, ...] = ()) -> Dict[str, Any]:
        """The outline of a part: the polygons with these names, or all of them, except for those named in `without`."""
        left_out = [id(polygon) for name in without for polygon in self.named(name)]
        chosen = [polygon for name in names for polygon in self.named(name)] if names else self.polygons
        remaining = [polygon.points.tolist() for polygon in chosen if id(polygon) not in left_out]
        if not remaining:
            raise ValueError("every closed curve of the drawing is left out")
        return {"polygons": remaining}


def text_of(source: Union[str, Path]) -> str:
    """The text of a drawing in a file; a string with line breaks or that begins with "<" is the text itself.

    A file that is not UTF-8 is read with the code page in its $DWGCODEPAGE (DXF before 2007), or else as Windows-1252.
    """
    if isinstance(source, str) and ("\n" in source or source.lstrip().startswith("<")):
        return source
    content = Path(source).read_bytes()
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        page = _CODE_PAGE.search(content[:65536])
        try:
            return content.decode(f"cp{page.group(1).decode()}" if page else "cp1252", errors="replace")
        except LookupError:
            return content.decode("cp1252", errors="replace")


def drawing(
    text: str,
    width: Optional[float],
    unit: Optional[str],
    tolerance: Optional[float],
    deadline: Optional[float],
    resolution: Optional[float] = None,
) -> Computation[Drawing]:
    checks.one_of(unit, "unit", UNITS)
    document: Dict[str, Any] = {"text": text}
    for name, value in (("width", width), ("unit", unit), ("resolution", resolution), ("deadline", deadline)):
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
        left_out=tuple(LeftOut(str(one["element"]), str(one["reason"])) for one in answer["left_out"]),
    )
