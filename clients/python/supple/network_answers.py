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
        energy: of the network.
        gradient_norm: of the energy by tangent coordinates of the free points; unit of the weights times mesh units.
        step_length: root of the sum of the points' squared ways to get there, mesh units; 0 for the start.
        regularization: what was added to the Hessian's diagonal, unit of the weights.
    """

    energy: float
    gradient_norm: float
    step_length: float
    regularization: float


@dataclass(frozen=True, repr=False)
class PartialRelaxation(Shown):
    """A network on its way, while it is relaxed.

    Attributes:
        iteration: iterations so far.
        energy, gradient_norm: as in `RelaxationStep`.
        positions: where the points are, shape (points, 3), mesh units; None for more than 5000 points.
        vertices: where the vertices of a host that gives way are, shape (vertices, 3), mesh units; None for more than 5000
            and on a rigid host.
    """

    iteration: int
    energy: float
    gradient_norm: float
    positions: Optional[Array]
    vertices: Optional[Array] = None


@dataclass(frozen=True, repr=False)
class FollowedStop(Shown):
    """How a network followed a moving surface, or a network and its host moved vertices, to one of their positions.

    Attributes:
        energy, gradient_norm: as in `RelaxedNetwork`, there.
        iterations: steps of the solver on the way from the position before.
        load_steps: parts that this way was divided into.
        jumps: how often an equilibrium was lost on this way, so that network and host went to another one of less energy.
            On the way back they need not return to where they were.
        stopped: as in `RelaxedNetwork`.
        reached: share of the way from the position before; below 1 where moved vertices cannot go on, since elements of the
            host would be turned inside out, or no equilibrium is found: it is then the last stop.
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
    """A shell or a solid that gave way under a network, or a surface that moved.

    Attributes:
        vertices: where the vertices of the mesh are, in their order, shape (vertices, 3), mesh units.
        largest_displacement: longest way of a vertex, or of a node inside, mesh units.
        volume_ratio: enclosed volume over that at rest; None for open surfaces.
        tetrahedra, nodes: of a solid, the vertices of the mesh among its nodes; None for others.
        stops: of a moving surface or of moved vertices, one for each of their positions; None for others.
    """

    vertices: Array
    largest_displacement: float
    volume_ratio: Optional[float]
    tetrahedra: Optional[int]
    nodes: Optional[int]
    stops: Optional[Tuple[FollowedStop, ...]]


@dataclass(frozen=True, repr=False)
class RelaxedNetwork(Drawn):
    """A network of springs at rest on a surface: E = sum weight (length - rest_length)^2, plus the energies of a membrane and
    of a host that gives way, has a local minimum.

    Attributes:
        points: where the points came to rest, in their order.
        positions: the same in space, shape (points, 3), mesh units.
        springs: the points that each spring joins, shape (springs, 2).
        lengths: of the springs, shape (springs,), mesh units.
        energies: of the springs, shape (springs,).
        compressed: springs shorter than their rest length, shape (springs,).
        at_cut_locus: springs for which another path is as short, within 1e-9, relative; shape (springs,).
        paths: of the springs; None where they were not asked for.
        triangles: the corners of the membrane's triangles; without a membrane triples of points whose Voronoi cells meet,
            counterclockwise, where the springs are `VoronoiDual`. Shape (triangles, 3), or None.
        stretches: principal stretches of the membrane's triangles, the greater first, shape (triangles, 2); None without one.
        triangle_energies: their energies, shape (triangles,); None without one.
        triangles_at_cut_locus: whether a side that pushes has another shortest path, shape (triangles,); None without one.
        host: where a host that gives way or moves came to be; None on a rigid one.
        energy: E, negative only under gravity.
        terms: what it consists of, by name: "geodesic_springs", "euclidean_springs", "membrane", and of a host
            "shell_membrane", "shell_bending", "shell_volume", "solid" and "gravity".
        gradient_norm: |grad E|, unit of the weights times mesh units; the bound that was asked for is `gradient_tolerance`.
        iterations: steps taken.
        history: the start and every step.
        stopped: "converged", "cut_locus", "step_too_small" or "iteration_limit".
        mollified: whether the energy at the end is the mollified one.
        at_vertices: points that came to rest at a vertex where the energy has a kink, ascending.
        loose_points: free points that no spring of positive weight and no triangle holds, ascending; they stayed where they were.
        warnings: what deserves attention, one sentence each.
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
        ways = [path.positions for path in self.paths] if self.paths else [self.positions[ends] for ends in self.springs]
        points = Line(self.positions, color=RED, marks=True)
        title = f"{len(self.positions)} points, {len(self.springs)} springs, energy {self.energy:.6g}"
        return Drawing("map", (Line(joined(ways)), points), title=title)


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
