"""What the scripts that draw the benchmarks' CSV files share."""

from __future__ import annotations

import csv
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt

Row = dict[str, str]
BLUE, RED, OLIVE, PURPLE, ORANGE, GREEN, GREY = (
    "#1b6ca8", "#d1495b", "#8a8d62", "#6b4e9b", "#d98e32", "#2a9d8f", "#9a9a9a")
COLOURS = [BLUE, RED, OLIVE, PURPLE, ORANGE, GREEN, "#444444", "#b07aa1"]

matplotlib.rcParams["svg.hashsalt"] = "supple"  # the same file for the same numbers


def read(path: Path) -> list[Row]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def grouped(rows: Iterable[Row], key: str) -> dict[str, list[Row]]:
    """Value of the column `key` -> its rows, in the order of the file."""
    groups: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        groups[row[key]].append(row)
    return groups


def numbers(rows: Iterable[Row], key: str) -> list[float]:
    return [float(row[key]) for row in rows]


def save(figure: plt.Figure, target: Path, tight: bool = True) -> None:
    if tight:
        figure.tight_layout()
    figure.savefig(target, metadata={"Date": None})
    plt.close(figure)
    print(target)
