#!/usr/bin/python3
"""Writes the meshes and networks of the examples with hosts, as OBJ and as JSON for `supple relax MESH --network FILE`.

    tests/support/make_host_examples.py api/examples
"""

import json
import math
import sys
from pathlib import Path

import numpy as np


def in_triangles(quads):
    return np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


# --- a torus in a sleeve --------------------------------------------------------------------------------------------------

AROUND, ACROSS = 36, 16  # quads of the torus along and about its tube
TUBE, RING = 0.1, 0.24  # radii, so that the bounding box has a diagonal of about 1


def torus():
    """A torus of quadrilaterals, each cut into two triangles."""
    u, v = np.meshgrid(np.arange(AROUND) * 2 * math.pi / AROUND, np.arange(ACROSS) * 2 * math.pi / ACROSS, indexing="ij")
    radius = RING + TUBE * np.cos(v)
    vertices = np.stack([radius * np.cos(u), radius * np.sin(u), TUBE * np.sin(v)], axis=-1).reshape(-1, 3)
    quads = [(i * ACROSS + j, (i + 1) % AROUND * ACROSS + j, (i + 1) % AROUND * ACROSS + (j + 1) % ACROSS,
              i * ACROSS + (j + 1) % ACROSS) for i in range(AROUND) for j in range(ACROSS)]
    return vertices, in_triangles(quads)


def sleeve():
    """A stretched membrane around two thirds of the torus, with four fixed points at each rim."""
    rows, columns = 24, ACROSS

    def at(i, j):
        return i * columns + j % columns

    points = [{"face": 2 * (i * ACROSS + j), "barycentric": [0.5, 0.2, 0.3]} for i in range(rows) for j in range(columns)]
    triangles = [t for i in range(rows - 1) for j in range(columns)
                 for t in ((at(i, j), at(i + 1, j), at(i + 1, j + 1)), (at(i, j), at(i + 1, j + 1), at(i, j + 1)))]
    fixed = [at(i, j) for i in (0, rows - 1) for j in range(0, columns, 4)]
    return {"points": points, "springs": [], "triangles": triangles, "fixed_points": fixed,
            "membrane": {"youngs_modulus": 1000, "poisson_ratio": 0.4, "thickness": 0.002, "rest_scale": 0.82},
            "host": {"kind": "rigid"}}


# --- a ball in a net of cords ---------------------------------------------------------------------------------------------


def ball(subdivisions, radius):
    """A sphere: an octahedron that is subdivided repeatedly."""
    points = [np.array(p, dtype=float) for p in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    for _ in range(subdivisions):
        middles = {}

        def middle(i, j):
            key = (min(i, j), max(i, j))
            if key not in middles:
                middles[key] = len(points)
                points.append((points[i] + points[j]) / np.linalg.norm(points[i] + points[j]))
            return middles[key]

        finer = []
        for i, j, k in faces:
            a, b, c = middle(i, j), middle(j, k), middle(k, i)
            finer += [(i, a, c), (j, b, a), (k, c, b), (a, b, c)]
        faces = finer
    return radius * np.array(points), np.array(faces)


def point_along(vertices, faces, target):
    """The point at which the ray from the origin through the target meets the surface, which it does once."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    weights = np.stack([np.cross(b, c) @ target, np.cross(c, a) @ target, np.cross(a, b) @ target], axis=1)
    sums = weights.sum(axis=1)  # negative for faces on the opposite side of the origin
    face = int(np.argmax(np.where(sums > 0, weights.min(axis=1) / np.abs(sums), -1)))
    barycentric = np.clip(weights[face] / weights[face].sum(), 0, None)
    first, second = (round(float(x), 4) for x in barycentric[:2] / barycentric.sum())
    return {"face": face, "barycentric": [first, second, round(max(1 - first - second, 0), 4)]}


def cords(vertices, faces):
    """Chains of springs along three great circles, joined where they meet. Their rest lengths are a fifth below their lengths."""
    turn = np.linalg.qr(np.array([[1, 0.1, 0.2], [0.15, 1, -0.1], [-0.1, 0.2, 1]]))[0]  # away from the mesh's edges
    count, points, springs, index = 24, [], [], {}

    def point(direction):
        key = tuple(np.round(direction, 9) + 0.0)
        if key not in index:
            index[key] = len(points)
            points.append(point_along(vertices, faces, turn @ direction))
        return index[key]

    radius = np.linalg.norm(vertices[0])
    rest = 0.8 * 2 * math.pi * radius / count
    for axis in range(3):
        circle = [np.roll([math.cos(a), math.sin(a), 0.0], axis) for a in np.arange(count) * 2 * math.pi / count]
        ring = [point(direction) for direction in circle]
        springs += [{"between": [ring[i], ring[(i + 1) % count]], "rest_length": rest, "weight": 40} for i in range(count)]
    return {"points": points, "springs": springs,
            "host": {"kind": "shell", "thickness": 0.003, "youngs_modulus": 1e4, "poisson_ratio": 0.48, "volume_weight": 1000}}


# --- a rabbit whose ears are pulled down ----------------------------------------------------------------------------------


def catmull_clark(vertices, quads):
    """One step of Catmull-Clark subdivision of a closed mesh of quadrilaterals."""
    centres = vertices[quads].mean(axis=1)
    edges, of_edge = {}, {}
    for f, quad in enumerate(quads):
        for a, b in zip(quad, np.roll(quad, -1)):
            key = (min(a, b), max(a, b))
            edges.setdefault(key, len(edges))
            of_edge.setdefault(key, []).append(f)
    middles = np.array([(vertices[a] + vertices[b] + centres[of_edge[a, b]].sum(axis=0)) / 4 for a, b in edges])
    moved = np.zeros_like(vertices)
    for v in range(len(vertices)):
        faces = [f for f, quad in enumerate(quads) if v in quad]
        around = [(vertices[a] + vertices[b]) / 2 for a, b in edges if v in (a, b)]
        n = len(faces)
        moved[v] = (centres[faces].mean(axis=0) + 2 * np.mean(around, axis=0) + (n - 3) * vertices[v]) / n
    first_edge, first_face = len(vertices), len(vertices) + len(edges)
    finer = []
    for f, quad in enumerate(quads):
        for k in range(4):
            after, before = sorted((quad[k], quad[(k + 1) % 4])), sorted((quad[k - 1], quad[k]))
            finer.append((quad[k], first_edge + edges[tuple(after)], first_face + f, first_edge + edges[tuple(before)]))
    return np.concatenate([moved, middles, centres]), np.array(finer)


def smoothed(vertices, quads):
    """The vertices, each moved halfway to the mean of its neighbours; feet stay on the ground."""
    sums, counts = np.zeros_like(vertices), np.zeros(len(vertices))
    for a, b in ((quads[:, k], quads[:, (k + 1) % 4]) for k in range(4)):
        np.add.at(sums, a, vertices[b])
        np.add.at(counts, a, 1)
    moved = (vertices + sums / counts[:, None]) / 2
    ground = vertices[:, 2] < 0.3
    moved[ground, 2] = vertices[ground, 2]
    return moved


def rabbit():
    """A sitting rabbit of smoothed blocks, with z upwards and its nose along x."""
    blocks = {(x, y, z) for x in range(4) for y in range(3) for z in range(2)}  # body
    blocks |= {(x, y, z) for x in (2, 3) for y in range(3) for z in (2, 3)}  # head
    blocks |= {(2, y, z) for y in (0, 2) for z in range(4, 8)}  # ears
    blocks |= {(-1, 1, 1), (4, 1, 2), (4, 0, 0), (4, 2, 0)}  # tail, nose, paws
    corners, quads = {}, []
    sides = {(1, 0, 0): [(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)], (-1, 0, 0): [(0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)],
             (0, 1, 0): [(0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)], (0, -1, 0): [(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)],
             (0, 0, 1): [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)], (0, 0, -1): [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)]}
    for block in sorted(blocks):
        for side, square in sides.items():
            if tuple(np.add(block, side)) not in blocks:
                quads.append([corners.setdefault(tuple(np.add(block, c).tolist()), len(corners)) for c in square])
    vertices = np.array(list(corners), dtype=float)
    vertices[:, 1] -= 1.5
    vertices, quads = catmull_clark(vertices, np.array(quads))
    ear = np.clip((vertices[:, 2] - 4) / 4, 0, 1)
    vertices[:, 1] += np.sign(vertices[:, 1]) * 0.25 * ear**2  # they lean outwards
    vertices[:, 0] -= 0.5 * ear
    faces = in_triangles(quads)
    ears = vertices[:, 2] > 4.4
    for step in range(5):
        before, vertices = vertices, smoothed(vertices, quads)
        if step >= 2:
            vertices[ears] = before[ears]
    vertices[:, 2] -= vertices[:, 2].min()
    return 0.1 * vertices, faces


def reins(vertices, faces):
    """A chain of springs from the tip of each ear along its outer side to the flank."""
    points, springs, fixed = [], [], []
    centroids = vertices[faces].mean(axis=1)
    for side in (-1, 1):
        sought = [(0.19, side * 0.2, 0.75), (0.21, side * 0.17, 0.6), (0.23, side * 0.15, 0.45), (0.25, side * 0.15, 0.3),
                  (0.25, side * 0.15, 0.15)]
        first = len(points)
        for target in sought:
            points.append({"face": int(np.argmin(np.linalg.norm(centroids - target, axis=1))), "barycentric": [0.3, 0.3, 0.4]})
        fixed += [first, first + len(sought) - 1]
        springs += [{"between": [first + i, first + i + 1], "rest_length": 0.05, "weight": 1} for i in range(len(sought) - 1)]
    bottom = np.flatnonzero(vertices[:, 2] < vertices[:, 2].min() + 0.02).tolist()
    return {"points": points, "springs": springs, "fixed_points": fixed,
            "host": {"kind": "solid", "youngs_modulus": 100, "poisson_ratio": 0.4, "element_size": 0.06, "fixed_vertices": bottom}}


def pricked(vertices, faces):
    """The same chains, slack, and moved vertices: the tips of the ears rotate forwards about the base of the ears, in three
    steps."""
    network = reins(vertices, faces)
    for spring in network["springs"]:
        spring["rest_length"] = 0.14
    pivot, moved = np.array([0.23, 0.0, 0.45]), []
    for tip in np.flatnonzero(vertices[:, 2] > 0.73).tolist():
        positions = []
        for angle in np.radians([20, 40, 60]):
            x, y, z = vertices[tip] - pivot
            positions.append([float(c) for c in pivot + [math.cos(angle) * x + math.sin(angle) * z, y, math.cos(angle) * z - math.sin(angle) * x]])
        moved.append({"vertex": tip, "positions": positions})
    return {**network, "host": {**network["host"], "moved_vertices": moved}}


# --- a strap on a cushion -------------------------------------------------------------------------------------------------

CUSHION = (200.0, 150.0, 50.0)  # half of its length, width and height in mm


def cushion():
    """The grid of a cube projected onto |x|^6 + |y|^6 + |z|^2.5 = 1, scaled to the cushion's size."""
    n = 8
    index, quads = {}, []

    def corner(p):
        return index.setdefault(tuple(p), len(index))

    for axis in range(3):
        for side in (0, n):
            for i in range(n):
                for j in range(n):
                    square = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                    quads.append([corner(np.roll([side, *s], axis).tolist()) for s in (square if side else square[::-1])])
    cube = 2 * np.array(list(index), dtype=float) / n - 1
    cube = np.sin(cube * math.pi / 4) / math.sin(math.pi / 4)
    power = np.array([6.0, 6.0, 2.5])
    scale = np.empty(len(cube))
    for i, p in enumerate(cube):
        low, high = 0.1, 1.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if (np.abs(middle * p) ** power).sum() < 1 else (low, middle)
        scale[i] = low
    return cube * scale[:, None] * CUSHION, in_triangles(quads)


def strap(vertices, faces):
    """Elastic webbing over the middle of the cushion, fixed at both ends: chains of springs and a membrane between them."""
    points, springs, triangles, fixed = [], [], [], []
    across, along = 4, 17
    for k in range(across):
        x = -30 + 20 * k + 3.0
        for i in range(along):
            angle = math.pi * (i / (along - 1)) * 1.02 - 0.02
            target = np.array([x, CUSHION[1] * math.cos(angle), CUSHION[2] * math.sin(angle)])
            points.append(point_along(vertices, faces, target))
        first = k * along
        fixed += [first, first + along - 1]
        springs += [{"between": [first + i, first + i + 1], "rest_length": 10.0, "weight": 3} for i in range(along - 1)]
        if k:
            triangles += [t for i in range(first - along, first - 1)
                          for t in ((i, i + along, i + 1), (i + 1, i + along, i + along + 1))]
    bottom = np.flatnonzero(vertices[:, 2] < -0.75 * CUSHION[2]).tolist()
    return {"points": points, "springs": springs, "triangles": triangles, "fixed_points": fixed,
            "membrane": {"youngs_modulus": 2, "poisson_ratio": 0.3, "thickness": 1, "rest_scale": 0.8},
            "host": {"kind": "solid", "youngs_modulus": 0.05, "poisson_ratio": 0.2, "fixed_vertices": bottom, "element_size": 35}}


def rounded(value):
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {key: rounded(entry) for key, entry in value.items()}
    return [rounded(entry) for entry in value] if isinstance(value, list) else value


def write(folder, name, mesh, network):
    vertices, faces = mesh
    lines = [f"v {x:.5g} {y:.5g} {z:.5g}" for x, y, z in vertices + 0.0] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (folder / "meshes" / f"{name}.obj").write_text("\n".join(lines) + "\n", encoding="utf-8")
    write_network(folder, name, network)


def write_network(folder, name, network):
    entries = [f'  "{key}": {json.dumps(rounded(value))}' for key, value in network.items()]
    (folder / "networks" / f"{name}.json").write_text("{\n" + ",\n".join(entries) + "\n}\n", encoding="utf-8")


def main():
    folder = Path(sys.argv[1])
    write(folder, "torus", torus(), sleeve())
    mesh = ball(4, 0.28868)
    write(folder, "ball", mesh, cords(*mesh))
    mesh = rabbit()
    write(folder, "rabbit", mesh, reins(*mesh))
    write_network(folder, "rabbit-pricks", pricked(*mesh))
    mesh = cushion()
    write(folder, "cushion", mesh, strap(*mesh))


if __name__ == "__main__":
    main()
