"""Whether a point of a surface is where an energy has a local minimum, by values of the energy alone."""

from __future__ import annotations

from typing import List

import numpy as np

from _surface import Point, Surface

SHARES = (1e-3, 1e-5, 1e-6)
"""How far a point is moved, in units of the diagonal. A place that is lower counts only if the way there is lower as well: beyond a ridge there may be another minimum."""


def surroundings(surface: Surface, point: Point, first_angle: float, directions: int = 8) -> List[Point]:
    """The places that a point is moved to: for each direction those of SHARES."""
    around = 2 * np.pi
    if "vertex" in point:
        around = float(surface.angles[point["vertex"]])
    return [surface.walk(point, first_angle + around * k / directions, share * surface.diagonal) for k in range(directions) for share in SHARES]


def steepest_descent(surface: Surface, energy: float, energies: np.ndarray) -> float:
    """The steepest descent among the directions that go down all the way, as energy for each mesh unit; 0 at a minimum."""
    falls = (energy - energies.reshape(-1, len(SHARES))) / (np.array(SHARES) * surface.diagonal)
    return float(max(0.0, falls.min(axis=1).max()))
