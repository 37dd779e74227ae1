"""The points of a mesh that are nearest to points in space, computed by the client."""

from __future__ import annotations

from typing import List, Tuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import Array
from .points import SurfacePoint

PAIRS_AT_A_TIME = 1_000_000
"""Pairs of points and faces that are computed together, which bounds memory."""


def _weights(p: Array, a: Array, b: Array, c: Array) -> Array:
    """Barycentric coordinates of the points of triangles abc that are nearest to p, by the region of the plane over which p
    lies [Ericson2005, section 5.1.5]. All arrays have the shape (..., 3)."""

    def dot(u: Array, v: Array) -> Array:
        return np.asarray(np.einsum("...i,...i->...", u, v), dtype=np.float64)

    ab, ac = b - a, c - a
    d1, d2 = dot(ab, p - a), dot(ac, p - a)
    d3, d4 = dot(ab, p - b), dot(ac, p - b)
    d5, d6 = dot(ab, p - c), dot(ac, p - c)
    va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
    with np.errstate(divide="ignore", invalid="ignore"):
        on_ab, on_ac = d1 / (d1 - d3), d2 / (d2 - d6)
        on_bc = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        v, w = vb / (va + vb + vc), vc / (va + vb + vc)
    zero, one = np.zeros_like(d1), np.ones_like(d1)
    regions = [
        ((d1 <= 0) & (d2 <= 0), (one, zero, zero)),
        ((d3 >= 0) & (d4 <= d3), (zero, one, zero)),
        ((d6 >= 0) & (d5 <= d6), (zero, zero, one)),
        ((vc <= 0) & (d1 >= 0) & (d3 <= 0), (1 - on_ab, on_ab, zero)),
        ((vb <= 0) & (d2 >= 0) & (d6 <= 0), (1 - on_ac, zero, on_ac)),
        ((va <= 0) & (d4 >= d3) & (d5 >= d6), (zero, 1 - on_bc, on_bc)),
    ]
    conditions = [condition for condition, _ in regions]
    inside = (1 - v - w, v, w)
    return np.stack(
        [np.select(conditions, [weights[i] for _, weights in regions], default=inside[i]) for i in range(3)], axis=-1
    )


def nearest_points(
    positions: Array, vertices: Array, faces: NDArray[np.int32]
) -> Tuple[List[SurfacePoint], Array, Array]:
    """For each of the positions, shape (n, 3): the nearest point of the mesh, its position, shape (n, 3), and its distance,
    shape (n,). Compares every position with every face, in O(n faces)."""
    a, b, c = vertices[faces[:, 0]], vertices[faces[:, 1]], vertices[faces[:, 2]]
    points: List[SurfacePoint] = []
    nearest_positions = np.empty_like(positions)
    distances = np.empty(len(positions))
    batch_size = max(1, PAIRS_AT_A_TIME // len(faces))
    for begin in range(0, len(positions), batch_size):
        batch = positions[begin : begin + batch_size, None, :]
        weights = _weights(batch, a, b, c)
        nearest = weights[..., :1] * a + weights[..., 1:2] * b + weights[..., 2:] * c
        squares = ((nearest - batch) ** 2).sum(axis=-1)
        best = squares.argmin(axis=1)
        for row, face in enumerate(best):
            wa, wb, wc = (float(weight) for weight in weights[row, face])
            points.append(SurfacePoint(int(face), (wa, wb, wc)))
            nearest_positions[begin + row] = nearest[row, face]
            distances[begin + row] = np.sqrt(squares[row, face])
    return points, nearest_positions, distances
