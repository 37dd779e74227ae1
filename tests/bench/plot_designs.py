#!/usr/bin/python3
"""Draws the inverse design benchmark's CSV files as SVG files beside them.

Usage: plot_designs.py [FOLDER]      default: docs/bench

designs-solvers.svg     performance profiles of solvers of the outer problem (Dolan and More 2002), a panel per task and
                        kind of target
designs-smoothness.svg  an objective along a line in parameter space by simulation and by the network, and the meshes
                        of three consecutive steps laid over each other

A study whose CSV file is not there is left out.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection

from plotting import BLUE, GREEN, OLIVE, ORANGE, RED, Row, grouped, numbers, read, save

SOLVERS = {"ours": ("ours", BLUE), "ceres_lm": ("Ceres, Levenberg-Marquardt", ORANGE),
           "ceres_dogleg": ("Ceres, dogleg", OLIVE), "lbfgsb": ("L-BFGS-B", RED)}
TASKS = {"stress_strain": "stress over strain", "stiffness": "directional stiffness", "poisson": "Poisson's ratio"}
TARGETS = {"design": "a design's own profile", "perturbed": "perturbed, out of reach"}
LARGEST_RATIO = 32.0
WINDOW = 1.5  # of the close-up of meshes: half its width in beam widths, as in design_smoothness.cpp


def time_ratios(rows: list[Row], key: str) -> tuple[dict[str, np.ndarray], int]:
    """Solver -> its times over those of the fastest on each problem that it solves, ascending; number of problems."""
    times: dict[tuple[str, str], dict[str, float]] = defaultdict(dict)
    for row in rows:
        times[row["family"], row["problem"]][row["solver"]] = np.inf if row[key] == "none" else float(row[key])
    ratios: dict[str, list[float]] = defaultdict(list)
    for of_problem in times.values():
        fastest = min(of_problem.values())
        for solver, time in of_problem.items():
            ratios[solver].append(time / fastest if np.isfinite(time) else np.inf)
    return {solver: np.sort(values) for solver, values in ratios.items()}, len(times)


def draw_solvers(rows: list[Row], target: Path) -> None:
    # Where equilibria have several branches the solvers did not see the same function.
    rows = [row for row in rows if row["place"] != "branches"]
    figure, panels = plt.subplots(len(TARGETS), len(TASKS), figsize=(11, 6.4), sharex=True, sharey=True)
    for panel_row, (kind, kind_name) in zip(panels, TARGETS.items()):
        of_kind = grouped(grouped(rows, "target")[kind], "task")
        for panel, (task, task_name) in zip(panel_row, TASKS.items()):
            for key, style in (("ms_to_least", "-"), ("ms_to_close", ":")):
                ratios, problems = time_ratios(of_kind[task], key)
                for solver, (name, colour) in SOLVERS.items():
                    within = ratios[solver][ratios[solver] <= LARGEST_RATIO]
                    share = 100 * np.arange(len(within) + 1) / problems
                    panel.step(np.concatenate([[1], within, [LARGEST_RATIO]]), np.append(share, share[-1]),
                               where="post", color=colour, linestyle=style, linewidth=1.5 if style == "-" else 1.2,
                               label=name if style == "-" else None)
            panel.set_title(f"{task_name}; {kind_name}", fontsize=9)
        panel_row[0].set_ylabel("share of problems solved, %")
    ticks = [1, 2, 4, 8, 16, 32]
    panels[0][0].set(xscale="log", xlim=(1, LARGEST_RATIO), ylim=(0, 102))
    panels[0][0].set_xticks(ticks, [str(t) for t in ticks])
    panels[0][0].minorticks_off()
    for panel in panels[-1]:
        panel.set_xlabel("CPU time over that of the fastest solver")
    panels[0][0].legend(fontsize=8, frameon=False, loc="lower right")
    save(figure, target)


def draw_smoothness(rows: list[Row], target: Path) -> None:
    sides = grouped(read(target.parent / "designs-smoothness-sides.csv"), "family")
    families = grouped(rows, "family")
    sources = {"data_set": ("simulation, data set's mesh", RED), "verification": ("simulation, finer mesh", ORANGE),
               "network": ("network", BLUE)}
    figure, panels = plt.subplots(2 * len(families), 2, figsize=(10.4, 9.2 * len(families)), squeeze=False)
    for top, bottom, (family, of_family) in zip(panels[::2], panels[1::2], families.items()):
        steps = sorted(grouped(of_family, "step").items(), key=lambda item: -float(item[0]))
        # Whole curves hide what shakes: beside them what they differ by from a smooth one.
        for panel, (step, points), order in ((top[0], steps[0], None), (top[1], steps[0], 3), (bottom[0], steps[1], 1)):
            index = np.array(numbers(points, "index"))
            for key, (name, colour) in sources.items():
                values = np.array(numbers(points, key))
                if order is None:
                    shown = 100 * values
                else:
                    shown = 1e6 * (values - np.polyval(np.polyfit(index, values, order), index)) / np.median(values)
                panel.plot(index, shown, color=colour, linewidth=1, marker=".", markersize=3, label=name)
            panel.set_title(f"{family}, steps of {float(step):g} of the parameters' ranges", fontsize=10)
            panel.set_xlabel("steps")
            panel.set_ylabel("objective, %" if order is None else
                             f"beside a {'cubic' if order == 3 else 'straight line'}, millionths of the objective")
        top[0].legend(fontsize=8, frameon=False)
        close_up = bottom[1]
        meshes = grouped(sides[family], "index")
        for (index, of_mesh), colour, width in zip(meshes.items(), (RED, GREEN, BLUE), (2.6, 1.5, 0.6)):
            x1, y1, x2, y2 = (numbers(of_mesh, key) for key in ("x1", "y1", "x2", "y2"))
            lines = LineCollection([((a, b), (c, d)) for a, b, c, d in zip(x1, y1, x2, y2)], colors=colour,
                                   linewidths=width, label=f"step {index}")
            close_up.add_collection(lines)
        close_up.set(xlim=(-WINDOW, WINDOW), ylim=(-WINDOW, WINDOW), aspect="equal", xlabel="beam widths")
        close_up.set_title(f"{family}, meshes of three steps of {float(sides[family][0]['step']):g}", fontsize=10)
        close_up.legend(fontsize=8, loc="upper left", framealpha=0.9)
    save(figure, target)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for source, name, draw in (("designs-solvers-runs", "designs-solvers", draw_solvers),
                               ("designs-smoothness-curves", "designs-smoothness", draw_smoothness)):
        if (folder / f"{source}.csv").exists():
            draw(read(folder / f"{source}.csv"), folder / f"{name}.svg")


if __name__ == "__main__":
    main()
