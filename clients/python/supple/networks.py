"""Elastic networks on surfaces, and their requests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Optional, Sequence, Tuple, Union

from .hosts import Host
from .jobs import Computation
from .network_answers import RelaxedNetwork, relaxed_network_from_wire
from .points import PointLike, point_to_wire
from .transport import Answer
from .weaves import given

NETWORKS = "/v1/embedded-systems"
FILE_TYPES = {"obj": "model/obj", "vtu": "application/x-vtu+xml", "svg": "image/svg+xml"}


@dataclass(frozen=True)
class PointsInFaces:
    """One point in each face, in the order of the faces.

    Attributes:
        barycentric: its barycentric coordinates in the face, nonnegative and with the sum 1.
    """

    barycentric: Tuple[float, float, float] = (0.25, 0.25, 0.5)

    def to_wire(self) -> Dict[str, Any]:
        return {"kind": "per_face", "barycentric": [float(b) for b in self.barycentric]}


@dataclass(frozen=True)
class PoissonDisk:
    """Random points of which no two are nearer than a radius.

    Attributes:
        radius: least geodesic distance of two points, mesh units.
        seed: the same seed gives the same points; 1 by default.
    """

    radius: float
    seed: Optional[int] = None

    def to_wire(self) -> Dict[str, Any]:
        return {"kind": "poisson_disk", "radius": float(self.radius), **given(seed=self.seed)}


@dataclass(frozen=True)
class Spring:
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
        return {"between": [int(self.start), int(self.end)], "rest_length": float(self.rest_length),
                "weight": float(self.weight)}


@dataclass(frozen=True)
class AdjacentFaces:
    """Springs between points whose faces share an edge; `rest_length` and `weight` are those of each `Spring`."""

    rest_length: float = 0.0
    weight: float = 1.0

    def to_wire(self) -> Dict[str, Any]:
        return {"kind": "adjacent_faces", "rest_length": float(self.rest_length), "weight": float(self.weight)}


@dataclass(frozen=True)
class VoronoiDual:
    """Springs between points whose geodesic Voronoi cells meet, which form a triangulation if the points are dense.
    `rest_length` and `weight` are those of each `Spring`."""

    rest_length: float = 0.0
    weight: float = 1.0

    def to_wire(self) -> Dict[str, Any]:
        return {"kind": "voronoi_dual", "rest_length": float(self.rest_length), "weight": float(self.weight)}


@dataclass(frozen=True)
class Membrane:
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
    youngs_modulus: Optional[float] = None
    poisson_ratio: Optional[float] = None
    thickness: Optional[float] = None
    rest_scale: Optional[float] = None

    def to_wire(self) -> Dict[str, Any]:
        material = given(youngs_modulus=self.youngs_modulus, poisson_ratio=self.poisson_ratio, thickness=self.thickness,
                         rest_scale=self.rest_scale)
        triangles: Any = {"kind": "voronoi_dual"}
        if self.triangles is not None:
            triangles = [[int(corner) for corner in corners] for corners in self.triangles]
        return {"triangles": triangles, **({"membrane": material} if material else {})}


NetworkPoints = Union[Sequence[PointLike], PointsInFaces, PoissonDisk]
"""The points of a network: a list, or a rule that gives them."""
NetworkSprings = Union[Sequence[Union[Spring, Tuple[int, int]]], AdjacentFaces, VoronoiDual]
"""The springs of a network: a list of `Spring` or of pairs of points (with rest length 0 and weight 1), or a rule."""


@dataclass(frozen=True)
class RelaxationOptions:
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
    tolerance: Optional[float] = None
    max_iterations: Optional[int] = None
    mollifier: Optional[str] = None
    mollifier_length: Optional[float] = None
    kept_strips: Optional[str] = None
    bending: Optional[str] = None

    def to_wire(self) -> Dict[str, Any]:
        groups = {
            "accuracy": given(tolerance=self.tolerance, mollifier_length=self.mollifier_length),
            "effects": given(mollifier=self.mollifier, kept_strips=self.kept_strips, bending=self.bending),
        }
        fields = given(method=self.method, spring_length=self.spring_length, max_iterations=self.max_iterations)
        return {**fields, **{name: group for name, group in groups.items() if group}}


def _points(points: NetworkPoints) -> Any:
    if isinstance(points, (PointsInFaces, PoissonDisk)):
        return points.to_wire()
    return [point_to_wire(point) for point in points]


def _springs(springs: NetworkSprings) -> Any:
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


def relaxation_document(
    mesh: str,
    points: NetworkPoints,
    springs: NetworkSprings,
    fixed_points: Sequence[int],
    options: Optional[RelaxationOptions],
    paths: bool,
    deadline: Optional[float],
    membrane: Optional[Membrane] = None,
    host: Optional[Host] = None,
) -> Dict[str, Any]:
    return {
        "mesh": mesh,
        "points": _points(points),
        "springs": _springs(springs),
        "fixed_points": [int(point) for point in fixed_points],
        **({} if membrane is None else membrane.to_wire()),
        **({} if host is None else {"host": host.to_wire()}),
        **({} if options is None else options.to_wire()),
        **given(paths=paths or None, deadline=deadline),
    }


def relaxation(document: Dict[str, Any]) -> Computation[RelaxedNetwork]:
    return Computation(NETWORKS, document, lambda answer: relaxed_network_from_wire(answer.json()))


def network_file(document: Dict[str, Any], kind: str) -> Computation[bytes]:
    def decode(answer: Answer) -> bytes:
        return answer.content

    if kind not in FILE_TYPES:
        raise ValueError(f"a network is written as {', '.join(sorted(FILE_TYPES))}, not {kind!r}")
    return Computation(NETWORKS, document, decode, accept=FILE_TYPES[kind])
