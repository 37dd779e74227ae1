#!/usr/bin/python3
"""Draws relative errors of a model against strain.

Usage: plot_models.py ROWS.csv TARGET.svg      ROWS.csv as `supple-lab card --rows` writes it
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt
import numpy as np

BLUE, RED, GREY = "#1b6ca8", "#d1495b", "#9a9a9a"


def main(source: Path, target: Path) -> None:
    with source.open(newline="") as file:
        rows = list(csv.DictReader(file))
    strain = np.array([float(row["strain_norm"]) for row in rows])
    buckled = np.array([int(row["branch"]) > 0 for row in rows])
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.6), sharex=True)
    for panel, key, title in ((panels[0], "gradient_error", "stress"), (panels[1], "energy_error", "energy density")):
        error = 100 * np.array([float(row[key]) for row in rows])
        panel.plot(strain[~buckled], error[~buckled], ".", color=BLUE, markersize=2, alpha=0.4, label="before buckling",
                   rasterized=True)
        panel.plot(strain[buckled], error[buckled], ".", color=RED, markersize=2, alpha=0.4, label="after buckling",
                   rasterized=True)
        edges = np.geomspace(strain.min(), strain.max() * 1.0001, 13)
        middles, medians = [], []
        for low, high in zip(edges[:-1], edges[1:]):
            inside = (strain >= low) & (strain < high)
            if inside.sum() >= 5:
                middles.append(np.sqrt(low * high))
                medians.append(np.median(error[inside]))
        panel.plot(middles, medians, color="black", linewidth=1.5, label="median")
        panel.axhline(1, color=GREY, linewidth=0.8, linestyle=":")
        panel.set(xscale="log", yscale="log", xlabel="|E|", ylabel=f"relative error of the {title} in %")
        panel.set_ylim(0.005, max(100, error.max()))
    panels[0].legend(fontsize=8, markerscale=4)
    figure.tight_layout()
    figure.savefig(target, metadata={"Date": None}, dpi=160)  # of the points, which are an image in it
    print(target)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), Path(sys.argv[2]))
