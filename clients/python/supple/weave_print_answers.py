"""Answers about printing weaves. Lengths are in mm, areas in mm^2, speeds in mm/min, durations in minutes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional, Tuple

import numpy as np

from .answers import Array, Cost, Effect, cost_from_wire, effects_from_wire
from .drawing import GREY, Drawing, Line, joined
from .shown import Drawn, Shown


@dataclass(frozen=True, repr=False)
class PrintMove(Shown):
    """A move of the nozzle. `kind` is "priming", "strand", "lifted", "channel", "support" or "travel"; `points` has the shape
    (n, 3); `strand` is None for supports and travels, `crossing` for all kinds except channels."""

    kind: str
    points: Array
    area: float
    speed: float
    strand: Optional[int]
    crossing: Optional[int]


@dataclass(frozen=True, repr=False)
class PrintStatistics(Shown):
    """Totals of a toolpath. `heights` are the heights of level printed lines; `lowest` and `highest`, shape (3,), are the
    corners of the print's bounding box, without the line that fills the nozzle."""

    strand_length: float
    lifted_length: float
    channel_length: float
    support_length: float
    priming_length: float
    travel_length: float
    extruded_length: float
    filament: float
    travels: int
    channels: int
    heights: Array
    minutes: float
    lowest: Array
    highest: Array


@dataclass(frozen=True, repr=False)
class Violation(Shown):
    """A fault in a line of G-code; lines are numbered from 1."""

    kind: str
    line: int
    message: str


@dataclass(frozen=True)
class UncheckedCommand:
    """A command whose effect on the printer the report does not consider: its line and name."""

    line: int
    command: str


@dataclass(frozen=True, repr=False)
class FoundChannel(Shown):
    """A recognized channel: the line at which it begins, its feet and its apex, shape (3,), and its length."""

    line: int
    start: Array
    apex: Array
    end: Array
    length: float


@dataclass(frozen=True, repr=False)
class GcodeReport(Shown):
    """A report on G-code: what it prints, and its violations.

    Attributes:
        minutes: duration; None if it is not finite.
        violations: the first 1000 of `violation_count`, ordered by line.
        unchecked: the first 1000 of `unchecked_count` commands whose effect was not considered, ordered by line.
    """

    lines: int
    extruded_length: float
    filament: float
    travel_length: float
    travels: int
    retractions: int
    heights: Array
    minutes: Optional[float]
    lowest: Array
    highest: Array
    channel_length: float
    channels: Tuple[FoundChannel, ...]
    violations: Tuple[Violation, ...]
    violation_count: int
    unchecked: Tuple[UncheckedCommand, ...] = ()
    unchecked_count: int = 0

    @property
    def clean(self) -> bool:
        """Whether there are no violations."""
        return self.violation_count == 0


@dataclass(frozen=True, repr=False)
class WeaveToolpath(Drawn):
    """The toolpath that prints a weave. `gcode`, `svg` and `moves` are None unless requested; `check` is the report of an
    independent checker on the G-code."""

    gcode: Optional[str]
    svg: Optional[str]
    moves: Optional[Tuple[PrintMove, ...]]
    statistics: PrintStatistics
    check: GcodeReport
    effects: Tuple[Effect, ...]
    cost: Cost

    def _drawing(self) -> Optional[Drawing]:
        if self.moves is None:
            return None
        printed = Line(joined([move.points for move in self.moves if move.kind != "travel"]))
        travels = Line(joined([move.points for move in self.moves if move.kind == "travel"]), color=GREY, width=0.6)
        return Drawing("map", (travels, printed), title=f"about {self.statistics.minutes:.3g} minutes")

    def _repr_svg_(self) -> Optional[str]:
        return self.svg or super()._repr_svg_()


def _array(values: Any) -> Array:
    return np.asarray(values, dtype=np.float64)


def _move(document: Mapping[str, Any]) -> PrintMove:
    return PrintMove(
        kind=str(document["kind"]),
        points=_array(document["points"]).reshape(-1, 3),
        area=float(document["area"]),
        speed=float(document["speed"]),
        strand=document["strand"],
        crossing=document["crossing"],
    )


def _statistics(document: Mapping[str, Any]) -> PrintStatistics:
    return PrintStatistics(
        strand_length=float(document["strand_length"]),
        lifted_length=float(document["lifted_length"]),
        channel_length=float(document["channel_length"]),
        support_length=float(document["support_length"]),
        priming_length=float(document["priming_length"]),
        travel_length=float(document["travel_length"]),
        extruded_length=float(document["extruded_length"]),
        filament=float(document["filament"]),
        travels=int(document["travels"]),
        channels=int(document["channels"]),
        heights=_array(document["heights"]),
        minutes=float(document["minutes"]),
        lowest=_array(document["lowest"]),
        highest=_array(document["highest"]),
    )


def _report(document: Mapping[str, Any]) -> GcodeReport:
    return GcodeReport(
        lines=int(document["lines"]),
        extruded_length=float(document["extruded_length"]),
        filament=float(document["filament"]),
        travel_length=float(document["travel_length"]),
        travels=int(document["travels"]),
        retractions=int(document["retractions"]),
        heights=_array(document["heights"]),
        minutes=document["minutes"],
        lowest=_array(document["lowest"]),
        highest=_array(document["highest"]),
        channel_length=float(document["channel_length"]),
        channels=tuple(
            FoundChannel(int(c["line"]), _array(c["start"]), _array(c["apex"]), _array(c["end"]), float(c["length"]))
            for c in document["channels"]
        ),
        violations=tuple(Violation(str(v["kind"]), int(v["line"]), str(v["message"])) for v in document["violations"]),
        violation_count=int(document["violation_count"]),
        unchecked=tuple(UncheckedCommand(int(u["line"]), str(u["command"])) for u in document["unchecked"]),
        unchecked_count=int(document["unchecked_count"]),
    )


def toolpath_from_wire(document: Mapping[str, Any]) -> WeaveToolpath:
    moves = document.get("moves")
    return WeaveToolpath(
        gcode=document.get("gcode"),
        svg=document.get("svg"),
        moves=None if moves is None else tuple(_move(move) for move in moves),
        statistics=_statistics(document["statistics"]),
        check=_report(document["check"]),
        effects=effects_from_wire(document["effects"]),
        cost=cost_from_wire(document["cost"]),
    )


def gcode_report_from_wire(document: Mapping[str, Any]) -> GcodeReport:
    return _report(document["report"])
