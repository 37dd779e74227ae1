"""Geodesic Voronoi diagrams, as dataclasses and numpy arrays.

Lengths are in mesh units, areas in squared mesh units; energies have no unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, Mapping, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from .answers import Array, Cost, Effect, cost_from_wire, effects_from_wire
from .drawing import RED, Drawing, Line, joined
from .points import PlacedPoint, SurfacePoint, placed_points_from_wire, point_from_wire
from .shown import Drawn, Shown

Indices = NDArray[np.int64]


@dataclass(frozen=True, repr=False)
class Spread(Shown):
    """A quantity over all that have it: its mean, least and greatest value, and its standard deviation."""

    mean: float
    least: float
    greatest: float
    deviation: float


@dataclass(frozen=True, repr=False)
class VoronoiStatistics(Shown):
    """What is asked about a diagram as a design.

    Attributes:
        edge_length: geodesic distance between the two vertices of an edge, mesh units.
        planarity: distance of a cell's vertices from the plane that fits them best, mesh units.
        area: of cells, squared mesh units.
        vertex_distance: distance of a cell's vertices from its site over its mean in the cell; 1 where a cell is regular.
    """

    edge_length: Spread
    planarity: Spread
    area: Spread
    vertex_distance: Spread


@dataclass(frozen=True, repr=False)
class VoronoiCell(Shown):
    """The points of the surface that are nearer to one site than to any other.

    Attributes:
        site: index of the site.
        area: squared mesh units.
        boundary: closed borders with the cell on their left, each the rows of `VoronoiDiagram.positions` along it, the first
            not repeated; none where the cell is empty or a whole component, several where it has holes or wraps a handle.
        neighbours: sites whose cells share a border with this one, ascending.
    """

    site: int
    area: float
    boundary: Tuple[Indices, ...]
    neighbours: Tuple[int, ...]


@dataclass(frozen=True, repr=False)
class VoronoiVertex(Shown):
    """A place where three or more cells meet.

    Attributes:
        point: where it is.
        position: the same in space, shape (3,), mesh units.
        sites: of the cells that meet there, counterclockwise seen from outside; one twice where a cell meets itself.
        distance: to each of these sites, mesh units.
        index: its row of `VoronoiDiagram.positions`.
    """

    point: SurfacePoint
    position: Array
    sites: Tuple[int, ...]
    distance: float
    index: int


@dataclass(frozen=True, repr=False)
class VoronoiEdge(Shown):
    """A border of two cells.

    Attributes:
        sites: on the left and on the right of the way along `points`.
        vertices: indices of the Voronoi vertices at its ends; None at the mesh's boundary and of a closed border.
        length: along the border, mesh units.
        points: rows of `VoronoiDiagram.positions` along it, two or more; of a closed one the first is the last.
    """

    sites: Tuple[int, int]
    vertices: Tuple[Optional[int], Optional[int]]
    length: float
    points: Indices


@dataclass(frozen=True, repr=False)
class VoronoiPiece(Shown):
    """The part of a cut face that belongs to one cell.

    Attributes:
        site: index of the site.
        face: index of the face.
        corners: of the polygon that draws it, shape (n, 3), mesh units, counterclockwise seen from outside.
        area: squared mesh units, borders taken as the curves that they are.
    """

    site: int
    face: int
    corners: Array
    area: float


@dataclass(frozen=True, repr=False)
class VoronoiPieces(Shown):
    """Which site every part of the surface belongs to.

    Attributes:
        vertex_sites: of each vertex of the mesh the nearest site, shape (vertices,); -1 where no path leads to one.
        face_sites: of each face its site, shape (faces,); -1 where it is cut, and where no path leads to a site.
        cut_faces: the pieces of cut faces, ascending by face.
    """

    vertex_sites: Indices
    face_sites: Indices
    cut_faces: Tuple[VoronoiPiece, ...]


@dataclass(frozen=True, repr=False)
class VoronoiDiagram(Drawn):
    """A geodesic Voronoi diagram.

    Attributes:
        sites: in their order.
        site_positions: the same in space, shape (sites, 3), mesh units.
        cells: one for each site, in their order.
        vertices: where three or more cells meet.
        edges: borders of two cells between vertices or the mesh's boundary, and closed ones.
        dual: triangles of sites whose cells meet in one place, counterclockwise, shape (triangles, 3).
        positions: points of all borders, shape (points, 3), mesh units: between two successive points of a border it lies in
            one face and no farther from the straight line than `border_deviation`.
        points: the same as points of the surface; None where they were not asked for.
        pieces: which site every part of the surface belongs to; None where that was not asked for.
        unreached_area: of the components without a site, squared mesh units.
        statistics: None where they were left out.
        warnings: what deserves attention, one sentence each.
        relative_error_bound: guaranteed bound of the relative error of every distance, rounding aside; None without one.
        border_deviation: largest distance of a border from the straight lines between its points, in units of the diagonal of
            the mesh's bounding box.
        points_in_space: where the request's points in space lie on the surface.
    """

    sites: Tuple[SurfacePoint, ...]
    site_positions: Array
    cells: Tuple[VoronoiCell, ...]
    vertices: Tuple[VoronoiVertex, ...]
    edges: Tuple[VoronoiEdge, ...]
    dual: Indices
    positions: Array
    points: Optional[Tuple[SurfacePoint, ...]]
    pieces: Optional[VoronoiPieces]
    unreached_area: float
    statistics: Optional[VoronoiStatistics]
    warnings: Tuple[str, ...]
    relative_error_bound: Optional[float]
    effects: Tuple[Effect, ...]
    cost: Cost
    points_in_space: Tuple[PlacedPoint, ...] = ()
    border_deviation: float = 0.0

    def borders(self, site: int) -> Tuple[Array, ...]:
        """The closed borders of a cell as polylines in space, each of shape (points + 1, 3) with the first point repeated."""
        return tuple(self.positions[np.append(border, border[:1])] for border in self.cells[site].boundary)

    def _drawing(self) -> Drawing:
        borders = Line(joined([self.positions[edge.points] for edge in self.edges]))
        sites = Line(self.site_positions, color=RED, marks=True)
        return Drawing("map", (borders, sites), title=f"{len(self.cells)} cells, {len(self.vertices)} vertices")


@dataclass(frozen=True, repr=False)
class OptimizationStep(Shown):
    """One state of the iteration.

    Attributes:
        energy: weighted sum of the objectives.
        gradient_norm: of the energy by tangent coordinates of the free sites, 1 / mesh unit.
        step_length: root of the sum of the sites' squared ways to get there, mesh units; 0 for the start.
    """

    energy: float
    gradient_norm: float
    step_length: float


@dataclass(frozen=True, repr=False)
class SiteMoves(Shown):
    """What was tried where no step for all sites lowered the energy.

    Attributes:
        held_searches: how often this was so; steps then went on without the sites of far the largest gradients.
        passes: passes of moves of single sites over all free sites, each moved in 8 directions by 5 lengths from 0.3 to 0.001 of the mean cell size.
        tried: moves of single sites whose energy was computed.
        taken: moves that lowered the energy, and were kept.
        energy_before: energy where no step for all sites lowered it for the first time.
        last_gain: fraction of the energy by which the last pass lowered it.
    """

    held_searches: int
    passes: int
    tried: int
    taken: int
    energy_before: float
    last_gain: float


@dataclass(frozen=True, repr=False)
class OptimizedVoronoi(Drawn):
    """Sites at a local minimum of the objectives, and their diagram.

    Attributes:
        diagram: at the end; its `statistics` are those at the end.
        before: statistics of the diagram at the start.
        energy: weighted sum of the objectives at the end.
        terms: what it consists of, by name, weights included.
        gradient_norm: at the end, 1 / mesh unit; the bound that was asked for is `gradient_tolerance`.
        iterations: steps taken.
        history: the start and every step.
        stopped: "converged"; "step_too_small", where neither steps for all sites nor moves of single ones lower the energy
            by more than a thousandth; or "iteration_limit".
        site_moves: what was tried in between; None where steps for all sites sufficed.
    """

    diagram: VoronoiDiagram
    before: VoronoiStatistics
    energy: float
    terms: Dict[str, float]
    gradient_norm: float
    gradient_tolerance: float
    iterations: int
    history: Tuple[OptimizationStep, ...]
    stopped: str
    site_moves: Optional[SiteMoves]

    @property
    def converged(self) -> bool:
        """Whether the gradient is below the tolerance."""
        return self.stopped == "converged"

    def _drawing(self) -> Drawing:
        return self.diagram._drawing()


@dataclass(frozen=True, repr=False)
class PartialOptimization(Shown):
    """A diagram on its way, while it is optimized.

    Attributes:
        iteration: iterations so far.
        energy, gradient_norm, step_length: as in `OptimizationStep`.
        sites: where the sites are; None for more than 5000. `optimize_voronoi(partial.sites, ...)` goes on from here, should
            the job not come to its end.
        site_positions: the same in space, shape (sites, 3), mesh units; None where `sites` is.
        positions: points of the borders, shape (points, 3), mesh units; None for more than 20000 of them.
        vertices: which rows of `positions` are Voronoi vertices; None where `positions` is.
        borders: rows of `positions` along each border; None where `positions` is.
    """

    iteration: int
    energy: float
    gradient_norm: float
    step_length: float
    sites: Optional[Tuple[SurfacePoint, ...]]
    site_positions: Optional[Array]
    positions: Optional[Array]
    vertices: Optional[Indices]
    borders: Optional[Tuple[Indices, ...]]


def _positions(document: Any) -> Array:
    return np.asarray(document, dtype=np.float64).reshape(-1, 3)


def _indices(document: Any) -> Indices:
    return np.asarray(document, dtype=np.int64)


def _or_minus_one(document: Any) -> Indices:
    return np.array([-1 if value is None else value for value in document], dtype=np.int64)


def _statistics(document: Mapping[str, Any]) -> VoronoiStatistics:
    spreads = {name: Spread(s["mean"], s["least"], s["greatest"], s["deviation"]) for name, s in document.items()}
    return VoronoiStatistics(**spreads)


def _pieces(document: Optional[Mapping[str, Any]]) -> Optional[VoronoiPieces]:
    if document is None:
        return None
    return VoronoiPieces(
        vertex_sites=_or_minus_one(document["vertex_sites"]),
        face_sites=_or_minus_one(document["face_sites"]),
        cut_faces=tuple(
            VoronoiPiece(piece["site"], piece["face"], _positions(piece["corners"]), piece["area"]) for piece in document["cut_faces"]
        ),
    )


def _diagram(document: Mapping[str, Any], statistics: Optional[Mapping[str, Any]], bound: Optional[float]) -> VoronoiDiagram:
    points = document.get("points")
    return VoronoiDiagram(
        sites=tuple(point_from_wire(site) for site in document["sites"]),
        site_positions=_positions(document["site_positions"]),
        cells=tuple(
            VoronoiCell(c["site"], c["area"], tuple(_indices(border) for border in c["boundary"]), tuple(c["neighbours"]))
            for c in document["cells"]
        ),
        vertices=tuple(
            VoronoiVertex(
                point_from_wire(v["point"]),
                np.asarray(v["position"], dtype=np.float64),
                tuple(v["sites"]),
                v["distance"],
                v["index"],
            )
            for v in document["vertices"]
        ),
        edges=tuple(
            VoronoiEdge(
                (e["sites"][0], e["sites"][1]), (e["vertices"][0], e["vertices"][1]), e["length"], _indices(e["points"])
            )
            for e in document["edges"]
        ),
        dual=_indices(document["dual"]).reshape(-1, 3),
        positions=_positions(document["positions"]),
        points=None if points is None else tuple(point_from_wire(point) for point in points),
        pieces=_pieces(document.get("pieces")),
        unreached_area=document["unreached_area"],
        statistics=None if statistics is None else _statistics(statistics),
        warnings=tuple(document["warnings"]),
        relative_error_bound=bound,
        effects=effects_from_wire(document["effects"]),
        cost=cost_from_wire(document["cost"]),
        points_in_space=placed_points_from_wire(document),
        border_deviation=document["accuracy"]["border_deviation"],
    )


def voronoi_diagram_from_wire(document: Mapping[str, Any]) -> VoronoiDiagram:
    return _diagram(document, document.get("statistics"), document["accuracy"]["relative_error_bound"])


def _site_moves(document: Optional[Mapping[str, Any]]) -> Optional[SiteMoves]:
    if document is None:
        return None
    names = ("held_searches", "passes", "tried", "taken", "energy_before", "last_gain")
    return SiteMoves(**{name: document[name] for name in names})


def optimized_voronoi_from_wire(document: Mapping[str, Any]) -> OptimizedVoronoi:
    return OptimizedVoronoi(
        diagram=_diagram(document, document["statistics"]["after"], 0.0),
        before=_statistics(document["statistics"]["before"]),
        energy=document["energy"],
        terms={term["name"]: float(term["energy"]) for term in document["terms"]},
        gradient_norm=document["gradient_norm"],
        gradient_tolerance=document["accuracy"]["gradient_tolerance"],
        iterations=document["iterations"],
        history=tuple(
            OptimizationStep(s["energy"], s["gradient_norm"], s["step_length"]) for s in document["history"]
        ),
        stopped=document["stopped"],
        site_moves=_site_moves(document.get("site_moves")),
    )


def partial_optimization_from_wire(document: Mapping[str, Any]) -> PartialOptimization:
    sites = document.get("sites")
    site_positions = document.get("site_positions")
    positions = document.get("positions")
    vertices = document.get("vertices")
    borders = document.get("borders")
    return PartialOptimization(
        iteration=int(document["iteration"]),
        energy=float(document["energy"]),
        gradient_norm=float(document["gradient_norm"]),
        step_length=float(document["step_length"]),
        sites=None if sites is None else tuple(point_from_wire(site) for site in sites),
        site_positions=None if site_positions is None else _positions(site_positions),
        positions=None if positions is None else _positions(positions),
        vertices=None if vertices is None else _indices(vertices),
        borders=None if borders is None else tuple(_indices(border) for border in borders),
    )
