"""The requests of geodesics, distance fields, means and straightest paths on a mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from ._arrays import Numbers
from .answers import ExponentialMap, Field, Geodesic, KarcherMean
from .points import OnePoint, PlacedPoint, PointLike, Points, point_to_wire
from .request import Deadline, OnMesh, Reported, Request, Timeout
from .transport import Answer
from .wire import ACCURACY, EFFECT, At, decode, decode_all


def _pairs_to_wire(pairs: Sequence[Tuple[PointLike, PointLike]], name: str) -> List[Dict[str, Any]]:
    return [{"from": point_to_wire(start), "to": point_to_wire(end)} for start, end in pairs]


@dataclass(frozen=True)
class GeodesicsRequest(Request[List[Geodesic]], path="/v1/geodesics"):
    """The exact shortest paths between pairs of points, in their order.

    Attributes:
        mesh: the mesh, or its id.
        pairs: start and end of each path; pairs with a common start share a search if that is faster.
        derivatives: 0 for distances, 1 for gradients, 2 for Hessians too.
        paths: whether the paths are returned.
        mollifier: whether derivatives are smoothed near vertices: "on", "off" or "automatic".
        mollifier_length: smoothing length as a fraction of an edge, in (0, 0.5]; 1e-6 by default.
    """

    mesh: OnMesh
    pairs: Annotated[Sequence[Tuple[PointLike, PointLike]], At(write=_pairs_to_wire)]
    derivatives: int = 0
    paths: bool = False
    mollifier: Annotated[Optional[str], EFFECT] = None
    mollifier_length: Annotated[Optional[float], ACCURACY] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def decode(self, answer: Answer) -> List[Geodesic]:
        document = answer.json()
        by_pair: Dict[int, List[PlacedPoint]] = {}
        for entry in document.get("points_in_space", ()):
            by_pair.setdefault(int(entry["pointer"].split("/")[2]), []).append(decode(PlacedPoint, entry))
        geodesics = decode_all(Geodesic, document["results"])
        for pair, points in by_pair.items():
            geodesics[pair] = replace(geodesics[pair], points_in_space=tuple(points))
        return geodesics


@dataclass(frozen=True)
class FieldRequest(Request[Field], path="/v1/geodesic-fields"):
    """The distance from the nearest of the sources to every vertex.

    Attributes:
        mesh: the mesh, or its id.
        sources: at least one point.
        relative_error: guaranteed bound of every distance's relative error; 0 is exact.
        method: "windows", or "edge_graph" for the cheapest upper bound of the distances, without a guarantee.
        max_distance: distances beyond it need not be computed, mesh units.
    """

    mesh: OnMesh
    sources: Points
    relative_error: Annotated[float, ACCURACY] = 0.0
    method: Annotated[str, ACCURACY] = "windows"
    max_distance: Optional[float] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    @property
    def accept(self) -> str:
        return "application/octet-stream"

    def decode(self, answer: Answer) -> Field:
        distances = np.frombuffer(answer.content, dtype="<f8").astype(np.float64)
        distances[distances < 0] = np.inf
        bound = answer.headers.get("Supple-Relative-Error-Bound")
        largest = answer.headers.get("Supple-Largest-Distance")
        return Field(
            distances=distances,
            method=answer.headers.get("Supple-Method", self.method),
            relative_error_bound=None if bound is None else float(bound),
            seconds=float(answer.headers.get("Supple-Seconds", "nan")),
            largest_distance=None if largest is None else float(largest),
        )


@dataclass(frozen=True)
class KarcherMeanRequest(Request[KarcherMean], path="/v1/karcher-means"):
    """The point of least weighted mean squared geodesic distance. It is a local minimum, of which there may be several.

    Attributes:
        mesh: the mesh, or its id.
        points: at least one, all on one component.
        weights: one for each point, at least 0 and not all 0; None gives all points the same weight.
        tolerance: the iteration stops once |grad E| <= tolerance * diagonal of the bounding box. 1e-9 by default.
        method: "newton" (with exact second derivatives), "lbfgs" or "gradient_descent".
        start: where the search starts; None starts at the given point with the least objective.
        starts: number of searches. Each one after the first starts far from the ones before it; the lowest minimum is the
            answer. 1 by default.
        max_iterations: 200 by default.
        kept_fields: whether one distance field for each point is cached over all iterations: "on", "off" or "automatic".
    """

    mesh: OnMesh
    points: Points
    weights: Optional[Numbers] = None
    tolerance: Optional[float] = None
    method: Optional[str] = None
    start: Annotated[Optional[PointLike], At(write=point_to_wire)] = None
    starts: Optional[int] = None
    max_iterations: Optional[int] = None
    kept_fields: Annotated[Optional[str], EFFECT] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class ExponentialMapRequest(Request[ExponentialMap], path="/v1/exponential-maps"):
    """The end of the straightest path with a given direction and length.

    Attributes:
        mesh: the mesh, or its id.
        start: where it starts.
        tangent: direction and length in mesh units. Three numbers are a vector in space, of which the part in the plane of the
            start's face is used; two are coordinates in the frame of that face.
        trace: whether the path is returned.
    """

    mesh: OnMesh
    start: OnePoint
    tangent: Numbers
    trace: bool = True
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None
