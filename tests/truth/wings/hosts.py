"""Shells and solids under networks, compared with the suite's own energies of the positions in the answers."""

from __future__ import annotations

from typing import Any, Callable, Dict, Iterator, Tuple

import numpy as np

from _hosts import enclosed_volume, host_of_vtu, shell_energies, solid_energies, tetrahedron_volumes
from _minima import steepest_descent, surroundings
from _networks import Network
from _shapes import Renumbering, ball, random_point, rotation, sheet, torus
from _surface import Surface
from _unfolding import distances
from truth import Check, Server

ABOUT = ("Random networks that pull on shells (balls, tori and sheets, some of which keep their volume) and on solids. Every term of the energy is computed again from the answered "
         "positions, its slope along random motions of all nodes is taken by differences, and the same body is asked about moved and turned, renumbered, of another unit of stiffness, "
         "and with a vertex taken away and back.")

OTHER = 1e-6
"""Relative difference of energies of shells above which they belong to different equilibria: a sheet can buckle to either side."""
JUMP = 1e-7
"""By the documents, jumps of less than this fraction of the energy are not detected."""

CHECKS = {
    "springs": Check("The springs' energy, from own lengths on the deformed surface, where no point is within 1e-6 of a vertex but not at it", 1e-10, "of the term"),
    "shell_membrane": Check("Energy of stretched faces, from their sides", 1e-10, "of the term"),
    "shell_bending": Check("Energy of bent edges, from their angles", 1e-10, "of the term"),
    "shell_volume": Check("Energy of the kept volume", 1e-10, "of the term"),
    "solid": Check("Energy of the tetrahedra, from their deformation gradients", 1e-10, "of the term"),
    "gravity": Check("Work of gravity, from the tetrahedra's ways", 1e-10, "of the term"),
    "volume_ratio": Check("The enclosed volume over that at rest", 1e-12, "1"),
    "filling": Check("Sum of the tetrahedra's volumes at rest, from the enclosed volume; all are positive", 1e-9, "volumes"),
    "equilibrium": Check("Slope of the energy along a random motion of all free nodes, at an answer that is `converged` and has no point beside a vertex like that", 1e-6, "sums of the terms' slopes"),
    "point_minimum": Check("Steepest descent of a single point of the network, at an answer that is `converged` and has no point beside a vertex like that", 1e-8, "stiffness"),
    "stiffness": Check("The energy after all stiffnesses are multiplied by one number, over it", 1e-9, "of the energy"),
    "moved_shell": Check("The energy of the shell that is moved and turned", 1e-9, "of the energy"),
    "moved_solid": Check("The energy of the solid that is moved and turned", 1e-7, "of the energy"),
    "renumbered_shell": Check("The energy of the shell after vertices, faces and their corners are renumbered", 1e-9, "of the energy"),
    "other_shell": Check("Shells that end in another equilibrium after one of these two", 0, "1 if it does", 0.05),
    "moved_filling": Check("Nodes of the solid at rest that is moved and turned, or renumbered, from the nearest node of the other filling", 1e-8, "diagonals"),
    "moved_tetrahedra": Check("Share of its tetrahedra that the other filling does not have", 0, "1"),
    "renumbered_solid": Check("The energy of the solid after vertices, faces and their corners are renumbered", 1e-7, "of the energy"),
    "moved_body": Check("Vertices of the solid that is moved and turned, or renumbered", 1e-6, "diagonals"),
    "there_and_back": Check("The energy after a vertex was taken away and back, where no jump is counted", 2 * JUMP, "of the energy"),
}


def case(rng: np.random.Generator) -> Dict[str, Any]:
    kind = "solid" if rng.random() < 0.4 else "shell"
    shape = str(rng.choice(["ball", "torus"] if kind == "solid" else ["ball", "torus", "sheet"]))
    if shape == "ball":
        vertices, faces = ball(rng, 1, float(rng.uniform(0.01, 0.1)), float(rng.uniform(0.6, 2)))
    elif shape == "torus":
        vertices, faces = torus(int(rng.integers(7, 10)), int(rng.integers(4, 6)), float(rng.uniform(0.3, 0.45)), float(rng.uniform(0.02, 0.1)), rng)
    else:
        vertices, faces = sheet(rng, int(rng.integers(4, 7)), int(rng.integers(4, 7)), float(rng.uniform(0.05, 0.3)), False)
    surface = Surface(vertices, faces)
    count = int(rng.integers(5, 10))
    points = [random_point(rng, faces, inside=True) for _ in range(count)]
    between, _ = distances(surface, points, points)
    pairs = sorted({(min(i, j), max(i, j)) for i in range(count) for j in np.argsort(between[i])[1:1 + int(rng.integers(3, 5))].tolist()})
    springs = [{"between": [i, j], "rest_length": float(between[i, j] * rng.uniform(0.3, 0.95)), "weight": float(rng.uniform(0.5, 2))} for i, j in pairs]
    host: Dict[str, Any] = {"kind": kind, "youngs_modulus": float(10 ** rng.uniform(0.7, 2)), "poisson_ratio": float(rng.uniform(0, 0.45))}
    if kind == "shell":
        host["thickness"] = float(10 ** rng.uniform(-1.7, -0.7)) * float(surface.length.mean())
        host["youngs_modulus"] *= float(surface.length.mean()) / host["thickness"]
        if shape != "sheet" and rng.random() < 0.5:
            host |= {"volume_weight": host["youngs_modulus"] * float(rng.uniform(0.01, 1)), "volume_scale": float(rng.uniform(0.9, 1.2))}
    far = [int(rng.integers(len(vertices)))]
    while len(far) < 4:  # vertices that are far from each other support the body
        far.append(int(np.argmax(np.linalg.norm(vertices[:, None] - vertices[far][None], axis=2).min(axis=1))))
    again = str(rng.choice(["stiffness", "moved", "renumbered", "there_and_back"]))
    if again == "there_and_back" or rng.random() < 0.3:
        host["fixed_vertices"] = far
        if kind == "solid" and rng.random() < 0.7:
            host["gravity"] = (0.02 * host["youngs_modulus"] * rng.normal(size=3) / surface.diagonal).tolist()
    return {"shape": shape, "vertices": vertices.tolist(), "faces": faces.tolist(), "points": points, "springs": springs, "host": host, "again": again,
            "fixed": list(range(int(rng.integers(0, 3)))), "turn": rotation(rng).tolist(), "shift": rng.uniform(-3, 3, 3).tolist(),
            "factor": float(10 ** rng.uniform(-3, 3)), "way": (surface.diagonal * rng.uniform(0.005, 0.05) * rotation(rng)[0]).tolist(), "seed": int(rng.integers(2**31)),
            "angle": float(rng.uniform(0, 2 * np.pi))}


def _body(mesh: str, case: Dict[str, Any], **changed: Any) -> Dict[str, Any]:
    return {"mesh": mesh, "points": case["points"], "springs": case["springs"], "fixed_points": case["fixed"], "host": case["host"], **changed}


def examine(server: Server, case: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    surface, rng = Surface(case["vertices"], case["faces"]), np.random.default_rng(case["seed"])
    mesh = server.upload(case["vertices"], case["faces"])["id"]
    body = _body(mesh, case)
    answer = server.post("/v1/embedded-systems", body)
    solid = case["host"]["kind"] == "solid"
    if solid:
        nodes, tetrahedra = host_of_vtu(server.file("/v1/embedded-systems", body, "application/x-vtu+xml").decode())
        rest = _at_rest(server, body)
        volumes, enclosed = tetrahedron_volumes(*rest), enclosed_volume(surface, surface.vertices)
        yield "filling", np.inf if volumes.min() <= 0 or not np.array_equal(rest[1], tetrahedra) else (volumes.sum() - enclosed) / enclosed

        def of_host(at: np.ndarray) -> Dict[str, float]:
            return solid_energies(*rest, case["host"], at)

        stiffness = case["host"]["youngs_modulus"] * enclosed
    else:
        nodes, rest = np.array(answer["host"]["vertices"]), None

        def of_host(at: np.ndarray) -> Dict[str, float]:
            return shell_energies(surface, case["host"], at)

        stiffness = case["host"]["youngs_modulus"] * case["host"]["thickness"] * surface.area
    network = Network(case["springs"], [], None, np.zeros((1, 1)))

    def energies(at: np.ndarray) -> Dict[str, float]:
        """All terms of the energy, for the network's points at their barycentric coordinates."""
        moved = surface.moved(at[:len(surface.vertices)])
        points = [surface.nearest_vertex(point) for point in answer["points"]]
        between, _ = distances(moved, points, points)
        return {"springs": network.energy(between), **of_host(at)}

    exact = not any(surface.beside_vertex(point) for point in answer["points"])  # else the suite's lengths are those from the vertex
    for name, deviation in _terms(answer, energies(nodes), stiffness):
        if exact or name != "springs":
            yield name, deviation
    if solid or case["shape"] != "sheet":
        yield "volume_ratio", answer["host"]["volume_ratio"] - enclosed_volume(surface, nodes) / enclosed_volume(surface, surface.vertices)
    if answer["stopped"] == "converged":
        if exact:
            yield from _at_equilibrium(case, surface, network, answer, energies, nodes, rng)
        yield from _again(server, mesh, case, surface, answer, rest, rng)
    server.delete(f"/v1/meshes/{mesh}")


def _at_rest(server: Server, body: Dict[str, Any]) -> Tuple[np.ndarray, np.ndarray]:
    """The nodes and tetrahedra of a solid without loads."""
    still = {**body, "springs": [], "host": {key: value for key, value in body["host"].items() if key != "gravity"}}
    return host_of_vtu(server.file("/v1/embedded-systems", still, "application/x-vtu+xml").decode())


def _terms(answer: Any, own: Dict[str, float], stiffness: float) -> Iterator[Tuple[str, float]]:
    """Compares the terms of the energy. Energies near rest are differences of numbers of the size of the stiffness; those of bending are differences
    of far smaller numbers."""
    said = {term["name"]: term["energy"] for term in answer["terms"]}
    said["springs"] = said.pop("geodesic_springs", 0.0)
    for name in sorted(own.keys() | said.keys()):
        energy = own.get(name, np.nan)
        yield name, (said.get(name, 0.0) - energy) / (abs(energy) + stiffness * (1e-6 if name == "shell_bending" else 1e-3))


def _at_equilibrium(case: Dict[str, Any], surface: Surface, network: Network, answer: Any, energies: Callable[[np.ndarray], Dict[str, float]], nodes: np.ndarray,
                    rng: np.random.Generator) -> Iterator[Tuple[str, float]]:
    fixed = case["host"].get("fixed_vertices", [])
    width = 1e-6 * float(surface.length.mean())
    motion = rng.normal(size=nodes.shape)
    motion[fixed] = 0

    def slopes_of(step: float) -> np.ndarray:
        ahead, back = energies(nodes + step * motion), energies(nodes - step * motion)
        return np.array([(ahead[name] - back[name]) / (2 * step) for name in ahead])

    # Thin tetrahedra are stiff, and their energy is far from a parabola: an extrapolation from two widths compensates for that.
    slopes = (4 * slopes_of(width / 2) - slopes_of(width)) / 3
    least = 1e-3 * network.largest_weight * surface.diagonal * float(np.linalg.norm(motion))  # a million times the tolerance of gradients
    yield "equilibrium", float(slopes.sum() / (np.abs(slopes).sum() + least))
    moved = surface.moved(nodes[:len(surface.vertices)])
    points = [moved.at_vertex(point) for point in answer["points"]]
    free = [i for i in range(len(points)) if i not in case["fixed"]]
    places = [surroundings(moved, points[i], case["angle"], 6) for i in free]
    found, _ = distances(moved, points, points + [place for of_point in places for place in of_point])
    count, each = len(points), len(places[0])
    steepest = max(steepest_descent(moved, network.energy(found[:, :count]), network.energies_with(found[:, :count], point, found[:, count + k * each:count + (k + 1) * each]))
                   for k, point in enumerate(free))
    yield "point_minimum", steepest / (network.largest_weight * moved.diagonal)


def _again(server: Server, mesh: str, case: Dict[str, Any], surface: Surface, answer: Any, rest: Any, rng: np.random.Generator) -> Iterator[Tuple[str, float]]:
    """Another request for the same body, for which the answer is an equilibrium as well."""
    host = case["host"]
    least = max(sum(abs(term["energy"]) for term in answer["terms"]), 1e-12)
    if case["again"] == "stiffness":
        by = case["factor"]
        scaled = {**host, **{key: host[key] * by for key in ("youngs_modulus", "volume_weight") if key in host}}
        if "gravity" in host:
            scaled["gravity"] = [by * force for force in host["gravity"]]
        other = server.post("/v1/embedded-systems", _body(mesh, case, host=scaled, springs=[{**spring, "weight": by * spring["weight"]} for spring in case["springs"]]))
        if other["stopped"] == "converged":
            yield "stiffness", (other["energy"] / by - answer["energy"]) / least
        return
    if case["again"] == "there_and_back":
        vertex, *held = host["fixed_vertices"]
        start = surface.vertices[vertex]
        moving = {**host, "fixed_vertices": held, "moved_vertices": [{"vertex": vertex, "positions": [(start + np.array(case["way"])).tolist(), start.tolist()]}]}
        other = server.post("/v1/embedded-systems", _body(mesh, case, host=moving))
        stops = other["host"]["stops"]
        if all(stop["stopped"] == "converged" and stop["jumps"] == 0 and stop["reached"] == 1 for stop in stops):
            yield "there_and_back", (other["energy"] - answer["energy"]) / least
        return
    turn, shift = np.array(case["turn"]), np.array(case["shift"])
    if case["again"] == "moved":
        new = {**host, "gravity": (turn @ np.array(host["gravity"])).tolist()} if "gravity" in host else host
        another = server.upload(surface.vertices @ turn.T + shift, surface.faces)["id"]
        asked = _body(another, case, host=new)

        def back(nodes: np.ndarray) -> np.ndarray:
            return (nodes - shift) @ turn

    else:
        renumbered = Renumbering(rng, surface)
        new = {**host, "fixed_vertices": [int(renumbered.vertex[v]) for v in host.get("fixed_vertices", [])]}
        another = server.upload(renumbered.vertices, renumbered.faces)["id"]
        asked = _body(another, case, host=new, points=[renumbered.point(point) for point in case["points"]])

        def back(nodes: np.ndarray) -> np.ndarray:
            return np.concatenate([nodes[renumbered.vertex], nodes[len(renumbered.vertex):]])

    other = server.post("/v1/embedded-systems", asked)
    vertices = back(np.array(other["host"]["vertices"]))
    if host["kind"] == "solid":
        filled, others = _at_rest(server, asked)
        apart = np.linalg.norm(back(filled)[:, None] - rest[0][None], axis=2)
        yield "moved_filling", float(max(apart.min(axis=0).max(), apart.min(axis=1).max())) / surface.diagonal
        new_index = np.arange(len(filled))
        if case["again"] == "renumbered":
            new_index[renumbered.vertex] = np.arange(len(renumbered.vertex))
        nearest = apart.argmin(axis=1)
        same = {frozenset(nodes) for nodes in nearest[new_index[others]].tolist()}
        yield "moved_tetrahedra", 1 - len(same & {frozenset(nodes) for nodes in rest[1].tolist()}) / len(rest[1])
    server.delete(f"/v1/meshes/{another}")
    if other["stopped"] == "converged":
        change = abs(other["energy"] - answer["energy"]) / least
        if host["kind"] == "shell":
            yield "other_shell", 1 if change > OTHER else 0
        if host["kind"] == "solid" or change <= OTHER:
            yield f"{case['again']}_{host['kind']}", change
        if host["kind"] == "solid" and "fixed_vertices" in host:
            yield "moved_body", float(np.linalg.norm(vertices - np.array(answer["host"]["vertices"]), axis=1).max()) / surface.diagonal
