"""Random small meshes, some of which have distances in closed form, and other representations of the same mesh."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Tuple

import numpy as np

from _surface import Point, Surface

Arrays = Tuple[np.ndarray, np.ndarray]


def rotation(rng: np.random.Generator) -> np.ndarray:
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def grid_faces(rows: int, columns: int, wrap_rows: bool, wrap_columns: bool, rng: Optional[np.random.Generator] = None) -> np.ndarray:
    """Triangles of a grid of rows x columns vertices, closed in the directions in which it wraps. With `rng` the diagonals are random, otherwise
    all the same."""
    faces = []
    for i in range(rows if wrap_rows else rows - 1):
        for j in range(columns if wrap_columns else columns - 1):
            a, b = i * columns + j, (i + 1) % rows * columns + j
            c, d = (i + 1) % rows * columns + (j + 1) % columns, i * columns + (j + 1) % columns
            faces += [[a, b, c], [a, c, d]] if rng is None or rng.random() < 0.5 else [[a, b, d], [b, c, d]]
    return np.array(faces)


def ball(rng: np.random.Generator, halvings: int, noise: float, stretch: float) -> Arrays:
    g = (1 + 5**0.5) / 2
    points = np.array([(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
                       (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]) / np.hypot(1, g)
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6), (7, 1, 8),
             (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    made = list(points)
    for _ in range(halvings):
        middles: Dict[Tuple[int, int], int] = {}

        def middle(a: int, b: int) -> int:
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(made)
                made.append((made[a] + made[b]) / np.linalg.norm(made[a] + made[b]))
            return middles[key]

        faces = [t for a, b, c in faces for ab, bc, ca in [(middle(a, b), middle(b, c), middle(c, a))]
                 for t in [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]]
    vertices = np.array(made) * (1 + noise * rng.uniform(-1, 1, (len(made), 1)))
    return vertices * np.array([1, 1, stretch]) @ rotation(rng).T, np.array(faces)


def torus(rows: int, columns: int, tube: float, noise: float, rng: np.random.Generator) -> Arrays:
    i, j = (at.ravel() for at in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    u, v = 2 * np.pi * i / rows, 2 * np.pi * j / columns
    radius = 1 + tube * np.cos(v)
    vertices = np.stack([radius * np.cos(u), radius * np.sin(u), tube * np.sin(v)], axis=1)
    return vertices + noise * tube * rng.uniform(-1, 1, vertices.shape), grid_faces(rows, columns, True, True)


def sheet(rng: np.random.Generator, rows: int, columns: int, height: float, hole: bool) -> Arrays:
    """A height field with a boundary, perhaps with a hole."""
    i, j = (at.ravel() for at in np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"))
    vertices = np.stack([i, j, height * rng.normal(size=i.size)], axis=1).astype(float)
    faces = grid_faces(rows, columns, False, False, rng)
    if hole:  # a rectangle of the grid's cells, surrounded by at least one ring of cells
        low = [int(rng.integers(1, size - 2)) for size in (rows, columns)]
        high = [int(rng.integers(least + 1, size - 1)) for least, size in zip(low, (rows, columns))]
        middle = vertices[faces][:, :, :2].mean(axis=1)
        faces = faces[~((middle > low) & (middle < high)).all(axis=1)]
        used = np.unique(faces)
        renumbered = np.full(len(vertices), -1)
        renumbered[used] = np.arange(len(used))
        vertices, faces = vertices[used], renumbered[faces]
    return vertices @ rotation(rng).T, faces


def folded(rng: np.random.Generator, tube: bool) -> Tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """A rectangle folded along parallel lines, or a prism without ends: vertices, faces, the positions of the faces' corners in the plane, and
    the circumference of the prism (0 for the rectangle). Distances are those in the plane."""
    rows, columns = int(rng.integers(3, 8)), int(rng.integers(2, 5))
    v = np.sort(rng.uniform(0, 1, columns))
    v = (v - v[0]) / max(v[-1] - v[0], 1e-9) * rng.uniform(0.5, 3) + 0.05 * np.arange(columns)
    if tube:
        around = 2 * np.pi * (np.arange(rows) + rng.uniform(-0.3, 0.3, rows)) / rows
        section = np.stack([np.cos(around), rng.uniform(0.5, 1) * np.sin(around)], axis=1)
        steps = np.linalg.norm(np.roll(section, -1, axis=0) - section, axis=1)
        u = np.concatenate([[0], np.cumsum(steps[:-1])])
        round_it = float(steps.sum())
    else:
        steps, angles = rng.uniform(0.3, 1, rows - 1), np.cumsum(rng.uniform(-1.2, 1.2, rows - 1))
        section = np.concatenate([np.zeros((1, 2)), np.cumsum(steps[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1), axis=0)])
        u, round_it = np.concatenate([[0], np.cumsum(steps)]), 0.0
    vertices = np.array([[*section[i], v[j]] for i in range(rows) for j in range(columns)])
    faces = grid_faces(rows, columns, tube, False, rng)
    row = faces // columns
    corners = np.stack([u[row], v[faces % columns]], axis=2)
    if tube:  # the faces after the last row end at the first row
        last = (row == rows - 1).any(axis=1) & (row == 0).any(axis=1)
        corners[..., 0] += np.where(last[:, None] & (row == 0), round_it, 0)
    return vertices @ rotation(rng).T, faces, corners, round_it


def any_mesh(rng: np.random.Generator) -> Tuple[str, Arrays]:
    """A small mesh of any kind except folded ones: closed or open, convex or with many saddles, with well-shaped or thin triangles."""
    kind = str(rng.choice(["tetrahedron", "ball", "bumpy ball", "torus", "sheet", "sheet with a hole"]))
    if kind == "tetrahedron":
        vertices = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) + rng.uniform(-0.4, 0.4, (4, 3))
        return kind, (vertices * np.array([1, 1, rng.uniform(0.3, 2)]), np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]))
    if kind == "ball":
        return kind, ball(rng, int(rng.integers(0, 2)), 0, float(rng.uniform(0.3, 4)))
    if kind == "bumpy ball":
        return kind, ball(rng, int(rng.integers(0, 2)), float(rng.uniform(0.05, 0.3)), float(rng.uniform(0.5, 3)))
    if kind == "torus":
        vertices, faces = torus(int(rng.integers(5, 10)), int(rng.integers(3, 7)), float(rng.uniform(0.2, 0.5)), float(rng.choice([0, 0.15])), rng)
        return kind, (vertices * np.array([1, 1, rng.uniform(0.7, 2)]), faces)
    rows, columns = int(rng.integers(4, 8)), int(rng.integers(4, 8))
    return kind, sheet(rng, rows, columns, float(rng.uniform(0, 0.5)), kind == "sheet with a hole")


def random_point(rng: np.random.Generator, faces: np.ndarray, inside: bool = False) -> Point:
    """A point in a face, or sometimes on an edge or at a vertex unless `inside`."""
    face, kind = int(rng.integers(len(faces))), 0.0 if inside else rng.random()
    if kind > 0.85:
        return {"vertex": int(faces[face, int(rng.integers(3))])}
    a, b = np.sort(rng.uniform(0.01 if inside else 0, 0.99 if inside else 1, 2))
    coordinates = np.array([a, b - a, 1 - b])
    if kind > 0.7:
        coordinates[int(rng.integers(3))] = 0
        coordinates /= coordinates.sum()
    return {"face": face, "barycentric": [float(x) for x in coordinates]}


class Renumbering:
    """The same mesh with a random order of its vertices and faces, and random first corners of the faces."""

    def __init__(self, rng: np.random.Generator, surface: Surface) -> None:
        self.vertex = rng.permutation(len(surface.vertices))  # the new index of each vertex
        self.face = rng.permutation(len(surface.faces))  # the new index of each face
        self.turned = rng.integers(0, 3, len(surface.faces))  # corner i of an old face is corner i - turned of the new one
        self.vertices = np.empty_like(surface.vertices)
        self.vertices[self.vertex] = surface.vertices
        self.faces = np.empty_like(surface.faces)
        for old, (new, turn) in enumerate(zip(self.face, self.turned)):
            self.faces[new] = np.roll(self.vertex[surface.faces[old]], -turn)

    def point(self, point: Point) -> Point:
        if "vertex" in point:
            return {"vertex": int(self.vertex[point["vertex"]])}
        return {"face": int(self.face[point["face"]]), "barycentric": np.roll(point["barycentric"], -self.turned[point["face"]]).tolist()}


def divided(rng: np.random.Generator, surface: Surface) -> Tuple[np.ndarray, np.ndarray, Any]:
    """Divides some faces into three at an inner point, which does not change the surface. Returns vertices, faces, and a map of points."""
    vertices, faces = surface.vertices.tolist(), surface.faces.tolist()
    chosen: Dict[int, Tuple[np.ndarray, List[int]]] = {}
    for face in rng.choice(len(faces), min(len(faces), 1 + int(rng.integers(6))), replace=False).tolist():
        weights = rng.uniform(0.2, 1, 3)
        weights /= weights.sum()
        a, b, c = faces[face]
        middle = len(vertices)
        vertices.append((weights @ surface.vertices[[a, b, c]]).tolist())
        chosen[face] = (weights, [face, len(faces), len(faces) + 1])  # opposite the third, the first, the second corner
        faces[face] = [a, b, middle]
        faces += [[b, c, middle], [c, a, middle]]

    def point(old: Point) -> Point:
        if "vertex" in old or old["face"] not in chosen:
            return old
        weights, parts = chosen[old["face"]]
        coordinates = np.asarray(old["barycentric"])
        share = coordinates / weights
        least = int(np.argmin(share))  # the corner that its part does not have
        first, second = (least + 1) % 3, (least + 2) % 3
        rest = coordinates - share[least] * weights
        return {"face": parts[{2: 0, 0: 1, 1: 2}[least]],
                "barycentric": [float(max(0.0, rest[first])), float(max(0.0, rest[second])), float(share[least])]}

    return np.array(vertices), np.array(faces), point
