"""Geodesic Voronoi diagrams: sites, objectives and requests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional, Sequence, Union

from .jobs import Computation
from .points import PointLike, point_to_wire
from .transport import Answer
from .voronoi_answers import (
    OptimizedVoronoi,
    VoronoiDiagram,
    optimized_voronoi_from_wire,
    voronoi_diagram_from_wire,
)
from .weaves import given

DIAGRAMS = "/v1/voronoi-diagrams"
OPTIMIZATIONS = "/v1/voronoi-optimizations"
FILE_TYPES = {"obj": "model/obj", "vtu": "application/x-vtu+xml", "svg": "image/svg+xml", "csv": "text/csv"}


@dataclass(frozen=True)
class RandomSites:
    """Random sites, uniform over the area.

    Attributes:
        count: number of sites.
        seed: the same seed gives the same sites; 1 by default.
    """

    count: int
    seed: Optional[int] = None

    def to_wire(self) -> Dict[str, Any]:
        return {"count": int(self.count), **given(seed=self.seed)}


Sites = Union[Sequence[PointLike], RandomSites]
"""Sites as an argument: a list of points, or random ones."""


@dataclass(frozen=True)
class VoronoiOptions:
    """How sites are optimized. None stands for the server's default.

    Attributes:
        target_length: length of all edges at which the objective "edge_length" is least, mesh units; by default the mean length
            at the start.
        method: "automatic", "gauss_newton" or "lbfgs".
        tolerance: the iteration stops once |grad E| <= tolerance * sqrt(number of sites) / (mean cell size). 1e-6 by default.
        max_iterations: 100 by default.
        border_deviation: as in `Mesh.voronoi`.
    """

    target_length: Optional[float] = None
    method: Optional[str] = None
    tolerance: Optional[float] = None
    max_iterations: Optional[int] = None
    border_deviation: Optional[float] = None

    def to_wire(self) -> Dict[str, Any]:
        accuracy = given(tolerance=self.tolerance, border_deviation=self.border_deviation)
        fields = given(target_length=self.target_length, method=self.method, max_iterations=self.max_iterations)
        return {**fields, **({"accuracy": accuracy} if accuracy else {})}


def _sites(sites: Sites) -> Any:
    return sites.to_wire() if isinstance(sites, RandomSites) else [point_to_wire(site) for site in sites]


def diagram_document(
    mesh: str,
    sites: Sites,
    method: Optional[str],
    relative_error: Optional[float],
    points: bool,
    pieces: bool,
    statistics: bool,
    deadline: Optional[float],
    border_deviation: Optional[float] = None,
) -> Dict[str, Any]:
    accuracy = given(method=method, relative_error=relative_error, border_deviation=border_deviation)
    if relative_error is not None and method is None:
        accuracy["method"] = "bounded"
    return {
        "mesh": mesh,
        "sites": _sites(sites),
        **({"accuracy": accuracy} if accuracy else {}),
        **given(points=points or None, pieces=pieces or None, statistics=None if statistics else False, deadline=deadline),
    }


def optimization_document(
    mesh: str,
    sites: Sites,
    objectives: Mapping[str, float],
    fixed_sites: Sequence[int],
    options: Optional[VoronoiOptions],
    points: bool,
    pieces: bool,
    deadline: Optional[float],
) -> Dict[str, Any]:
    return {
        "mesh": mesh,
        "sites": _sites(sites),
        "objectives": {name: float(weight) for name, weight in objectives.items()},
        "fixed_sites": [int(site) for site in fixed_sites],
        **({} if options is None else options.to_wire()),
        **given(points=points or None, pieces=pieces or None, deadline=deadline),
    }


def diagram(document: Dict[str, Any]) -> Computation[VoronoiDiagram]:
    return Computation(DIAGRAMS, document, lambda answer: voronoi_diagram_from_wire(answer.json()))


def optimization(document: Dict[str, Any]) -> Computation[OptimizedVoronoi]:
    return Computation(OPTIMIZATIONS, document, lambda answer: optimized_voronoi_from_wire(answer.json()))


def diagram_file(document: Dict[str, Any], kind: str, panel_scale: Optional[float]) -> Computation[bytes]:
    def decode(answer: Answer) -> bytes:
        return answer.content

    if kind not in FILE_TYPES:
        raise ValueError(f"a Voronoi diagram is written as {', '.join(sorted(FILE_TYPES))}, not {kind!r}")
    return Computation(DIAGRAMS, {**document, **given(panel_scale=panel_scale)}, decode, accept=FILE_TYPES[kind])
