"""Energies of elastic networks from lengths alone, by the definitions in the documents."""

from __future__ import annotations

from typing import Any, List, Sequence

import numpy as np


def neo_hookean_triangles(sides: np.ndarray, at_rest: np.ndarray, mu: float, lame: float) -> np.ndarray:
    """Energies of flat triangles whose sides 01, 12 and 20 have the lengths `sides`, and `at_rest` at rest: the area at rest times the
    density mu / 2 (tr C - 2 - 2 log J) + lambda / 2 log(J)^2. Infinite if no triangle has such sides."""

    def metric(lengths: np.ndarray) -> np.ndarray:
        squares = lengths**2
        mixed = (squares[:, 0] + squares[:, 2] - squares[:, 1]) / 2
        return np.stack([np.stack([squares[:, 0], mixed], axis=1), np.stack([mixed, squares[:, 2]], axis=1)], axis=1)

    rest, now = metric(at_rest), metric(sides)
    ratio = np.linalg.det(now) / np.linalg.det(rest)
    trace = np.einsum("ijj->i", np.linalg.solve(rest, now))
    with np.errstate(invalid="ignore", divide="ignore"):
        log_j = np.log(ratio) / 2
        energy = np.sqrt(np.linalg.det(rest)) / 2 * (mu / 2 * (trace - 2 - 2 * log_j) + lame / 2 * log_j**2)
    return np.where(ratio > 0, energy, np.inf)


class Network:
    """The energies of springs and triangles as functions of the matrix of distances between points."""

    def __init__(self, springs: Sequence[Any], triangles: Sequence[Any], membrane: Any, at_rest: np.ndarray) -> None:
        self.ends = np.array([spring["between"] for spring in springs], dtype=int).reshape(-1, 2)
        self.rest_length = np.array([spring["rest_length"] for spring in springs], dtype=float)
        self.weight = np.array([spring.get("weight", 1) for spring in springs], dtype=float)
        self.triangles = np.array(triangles, dtype=int).reshape(-1, 3)
        self.membrane = membrane
        self.rest_sides = self._sides(self.triangles, at_rest) * (membrane["rest_scale"] if membrane else 1)

    @staticmethod
    def _sides(triangles: np.ndarray, distance: np.ndarray) -> np.ndarray:
        return np.stack([distance[triangles[:, i], triangles[:, (i + 1) % 3]] for i in range(3)], axis=1)

    @property
    def largest_weight(self) -> float:
        of_springs = float(self.weight.max(initial=0))
        return max(of_springs, self.membrane["youngs_modulus"] * self.membrane["thickness"]) if self.membrane else of_springs

    def spring_energies(self, distance: np.ndarray) -> np.ndarray:
        return self.weight * (distance[self.ends[:, 0], self.ends[:, 1]] - self.rest_length) ** 2

    def triangle_energies(self, distance: np.ndarray) -> np.ndarray:
        return self._of_triangles(self._sides(self.triangles, distance), self.rest_sides)

    def _of_triangles(self, sides: np.ndarray, at_rest: np.ndarray) -> np.ndarray:
        if not self.membrane or len(sides) == 0:
            return np.zeros(len(sides))
        young, nu = self.membrane["youngs_modulus"], self.membrane["poisson_ratio"]
        return self.membrane["thickness"] * neo_hookean_triangles(sides, at_rest, young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu)))

    def energy(self, distance: np.ndarray) -> float:
        return float(self.spring_energies(distance).sum() + self.triangle_energies(distance).sum())

    def energies_with(self, distance: np.ndarray, point: int, places: np.ndarray) -> np.ndarray:
        """The energies of the whole network if one point is moved to each of some places. The columns of `places` are their distances from all
        points."""
        touched = np.flatnonzero((self.ends == point).any(axis=1))
        others = self.ends[touched].sum(axis=1) - point
        before = self.spring_energies(distance)[touched].sum()
        now = (self.weight[touched, None] * (places[others] - self.rest_length[touched, None]) ** 2).sum(axis=0)
        of_triangles = np.flatnonzero((self.triangles == point).any(axis=1))
        if len(of_triangles):
            before += self.triangle_energies(distance)[of_triangles].sum()
            now = now + np.array([self._moved(distance, point, places[:, k], of_triangles) for k in range(places.shape[1])])
        return self.energy(distance) - before + now

    def _moved(self, distance: np.ndarray, point: int, place: np.ndarray, of_triangles: np.ndarray) -> float:
        moved = distance.copy()
        moved[point], moved[:, point] = place, place
        moved[point, point] = 0
        return float(self._of_triangles(self._sides(self.triangles[of_triangles], moved), self.rest_sides[of_triangles]).sum())

    def scale(self, distance: np.ndarray) -> float:
        """The scale of this network's energies: the energy of all springs stretched to twice their lengths, plus the membrane's stiffness times its
        area."""
        of_springs = float((self.weight * distance[self.ends[:, 0], self.ends[:, 1]] ** 2).sum())
        if not self.membrane:
            return of_springs
        rest = np.array(self.rest_sides)
        return of_springs + float(self.membrane["youngs_modulus"] * self.membrane["thickness"] * (rest[:, 0] * rest[:, 1]).sum() / 2)


def permuted(order: np.ndarray, items: Sequence[Any]) -> List[Any]:
    return [items[int(i)] for i in order]
