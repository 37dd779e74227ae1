"""The server's answers as dataclasses and numpy arrays.

Lengths are in mesh units (the unit of the mesh's coordinates), angles in radians, times in seconds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Optional, Tuple

import numpy as np

from ._arrays import Array, Indices, Positions, Vector3
from .drawing import RED, Drawing, Line
from .points import PlacedPoint, SurfacePoint
from .shown import Drawn, Shown
from .wire import ACCURACY, LOCAL, At, by_name


@dataclass(frozen=True, repr=False)
class Cost(Shown):
    """The bill of a computation.

    Attributes:
        seconds: wall-clock duration on the server.
        stages: seconds by stage; stages of parallel work add up the time of all threads.
        quantities: counted work by name, such as "windows".
    """

    seconds: float
    stages: Annotated[Dict[str, float], At(read=by_name("seconds"))]
    quantities: Dict[str, float]


@dataclass(frozen=True, repr=False)
class Effect(Shown):
    """An optional part of a computation: whether it ran, why or why not, how often, and for how many seconds."""

    name: str
    ran: bool
    why: str
    count: int
    seconds: float


@dataclass(frozen=True, repr=False)
class MeshInfo(Shown):
    """The server's description of a mesh.

    Attributes:
        id: SHA-256 of the canonical content; equal meshes have equal ids.
        created: time of the first upload, RFC 3339 in UTC.
        vertices, faces, edges: numbers.
        components: number of connected components.
        boundary_loops: number of closed boundary curves.
        genus: number of handles, summed over the components.
        saddle_vertices: interior vertices whose angles sum to more than 2 pi; shortest paths bend there.
        lower, upper: corners of the bounding box; `diagonal` is its length.
        area: sum of the faces' areas, mesh units squared.
        edge_min, edge_mean, edge_max: edge lengths.
        angle_min, angle_max: corner angles, radians.
        warnings: a sentence for each repair and for each fact that deserves attention.
    """

    id: str
    created: str
    vertices: int
    faces: int
    edges: int
    components: int
    boundary_loops: int
    genus: int
    saddle_vertices: int
    lower: Annotated[Vector3, At("/bounding_box/lower")]
    upper: Annotated[Vector3, At("/bounding_box/upper")]
    diagonal: Annotated[float, At("/bounding_box/diagonal")]
    area: float
    edge_min: Annotated[float, At("/edge_length/min")]
    edge_mean: Annotated[float, At("/edge_length/mean")]
    edge_max: Annotated[float, At("/edge_length/max")]
    angle_min: Annotated[float, At("/angle/min")]
    angle_max: Annotated[float, At("/angle/max")]
    warnings: Tuple[str, ...]


def _remaining(vertices: Any) -> Tuple[Tuple[int, ...], ...]:
    return tuple(() if one is None else tuple(one) if isinstance(one, list) else (one,) for one in vertices)


@dataclass(frozen=True, repr=False)
class MeshRepair(Shown):
    """What the repairs of an uploaded mesh have changed.

    Attributes:
        made: names of the repairs that have changed something, in their order.
        welded_vertices: vertices that were joined to an earlier one.
        weld_distance: distance up to which they were joined, mesh units: the tolerance, or without one the widest gap of a
            crack; 0 if welding was not requested.
        dropped_degenerate_faces: degenerate faces that were dropped.
        dropped_duplicate_faces: faces that were dropped because an earlier one has their vertices.
        split_edges: edges with more than two faces at which the faces were separated.
        split_vertices: vertices that were split into several.
        removed_vertices: vertices that were removed since all of their faces were dropped, without welded ones.
        vertices: for each uploaded vertex its vertices in the mesh: one, several if it was split, none if it was removed.
        faces: for each uploaded face its face in the mesh, -1 if it was dropped; shape (uploaded faces,).
    """

    made: Tuple[str, ...]
    welded_vertices: int
    weld_distance: float
    dropped_degenerate_faces: int
    dropped_duplicate_faces: int
    split_edges: int
    split_vertices: int
    removed_vertices: int
    vertices: Annotated[Tuple[Tuple[int, ...], ...], At(read=_remaining)]
    faces: Indices


@dataclass(frozen=True, repr=False)
class Path(Drawn):
    """A path on the surface, straight between neighbouring points.

    Attributes:
        points: its start, its crossings of edges, the vertices that it passes, and its end.
        positions: their positions in space, shape (n, 3).
        vertices: for each point the index of the vertex that it is, or None.
    """

    points: Annotated[Tuple[SurfacePoint, ...], At("")]
    positions: Annotated[Positions, At("/*/position")]
    vertices: Annotated[Tuple[Optional[int], ...], At("/*/vertex")]

    def length(self) -> float:
        return float(np.linalg.norm(np.diff(self.positions, axis=0), axis=1).sum())

    def _drawing(self) -> Drawing:
        ends = Line(self.positions[[0, -1]], color=RED, marks=True)
        return Drawing("map", (Line(self.positions), ends), title=f"length {self.length():.6g}")


@dataclass(frozen=True, repr=False)
class Gradient(Shown):
    """First derivatives of a distance.

    Attributes:
        barycentric: with respect to the three barycentric coordinates of the first end, then of the second; shape (6,),
            mesh units. Meaningful for variations of sum zero at either end.
        tangent: with respect to displacements of the first end, then of the second, in `Geodesic.frames`; shape (4,),
            dimensionless.
    """

    barycentric: Array
    tangent: Array


@dataclass(frozen=True, repr=False)
class Hessian(Shown):
    """Second derivatives, symmetric; variables as in `Gradient`. Shapes (6, 6), mesh units, and (4, 4), 1 / mesh unit."""

    barycentric: Array
    tangent: Array


def _axes(ends: Any) -> Array:
    return np.array([ends["from"]["axes"], ends["to"]["axes"]], dtype=np.float64)


@dataclass(frozen=True, repr=False)
class Geodesic(Drawn):
    """A shortest path between two points.

    Attributes:
        distance: its length; infinity if `unreachable`.
        unreachable: whether the points lie on different components; all further attributes are empty then.
        unique: whether no other shortest path was found, within 1e-9 relative.
        near_cut_locus: whether a path from another direction is longer by less than 1e-6, relative.
        competing_excess: length by which the shortest path from another direction exceeds the distance; infinity if none was
            found.
        pinned_at: saddle or boundary vertices that the path bends at, from the first end to the second.
        differentiable: False if the ends coincide; None if no derivatives were requested.
        gradient, hessian: the derivatives that were requested.
        frames: orthonormal frames of the ends' faces in space, shape (2, 2, 3): end, axis, coordinate. None without
            derivatives.
        path: None if it was not requested.
        points_in_space: the nearest points on the surface of those ends that were given as points in space.
    """

    distance: float = float("inf")
    unreachable: bool = False
    unique: bool = True
    near_cut_locus: bool = False
    competing_excess: float = float("inf")
    pinned_at: Tuple[int, ...] = ()
    differentiable: Optional[bool] = None
    gradient: Optional[Gradient] = None
    hessian: Optional[Hessian] = None
    frames: Annotated[Optional[Array], At(read=_axes)] = None
    path: Optional[Path] = None
    points_in_space: Annotated[Tuple[PlacedPoint, ...], LOCAL] = ()

    def _drawing(self) -> Optional[Drawing]:
        return None if self.path is None else self.path._drawing()


@dataclass(frozen=True, repr=False)
class Field(Shown):
    """Distances from a set of sources to every vertex.

    Attributes:
        distances: shape (vertices,), mesh units; infinity where unreached.
        method: "windows" or "edge_graph".
        relative_error_bound: guaranteed bound of every distance's relative error; None if the method gives none.
        seconds: duration of the computation on the server.
        largest_distance: largest distance of a source that is a point in space from the surface, mesh units; None
            without such a source.
    """

    distances: Array
    method: str
    relative_error_bound: Optional[float]
    seconds: float
    largest_distance: Optional[float] = None


@dataclass(frozen=True, repr=False)
class KarcherStep(Shown):
    """One state of the iteration: objective (mesh units squared), norm of its gradient (mesh units), length of the step to it
    (mesh units) and what that step added to the Hessian's diagonal (dimensionless)."""

    objective: float
    gradient_norm: float
    step_length: float
    regularization: float


@dataclass(frozen=True, repr=False)
class KarcherMean(Shown):
    """The point of least weighted mean squared geodesic distance: E = sum w_i g_i^2 / (2 sum w_i).

    Attributes:
        mean: the point; `position` is its position in space.
        objective: E at the mean, mesh units squared.
        gradient_norm: |grad E| at the mean, mesh units; the requested bound is `gradient_tolerance`.
        iterations: steps from the start that led to the mean.
        start: number of that start, from 0.
        stopped: "converged", "kink", "step_too_small" or "iteration_limit".
        history: the start and every step.
        points_in_space: the nearest points on the surface of the request's points in space.
    """

    mean: SurfacePoint
    position: Vector3
    objective: float
    gradient_norm: float
    gradient_tolerance: Annotated[float, ACCURACY]
    iterations: int
    start: int
    stopped: str
    history: Tuple[KarcherStep, ...]
    effects: Tuple[Effect, ...]
    cost: Cost
    points_in_space: Tuple[PlacedPoint, ...] = ()

    @property
    def converged(self) -> bool:
        """Whether the mean is a minimum within the tolerance, smooth or at a kink."""
        return self.stopped in ("converged", "kink")


@dataclass(frozen=True, repr=False)
class ExponentialMap(Drawn):
    """The end of a straightest path.

    Attributes:
        end: the point; `position` is its position in space.
        end_direction: unit tangent of the path at its end, in space.
        length: length of the path; less than requested only if the path ends at the boundary.
        reached_boundary: whether it ends there.
        transport_angle: angle in radians by which parallel transport along the path rotates coordinates in the frame of the
            start's face into those in the frame of the end's face.
        trace: the path; None if it was not requested.
        points_in_space: the nearest points on the surface of the request's points in space.
    """

    end: SurfacePoint
    position: Vector3
    end_direction: Vector3
    length: float
    reached_boundary: bool
    transport_angle: float
    trace: Optional[Path]
    points_in_space: Tuple[PlacedPoint, ...] = ()

    def _drawing(self) -> Optional[Drawing]:
        return None if self.trace is None else self.trace._drawing()
