"""Geodesic Voronoi diagrams: sites, objectives and requests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Mapping, Optional, Sequence, Union

from ._arrays import IndexList
from .points import PointLike, points_to_wire
from .request import Deadline, FileRequest, Kind, OnMesh, Reported, Request, Timeout
from .voronoi_answers import OptimizedVoronoi, VoronoiDiagram
from .wire import ACCURACY, At, Sent


@dataclass(frozen=True)
class RandomSites(Sent):
    """Random sites, uniform over the area.

    Attributes:
        count: number of sites.
        seed: the same seed gives the same sites; 1 by default.
    """

    count: int
    seed: Optional[int] = None


Sites = Union[Sequence[PointLike], RandomSites]
"""Sites as an argument: a list of points, or random ones."""


@dataclass(frozen=True)
class VoronoiOptions(Sent):
    """How sites are optimized. None stands for the server's default.

    Attributes:
        target_length: length of all edges at which the objective "edge_length" is least, mesh units; by default the mean length
            at the start.
        method: "automatic", "gauss_newton" or "lbfgs".
        tolerance: the iteration stops once |grad E| <= tolerance * sqrt(number of sites) / (mean cell size). 1e-6 by default.
        max_iterations: 100 by default.
        border_deviation: as in `VoronoiRequest`.
    """

    target_length: Optional[float] = None
    method: Optional[str] = None
    tolerance: Annotated[Optional[float], ACCURACY] = None
    max_iterations: Optional[int] = None
    border_deviation: Annotated[Optional[float], ACCURACY] = None


def _sites_to_wire(sites: Sites, name: str) -> Any:
    return sites.to_wire() if isinstance(sites, RandomSites) else points_to_wire(sites)


@dataclass(frozen=True)
class _Diagram(Sent):
    """The fields of both requests of a diagram."""

    mesh: OnMesh
    sites: Annotated[Sites, At(write=_sites_to_wire)]
    method: Annotated[Optional[str], ACCURACY] = None
    relative_error: Annotated[Optional[float], ACCURACY] = None
    border_deviation: Annotated[Optional[float], ACCURACY] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def to_wire(self) -> Dict[str, Any]:
        document = super().to_wire()
        if self.relative_error is not None:
            document["accuracy"].setdefault("method", "bounded")
        return document


@dataclass(frozen=True)
class VoronoiRequest(_Diagram, Request[VoronoiDiagram], path="/v1/voronoi-diagrams"):
    """The geodesic Voronoi diagram of sites: each cell has the points that are nearer to its site than to any other site.

    Attributes:
        mesh: the mesh, or its id.
        sites: a list of points, or `RandomSites`.
        method: "exact" (the default), "bounded" (each distance within `relative_error`, with less work) or "edges" (along
            edges and across pairs of faces, without a bound).
        relative_error: permitted error of every distance, in (0, 1]; implies "bounded". 0.01 by default.
        border_deviation: largest distance of a border from the straight lines between its points, in units of the
            diagonal of the mesh's bounding box, from 1e-7 to 1. 1e-5 by default. Areas and lengths are always those of the
            exact curves.
        points: whether `VoronoiDiagram.points` are returned, the surface points of its `positions`.
        pieces: whether `VoronoiDiagram.pieces` are returned, with which cells can be coloured.
        statistics: whether `VoronoiDiagram.statistics` are returned.

    Raises `InvalidVoronoi` (codes "voronoi.no_sites", "voronoi.too_many_sites", "voronoi.invalid_option"), and
    `InvalidRequest` (code "request.limit_exceeded") if there are more sites than the server permits.
    """

    points: bool = False
    pieces: bool = False
    statistics: bool = True


@dataclass(frozen=True)
class VoronoiFileRequest(_Diagram, FileRequest, path="/v1/voronoi-diagrams"):
    """A Voronoi diagram as a file. `kind` is "obj" or "vtu" (borders and the surface cut along them, mesh units), "svg" (flat
    panels with numbered edges, `panel_scale` millimetres for each mesh unit, 1 by default) or "csv" (lengths and angles of
    the panels). For an optimized diagram, give its `sites`. The other fields are those of `VoronoiRequest`."""

    TYPES = {"obj": "model/obj", "vtu": "application/x-vtu+xml", "svg": "image/svg+xml", "csv": "text/csv"}
    kind: Kind = "obj"
    panel_scale: Optional[float] = None


@dataclass(frozen=True)
class VoronoiOptimizationRequest(Request[OptimizedVoronoi], path="/v1/voronoi-optimizations"):
    """Moves sites until their Voronoi diagram has a local minimum of the weighted sum of objectives.

    Attributes:
        mesh: the mesh, or its id.
        sites: the sites at the start: a list of points, or `RandomSites`.
        objectives: weights by name, at least 0, of "edge_length" (edges as long as `VoronoiOptions.target_length`),
            "planarity" (cells whose vertices lie in a plane), "regularity" (vertices near their sites), "centroidal"
            (sites at the centres of their cells) and "equal_area". Lengths are measured in units of the mean cell size, so that
            all objectives are dimensionless.
        fixed_sites: indices of fixed sites.
        options: options of the search.
        points, pieces: as in `VoronoiRequest`.

    The `status().partial` of its job is the diagram after the latest iteration (`PartialOptimization`).

    Raises `InvalidVoronoi` with the codes of `VoronoiRequest`, "voronoi.no_objective" and "voronoi.fixed_site"; `faults` names
    the entries.
    """

    mesh: OnMesh
    sites: Annotated[Sites, At(write=_sites_to_wire)]
    objectives: Mapping[str, float]
    fixed_sites: IndexList = ()
    options: Annotated[Optional[VoronoiOptions], At("")] = None
    points: bool = False
    pieces: bool = False
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None
