"""Plane finite elements for large strains: quadratic triangles of a periodic cell, in a program that is as short as possible.

A point X of the cell moves to F X + w, where w is periodic. The energy is integrated with three points in each triangle and
divided by the area of the whole cell, holes included.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any, Dict, Tuple

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

Array = Any
SAME_NODE = 1e-6
"""Tolerance, in lattice coordinates, within which points of a mesh at rest that differ by a lattice vector are one node."""
PLACES = np.array([[2 / 3, 1 / 6, 1 / 6], [1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]])
"""The integration points of a triangle in barycentric coordinates; the weight of each is a third of the area."""


@dataclass
class Law:
    """A plane hyperelastic law: energy density, first Piola-Kirchhoff stress and its derivative, for arrays of F."""
    name: str
    youngs_modulus: float
    poisson_ratio: float

    def respond(self, f: Array) -> Tuple[Array, Array, Array]:
        identity = np.eye(2)
        j = np.linalg.det(f)
        g = np.swapaxes(np.linalg.inv(f), -1, -2)
        trace = np.einsum("...ij,...ij->...", f, f)
        kept = np.einsum("ik,jl->ijkl", identity, identity)
        turned = np.einsum("...il,...kj->...ijkl", g, g)
        spread = np.einsum("...ij,...kl->...ijkl", g, g)
        log = np.log(j)
        if self.name == "incompressible_plane_stress":
            mu = self.youngs_modulus / 3
            thin = (j ** -2)[..., None, None]
            return (mu / 2 * (trace + j ** -2 - 3), mu * (f - thin * g),
                    mu * (kept + thin[..., None, None] * (turned + 2 * spread)))
        mu = self.youngs_modulus / (2 * (1 + self.poisson_ratio))
        lam = self.youngs_modulus * self.poisson_ratio / ((1 + self.poisson_ratio) * (1 - 2 * self.poisson_ratio))
        pressure = (lam * log)[..., None, None]
        return (mu / 2 * (trace - 2 - 2 * log) + lam / 2 * log ** 2, mu * f + (pressure - mu) * g,
                mu * kept + (mu - pressure)[..., None, None] * turned + lam * spread)


class Cell:
    """The mesh of a periodic patch at rest from an answer of the server, which has points on both of two opposite sides."""

    def __init__(self, mesh: Dict[str, Any]) -> None:
        self.points = np.array(mesh["points"])
        self.triangles = np.array(mesh["triangles"])
        self.lattice = np.array(mesh["lattice"])
        self.area = abs(np.linalg.det(self.lattice))
        shares = self.points @ np.linalg.inv(self.lattice)
        wrapped = np.mod(shares, 1.0)
        wrapped[wrapped >= 1.0] = 0.0
        pairs = cKDTree(wrapped, boxsize=1.0).query_pairs(SAME_NODE, output_type="ndarray")
        count = len(self.points)
        same = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
        self.nodes, self.node = connected_components(same, directed=False)
        first = np.full(self.nodes, -1)
        first[self.node[::-1]] = np.arange(count)[::-1]
        self.first = first
        self.shift = np.rint(shares - shares[first[self.node]]).astype(int)
        """For each point the lattice vector, in translations, from the point that represents its node."""
        corners = self.points[self.triangles[:, :3]]
        sides = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1)
        inverse = np.linalg.inv(sides)
        slopes = np.stack([-inverse[:, 0] - inverse[:, 1], inverse[:, 0], inverse[:, 1]], axis=1)
        self.slope = np.stack([self._slope(slopes, place) for place in PLACES], axis=1)
        """Derivatives of the six shape functions by X, at each integration point of each triangle."""
        self.weight = np.repeat(np.linalg.det(sides)[:, None] / 6, 3, axis=1)

    @staticmethod
    def _slope(slopes: Array, place: Array) -> Array:
        corner = [(4 * place[i] - 1) * slopes[:, i] for i in range(3)]
        middle = [4 * (place[i] * slopes[:, j] + place[j] * slopes[:, i]) for i, j in ((0, 1), (1, 2), (2, 0))]
        return np.stack(corner + middle, axis=1)


@dataclass
class Response:
    """The response of a cell at given positions, per area of the cell: P = d psi / d F if the positions are an equilibrium."""
    energy: float
    nominal: Array
    decrement: float
    """Reduction of the energy by one more step of Newton's method."""
    corrected: Array
    """P after that step."""
    modulus: Array
    """d P / d F of the equilibrium, by indices i, j, k, l."""
    matrix: Any
    smallest_jacobian: float


def _assembled(cell: Cell, blocks: Array, signs: Array) -> csc_matrix:
    """The sum of the triangles' stiffnesses. `signs` has for each point of the mesh the sign of its displacement relative to that
    of its node."""
    unknowns = (2 * cell.node[cell.triangles][:, :, None] + np.arange(2)).reshape(len(cell.triangles), 12)
    sign = np.repeat(signs[cell.triangles], 2, axis=1)
    values = blocks * sign[:, :, None] * sign[:, None, :]
    rows = np.broadcast_to(unknowns[:, :, None], values.shape).ravel()
    columns = np.broadcast_to(unknowns[:, None, :], values.shape).ravel()
    return coo_matrix((values.ravel(), (rows, columns)), shape=(2 * cell.nodes, 2 * cell.nodes)).tocsc()


def _factor(matrix: csc_matrix) -> Any:
    """The factorization L D L^T without row exchanges, so that there are as many negative pivots as negative eigenvalues."""
    return splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})


def negative_pivots(matrix: csc_matrix) -> int:
    return int(np.sum(_factor(matrix).U.diagonal() < 0))


def respond(cell: Cell, law: Law, positions: Array) -> Response:
    """The response if the points of the mesh are at `positions`."""
    f = np.einsum("tni,tqnj->tqij", positions[cell.triangles], cell.slope)
    psi, stress, modulus = law.respond(f)
    weight = cell.weight / cell.area
    energy = float(np.sum(weight * psi))
    nominal = np.einsum("tq,tqij->ij", weight, stress)
    forces = np.einsum("tq,tqij,tqnj->tni", weight, stress, cell.slope).reshape(-1)
    unknowns = (2 * cell.node[cell.triangles][:, :, None] + np.arange(2)).reshape(-1)
    gradient = np.bincount(unknowns, forces, 2 * cell.nodes)
    blocks = np.einsum("tq,tqijkl,tqnj,tqml->tnimk", weight, modulus, cell.slope, cell.slope, optimize=True).reshape(-1, 12, 12)
    mixed = np.einsum("tq,tqijkl,tqnj->tnikl", weight, modulus, cell.slope, optimize=True).reshape(-1, 4)
    coupling = np.stack([np.bincount(unknowns, mixed[:, column], 2 * cell.nodes) for column in range(4)], axis=1)
    matrix = _assembled(cell, blocks, np.ones(len(cell.points)))
    held = matrix[2:, 2:].tocsc()  # The first node is fixed, since a translation of all nodes has no energy.
    solver = splu(held)
    step = solver.solve(gradient[2:])
    along = solver.solve(coupling[2:])
    macroscopic = np.einsum("tq,tqijkl->ijkl", weight, modulus).reshape(4, 4) - coupling[2:].T @ along
    corrected = nominal - (coupling[2:].T @ step).reshape(2, 2)
    return Response(energy, nominal, float(gradient[2:] @ step) / 2, corrected, macroscopic.reshape(2, 2, 2, 2),
                    (blocks, held), float(np.min(_corner_jacobians(cell, positions))))


def _corner_jacobians(cell: Cell, positions: Array) -> Array:
    """det F at the corners of the triangles. Its least value in a triangle is at most the least of these."""
    corners = cell.points[cell.triangles[:, :3]]
    sides = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=-1)
    inverse = np.linalg.inv(sides)
    slopes = np.stack([-inverse[:, 0] - inverse[:, 1], inverse[:, 0], inverse[:, 1]], axis=1)
    slope = np.stack([Cell._slope(slopes, place) for place in np.eye(3)], axis=1)
    return np.linalg.det(np.einsum("tni,tqnj->tqij", positions[cell.triangles], slope))


def unstable_modes(cell: Cell, response: Response, alternating: bool) -> int:
    """Number of modes that lower the energy at a given F: those of the patch and, if `alternating`, those that alternate from cell
    to cell."""
    blocks, held = response.matrix
    count = negative_pivots(held)
    if alternating:
        for signs in itertools.product((0, 1), repeat=2):
            if any(signs):
                count += negative_pivots(_assembled(cell, blocks, np.where((cell.shift @ np.array(signs)) % 2 == 0, 1.0, -1.0)))
    return count


def second_stress(f: Array, nominal: Array) -> Array:
    """The second Piola-Kirchhoff stress as (S_xx, S_yy, S_xy)."""
    stress = np.linalg.solve(f, nominal)
    return np.array([stress[0, 0], stress[1, 1], (stress[0, 1] + stress[1, 0]) / 2])


def tangent_of(f: Array, nominal: Array, modulus: Array) -> Array:
    """d (S_xx, S_yy, S_xy) / d (E_xx, E_yy, 2 E_xy), from d P / d F and P = F S."""
    inverse = np.linalg.inv(f)
    stress = inverse @ nominal
    rest = modulus - np.einsum("ik,lj->ijkl", np.eye(2), stress)
    full = np.einsum("ai,ijkl,bk->ajbl", inverse, rest, inverse)
    full = (full + np.swapaxes(full, 2, 3)) / 2
    full = (full + np.swapaxes(full, 0, 1)) / 2
    pairs = ((0, 0), (1, 1), (0, 1))
    return np.array([[full[a, j, b, l] for b, l in pairs] for a, j in pairs])


def broken_periods(cell: Cell, positions: Array, f: Array) -> float:
    """The largest difference of w between points of one node, over the size of the cell."""
    moved = positions - cell.points @ f.T
    return float(np.max(np.abs(moved - moved[cell.first[cell.node]])) / np.sqrt(cell.area))
