"""Optimized sites of Voronoi diagrams, compared with the suite's own energies and with moves of single sites."""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Optional, Tuple

import numpy as np

from _minima import steepest_descent, surroundings
from _shapes import ball, random_point, rotation, sheet, torus
from _surface import Point, Surface
from _unfolding import distances
from truth import Check, Server

ABOUT = ("Diagrams of 4 to 12 random sites that are optimized for one objective, on balls, tori and sheets. Energies are computed again from areas and from the least lengths over all "
         "unfolded sequences of faces; single sites are moved to see whether that lowers the energy.")

DIRECTIONS = 8
LENGTHS = (0.3, 0.1, 0.03, 0.01)
"""Distances by which a site is moved, in units of the mean cell size."""

CHECKS = {
    "energy": Check("The energy of edge_length, regularity or equal_area, from own lengths and the answered areas", 1e-9, "of the energy"),
    "descent": Check("By how much the energy rose in an iteration", 1e-12, "of the energy"),
    "minimum": Check("Steepest descent of a single site from an answer that is `converged`", 1e-4, "cell sizes"),
    "single_move": Check("By how much moving a single site lowers an energy that no step lowers (`step_too_small`)", 1e-3, "of the energy"),
}


def case(rng: np.random.Generator) -> Dict[str, Any]:
    shape = str(rng.choice(["ball", "torus", "sheet"]))
    if shape == "ball":
        vertices, faces = ball(rng, 1, float(rng.choice([0, 0.05])), float(rng.uniform(0.7, 1.5)))
    elif shape == "torus":
        vertices, faces = torus(int(rng.integers(8, 12)), int(rng.integers(5, 8)), float(rng.uniform(0.25, 0.45)), float(rng.choice([0, 0.05])), rng)
    else:
        vertices, faces = sheet(rng, int(rng.integers(5, 8)), int(rng.integers(5, 8)), float(rng.uniform(0, 0.2)), False)
    objective = str(rng.choice(["edge_length", "planarity", "regularity", "centroidal", "equal_area"]))
    return {"shape": shape, "vertices": vertices.tolist(), "faces": faces.tolist(), "objective": objective, "angle": float(rng.uniform(0, 2 * np.pi)),
            "sites": [random_point(rng, faces, inside=True) for _ in range(int(rng.integers(4, 13)))], "turn": rotation(rng).tolist(), "moved": int(rng.integers(2**31))}


def examine(server: Server, case: Dict[str, Any]) -> Iterator[Tuple[str, float]]:
    surface = Surface(case["vertices"], case["faces"])
    mesh = server.upload(case["vertices"], case["faces"])["id"]
    cell_size = float(np.sqrt(surface.area / len(case["sites"])))
    body = {"mesh": mesh, "sites": case["sites"], "objectives": {case["objective"]: 1}, "max_iterations": 60, "target_length": cell_size,
            "accuracy": {"tolerance": 1e-6}}
    answer = server.post("/v1/voronoi-optimizations", body)
    energy = answer["energy"]
    steps = np.array([step["energy"] for step in answer["history"]])
    yield "descent", max(0.0, float(np.diff(steps).max(initial=0))) / max(energy, 1e-12)
    own = _own_energy(surface, case["objective"], answer, cell_size)
    if own is not None:
        yield "energy", (own - energy) / max(energy, 1e-6)

    def energies(places: List[Point]) -> np.ndarray:
        """The energies with one site at each of some places and the others unchanged. All sites are fixed, so that the server moves none."""
        found = []
        for place in places:
            sites = answer["sites"][:moved] + [place] + answer["sites"][moved + 1:]
            fixed = {**body, "sites": sites, "fixed_sites": list(range(len(sites))), "max_iterations": 1}
            found.append(server.post("/v1/voronoi-optimizations", fixed)["history"][0]["energy"])
        return np.array(found)

    moved = case["moved"] % len(case["sites"])
    site = surface.at_vertex(answer["sites"][moved])
    if answer["stopped"] == "converged":
        yield "minimum", steepest_descent(surface, energy, energies(surroundings(surface, site, case["angle"], 6))) * cell_size
    if answer["stopped"] == "step_too_small":
        ways = [surface.walk(site, case["angle"] + 2 * np.pi * k / DIRECTIONS, length * cell_size) for k in range(DIRECTIONS) for length in LENGTHS]
        yield "single_move", max(0.0, energy - float(energies(ways).min())) / energy
    server.delete(f"/v1/meshes/{mesh}")


def _own_energy(surface: Surface, objective: str, answer: Any, cell_size: float) -> Optional[float]:
    """The energy of an objective: half the sum of squared residuals, with lengths in units of the mean cell size. None for objectives that the suite
    does not compute."""
    if objective == "equal_area":
        areas = np.array([cell["area"] for cell in answer["cells"]]) / cell_size**2
        return float(((areas - areas.mean()) ** 2).sum()) / 2
    corners = [corner["point"] for corner in answer["vertices"]]
    if objective == "regularity" and corners:
        found, _ = distances(surface, answer["sites"], corners)
        return float(sum((found[corner["sites"], k] ** 2).sum() for k, corner in enumerate(answer["vertices"]))) / cell_size**2 / 2
    if objective == "edge_length" and corners:
        found, _ = distances(surface, corners, corners)
        ends = [edge["vertices"] for edge in answer["edges"] if None not in edge["vertices"]]
        return float(sum((found[a, b] / cell_size - 1) ** 2 for a, b in ends)) / 2
    return None
