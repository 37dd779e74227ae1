"""The requests of computations on a mesh, and the functions that decode their answers."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from .answers import (
    ExponentialMap,
    Field,
    Geodesic,
    KarcherMean,
    exponential_map_from_wire,
    geodesic_from_wire,
    karcher_mean_from_wire,
)
from .jobs import Computation
from .points import PlacedPoint, PointLike, placed_points_from_wire, point_to_wire
from .transport import Answer

OCTETS = "application/octet-stream"


def _request(mesh: str, optional: Dict[str, Any], **required: Any) -> Dict[str, Any]:
    return {"mesh": mesh, **required, **{name: value for name, value in optional.items() if value is not None}}


def geodesics(
    mesh: str,
    pairs: Sequence[Tuple[PointLike, PointLike]],
    derivatives: int,
    paths: bool,
    mollifier: Optional[str],
    mollifier_length: Optional[float],
    deadline: Optional[float],
) -> Computation[List[Geodesic]]:
    optional = {
        "accuracy": None if mollifier_length is None else {"mollifier_length": mollifier_length},
        "effects": None if mollifier is None else {"mollifier": mollifier},
        "deadline": deadline,
    }
    wire_pairs = [{"from": point_to_wire(start), "to": point_to_wire(end)} for start, end in pairs]

    def decode(answer: Answer) -> List[Geodesic]:
        document = answer.json()
        by_pair: Dict[int, List[PlacedPoint]] = {}
        for point in placed_points_from_wire(document):
            by_pair.setdefault(int(point.pointer.split("/")[2]), []).append(point)
        return [geodesic_from_wire(result, tuple(by_pair.get(i, ()))) for i, result in enumerate(document["results"])]

    document = _request(mesh, optional, pairs=wire_pairs, derivatives=derivatives, paths=paths)
    return Computation("/v1/geodesics", document, decode)


def field(
    mesh: str,
    sources: Sequence[PointLike],
    relative_error: float,
    method: str,
    max_distance: Optional[float],
    deadline: Optional[float],
) -> Computation[Field]:
    accuracy: Dict[str, Any] = {"method": method}
    if relative_error:
        accuracy["relative_error"] = relative_error
    optional = {"accuracy": accuracy, "max_distance": max_distance, "deadline": deadline}

    def decode(answer: Answer) -> Field:
        distances = np.frombuffer(answer.content, dtype="<f8").astype(np.float64)
        distances[distances < 0] = np.inf
        bound = answer.headers.get("Supple-Relative-Error-Bound")
        largest = answer.headers.get("Supple-Largest-Distance")
        return Field(
            distances=distances,
            method=answer.headers.get("Supple-Method", method),
            relative_error_bound=None if bound is None else float(bound),
            seconds=float(answer.headers.get("Supple-Seconds", "nan")),
            largest_distance=None if largest is None else float(largest),
        )

    document = _request(mesh, optional, sources=[point_to_wire(source) for source in sources])
    return Computation("/v1/geodesic-fields", document, decode, accept=OCTETS)


def karcher_mean(
    mesh: str,
    points: Sequence[PointLike],
    weights: Optional[Sequence[float]],
    tolerance: Optional[float],
    method: Optional[str],
    start: Optional[PointLike],
    starts: Optional[int],
    max_iterations: Optional[int],
    kept_fields: Optional[str],
    deadline: Optional[float],
) -> Computation[KarcherMean]:
    optional = {
        "weights": None if weights is None else [float(weight) for weight in weights],
        "tolerance": tolerance,
        "method": method,
        "start": None if start is None else point_to_wire(start),
        "starts": starts,
        "max_iterations": max_iterations,
        "effects": None if kept_fields is None else {"kept_fields": kept_fields},
        "deadline": deadline,
    }
    document = _request(mesh, optional, points=[point_to_wire(point) for point in points])
    return Computation("/v1/karcher-means", document, lambda answer: karcher_mean_from_wire(answer.json()))


def exponential_map(
    mesh: str, start: PointLike, tangent: Sequence[float], trace: bool, deadline: Optional[float]
) -> Computation[ExponentialMap]:
    document = _request(
        mesh, {"deadline": deadline}, start=point_to_wire(start), tangent=[float(t) for t in tangent], trace=trace
    )
    return Computation("/v1/exponential-maps", document, lambda answer: exponential_map_from_wire(answer.json()))
