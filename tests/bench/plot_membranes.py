#!/usr/bin/python3
"""Draws the CSV files that the network benchmark's study of membranes writes as SVG files beside them.

Usage: plot_membranes.py [FOLDER]      default: docs/bench

membranes-steps.svg        iterations of each load step, from two starts, with and without longer steps
membranes-figure.svg       a membrane on a stretched torus, with kept and with optimized coordinates
membranes-border.svg       gradient norm over the iterations of free membranes with a border
membranes-accuracy.svg     errors of energy and positions against time and tolerance
membranes-refinement.svg   error of the energy against time and the triangles' size

A CSV file that is not there is left out.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from plotting import BLUE, COLOURS, ORANGE, RED, Row, grouped, numbers, read, save

LEAST = 1e-17  # zeros, and what is below rounding, are drawn here
HEIGHT_OF_EYE = math.radians(42)
Point = tuple[float, float, float]


def positive(values: list[float]) -> list[float]:
    return [max(value, LEAST) for value in values]


def draw_steps(rows: list[Row], target: Path) -> None:
    own = [row for row in rows if row["gradient"] == "1e-06" or float(row["gradient"]) == 1e-6]
    scenes = grouped(own, "stretched")
    figure, panels = plt.subplots(len(scenes), 1, figsize=(8.8, 2.6 * len(scenes) + 0.6), sharex=True, squeeze=False)
    for (panel,), (scene, steps) in zip(panels, scenes.items()):
        for key, colour, label in (("kept no", BLUE, "kept coordinates"), ("continued no", ORANGE, "continued"),
                                   ("kept yes", RED, "kept, longer steps")):
            start, longer = key.split()
            way = [row for row in steps if row["start"] == start and row["longer"] == longer]
            iterations = numbers(way, "iterations")
            mean = sum(iterations) / len(iterations)
            panel.plot(numbers(way, "step"), iterations, color=colour, marker=".", markersize=5, linewidth=0.9,
                       label=f"{label}: mean {mean:.1f}")
            stuck = [row for row in way if row["stopped"] != "converged"]
            panel.plot(numbers(stuck, "step"), numbers(stuck, "iterations"), color=colour, marker="x", markersize=8,
                       linestyle="")
        panel.axhline(5, color="0.6", linewidth=0.8, linestyle="--")
        panel.set_yscale("log", base=2)
        panel.yaxis.set_major_formatter("{x:g}")
        panel.set_ylabel("Newton iterations")
        panel.set_title(f"stretched: {scene}; crosses: not converged", fontsize=9, loc="left")
        panel.legend(fontsize=8, frameon=False, ncols=3, loc="upper left")
        panel.set_ylim(1, panel.get_ylim()[1] * 2)
    panels[-1][0].set_xlabel("load step")
    save(figure, target)


def corners(row: Row) -> list[Point]:
    return [(float(row[f"x{k}"]), float(row[f"y{k}"]), float(row[f"z{k}"])) for k in range(3)]


def seen(place: Point) -> tuple[float, float, float]:
    """Across, upwards and towards the eye, which looks down on the torus along y."""
    x, y, z = place
    sine, cosine = math.sin(HEIGHT_OF_EYE), math.cos(HEIGHT_OF_EYE)
    return x, z * cosine + y * sine, z * sine - y * cosine


def draw_figure(rows: list[Row], target: Path) -> None:
    steps = grouped(rows, "step")
    hows = list(grouped(rows, "how"))
    values = sorted(numbers(rows, "distortion"))
    scale = Normalize(0, values[int(0.995 * (len(values) - 1))])
    figure, panels = plt.subplots(len(hows), len(steps), figsize=(9.2, 5.4), squeeze=False, sharex=True, sharey=True)
    for column, (step, of_step) in enumerate(steps.items()):
        for row, how in enumerate(hows):
            own = [triangle for triangle in of_step if triangle["how"] == how]
            shapes = [([seen(place) for place in corners(triangle)], float(triangle["distortion"])) for triangle in own]
            shapes.sort(key=lambda shape: sum(place[2] for place in shape[0]))
            panel = panels[row][column]
            panel.add_collection(PolyCollection([[place[:2] for place in shape] for shape, _ in shapes],
                                                array=[value for _, value in shapes], cmap="viridis", norm=scale,
                                                edgecolors=(0, 0, 0, 0.55), linewidths=0.4))
            panel.autoscale_view()
            panel.set_aspect("equal")
            panel.set_axis_off()
            panel.set_title(f"load step {step}, coordinates {how}", fontsize=9)
    figure.colorbar(ScalarMappable(scale, "viridis"), ax=panels, shrink=0.7, extend="max", label="distortion")
    save(figure, target, tight=False)


def draw_border(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(6.8, 3.6))
    for colour, (case, points) in zip(COLOURS, grouped(rows, "case").items()):
        axes.plot([max(value, 0.5) for value in numbers(points, "iteration")], positive(numbers(points, "gradient")),
                  color=colour, linewidth=1.2, label=case)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("iterations")
    axes.set_ylabel("|g|")
    axes.legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_accuracy(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(8.8, 3.8))
    for colour, (step, points) in zip(COLOURS, grouped(rows, "step").items()):
        for panel, key in zip(panels, ("cpu_ms", "tolerance")):
            panel.plot(numbers(points, key), positive(numbers(points, "position_error")), marker="o", markersize=4,
                       color=colour, label=f"load step {step}")
            panel.plot(numbers(points, key), positive(numbers(points, "energy_error")), marker="x", markersize=4,
                       linewidth=0.8, linestyle="--", color=colour)
            panel.set_yscale("log")
    panels[0].set_xlabel("CPU milliseconds, one thread")
    panels[1].set_xscale("log")
    panels[1].set_xlabel("tolerance")
    panels[1].invert_xaxis()
    panels[0].set_ylabel("error of positions / D (dots)\nand of E (crosses)")
    panels[1].legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_refinement(rows: list[Row], target: Path) -> None:
    own = [row for row in rows if row["error"] != "-"]
    figure, panels = plt.subplots(1, 2, figsize=(8.4, 3.5), sharey=True)
    for panel, key, label in zip(panels, ("cpu_ms", "radius"), ("CPU milliseconds of five load steps, one thread",
                                                               "least distance of points, mesh units")):
        panel.loglog(numbers(own, key), numbers(own, "error"), marker="o", color=BLUE)
        panel.set_xlabel(label)
    panels[0].set_ylabel("error of E, relative to the finest")
    panels[1].set_xticks(numbers(own, "radius"), [row["radius"] for row in own], fontsize=8)
    panels[1].minorticks_off()
    panels[1].invert_xaxis()
    save(figure, target)


DRAWINGS = [("membranes-steps.csv", "membranes-steps.svg", draw_steps),
            ("membranes-figure.csv", "membranes-figure.svg", draw_figure),
            ("membranes-border-history.csv", "membranes-border.svg", draw_border),
            ("membranes-accuracy.csv", "membranes-accuracy.svg", draw_accuracy),
            ("membranes-refinement.csv", "membranes-refinement.svg", draw_refinement)]


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for source, target, draw in DRAWINGS:
        if (folder / source).exists():
            draw(read(folder / source), folder / target)


if __name__ == "__main__":
    main()
