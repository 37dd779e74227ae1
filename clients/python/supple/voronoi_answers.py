"""Geodesic Voronoi diagrams, as dataclasses and numpy arrays.

Lengths are in mesh units, areas in squared mesh units; energies have no unit.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Mapping, Optional, Tuple

import numpy as np

from ._arrays import Array, Indices, Positions
from .answers import Cost, Effect
from .drawing import RED, Drawing, Line, joined
from .points import PlacedPoint, SurfacePoint
from .shown import Drawn, Shown
from .wire import ACCURACY, At, Shape, by_name, decode


@dataclass(frozen=True, repr=False)
class Spread(Shown):
    """The distribution of a quantity: its mean, least and greatest value, and its standard deviation."""

    mean: float
    least: float
    greatest: float
    deviation: float


@dataclass(frozen=True, repr=False)
class VoronoiStatistics(Shown):
    """Statistics of a diagram as a design.

    Attributes:
        edge_length: geodesic distance between the two vertices of an edge, mesh units.
        planarity: distance of a cell's vertices from the plane that fits them best, mesh units.
        area: area of a cell, squared mesh units.
        vertex_distance: distance of a vertex of a cell from its site, over the mean for this cell; 1 in a regular cell.
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
        boundary: the closed curves around the cell, with the cell on their left. Each is a sequence of rows of
            `VoronoiDiagram.positions`, without repetition of the first. There is none if the cell is empty or a whole
            component; there are several if it has holes or wraps a handle.
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
        point: the point on the surface.
        position: its position in space, shape (3,), mesh units.
        sites: the sites of the cells that meet there, counterclockwise seen from outside; a site occurs twice if its cell
            meets itself.
        distance: distance from each of these sites, mesh units.
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
        sites: the sites on the left and on the right in the direction of `points`.
        vertices: indices of the Voronoi vertices at its ends; None at the mesh's boundary, and for a closed border.
        length: length along the border, mesh units.
        points: rows of `VoronoiDiagram.positions` along it, two or more; a closed border repeats the first at its end.
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
        corners: corners of a polygon that approximates it, shape (n, 3), mesh units, counterclockwise seen from outside.
        area: area within the exact curved borders, squared mesh units.
    """

    site: int
    face: int
    corners: Positions
    area: float


@dataclass(frozen=True, repr=False)
class VoronoiPieces(Shown):
    """The nearest site of every part of the surface.

    Attributes:
        vertex_sites: the nearest site of each vertex of the mesh, shape (vertices,); -1 if no path leads to one.
        face_sites: the site of each face, shape (faces,); -1 if a border cuts the face, or no path leads to a site.
        cut_faces: the pieces of cut faces, ascending by face.
    """

    vertex_sites: Indices
    face_sites: Indices
    cut_faces: Tuple[VoronoiPiece, ...]


@dataclass(frozen=True, repr=False)
class VoronoiDiagram(Drawn):
    """A geodesic Voronoi diagram.

    Attributes:
        sites: the sites in their order.
        site_positions: their positions in space, shape (sites, 3), mesh units.
        cells: one for each site, in their order.
        vertices: where three or more cells meet.
        edges: borders of two cells between vertices or the mesh's boundary, and closed ones.
        dual: triangles of sites whose cells meet in one place, counterclockwise, shape (triangles, 3).
        positions: points of all borders, shape (points, 3), mesh units. Between two successive points a border lies in one face
            and is no farther from the straight line than `border_deviation`.
        points: the same points on the surface; None if they were not requested.
        pieces: the nearest site of every part of the surface; None if it was not requested.
        unreached_area: area of the components without a site, squared mesh units.
        statistics: None if they were not requested.
        warnings: a sentence for each fact that deserves attention.
        relative_error_bound: guaranteed bound of the relative error of every distance, apart from rounding; None without one.
        border_deviation: largest distance of a border from the straight lines between its points, in units of the diagonal of
            the mesh's bounding box.
        points_in_space: the nearest points on the surface of the request's points in space.
    """

    sites: Tuple[SurfacePoint, ...]
    site_positions: Positions
    cells: Tuple[VoronoiCell, ...]
    vertices: Tuple[VoronoiVertex, ...]
    edges: Tuple[VoronoiEdge, ...]
    dual: Annotated[Indices, Shape(-1, 3)]
    positions: Positions
    points: Optional[Tuple[SurfacePoint, ...]]
    pieces: Optional[VoronoiPieces]
    unreached_area: float
    statistics: Optional[VoronoiStatistics]
    warnings: Tuple[str, ...]
    relative_error_bound: Annotated[Optional[float], ACCURACY]
    effects: Tuple[Effect, ...]
    cost: Cost
    points_in_space: Tuple[PlacedPoint, ...] = ()
    border_deviation: Annotated[float, ACCURACY] = 0.0

    def borders(self, site: int) -> Tuple[Array, ...]:
        """The closed borders of a cell as polylines in space, each of shape (points + 1, 3) with the first point at its end too."""
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
        gradient_norm: norm of the energy's gradient by tangent coordinates of the free sites, 1 / mesh unit.
        step_length: norm of the sites' displacements from the state before, mesh units; 0 at the start.
    """

    energy: float
    gradient_norm: float
    step_length: float


@dataclass(frozen=True, repr=False)
class SiteMoves(Shown):
    """Searches at states where no step of all sites lowered the energy.

    Attributes:
        held_searches: number of such states; the search then continued with the sites of by far the largest gradients fixed.
        passes: number of passes over all free sites in which single sites were moved, each in 8 directions by 5 lengths from
            0.3 to 0.001 of the mean cell size.
        tried: number of moves of single sites for which the energy was computed.
        taken: number of moves that lowered the energy, and were accepted.
        energy_before: energy at the first such state.
        last_gain: fraction of the energy by which the last pass lowered it.
    """

    held_searches: int
    passes: int
    tried: int
    taken: int
    energy_before: float
    last_gain: float


def _diagram_after(optimization: Mapping[str, Any]) -> VoronoiDiagram:
    accuracy = {**optimization["accuracy"], "relative_error_bound": 0.0}
    return decode(VoronoiDiagram, {**optimization, "statistics": optimization["statistics"]["after"], "accuracy": accuracy})


@dataclass(frozen=True, repr=False)
class OptimizedVoronoi(Drawn):
    """Sites at a local minimum of the objectives, and their diagram.

    Attributes:
        diagram: the diagram at the end, with its `statistics`.
        before: statistics of the diagram at the start.
        energy: weighted sum of the objectives at the end.
        terms: the weighted objectives by name.
        gradient_norm: norm of the gradient at the end, 1 / mesh unit; the requested bound is `gradient_tolerance`.
        iterations: number of iterations.
        history: the start and every step.
        stopped: "converged"; "step_too_small" if neither steps of all sites nor moves of single ones lower the energy by more
            than a thousandth; "iteration_limit"; or "deadline" or "memory" if time or memory ran out, and this is the best
            state until then.
        site_moves: searches with single sites; None if steps of all sites sufficed.
    """

    diagram: Annotated[VoronoiDiagram, At("", read=_diagram_after)]
    before: Annotated[VoronoiStatistics, At("/statistics/before")]
    energy: float
    terms: Annotated[Dict[str, float], At(read=by_name("energy"))]
    gradient_norm: float
    gradient_tolerance: Annotated[float, ACCURACY]
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
    """A diagram after the latest iteration of a running job.

    Attributes:
        iteration: iterations so far.
        energy, gradient_norm, step_length: as in `OptimizationStep`.
        sites: the sites; None for more than 5000. If the job does not finish, `optimize_voronoi(partial.sites, ...)` continues
            from them.
        site_positions: their positions in space, shape (sites, 3), mesh units; None if `sites` is.
        positions: points of the borders, shape (points, 3), mesh units; None for more than 20000 of them.
        vertices: the rows of `positions` that are Voronoi vertices; None if `positions` is.
        borders: rows of `positions` along each border; None if `positions` is.
    """

    iteration: int
    energy: float
    gradient_norm: float
    step_length: float
    sites: Optional[Tuple[SurfacePoint, ...]]
    site_positions: Optional[Positions]
    positions: Optional[Positions]
    vertices: Optional[Indices]
    borders: Optional[Tuple[Indices, ...]]
