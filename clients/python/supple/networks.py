"""Elastic networks on surfaces, and their requests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Optional, Sequence, Tuple, Union

from ._arrays import IndexList
from .hosts import Host
from .network_answers import RelaxedNetwork
from .points import PointLike, points_to_wire
from .request import Deadline, FileRequest, Kind, OnMesh, Reported, Request, Timeout
from .wire import ACCURACY, EFFECT, At, Sent


@dataclass(frozen=True)
class PointsInFaces(Sent, kind="per_face"):
    """One point in each face, in the order of the faces.

    Attributes:
        barycentric: its barycentric coordinates in the face, nonnegative and with the sum 1.
    """

    barycentric: Tuple[float, float, float] = (0.25, 0.25, 0.5)


@dataclass(frozen=True)
class PoissonDisk(Sent, kind="poisson_disk"):
    """Random points of which no two are nearer than a radius.

    Attributes:
        radius: least geodesic distance of two points, mesh units.
        seed: the same seed gives the same points; 1 by default.
    """

    radius: float
    seed: Optional[int] = None


@dataclass(frozen=True)
class Spring(Sent):
    """A spring between two points, with the energy weight (length - rest_length)^2.

    Attributes:
        start, end: indices of the points.
        rest_length: mesh units, at least 0.
        weight: energy per squared mesh unit, at least 0.
    """

    start: int
    end: int
    rest_length: float = 0.0
    weight: float = 1.0

    def to_wire(self) -> Dict[str, Any]:
        return {"between": [int(self.start), int(self.end)], "rest_length": self.rest_length, "weight": self.weight}


@dataclass(frozen=True)
class AdjacentFaces(Sent, kind="adjacent_faces"):
    """Springs between points whose faces share an edge; `rest_length` and `weight` are those of each `Spring`."""

    rest_length: float = 0.0
    weight: float = 1.0


@dataclass(frozen=True)
class VoronoiDual(Sent, kind="voronoi_dual"):
    """Springs between points whose geodesic Voronoi cells meet, which form a triangulation if the points are dense.
    `rest_length` and `weight` are those of each `Spring`."""

    rest_length: float = 0.0
    weight: float = 1.0


@dataclass(frozen=True)
class Membrane(Sent):
    """Compressible neo-Hookean triangles whose sides are shortest paths on the surface. They are at rest where the points start.

    Attributes:
        triangles: triples of indices of points; None takes all triples of points whose geodesic Voronoi cells meet.
        youngs_modulus: energy per cubed mesh unit, positive; 1 by default.
        poisson_ratio: in [-0.99, 0.4999]; 0.3 by default.
        thickness: mesh units, positive; 1 by default.
        rest_scale: ratio of rest lengths to lengths at the start, positive: below 1 the membrane is stretched at the start. 1 by
            default.
    """

    triangles: Optional[Sequence[Tuple[int, int, int]]] = None
    youngs_modulus: Annotated[Optional[float], At("/membrane/youngs_modulus")] = None
    poisson_ratio: Annotated[Optional[float], At("/membrane/poisson_ratio")] = None
    thickness: Annotated[Optional[float], At("/membrane/thickness")] = None
    rest_scale: Annotated[Optional[float], At("/membrane/rest_scale")] = None

    def to_wire(self) -> Dict[str, Any]:
        return {"triangles": {"kind": "voronoi_dual"}, **super().to_wire()}


NetworkPoints = Union[Sequence[PointLike], PointsInFaces, PoissonDisk]
"""The points of a network: a list, or a rule that gives them."""
NetworkSprings = Union[Sequence[Union[Spring, Tuple[int, int]]], AdjacentFaces, VoronoiDual]
"""The springs of a network: a list of `Spring` or of pairs of points (with rest length 0 and weight 1), or a rule."""


@dataclass(frozen=True)
class RelaxationOptions(Sent):
    """How an equilibrium is found. None stands for the server's default.

    Attributes:
        method: "newton" (with exact second derivatives), "lbfgs" or "gradient_descent".
        spring_length: "geodesic" for the length of the shortest path on the surface, "euclidean" for the distance in space.
        tolerance: the iteration stops once |grad E| <= tolerance * (largest weight) * (diagonal of the bounding box). 1e-9
            by default.
        max_iterations: 200 by default.
        mollifier: whether lengths of paths are smoothed next to vertices: "on", "off" or "automatic".
        mollifier_length: smoothing length as a fraction of an edge, in (0, 0.5]; 1e-6 by default.
        kept_strips: whether the strip of faces that a spring crossed in the state before is unfolded first, before a search:
            "on", "off" or "automatic". Never changes the answer.
        bending: whether the edges of a shell resist bending: "on", "off" or "automatic", which means on. It has no effect on
            other hosts.
    """

    method: Optional[str] = None
    spring_length: Optional[str] = None
    tolerance: Annotated[Optional[float], ACCURACY] = None
    max_iterations: Optional[int] = None
    mollifier: Annotated[Optional[str], EFFECT] = None
    mollifier_length: Annotated[Optional[float], ACCURACY] = None
    kept_strips: Annotated[Optional[str], EFFECT] = None
    bending: Annotated[Optional[str], EFFECT] = None


def _points_to_wire(points: NetworkPoints, name: str) -> Any:
    return points.to_wire() if isinstance(points, (PointsInFaces, PoissonDisk)) else points_to_wire(points)


def _springs_to_wire(springs: NetworkSprings, name: str) -> Any:
    if isinstance(springs, (AdjacentFaces, VoronoiDual)):
        return springs.to_wire()
    wire = []
    for spring in springs:
        if not isinstance(spring, Spring):
            if len(spring) != 2:
                raise ValueError(f"a spring as a tuple is (start, end), not {spring!r}")
            spring = Spring(*spring)
        wire.append(spring.to_wire())
    return wire


@dataclass(frozen=True)
class _Relaxation:
    """The fields of both requests."""

    mesh: OnMesh
    points: Annotated[NetworkPoints, At(write=_points_to_wire)]
    springs: Annotated[NetworkSprings, At(write=_springs_to_wire)]
    fixed_points: IndexList = ()
    membrane: Annotated[Optional[Membrane], At("")] = None
    host: Optional[Host] = None
    options: Annotated[Optional[RelaxationOptions], At("")] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class RelaxationRequest(_Relaxation, Request[RelaxedNetwork], path="/v1/embedded-systems"):
    """The equilibrium of an elastic network whose points slide on the surface: a local minimum of the energy E near the start.
    E is the sum of weight (length - rest_length)^2 over the springs, plus the energies of a membrane's triangles and of a
    deformable host.

    Attributes:
        mesh: the mesh, or its id.
        points: the points at the start, at least one: a list of points, `PointsInFaces` or `PoissonDisk`.
        springs: a list of `Spring` or of pairs of indices of points, `AdjacentFaces` or `VoronoiDual`. A spring joins two
            different points of one component.
        fixed_points: indices of fixed points.
        membrane: triangles between the points, besides the springs or instead of them.
        host: a `Shell` or a `Solid` whose surface is the mesh and which deforms under the network, or a `Moving` surface; None
            for a rigid surface. `RelaxedNetwork.host` is its state at the end.
        options: options of the search.
        paths: whether the paths of the springs are returned.

    The `status().partial` of its job is the network after the latest iteration.

    Raises `InvalidNetwork` if points and springs do not fit together, with the codes "network.spring",
    "network.triangle", "network.collapsed" (a triangle without area), "network.fixed_point", "network.unreachable" and
    "network.radius". Raises `InvalidHost` if the mesh is not suitable for the host ("host.open_surface",
    "solid.not_filled", ...). `faults` names the entries.
    """

    paths: bool = False


@dataclass(frozen=True)
class NetworkFileRequest(_Relaxation, FileRequest, path="/v1/embedded-systems"):
    """A relaxed network as a file. `kind` is "obj" or "vtu" (a polyline along each spring's path, and the host if it
    deformed or moved, mesh units), or "svg" (energy and gradient norm over the iterations). The other fields are those
    of `RelaxationRequest`."""

    TYPES = {"obj": "model/obj", "vtu": "application/x-vtu+xml", "svg": "image/svg+xml"}
    kind: Kind = "obj"
