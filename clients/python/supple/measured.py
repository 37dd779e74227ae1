"""Measured curves that become targets."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Dict, Mapping, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import checks
from .answers import Array, Cost, cost_from_wire
from .designs import Target
from .jobs import Computation

Column = Union[int, str]


@dataclass(frozen=True)
class CurveNote:
    """A note about how a curve was read.

    Attributes:
        text: a sentence.
        is_warning: whether it says that more than a tenth of the points were not used.
        pointer: the field of the request with which this can be changed, such as "/sense"; may be empty.
    """

    text: str
    is_warning: bool
    pointer: str


@dataclass(frozen=True)
class MeasuredCurve:
    """A measured curve as the control points of a target.

    Attributes:
        task: "stress_strain", "stiffness" or "poisson".
        control_points: (x, y), shape (n, 2): strains or radians, and MPa or a Poisson's ratio.
        interpolation: "cubic", "monotone" or "linear".
        points: the measured points that were used, ordered by x, at most 1000 of them, shape (m, 2), in the same units.
        point_count: number of points with different x that were used.
        set_aside: number of points that were not used.
        set_aside_reasons: their number for each reason: "no_row", "no_number", "out_of_range", "not_first_loading",
            "after_rupture".
        sense: "tension", "compression" or "both"; None over directions.
        sense_told_by: what determined the sense: "request", "titles", "remarks" or "signs", or "nothing" if tension was
            assumed; None over directions.
        relative_rms: root mean square deviation of the curve from the points over that of the points, dimensionless.
        max_deviation, max_at: the largest deviation, in the unit of y, and its x.
        noise: scatter of the points about their neighbours, relative like `relative_rms`.
        offset: measured stress at zero strain, which was subtracted so that the curve passes through the origin, MPa.
        units: the units (x, y) in which the numbers were read.
        message: all notes about the curve; may be empty.
        notes: the notes one by one.
        cost: the bill of the computation.
    """

    task: str
    control_points: Array
    interpolation: str
    points: Array
    point_count: int
    set_aside: int
    relative_rms: float
    max_deviation: float
    max_at: float
    noise: float
    offset: float
    units: Tuple[str, str]
    message: str
    cost: Cost
    set_aside_reasons: Mapping[str, int] = field(default_factory=dict)
    sense: Optional[str] = None
    sense_told_by: Optional[str] = None
    notes: Tuple[CurveNote, ...] = ()

    def target(self, **more: Any) -> Target:
        """The target of this curve; `more` are further fields of `Target`. Stress over strain has the strain measure
        "engineering" unless `strain_measure` says otherwise."""
        if self.task == "stress_strain":
            more.setdefault("strain_measure", "engineering")
        return Target(self.task, self.control_points, interpolation=self.interpolation, **more)


def curve_from_wire(answer: Mapping[str, Any]) -> MeasuredCurve:
    error, target, units = answer["error"], answer["target"], answer["units"]
    return MeasuredCurve(
        task=answer["task"],
        control_points=np.asarray(target["control_points"], dtype=np.float64),
        interpolation=target["interpolation"],
        points=np.asarray(answer["points"], dtype=np.float64),
        point_count=answer["point_count"],
        set_aside=answer["set_aside"],
        relative_rms=error["relative_rms"],
        max_deviation=error["max"],
        max_at=error["max_at"],
        noise=error["noise"],
        offset=answer["offset"],
        units=(units["x"], units["y"]),
        message=answer["message"],
        cost=cost_from_wire(answer["cost"]),
        set_aside_reasons={entry["reason"]: entry["count"] for entry in answer["set_aside_reasons"]},
        sense=answer["sense"]["used"] if "sense" in answer else None,
        sense_told_by=answer["sense"]["told_by"] if "sense" in answer else None,
        notes=tuple(CurveNote(note["text"], note["level"] == "warning", note["pointer"]) for note in answer["notes"]),
    )


def table_of(source: Union[str, Path]) -> Dict[str, str]:
    """The field of a request for a table: `text` for a string with line breaks, `content` for a file, whose encoding the server
    recognizes."""
    if isinstance(source, str) and ("\n" in source or "\r" in source):
        return {"text": source}
    return {"content": base64.b64encode(Path(source).read_bytes()).decode("ascii")}


def text_of(source: Union[str, Path]) -> str:
    """The text of a file in UTF-8, or else in the Latin-1 of older instruments. A string with line breaks is the text itself."""
    if isinstance(source, str) and "\n" in source:
        return source
    content = Path(source).read_bytes()
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def measured_curve(
    task: str,
    table: Mapping[str, str],
    points: Optional[ArrayLike],
    columns: Optional[Tuple[Optional[Column], Optional[Column]]],
    units: Optional[Tuple[Optional[str], Optional[str]]],
    gauge_length: Optional[float],
    area: Optional[float],
    limits: Optional[Tuple[float, float]],
    interpolation: Optional[str],
    max_control_points: Optional[int],
    tolerance: Optional[float],
    origin: Optional[str],
    loading: Optional[str],
    rupture: Optional[str],
    sense: Optional[str],
    decimal_separator: Optional[str],
    zero: Optional[str],
    block: Optional[int],
    deadline: Optional[float],
) -> Computation[MeasuredCurve]:
    checks.one_of(task, "task", checks.TASKS)
    document: Dict[str, Any] = {"task": task, **table}
    if points is not None:
        array = np.asarray(points, dtype=np.float64)
        if array.ndim != 2 or array.shape[1] != 2:
            raise ValueError(f"points have the shape {array.shape}; expected (n, 2)")
        document["points"] = array.tolist()
    groups: Dict[str, Mapping[str, Any]] = {
        "columns": dict(zip("xy", columns or ())),
        "units": dict(zip("xy", units or ())),
        "specimen": {"gauge_length": gauge_length, "area": area},
        "accuracy": {"max_control_points": max_control_points, "tolerance": tolerance},
        "effects": {"origin": origin, "loading": loading, "rupture": rupture},
    }
    for name, group in groups.items():
        given = {key: value for key, value in group.items() if value is not None}
        if given:
            document[name] = given
    more = {
        "range": None if limits is None else [float(value) for value in limits],
        "interpolation": interpolation,
        "sense": sense,
        "decimal_separator": decimal_separator,
        "zero": zero,
        "block": block,
        "deadline": deadline,
    }
    document.update({key: value for key, value in more.items() if value is not None})
    return Computation("/v1/measured-curves", document, lambda answer: curve_from_wire(answer.json()))
