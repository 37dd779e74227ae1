"""Pictures of results, drawn as SVG for notebooks, or with matplotlib if it is installed."""

from __future__ import annotations

import html
import math
from dataclasses import dataclass
from typing import Any, List, Optional, Sequence, Tuple

import numpy as np

from ._arrays import Array, Indices

BLUE, ORANGE, RED, GREY, PALE, SOLID = "#1f4e9c", "#f3b562", "#c2362f", "#98a4ae", "#dbe3f0", "#b9c6d8"
WIDTH, HEIGHT = 480.0, 360.0
"""Size of an SVG picture, pixels."""
FLAT = 1e-6
"""Lines in space count as planar if their extent along z is below this fraction of their largest extent."""


@dataclass(frozen=True)
class Line:
    """A polyline of shape (n, 2), or (n, 3) in space. With `marks` its points are marked instead. nan interrupts it."""

    points: Array
    color: str = BLUE
    label: str = ""
    width: float = 1.6
    marks: bool = False
    dashed: bool = False


@dataclass(frozen=True)
class Area:
    """The area between closed polylines of shape (n, 2): the first one is the outline, the others are holes."""

    rings: Tuple[Array, ...]
    color: str = SOLID


@dataclass(frozen=True)
class Band:
    """What lies between two curves over the same x of shape (n,), for example the error bars of a curve. nan interrupts it."""

    x: Array
    lower: Array
    upper: Array
    color: str = BLUE

    def runs(self) -> List[Indices]:
        """The indices of the samples without a gap, for each stretch of them."""
        finite = np.flatnonzero(np.isfinite(self.lower) & np.isfinite(self.upper) & np.isfinite(self.x))
        return [run for run in np.split(finite, np.flatnonzero(np.diff(finite) > 1) + 1) if len(run) > 1]


BAND_OPACITY = 0.2


@dataclass(frozen=True)
class Drawing:
    """A picture.

    Attributes:
        kind: "curves" (axes with numbers), "polar" (x are angles of period pi, in radians) or "map" (equal scales and no
            axes; lines in space are drawn in isometric projection).
        lines, areas, bands: its content; areas and bands are drawn below lines. A map has no bands.
        title: one line of text.
        x_label, y_label: labels of the axes of curves.
    """

    kind: str
    lines: Tuple[Line, ...]
    areas: Tuple[Area, ...] = ()
    title: str = ""
    x_label: str = ""
    y_label: str = ""
    bands: Tuple[Band, ...] = ()

    @property
    def in_space(self) -> bool:
        """Whether the lines do not lie in one plane z = constant. Lines that do are drawn as seen from above."""
        points = [line.points for line in self.lines if line.points.shape[1] == 3]
        every = np.vstack(points) if points else np.empty((0, 3))
        every = every[np.isfinite(every).all(axis=1)]
        return len(every) > 0 and bool(np.ptp(every[:, 2]) > FLAT * np.ptp(every, axis=0).max())


def curve(x: Any, y: Any, **style: Any) -> Line:
    """A line from two arrays of shape (n,)."""
    return Line(np.column_stack([np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)]), **style)


def error_band(x: Any, y: Any, error_bar: Any, color: str = BLUE) -> Tuple[Band, ...]:
    """The band of a curve's error bars, from arrays of shape (n,); none if there are no bars."""
    if error_bar is None:
        return ()
    places, values, bars = (np.asarray(array, dtype=np.float64) for array in (x, y, error_bar))
    return (Band(places, values - bars, values + bars, color),)


def _isometric(points: Array) -> Array:
    """The isometric projection of points in space along (-1, -1, -1), with z upwards; points in the plane are unchanged."""
    if points.shape[1] == 2:
        return points
    x, y, z = points.T
    return np.column_stack([(y - x) / math.sqrt(2), (2 * z - x - y) / math.sqrt(6)])


def _closed_polar(angles: Array, values: Array) -> Array:
    """A polar curve over half a turn as a closed curve over the whole turn, in Cartesian coordinates."""
    order = np.argsort(angles)
    angles_all_around = np.concatenate([angles[order], angles[order] + np.pi])
    radii = np.abs(np.concatenate([values[order], values[order]]))
    points = np.column_stack([radii * np.cos(angles_all_around), radii * np.sin(angles_all_around)])
    return np.vstack([points, points[:1]])


def _band_rings(drawing: Drawing, band: Band) -> List[Array]:
    """The outlines of a band's stretches in the plane of the picture, before scaling. A polar band is there once more, half a
    turn further, and is closed if it has no gap."""
    rings: List[Array] = []
    for run in band.runs():
        x, lower, upper = band.x[run], band.lower[run], band.upper[run]
        if drawing.kind != "polar":
            rings.append(np.column_stack([np.concatenate([x, x[::-1]]), np.concatenate([lower, upper[::-1]])]))
            continue
        order = np.argsort(x)
        x, lower, upper = x[order], lower[order], upper[order]
        if len(run) == len(band.x):
            x, lower, upper = (np.append(a, b) for a, b in ((x, x[0] + np.pi), (lower, lower[0]), (upper, upper[0])))
        radii = np.abs(np.concatenate([lower, upper[::-1]]))
        for turn in (0.0, np.pi):
            angles = np.concatenate([x, x[::-1]]) + turn
            rings.append(np.column_stack([radii * np.cos(angles), radii * np.sin(angles)]))
    return rings


def _in_plane(drawing: Drawing) -> List[Array]:
    """The lines in the plane of the picture, before scaling."""
    if drawing.kind == "polar":
        return [_closed_polar(line.points[:, 0], line.points[:, 1]) for line in drawing.lines]
    return [_isometric(line.points) if drawing.in_space else line.points[:, :2] for line in drawing.lines]


def _box(points: Sequence[Array]) -> Tuple[Array, Array]:
    every = np.vstack([*points, np.empty((0, 2))])
    every = every[np.isfinite(every).all(axis=1)]
    if len(every) == 0:
        return np.zeros(2), np.ones(2)
    low, high = every.min(axis=0), every.max(axis=0)
    flat = high - low <= 1e-12 * np.maximum(np.abs(low), np.abs(high))
    return np.where(flat, low - 0.5, low), np.where(flat, high + 0.5, high)


def _ticks(low: float, high: float) -> List[float]:
    """About five round numbers between both ends."""
    raw = (high - low) / 5
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1, 2, 5, 10) if raw <= factor * power * (1 + 1e-9))
    return [i * step for i in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _path(points: Array, closed: bool = False) -> str:
    parts: List[str] = []
    pen = "M"
    for x, y in points:
        if math.isfinite(x) and math.isfinite(y):
            parts.append(f"{pen}{x:.1f} {y:.1f}")
            pen = "L"
        else:
            pen = "M"
    return "".join(parts) + ("Z" if closed and parts else "")


def _text(x: float, y: float, text: str, anchor: str = "middle", color: str = "#22313f") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="11" fill="{color}">{html.escape(text)}</text>'


def to_svg(drawing: Drawing) -> str:
    """The picture as an SVG document."""
    lines = _in_plane(drawing)
    rings = [ring for area in drawing.areas for ring in area.rings]
    bands = [(band, ring) for band in drawing.bands for ring in _band_rings(drawing, band)]
    low, high = _box(lines + rings + [ring for _, ring in bands])
    curves = drawing.kind == "curves"
    left, right, top, bottom = (62.0, 14.0, 28.0, 52.0) if curves else (10.0, 10.0, 28.0, 24.0)
    if curves:
        pad = 0.04 * (high - low)
        low, high = low - pad, high + pad
    room = np.array([WIDTH - left - right, HEIGHT - top - bottom])
    scale = room / (high - low)
    if not curves:
        scale = np.full(2, scale.min())
    middle = np.array([left, top]) + room / 2

    def place(points: Array) -> Array:
        return np.asarray(middle + (points - (low + high) / 2) * scale * [1, -1], dtype=np.float64)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH:g}" height="{HEIGHT:g}" '
           f'viewBox="0 0 {WIDTH:g} {HEIGHT:g}" font-family="sans-serif">',
           f'<rect width="{WIDTH:g}" height="{HEIGHT:g}" fill="#ffffff"/>', _text(WIDTH / 2, 16, drawing.title)]
    if curves:
        for tick in _ticks(low[0], high[0]):
            x = float(place(np.array([[tick, low[1]]]))[0, 0])
            out.append(f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{top:g}" y2="{HEIGHT - bottom:g}" stroke="#e3e8ec"/>')
            out.append(_text(x, HEIGHT - bottom + 14, f"{tick:.6g}"))
        for tick in _ticks(low[1], high[1]):
            y = float(place(np.array([[low[0], tick]]))[0, 1])
            out.append(f'<line x1="{left:g}" x2="{WIDTH - right:g}" y1="{y:.1f}" y2="{y:.1f}" stroke="#e3e8ec"/>')
            out.append(_text(left - 5, y + 4, f"{tick:.6g}", "end"))
        out.append(_text(WIDTH / 2, HEIGHT - 20, drawing.x_label))
        out.append(_text(4, 24, drawing.y_label, "start"))
    for area in drawing.areas:
        path = "".join(_path(place(ring), closed=True) for ring in area.rings)
        out.append(f'<path d="{path}" fill="{area.color}" fill-rule="evenodd"/>')
    for band, ring in bands:
        out.append(f'<path d="{_path(place(ring), closed=True)}" fill="{band.color}" fill-opacity="{BAND_OPACITY}"/>')
    for line, points in zip(drawing.lines, lines):
        placed = place(points)
        if line.marks:
            for x, y in placed[np.isfinite(placed).all(axis=1)]:
                out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.6" fill="{line.color}"/>')
        else:
            dashes = ' stroke-dasharray="5 3"' if line.dashed else ""
            out.append(f'<path d="{_path(placed)}" fill="none" stroke="{line.color}" stroke-width="{line.width:g}"{dashes}/>')
    x = left
    for line in drawing.lines:
        if line.label:
            out.append(_text(x, HEIGHT - 2, f"\u25cf {line.label}", "start", line.color))
            x += 22 + 6.5 * len(line.label)
    return "\n".join([*out, "</svg>"])


def _matplotlib() -> Any:
    try:
        import matplotlib.pyplot
    except ImportError as error:
        raise ImportError(
            "plot() needs matplotlib, which is not installed (pip install matplotlib, or Debian's python3-matplotlib); "
            "notebooks show results without it"
        ) from error
    return matplotlib.pyplot


def _fill_band(ax: Any, drawing: Drawing, band: Band) -> None:
    for run in band.runs():
        order = run[np.argsort(band.x[run])]
        x, lower, upper = band.x[order], band.lower[order], band.upper[order]
        if drawing.kind == "polar" and len(run) == len(band.x):
            x, lower, upper = (np.append(a, b) for a, b in ((x, x[0] + np.pi), (lower, lower[0]), (upper, upper[0])))
        for turn in (0.0, np.pi) if drawing.kind == "polar" else (0.0,):
            ax.fill_between(x + turn, lower, upper, color=band.color, alpha=BAND_OPACITY, linewidth=0)


def to_matplotlib(drawing: Drawing, ax: Optional[Any]) -> Any:
    """Draws with matplotlib and returns the axes, new ones if `ax` is None. Raises `ImportError` if it is not installed."""
    pyplot = _matplotlib()
    if ax is None:
        projection = "polar" if drawing.kind == "polar" else "3d" if drawing.in_space else None
        ax = pyplot.figure().add_subplot(projection=projection)
    for area in drawing.areas:
        from matplotlib.patches import PathPatch
        from matplotlib.path import Path

        ax.add_patch(PathPatch(Path.make_compound_path(*[Path(ring, closed=False) for ring in area.rings]),
                               facecolor=area.color, edgecolor="none"))
    for band in drawing.bands:
        _fill_band(ax, drawing, band)
    for line in drawing.lines:
        points = line.points if drawing.in_space else line.points[:, :2]
        if drawing.kind == "polar":
            angles, values = points.T
            order = np.argsort(angles)
            angles = np.concatenate([angles[order], angles[order] + np.pi, angles[order][:1] + 2 * np.pi])
            points = np.column_stack([angles, np.concatenate([values[order], values[order], values[order][:1]])])
        style = "o" if line.marks else "--" if line.dashed else "-"
        ax.plot(*points.T, style, color=line.color, linewidth=line.width, markersize=3, label=line.label or None)
    if drawing.kind == "map":
        if not drawing.in_space:
            ax.set_aspect("equal")
            ax.autoscale_view()
        ax.set_axis_off()
    elif drawing.kind == "curves":
        ax.set_xlabel(drawing.x_label)
        ax.set_ylabel(drawing.y_label)
    if any(line.label for line in drawing.lines):
        ax.legend()
    ax.set_title(drawing.title)
    return ax


def joined(polylines: Sequence[Array], size: int = 3) -> Array:
    """Several polylines as one, with rows of nan between them; shape (n, size)."""
    gap = np.full((1, size), np.nan)
    parts = [part for polyline in polylines for part in (polyline, gap)]
    return np.vstack(parts) if parts else np.empty((0, size))


def plot_surface(vertices: Array, faces: Any, ax: Optional[Any], values: Optional[Any]) -> Any:
    """Draws a surface in three-dimensional axes of matplotlib. The mean of the values at a face's corners is its colour."""
    pyplot = _matplotlib()
    if ax is None:
        ax = pyplot.figure().add_subplot(projection="3d")
    surface = ax.plot_trisurf(*vertices.T, triangles=faces, color=None if values is not None else SOLID, edgecolor="none")
    if values is not None:
        at_vertices = np.asarray(values, dtype=np.float64)
        if at_vertices.shape != (len(vertices),):
            raise ValueError(f"values have the shape {at_vertices.shape}; expected ({len(vertices)},), one for each vertex")
        surface.set_array(np.where(np.isfinite(at_vertices), at_vertices, np.nan)[faces].mean(axis=1))
    spans = np.ptp(vertices, axis=0)
    ax.set_box_aspect(np.maximum(spans, 1e-3 * spans.max()))
    return ax
