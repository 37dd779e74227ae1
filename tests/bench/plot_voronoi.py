#!/usr/bin/python3
"""Draws the cells that the Voronoi benchmark's study of designs writes, before and after, as a PNG file beside them.

Usage: plot_voronoi.py [FOLDER]      default: docs/bench

voronoi-figure.png   from voronoi-figure.csv, which is not kept: it is large
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from plotting import Row, grouped, read


def seen(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Across, up and towards the eye, which looks from the front right and from above."""
    turn, tilt = math.radians(-60), math.radians(35)
    across = math.cos(turn) * x + math.sin(turn) * y
    away = -math.sin(turn) * x + math.cos(turn) * y
    return across, math.cos(tilt) * z + math.sin(tilt) * away, math.sin(tilt) * z - math.cos(tilt) * away


def draw_cells(panel: plt.Axes, rows: list[Row]) -> None:
    shapes, sites = [], []
    for polygon in grouped(rows, "polygon").values():
        shapes.append(np.array([seen(*(float(row[k]) for k in "xyz")) for row in polygon]))
        sites.append(int(polygon[0]["site"]))
    normals = []
    for shape in shapes:
        offsets = shape - shape[0]
        normal = np.cross(offsets[1:-1], offsets[2:]).sum(axis=0)
        normals.append(normal / max(np.linalg.norm(normal), 1e-300))
    order = sorted((i for i in range(len(shapes)) if normals[i][2] > 0), key=lambda i: shapes[i].mean(axis=0)[2])
    light = np.array([0.35, 0.6, 0.72])
    # Neighbouring cells get different hues: sites are numbered at random.
    colours = [np.array(plt.cm.tab20(sites[i] % 20)[:3]) * (0.45 + 0.55 * min(1.0, max(0.0, float(normals[i] @ light)))) for i in order]
    panel.add_collection(PolyCollection([shapes[i][:, :2] for i in order], facecolors=colours, edgecolors="face", linewidths=0.3))
    panel.set_aspect("equal")
    panel.autoscale_view()
    panel.set_axis_off()


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    scenes = grouped(read(folder / "voronoi-figure.csv"), "scene")
    figure, panels = plt.subplots(len(scenes), 2, figsize=(6.4, 3 * len(scenes)), squeeze=False)
    for row, (scene, own) in zip(panels, scenes.items()):
        for panel, (state, polygons) in zip(row, grouped(own, "state").items()):
            draw_cells(panel, polygons)
            panel.set_title(f"{scene}: {state}", fontsize=8)
    figure.tight_layout()
    figure.savefig(folder / "voronoi-figure.png", dpi=110)
    plt.close(figure)


if __name__ == "__main__":
    main()
