#!/usr/bin/python3
"""Draws the network benchmark's CSV files as SVG files beside them.

Usage: plot_networks.py [FOLDER]      default: docs/bench

networks-steps.svg       what a Newton step's time goes into
networks-growth.svg      time of a step against the number of unknowns
networks-scenes.svg      gradient norm over the iterations from starts near vertices and on edges
networks-methods.svg     gradient norm of three methods against iterations and time
networks-accuracy.svg    errors of energy and positions against time and tolerance
networks-straight.svg    energies of end states of geodesic and straight springs
networks-mollifier.svg   gradient norm with and without mollifier
networks-vertices.svg    a distance and its derivatives across three kinds of vertices

A study whose CSV file is not there is left out.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt

from plotting import BLUE, COLOURS, GREEN, GREY, ORANGE, RED, Row, grouped, numbers, read, save

PARTS = [("search", "geodesics", BLUE), ("assembly", "assembly", GREEN), ("solve", "factorization and solve", RED),
         ("motion", "motion", ORANGE), ("other", "other", GREY)]
METHODS = {"newton": ("Newton", BLUE), "lbfgs": ("L-BFGS", RED), "gradient_descent": ("gradient descent", ORANGE)}
DRAWN_MOLLIFIERS = ("0", "0.1")
LEAST = 1e-17  # zeros, and what is below rounding, are drawn here


def positive(values: list[float]) -> list[float]:
    return [max(value, LEAST) for value in values]


def draw_steps(rows: list[Row], target: Path) -> None:
    alone = [row for row in rows if row["threads"] == "1"]
    figure, axes = plt.subplots(figsize=(7.6, 0.45 * len(alone) + 1.4))
    for place, row in enumerate(alone):
        left = 0.0
        for key, _, colour in PARTS:
            width = float(row["ms"]) * float(row[key]) / 100
            axes.barh(place, width, left=left, color=colour, height=0.65)
            left += width
    axes.set_yticks(range(len(alone)), [f"{row['scene']} ({row['unknowns']})" for row in alone], fontsize=8)
    axes.invert_yaxis()
    axes.set_xlabel("CPU milliseconds per Newton step, one thread (in brackets: unknowns)")
    axes.legend(handles=[plt.Rectangle((0, 0), 1, 1, color=colour, label=label) for _, label, colour in PARTS],
                fontsize=8, frameon=False, ncols=len(PARTS), loc="lower left", bbox_to_anchor=(-0.25, 1.0),
                columnspacing=1.2)
    save(figure, target)


def draw_growth(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(6.2, 3.8))
    for threads, colour, label in (("1", BLUE, "one thread, CPU"), ("2", RED, "two threads, wall")):
        own = [row for row in rows if row["threads"] == threads]
        axes.plot(numbers(own, "unknowns"), numbers(own, "ms"), marker="o", color=colour, label=label)
    alone = [row for row in rows if row["threads"] == "1"]
    for key, label, colour in PARTS[:4]:
        parts = [float(row["ms"]) * float(row[key]) / 100 for row in alone]
        axes.plot(numbers(alone, "unknowns"), parts, color=colour, linewidth=1, linestyle="--", alpha=0.8,
                  label=f"{label} of the former")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("unknowns")
    axes.set_ylabel("milliseconds per Newton step")
    axes.legend(fontsize=7, frameon=False)
    save(figure, target)


def draw_scenes(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(8, 4))
    shapes = list(dict.fromkeys(row["scene"].split(",")[0] for row in rows))
    for scene, points in grouped(rows, "scene").items():
        colour = COLOURS[shapes.index(scene.split(",")[0])]
        on_edges = scene.endswith("on edges")
        axes.semilogy(numbers(points, "iteration"), positive(numbers(points, "gradient")), color=colour, marker="o",
                      markersize=3, linewidth=1.2, linestyle="--" if on_edges else "-", label=scene)
    axes.axhline(1e-6, color="0.6", linewidth=0.8, linestyle=":")
    axes.annotate("the thesis ends here", (axes.get_xlim()[0], 1e-6), fontsize=7, color="0.4", ha="left",
                  xytext=(4, 3), textcoords="offset points")
    axes.set_xlabel("Newton iterations")
    axes.set_ylabel("|g|")
    axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    save(figure, target)


def draw_methods(rows: list[Row], target: Path) -> None:
    problems = grouped(rows, "problem")
    figure, axes = plt.subplots(len(problems), 2, figsize=(8.6, 3.2 * len(problems)), squeeze=False, sharey="row")
    for panels, (problem, own) in zip(axes, problems.items()):
        for method, points in grouped(own, "method").items():
            label, colour = METHODS[method]
            seen = next((row for row in points if row["visible"] == "0"), points[-1])
            for panel, key in zip(panels, ("iteration", "cpu_ms")):
                panel.plot([max(x, 0.5) for x in numbers(points, key)], positive(numbers(points, "gradient")),
                           color=colour, linewidth=1.2, label=label)
                panel.plot(max(float(seen[key]), 0.5), max(float(seen["gradient"]), LEAST), marker="o", color=colour,
                           markersize=5)
        for panel, label in zip(panels, ("iterations", "milliseconds of CPU, one thread")):
            panel.set_xscale("log")
            panel.set_yscale("log")
            panel.set_xlabel(label)
        panels[0].set_ylabel("|g|")
        panels[0].set_title(problem, fontsize=9, loc="left")
    axes[0][1].legend(fontsize=8, frameon=False)
    axes[0][1].set_title("dots: from here on within 1 % of D of the end", fontsize=8, color="0.4", loc="right")
    save(figure, target)


def draw_accuracy(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(8.8, 3.8))
    for colour, (scene, points) in zip(COLOURS, grouped(rows, "scene").items()):
        times = numbers(points, "cpu_ms")
        panels[0].plot(times, positive(numbers(points, "position_error")), marker="o", markersize=4, color=colour,
                       label=scene)
        panels[0].plot(times, positive(numbers(points, "energy_error")), marker="x", markersize=4, linewidth=0.8,
                       linestyle="--", color=colour)
        panels[1].plot(numbers(points, "tolerance"), positive(numbers(points, "position_error")), marker="o",
                       markersize=4, color=colour)
        panels[1].plot(numbers(points, "tolerance"), positive(numbers(points, "energy_error")), marker="x",
                       markersize=4, linewidth=0.8, linestyle="--", color=colour)
    for panel, label in zip(panels, ("CPU milliseconds, one thread", "tolerance")):
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel(label)
    panels[0].set_ylabel("error of positions / D (dots)\nand of E (crosses)")
    panels[1].invert_xaxis()
    panels[0].legend(fontsize=7, frameon=False)
    save(figure, target)


def draw_straight(rows: list[Row], target: Path) -> None:
    problems = grouped(rows, "problem")
    figure, axes = plt.subplots(1, len(problems), figsize=(3.3 * len(problems), 3.4), squeeze=False)
    for panel, (problem, own) in zip(axes[0], problems.items()):
        for springs, colour in (("geodesic", BLUE), ("straight", RED)):
            points = [row for row in own if row["springs"] == springs]
            energies = sorted(numbers(points, "energy"))
            stuck = [row for row in points if row["stopped"] != "converged"]
            panel.plot(range(1, len(energies) + 1), energies, color=colour, marker=".", markersize=5, linewidth=0.8,
                       label=f"{springs}: {len({row['state'] for row in points})} end state(s)"
                             + (f", {len(stuck)} stuck" if stuck else ""))
        panel.set_title(problem, fontsize=9)
        panel.set_xlabel("starts, in the order of energy")
        top = panel.get_ylim()[1]
        panel.set_ylim(1 - 0.04 * (top - 1), 1 + 1.35 * (top - 1))
        panel.legend(fontsize=7, frameon=False, loc="upper left")
    axes[0][0].set_ylabel("geodesic energy of the end state\nover the equilibrium's")
    save(figure, target)


def draw_mollifier(rows: list[Row], target: Path) -> None:
    places = grouped(rows, "equilibrium")
    figure, axes = plt.subplots(1, len(places), figsize=(3.4 * len(places), 3.4), squeeze=False, sharey=True)
    widths = [3.6, 2.2, 1.3, 1.3]
    for panel, (place, own) in zip(axes[0], places.items()):
        for colour, width, (mollifier, points) in zip(COLOURS, widths, grouped(own, "mollifier").items()):
            panel.semilogy(numbers(points, "iteration"), positive(numbers(points, "gradient")), color=colour, marker="o",
                           markersize=width + 1.5, linewidth=width, alpha=0.85,
                           label="no mollifier" if mollifier == "off" else f"mollifier {mollifier}")
        panel.set_title(f"equilibrium {place}", fontsize=9)
        panel.set_xlabel("Newton iterations")
        panel.xaxis.get_major_locator().set_params(integer=True)
    axes[0][0].set_ylabel("|g|")
    axes[0][-1].legend(fontsize=7, frameon=False)
    save(figure, target)


def draw_vertices(rows: list[Row], target: Path) -> None:
    kinds = grouped(rows, "kind")
    figure, axes = plt.subplots(3, len(kinds), figsize=(8.6, 6.6), sharex=True, squeeze=False)
    for column, (kind, own) in enumerate(kinds.items()):
        for mollifier, points in reversed(grouped(own, "mollifier").items()):
            if mollifier not in DRAWN_MOLLIFIERS:
                continue
            plain = float(mollifier) == 0
            for panel, key in zip(axes[:, column], ("g", "slope", "curvature")):
                s, values = numbers(points, "s"), numbers(points, key)
                if kind == "spherical":  # a gap where the derivative jumps
                    middle = sum(x < 0 for x in s)
                    s.insert(middle, 0.0)
                    values.insert(middle, float("nan") if key != "g" else (values[middle - 1] + values[middle]) / 2)
                panel.plot(s, values, color=BLUE if plain else ORANGE, linewidth=1.8 if plain else 1.0,
                           label="exact" if plain else f"mollifier {mollifier}")
        axes[0, column].set_title(f"{kind} vertex", fontsize=9)
        axes[2, column].set_xlabel("s")
    for row, label in enumerate(("g", "g'", "g''")):
        axes[row, 0].set_ylabel(label)
    for row, limits in ((1, (-0.55, 0.55)), (2, (-3, 6.5))):
        for panel in axes[row]:
            panel.set_ylim(limits)
    axes[0, 1].legend(fontsize=8, frameon=False, loc="upper center")
    save(figure, target)


DRAWINGS = [("networks-steps.csv", "networks-steps.svg", draw_steps),
            ("networks-growth.csv", "networks-growth.svg", draw_growth),
            ("networks-history.csv", "networks-scenes.svg", draw_scenes),
            ("networks-methods-history.csv", "networks-methods.svg", draw_methods),
            ("networks-accuracy.csv", "networks-accuracy.svg", draw_accuracy),
            ("networks-straight-ends.csv", "networks-straight.svg", draw_straight),
            ("networks-mollifier-history.csv", "networks-mollifier.svg", draw_mollifier),
            ("networks-vertices.csv", "networks-vertices.svg", draw_vertices)]


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for source, target, draw in DRAWINGS:
        if (folder / source).exists():
            draw(read(folder / source), folder / target)


if __name__ == "__main__":
    main()
