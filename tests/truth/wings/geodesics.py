"""Geodesic distances, paths, derivatives, fields, means and straightest paths, compared with the suite's own exact search and closed forms."""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Tuple

import numpy as np

from _minima import steepest_descent, surroundings
from _shapes import Renumbering, any_mesh, divided, folded, random_point, rotation
from _surface import Point, Surface
from _unfolding import distances
from truth import Check, Server

ABOUT = ("On random small meshes (tetrahedra, balls, tori, sheets with holes and saddles, folded sheets, prisms) distances are compared with the least length over all "
         "unfolded sequences of faces, with the plane where the surface is a folded plane, and with the same question asked about the moved, scaled, "
         "renumbered and divided mesh.")

ROUNDING = 1e-12
"""The documents promise exactness up to rounding. Coordinates are rounded to 1e-16, and a path crosses up to some tens of thin faces."""

CHECKS = {
    "distance": Check("Distance between two points, from the least over all unfolded sequences of faces", ROUNDING, "diagonals"),
    "closed_form": Check("Distance on a folded rectangle or a prism, from that in the plane", ROUNDING, "diagonals"),
    "symmetry": Check("Distance there and back", ROUNDING, "diagonals"),
    "rigid_motion": Check("Distance before and after the mesh is moved and turned", ROUNDING, "diagonals"),
    "scale": Check("Distance before and after the mesh is scaled, over the scale", ROUNDING, "diagonals"),
    "renumbering": Check("Distance before and after vertices, faces and their corners are renumbered", ROUNDING, "diagonals"),
    "division": Check("Distance before and after faces are divided in their planes", ROUNDING, "diagonals"),
    "path_length": Check("Length of the path as it is drawn, from the distance", ROUNDING, "diagonals"),
    "path_on_surface": Check("Points of the path, from their places in the faces that they name; neighbours share a face", ROUNDING, "diagonals"),
    "gradient": Check("Slope of the distance along a random direction, from differences of unfolded lengths", 1e-7, "1"),
    "hessian": Check("Curvature of the distance along a random direction, from second differences of unfolded lengths", 1e-3, "over the distance"),
    "field": Check("Distances of all vertices from two sources, from unfolded lengths", ROUNDING, "diagonals"),
    "bounded_field": Check("By how much distances within a given error are too short, or too long by more than the error", ROUNDING, "diagonals"),
    "edge_graph": Check("By how much distances along edges are too short", ROUNDING, "diagonals"),
    "karcher": Check("Steepest descent from a Karcher mean, by unfolded lengths around it", 1e-8, "diagonals"),
    "walk": Check("End of a walk straight ahead, from one unfolded by own code", 1e-10, "diagonals"),
}


def case(rng: np.random.Generator) -> Dict[str, Any]:
    made: Dict[str, Any] = {}
    if rng.random() < 0.25:
        made["kind"] = "prism" if rng.random() < 0.5 else "folded sheet"
        vertices, faces, flat, round_it = folded(rng, made["kind"] == "prism")
        made |= {"flat": flat.tolist(), "round": round_it}
    else:
        made["kind"], (vertices, faces) = any_mesh(rng)
    points = [random_point(rng, faces, inside=i < 2) for i in range(5)]
    return made | {"vertices": vertices.tolist(), "faces": faces.tolist(), "points": points, "turn": rotation(rng).tolist(),
                   "shift": rng.uniform(-3, 3, 3).tolist(), "scale": float(10 ** rng.uniform(-3, 3)), "angle": float(rng.uniform(0, 2 * np.pi)),
                   "share": float(rng.uniform(0.05, 0.6)), "error": float(10 ** rng.uniform(-4, 0)), "seed": int(rng.integers(2**31))}


def _asked(server: Server, vertices: Any, faces: Any, points: List[Point], **more: Any) -> Tuple[str, np.ndarray, List[Any]]:
    """The mesh's id, the matrix of distances, and all results: pair (i, j) is result 5 i + j."""
    mesh = server.upload(vertices, faces)["id"]
    answer = server.post("/v1/geodesics", {"mesh": mesh, "pairs": [{"from": a, "to": b} for a in points for b in points], **more})["results"]
    return mesh, np.array([np.nan if one["distance"] is None else one["distance"] for one in answer]).reshape(len(points), len(points)), answer


def examine(server: Server, case: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    surface, points = Surface(case["vertices"], case["faces"]), case["points"]
    rng = np.random.default_rng(case["seed"])
    diagonal = surface.diagonal
    mesh, asked, results = _asked(server, case["vertices"], case["faces"], points, paths=True, derivatives=2)
    unfolded, to_vertices = distances(surface, points, points, to_vertices=True)
    yield "distance", _largest(asked - unfolded) / diagonal
    yield "symmetry", _largest(asked - asked.T) / diagonal
    if "flat" in case:
        yield "closed_form", _largest(asked - _in_the_plane(case)) / diagonal
    yield from _again(server, case, surface, asked, rng)
    for result in results:
        yield from _path(surface, result)
    yield from _derivatives(surface, points, results[1], case["angle"])
    yield from _fields(server, mesh, case, surface, to_vertices)
    yield from _mean(server, mesh, case, surface)
    yield from _walk(server, mesh, case, surface)
    server.delete(f"/v1/meshes/{mesh}")


def _largest(deviations: Any) -> float:
    """The largest deviation; NaN if there is one."""
    return float(np.max(np.abs(deviations)))


def _in_the_plane(case: Dict[str, Any]) -> np.ndarray:
    surface, flat, round_it = Surface(case["vertices"], case["faces"]), np.array(case["flat"]), case["round"]
    first = [surface.entries(point)[0] for point in case["points"]]
    places = np.array([coordinates @ flat[face] for face, coordinates in first])
    apart = places[:, None] - places[None]
    if round_it:
        apart[..., 0] = (apart[..., 0] + round_it / 2) % round_it - round_it / 2
    return np.linalg.norm(apart, axis=2)


def _again(server: Server, case: Dict[str, Any], surface: Surface, asked: np.ndarray, rng: np.random.Generator) -> Iterator[Tuple[str, float]]:
    """The same distances on the same surface after a rigid motion, a scaling, a renumbering and a subdivision."""
    vertices, faces, points, diagonal = surface.vertices, surface.faces, case["points"], surface.diagonal
    renumbered = Renumbering(rng, surface)
    more_vertices, more_faces, placed = divided(rng, surface)
    for name, v, f, p, scale in [
            ("rigid_motion", vertices @ np.array(case["turn"]).T + np.array(case["shift"]), faces, points, 1.0),
            ("scale", vertices * case["scale"], faces, points, case["scale"]),
            ("renumbering", renumbered.vertices, renumbered.faces, [renumbered.point(one) for one in points], 1.0),
            ("division", more_vertices, more_faces, [placed(one) for one in points], 1.0)]:
        mesh, other, _ = _asked(server, v, f, p)
        yield name, _largest(other / scale - asked) / diagonal
        server.delete(f"/v1/meshes/{mesh}")


def _path(surface: Surface, result: Any) -> Iterator[Tuple[str, float]]:
    drawn = np.array([point["position"] for point in result["path"]])
    yield "path_length", (float(np.linalg.norm(np.diff(drawn, axis=0), axis=1).sum()) - result["distance"]) / surface.diagonal
    off = max(float(np.linalg.norm(surface.position(point) - place)) for point, place in zip(result["path"], drawn)) / surface.diagonal
    faces = [{face for face, _ in surface.entries({"vertex": point["vertex"]} if "vertex" in point else point)} for point in result["path"]]
    yield "path_on_surface", off if all(a & b for a, b in zip(faces, faces[1:])) else np.inf


def _derivatives(surface: Surface, points: List[Point], result: Any, angle: float) -> Iterator[Tuple[str, float]]:
    """Derivatives by the second end, which is in a face. They are not compared if finite differences of two widths disagree, since the distance then
    has a kink nearby."""
    if not result.get("differentiable", False) or result["frames"]["to"]["face"] != points[1]["face"]:
        return
    width = 1e-3 * min(float(surface.length.mean()), result["distance"])
    moved = [surface.walk(points[1], angle + (0 if step > 0 else np.pi), abs(step) * width) for step in (-1, -0.5, 0.5, 1)]
    far_back, back, ahead, far_ahead, here = distances(surface, [points[0]], moved + [points[1]])[0][0]
    slopes = np.array([(far_ahead - far_back) / (2 * width), (ahead - back) / width])
    curvatures = np.array([(far_ahead - 2 * here + far_back) / width**2, (ahead - 2 * here + back) / (width / 2) ** 2])
    if abs(slopes[1] - slopes[0]) > 1e-5 or abs(curvatures[1] - curvatures[0]) * result["distance"] > 1e-2 + 0.1 * abs(curvatures[1]) * result["distance"]:
        return
    direction = np.array([np.cos(angle), np.sin(angle)])
    tangent = np.array(result["gradient"]["tangent"])[2:]
    second = np.array(result["hessian"]["tangent"])[2:, 2:]
    yield "gradient", float(tangent @ direction - (4 * slopes[1] - slopes[0]) / 3)
    yield "hessian", float(direction @ second @ direction - (4 * curvatures[1] - curvatures[0]) / 3) * result["distance"]


def _fields(server: Server, mesh: str, case: Dict[str, Any], surface: Surface, to_vertices: np.ndarray) -> Iterator[Tuple[str, float]]:
    used, sources, right = np.unique(surface.faces), case["points"][:2], to_vertices[:2].min(axis=0)

    def field(**accuracy: Any) -> np.ndarray:
        found = server.post("/v1/geodesic-fields", {"mesh": mesh, "sources": sources, "accuracy": accuracy})["distances"]
        return np.array([np.nan if one is None else one for one in found])[used]

    right = right[used]
    yield "field", _largest(field() - right) / surface.diagonal
    bounded = field(relative_error=case["error"])
    yield "bounded_field", _largest(np.maximum(0, np.maximum(right - bounded, bounded - (1 + case["error"]) * right))) / surface.diagonal
    yield "edge_graph", _largest(np.maximum(0, right - field(method="edge_graph"))) / surface.diagonal


def _mean(server: Server, mesh: str, case: Dict[str, Any], surface: Surface) -> Iterator[Tuple[str, float]]:
    points = case["points"][:3]
    answer = server.post("/v1/karcher-means", {"mesh": mesh, "points": points})
    if answer["stopped"] not in ("converged", "kink"):
        return
    mean = surface.at_vertex(answer["mean"])
    found, _ = distances(surface, points, [mean] + surroundings(surface, mean, case["angle"]))
    energies = (found**2).sum(axis=0) / (2 * len(points))
    yield "karcher", steepest_descent(surface, float(energies[0]), energies[1:]) / surface.diagonal


def _walk(server: Server, mesh: str, case: Dict[str, Any], surface: Surface) -> Iterator[Tuple[str, float]]:
    start, length = case["points"][0], case["share"] * surface.diagonal
    answer = server.post("/v1/exponential-maps", {"mesh": mesh, "start": start, "trace": False,
                                                  "tangent": [length * float(np.cos(case["angle"])), length * float(np.sin(case["angle"]))]})
    if not answer["reached_boundary"]:
        end = surface.walk(start, case["angle"], length)
        yield "walk", float(np.linalg.norm(surface.position(end) - np.array(answer["position"]))) / surface.diagonal
