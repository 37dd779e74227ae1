"""The suite's own reader of G-code: positions, lengths and filament, for absolute coordinates in millimetres."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import List, Tuple

import numpy as np

WORD = re.compile(r"([A-Z])\s*(-?\d*\.?\d+)")


@dataclass
class Print:
    """The print of a file: beads as pairs of ends, lengths, and the extruded filament after compensation of retractions."""
    beads: List[Tuple[Tuple[float, float, float], Tuple[float, float, float]]] = field(default_factory=list)
    extruded: float = 0.0
    travelled: float = 0.0
    filament: float = 0.0
    minutes: float = 0.0


def read(text: str) -> Print:
    """The print of a file, with the nozzle at (0, 0, 0) in the beginning."""
    found = Print()
    place = {"X": 0.0, "Y": 0.0, "Z": 0.0}
    pushed = furthest = 0.0
    speed = np.inf
    for line in text.splitlines():
        words = dict((letter, float(number)) for letter, number in WORD.findall(line.split(";")[0]))
        if "G" not in words:
            continue
        if words["G"] == 92:
            pushed = furthest = words.get("E", pushed)
        if words["G"] not in (0, 1):
            continue
        speed = words.get("F", speed)
        start = (place["X"], place["Y"], place["Z"])
        place.update({axis: words[axis] for axis in place if axis in words})
        end = (place["X"], place["Y"], place["Z"])
        length = float(np.linalg.norm(np.subtract(end, start)))
        push = words.get("E", pushed) - pushed
        pushed += push
        fresh = max(0.0, pushed - furthest)
        furthest = max(furthest, pushed)
        found.minutes += (length if length > 0 else abs(push)) / speed
        if length > 0 and fresh > 0:
            found.extruded += length
            found.beads.append((start, end))
        else:
            found.travelled += length
        found.filament += fresh
    return found
