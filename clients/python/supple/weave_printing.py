"""Printing weaves: options and requests. Lengths are in millimetres."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated, Any, Dict, List, Mapping, Optional, Sequence, Union

from numpy.typing import ArrayLike

from ._arrays import IndexList, Vector2Like
from .request import Deadline, Reported, Request, Timeout
from .transport import Answer
from .units import LENGTH, Number, Pair, without_unit
from .weave_print_answers import GcodeReport, WeaveToolpath
from .weaves import Weave
from .wire import At, Sent, Shape, decode


def _overruns_to_wire(overruns: Mapping[int, Pair], name: str) -> List[Dict[str, Any]]:
    return [{"strand": int(strand), "start": start, "end": end}
            for strand, (start, end) in ((strand, without_unit(pair, name, "length")) for strand, pair in overruns.items())]


def _pair(first: str, second: str) -> At:
    """The place of a pair that is an object in JSON."""
    return At(write=lambda pair, name: {first: pair[0], second: pair[1]})


@dataclass(frozen=True)
class Grip(Sent):
    """A solid bar at which a printed sheet can be gripped. It consists of passes parallel to the line from `start` to `end`,
    which is the first pass; the others are to the right of it, over `width`. None takes 10 mm."""

    start: Annotated[ArrayLike, Shape(2), At("/from"), LENGTH]
    end: Annotated[ArrayLike, Shape(2), At("/to"), LENGTH]
    width: Annotated[Optional[Number], LENGTH] = None


@dataclass(frozen=True)
class PrintOptions(Sent):
    """How a weave is printed. None stands for the server's default.

    Attributes:
        origin: position on the bed of the weave's (0, 0), shape (2,); None centres the print.
        order: all strands in printing order.
        overrun: length by which open strands are printed before their start and beyond their end.
        overruns: the overrun of single strands, by their indices.
        loop_overlap: length by which closed strands are printed over their beginning.
        frame: (margin, lead_in) of a rectangle around the weave; None for no frame.
        grips: bars at which the sheet can be gripped.
        chord_error: largest distance of printed polylines from curved strands.
    """

    origin: Annotated[Optional[Vector2Like], LENGTH] = None
    order: IndexList = ()
    overrun: Annotated[Optional[Pair], _pair("start", "end"), LENGTH] = None
    overruns: Annotated[Mapping[int, Pair], At(write=_overruns_to_wire)] = field(default_factory=dict)
    loop_overlap: Annotated[Optional[Number], LENGTH] = None
    frame: Annotated[Optional[Pair], _pair("margin", "lead_in"), LENGTH] = None
    grips: Sequence[Grip] = ()
    chord_error: Annotated[Optional[Number], LENGTH] = None


@dataclass(frozen=True)
class WeaveToolpathRequest(Request[WeaveToolpath], path="/v1/weave-toolpaths"):
    """G-code that prints a sheet, and the report of an independent checker on it. Raises `InvalidWeave`.

    Attributes:
        weave: a sheet: a pattern with `sheet`, or a layout without a lattice.
        options: supports, overruns, order and place.
        printer: fields of the contract's PrinterProfile; None takes a Prusa i3 MK3S with PLA.
        include: parts of the answer: "gcode", "svg", "moves". ["gcode"] by default.
    """

    weave: Weave
    options: Annotated[Optional[PrintOptions], At("")] = None
    printer: Optional[Mapping[str, Any]] = None
    include: Optional[Sequence[str]] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


def _gcode_to_wire(gcode: Union[str, bytes], name: str) -> str:
    content = gcode if isinstance(gcode, bytes) else gcode.encode("ascii", errors="replace")
    return "".join(chr(byte) if byte < 0x7F else "?" for byte in content)


@dataclass(frozen=True)
class GcodeReportRequest(Request[GcodeReport], path="/v1/gcode-reports"):
    """A check of G-code: what a printer would do with it, and its violations.

    Violations raise no exception: see `GcodeReport.violations`. `limits` has fields of the contract's GcodeLimits. Bytes
    that are not ASCII are read as question marks.
    """

    gcode: Annotated[Union[str, bytes], At(write=_gcode_to_wire)]
    limits: Optional[Mapping[str, Any]] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def decode(self, answer: Answer) -> GcodeReport:
        return decode(GcodeReport, answer.json()["report"])
