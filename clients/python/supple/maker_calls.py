"""The calls of a client about what people bring and take away: measured curves, drawings and parts."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any, Mapping, Optional, Tuple, Union

from numpy.typing import ArrayLike

from . import drawings, measured, parts
from .drawings import Drawing
from .jobs import run
from .measured import Column, MeasuredCurve
from .parts import Part, PartOptions
from .transport import Transport


class MakerCalls:
    """Mixed into `Client`."""

    _transport: Transport

    def measured_curve(
        self,
        source: Union[str, Path, None] = None,
        *,
        points: Optional[ArrayLike] = None,
        task: str = "stress_strain",
        columns: Optional[Tuple[Optional[Column], Optional[Column]]] = None,
        units: Optional[Tuple[Optional[str], Optional[str]]] = None,
        gauge_length: Optional[float] = None,
        area: Optional[float] = None,
        limits: Optional[Tuple[float, float]] = None,
        interpolation: Optional[str] = None,
        max_control_points: Optional[int] = None,
        tolerance: Optional[float] = None,
        origin: Optional[str] = None,
        loading: Optional[str] = None,
        rupture: Optional[str] = None,
        sense: Optional[str] = None,
        decimal_separator: Optional[str] = None,
        zero: Optional[str] = None,
        block: Optional[int] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
    ) -> MeasuredCurve:
        """A measured curve as the few control points of a target.

        Args:
            source: a file in UTF-8, UTF-16, GBK or Windows-1252, or text with line breaks: numbers separated by commas,
                semicolons, tabs or blanks, with decimal points or commas, a header and remarks before them or not.
            points: instead of it (x, y) in the order of the measurement, shape (n, 2).
            columns: which columns of the text are x and y, by index or name; told by the header without it.
            units: of x and y, such as ("%", "kPa") or ("mm", "N"); those of the file without it. A file that names none
                is refused; `points` without units are in 1 or rad, and MPa.
            gauge_length, area: of the specimen, mm and mm^2, for displacements and forces.
            limits: least and greatest x that count, as strains or radians.
            interpolation: "cubic", "monotone" or "linear"; "cubic" on the server's side.
            max_control_points, tolerance: 12, and 0.005 of relative root mean square deviation on the server's side.
            origin, loading, rupture: whether the curve passes through zero, whether only first loadings count, and whether what
                follows a break is left out: "automatic", "on" or "off".
            sense: "tension" or "compression", whose strains and stresses are negative; told by signs, titles or remarks without
                it, and tension where nothing tells, which `notes` says.
            decimal_separator: "point" or "comma", where the numbers of the file do not tell.
            zero: "first" where displacements count from the first of them, "as_written" where they count from zero.
            block: which of several blocks of rows below each other, from 0; the first without it.

        Warns where more than a tenth of the points were set aside. Raises `InvalidRequest` that names the column, unit, length,
        sense or decimal sign that is missing.
        """
        if (source is None) == (points is None):
            raise ValueError("give either source or points")
        table = {} if source is None else measured.table_of(source)
        computation = measured.measured_curve(
            task, table, points, columns, units, gauge_length, area, limits, interpolation, max_control_points, tolerance,
            origin, loading, rupture, sense, decimal_separator, zero, block, deadline,
        )
        curve = run(self._transport, computation, timeout, None)
        for note in curve.notes:
            if note.is_warning:
                warnings.warn(note.text, stacklevel=2)
        return curve

    def drawing(
        self,
        source: Union[str, Path],
        *,
        width: Optional[float] = None,
        unit: Optional[str] = None,
        tolerance: Optional[float] = None,
        deadline: Optional[float] = None,
        resolution: Optional[float] = None,
        timeout: Optional[float] = None,
    ) -> Drawing:
        """The closed curves of an SVG or ASCII DXF drawing as polygons in mm.

        Args:
            source: a file, or text with line breaks.
            width: scales the drawing until all its closed curves together are so wide, mm.
            unit: what one unit of the drawing is, "mm", "cm", "m", "in", "ft", "pt" or "px"; what the file says without it.
            tolerance: how far a chord may be from its curve, mm; 0.05 on the server's side.
            resolution: pixels per inch of an SVG drawing without a physical size; 96 without it.

        Warns about what was left out. Raises `InvalidRequest` that names the element or line that cannot be read.
        """
        computation = drawings.drawing(drawings.text_of(source), width, unit, tolerance, deadline, resolution)
        return run(self._transport, computation, timeout, None)

    def part(
        self,
        outline: Mapping[str, Any],
        family: str,
        parameters: Optional[ArrayLike] = None,
        *,
        options: Optional[PartOptions] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
    ) -> Part:
        """What a part to print or cut is: an outline (`parts.coupon`, `block`, `rectangle`, `polygons` or `Drawing.outline`) filled."""
        return run(self._transport, parts.part(outline, family, parameters, options, deadline), timeout, None)

    def part_file(
        self,
        outline: Mapping[str, Any],
        family: str,
        parameters: Optional[ArrayLike] = None,
        *,
        kind: str = "stl",
        options: Optional[PartOptions] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
    ) -> bytes:
        """The same part as a file: `kind` is "step", "stl", "3mf", "dxf" or "svg". Lengths are in mm.

        Warns with the `message` of `Part` where a grip or a plate is missing.
        """
        return run(self._transport, parts.part_file(outline, family, parameters, kind, options, deadline), timeout, None)
