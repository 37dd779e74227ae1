#!/usr/bin/python3
"""Draws the benchmarks' CSV files as SVG files beside them.

Usage: plot.py [FOLDER]      default: docs/bench

`DRAWINGS` at the end says which file is drawn by what. A CSV file that is not there is left out.
"""

from __future__ import annotations

import math
import sys
from collections import defaultdict
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from plotting import BLUE, COLOURS, GREEN, GREY, OLIVE, ORANGE, RED, Row, grouped, numbers, read, save

METHODS = {"newton": ("Newton", BLUE), "lbfgs": ("L-BFGS", RED), "gradient_descent": ("gradient descent", OLIVE)}
PARTS = [("search", "geodesics", BLUE), ("assembly", "assembly", GREEN), ("solve", "factorization and solve", RED),
         ("motion", "motion", ORANGE)]
LEAST = 1e-17  # zeros, and what is below rounding, are drawn here
LEAST_PERCENT = 1e-10  # the same of percentages
CHOSEN = "1/2, 0.1"  # the mesh of most data sets
EXACT = 1e-6  # the exact distance field is drawn here
ERROR_TICKS = [1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1]
Point = tuple[float, float, float]


def positive(values: list[float], least: float = LEAST) -> list[float]:
    return [max(value, least) for value in values]


def count(text: str) -> float:
    return float(text.replace(",", ""))


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


def draw_fields(rows: list[Row], target: Path) -> None:
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
        panel.plot(numbers(exact, "ms"), [EXACT] * len(exact), marker="D", linestyle="none", color="0.2",
                   label="exact")
        panel.set_yscale("log")
        panel.set_yticks(ERROR_TICKS, ["exact" if e == EXACT else f"{e:g}" for e in ERROR_TICKS])
        panel.minorticks_off()
        panel.set_xlim(left=0)
        panel.set_xlabel("milliseconds")
        panel.set_title(f"{mesh}, {int(points[0]['faces']):,} faces", fontsize=10)
    panels[0][0].set_ylabel("relative error at the vertices")
    figure.tight_layout(rect=(0, 0.13, 1, 1))
    handles, labels = panels[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=3, fontsize=8, frameon=False)
    save(figure, target, tight=False)


def draw_methods(rows: list[Row], target: Path) -> None:
    meshes = grouped(rows, "mesh")
    figure, axes = plt.subplots(len(meshes), 2, figsize=(9, 2.6 * len(meshes)), squeeze=False, sharey=True)
    for panels, (mesh, own) in zip(axes, meshes.items()):
        for method, points in grouped(own, "method").items():
            for run in grouped(points, "seed").values():
                gradients = positive(numbers(run, "gradient"))
                for panel, key in zip(panels, ("iteration", "milliseconds")):
                    panel.semilogy(numbers(run, key), gradients, color=METHODS[method][1], alpha=0.7, linewidth=1, marker=".",
                                   markersize=3)
        for panel, label in zip(panels, ("iterations", "milliseconds of processor time")):
            panel.axhline(1e-9, color="0.7", linewidth=0.8, linestyle=":")
            panel.set_xlabel(label)
            panel.set_xlim(left=0)
        panels[0].set_ylabel(f"{mesh}\n|gradient| / diagonal")
    axes[0][1].legend(handles=[plt.Line2D([], [], color=colour, label=name) for name, colour in METHODS.values()],
                      frameon=False, fontsize=8)
    save(figure, target)


def draw_growth(rows: list[Row], target: Path) -> None:
    figure, axes = plt.subplots(figsize=(6.2, 3.8))
    for threads, colour, label in (("1", BLUE, "one thread, CPU"), ("2", RED, "two threads, wall")):
        own = [row for row in rows if row["threads"] == threads]
        axes.plot(numbers(own, "unknowns"), numbers(own, "ms"), marker="o", color=colour, label=label)
    alone = [row for row in rows if row["threads"] == "1"]
    for key, label, colour in PARTS:
        parts = [float(row["ms"]) * float(row[key]) / 100 for row in alone]
        axes.plot(numbers(alone, "unknowns"), parts, color=colour, linewidth=1, linestyle="--", alpha=0.8,
                  label=f"{label} of the former")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("unknowns")
    axes.set_ylabel("milliseconds per Newton step")
    axes.legend(fontsize=7, frameon=False)
    save(figure, target)


def draw_size(rows: list[Row], target: Path) -> None:
    own = [row for row in rows if row["threads"] == "2"]
    figure, panel = plt.subplots(figsize=(6, 3.8))
    panel.plot([count(row["unknowns"]) for row in own], [count(row["ms"]) for row in own], color=BLUE, marker="o")
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlabel("unknowns")
    panel.set_ylabel("ms a step, two threads")
    save(figure, target)


def draw_errors(rows: list[Row], target: Path, group: str, axes: dict[str, str]) -> None:
    """Errors of positions (dots) and of the energy (crosses) against two quantities; what has no error is left out."""
    def label_of(name: str) -> str:
        return f"load step {name}" if group == "step" else name

    figure, panels = plt.subplots(1, 2, figsize=(8.8, 3.8), sharey=True)
    for panel, (key, label) in zip(panels, axes.items()):
        for colour, (name, points) in zip(COLOURS, grouped(rows, group).items()):
            for error, style in (("position_error", "o-"), ("energy_error", "x--")):
                own = [row for row in points if row[error] != "-"]
                panel.loglog([count(row[key]) for row in own], positive([count(row[error]) for row in own]), style,
                             markersize=4, linewidth=0.9, color=colour, label=label_of(name) if style == "o-" else None)
        panel.set_xlabel(label)
        if key == "tolerance":
            panel.invert_xaxis()
    panels[0].set_ylabel("error of positions / D (dots)\nand of E (crosses)")
    panels[1].legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_tolerances(rows: list[Row], target: Path) -> None:
    group = "step" if "step" in rows[0] else "scene"
    draw_errors(rows, target, group, {"cpu_ms": "CPU milliseconds, one thread", "tolerance": "tolerance"})


def draw_host_refinement(rows: list[Row], target: Path) -> None:
    draw_errors(rows, target, "shell", {"faces": "faces of the host", "cpu_ms": "CPU milliseconds, one thread"})


def draw_membrane_refinement(rows: list[Row], target: Path) -> None:
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


def seen(place: Point, tilt: float) -> Point:
    """Across, up and towards the eye, which looks from the front right and from above, at this angle in degrees."""
    turn, tilt = math.radians(-60), math.radians(tilt)
    x, y, z = place
    across = math.cos(turn) * x + math.sin(turn) * y
    away = -math.sin(turn) * x + math.cos(turn) * y
    return across, math.cos(tilt) * z + math.sin(tilt) * away, math.sin(tilt) * z - math.cos(tilt) * away


def place_of(row: Row) -> Point:
    return float(row["x"]), float(row["y"]), float(row["z"])


def draw_hosts(vertex_rows: list[Row], target: Path) -> None:
    vertices = grouped(vertex_rows, "scene")
    faces, paths = (grouped(read(target.parent / f"hosts-figure-{part}.csv"), "scene") for part in ("faces", "paths"))
    figure, panels = plt.subplots(len(vertices), 2, figsize=(8.4, 4.2 * len(vertices)), squeeze=False)
    for row, scene in enumerate(vertices):
        corners = np.array([[int(face[k]) for k in "abc"] for face in faces[scene]])
        for panel, state in zip(panels[row], ("before", "after")):
            at = np.array([seen(place_of(v), 20) for v in vertices[scene] if v["state"] == state])
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
                line = np.array([seen(place_of(p), 20) for p in spring])
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


def draw_cells(panel: plt.Axes, rows: list[Row]) -> None:
    shapes, sites = [], []
    for polygon in grouped(rows, "polygon").values():
        shapes.append(np.array([seen(place_of(row), 35) for row in polygon]))
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


def draw_diagrams(rows: list[Row], target: Path) -> None:
    scenes = grouped(rows, "scene")
    figure, panels = plt.subplots(len(scenes), 2, figsize=(6.4, 3 * len(scenes)), squeeze=False)
    for line, (scene, own) in zip(panels, scenes.items()):
        for panel, (state, polygons) in zip(line, grouped(own, "state").items()):
            draw_cells(panel, polygons)
            panel.set_title(f"{scene}: {state}", fontsize=8)
    figure.tight_layout()
    figure.savefig(target, dpi=110)
    plt.close(figure)


def draw_native_time(rows: list[Row], target: Path) -> None:
    families = grouped(rows, "family")
    # The place after the last family holds the legend.
    columns = min(4, len(families) + 1)
    lines = math.ceil((len(families) + 1) / columns)
    figure, panels = plt.subplots(lines, columns, figsize=(3.1 * columns, 2.9 * lines), sharex=True, sharey=True,
                                  squeeze=False)
    for panel, (family, points) in zip(panels.flat, families.items()):
        strain = [100 * s for s in numbers(points, "strain")]
        for key, colour, label in (("native", RED, "simulation"), ("network", BLUE, "network")):
            panel.plot(strain, numbers(points, f"{key}_ms"), color=colour, marker="o", markersize=3,
                       label=f"{label}, median")
            panel.plot(strain, numbers(points, f"{key}_worst"), color=colour, linewidth=0.8, linestyle="--",
                       label=f"{label}, worst")
        panel.axvline(0, color=GREY, linewidth=0.8, linestyle=":")
        panel.set(yscale="log")
        panel.set_title(family, fontsize=10)
        panel.tick_params(labelbottom=True)
    for rest in panels.flat[len(families):]:
        rest.axis("off")
    panels.flat[len(families)].legend(*panels.flat[0].get_legend_handles_labels(), fontsize=9, frameon=False,
                                      loc="center")
    figure.supxlabel("strain along the load, %", fontsize=10)
    figure.supylabel("milliseconds of an equilibrium", fontsize=10)
    save(figure, target)


def draw_mesh_refinement(rows: list[Row], target: Path) -> None:
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


def draw_simulations(rows: list[Row], target: Path) -> None:
    """The rows are those of tolerances; load steps stand beside them."""
    figure, panels = plt.subplots(1, 2, figsize=(9, 3.8), sharey=True)
    for panel, knob, points in ((panels[0], "tolerance", rows),
                                (panels[1], "load_step", read(target.parent / "simulations-load-step.csv"))):
        reached = [row for row in points if row["stress_percent"] != "not reached"]
        for colour, (family, own) in zip(COLOURS, grouped(reached, "family").items()):
            for marker, (load, line) in zip("os^", grouped(own, "load").items()):
                panel.plot(numbers(line, knob), positive(numbers(line, "stress_percent"), LEAST_PERCENT),
                           color=colour, marker=marker, markersize=4, label=f"{family}, {load}")
        panel.set_xscale("log")
        panel.set_yscale("log")
        panel.invert_xaxis()
        panel.set_xlabel(knob.replace("_", " "))
    panels[0].set_ylabel("error of the stress, %")
    panels[0].legend(fontsize=6, frameon=False)
    save(figure, target)


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


def draw_weave_tolerance(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(8.4, 3.8))
    for colour, (cell, points) in zip(COLOURS, grouped(rows, "cell").items()):
        tolerances = numbers(points, "tolerance")
        panels[0].plot(tolerances, positive(numbers(points, "modulus_percent"), LEAST_PERCENT), marker="o", color=colour, label=cell)
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
        axes.plot(counts, positive(numbers(points, "cubic_percent"), LEAST_PERCENT), marker="o", color=colour, label=cell)
        axes.plot(counts, positive(numbers(points, "linear_percent"), LEAST_PERCENT), marker="s", markersize=4, linestyle=":", color=colour)
    axes.set_xscale("log")
    axes.set_yscale("log")
    ticks = sorted({int(row["directions"]) for row in rows})
    axes.set_xticks(ticks, [str(tick) for tick in ticks])
    axes.minorticks_off()
    axes.set_xlabel("directions over half a turn (dotted: linear between them)")
    axes.set_ylabel("error of the modulus, %")
    axes.legend(fontsize=8, frameon=False)
    save(figure, target)


DRAWINGS = [("models-native-time.csv", "models-native-time.svg", draw_native_time),
            ("simulations-tolerance.csv", "simulations-accuracy.svg", draw_simulations),
            ("simulations-refinement.csv", "simulations-refinement.svg", draw_mesh_refinement),
            ("geodesics-accuracy.csv", "geodesics-accuracy.svg", draw_fields),
            ("geodesics-one-to-all.csv", "geodesics-ratio.svg", draw_ratio),
            ("karcher.csv", "karcher.svg", draw_methods),
            ("networks-accuracy.csv", "networks-accuracy.svg", draw_tolerances),
            ("networks-growth.csv", "networks-growth.svg", draw_growth),
            ("membranes-accuracy.csv", "membranes-accuracy.svg", draw_tolerances),
            ("membranes-refinement.csv", "membranes-refinement.svg", draw_membrane_refinement),
            ("hosts-accuracy.csv", "hosts-accuracy.svg", draw_tolerances),
            ("hosts-refinement.csv", "hosts-refinement.svg", draw_host_refinement),
            ("hosts-size.csv", "hosts-size.svg", draw_size),
            ("hosts-figure-vertices.csv", "hosts-figure.svg", draw_hosts),
            ("voronoi-figure.csv", "voronoi-figure.png", draw_diagrams),
            ("weaves-segments.csv", "weaves-segments.svg", draw_segments),
            ("weaves-tolerance.csv", "weaves-tolerance.svg", draw_weave_tolerance),
            ("weaves-directions.csv", "weaves-directions.svg", draw_directions)]


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for source, target, draw in DRAWINGS:
        if (folder / source).exists():
            draw(read(folder / source), folder / target)


if __name__ == "__main__":
    main()
