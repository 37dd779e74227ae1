"""Elastic networks and membranes on rigid and moving surfaces, compared with energies from the suite's own distances."""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Tuple

import numpy as np

from _minima import SHARES, steepest_descent, surroundings
from _networks import Network, permuted
from _shapes import Renumbering, ball, random_point, rotation, sheet, torus
from _surface import Point, Surface
from _unfolding import distances
from truth import Check, Refusal, Server

ABOUT = ("Random networks of 6 to 40 points and membranes on tori, balls and sheets, with springs that pull and push. Energies are computed again from the least lengths over all "
         "unfolded sequences of faces, single points are moved to see whether that lowers the energy, and the same network is asked about in another order, on the moved, turned and "
         "renumbered mesh, and on a surface that moves away and back.")

SAME = 1e-9
"""Relative difference of energies of one equilibrium. Gradients are zero up to 1e-9, so that energies are exact up to the square of that."""
OTHER = 1e-6
"""Relative difference of energies above which they belong to different equilibria, between which rounding may decide."""
JUMP = 1e-7
"""By the documents, jumps of less than this fraction of the energy are not detected."""

CHECKS = {
    "energy": Check("The energy, from that of own lengths, where no point is within 1e-6 of a vertex but not at it", 1e-12, "stiffness"),
    "length": Check("Lengths of springs, from own lengths, but for ends within 1e-6 of a vertex that are not at it", 1e-12, "diagonals"),
    "minimum": Check("Steepest descent of a single point from an answer that is `converged`, where no point is beside a vertex like that", 1e-8, "stiffness"),
    "cut_locus": Check("By how much moving a single point lowers an energy that no step lowers (`cut_locus`), where no point is beside a vertex like that", 1e-6, "of the energy"),
    "held_ends": Check("By how much the other points lower such an energy while the ends at cut loci are held", 1e-6, "of the energy"),
    "order": Check("The energy after points and springs are named in another order", SAME, "of the energy"),
    "renumbering": Check("The energy after vertices, faces and their corners are renumbered", SAME, "of the energy"),
    "rigid_motion": Check("The energy on the mesh that is moved and turned", SAME, "of the energy"),
    "other_equilibrium": Check("Cases that end in another equilibrium after one of these three", 0, "1 if it does", 0.01),
    "turned_host": Check("The energy after the surface has moved and turned rigidly, from rest", SAME, "of the energy"),
    "nudged_host": Check("The energy after the surface was deformed by 1e-9 of its diagonal, where no jump is counted", 2 * JUMP, "of the energy"),
    "there_and_back": Check("The energy after the surface was deformed by up to 2 % of its diagonal and back, where no jump is counted", 2 * JUMP, "of the energy"),
    "moved_length": Check("Lengths of springs on the deformed surface, from own lengths, but for ends within 1e-6 of a vertex that are not at it", 1e-12, "diagonals"),
}


def _mesh(rng: np.random.Generator) -> Tuple[str, np.ndarray, np.ndarray]:
    kind = str(rng.choice(["fine torus", "torus", "ball", "sheet"], p=[0.04, 0.56, 0.2, 0.2]))
    if kind == "fine torus":
        return (kind, *torus(24, 12, 1 / 3, 0, rng))
    if kind == "torus":
        return (kind, *torus(int(rng.integers(7, 14)), int(rng.integers(4, 8)), float(rng.uniform(0.25, 0.45)), float(rng.choice([0, 0.1])), rng))
    if kind == "ball":
        return (kind, *ball(rng, 1, float(rng.choice([0, 0.1])), float(rng.uniform(0.5, 2))))
    return (kind, *sheet(rng, int(rng.integers(5, 9)), int(rng.integers(5, 9)), float(rng.uniform(0, 0.4)), bool(rng.random() < 0.3)))


def case(rng: np.random.Generator) -> Dict[str, Any]:
    kind, vertices, faces = _mesh(rng)
    jam = kind == "fine torus"  # many points with compressed springs, some of which reach equilibrium at cut loci
    count = int(rng.integers(25, 41)) if jam else int(rng.integers(6, 21))
    points = [random_point(rng, faces, inside=True) for _ in range(count)]
    between, _ = distances(Surface(vertices, faces), points, points)
    low, high = (0.8, 1.3) if jam else [(0.8, 1.2), (0.6, 1.3), (0.3, 0.9)][int(rng.integers(3))]
    nearest = jam or rng.random() < 0.5
    pairs = set()
    for i in range(count):
        others = [int(j) for j in (np.argsort(between[i]) if nearest else rng.permutation(count)) if j != i][:4 if jam else int(rng.integers(2, 5))]
        pairs |= {(min(i, j), max(i, j)) for j in others}
    made: Dict[str, Any] = {
        "kind": kind, "vertices": vertices.tolist(), "faces": faces.tolist(), "points": points, "fixed": list(range(int(rng.integers(0, 4)))),
        "springs": [{"between": [i, j], "rest_length": float(between[i, j] * rng.uniform(low, high)), "weight": float(rng.uniform(0.5, 2))} for i, j in sorted(pairs)],
        "turn": rotation(rng).tolist(), "slight_turn": float(rng.uniform(-0.3, 0.3)), "shift": rng.uniform(-1, 1, 3).tolist(), "waves": rng.normal(size=(2, 3, 3)).tolist(),
        "amplitude": float(rng.choice([0.002, 0.005, 0.02])), "again": str(rng.choice(["order", "renumbering", "rigid_motion"])),
        "host": str(rng.choice(["turned_host", "nudged_host", "there_and_back"])), "seed": int(rng.integers(2**31)), "angle": float(rng.uniform(0, 2 * np.pi))}
    if rng.random() < 0.2 and count >= 8 and not jam:
        made["springs"] = made["springs"][:int(rng.integers(0, 4))]
        made["membrane"] = {"youngs_modulus": float(10 ** rng.uniform(-1, 1)), "poisson_ratio": float(rng.uniform(0, 0.45)), "thickness": float(rng.uniform(0.05, 1)),
                            "rest_scale": float(rng.uniform(0.7, 1.2))}
        made["fixed"] = [0, 1, 2]
    return made


def _relax(server: Server, mesh: str, case: Dict[str, Any], triangles: Any = None, **changed: Any) -> Any:
    body = {"mesh": mesh, "points": case["points"], "springs": case["springs"], "fixed_points": case["fixed"]}
    if "membrane" in case:
        body |= {"membrane": case["membrane"], "triangles": {"kind": "voronoi_dual"} if triangles is None else triangles}
    return server.post("/v1/embedded-systems", body | changed)


def examine(server: Server, case: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    surface, rng = Surface(case["vertices"], case["faces"]), np.random.default_rng(case["seed"])
    mesh = server.upload(case["vertices"], case["faces"])["id"]
    try:
        answer = _relax(server, mesh, case)
    except Refusal as refusal:
        if refusal.code == "network.collapsed" and "membrane" in case:  # points of a coarse triangulation may lie on one line
            return
        raise
    triangles = answer.get("triangles", [])
    at_rest, _ = distances(surface, case["points"], case["points"]) if triangles else (np.zeros((1, 1)), None)
    network = Network(case["springs"], triangles, case.get("membrane"), at_rest)
    points = [surface.nearest_vertex(point) for point in answer["points"]]
    exact = not any(surface.beside_vertex(point) for point in answer["points"])
    free = [i for i in range(len(points)) if i not in case["fixed"]]
    places = {i: surroundings(surface, points[i], case["angle"]) for i in free}
    found, _ = distances(surface, points, points + [place for i in free for place in places[i]])
    between = found[:, :len(points)]
    scale, energy = network.scale(between), network.energy(between)
    if exact and not answer["mollified"]:  # a mollified energy is that of mollified lengths
        yield "energy", (answer["energy"] - energy) / scale
    yield from _lengths("length", surface, network, answer, between)
    if exact:
        yield from _moves(server, mesh, case, surface, network, answer, found, free)
    least = max(answer["energy"], 1e-6 * scale)
    yield from _again(server, mesh, case, surface, answer, least, rng)
    if answer["stopped"] == "converged":
        yield from _on_a_moving_surface(server, mesh, case, surface, network, answer, scale, least)
    server.delete(f"/v1/meshes/{mesh}")


def _lengths(name: str, surface: Surface, network: Network, answer: Any, between: np.ndarray) -> Iterator[Tuple[str, float]]:
    beside = np.array([surface.beside_vertex(point) for point in answer["points"]], dtype=bool)
    compared = ~beside[network.ends].any(axis=1)
    if compared.any():
        own = between[network.ends[:, 0], network.ends[:, 1]]
        said = np.array([spring["length"] for spring in answer["springs"]])
        yield name, float(np.abs(said - own)[compared].max()) / surface.diagonal


def _moves(server: Server, mesh: str, case: Dict[str, Any], surface: Surface, network: Network, answer: Any, found: np.ndarray, free: List[int]) -> Iterator[Tuple[str, float]]:
    """Moves single points, which shows whether the energy of an answer can still be lowered."""
    count = len(answer["points"])
    between, energy = found[:, :count], network.energy(found[:, :count])
    each = (found.shape[1] - count) // max(len(free), 1)
    steepest, fall = 0.0, 0.0
    for k, point in enumerate(free):
        energies = network.energies_with(between, point, found[:, count + k * each:count + (k + 1) * each])
        steepest = max(steepest, steepest_descent(surface, energy, energies))
        falls = (energy - energies).reshape(-1, len(SHARES))
        fall = max(fall, float(np.where((falls > 0).all(axis=1), falls.max(axis=1), 0).max()))
    if answer["stopped"] == "converged":
        yield "minimum", steepest / (network.largest_weight * surface.diagonal)
    if answer["stopped"] == "cut_locus":
        yield "cut_locus", fall / energy
        held = {i for spring in answer["springs"] if spring["at_cut_locus"] for i in spring["between"]}
        held |= {i for corners, triangle in zip(answer.get("triangles", []), answer.get("membrane", [])) if triangle["at_cut_locus"] for i in corners}
        other = _with_rest(server, mesh, case, answer, fixed_points=sorted(held | set(case["fixed"])))
        if other is not None:
            yield "held_ends", max(0.0, energy - other["energy"]) / energy


def _with_rest(server: Server, mesh: str, case: Dict[str, Any], answer: Any, **changed: Any) -> Any:
    """Continues from an answer. A membrane is at rest at its start, so that only networks can be continued."""
    return None if "membrane" in case else _relax(server, mesh, case, points=answer["points"], **changed)


def _again(server: Server, mesh: str, case: Dict[str, Any], surface: Surface, answer: Any, least: float, rng: np.random.Generator) -> Iterator[Tuple[str, float]]:
    triangles = answer.get("triangles")
    if case["again"] == "order":
        order, springs = rng.permutation(len(case["points"])), rng.permutation(len(case["springs"]))
        index = np.argsort(order)
        changed: Dict[str, Any] = {
            "points": permuted(order, case["points"]), "fixed_points": [int(index[i]) for i in case["fixed"]],
            "springs": [{**spring, "between": [int(index[i]) for i in spring["between"]]} for spring in permuted(springs, case["springs"])]}
        if triangles is not None:
            triangles = [[int(index[i]) for i in corners] for corners in permuted(rng.permutation(len(triangles)), triangles)]
        other = _relax(server, mesh, case, triangles, **changed)
    else:
        renumbered = Renumbering(rng, surface)
        turned = surface.vertices @ np.array(case["turn"]).T + np.array(case["shift"])
        new = case["again"] == "renumbering"
        another = server.upload(renumbered.vertices if new else turned, renumbered.faces if new else surface.faces)["id"]
        other = _relax(server, another, case, triangles, points=[renumbered.point(point) if new else point for point in case["points"]])
        server.delete(f"/v1/meshes/{another}")
    if other["stopped"] == answer["stopped"] == "converged":
        change = abs(other["energy"] - answer["energy"]) / least
        yield "other_equilibrium", 1 if change > OTHER else 0
        if change <= OTHER:
            yield case["again"], change


def _on_a_moving_surface(server: Server, mesh: str, case: Dict[str, Any], surface: Surface, network: Network, answer: Any, scale: float, least: float) -> Iterator[Tuple[str, float]]:
    if "membrane" in case:
        start: List[Point] = case["points"]  # where the membrane is at rest
    else:
        start = answer["points"]
    vertices = surface.vertices
    if case["host"] == "turned_host":
        c, s = np.cos(case["slight_turn"]), np.sin(case["slight_turn"])
        ways = [vertices @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T + 0.1 * np.array(case["shift"])]
    else:
        amount = (1e-9 if case["host"] == "nudged_host" else case["amplitude"]) * surface.diagonal
        phase = vertices @ np.array(case["waves"][0]) * (2 / surface.diagonal)
        wave = np.sin(phase) @ np.array(case["waves"][1])
        ways = [vertices + amount * wave / np.linalg.norm(wave, axis=1).max()]
        if case["host"] == "there_and_back":
            ways.append(vertices)
    other = _relax(server, mesh, case, answer.get("triangles"), points=start, host={"kind": "moving", "positions": [way.tolist() for way in ways]})
    if any(stop["stopped"] == "iteration_limit" for stop in other["host"]["stops"]):
        return
    jumps = sum(stop["jumps"] for stop in other["host"]["stops"])
    if case["host"] == "turned_host":
        yield "turned_host", np.inf if jumps else (other["energy"] - answer["energy"]) / least
    elif not jumps:
        # If all lengths d change by the fraction s, the sum E of w (d - L)^2 changes by at most 2 s sqrt(E * sum of w d^2).
        stretch = 0.0 if case["host"] == "there_and_back" else 5 * float(np.abs(surface.moved(ways[-1]).length / surface.length - 1).max())
        caused = 2 * stretch * float(np.sqrt(answer["energy"] * scale))
        yield case["host"], max(0.0, abs(other["energy"] - answer["energy"]) - caused) / least
    if case["host"] == "nudged_host" and len(network.ends):
        moved = surface.moved(other["host"]["vertices"])
        between, _ = distances(moved, other["points"], other["points"])
        yield from _lengths("moved_length", moved, network, other, between)
