"""A test, by values of the energy alone, whether a point of a surface is a local minimum."""

from __future__ import annotations

from typing import List

import numpy as np

from _surface import Point, Surface

SHARES = (1e-3, 1e-5, 1e-6)
"""Distances by which a point is moved, in units of the diagonal. A lower energy at a distance is a descent only if the energy is lower at the
smaller distances as well, since there may be another minimum beyond a ridge."""


def surroundings(surface: Surface, point: Point, first_angle: float, directions: int = 8) -> List[Point]:
    """The places to which a point is moved: for each direction those at the distances of SHARES."""
    around = 2 * np.pi
    if "vertex" in point:
        around = float(surface.angles[point["vertex"]])
    return [surface.walk(point, first_angle + around * k / directions, share * surface.diagonal) for k in range(directions) for share in SHARES]


def steepest_descent(surface: Surface, energy: float, energies: np.ndarray) -> float:
    """The steepest descent, energy per mesh unit, of the directions in which the energy is lower at all distances; 0 at a minimum."""
    falls = (energy - energies.reshape(-1, len(SHARES))) / (np.array(SHARES) * surface.diagonal)
    return float(max(0.0, falls.min(axis=1).max()))
