"""Relaxed networks on surfaces, as dataclasses and numpy arrays.

Lengths are in mesh units, energies in the unit of the springs' weights times squared mesh units.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from .answers import Array, Cost, Effect, Path, cost_from_wire, effects_from_wire, path_from_wire
from .drawing import RED, Drawing, Line, joined
from .points import PlacedPoint, SurfacePoint, placed_points_from_wire, point_from_wire
from .shown import Drawn, Shown

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, repr=False)
class RelaxationStep(Shown):
    """One state of the iteration.

    Attributes:
        energy: energy of the network and its host.
        gradient_norm: norm of the energy's gradient by tangent coordinates of the free points; unit of the weights times mesh
            units.
        step_length: norm of the points' displacements from the state before, mesh units; 0 at the start.
        regularization: number that was added to the Hessian's diagonal, unit of the weights.
    """

    energy: float
    gradient_norm: float
    step_length: float
    regularization: float


@dataclass(frozen=True, repr=False)
class PartialRelaxation(Shown):
    """A network after the latest iteration of a running job.

    Attributes:
        iteration: iterations so far.
        energy, gradient_norm: as in `RelaxationStep`.
        positions: positions of the points, shape (points, 3), mesh units; None for more than 5000 points.
        vertices: positions of the host's vertices, shape (vertices, 3), mesh units; None for more than 5000, and on a rigid
            host.
    """

    iteration: int
    energy: float
    gradient_norm: float
    positions: Optional[Array]
    vertices: Optional[Array] = None


@dataclass(frozen=True, repr=False)
class FollowedStop(Shown):
    """One load increment: how a network followed a moving surface, or a network and its host moved vertices, to one of their
    positions.

    Attributes:
        energy, gradient_norm: as in `RelaxedNetwork`, at this position.
        iterations: iterations of the solver since the position before.
        load_steps: number of load steps into which the increment was divided.
        jumps: how often the increment lost its equilibrium path, so that network and host went to another equilibrium of less
            energy. Under the reverse motion they need not return to where they were.
        stopped: as in `RelaxedNetwork`.
        reached: fraction of the increment. It is below 1 if moved vertices cannot go on because elements of the host would be
            inverted or no equilibrium is found; this is then the last increment.
    """

    energy: float
    gradient_norm: float
    iterations: int
    load_steps: int
    stopped: str
    reached: float = 1.0
    jumps: int = 0


@dataclass(frozen=True, repr=False)
class HostState(Shown):
    """The state of a shell or a solid that deformed under a network, or of a surface that moved.

    Attributes:
        vertices: positions of the mesh's vertices, in their order, shape (vertices, 3), mesh units.
        largest_displacement: largest displacement of a vertex or an inner node, mesh units.
        volume_ratio: enclosed volume over that at rest; None for open surfaces.
        tetrahedra, nodes: those of a solid, whose nodes include the vertices of the mesh; None for other hosts.
        stops: the load increments of a moving surface or of moved vertices, one for each of their positions; None for others.
    """

    vertices: Array
    largest_displacement: float
    volume_ratio: Optional[float]
    tetrahedra: Optional[int]
    nodes: Optional[int]
    stops: Optional[Tuple[FollowedStop, ...]]


@dataclass(frozen=True, repr=False)
class RelaxedNetwork(Drawn):
    """A network in equilibrium on a surface, at a local minimum of its energy E: the sum of weight (length - rest_length)^2
    over its springs, plus the energies of a membrane and of a deformable host.

    Attributes:
        points: the points in equilibrium, in their order.
        positions: their positions in space, shape (points, 3), mesh units.
        springs: the points that each spring joins, shape (springs, 2).
        lengths: lengths of the springs, shape (springs,), mesh units.
        energies: energies of the springs, shape (springs,).
        compressed: whether each spring is shorter than its rest length, shape (springs,).
        at_cut_locus: whether another path of each spring is as short, within 1e-9, relative; shape (springs,).
        paths: paths of the springs; None if they were not requested.
        triangles: the corners of the membrane's triangles. Without a membrane, but with springs by `VoronoiDual`, the triples
            of points whose Voronoi cells meet, counterclockwise. Shape (triangles, 3), or None.
        stretches: principal stretches of the membrane's triangles, the greater first, shape (triangles, 2); None without one.
        triangle_energies: their energies, shape (triangles,); None without a membrane.
        triangles_at_cut_locus: whether a side of the triangle that is under compression has another shortest path, shape
            (triangles,); None without a membrane.
        host: the state of a host that deformed or moved; None for a rigid one.
        energy: E, negative only under gravity.
        terms: the terms of E by name: "geodesic_springs", "euclidean_springs", "membrane", and for a host "shell_membrane",
            "shell_bending", "shell_volume", "solid" and "gravity".
        gradient_norm: |grad E|, unit of the weights times mesh units; the requested bound is `gradient_tolerance`.
        iterations: number of iterations.
        history: the start and every step.
        stopped: "converged", "cut_locus", "step_too_small" or "iteration_limit".
        mollified: whether the energy at the end is the mollified one.
        at_vertices: points, ascending, that are in equilibrium at a vertex where the energy has a kink.
        loose_points: free points, ascending, without a spring of positive weight or a triangle; they did not move.
        warnings: a sentence for each fact that deserves attention.
    """

    points: Tuple[SurfacePoint, ...]
    positions: Array
    springs: Indices
    lengths: Array
    energies: Array
    compressed: Flags
    at_cut_locus: Flags
    paths: Optional[Tuple[Path, ...]]
    triangles: Optional[Indices]
    stretches: Optional[Array]
    triangle_energies: Optional[Array]
    triangles_at_cut_locus: Optional[Flags]
    host: Optional[HostState]
    energy: float
    terms: Dict[str, float]
    gradient_norm: float
    gradient_tolerance: float
    iterations: int
    history: Tuple[RelaxationStep, ...]
    stopped: str
    mollified: bool
    at_vertices: Tuple[int, ...]
    loose_points: Tuple[int, ...]
    warnings: Tuple[str, ...]
    effects: Tuple[Effect, ...]
    cost: Cost
    points_in_space: Tuple[PlacedPoint, ...] = ()

    @property
    def converged(self) -> bool:
        """Whether the network is in equilibrium within the tolerance."""
        return self.stopped == "converged"

    def _drawing(self) -> Drawing:
        polylines = [path.positions for path in self.paths] if self.paths else [self.positions[ends] for ends in self.springs]
        points = Line(self.positions, color=RED, marks=True)
        title = f"{len(self.positions)} points, {len(self.springs)} springs, energy {self.energy:.6g}"
        return Drawing("map", (Line(joined(polylines)), points), title=title)


def _paths(springs: Any) -> Optional[Tuple[Path, ...]]:
    paths = tuple(path for path in (path_from_wire(spring.get("path")) for spring in springs) if path is not None)
    return paths if len(paths) == len(springs) and springs else None


def _host(host: Optional[Mapping[str, Any]]) -> Optional[HostState]:
    if host is None:
        return None
    stops = host.get("stops")
    return HostState(
        vertices=np.asarray(host["vertices"], dtype=np.float64).reshape(-1, 3),
        largest_displacement=float(host["largest_displacement"]),
        volume_ratio=host.get("volume_ratio"),
        tetrahedra=host.get("tetrahedra"),
        nodes=host.get("nodes"),
        stops=None if stops is None else tuple(
            FollowedStop(s["energy"], s["gradient_norm"], s["iterations"], s["load_steps"], s["stopped"], s["reached"], s["jumps"])
            for s in stops
        ),
    )


def relaxed_network_from_wire(document: Mapping[str, Any]) -> RelaxedNetwork:
    springs = document["springs"]
    triangles = document.get("triangles")
    membrane = document.get("membrane")
    return RelaxedNetwork(
        points=tuple(point_from_wire(point) for point in document["points"]),
        positions=np.asarray(document["positions"], dtype=np.float64).reshape(-1, 3),
        springs=np.array([spring["between"] for spring in springs], dtype=np.int64).reshape(-1, 2),
        lengths=np.array([spring["length"] for spring in springs], dtype=np.float64),
        energies=np.array([spring["energy"] for spring in springs], dtype=np.float64),
        compressed=np.array([spring["compressed"] for spring in springs], dtype=np.bool_),
        at_cut_locus=np.array([spring["at_cut_locus"] for spring in springs], dtype=np.bool_),
        paths=_paths(springs),
        triangles=None if triangles is None else np.array(triangles, dtype=np.int64).reshape(-1, 3),
        stretches=None if membrane is None else np.array([t["stretches"] for t in membrane], dtype=np.float64).reshape(-1, 2),
        triangle_energies=None if membrane is None else np.array([t["energy"] for t in membrane], dtype=np.float64),
        triangles_at_cut_locus=None if membrane is None else np.array([t["at_cut_locus"] for t in membrane], dtype=np.bool_),
        host=_host(document.get("host")),
        energy=document["energy"],
        terms={term["name"]: float(term["energy"]) for term in document["terms"]},
        gradient_norm=document["gradient_norm"],
        gradient_tolerance=document["accuracy"]["gradient_tolerance"],
        iterations=document["iterations"],
        history=tuple(
            RelaxationStep(s["energy"], s["gradient_norm"], s["step_length"], s["regularization"])
            for s in document["history"]
        ),
        stopped=document["stopped"],
        mollified=document["mollified"],
        at_vertices=tuple(document["at_vertices"]),
        loose_points=tuple(document["loose_points"]),
        warnings=tuple(document["warnings"]),
        effects=effects_from_wire(document["effects"]),
        cost=cost_from_wire(document["cost"]),
        points_in_space=placed_points_from_wire(document),
    )


def partial_relaxation_from_wire(document: Mapping[str, Any]) -> PartialRelaxation:
    positions = document.get("positions")
    vertices = document.get("vertices")
    return PartialRelaxation(
        iteration=int(document["iteration"]),
        energy=float(document["energy"]),
        gradient_norm=float(document["gradient_norm"]),
        positions=None if positions is None else np.asarray(positions, dtype=np.float64).reshape(-1, 3),
        vertices=None if vertices is None else np.asarray(vertices, dtype=np.float64).reshape(-1, 3),
    )
