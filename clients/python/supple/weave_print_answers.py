"""Answers about printing weaves. Lengths are in mm, areas in mm^2, speeds in mm/min, durations in minutes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Optional, Tuple

from ._arrays import Array, Positions
from .answers import Cost, Effect
from .drawing import GREY, Drawing, Line, joined
from .shown import Drawn, Shown


@dataclass(frozen=True, repr=False)
class PrintMove(Shown):
    """A move of the nozzle. `kind` is "priming", "strand", "lifted", "channel", "support" or "travel"; `points` has the shape
    (n, 3); `strand` is None for supports and travels, `crossing` for all kinds except channels."""

    kind: str
    points: Positions
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
