#!/usr/bin/python3
"""Draws the weave benchmark's CSV files as SVG files beside them.

Usage: plot_weaves.py [FOLDER]      default: docs/bench

weaves-segments.svg     error of moduli against time for segments between crossings
weaves-tolerance.svg    error of moduli and Newton iterations against the tolerance
weaves-directions.svg   error of interpolated profiles against the number of directions
weaves-sheets.svg       error of a sheet's force against time for segments, tolerances and load steps
weaves-paths.svg        directions that end on another equilibrium, and time, against load steps
weaves-speed.svg        time per direction of each cell, by what it goes into
weaves-size.svg         time and memory of a sheet against the number of its crossings

A study whose CSV file is not there is left out.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt

from plotting import BLUE, COLOURS, GREEN, GREY, ORANGE, PURPLE, RED, Row, grouped, numbers, read, save

PARTS = [("assembly", "assembly", BLUE), ("factorization", "factorization", RED), ("solve", "solves", ORANGE),
         ("out_of_plane", "look out of the plane", PURPLE), ("other", "other", GREY)]
LEAST_PERCENT = 1e-10  # errors that are zero, or rounding, are drawn here


def positive(values: list[float]) -> list[float]:
    return [max(value, LEAST_PERCENT) for value in values]


def draw_segments(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(6.6, 4))
    compared = [row for row in rows if row["modulus_percent"] != "reference"]
    for colour, (cell, points) in zip(COLOURS, grouped(compared, "cell").items()):
        axes.plot(numbers(points, "ms"), numbers(points, "modulus_percent"), marker="o", color=colour, label=cell)
        for row in points:
            axes.annotate(row["segments"], (float(row["ms"]), float(row["modulus_percent"])), fontsize=7, xytext=(4, 3),
                          textcoords="offset points")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("milliseconds per direction (numbers: segments between crossings)")
    axes.set_ylabel("error of the modulus, %")
    axes.legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_tolerance(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(8.4, 3.8))
    for colour, (cell, points) in zip(COLOURS, grouped(rows, "cell").items()):
        tolerances = numbers(points, "tolerance")
        panels[0].plot(tolerances, positive(numbers(points, "modulus_percent")), marker="o", color=colour, label=cell)
        panels[1].plot(tolerances, numbers(points, "iterations"), marker="o", color=colour, label=cell)
    panels[0].set_yscale("log")
    panels[0].set_ylabel("error of the modulus, %")
    panels[1].set_ylabel("Newton iterations per direction")
    panels[1].set_ylim(bottom=0)
    for panel in panels:
        panel.set_xscale("log")
        panel.invert_xaxis()
        panel.set_xlabel("tolerance")
    panels[0].legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_directions(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(6.6, 4))
    for colour, (cell, points) in zip(COLOURS, grouped(rows, "cell").items()):
        counts = numbers(points, "directions")
        axes.plot(counts, positive(numbers(points, "cubic_percent")), marker="o", color=colour, label=cell)
        axes.plot(counts, positive(numbers(points, "linear_percent")), marker="s", markersize=4, linestyle=":", color=colour)
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = sorted({int(row["directions"]) for row in rows})
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel("directions over half a turn (dotted: linear between them)")
    axes.set_ylabel("error of the modulus, %")
    axes.legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_sheets(rows: list[Row], target: Path) -> None:
    """The rows are those of segments; tolerances and load steps stand beside them."""
    figure, panels = plt.subplots(1, 3, figsize=(11.4, 3.6), sharey=True)
    knobs = [("segments", rows)]
    for knob, table in (("tolerance", "weaves-sheet-tolerance"), ("load_steps", "weaves-sheet-steps")):
        knobs.append((knob, [row for row in read(target.parent / f"{table}.csv") if row[knob] != "automatic"]))
    for panel, (knob, points) in zip(panels, knobs):
        for colour, (sheet, own) in zip((BLUE, RED, GREEN), grouped(points, "sheet").items()):
            panel.plot(numbers(own, "ms"), positive(numbers(own, "force_percent")), marker="o", color=colour, label=sheet)
            for row in own:
                panel.annotate(row[knob], (float(row["ms"]), max(float(row["force_percent"]), LEAST_PERCENT)), fontsize=6,
                               xytext=(3, 3), textcoords="offset points")
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel(f"CPU milliseconds (numbers: {knob.replace('_', ' ')})")
    panels[0].set_ylabel("error of the force, %")
    panels[0].legend(fontsize=7, frameon=False)
    save(figure, target)


def draw_paths(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(8.4, 3.8))
    large = [row for row in rows if float(row["strain"]) > 0.2]
    for colour, (cell, points) in zip(COLOURS, grouped(large, "cell").items()):
        steps = numbers(points, "load_steps")
        panels[0].plot(steps, numbers(points, "other"), marker="o", color=colour, label=cell)
        panels[1].plot(steps, numbers(points, "ms"), marker="o", color=colour, label=cell)
    ticks = sorted({int(row["load_steps"]) for row in large})
    for panel in panels:
        panel.set_xscale("log", base=2)
        panel.set_xticks(ticks, [str(tick) for tick in ticks])
        panel.set_ylim(bottom=0 if panel is panels[1] else None)
        panel.set_xlabel("load steps to a strain of 0.3")
    panels[0].set_ylabel("directions on another equilibrium")
    panels[1].set_ylabel("milliseconds per direction")
    panels[0].legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_speed(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(7.6, 4.6))
    labels = [f"{row['cell']}, {row['strain']}" for row in rows]
    left = [0.0] * len(rows)
    for key, label, colour in PARTS:
        widths = [float(row["ms"]) * float(row[key]) / 100 for row in rows]
        axes.barh(labels, widths, left=left, color=colour, label=label)
        left = [a + b for a, b in zip(left, widths)]
    axes.invert_yaxis()
    axes.set_xlabel("milliseconds per direction on one thread")
    axes.legend(fontsize=8, frameon=False, loc="lower right")
    save(figure, target)


def draw_size(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(8.4, 3.8))
    for colour, (scene, points) in zip((BLUE, RED, GREEN, ORANGE), grouped(rows, "scene").items()):
        crossings = numbers(points, "crossings")
        panels[0].plot(crossings, numbers(points, "cpu_s"), marker="o", color=colour, label=scene)
        panels[0].plot(crossings, [1e-3 * ms for ms in numbers(points, "ms_per_iteration")], marker="s", markersize=4,
                       linestyle=":", color=colour)
        panels[1].plot(crossings, positive(numbers(points, "mb")), marker="o", color=colour, label=scene)
    panels[0].set_ylabel("CPU seconds (dotted: per Newton iteration)")
    panels[1].set_ylabel("memory, MB")
    for panel in panels:
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel("crossings")
    panels[1].set_ylim(bottom=0.1)
    panels[0].legend(fontsize=8, frameon=False)
    save(figure, target)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for table, image, draw in (("weaves-segments", "weaves-segments", draw_segments),
                               ("weaves-tolerance", "weaves-tolerance", draw_tolerance),
                               ("weaves-directions", "weaves-directions", draw_directions),
                               ("weaves-sheet-segments", "weaves-sheets", draw_sheets),
                               ("weaves-paths", "weaves-paths", draw_paths),
                               ("weaves-speed-cell-shares", "weaves-speed", draw_speed),
                               ("weaves-size", "weaves-size", draw_size)):
        if (folder / f"{table}.csv").exists():
            draw(read(folder / f"{table}.csv"), folder / f"{image}.svg")


if __name__ == "__main__":
    main()
