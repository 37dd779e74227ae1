#!/usr/bin/python3
"""Draws the geodesic benchmark's CSV files as SVG files beside them.

Usage: plot_geodesics.py [FOLDER]      default: docs/bench

geodesics-ratio.svg        CGAL's time over ours for one source to all vertices, against the number of faces
geodesics-accuracy.svg     error against time of distance fields, one panel per mesh
geodesics-throughput.svg   queries per second against threads
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib.pyplot as plt

from plotting import COLOURS, Row, grouped, numbers, read, save

SMALLEST_ERROR = 1e-6  # the exact field is drawn here
ERROR_TICKS = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1]


def draw_ratio(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(7.6, 3.8))
    for colour, (mesh, points) in zip(COLOURS, grouped(rows, "mesh").items()):
        axes.plot(numbers(points, "faces"), numbers(points, "ratio"), marker="o", color=colour, label=mesh)
    axes.axhline(20, color="0.6", linewidth=0.9, linestyle=":")
    axes.axhline(35, color="0.6", linewidth=0.9, linestyle=":")
    axes.set_xscale("log")
    axes.set_ylim(bottom=0)
    axes.set_xlabel("faces")
    axes.set_ylabel("CGAL's time / ours")
    axes.set_title("One source to every vertex", fontsize=10)
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(1.01, 0.5), frameon=False)
    save(figure, target)


def draw_accuracy(rows: list[Row], target: Path) -> None:
    meshes = grouped(rows, "mesh")
    figure, panels = plt.subplots(1, len(meshes), figsize=(3.4 * len(meshes), 3.6), sharey=True, squeeze=False)
    for panel, (mesh, points) in zip(panels[0], meshes.items()):
        exact = [row for row in points if row["method"] == "exact"]
        graph = [row for row in points if row["method"] == "edge_graph"]
        bounded = [row for row in points if row not in exact and row not in graph]
        for colour, key, label in ((COLOURS[1], "max_error", "largest"), (COLOURS[0], "mean_error", "mean")):
            panel.plot(numbers(bounded, "ms"), numbers(bounded, key), marker="o", markersize=4, color=colour,
                       label=f"error-bounded, {label}")
            panel.plot(numbers(graph, "ms"), numbers(graph, key), marker="s", markersize=6, linestyle="none",
                       markerfacecolor="none", color=colour, label=f"edge graph, {label}")
        panel.plot(numbers(bounded, "ms"), numbers(bounded, "bound"), color="0.5", linewidth=1, linestyle="--",
                   label="error-bounded, guaranteed")
        panel.plot(numbers(exact, "ms"), [SMALLEST_ERROR] * len(exact), marker="D", linestyle="none", color="0.2",
                   label="exact")
        panel.set_yscale("log")
        panel.set_yticks(ERROR_TICKS, ["exact" if e == SMALLEST_ERROR else f"{e:g}" for e in ERROR_TICKS])
        panel.minorticks_off()
        panel.set_xlim(left=0)
        panel.set_xlabel("milliseconds")
        panel.set_title(f"{mesh}, {int(points[0]['faces']):,} faces", fontsize=10)
    panels[0][0].set_ylabel("relative error at the vertices")
    figure.tight_layout(rect=(0, 0.13, 1, 1))
    handles, labels = panels[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=3, fontsize=8, frameon=False)
    save(figure, target, tight=False)


def draw_throughput(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(5.2, 3.6))
    for colour, (what, points) in zip(COLOURS, grouped(rows, "what").items()):
        threads = numbers(points, "threads")
        rates = numbers(points, "per_second")
        axes.plot(threads, rates, marker="o", color=colour, label=what)
        axes.plot(threads, [rates[0] * t for t in threads], color=colour, linewidth=0.8, linestyle=":")
    axes.set_yscale("log")
    axes.set_xticks(sorted({int(row["threads"]) for row in rows}))
    axes.set_xlabel("threads (dotted: proportional)")
    axes.set_ylabel("queries per second")
    axes.legend(fontsize=8, frameon=False)
    save(figure, target)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    draw_ratio(read(folder / "geodesics-one-to-all.csv"), folder / "geodesics-ratio.svg")
    draw_accuracy(read(folder / "geodesics-accuracy.csv"), folder / "geodesics-accuracy.svg")
    draw_throughput(read(folder / "geodesics-throughput.csv"), folder / "geodesics-throughput.svg")


if __name__ == "__main__":
    main()
