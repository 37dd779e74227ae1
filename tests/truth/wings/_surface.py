"""Triangle meshes for the suite's own code: faces laid out in the plane, neighbours, points, and straightest paths."""

from __future__ import annotations

from typing import Any, Dict, List, Tuple

import numpy as np

Point = Dict[str, Any]
"""The JSON form of a point: a face and barycentric coordinates, or a vertex."""

ON_EDGE = 1e-9
"""A point with a barycentric coordinate below this is near an edge, and counts as a point of the face beyond it as well."""
AT_VERTEX = 1e-14
"""A point with two barycentric coordinates below this counts as a vertex."""
BESIDE_VERTEX = 1e-6
"""A point with two barycentric coordinates below this, but not at the vertex, would have to count as a point of all faces around the vertex. As a
point of only two of them its rays lose digits, so that some paths are not found and the suite's own lengths are too long."""


class Surface:
    """A mesh. Halfedge h = 3 f + i goes from corner i of face f to the next corner, with the face on its left. The origin of its frame is its tail
    and the x axis is along it, so that the face is at y > 0."""

    def __init__(self, vertices: Any, faces: Any) -> None:
        self.vertices = np.asarray(vertices, dtype=float)
        self.faces = np.asarray(faces, dtype=int)
        self.start = self.faces.ravel()
        self.end = np.roll(self.faces, -1, axis=1).ravel()
        self.apex = np.roll(self.faces, -2, axis=1).ravel()
        a, b, c = (self.vertices[at] for at in (self.start, self.end, self.apex))
        self.length = np.linalg.norm(b - a, axis=1)
        along = (b - a) / self.length[:, None]
        self.apex_x = np.einsum("ij,ij->i", c - a, along)
        self.apex_y = np.linalg.norm(c - a - self.apex_x[:, None] * along, axis=1)
        of_ends = {(int(s), int(e)): h for h, (s, e) in enumerate(zip(self.start, self.end))}
        self.twin = np.array([of_ends.get((int(e), int(s)), -1) for s, e in zip(self.start, self.end)])
        self.diagonal = float(np.linalg.norm(self.vertices.max(axis=0) - self.vertices.min(axis=0)))
        self.face_areas = self.length[::3] * self.apex_y[::3] / 2
        self.area = float(self.face_areas.sum())
        self.layout = np.zeros((len(self.faces), 3, 2))
        self.layout[:, 1, 0] = self.length[::3]
        self.layout[:, 2, 0] = self.apex_x[::3]
        self.layout[:, 2, 1] = self.apex_y[::3]
        angles = np.zeros(len(self.vertices))
        np.add.at(angles, self.start, np.arctan2(self.apex_y, self.apex_x))
        on_boundary = np.zeros(len(self.vertices), dtype=bool)
        on_boundary[self.start[self.twin < 0]] = True
        on_boundary[self.end[self.twin < 0]] = True
        self.angles = angles
        self.on_boundary = on_boundary
        # A shortest path can bend only at a vertex with an angle of at least pi on both sides. This includes flat vertices, whose angle is 2 pi up to rounding.
        self.turns_paths = np.where(on_boundary, angles > np.pi - 1e-6, angles > 2 * np.pi - 1e-6)

    def moved(self, vertices: Any) -> "Surface":
        return Surface(vertices, self.faces)

    def entries(self, point: Point) -> List[Tuple[int, np.ndarray]]:
        """All faces that contain the point, each with its coordinates in that face."""
        if "vertex" in point:
            around = np.flatnonzero(self.start == point["vertex"])
            return [(int(h) // 3, np.eye(3)[int(h) % 3]) for h in around]
        face, coordinates = int(point["face"]), np.asarray(point["barycentric"], dtype=float)
        coordinates = coordinates / coordinates.sum()
        if (np.abs(coordinates) < AT_VERTEX).sum() == 2:
            return self.entries({"vertex": int(self.faces[face, int(np.argmax(coordinates))])})
        found = [(face, coordinates)]
        least = int(np.argmin(coordinates))
        if coordinates[least] < ON_EDGE:
            halfedge = 3 * face + (least + 1) % 3
            twin = int(self.twin[halfedge])
            if twin >= 0:
                # The point in the plane of the face beyond the edge, where it is outside by as much as it is inside its own face.
                along = coordinates[(least + 2) % 3] * self.length[halfedge] + coordinates[least] * self.apex_x[halfedge]
                out = coordinates[least] * self.apex_y[halfedge]
                apex = -out / self.apex_y[twin]
                end = (self.length[twin] - along - apex * self.apex_x[twin]) / self.length[twin]
                other = np.zeros(3)
                other[twin % 3], other[(twin + 1) % 3], other[(twin + 2) % 3] = 1 - end - apex, end, apex
                found.append((twin // 3, other))
        return found

    def at_vertex(self, point: Point) -> Point:
        """The point as a vertex, if it is at one."""
        if "vertex" in point or sum(abs(x) < AT_VERTEX for x in point["barycentric"]) < 2:
            return point
        return {"vertex": int(self.faces[point["face"], int(np.argmax(point["barycentric"]))])}

    def beside_vertex(self, point: Point) -> bool:
        """Whether the suite's own lengths from this point are too inaccurate for comparisons (see BESIDE_VERTEX)."""
        return "vertex" not in self.at_vertex(point) and sum(abs(x) < BESIDE_VERTEX for x in point["barycentric"]) == 2

    def nearest_vertex(self, point: Point) -> Point:
        """The point, or the vertex next to it: lengths from the vertex are accurate up to the distance between the two."""
        return {"vertex": int(self.faces[point["face"], int(np.argmax(point["barycentric"]))])} if self.beside_vertex(point) else self.at_vertex(point)

    def position(self, point: Point) -> np.ndarray:
        if "vertex" in point:
            return self.vertices[point["vertex"]]
        coordinates = np.asarray(point["barycentric"], dtype=float)
        return (coordinates / coordinates.sum()) @ self.vertices[self.faces[point["face"]]]

    def walk(self, point: Point, angle: float, length: float) -> Point:
        """The end of a straightest path from a point of a face. `angle` is measured from the face's first edge. The path ends early at the boundary.
        From a vertex, `angle` is measured through the faces around it, one after the other."""
        if "vertex" in point:
            around = np.flatnonzero(self.start == point["vertex"])
            openings = np.arctan2(self.apex_y[around], self.apex_x[around])
            left = angle % float(openings.sum())
            for halfedge, opening in zip(around, openings):
                if left <= opening:
                    face, corner = int(halfedge) // 3, int(halfedge) % 3
                    edge = self.layout[face, (corner + 1) % 3] - self.layout[face, corner]
                    return self._go(face, self.layout[face, corner].copy(), float(np.arctan2(edge[1], edge[0])) + float(left), length, {corner, (corner + 2) % 3})
                left -= opening
            raise ValueError("the angles around a vertex do not add up")
        coordinates = np.asarray(point["barycentric"], dtype=float)
        return self._go(int(point["face"]), coordinates @ self.layout[point["face"]] / coordinates.sum(), angle, length, set())

    def _go(self, face: int, place: np.ndarray, angle: float, length: float, not_across: "set[int]") -> Point:
        way = np.array([np.cos(angle), np.sin(angle)])
        for _ in range(10_000):
            corners = self.layout[face]
            nearest, edge = length, -1
            for i in range(3):
                if i in not_across:
                    continue
                a, along = corners[i], corners[(i + 1) % 3] - corners[i]
                leaving = along[1] * way[0] - along[0] * way[1]  # positive if the path leaves the face across this edge
                if leaving <= 0:
                    continue
                reach = (along[1] * (a[0] - place[0]) - along[0] * (a[1] - place[1])) / leaving
                if reach < nearest:
                    nearest, edge = max(reach, 0.0), i
            place = place + nearest * way
            length -= nearest
            twin = int(self.twin[3 * face + edge]) if edge >= 0 else -1
            if edge < 0 or twin < 0:
                return {"face": face, "barycentric": self._coordinates(face, place)}
            along = corners[(edge + 1) % 3] - corners[edge]
            share = float((place - corners[edge]) @ along / (along @ along))
            forward = float(way @ along) / float(np.linalg.norm(along))
            outward = float(way[0] * along[1] - way[1] * along[0]) / float(np.linalg.norm(along))
            face, edge = twin // 3, twin % 3
            corners = self.layout[face]
            along = corners[(edge + 1) % 3] - corners[edge]
            place = corners[edge] + (1 - share) * along
            along = along / np.linalg.norm(along)
            way = -forward * along + outward * np.array([-along[1], along[0]])
            not_across = {edge}
        raise ValueError("a walk does not end")

    def _coordinates(self, face: int, place: np.ndarray) -> List[float]:
        corners = self.layout[face]
        c = place[1] / corners[2, 1]
        b = (place[0] - c * corners[2, 0]) / corners[1, 0]
        coordinates = np.clip([1 - b - c, b, c], 0, None)
        return [float(x) for x in coordinates / coordinates.sum()]
