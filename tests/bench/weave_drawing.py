"""How the gallery of weaves draws: profiles over direction, cells, sheets from above and in space. Small files: curves lose
the points that nobody would miss."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, List, Optional, Sequence, Tuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import Colormap, LinearSegmentedColormap, to_rgb
from plotting import BLUE, GREY, RED, save

STRAND, FADED, REST, FUSED, SLIDING = BLUE, "#b9cfe0", "#d9d9d4", "#a32a2a", "#c77a10"
HEIGHTS: Colormap = LinearSegmentedColormap.from_list("height", ["#23406b", "#1b6ca8", "#2a9d8f", "#d9b23c", "#d1495b"])
BANDS = 12  # colours of a view in space
TOLERANCE = 0.01  # mm by which a drawn curve of a cell may miss the computed one
SHEET_TOLERANCE = 0.05  # the same of a sheet
POLAR_TICKS = np.radians([0, 45, 90, 135, 180, 225, 270, 315])

plt.rcParams["path.simplify_threshold"] = 0.3  # of a pixel, for curves over direction

Polylines = Sequence[np.ndarray]


def simplified(points: np.ndarray, tolerance: float = TOLERANCE) -> np.ndarray:
    """The polyline without the points that lie within the tolerance of the rest (Douglas and Peucker 1973)."""
    keep = np.zeros(len(points), dtype=bool)
    keep[[0, -1]] = True
    open_parts = [(0, len(points) - 1)]
    while open_parts:
        first, last = open_parts.pop()
        if last - first < 2:
            continue
        start, chord = points[first], points[last] - points[first]
        between = points[first + 1:last] - start
        square = float(chord @ chord)
        along = np.clip(between @ chord / square, 0, 1) if square > 0 else np.zeros(len(between))
        off = np.linalg.norm(between - along[:, None] * chord, axis=1)
        worst = int(np.argmax(off))
        if off[worst] > tolerance:
            keep[first + 1 + worst] = True
            open_parts += [(first, first + 1 + worst), (first + 1 + worst, last)]
    return points[keep]


def bare(axes: plt.Axes) -> None:
    axes.set_aspect("equal")
    axes.axis("off")


def same_scale(panels: Sequence[plt.Axes]) -> None:
    """Gives pictures the same limits, so that lengths compare."""
    for kind in ("x", "y"):
        limits = np.array([getattr(panel, f"get_{kind}lim")() for panel in panels])
        for panel in panels:
            getattr(panel, f"set_{kind}lim")(limits[:, 0].min(), limits[:, 1].max())


def draw_strands(axes: plt.Axes, strands: Polylines, colour: Any = STRAND, width: float = 1.2,
                 tolerance: float = TOLERANCE) -> None:
    """From above; one path for all of them."""
    parts: List[np.ndarray] = []
    for strand in strands:
        parts += [simplified(np.asarray(strand)[:, :2], tolerance), np.full((1, 2), np.nan)]
    path = np.concatenate(parts)
    axes.plot(path[:, 0], path[:, 1], color=colour, linewidth=width, solid_capstyle="round")


def along(polyline: np.ndarray, coordinate: float) -> Tuple[np.ndarray, np.ndarray]:
    """Position and direction at a length along a polyline."""
    steps = np.diff(polyline, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    ends = np.cumsum(lengths)
    piece = min(int(np.searchsorted(ends, coordinate)), len(steps) - 1)
    direction = steps[piece] / lengths[piece]
    return polyline[piece] + (coordinate - ends[piece] + lengths[piece]) * direction, direction


def draw_crossings(axes: plt.Axes, layout: Any, arrow: float) -> None:
    """Dots where strands are fused, double arrows of this length (mm) along the strand that slides."""
    for crossing in layout.crossings:
        x, y = crossing.position
        sliders = [member for member in crossing.members if member.slides]
        if not sliders:
            axes.plot([x], [y], "o", color=FUSED, markersize=4.5)
        for member in sliders:
            _, direction = along(layout.strands[member.strand].polyline, member.coordinate)
            half = 0.5 * arrow * direction
            axes.annotate("", (x + half[0], y + half[1]), (x - half[0], y - half[1]),
                          arrowprops={"arrowstyle": "<->", "color": SLIDING, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0,
                                      "mutation_scale": 9})


def draw_layout(axes: plt.Axes, layout: Any, arrow: float) -> None:
    """A cell at rest with its crossings, amid its neighbours."""
    draw_repeated(axes, [strand.polyline for strand in layout.strands], layout.lattice, 3)
    draw_crossings(axes, layout, arrow)
    corners = np.array([crossing.position for crossing in layout.crossings] +
                       [point for strand in layout.strands for point in strand.polyline])
    margin = 0.08 * np.ptp(corners, axis=0).max()
    axes.set_xlim(corners[:, 0].min() - margin, corners[:, 0].max() + margin)
    axes.set_ylim(corners[:, 1].min() - margin, corners[:, 1].max() + margin)


def draw_sheet(axes: plt.Axes, rest: Polylines, deformed: Polylines) -> None:
    """A sheet from above, over what it is at rest."""
    draw_strands(axes, rest, REST, 0.8, SHEET_TOLERANCE)
    draw_strands(axes, deformed, width=0.9, tolerance=SHEET_TOLERANCE)
    bare(axes)


def draw_repeated(axes: plt.Axes, strands: Sequence[np.ndarray], lattice: np.ndarray, times: int) -> None:
    """A cell and its copies; the middle one stands out."""
    middle = times // 2
    for i in range(times):
        for j in range(times):
            if (i, j) != (middle, middle):
                shift = (i - middle) * lattice[0] + (j - middle) * lattice[1]
                draw_strands(axes, [np.asarray(strand)[:, :2] + shift for strand in strands], FADED)
    draw_strands(axes, strands)
    bare(axes)


def draw_polar(axes: plt.Axes, curves: Sequence[Tuple[np.ndarray, np.ndarray, Any, str]],
               decades: Optional[Tuple[int, int]] = None) -> None:
    """Profiles over half a turn, (radians, values, colour, label), drawn over a whole one; with `decades` the radius is the
    logarithm from the lower one on."""
    for angles, values, colour, label in curves:
        x = np.concatenate([angles, angles + np.pi, angles[:1] + 2 * np.pi])
        y = np.concatenate([values, values, values[:1]])
        if decades is not None:
            y = np.log10(np.maximum(y, 10.0 ** decades[0])) - decades[0]
        axes.plot(x, y, color=colour, linewidth=1.5, label=label)
    axes.set_xticks(POLAR_TICKS, ["0°", "45°", "90°", "", "", "", "", ""], fontsize=7)
    axes.tick_params(pad=-1)
    axes.set_rlabel_position(302)
    if decades is not None:
        ticks = list(range(decades[0] + 2, decades[1], 2))
        axes.set_ylim(0, decades[1] - decades[0])
        axes.set_yticks([tick - decades[0] for tick in ticks], [f"$10^{{{tick}}}$" for tick in ticks], fontsize=6)
    else:
        axes.set_ylim(bottom=0)
        axes.yaxis.set_major_locator(plt.MaxNLocator(3))
        axes.tick_params(axis="y", labelsize=6)
    axes.grid(linewidth=0.4)


def pull_arrows(axes: plt.Axes, direction: float) -> None:
    """Where a cell is pulled, beside its picture."""
    d = np.array([np.cos(direction), np.sin(direction)])
    d /= np.abs(d).max()
    centre = np.array([0.5, 0.5])
    for sign in (1, -1):
        axes.annotate("", centre + sign * 0.58 * d, centre + sign * 0.49 * d, xycoords="axes fraction",
                      annotation_clip=False, arrowprops={"arrowstyle": "-|>", "color": RED, "linewidth": 1.5})


def draw_in_space(axes: plt.Axes, strands: Polylines, azimuth: float, elevation: float, highest: float,
                  ground: Optional[np.ndarray] = None) -> None:
    """Strands seen from far away under these angles (degrees), coloured by height between -`highest` and it where anything is
    below the plane, from 0 otherwise; `ground` is a closed outline in the plane, drawn below."""
    a, e = np.radians([azimuth, elevation])
    right = np.array([-np.sin(a), np.cos(a), 0])
    up = np.array([-np.sin(e) * np.cos(a), -np.sin(e) * np.sin(a), np.cos(e)])
    lowest = -highest if min(float(np.asarray(strand)[:, 2].min()) for strand in strands) < -0.05 * highest else 0.0
    if ground is not None:
        flat = np.column_stack([ground, np.zeros(len(ground))])
        axes.fill(flat @ right, flat @ up, facecolor="#f1f1ee", edgecolor=GREY, linewidth=0.6)
    runs: List[List[np.ndarray]] = [[] for _ in range(BANDS)]
    for strand in strands:
        points = simplified(np.asarray(strand), SHEET_TOLERANCE)
        middle = 0.5 * (points[1:, 2] + points[:-1, 2])
        band = np.clip(((middle - lowest) / (highest - lowest) * BANDS).astype(int), 0, BANDS - 1)
        first = 0
        for i in range(1, len(band) + 1):
            if i == len(band) or band[i] != band[first]:
                runs[band[first]].append(points[first:i + 1])
                first = i
    for index, parts in enumerate(runs):
        path: List[np.ndarray] = []
        for points in parts:
            path += [np.column_stack([points @ right, points @ up]), np.full((1, 2), np.nan)]
        if path:
            whole = np.concatenate(path)
            axes.plot(whole[:, 0], whole[:, 1], color=to_rgb(HEIGHTS((index + 0.5) / BANDS)), linewidth=1,
                      solid_capstyle="round")
    bare(axes)


def height_bar(figure: plt.Figure, axes: Any, lowest: float, highest: float) -> None:
    scale = plt.cm.ScalarMappable(plt.Normalize(lowest, highest), HEIGHTS.resampled(BANDS))
    bar = figure.colorbar(scale, ax=axes, fraction=0.03, pad=0.01, shrink=0.6)
    bar.set_label("height, mm", fontsize=8)
    bar.ax.tick_params(labelsize=7)


def save_small(figure: plt.Figure, path: Path, tight: bool = True) -> None:
    """Saves with the coordinates of curves to a hundredth of a point."""
    save(figure, path, tight)

    def rounded(attribute: re.Match[str]) -> str:
        return re.sub(r"-?\d+\.\d+", lambda number: f"{float(number.group()):.2f}".rstrip("0").rstrip("."), attribute.group())

    path.write_text(re.sub(r' d="[^"]*"', rounded, path.read_text(encoding="utf-8")), encoding="utf-8")
