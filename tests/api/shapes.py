"""Generated meshes for which answers are known."""

from __future__ import annotations

from typing import Tuple

import numpy as np

Mesh = Tuple[np.ndarray, np.ndarray]


def flat_grid(cells: int, size: float = 1.0) -> Mesh:
    """A square of side `size` in the plane z = 0, cut into 2 cells^2 triangles: geodesics are straight lines."""
    x, y = np.meshgrid(np.linspace(0, size, cells + 1), np.linspace(0, size, cells + 1), indexing="ij")
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    i, j = np.meshgrid(np.arange(cells), np.arange(cells), indexing="ij")
    a = (i * (cells + 1) + j).ravel()
    b = a + cells + 1
    faces = np.concatenate([np.stack([a, b, b + 1], axis=1), np.stack([a, b + 1, a + 1], axis=1)])
    return vertices, faces


def sphere(subdivisions: int) -> Mesh:
    """An icosahedron that is subdivided n = `subdivisions` times, with its vertices on the unit sphere: 20 * 4^n faces."""
    g = (1 + 5**0.5) / 2
    vertices = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
                (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    points = np.asarray(vertices) / np.hypot(1, g)
    faces = np.array([(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
                      (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
                      (8, 6, 7), (9, 8, 1)])
    for _ in range(subdivisions):
        # The midpoints of edges become vertices, numbered in the order of their first occurrence in the faces.
        edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
        _, first, which = np.unique(edges[:, 0] * len(points) + edges[:, 1], return_index=True, return_inverse=True)
        number = np.empty(len(first), dtype=int)
        number[np.argsort(first)] = np.arange(len(first))
        (i, j, k), (a, b, c) = faces.T, (len(points) + number[which]).reshape(-1, 3).T
        middles = points[edges[np.sort(first)]].sum(axis=1)
        points = np.concatenate([points, middles / np.linalg.norm(middles, axis=1)[:, None]])
        faces = np.stack([i, a, c, j, b, a, k, c, b, a, b, c], axis=1).reshape(-1, 3)
    return points, faces


def torus(around: int, across: int) -> Mesh:
    """A torus of radii 1 and 0.4, cut into `around` rings of 2 `across` triangles."""
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    u, v = 2 * np.pi * i / around, 2 * np.pi * j / across
    vertices = np.stack([(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)], axis=1)
    number = lambda ring, place: ring % around * across + place % across  # noqa: E731
    a, b, c, d = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
    return vertices, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def bumpy_sphere(subdivisions: int, seed: int = 1) -> Mesh:
    """A sphere with waves, whose many saddle vertices make exact geodesics expensive."""
    vertices, faces = sphere(subdivisions)
    phase = np.random.default_rng(seed).uniform(0, 6.28, 3)
    waves = np.sin(9 * vertices[:, 0] + phase[0]) + np.sin(11 * vertices[:, 1] + phase[1]) + np.sin(8 * vertices[:, 2] + phase[2])
    return vertices * (1 + 0.08 * waves)[:, None], faces


def two_triangles_apart() -> Mesh:
    """Two components that no path joins."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 0, 0], [6, 0, 0], [5, 1, 0]], dtype=float)
    return vertices, np.array([[0, 1, 2], [3, 4, 5]])


def obj_text(mesh: Mesh) -> str:
    vertices, faces = mesh
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    return "\n".join(lines + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces.tolist()]) + "\n"

def exported_ring() -> Mesh:
    """A ring of 8 x 4 trapezoids with coordinates of four decimals, as CAD programs export them. Vertex 4 i + j is at angle i of the ring."""
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(8), np.arange(4), indexing="ij"))
    radius = 2 + 0.4 * np.cos(np.pi * j / 2)
    angle = np.pi * i / 4
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.4 * np.sin(np.pi * j / 2)], axis=1).round(4)

    a, b, c, d = ((i + across) % 8 * 4 + (j + along) % 4 for across, along in [(0, 0), (1, 0), (1, 1), (0, 1)])
    return vertices, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
