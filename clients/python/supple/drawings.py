"""SVG and DXF drawings, and the outlines of parts in them."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Dict, Optional, Tuple, Union

from ._arrays import Array
from .answers import Cost
from .checks import one_of, warn
from .request import Deadline, Reported, Request, Timeout
from .transport import Answer
from .units import LENGTH, Number
from .wire import ACCURACY, At

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


def text_of(source: Union[str, Path], name: str = "") -> str:
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


@dataclass(frozen=True)
class DrawingRequest(Request[Drawing], path="/v1/outlines"):
    """The closed curves of an SVG or ASCII DXF drawing as polygons in mm.

    Attributes:
        source: a file, or text with line breaks.
        width: width of all closed curves together after scaling, mm.
        unit: the drawing's unit, "mm", "cm", "m", "in", "ft", "pt" or "px"; by default that in the file.
        tolerance: largest distance of a chord from its curve, mm; 0.05 by default.
        resolution: pixels per inch of an SVG drawing without a physical size; 96 by default.

    Warns about omitted elements. Raises `InvalidRequest`, which names the element or line that cannot be read.
    """

    source: Annotated[Union[str, Path], At("/text", write=text_of)]
    width: Annotated[Optional[Number], LENGTH] = None
    unit: Optional[str] = None
    tolerance: Annotated[Optional[Number], ACCURACY, LENGTH] = None
    deadline: Deadline = None
    resolution: Optional[float] = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        one_of(self.unit, "unit", UNITS)

    def decode(self, answer: Answer) -> Drawing:
        drawing = super().decode(answer)
        for warning in drawing.warnings:
            warn(warning)
        return drawing
