#!/usr/bin/python3
"""Draws the inverse design benchmark's CSV files as SVG files beside them.

Usage: plot_designs.py [FOLDER]      default: docs/bench

designs-solvers.svg   performance profiles of solvers of the outer problem (Dolan and More 2002), a panel per task and
                      kind of target

A study whose CSV file is not there is left out.
"""

from __future__ import annotations

import sys
from collections import defaultdict
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from plotting import BLUE, OLIVE, ORANGE, RED, Row, grouped, read, save

SOLVERS = {"ours": ("ours", BLUE), "ceres_lm": ("Ceres, Levenberg-Marquardt", ORANGE),
           "ceres_dogleg": ("Ceres, dogleg", OLIVE), "lbfgsb": ("L-BFGS-B", RED)}
TASKS = {"stress_strain": "stress over strain", "stiffness": "directional stiffness", "poisson": "Poisson's ratio"}
TARGETS = {"design": "a design's own profile", "perturbed": "perturbed, out of reach"}
LARGEST_RATIO = 32.0


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


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for source, name, draw in (("designs-solvers-runs", "designs-solvers", draw_solvers),):
        if (folder / f"{source}.csv").exists():
            draw(read(folder / f"{source}.csv"), folder / f"{name}.svg")


if __name__ == "__main__":
    main()
