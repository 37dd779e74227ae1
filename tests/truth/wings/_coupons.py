"""A coupon between grips by finite elements of the suite's own: a mesh that fills the outline of the part, and its response to a test."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, Tuple

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu
from scipy.spatial import Delaunay, cKDTree
from shapely.geometry import Polygon

from _elements import PLACES, Cell

Array = Any
MAX_PASSES = 30
"""Largest number of passes in which sides of the outline that are no edges of the mesh are halved."""


def _divided(ring: Array, size: float) -> Array:
    """The corners of a closed ring, and points between them that are at most `size` apart."""
    corners = ring[:-1] if np.array_equal(ring[0], ring[-1]) else ring
    points: List[Array] = []
    for one, other in zip(corners, np.roll(corners, -1, axis=0)):
        count = max(1, int(np.ceil(np.linalg.norm(other - one) / size)))
        points.append(one + np.outer(np.arange(count) / count, other - one))
    return np.concatenate(points)


def _filling(part: Polygon, size: float) -> Array:
    """Points of a triangular grid over the part's bounding box."""
    low, high = np.array(part.bounds[:2]), np.array(part.bounds[2:])
    rows = np.arange(low[1], high[1], size * np.sqrt(3) / 2)
    columns = np.arange(low[0], high[0], size)
    return np.concatenate([np.stack([columns + (row % 2) * size / 2, np.full(len(columns), y)], axis=1) for row, y in enumerate(rows)])


def _inside(part: Polygon, points: Array) -> Array:
    """Whether each point lies within the part, by the number of sides to the right of it."""
    rings = [np.array(ring.coords) for ring in (part.exterior, *part.interiors)]
    starts = np.concatenate([ring[:-1] for ring in rings])
    ends = np.concatenate([ring[1:] for ring in rings])
    inside = np.zeros(len(points), dtype=bool)
    order = np.argsort(points[:, 1])
    heights = points[order, 1]
    for (ax, ay), (bx, by) in zip(starts, ends):
        if ay == by:
            continue
        first, last = np.searchsorted(heights, [min(ay, by), max(ay, by)])
        those = order[first:last]
        crossing = ax + (points[those, 1] - ay) * (bx - ax) / (by - ay)
        inside[those] ^= crossing > points[those, 0]
    return inside


def triangulated(part: Polygon, size: float) -> Tuple[Array, Array]:
    """Points and triangles that fill the part, with sides of about `size`. Each side of the part is a chain of edges of the mesh: it is halved
    until Delaunay's triangulation has its pieces."""
    rings = [_divided(np.array(ring.coords), size) for ring in (part.exterior, *part.interiors)]
    grid = _filling(part, size)
    grid = grid[_inside(part, grid)]
    for _ in range(MAX_PASSES):
        outline = np.concatenate(rings)
        away, _ = cKDTree(outline).query(grid)
        points = np.concatenate([outline, grid[away > 0.6 * size]])
        triangles = Delaunay(points).simplices
        sides = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
        edges = np.unique(sides[:, 0].astype(np.int64) * len(points) + sides[:, 1])
        whole, first, halved = True, 0, []
        for ring in rings:
            index = first + np.arange(len(ring))
            pairs = np.sort(np.stack([index, np.roll(index, -1)], axis=1), axis=1)
            there = np.isin(pairs[:, 0].astype(np.int64) * len(points) + pairs[:, 1], edges)
            middles = (ring + np.roll(ring, -1, axis=0)) / 2
            pieces = [np.stack([corner, middle]) if not found else corner[None] for corner, middle, found in zip(ring, middles, there)]
            halved.append(np.concatenate(pieces))
            whole = whole and bool(there.all())
            first += len(ring)
        if whole:
            middles = points[triangles].mean(axis=1)
            triangles = triangles[_inside(part, middles)]
            used, triangles = np.unique(triangles, return_inverse=True)
            return points[used], triangles.reshape(-1, 3)
        rings = halved
    raise ArithmeticError("a side of the part is no chain of edges of the mesh")


def quadratic(points: Array, triangles: Array) -> Tuple[Array, Array]:
    """The mesh with points in the middle of its edges, and six points for each triangle, counterclockwise."""
    corners = points[triangles]
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    turned = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] < 0
    triangles = np.where(turned[:, None], triangles[:, [0, 2, 1]], triangles)
    sides = np.sort(np.stack([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]], axis=1).reshape(-1, 2), axis=1)
    edges, index = np.unique(sides, axis=0, return_inverse=True)
    return np.concatenate([points, points[edges].mean(axis=1)]), np.concatenate([triangles, len(points) + index.reshape(-1, 3)], axis=1)


@dataclass
class Linear:
    """The law of a homogeneous sheet at small strains: P = C : (sym F - 1), where C is d (S_xx, S_yy, S_xy) / d (E_xx, E_yy, 2 E_xy)."""
    tangent: Array

    def respond(self, f: Array) -> Tuple[Array, Array, Array]:
        place = np.array([[0, 2], [2, 1]])
        modulus = self.tangent[place][:, :, place]
        strain = (f + np.swapaxes(f, -1, -2)) / 2 - np.eye(2)
        stress = np.einsum("ijkl,...kl->...ij", modulus, strain)
        return np.einsum("...ij,...ij->...", stress, strain) / 2, stress, np.broadcast_to(modulus, (*f.shape[:-2], 2, 2, 2, 2))


@dataclass
class Tested:
    """A state of the test: nominal strains of the middle half and between the grips, force over the width in N/mm for 1 mm of thickness."""
    strain: float
    between_grips: float
    force: float


class Coupon:
    """The mesh of a coupon. Nodes in its grips move with them."""

    def __init__(self, part: Polygon, grip: float, size: float) -> None:
        self.points, self.triangles = quadratic(*triangulated(part, size))
        low, high = part.bounds[1] + grip, part.bounds[3] - grip
        self.width, self.length = part.bounds[2] - part.bounds[0], high - low
        self.lower = self.points[:, 1] <= low + 1e-9
        self.upper = self.points[:, 1] >= high - 1e-9
        middle, y = (low + high) / 2, self.points[:, 1]
        self.gauge = np.abs(y - middle) <= self.length / 4
        corners = self.points[self.triangles[:, :3]]
        sides = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1)
        inverse = np.linalg.inv(sides)
        slopes = np.stack([-inverse[:, 0] - inverse[:, 1], inverse[:, 0], inverse[:, 1]], axis=1)
        self.slope = np.stack([Cell._slope(slopes, place) for place in PLACES], axis=1)
        self.weight = np.repeat(np.linalg.det(sides)[:, None] / 6, 3, axis=1)
        count = 2 * len(self.points)
        self.unknowns = (2 * self.triangles[:, :, None] + np.arange(2)).reshape(len(self.triangles), 12)
        self.free = np.flatnonzero(np.repeat(~(self.lower | self.upper), 2))
        self.count = count

    def stretched(self, law: Any) -> Tested:
        """The linear response at rest, for a strain between the grips of 1."""
        moved = self._advanced(law, self.points, 1.0) - self.points
        matrix = self._response(law, self.points, stiffness=True)[2]
        return self._state(self.points + moved, matrix @ moved.reshape(-1), 1.0)

    def _advanced(self, law: Any, positions: Array, more: float) -> Array:
        """The positions after a further strain between the grips, by the tangent of the present ones."""
        moved = np.zeros_like(positions)
        moved[self.upper, 1] = more * self.length
        matrix = self._response(law, positions, stiffness=True)[2]
        moved.reshape(-1)[self.free] = -self._solved(matrix, matrix @ moved.reshape(-1))
        return positions + moved

    def _solved(self, matrix: Any, forces: Array) -> Array:
        inner = matrix[self.free][:, self.free].tocsc()
        return splu(inner, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}).solve(forces[self.free])

    def _response(self, law: Any, positions: Array, stiffness: bool = False) -> Tuple[float, Array, Any]:
        """The energy, which is infinite where an element has turned over, its gradient and, if it is wanted, its Hessian."""
        f = np.einsum("tni,tqnj->tqij", positions[self.triangles], self.slope)
        if np.min(np.linalg.det(f)) <= 0:
            return np.inf, np.zeros(self.count), None
        psi, stress, modulus = law.respond(f)
        forces = np.einsum("tq,tqij,tqnj->tni", self.weight, stress, self.slope).reshape(-1)
        total = np.bincount(self.unknowns.reshape(-1), forces, self.count)
        if not stiffness:
            return float(np.sum(self.weight * psi)), total, None
        blocks = np.einsum("tq,tqijkl,tqnj,tqml->tnimk", self.weight, modulus, self.slope, self.slope, optimize=True).reshape(-1, 12, 12)
        rows = np.broadcast_to(self.unknowns[:, :, None], blocks.shape).ravel()
        columns = np.broadcast_to(self.unknowns[:, None, :], blocks.shape).ravel()
        return float(np.sum(self.weight * psi)), total, coo_matrix((blocks.ravel(), (rows, columns)), shape=(self.count, self.count)).tocsr()

    def _state(self, positions: Array, forces: Array, strain: float) -> Tested:
        force = float(forces.reshape(-1, 2)[self.upper, 1].sum())
        x, y = self.points[self.gauge].T
        moved = positions[self.gauge, 1] - y
        fit, *_ = np.linalg.lstsq(np.stack([np.ones_like(x), x - x.mean(), y - y.mean()], axis=1), moved, rcond=None)
        return Tested(float(fit[2]), strain, force / self.width)
