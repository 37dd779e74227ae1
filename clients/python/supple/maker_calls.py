"""The calls of a client about measured curves, drawings and parts."""

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
    """A base class of `Client`."""

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
        """Approximates a measured curve by the few control points of a target.

        Args:
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
            width: width of all closed curves together after scaling, mm.
            unit: the drawing's unit, "mm", "cm", "m", "in", "ft", "pt" or "px"; by default that in the file.
            tolerance: largest distance of a chord from its curve, mm; 0.05 by default.
            resolution: pixels per inch of an SVG drawing without a physical size; 96 by default.

        Warns about omitted elements. Raises `InvalidRequest`, which names the element or line that cannot be read.
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
        """The properties of a part: an outline that a structure fills, for printing or cutting. `outline` comes from
        `parts.coupon`, `block`, `rectangle`, `polygons` or `Drawing.outline`."""
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

        Warns with the `message` of `Part` if a grip or a plate is missing.
        """
        return run(self._transport, parts.part_file(outline, family, parameters, kind, options, deadline), timeout, None)
