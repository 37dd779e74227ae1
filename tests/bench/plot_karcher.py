#!/usr/bin/python3
"""Draws docs/bench/karcher.csv: gradient norm against iterations and against time, one colour per method.

Usage: plot_karcher.py [CSV [SVG]]
"""
import csv
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt

COLOURS = {"newton": "#1b6ca8", "lbfgs": "#d1495b", "gradient_descent": "#8a8d62"}
NAMES = {"newton": "Newton", "lbfgs": "L-BFGS", "gradient_descent": "gradient descent"}
SMALLEST = 1e-17  # exact zeros are drawn here


def read_runs(path: Path) -> dict[str, dict[tuple[str, str], list[tuple[int, float, float]]]]:
    """Mesh -> (method, seed) -> (iteration, milliseconds, gradient), in the order of the file."""
    runs: dict = defaultdict(lambda: defaultdict(list))
    with path.open(newline="") as file:
        for row in csv.DictReader(file):
            runs[row["mesh"]][(row["method"], row["seed"])].append(
                (int(row["iteration"]), float(row["milliseconds"]), max(float(row["gradient"]), SMALLEST)))
    return runs


def draw(runs: dict, target: Path) -> None:
    figure, axes = plt.subplots(len(runs), 2, figsize=(9, 2.6 * len(runs)), squeeze=False, sharey=True)
    for row, (mesh, lines) in zip(axes, runs.items()):
        for (method, _), points in lines.items():
            iterations, times, gradients = zip(*points)
            for panel, x in ((row[0], iterations), (row[1], times)):
                panel.semilogy(x, gradients, color=COLOURS[method], alpha=0.7, linewidth=1, marker=".", markersize=3)
        for panel, label in ((row[0], "iterations"), (row[1], "milliseconds of processor time")):
            panel.axhline(1e-9, color="0.7", linewidth=0.8, linestyle=":")
            panel.set_xlabel(label)
            panel.set_xlim(left=0)
        row[0].set_ylabel(f"{mesh}\n|gradient| / diagonal")
    handles = [plt.Line2D([], [], color=COLOURS[m], label=NAMES[m]) for m in COLOURS]
    axes[0][1].legend(handles=handles, frameon=False, fontsize=8)
    figure.tight_layout()
    figure.savefig(target, metadata={"Date": None})


def main() -> None:
    source = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench/karcher.csv")
    target = Path(sys.argv[2]) if len(sys.argv) > 2 else source.with_suffix(".svg")
    plt.rcParams["svg.hashsalt"] = "karcher"
    draw(read_runs(source), target)


if __name__ == "__main__":
    main()
