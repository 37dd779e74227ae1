#!/usr/bin/python3
"""Digital weaves, computed by a running server: the page docs/weave-gallery.md with its pictures.

    tests/bench/weave_gallery.py [--server URL] [--out DIR] [NAME ...]

Names choose among the entries; the page is written only where all are made.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable, List, Tuple

import matplotlib.pyplot as plt
import numpy as np
from gallery import read_order
from plotting import BLUE, GREEN, GREY, ORANGE, PURPLE, RED
from weave_drawing import (REST, bare, draw_in_space, draw_layout, draw_polar, draw_repeated, draw_sheet, draw_strands,
                           height_bar, pull_arrows, same_scale, save_small)

import supple
from supple import Place, Support, Weave, WeaveOptions

DIRECTIONS = 200
TIMEOUT = 1800.0
STRAIN = 0.1
LARGE_STRAIN = 0.3
DIAGONAL = DIRECTIONS // 4  # index of 45 degrees
SQUARES = (1, 2, 3, 4)
LOAD_STEP = 0.02  # strain: in longer steps a weave that slides may come to another equilibrium
NEARLY_NOTHING = 1e-3


@dataclass
class Entry:
    """A picture and what to see in it."""

    name: str
    title: str
    make: Callable[[supple.Client, Path], str]


def number(value: float, digits: int = 3) -> str:
    """With so many significant digits, thousands separated."""
    if value == 0:
        return "0"
    decimals = max(0, digits - 1 - math.floor(math.log10(abs(value))))
    return f"{round(value, digits - 1 - math.floor(math.log10(abs(value)))):,.{decimals}f}"


def measured(value: float, unit: str, digits: int = 3) -> str:
    return f"less than {NEARLY_NOTHING:g} {unit}" if abs(value) < NEARLY_NOTHING else f"{number(value, digits)} {unit}"


def percent(share: float, decimals: int = 1) -> str:
    return f"{100 * share:.{decimals}f} %"


def homogenize(client: supple.Client, weave: Weave, strain: float, segments: int = 4,
               **more: Any) -> supple.WeaveHomogenization:
    options = WeaveOptions(load_steps=math.ceil(strain / LOAD_STEP), segments=segments)
    answer = client.weave_homogenization(weave, strain=strain, options=options, timeout=TIMEOUT,
                                         **{"directions": DIRECTIONS, **more})
    if not answer.converged:
        raise RuntimeError(answer.message)
    return answer


def polar_row(figure: plt.Figure, rows: int, columns: int, row: int) -> List[plt.Axes]:
    return [figure.add_subplot(rows, columns, row * columns + k + 1, projection="polar") for k in range(columns)]


def plain_row(figure: plt.Figure, rows: int, columns: int, row: int) -> List[plt.Axes]:
    return [figure.add_subplot(rows, columns, row * columns + k + 1) for k in range(columns)]


def draw_cell(axes: plt.Axes, cell: Any, times: int, direction: float) -> None:
    draw_repeated(axes, cell.strands, cell.lattice, times)
    pull_arrows(axes, direction)


def highest_point(state: supple.SheetState) -> float:
    return float(np.abs(state.crossings[:, 2]).max())


# One crossing


def crossing(client: supple.Client, path: Path) -> str:
    half, pushed = 20.0, 3.0
    strands = [supple.Strand([[-half, 0], [half, 0]]), supple.Strand([[0, -half], [0, half]])]
    supports = [Support(Place.strand(0, share=0.0), clamped=True), Support(Place.strand(0, share=1.0), clamped=True),
                Support(Place.strand(1, share=1.0), displacement=(0, pushed, 0))]
    figure, panels = plt.subplots(1, 2, figsize=(7.4, 3.6))
    forces: List[float] = []
    bends: List[float] = []
    for panel, name in zip(panels, ("fused", "sliding")):
        weave = Weave.layout(strands)
        if name == "sliding":
            weave = weave.slide(0, 1)
        answer = client.weave_simulation(weave, supports, options=WeaveOptions(out_of_plane="off", segments=16), timeout=TIMEOUT)
        if not answer.converged:
            raise RuntimeError(f"crossing {name}: {answer.message}")
        deformed = answer.states[-1].strands or ()
        forces.append(abs(float(answer.resultant(2)[-1][1])))
        bends.append(float(np.abs(deformed[0][:, 1]).max()))
        draw_strands(panel, [strand.polyline for strand in client.weave_layout(weave).strands], REST, 2.5)
        draw_strands(panel, deformed[:1], BLUE, 2.5)
        draw_strands(panel, deformed[1:], GREEN, 2.5)
        panel.annotate("", (0, half + pushed + 6), (0, half + pushed + 1), arrowprops={"arrowstyle": "-|>", "color": PURPLE})
        panel.set_title(f"{name}: {measured(forces[-1], 'N')}", fontsize=9)
        bare(panel)
    same_scale(panels)
    save_small(figure, path)
    # A beam clamped at both ends and pulled in its middle, for small deflections: F = 192 E I w / L^3.
    bending_stiffness = 3500 * math.pi * 0.25**4 / 4
    small = 192 * bending_stiffness * pushed / (2 * half) ** 3
    return (f"One strand (blue) is clamped at both ends; the one across it (green) is pulled along its axis by {pushed:g} mm. Fused, it "
            f"bends the other by {number(bends[0])} mm, at {number(forces[0])} N: the beam of small deflections would take "
            f"{number(small)} N, and the rest is its stretching. Sliding, it moves through, at {measured(forces[1], 'N')}, and the "
            f"other bends by {measured(bends[1], 'mm')}.")


# Regular weaves

BLOCKS: List[Tuple[str, Any]] = [
    ("all fused", "fused"),
    ("one slides", [["slides_x", "fused"], ["fused", "fused"]]),
    ("a row slides", [["slides_x", "slides_x"], ["fused", "fused"]]),
    ("two corners slide", [["slides_x", "fused"], ["fused", "slides_y"]]),
    ("one fused", [["fused", "slides_x"], ["slides_x", "slides_x"]]),
    ("all slide", "slides_x"),
]


def regular_cells(client: supple.Client, path: Path) -> str:
    figure = plt.figure(figsize=(11.5, 5.8))
    rows = [plain_row(figure, 3, len(BLOCKS), 0), polar_row(figure, 3, len(BLOCKS), 1), plain_row(figure, 3, len(BLOCKS), 2)]
    stiffness: List[float] = []
    along: List[float] = []
    for column, (name, block) in enumerate(BLOCKS):
        weave = Weave.regular(block)
        answer = homogenize(client, weave, STRAIN, deformed=[DIAGONAL])
        stiffness.append(float(answer.youngs_modulus[DIAGONAL]))
        along.append(float(answer.youngs_modulus[0]))
        draw_layout(rows[0][column], client.weave_layout(weave), 2.4)
        draw_polar(rows[1][column], [(answer.directions, answer.youngs_modulus, BLUE, name)], (0, 6))
        draw_cell(rows[2][column], answer.cells[0], 3, math.pi / 4)
        rows[0][column].set_title(name, fontsize=9)
        rows[2][column].set_title(f"{measured(stiffness[-1], 'N/m')} at 45°", fontsize=8, y=-0.24)
    save_small(figure, path)
    return (f"Regular weaves whose cell of 2 x 2 crossings has from none to four that slide (dots: fused; arrows: where a strand "
            f"slides); below, Young's modulus over direction at a strain of {percent(STRAIN, 0)} on a logarithmic scale (N/m), "
            f"and the cell pulled along 45°. Along the strands all have {number(min(along))} N/m, whatever the crossings (they "
            f"differ by {max(along) / min(along) - 1:.0e} of it). Along the diagonal it falls from {number(stiffness[0])} N/m where "
            f"all are fused to {number(stiffness[4])} N/m with one fused crossing in four; where all slide, strands turn and "
            f"nothing resists: {measured(stiffness[5], 'N/m')}.")


def regular_sheets(client: supple.Client, path: Path) -> str:
    count, pitch = 20, 4.5
    side = count * pitch
    supports = [Support(Place.box((-1, -1), (7, 7))),
                Support(Place.box((side - 7, side - 7), (side + 1, side + 1)), displacement=(-18, -18, -0.9))]
    outline = np.array([[0, 0], [side, 0], [side, side], [0, side]])
    states = []
    for connections in ("fused", "slides_x"):
        sheet = Weave.regular(connections, pitch=pitch, sheet=(count, count))
        answer = client.weave_simulation(sheet, supports, options=WeaveOptions(segments=2), timeout=TIMEOUT)
        if not answer.converged:
            raise RuntimeError(f"{connections}: {answer.message}")
        states.append((answer.states[-1], float(np.linalg.norm(answer.resultant(1)[-1]))))
    highest = max(highest_point(state) for state, _ in states)
    figure, panels = plt.subplots(1, 2, figsize=(9.6, 3.7), gridspec_kw={"left": 0.01, "right": 0.9, "wspace": 0.02,
                                                                          "bottom": 0.01, "top": 0.92})
    for panel, (state, force), name in zip(panels, states, ("all crossings fused", "all slide along x")):
        draw_in_space(panel, state.strands or (), -75, 32, highest, outline)
        panel.set_title(f"{name}: {number(force)} N", fontsize=9)
    same_scale(panels)
    height_bar(figure, list(panels), 0, highest)
    save_small(figure, path, tight=False)
    (fused, pull), (sliding, small_pull) = states
    return (f"A sheet of {count} x {count} strands is held at one corner, and the opposite corner is drawn towards it by 18 mm in x "
            f"and y (the shaded square is the sheet at rest). Fused, it bends out of its plane, by {number(highest_point(fused))} "
            f"mm, which takes {number(pull)} N and stores {number(fused.energy)} N mm. Where one strand of each crossing "
            f"slides, it shears in its plane and rises by no more than {number(highest_point(sliding), 2)} mm, at "
            f"{number(small_pull)} N and {number(sliding.energy)} N mm.")


# Squares


def squares_profiles(client: supple.Client, path: Path) -> str:
    figure = plt.figure(figsize=(10, 9.6))
    rows = [plain_row(figure, 4, 4, 0), polar_row(figure, 4, 4, 1), plain_row(figure, 4, 4, 2), plain_row(figure, 4, 4, 3)]
    facts: List[Tuple[float, float, float, float]] = []
    last: List[float] = []  # along both diagonals at the larger strain, of the type drawn last
    for column, kind in enumerate(SQUARES):
        weave = Weave.squares(kind)
        small = homogenize(client, weave, STRAIN, deformed=[DIAGONAL])
        large = homogenize(client, weave, LARGE_STRAIN)
        modulus = small.youngs_modulus
        facts.append((float(modulus.min()), float(modulus.max()), float(modulus[DIAGONAL]), float(modulus[3 * DIAGONAL])))
        last = [float(large.youngs_modulus[DIAGONAL]), float(large.youngs_modulus[3 * DIAGONAL])]
        draw_layout(rows[0][column], client.weave_layout(weave), 3)
        rows[0][column].set_title(f"type {kind}", fontsize=9)
        draw_polar(rows[1][column], [(small.directions, modulus, BLUE, "10 %"),
                                     (large.directions, large.youngs_modulus, ORANGE, "30 %")])
        degrees = np.degrees(small.directions)
        rows[2][column].plot(degrees, small.poisson_ratio, color=BLUE, linewidth=1.4)
        rows[2][column].plot(degrees, large.poisson_ratio, color=ORANGE, linewidth=1.4)
        rows[2][column].axhline(0, color=GREY, linewidth=0.6)
        rows[2][column].set_xticks([0, 45, 90, 135, 180])
        rows[2][column].tick_params(labelsize=7)
        draw_cell(rows[3][column], small.cells[0], 2, math.pi / 4)
    rows[1][0].legend(fontsize=7, frameon=False, loc=(-0.3, 0.92))
    rows[2][0].set_ylabel("Poisson's ratio", fontsize=8)
    rows[2][0].set_xlabel("direction, degrees", fontsize=8)
    save_small(figure, path)
    return (f"The four types of interlacing squares. From above: their cells; Young's modulus over direction at strains of 10 % and "
            f"30 % (N/m); Poisson's ratio; the cells pulled by 10 % along 45°. At 10 %, type 1, fused, lies between "
            f"{number(facts[0][0])} and {number(facts[0][1])} N/m. Type 2 slides along x: {number(facts[1][0], 2)} N/m there and up "
            f"to {number(facts[1][1])} N/m elsewhere. Type 3 is orthotropic, its diagonals alike ({number(facts[2][2])} and "
            f"{number(facts[2][3])} N/m). Type 4 has one corner fused: its diagonals differ, {number(facts[3][2])} against "
            f"{number(facts[3][3])} N/m, and at 30 % {number(last[0])} against {number(last[1])} N/m.")


def squares_locking(client: supple.Client, path: Path) -> str:
    strains = np.concatenate([np.linspace(0.02, 0.22, 11), np.linspace(0.225, 0.26, 15), np.linspace(0.27, 0.4, 14)])
    stress: List[float] = []
    for strain in strains:
        answer = homogenize(client, Weave.squares(2), float(strain), directions=[0.0])
        stress.append(float(answer.cauchy_stress[0, 0, 0]))
    profiles = [homogenize(client, Weave.squares(2), strain, deformed=[0]) for strain in (STRAIN, LARGE_STRAIN)]
    share, arm, period = 0.7, 3.0, 18.0
    lock = 2 * share * arm / period
    figure = plt.figure(figsize=(11.4, 3.2))
    curve = figure.add_subplot(1, 4, 1)
    curve.plot(100 * strains, stress, color=BLUE, linewidth=1.6)
    curve.axvline(100 * lock, color=RED, linewidth=0.8, linestyle=":")
    curve.set_xlabel("strain along x, %", fontsize=8)
    curve.set_ylabel("stress, N/m", fontsize=8)
    curve.tick_params(labelsize=7)
    polar = figure.add_subplot(1, 4, 2, projection="polar")
    draw_polar(polar, [(answer.directions, answer.youngs_modulus, colour, f"{100 * answer.strain:.0f} %")
                       for answer, colour in zip(profiles, (BLUE, ORANGE))])
    polar.legend(fontsize=7, frameon=False, loc=(-0.25, 0.95))
    for place, answer in zip((3, 4), profiles):
        panel = figure.add_subplot(1, 4, place)
        draw_cell(panel, answer.cells[0], 2, 0.0)
        panel.set_title(f"pulled by {100 * answer.strain:.0f} %", fontsize=8)
    same_scale(figure.axes[2:])
    save_small(figure, path)
    at = [float(np.interp(strain, strains, stress)) / strain for strain in (STRAIN, LARGE_STRAIN)]
    begin = float(strains[np.flatnonzero(np.array(stress) > 0.05 * max(stress))[0]])
    return (f"Squares of type 2, pulled along x. Their sliders have 2.1 mm on either side of a corner, so that a cell of 18 mm gives "
            f"way by 2 x 2.1 / 18 = {percent(lock)} (dotted) before they lock. The computed stress agrees: the secant modulus along x is "
            f"{number(at[0], 2)} N/m at 10 % and {number(at[1])} N/m at 30 %, and stress passes a twentieth of its value at 40 % "
            f"at a strain of {percent(begin)}. Right: the cell before and after it locked.")


def squares_sheets(client: supple.Client, path: Path) -> str:
    side, overlap, columns = 12.0, 3.6, 5
    length = columns * 2 * (side - overlap) - side + 2 * overlap
    pulled = 0.1 * length
    supports = [Support(Place.box((-1, -1), (0.1, length + 1))),
                Support(Place.box((length - 0.1, -1), (length + 1, length + 1)), displacement=(pulled, 0, 0))]
    figure, panels = plt.subplots(1, 4, figsize=(11, 3.2))
    forces: List[float] = []
    for panel, kind in zip(panels, SQUARES):
        sheet = Weave.squares(kind, side=side, overlap=overlap, sheet=(columns, columns))
        answer = client.weave_simulation(sheet, supports, options=WeaveOptions(out_of_plane="off"), timeout=TIMEOUT)
        if not answer.converged:
            raise RuntimeError(f"type {kind}: {answer.message}")
        forces.append(abs(float(answer.resultant(1)[-1][0])))
        draw_sheet(panel, [strand.polyline for strand in client.weave_layout(sheet).strands], answer.states[-1].strands or ())
        panel.set_title(f"type {kind}: {measured(forces[-1], 'N')}", fontsize=9)
    save_small(figure, path)
    return (f"Sheets of 5 x 5 and 4 x 4 squares, {number(length)} mm long, whose left side is held and whose right side is pulled by "
            f"10 % (grey: at rest). Type 1 takes {number(forces[0])} N, type 2 {measured(forces[1], 'N')}: its squares slide past "
            f"each other and none bends. Types 3 and 4 take {number(forces[2])} and {number(forces[3])} N.")


def strain_at_stress(client: supple.Client, weave: Weave, wanted: float, most: float) -> float:
    """The strain along the diagonal at which the nominal stress along it is as wanted, N/m."""
    along = np.full(2, math.sqrt(0.5))
    least = 0.0
    while most - least > 1e-3 * most:
        strain = (least + most) / 2
        answer = homogenize(client, weave, strain, directions=[math.pi / 4])
        enough = float(along @ answer.nominal_stress[0] @ along) >= wanted
        least, most = (least, strain) if enough else (strain, most)
    return most


def squares_diagonal(client: supple.Client, path: Path) -> str:
    wanted = 20.0
    figure, panels = plt.subplots(1, 4, figsize=(11, 3.2))
    strains: List[float] = []
    for panel, kind in zip(panels, SQUARES):
        weave = Weave.squares(kind)
        strains.append(strain_at_stress(client, weave, wanted, 0.4))
        cell = homogenize(client, weave, strains[-1], directions=[math.pi / 4], deformed=[0]).cells[0]
        draw_cell(panel, cell, 2, math.pi / 4)
        panel.set_title(f"type {kind}: {percent(strains[-1])}", fontsize=9)
    same_scale(panels)
    save_small(figure, path)
    return (f"The four types of squares under the same force along the diagonal, {wanted:g} N for each metre of width at rest. "
            f"They lengthen by {', '.join(percent(strain) for strain in strains[:3])} and {percent(strains[3])}: types 2 and 3, whose "
            f"strands slide at every crossing of two squares, give way by {number(min(strains[1:3]) / strains[0], 2)} to "
            f"{number(max(strains[1:3]) / strains[0], 2)} times as much as the fused type 1.")


# Circles and rings


def circles(client: supple.Client, path: Path) -> str:
    radius, distance, columns, rows, segments = 8.0, 14.4, 5, 6, 8
    width, height = columns * distance, (rows - 1) * distance
    force = 4.0
    lowest = Place.box((-radius, -0.5 * distance), (width, 0.45 * distance))
    highest = Place.box((-radius, height - 0.45 * distance), (width, height + 0.5 * distance))
    options = WeaveOptions(out_of_plane="off", segments=segments, load_steps=10)
    figure = plt.figure(figsize=(10.6, 5.8))
    profiles: List[np.ndarray] = []
    lengthened: List[float] = []
    for row, (kind, name) in enumerate(((1, "fused"), (2, "sliding"))):
        weave = Weave.circles(kind)
        answer = homogenize(client, weave, STRAIN, segments)
        profiles.append(answer.youngs_modulus)
        layout = figure.add_subplot(2, 4, 4 * row + 1)
        draw_layout(layout, client.weave_layout(weave), 2.6)
        layout.set_title(name, fontsize=9)
        polar = figure.add_subplot(2, 4, 4 * row + 2, projection="polar")
        draw_polar(polar, [(answer.directions, answer.youngs_modulus, BLUE, "")])
        ratio = figure.add_subplot(2, 4, 4 * row + 3)
        ratio.plot(np.degrees(answer.directions), answer.poisson_ratio, color=GREEN, linewidth=1.4)
        ratio.set_xticks([0, 45, 90, 135, 180])
        ratio.set_ylim(0.95, 1.3)
        ratio.tick_params(labelsize=7)
        ratio.set_title("Poisson's ratio", fontsize=8)
        sheet = Weave.circles(kind, circle_radius=radius, distance=distance, sheet=(columns, rows))
        rest = [strand.polyline for strand in client.weave_layout(sheet).strands]
        pulled = client.weave_simulation(sheet, [Support(lowest)], [supple.Force(highest, (0, force, 0))], options=options,
                                         timeout=TIMEOUT)
        if not pulled.converged:
            raise RuntimeError(f"circles {name}: {pulled.message}")
        deformed = pulled.states[-1].strands or ()
        before, after = np.concatenate(rest), np.concatenate([strand[:, :2] for strand in deformed])
        lengthened.append(float(np.ptp(after[:, 1]) / np.ptp(before[:, 1]) - 1))
        draw_sheet(figure.add_subplot(2, 4, 4 * row + 4), rest, deformed)
    same_scale([figure.axes[3], figure.axes[7]])
    save_small(figure, path)
    fused, sliding = profiles
    return (f"Interlacing circles: the cell, Young's modulus over direction (N/m) and Poisson's ratio at 10 %. Fused, they have "
            f"{number(float(fused.min()))} to {number(float(fused.max()))} N/m and the same along both diagonals; sliding, "
            f"{number(float(sliding.min()))} to {number(float(sliding.max()))} N/m, and {number(float(sliding[DIAGONAL]))} along "
            f"one diagonal against {number(float(sliding[3 * DIAGONAL]))} N/m along the other. Right: sheets of {columns} x {rows} "
            f"circles whose lowest row is held and whose highest is drawn up by {force:g} N (grey: at rest). Fused, the sheet "
            f"lengthens by {percent(lengthened[0])}, sliding by {percent(lengthened[1])}: circles become ovals that slide through each other.")


def circles_anisotropy(client: supple.Client, path: Path) -> str:
    strains = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3)
    count = 36
    ratios: List[List[float]] = [[], []]
    diagonals: List[float] = []
    figure, (curve, polar) = plt.subplots(1, 2, figsize=(8, 3.2))
    polar.remove()
    polar = figure.add_subplot(1, 2, 2, projection="polar")
    for row, (kind, name, colour) in enumerate(((1, "fused", GREY), (2, "sliding", BLUE))):
        for strain in strains:
            answer = homogenize(client, Weave.circles(kind), strain, 8, directions=count)
            modulus = answer.youngs_modulus
            ratios[row].append(float(modulus.max() / modulus.min()))
            if kind == 2:
                diagonals.append(float(modulus[count // 4] / modulus[3 * count // 4]))
        draw_polar(polar, [(answer.directions, modulus / modulus.max(), colour, name)])
        curve.plot([100 * strain for strain in strains], ratios[row], color=colour, marker="o", markersize=3, label=name)
    polar.set_title("at 30 %, over the greatest", fontsize=8)
    curve.plot([100 * strain for strain in strains], diagonals, color=ORANGE, linestyle="--", label="sliding: one diagonal over the other")
    curve.set_xlabel("strain, %", fontsize=8)
    curve.set_ylabel("greatest over least modulus", fontsize=8)
    curve.set_ylim(0, None)
    curve.legend(fontsize=7, frameon=False)
    curve.tick_params(labelsize=7)
    save_small(figure, path)
    (fused_first, *_, fused_last), (first, *_, last) = ratios
    return (f"How anisotropic are circles? The greatest modulus over the least is {number(fused_first)} for fused circles at a strain of "
            f"{percent(strains[0], 0)} and falls to {number(fused_last)} at {percent(strains[-1], 0)}. For sliding ones it is only "
            f"{number(first)} at first, since every direction bends the same arcs, and it grows to {number(last)} as the circles become "
            f"ovals and their crossings reach the limits of sliding. One diagonal is {number(diagonals[0])} times as stiff as the other at "
            f"{percent(strains[0], 0)} and {number(diagonals[-1])} times at {percent(strains[-1], 0)}: circles slide along one of them "
            f"only. So sliding makes circles highly anisotropic at large strains, and not at small ones.")


def rings(client: supple.Client, path: Path) -> str:
    push, steps = 12.5, 25
    weave = Weave.rings()
    rest = client.weave_layout(weave)
    pushed = len(rest.strands) - 1
    outer = 2
    supports = [Support(Place.strand(outer, share=0.75), clamped=True),
                Support(Place.strand(pushed, share=1.0), displacement=(0, push, 0))]
    answer = client.weave_simulation(weave, supports, states=steps, options=WeaveOptions(segments=8), timeout=TIMEOUT)
    if not answer.converged:
        raise RuntimeError(answer.message)
    pushes = [0.0] + [push * state.share for state in answer.states]
    heights = [0.0] + [highest_point(state) for state in answer.states]
    force = [0.0] + [float(reaction[1]) for reaction in answer.resultant(1)]
    figure, (curve, *views) = plt.subplots(1, 3, figsize=(10.6, 3.4), gridspec_kw={
        "width_ratios": [1, 1.1, 1.1], "wspace": 0.3, "left": 0.05, "right": 0.99, "bottom": 0.13, "top": 0.92})
    curve.plot(pushes, heights, color=BLUE, marker="o", markersize=3)
    curve.set_xlabel("the strand is pushed in by, mm", fontsize=8)
    curve.set_ylabel("height, mm", fontsize=8, color=BLUE)
    twin = curve.twinx()
    twin.plot(pushes, force, color=PURPLE, linewidth=1.2, linestyle="--")
    twin.set_ylabel("force on the strand, N", fontsize=8, color=PURPLE)
    circle = np.linspace(0, 2 * np.pi, 73)
    ground = 28 * np.column_stack([np.cos(circle), np.sin(circle)])
    for panel, index in zip(views, (steps // 4 - 1, steps - 1)):
        state = answer.states[index]
        draw_in_space(panel, state.strands or (), -60, 22, heights[-1], ground)
        panel.set_title(f"pushed in by {number(push * state.share)} mm", fontsize=8)
    same_scale(views)
    for axis in (curve, twin):
        axis.tick_params(labelsize=7)
    save_small(figure, path, tight=False)
    first = next(i for i, height in enumerate(heights) if height > 0.5)
    return (f"Three rings and their diameters are fused; one more strand is fused to the outer ring's top and slides through the rest. "
            f"The ring is clamped at the bottom, and the strand is pushed in there: the disc buckles and becomes a dome, "
            f"{number(heights[first])} mm high after {number(pushes[first])} mm, {number(heights[steps // 2])} mm after "
            f"{number(pushes[steps // 2])} mm and {number(heights[-1])} mm after {number(push)} mm, with a force of at most "
            f"{number(max(np.abs(force)), 2)} N.")


ENTRIES = [
    Entry("crossing", "One crossing, fused and sliding", crossing),
    Entry("regular-cells", "A regular weave, crossing by crossing", regular_cells),
    Entry("regular-sheets", "Fused sheets buckle, sliding ones shear", regular_sheets),
    Entry("squares-profiles", "Four kinds of interlacing squares", squares_profiles),
    Entry("squares-locking", "No stiffness at all, until the sliders lock", squares_locking),
    Entry("squares-diagonal", "Squares under the same force along the diagonal", squares_diagonal),
    Entry("squares-sheets", "Sheets of squares, pulled by 10 %", squares_sheets),
    Entry("circles", "Interlacing circles", circles),
    Entry("circles-anisotropy", "Circles become anisotropic when they lock", circles_anisotropy),
    Entry("rings", "Rings that rise", rings),
]

HEAD = """# Gallery of weaves

This page is generated by `tests/bench/weave_gallery.py` with a running server; the numbers in its sentences are from the answers.
How to ask for such weaves is in [digital weaves](weaves.md). Strands are 0.5 mm wide and of printed PLA; effects are the
defaults, sheets that are pulled in their plane stay in it, and cells are strained in load steps of at most 2 %.
"""


def main() -> int:
    order = read_order(__doc__ or "", "weaves")
    sections: List[str] = []
    with supple.Client(order.server) as client:
        for entry in ENTRIES:
            if not order.wants(entry.name):
                continue
            sentence = entry.make(client, order.pictures / f"{entry.name}.svg")
            print(sentence, flush=True)
            sections.append(f"## {entry.title}\n\n{sentence}\n\n![{entry.title}](images/weaves/{entry.name}.svg)\n")
    if len(sections) == len(ENTRIES):
        (order.docs / "weave-gallery.md").write_text(HEAD + "\n" + "\n".join(sections), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
