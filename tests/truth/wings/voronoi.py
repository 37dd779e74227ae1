"""Geodesic Voronoi diagrams, compared with the suite's own distances and areas."""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np

from _shapes import Renumbering, any_mesh, random_point, rotation
from _surface import Point, Surface
from _unfolding import distances
from truth import Check, Server

ABOUT = ("Diagrams of 2 to 7 random sites, some of them on vertices and edges, on random small meshes. Whose cell random points, vertices and borders lie in or between is "
         "compared with the least lengths over all unfolded sequences of faces, areas with the polygons that are drawn, and the diagram with that of the moved and renumbered mesh.")

AREAS = 2e-7
"""By the documents, the largest error of a cell's area as a fraction of the surface's area."""

CHECKS = {
    "cells_cover": Check("Sum of the cells' areas, from the area of the mesh", 1e-9, "surfaces"),
    "pieces_cover": Check("Areas of a cell's pieces and whole faces, from the cell's area", 1e-9, "surfaces"),
    "drawn_area": Check("Areas of a cell's polygons, from the cell's area, beyond what borders may be off their chords", AREAS, "surfaces"),
    "drawn_length": Check("Length of all borders as they are drawn, from their lengths, beyond what chords are shorter", 3e-5, "lengths"),
    "in_one_piece": Check("Distance of a random point from the nearest piece of its face", 1e-9, "diagonals"),
    "nearest_site": Check("By how much a random point is farther from the site of its piece than from the nearest", 2, "`border_deviation`s"),
    "vertex_site": Check("By how much a vertex of the mesh is farther from its site than from the nearest", 1e-12, "diagonals"),
    "border": Check("Difference of the distances of a border's point from its two sites", 1e-9, "diagonals"),
    "border_nearest": Check("By how much a border's point is farther from its sites than from the nearest", 1e-9, "diagonals"),
    "chord": Check("Difference of the distances of the middle between two of a border's points from its two sites", 2, "`border_deviation`s"),
    "corner": Check("Distances of Voronoi vertices from their sites, from what the answer says", 1e-9, "diagonals"),
    "corner_nearest": Check("By how much a Voronoi vertex is farther from its sites than from the nearest", 1e-9, "diagonals"),
    "rigid_motion": Check("Areas of cells before and after the mesh is moved and turned", AREAS, "surfaces"),
    "renumbering": Check("Areas of cells before and after vertices, faces and their corners are renumbered", AREAS, "surfaces"),
}


def case(rng: np.random.Generator) -> Dict[str, Any]:
    kind, (vertices, faces) = any_mesh(rng)
    sites = [random_point(rng, faces) for _ in range(int(rng.integers(2, 8)))]
    return {"kind": kind, "vertices": vertices.tolist(), "faces": faces.tolist(), "sites": sites, "deviation": float(rng.choice([1e-7, 1e-6, 1e-5, 1e-4])),
            "turn": rotation(rng).tolist(), "shift": rng.uniform(-3, 3, 3).tolist(), "seed": int(rng.integers(2**31))}


def examine(server: Server, case: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    surface, rng = Surface(case["vertices"], case["faces"]), np.random.default_rng(case["seed"])
    mesh = server.upload(case["vertices"], case["faces"])["id"]
    answer = server.post("/v1/voronoi-diagrams", {"mesh": mesh, "sites": case["sites"], "points": True, "pieces": True, "statistics": False,
                                                  "accuracy": {"border_deviation": case["deviation"]}})
    server.delete(f"/v1/meshes/{mesh}")
    areas = np.array([cell["area"] for cell in answer["cells"]])
    yield "cells_cover", (areas.sum() + answer["unreached_area"] - surface.area) / surface.area
    yield from _sums(surface, answer, areas, case["deviation"])
    yield from _places(surface, answer, case, rng)
    yield from _again(server, case, surface, areas, rng)


class Polygon:
    """A piece of a face, in the face's frame."""

    def __init__(self, surface: Surface, piece: Any) -> None:
        face, corners = piece["face"], np.array(piece["corners"])
        a, b, c = surface.vertices[surface.faces[face]]
        x = (b - a) / np.linalg.norm(b - a)
        y = c - a - ((c - a) @ x) * x
        self.corners = np.stack([(corners - a) @ x, (corners - a) @ (y / np.linalg.norm(y))], axis=1)
        self.site, self.face = int(piece["site"]), int(face)
        following = np.roll(self.corners, -1, axis=0)
        self.area = float(np.sum(self.corners[:, 0] * following[:, 1] - following[:, 0] * self.corners[:, 1])) / 2
        self.perimeter = float(np.linalg.norm(following - self.corners, axis=1).sum())

    def has(self, place: np.ndarray) -> bool:
        """Whether the polygon contains the place, by the number of its sides to the right of the place."""
        a, b = self.corners, np.roll(self.corners, -1, axis=0)
        spans = (a[:, 1] > place[1]) != (b[:, 1] > place[1])
        a, b = a[spans], b[spans]
        return bool(np.sum(place[0] < a[:, 0] + (b[:, 0] - a[:, 0]) * (place[1] - a[:, 1]) / (b[:, 1] - a[:, 1])) % 2)

    def distance(self, place: np.ndarray) -> float:
        a, along = self.corners, np.roll(self.corners, -1, axis=0) - self.corners
        share = np.clip(np.einsum("ij,ij->i", place - a, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300), 0, 1)
        return float(np.linalg.norm(place - a - share[:, None] * along, axis=1).min())


def _sums(surface: Surface, answer: Any, areas: np.ndarray, deviation: float) -> Iterator[Tuple[str, float]]:
    pieces, drawn, between = np.zeros_like(areas), np.zeros_like(areas), np.zeros_like(areas)
    for face, site in enumerate(answer["pieces"]["face_sites"]):
        if site is not None:
            pieces[site] += surface.face_areas[face]
            drawn[site] += surface.face_areas[face]
    for piece in answer["pieces"]["cut_faces"]:
        polygon = Polygon(surface, piece)
        pieces[polygon.site] += piece["area"]
        drawn[polygon.site] += polygon.area
        between[polygon.site] += 2 / 3 * deviation * surface.diagonal * polygon.perimeter
    yield "pieces_cover", float(np.abs(pieces - areas).max()) / surface.area
    yield "drawn_area", float(np.maximum(0, np.abs(drawn - areas) - between).max()) / surface.area
    positions = np.array(answer["positions"]).reshape(-1, 3)
    said, shown, shorter = 0.0, 0.0, 0.0
    for edge in answer["edges"]:
        chords = np.linalg.norm(np.diff(positions[edge["points"]], axis=0), axis=1)
        chords = chords[chords > 0]
        said, shown = said + edge["length"], shown + float(chords.sum())
        shorter += float((8 / 3 * np.minimum(deviation * surface.diagonal, chords / 2) ** 2 / chords).sum())
    if said > 0:
        yield "drawn_length", max(0.0, abs(said - shown) - shorter) / said


def _places(surface: Surface, answer: Any, case: Dict[str, Any], rng: np.random.Generator) -> Iterator[Tuple[str, float]]:
    """Compares the sites of random places with the suite's own distances from all sites, with one search for all places."""
    within = case["deviation"] * surface.diagonal
    of_face: Dict[int, List[Polygon]] = {}
    for piece in answer["pieces"]["cut_faces"]:
        of_face.setdefault(piece["face"], []).append(Polygon(surface, piece))
    asked: List[Tuple[str, Point, List[int], Optional[float]]] = []  # check, place, its sites, and how far they are where the answer says so
    for _ in range(50):
        cut = list(of_face)
        face = int(rng.choice(cut)) if cut and rng.random() < 0.7 else int(rng.integers(len(surface.faces)))
        coordinates = rng.dirichlet([1, 1, 1])
        point = {"face": face, "barycentric": coordinates.tolist()}
        if face not in of_face:
            site = answer["pieces"]["face_sites"][face]
            asked.append(("nearest_site", point, [] if site is None else [site], None))
            continue
        place = coordinates @ surface.layout[face]
        sites = [polygon.site for polygon in of_face[face] if polygon.has(place)]
        yield "in_one_piece", 0 if sites else min(polygon.distance(place) for polygon in of_face[face]) / surface.diagonal
        asked += [("nearest_site", point, [site], None) for site in sites]
    for vertex in np.unique(surface.faces):
        site = answer["pieces"]["vertex_sites"][vertex]
        asked.append(("vertex_site", {"vertex": int(vertex)}, [] if site is None else [site], None))
    for edge in answer["edges"]:
        points = edge["points"]
        for at in rng.choice(len(points), min(5, len(points)), replace=False):
            asked.append(("border", answer["points"][points[at]], edge["sites"], None))
            if at + 1 < len(points):
                asked.append(("chord", _middle(surface, answer["points"][points[at]], answer["points"][points[at + 1]]), edge["sites"], None))
    asked += [("corner", corner["point"], corner["sites"], corner["distance"]) for corner in answer["vertices"]]
    found, _ = distances(surface, case["sites"], [one[1] for one in asked])
    for (check, _, sites, distance), own in zip(asked, found.T):
        if not sites:
            yield check, 0 if np.isinf(own).all() else np.inf
            continue
        excess = float(own[sites].max() - own.min())
        if check == "nearest_site":
            yield check, excess / within
        elif check == "vertex_site":
            yield check, excess / surface.diagonal
        elif check == "chord":
            yield check, float(np.ptp(own[sites])) / within
        elif check == "border":
            yield check, float(np.ptp(own[sites])) / surface.diagonal
            yield "border_nearest", excess / surface.diagonal
        else:
            yield check, float(np.abs(own[sites] - distance).max()) / surface.diagonal
            yield "corner_nearest", excess / surface.diagonal


def _middle(surface: Surface, a: Point, b: Point) -> Point:
    """The midpoint of two points of a border that are in one face."""
    of_a, of_b = dict(surface.entries(a)), dict(surface.entries(b))
    face = next(face for face in of_a if face in of_b)
    return {"face": face, "barycentric": ((of_a[face] + of_b[face]) / 2).tolist()}


def _again(server: Server, case: Dict[str, Any], surface: Surface, areas: np.ndarray, rng: np.random.Generator) -> Iterator[Tuple[str, float]]:
    renumbered = Renumbering(rng, surface)
    for name, vertices, faces, sites in [
            ("rigid_motion", surface.vertices @ np.array(case["turn"]).T + np.array(case["shift"]), surface.faces, case["sites"]),
            ("renumbering", renumbered.vertices, renumbered.faces, [renumbered.point(site) for site in case["sites"]])]:
        mesh = server.upload(vertices, faces)["id"]
        answer = server.post("/v1/voronoi-diagrams", {"mesh": mesh, "sites": sites, "statistics": False})
        server.delete(f"/v1/meshes/{mesh}")
        yield name, float(np.abs(np.array([cell["area"] for cell in answer["cells"]]) - areas).max()) / surface.area
