#!/usr/bin/python3
"""Draws the CSV files that the network benchmark's study of hosts writes as SVG files beside them.

Usage: plot_hosts.py [FOLDER]      default: docs/bench

hosts-scenes.svg     gradient norm over the iterations of the scenes
hosts-steps.svg      what the time of a Newton step goes into
hosts-size.svg       time of a step of a solid against the number of unknowns
hosts-accuracy.svg   errors of positions and energy against time and tolerance
hosts-refinement.svg errors of positions and energy against the number of faces and time
hosts-figure.svg     a shell and a solid before and after their networks tighten

A CSV file that is not there is left out.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from plotting import BLUE, COLOURS, Row, grouped, numbers, read, save

PARTS = {"search": "search", "host_derivatives": "derivatives by the host", "assembly": "assembly",
         "step": "factorization and solution", "motion": "motion", "other": "other"}


def number(text: str) -> float:
    return float(text.replace(",", ""))


def draw_history(rows: list[Row], target: Path) -> None:
    figure, panel = plt.subplots(figsize=(7.4, 4.2))
    for colour, (scene, steps) in zip(COLOURS * 2, grouped(rows, "scene").items()):
        panel.plot([number(row["iteration"]) for row in steps], [max(number(row["gradient"]), 1e-17) for row in steps],
                   color=colour, linewidth=1.1, label=scene)
    panel.axhline(1e-6, color="0.6", linewidth=0.8, linestyle="--")
    panel.set_yscale("log")
    panel.set_xlabel("iterations")
    panel.set_ylabel("|g|")
    panel.legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_steps(rows: list[Row], target: Path) -> None:
    own = [row for row in rows if row["threads"] == "2"]
    figure, panel = plt.subplots(figsize=(8, 0.5 * len(own) + 1.6))
    places = range(len(own))
    left = [0.0] * len(own)
    for colour, (key, label) in zip(COLOURS * 2, PARTS.items()):
        widths = numbers(own, key)
        panel.barh(places, widths, left=left, color=colour, label=label)
        left = [a + b for a, b in zip(left, widths)]
    panel.set_yticks(list(places), [f"{row['scene']}: {row['ms']} ms" for row in own], fontsize=8)
    panel.set_xlabel("share of a step, two threads (%)")
    panel.set_xlim(0, 100)
    panel.invert_yaxis()
    panel.legend(fontsize=8, frameon=False, ncols=3, loc="lower center", bbox_to_anchor=(0.4, 1))
    save(figure, target)


def draw_size(rows: list[Row], target: Path) -> None:
    own = [row for row in rows if row["threads"] == "2"]
    figure, panel = plt.subplots(figsize=(6, 3.8))
    panel.plot([number(row["unknowns"]) for row in own], [number(row["ms"]) for row in own], color=BLUE, marker="o")
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlabel("unknowns")
    panel.set_ylabel("ms a step, two threads")
    save(figure, target)


def draw_errors(rows: list[Row], target: Path, group: str, axes: dict[str, str]) -> None:
    """Errors of positions (dots) and of the energy (crosses) against two quantities; what has no error is left out."""
    figure, panels = plt.subplots(1, 2, figsize=(8.8, 3.8), sharey=True)
    for panel, (key, label) in zip(panels, axes.items()):
        for colour, (name, points) in zip(COLOURS, grouped(rows, group).items()):
            for error, style in (("position_error", "o-"), ("energy_error", "x--")):
                own = [row for row in points if row[error] not in ("-", "0")]
                panel.loglog([number(row[key]) for row in own], [number(row[error]) for row in own], style, markersize=4,
                             linewidth=0.9, color=colour, label=name if style == "o-" else None)
        panel.set_xlabel(label)
        if key == "tolerance":
            panel.invert_xaxis()
    panels[0].set_ylabel("error of positions / D (dots)\nand of E, relative (crosses)")
    panels[1].legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_accuracy(rows: list[Row], target: Path) -> None:
    draw_errors(rows, target, "scene", {"cpu_ms": "CPU milliseconds, one thread", "tolerance": "tolerance"})


def draw_refinement(rows: list[Row], target: Path) -> None:
    draw_errors(rows, target, "shell", {"faces": "faces of the host", "cpu_ms": "CPU milliseconds, one thread"})


def seen(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Across, up and towards the eye, which looks from the front right and a little from above."""
    turn, tilt = math.radians(-60), math.radians(20)
    across = math.cos(turn) * x + math.sin(turn) * y
    away = -math.sin(turn) * x + math.cos(turn) * y
    return across, math.cos(tilt) * z + math.sin(tilt) * away, math.sin(tilt) * z - math.cos(tilt) * away


def draw_figure(folder: Path, target: Path) -> None:
    vertices, faces, paths = (grouped(read(folder / f"hosts-figure-{part}.csv"), "scene")
                              for part in ("vertices", "faces", "paths"))
    figure, panels = plt.subplots(len(vertices), 2, figsize=(8.4, 4.2 * len(vertices)), squeeze=False)
    for row, scene in enumerate(vertices):
        corners = np.array([[int(face[k]) for k in "abc"] for face in faces[scene]])
        for panel, state in zip(panels[row], ("before", "after")):
            at = np.array([seen(*(float(v[k]) for k in "xyz")) for v in vertices[scene] if v["state"] == state])
            shapes = at[corners]
            normals = np.cross(shapes[:, 1] - shapes[:, 0], shapes[:, 2] - shapes[:, 0])
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
            front = np.flatnonzero(normals[:, 2] > 0)
            order = front[np.argsort(shapes[front].mean(axis=1)[:, 2])]
            light = np.clip(normals[order] @ np.array([0.35, 0.6, 0.72]), 0, 1)
            panel.add_collection(PolyCollection(shapes[order][:, :, :2], facecolors=plt.cm.bone(0.35 + 0.6 * light),
                                                edgecolors="face", linewidths=0.2, rasterized=True))
            centres, towards = at[corners].mean(axis=1), normals
            own = [p for p in paths[scene] if p["state"] == state]
            for spring in grouped(own, "spring").values():
                line = np.array([seen(*(float(p[k]) for k in "xyz")) for p in spring])
                for a, b in zip(line, line[1:]):
                    nearest = np.argmin(np.linalg.norm(centres - (a + b) / 2, axis=1))
                    if towards[nearest, 2] > 0:
                        panel.plot([a[0], b[0]], [a[1], b[1]], color="#c8503c", linewidth=1.6, solid_capstyle="round")
            panel.set_aspect("equal")
            panel.autoscale_view()
            panel.set_axis_off()
            panel.set_title(f"{scene}: {state}", fontsize=9)
    figure.savefig(target, dpi=130)
    plt.close(figure)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for source, target, draw in (("history", "scenes", draw_history), ("steps", "steps", draw_steps),
                                 ("size", "size", draw_size), ("accuracy", "accuracy", draw_accuracy),
                                 ("refinement", "refinement", draw_refinement)):
        if (folder / f"hosts-{source}.csv").exists():
            draw(read(folder / f"hosts-{source}.csv"), folder / f"hosts-{target}.svg")
    if (folder / "hosts-figure-vertices.csv").exists():
        draw_figure(folder, folder / "hosts-figure.svg")


if __name__ == "__main__":
    main()
