"""Printing weaves: options and requests. Lengths are in millimetres."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple, Union

from numpy.typing import ArrayLike

from .jobs import Computation
from .weave_print_answers import GcodeReport, WeaveToolpath, gcode_report_from_wire, toolpath_from_wire
from .weaves import Weave, given, request_document, vector_of


@dataclass(frozen=True)
class Grip:
    """A solid bar at which a printed sheet can be gripped. It consists of passes parallel to the line from `start` to `end`,
    which is the first pass; the others are to the right of it, over `width`. None takes 10 mm."""

    start: ArrayLike
    end: ArrayLike
    width: Optional[float] = None

    def to_wire(self) -> Dict[str, Any]:
        return given(**{"from": vector_of(self.start, 2, "start"), "to": vector_of(self.end, 2, "end"), "width": self.width})


@dataclass(frozen=True)
class PrintOptions:
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

    origin: Optional[ArrayLike] = None
    order: Sequence[int] = ()
    overrun: Optional[Tuple[float, float]] = None
    overruns: Mapping[int, Tuple[float, float]] = field(default_factory=dict)
    loop_overlap: Optional[float] = None
    frame: Optional[Tuple[float, float]] = None
    grips: Sequence[Grip] = ()
    chord_error: Optional[float] = None

    def to_wire(self) -> Dict[str, Any]:
        overruns = [{"strand": int(strand), "start": start, "end": end} for strand, (start, end) in self.overruns.items()]
        return given(
            origin=vector_of(self.origin, 2, "origin"),
            order=[int(strand) for strand in self.order] or None,
            overrun=None if self.overrun is None else {"start": self.overrun[0], "end": self.overrun[1]},
            overruns=overruns or None,
            loop_overlap=self.loop_overlap,
            frame=None if self.frame is None else {"margin": self.frame[0], "lead_in": self.frame[1]},
            grips=[grip.to_wire() for grip in self.grips] or None,
            chord_error=self.chord_error,
        )


def toolpath(
    weave: Weave,
    options: Optional[PrintOptions],
    printer: Optional[Mapping[str, Any]],
    include: Optional[Sequence[str]],
    deadline: Optional[float],
) -> Computation[WeaveToolpath]:
    document = request_document(
        weave,
        None,
        printer=None if printer is None else dict(printer),
        include=None if include is None else list(include),
        deadline=deadline,
        **({} if options is None else options.to_wire()),
    )
    return Computation("/v1/weave-toolpaths", document, lambda answer: toolpath_from_wire(answer.json()))


def report(
    gcode: Union[str, bytes], limits: Optional[Mapping[str, Any]], deadline: Optional[float]
) -> Computation[GcodeReport]:
    content = gcode if isinstance(gcode, bytes) else gcode.encode("ascii", errors="replace")
    text = "".join(chr(byte) if byte < 0x7F else "?" for byte in content)
    document = given(gcode=text, limits=None if limits is None else dict(limits), deadline=deadline)
    return Computation("/v1/gcode-reports", document, lambda answer: gcode_report_from_wire(answer.json()))
