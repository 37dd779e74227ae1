"""Relaxed networks on surfaces, as dataclasses and numpy arrays.

Lengths are in mesh units, energies in the unit of the springs' weights times squared mesh units.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Optional, Tuple

from ._arrays import Array, Flags, Indices, Positions, Positions2
from .answers import Cost, Effect, Path
from .drawing import RED, Drawing, Line, joined
from .points import PlacedPoint, SurfacePoint
from .shown import Drawn, Shown
from .wire import ACCURACY, At, Shape, by_name, decode_all


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
    positions: Optional[Positions]
    vertices: Optional[Positions] = None


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
        stops: the load increments of a moving surface or of moved vertices, one for each of their positions
            that was reached; None for others.
    """

    vertices: Positions
    largest_displacement: float
    volume_ratio: Optional[float]
    tetrahedra: Optional[int]
    nodes: Optional[int]
    stops: Optional[Tuple[FollowedStop, ...]]


def _paths(springs: Any) -> Optional[Tuple[Path, ...]]:
    paths = decode_all(Path, [spring["path"] for spring in springs if "path" in spring])
    return tuple(paths) if springs and len(paths) == len(springs) else None


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
        stopped: "converged", "cut_locus", "step_too_small", "iteration_limit", or "deadline" or "memory" if time or memory ran
            out, and this is the best state until then.
        mollified: whether the energy at the end is the mollified one.
        at_vertices: points, ascending, that are in equilibrium at a vertex where the energy has a kink.
        loose_points: free points, ascending, without a spring of positive weight or a triangle; they did not move.
        warnings: a sentence for each fact that deserves attention.
    """

    points: Tuple[SurfacePoint, ...]
    positions: Positions
    springs: Annotated[Indices, Shape(-1, 2), At("/springs/*/between")]
    lengths: Annotated[Array, At("/springs/*/length")]
    energies: Annotated[Array, At("/springs/*/energy")]
    compressed: Annotated[Flags, At("/springs/*/compressed")]
    at_cut_locus: Annotated[Flags, At("/springs/*/at_cut_locus")]
    paths: Annotated[Optional[Tuple[Path, ...]], At("/springs", read=_paths)]
    triangles: Optional[Annotated[Indices, Shape(-1, 3)]]
    stretches: Annotated[Optional[Positions2], At("/membrane/*/stretches")]
    triangle_energies: Annotated[Optional[Array], At("/membrane/*/energy")]
    triangles_at_cut_locus: Annotated[Optional[Flags], At("/membrane/*/at_cut_locus")]
    host: Optional[HostState]
    energy: float
    terms: Annotated[Dict[str, float], At(read=by_name("energy"))]
    gradient_norm: float
    gradient_tolerance: Annotated[float, ACCURACY]
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
