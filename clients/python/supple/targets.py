"""Targets of designs, and the measured curves that become targets."""

from __future__ import annotations

import base64
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Dict, Mapping, Optional, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import checks
from ._arrays import Array, Numbers
from .answers import Cost
from .connection import Connection
from .errors import InvalidRequest
from .request import Deadline, Reported, Request, Timeout
from .transport import Answer
from .units import ANGLE, AREA, LENGTH, RATIO, STRAIN_OR_ANGLE, Number, columns_without_units, without_unit
from .wire import ACCURACY, EFFECT, At, Sent, Shape, by_name

Column = Union[int, str]


@dataclass(frozen=True)
class Target(Sent):
    """A wanted profile: a curve through control points. None stands for the server's default.

    Attributes:
        task: "stress_strain" (MPa over strain in one direction), "stiffness" (MPa over directions) or "poisson"
            (Poisson's ratio over directions).
        control_points: (x, y), shape (n, 2), x increasing: strains, or angles in radians of period pi; texts may have other
            units, as in ("5 %", "60 kPa").
        direction: angle of the load from the x axis, radians, for stress_strain. 0 by default.
        strain: strain along the load, for stiffness and poisson. 0.05 by default.
        strain_measure: "green" (Green strain, second Piola-Kirchhoff stress) or "engineering" (stretch - 1, force over rest
            width). "green" by default.
        interpolation: "cubic", "monotone" or "linear"; "cubic" by default.
        weights: weights of the deviations at the control points, shape (n,).
        bands: tolerated deviations at the control points, shape (n,), in the unit of y.
        samples: number of points at which profiles are compared with the target. 10 by default, 50 over directions.
        weight: weight of this target among several. 1 by default.
    """

    task: str
    control_points: Annotated[ArrayLike, Shape(-1, 2), At("/target/")]
    direction: Annotated[Optional[Number], ANGLE] = None
    strain: Annotated[Optional[Number], RATIO] = None
    strain_measure: Optional[str] = None
    interpolation: Annotated[Optional[str], At("/target/")] = None
    weights: Annotated[Optional[Numbers], At("/target/")] = None
    bands: Annotated[Optional[Numbers], At("/target/")] = None
    samples: Optional[int] = None
    weight: Optional[float] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.one_of(self.task, "task", checks.TASKS)
        x, y = "ratio" if self.task == "stress_strain" else "angle", "ratio" if self.task == "poisson" else "stress"
        object.__setattr__(self, "control_points", columns_without_units(self.control_points, "control_points", (x, y)))
        object.__setattr__(self, "bands", without_unit(self.bands, "bands", y))
        points = checks.control_points(self.control_points, self.task, self.direction)
        if self.direction is not None:
            checks.radians(self.direction, "direction")
        if self.strain is not None:
            checks.number(self.strain, "strain")
        checks.one_of(self.strain_measure, "strain_measure", ("green", "engineering"))
        checks.one_of(self.interpolation, "interpolation", ("cubic", "monotone", "linear"))
        checks.one_for_each(self.weights, "weights", len(points))
        checks.one_for_each(self.bands, "bands", len(points))

    @classmethod
    def from_csv(cls, source: Union[str, Path], client: Optional[Connection] = None, **how: Any) -> "Target":
        """The target of a measured curve in a file, or in a text with line breaks. `how` are arguments of
        `MeasuredCurveRequest`. Without a client, one with the environment's address and key is used."""
        return _measured(client, source, None, how)

    @classmethod
    def from_xy(cls, x: ArrayLike, y: ArrayLike, client: Optional[Connection] = None, **how: Any) -> "Target":
        """The same for measured points in the order of the measurement; x and y have the shape (n,)."""
        return _measured(client, None, np.column_stack([np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)]), how)


def _measured(
    client: Optional[Connection], source: Union[str, Path, None], points: Optional[ArrayLike], how: Dict[str, Any]
) -> Target:
    request = MeasuredCurveRequest(source, points, **how)
    try:
        if client is not None:
            return client.run(request).target()
        with Connection() as own:
            return own.run(request).target()
    except InvalidRequest as refused:
        if source is None or not _holds_control_points(source):
            raise
        advice = " If the lines are control points rather than measurements, give them to supple.Target, for example by numpy.loadtxt."
        raise type(refused)(refused.status, refused.code, refused.title, refused.detail + advice, refused.faults) from None


def _holds_control_points(source: Union[str, Path]) -> bool:
    """Whether each line of a file or text, perhaps after a heading, has two to four numbers, as control points have."""
    lines = [line for line in text_of(source).splitlines() if line.strip() and not line.lstrip().startswith("#")]

    def is_point(line: str) -> bool:
        try:
            return 2 <= len([float(cell) for cell in line.split(",")]) <= 4
        except ValueError:
            return False

    return bool(lines) and all(map(is_point, lines[1:])) and (is_point(lines[0]) or len(lines) > 1)


@dataclass(frozen=True)
class CurveNote:
    """A note about how a curve was read.

    Attributes:
        text: a sentence.
        is_warning: whether it says that more than a tenth of the points were not used.
        pointer: the field of the request with which this can be changed, such as "/sense"; may be empty.
    """

    text: str
    is_warning: Annotated[bool, At("/level", read=lambda level: level == "warning")]
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
    control_points: Annotated[Array, At("/target/")]
    interpolation: Annotated[str, At("/target/")]
    points: Array
    point_count: int
    set_aside: int
    relative_rms: Annotated[float, At("/error/")]
    max_deviation: Annotated[float, At("/error/max")]
    max_at: Annotated[float, At("/error/")]
    noise: Annotated[float, At("/error/")]
    offset: float
    units: Annotated[Tuple[str, str], At(read=lambda units: (units["x"], units["y"]))]
    message: str
    cost: Cost
    set_aside_reasons: Annotated[Mapping[str, int], At(read=by_name("count", "reason"))] = field(default_factory=dict)
    sense: Annotated[Optional[str], At("/sense/used")] = None
    sense_told_by: Annotated[Optional[str], At("/sense/told_by")] = None
    notes: Tuple[CurveNote, ...] = ()

    def target(self, **more: Any) -> Target:
        """The target of this curve; `more` are further fields of `Target`. Stress over strain has the strain measure
        "engineering" unless `strain_measure` says otherwise."""
        if self.task == "stress_strain":
            more.setdefault("strain_measure", "engineering")
        return Target(self.task, self.control_points, interpolation=self.interpolation, **more)


def table_of(source: Union[str, Path], name: str = "") -> Dict[str, str]:
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


def _axes(pair: Tuple[Any, Any], name: str) -> Dict[str, Any]:
    return {axis: value for axis, value in zip("xy", pair) if value is not None}


@dataclass(frozen=True)
class MeasuredCurveRequest(Request[MeasuredCurve], path="/v1/measured-curves"):
    """Approximates a measured curve by the few control points of a target.

    Attributes:
        source: a file in UTF-8, UTF-16, GBK or Windows-1252, or text with line breaks. Numbers are separated by commas,
            semicolons, tabs or blanks, and have decimal points or commas; a header and remarks may precede them.
        points: instead of `source`, (x, y) in the order of the measurement, shape (n, 2).
        columns: the columns of x and y, by index or name; by default the header determines them.
        units: units of x and y, such as ("%", "kPa") or ("mm", "N"); by default those in the file. A file without units
            is refused; `points` without units are strains or radians, and MPa.
        gauge_length, area: gauge length and cross section of the specimen, mm and mm^2, for displacements and forces.
        limits: least and greatest x that are used, as strains or radians.
        interpolation: "cubic", "monotone" or "linear"; "cubic" by default.
        max_control_points, tolerance: 12 points, and a relative root mean square deviation of 0.005 by default.
        origin, loading, rupture: whether the curve passes through zero, whether only the first loading is used, and whether
            points after a rupture are omitted: "automatic", "on" or "off".
        sense: "tension" or "compression", in which strains and stresses are negative. By default signs, titles or remarks
            determine it; if they do not, tension is assumed, which `notes` says.
        decimal_separator: "point" or "comma", for a file in which it is ambiguous.
        zero: "first" if displacements are relative to the first one, "as_written" if they are relative to zero.
        block: the block of rows, from 0, in a file with several one after the other; the first one by default.

    Warns if more than a tenth of the points were not used. Raises `InvalidRequest`, which names the column, unit, length,
    sense or decimal separator that is missing.
    """

    source: Annotated[Union[str, Path, None], At("", write=table_of)] = None
    points: Annotated[Optional[ArrayLike], Shape(-1, 2)] = None
    task: str = "stress_strain"
    columns: Annotated[Optional[Tuple[Optional[Column], Optional[Column]]], At(write=_axes)] = None
    units: Annotated[Optional[Tuple[Optional[str], Optional[str]]], At(write=_axes)] = None
    gauge_length: Annotated[Optional[Number], At("/specimen/"), LENGTH] = None
    area: Annotated[Optional[Number], At("/specimen/"), AREA] = None
    limits: Annotated[Optional[Tuple[Number, Number]], Shape(2), At("/range"), STRAIN_OR_ANGLE] = None
    interpolation: Optional[str] = None
    max_control_points: Annotated[Optional[int], ACCURACY] = None
    tolerance: Annotated[Optional[Number], ACCURACY, RATIO] = None
    origin: Annotated[Optional[str], EFFECT] = None
    loading: Annotated[Optional[str], EFFECT] = None
    rupture: Annotated[Optional[str], EFFECT] = None
    sense: Optional[str] = None
    decimal_separator: Optional[str] = None
    zero: Optional[str] = None
    block: Optional[int] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.source is None) == (self.points is None):
            raise ValueError("give either source or points")
        checks.one_of(self.task, "task", checks.TASKS)

    def decode(self, answer: Answer) -> MeasuredCurve:
        curve = super().decode(answer)
        for note in curve.notes:
            if note.is_warning:
                checks.warn(note.text)
        return curve
