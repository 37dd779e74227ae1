#!/usr/bin/python3
"""Draws the neural benchmark's CSV files as SVG files beside them.

Usage: plot_neural.py [FOLDER]      default: docs/bench

models-activations.svg   second derivatives of networks with three activation functions, and the law's
models-singularity.svg   energy density and stress of the family "square" along p, by simulation and by the network
models-native-time.svg   milliseconds of an equilibrium over the strain
models-smoothness.svg    energy density and stress along a design parameter in small steps
models-cost.svg          error against seconds to train and microseconds to evaluate
models-data.svg          error against the number of designs
training-loss.svg        errors against the time of a training, by loss, optimizer and tangent term

A study whose CSV file is not there is left out.
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from plotting import BLUE, COLOURS, GREEN, GREY, ORANGE, RED, Row, grouped, numbers, read, save

ACTIVATIONS = {"swish": BLUE, "tanh": RED, "sine": ORANGE}
FORMS = {"sum_of_squares": "sum of squares", "softplus": "softplus"}


def draw_activations(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(2, 3, figsize=(11, 6))
    for panel_row, (form, of_form) in zip(panels, grouped(rows, "form").items()):
        curves = grouped(of_form, "curve")
        along, error, directional = panel_row
        for activation, points in grouped(curves["C_11"], "activation").items():
            strain, network, exact = (np.array(numbers(points, key)) for key in ("at", "network", "exact"))
            colour = ACTIVATIONS[activation]
            along.plot(strain, network, color=colour, linewidth=1.2, label=activation)
            error.plot(strain, 100 * (network / exact - 1), color=colour, linewidth=1.2)
        along.plot(strain, exact, color="black", linewidth=1, linestyle=":", label="exact")
        for activation, points in grouped(curves["directional"], "activation").items():
            angle, network, exact = (np.array(numbers(points, key)) for key in ("at", "network", "exact"))
            directional.plot(np.degrees(angle), 100 * (network / exact - 1), color=ACTIVATIONS[activation],
                             linewidth=1.2)
        along.set(ylabel=f"{FORMS[form]}\n$C_{{11}}$, MPa")
        along.set_yscale("log")
        error.set(ylabel="error of $C_{11}$, %")
        directional.set(ylabel="error of the directional stiffness, %", xticks=range(0, 181, 45))
        for panel in (error, directional):
            panel.axhline(0, color="black", linewidth=1, linestyle=":")
    for panel in panels[1][:2]:
        panel.set_xlabel("$E_{xx}$")
    panels[1][2].set_xlabel("direction, degrees")
    panels[0][0].legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_singularity(rows: list[Row], target: Path) -> None:
    windows = grouped(rows, "window")
    shown = {"whole": "all designs", "near": "where the inner void closes", "0": "around p = 0", "0.0424": "around p = 0.0424"}
    figure, panels = plt.subplots(2, len(shown), figsize=(3.1 * len(shown), 5.6))
    for column, (window, title) in enumerate(shown.items()):
        sources = grouped(windows[window], "source")
        coarse = window in ("whole", "near")
        for panel, key, label in ((panels[0][column], "energy", "energy density"), (panels[1][column], "stress", "$S_{xx}$")):
            middle = 0 if coarse else float(window)
            for source, colour in (("simulation", RED), ("network", BLUE)):
                p = np.array(numbers(sources[source], "p"))
                values = np.array(numbers(sources[source], key))
                if coarse:
                    panel.plot(p, values, color=colour, linewidth=1.2, marker="." if source == "simulation" else None,
                               linestyle="none" if source == "simulation" else "-", markersize=4, label=source)
                else:
                    # Each beside its own middle: what is shown is how it shakes, not how they differ.
                    relative = 1e6 * (values / np.median(values) - 1)
                    panel.plot(1e5 * (p - middle), relative, color=colour, linewidth=1, marker=".", markersize=2.5)
            if window == "whole":
                panel.set_yscale("log")
            if coarse:
                panel.set_ylabel(f"{label}, MPa")
                for edge in (0.0424, 0.9576) if window == "whole" else (0.0424,):
                    for side in (-edge, edge):
                        panel.axvline(side, color=GREY, linewidth=0.8, linestyle=":")
            else:
                panel.set_ylabel("change, millionths")
        panels[1][column].set_xlabel("p" if coarse else f"(p - {middle:g}) / 1e-5")
        panels[0][column].set_title(title, fontsize=10)
    panels[0][0].legend(fontsize=8, frameon=False)
    save(figure, target)


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


def draw_smoothness(rows: list[Row], target: Path) -> None:
    families = grouped(rows, "family")
    figure, panels = plt.subplots(2, 2 * len(families), figsize=(6.4 * len(families), 5.2), squeeze=False)
    column = 0
    for family, of_family in families.items():
        for step, points in grouped(of_family, "step").items():
            p = np.array(numbers(points, "p1"))
            x = (p - p[len(p) // 2]) / float(step)
            coarse = step == max(grouped(of_family, "step"), key=float)
            for panel, key, label in ((panels[0][column], "energy", "energy density"),
                                      (panels[1][column], "stress", "$S_{xx}$")):
                for source, colour, name in (("native", RED, "simulation"), ("network", BLUE, "network")):
                    values = np.array(numbers(points, f"{source}_{key}"))
                    # Each beside its own middle: the fine steps are far below the network's error. The coarse ones
                    # change by tenths, which would hide what shakes.
                    change = 100 * (values / values[len(values) // 2] - 1)
                    if coarse:
                        change -= np.polyval(np.polyfit(x, change, 3), x)
                    panel.plot(x, change, color=colour, linewidth=1, marker=".", markersize=3, label=name)
                panel.set_ylabel(f"{label}, " + ("% beside a cubic" if coarse else "change in %"), fontsize=9)
            panels[0][column].set_title(f"{family}, steps of {float(step):.1e}", fontsize=10)
            panels[1][column].set_xlabel("steps of $p_1$")
            column += 1
    figure.tight_layout(rect=(0, 0.05, 1, 1))
    figure.legend(*panels[0][0].get_legend_handles_labels(), loc="lower center", ncol=2, fontsize=9, frameon=False)
    save(figure, target, tight=False)


def draw_cost(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(1, 3, figsize=(11.4, 3.8), sharey=True)
    markers = dict(zip(grouped(rows, "width"), "osD^v"))
    for colour, (designs, points) in zip((ORANGE, GREEN, BLUE), grouped(rows, "designs").items()):
        error = numbers(points, "gradient_percent")
        for panel, key in ((panels[0], "training_seconds"), (panels[1], "microseconds")):
            panel.plot(numbers(points, key), error, color=colour, linewidth=1, label=f"{designs} designs")
            for row in points:
                panel.plot(float(row[key]), float(row["gradient_percent"]), color=colour,
                           marker=markers[row["width"]], markersize=5)
    for width, points in grouped(rows, "width").items():
        panels[2].plot(numbers(points, "designs"), numbers(points, "gradient_percent"), color=GREY, linewidth=1,
                       marker=markers[width], markerfacecolor="black", markeredgecolor="black", markersize=5,
                       label=f"width {width}")
    panels[0].set(xscale="log", yscale="log", xlabel="core-seconds to train",
                  ylabel="mean relative error of the stress, %")
    panels[1].set(xscale="log", xlabel="microseconds a strain, with tangent")
    panels[2].set(xscale="log", xlabel="designs trained on")
    designs = sorted({int(row["designs"]) for row in rows})
    panels[2].set_xticks(designs, [str(d) for d in designs])
    panels[2].minorticks_off()
    for panel, ticks in ((panels[0], (20, 50, 100, 200)), (panels[1], (5, 10, 20, 50))):
        panel.set_xticks(ticks, [str(t) for t in ticks])
        panel.minorticks_off()
    low, high = panels[0].get_ylim()
    ticks = [t for t in (0.5, 1, 2, 3, 4, 5, 7, 10, 15, 20, 30, 50, 100) if low <= t <= high]
    panels[0].set_yticks(ticks, [f"{t:g}" for t in ticks])
    panels[0].minorticks_off()
    panels[0].legend(fontsize=8, frameon=False)
    panels[2].legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_data(rows: list[Row], target: Path) -> None:
    figure, panel = plt.subplots(figsize=(4.6, 3.8))
    for colour, marker, (family, points) in zip((ORANGE, GREEN, BLUE), "osD", grouped(rows, "family").items()):
        designs = numbers(points, "designs")
        panel.plot(designs, numbers(points, "gradient_percent"), color=colour, marker=marker, markersize=5, linewidth=1,
                   label=f"{family}, mean")
        panel.plot(designs, numbers(points, "gradient_median"), color=colour, marker=marker, markersize=5, linewidth=1,
                   linestyle=":", label=f"{family}, median")
    panel.set(xscale="log", yscale="log", xlabel="designs trained on", ylabel="relative error of the stress, %")
    designs = sorted({int(row["designs"]) for row in rows})
    panel.set_xticks(designs, [str(d) for d in designs])
    low, high = panel.get_ylim()
    ticks = [t for t in (1, 2, 3, 4, 5, 7, 10, 15, 20, 30, 50) if low <= t <= high]
    panel.set_yticks(ticks, [f"{t:g}" for t in ticks])
    panel.minorticks_off()
    panel.legend(fontsize=8, frameon=False)
    save(figure, target)


def draw_training(rows: list[Row], target: Path) -> None:
    figure, panels = plt.subplots(1, 2, figsize=(8.6, 3.8), sharex=True)
    colours = {("robust", "soap"): BLUE, ("squared", "soap"): RED, ("robust", "adam"): GREEN, ("squared", "adam"): ORANGE}
    for row in rows:
        row["kind"] = f"{row['loss']} {row['optimizer']} {row['tangent']}"
    for kind, points in grouped(rows, "kind").items():
        loss, optimizer, tangent = kind.split()
        # Epochs are the same for all seeds: their times and errors are averaged.
        epochs = list(grouped(points, "epoch").values())
        seconds = [np.mean(numbers(of_epoch, "seconds")) for of_epoch in epochs]
        for panel, key in ((panels[0], "gradient_percent"), (panels[1], "stiffness_median")):
            panel.plot(seconds, [np.mean(numbers(of_epoch, key)) for of_epoch in epochs], linewidth=1.2,
                       color=colours[loss, optimizer], linestyle="--" if float(tangent) == 0 else "-",
                       label=f"{loss}, {optimizer}" + (", no tangents" if float(tangent) == 0 else ""))
    panels[0].set(yscale="log", xlabel="core-seconds", ylabel="mean relative error of the stress, %")
    panels[1].set(yscale="log", xlabel="core-seconds", ylabel="relative error of the stiffness, median, %")
    for panel in panels:
        low, high = panel.get_ylim()
        ticks = [t for t in (3, 5, 7, 10, 15, 20, 30, 50, 100) if low <= t <= high]
        panel.set_yticks(ticks, [f"{t:g}" for t in ticks])
        panel.minorticks_off()
    panels[0].legend(fontsize=7, frameon=False)
    save(figure, target)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "docs/bench")
    for source, name, draw in (("models-activations-curves", "models-activations", draw_activations),
                               ("models-singularity-curves", "models-singularity", draw_singularity),
                               ("models-native-time", "models-native-time", draw_native_time),
                               ("models-smoothness-curves", "models-smoothness", draw_smoothness),
                               ("models-cost", "models-cost", draw_cost),
                               ("models-data", "models-data", draw_data),
                               ("training-loss-curves", "training-loss", draw_training)):
        if (folder / f"{source}.csv").exists():
            draw(read(folder / f"{source}.csv"), folder / f"{name}.svg")


if __name__ == "__main__":
    main()
