#!/usr/bin/python3
"""Draws the simulation benchmark's CSV files as SVG files beside them.

Usage: plot_simulations.py [FOLDER]      default: docs/bench

simulations-refinement.svg   error of stress against time per state, one panel per family
simulations-accuracy.svg     error of stress against tolerance and load step
simulations-smoothness.svg   energy density and stress along a parameter in steps of a millionth

A study whose CSV file is not there is left out.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path

import matplotlib.pyplot as plt

from plotting import BLUE, COLOURS, RED, Row, grouped, numbers, read, save

CHOSEN = "1/2, 0.1"
LEAST_PERCENT = 1e-10  # errors that are zero, or rounding, are drawn here


def draw_refinement(rows: list[Row], target: Path) -> None:
    families: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        if row["median_percent"] != "none":
            families[row["family"]].append(row)
    figure, panels = plt.subplots(1, len(families), figsize=(4.2 * len(families), 4.2), sharey=True, squeeze=False)
    for panel, (family, points) in zip(panels[0], families.items()):
        for colour, key, label, limit in ((RED, "worst_percent", "worst", 3), (BLUE, "median_percent", "median", 1)):
            for uniform, marker in ((True, "s"), (False, "o")):
                chosen = [row for row in points if row["mesh"].endswith("uniform") == uniform]
                panel.plot(numbers(chosen, "ms_per_state"), numbers(chosen, key), marker=marker, linestyle="none",
                           color=colour, markerfacecolor="none" if uniform else colour,
                           label=f"{label}, {'uniform' if uniform else 'finer at corners'}")
            panel.axhline(limit, color=colour, linewidth=0.8, linestyle=":")
        for row in points:
            panel.annotate(row["mesh"], (float(row["ms_per_state"]), float(row["median_percent"])), fontsize=7,
                           xytext=(3, -9), textcoords="offset points",
                           fontweight="bold" if row["mesh"] == CHOSEN else "normal")
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.set_xlabel("milliseconds per state")
        panel.set_title(family, fontsize=10)
    panels[0][0].set_ylabel("relative error of stress, % (dotted: what was asked)")
    panels[0][0].legend(fontsize=7, frameon=False)
    save(figure, target)


def draw_smoothness(rows: list[Row], target: Path) -> None:
    middle = float(rows[len(rows) // 2]["p2"])
    steps = [(p - middle) * 1e6 for p in numbers(rows, "p2")]
    figure, panels = plt.subplots(2, 1, figsize=(7.6, 5), sharex=True)
    for panel, key, label in ((panels[0], "energy_density", "energy density"), (panels[1], "stress", "stress $S_{xx}$")):
        values = numbers(rows, key)
        middle_value = values[len(values) // 2]
        panel.plot(steps, [1e6 * (v / middle_value - 1) for v in values], color=BLUE, linewidth=0.9, marker=".", markersize=3)
        panel.set_ylabel(f"{label},\nchange in millionths")
    panels[1].set_xlabel(f"$p_2$ - {middle:g}, in millionths")
    panels[0].set_title("IH21 under uniaxial tension, each design meshed anew", fontsize=10)
    save(figure, target)


def draw_accuracy(rows: list[Row], target: Path) -> None:
    """The rows are those of tolerances; load steps stand beside them."""
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True)
    for panel, knob, points in ((panels[0], "tolerance", rows),
                                (panels[1], "load_step", read(target.parent / "simulations-load-step.csv"))):
        reached = [row for row in points if row["stress_percent"] != "not reached"]
        for colour, (family, own) in zip(COLOURS, grouped(reached, "family").items()):
            for marker, (load, line) in zip("os^", grouped(own, "load").items()):
                panel.plot(numbers(line, knob), [max(value, LEAST_PERCENT) for value in numbers(line, "stress_percent")],
                           color=colour, marker=marker, markersize=4, label=f"{family}, {load}")
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.invert_xaxis()
        panel.set_xlabel(knob.replace("_", " "))
    panels[0].set_ylabel("error of the stress, %")
    panels[0].legend(fontsize=6, frameon=False)
    save(figure, target)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for table, image, draw in (("simulations-refinement", "simulations-refinement", draw_refinement),
                               ("simulations-tolerance", "simulations-accuracy", draw_accuracy),
                               ("simulations-smoothness", "simulations-smoothness", draw_smoothness)):
        if (folder / f"{table}.csv").exists():
            draw(read(folder / f"{table}.csv"), folder / f"{image}.svg")


if __name__ == "__main__":
    main()
