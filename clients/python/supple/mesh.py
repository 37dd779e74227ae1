"""A mesh on the server and the computations on it."""

from __future__ import annotations

from typing import Any, List, Mapping, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import computations, conversion, networks, voronoi
from .answers import Array, ExponentialMap, Field, Geodesic, KarcherMean, MeshInfo, MeshRepair
from .drawing import plot_surface
from .hosts import Host
from .jobs import Job, Progress, run, submit
from .nearest import nearest_points
from .network_answers import RelaxedNetwork
from .networks import Membrane, NetworkPoints, NetworkSprings, RelaxationOptions
from .points import PointLike, SurfacePoint
from .transport import Transport
from .voronoi import Sites, VoronoiOptions
from .voronoi_answers import OptimizedVoronoi, VoronoiDiagram

_VERTEX = np.dtype("<f8")
_FACE = np.dtype([("corners", "u1"), ("vertices", "<i4", (3,))])


class Mesh:
    """A mesh on a server. Methods of `Client` create it.

    Every computation has two forms: `geodesics(...)` waits and returns the result, `start_geodesics(...)` returns a `Job`
    immediately. The waiting forms have the arguments `timeout` (seconds after which `RequestTimeout` is raised; None waits
    without limit) and `progress` (see `Progress`); anything that interrupts the wait cancels the computation. `deadline` bounds
    the computation on the server (seconds; `DeadlineExceeded`).

    All forms raise `InvalidPoint` if a point does not lie on the mesh.

    `info` describes the mesh; `repair` says what the repairs of its upload have changed, None if none were requested.
    """

    def __init__(self, transport: Transport, info: MeshInfo, repair: Optional[MeshRepair] = None) -> None:
        self._transport = transport
        self.info = info
        self.repair = repair
        self._arrays: Optional[Tuple[Array, NDArray[np.int32]]] = None

    def __repr__(self) -> str:
        return f"Mesh({self.id[:12]}…, {self.info.vertices} vertices, {self.info.faces} faces)"

    def _repr_html_(self) -> str:
        return self.info._repr_html_()

    @property
    def id(self) -> str:
        return self.info.id

    def delete(self) -> None:
        """Removes the mesh from the server. Raises `InvalidRequest` (code "mesh.in_use") while a job uses it."""
        self._transport.request("DELETE", f"/v1/meshes/{self.id}")

    def arrays(self) -> Tuple[Array, NDArray[np.int32]]:
        """Positions, shape (vertices, 3), and the corners of each face, shape (faces, 3), as the server has them."""
        answer = self._transport.request("GET", f"/v1/meshes/{self.id}/content", headers={"Accept": "model/ply"})
        body = answer.content.index(b"end_header\n") + len(b"end_header\n")
        split = body + 3 * _VERTEX.itemsize * self.info.vertices
        positions = np.frombuffer(answer.content[body:split], dtype=_VERTEX).reshape(-1, 3)
        faces = np.frombuffer(answer.content[split:], dtype=_FACE)["vertices"]
        return positions.astype(np.float64), faces.astype(np.int32)

    def to_trimesh(self) -> Any:
        """The mesh as a trimesh.Trimesh. Raises `ImportError` if trimesh is not installed."""
        return conversion.to_trimesh(*self.arrays())

    def to_meshio(self) -> Any:
        """The mesh as a meshio.Mesh. Raises `ImportError` if meshio is not installed."""
        return conversion.to_meshio(*self.arrays())

    def to_pyvista(self) -> Any:
        """The mesh as a pyvista.PolyData. Raises `ImportError` if pyvista is not installed."""
        return conversion.to_pyvista(*self.arrays())

    def nearest_point(self, position: ArrayLike) -> SurfacePoint:
        """The point of the surface that is nearest, through space, to a position, shape (3,), mesh units."""
        return self.nearest_points(np.asarray(position, dtype=np.float64).reshape(1, -1))[0][0]

    def nearest_points(self, positions: ArrayLike) -> Tuple[List[SurfacePoint], Array, Array]:
        """The points of the surface that are nearest, through space, to positions of shape (n, 3), mesh units.

        Returns the points, their positions, shape (n, 3), and their distances, shape (n,), mesh units. The mesh is fetched
        from the server once; then this process compares each position with every face, in O(n faces).
        """
        array = np.asarray(positions, dtype=np.float64)
        if array.ndim != 2 or array.shape[1] != 3 or not np.isfinite(array).all():
            raise ValueError(f"positions have the shape {array.shape}; expected finite numbers of shape (n, 3)")
        if self._arrays is None:
            self._arrays = self.arrays()
        return nearest_points(array, *self._arrays)

    def plot(self, ax: Optional[Any] = None, *, values: Optional[ArrayLike] = None) -> Any:
        """Draws the surface with matplotlib into the three-dimensional axes `ax`, or into new ones, and returns them.

        `values`, shape (vertices,), such as `Field.distances`, colour it. Raises `ImportError` where matplotlib is missing.
        """
        return plot_surface(*self.arrays(), ax, values)

    def geodesic(self, start: PointLike, end: PointLike, *, derivatives: int = 0, path: bool = False) -> Geodesic:
        """The shortest path between two points. The options are those of `geodesics`."""
        return self.geodesics([(start, end)], derivatives=derivatives, paths=path)[0]

    def geodesics(
        self,
        pairs: Sequence[Tuple[PointLike, PointLike]],
        *,
        derivatives: int = 0,
        paths: bool = False,
        mollifier: Optional[str] = None,
        mollifier_length: Optional[float] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> List[Geodesic]:
        """The exact shortest paths between pairs of points, in their order.

        Args:
            pairs: start and end of each path; pairs with a common start share a search if that is faster.
            derivatives: 0 for distances, 1 for gradients, 2 for Hessians too.
            paths: whether the paths are returned.
            mollifier: whether derivatives are smoothed near vertices: "on", "off" or "automatic".
            mollifier_length: smoothing length as a fraction of an edge, in (0, 0.5]; 1e-6 by default.
        """
        computation = computations.geodesics(
            self.id, pairs, derivatives, paths, mollifier, mollifier_length, deadline
        )
        return run(self._transport, computation, timeout, progress)

    def start_geodesics(
        self,
        pairs: Sequence[Tuple[PointLike, PointLike]],
        *,
        derivatives: int = 0,
        paths: bool = False,
        mollifier: Optional[str] = None,
        mollifier_length: Optional[float] = None,
        deadline: Optional[float] = None,
    ) -> Job[List[Geodesic]]:
        """`geodesics` as a job."""
        computation = computations.geodesics(
            self.id, pairs, derivatives, paths, mollifier, mollifier_length, deadline
        )
        return submit(self._transport, computation)

    def field(
        self,
        sources: Sequence[PointLike],
        *,
        relative_error: float = 0.0,
        method: str = "windows",
        max_distance: Optional[float] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> Field:
        """The distance from the nearest of the sources to every vertex.

        Args:
            sources: at least one point.
            relative_error: guaranteed bound of every distance's relative error; 0 is exact.
            method: "windows", or "edge_graph" for the cheapest upper bound of the distances, without a guarantee.
            max_distance: distances beyond it need not be computed, mesh units.
        """
        computation = computations.field(self.id, sources, relative_error, method, max_distance, deadline)
        return run(self._transport, computation, timeout, progress)

    def start_field(
        self,
        sources: Sequence[PointLike],
        *,
        relative_error: float = 0.0,
        method: str = "windows",
        max_distance: Optional[float] = None,
        deadline: Optional[float] = None,
    ) -> Job[Field]:
        """`field` as a job."""
        computation = computations.field(self.id, sources, relative_error, method, max_distance, deadline)
        return submit(self._transport, computation)

    def karcher_mean(
        self,
        points: Sequence[PointLike],
        weights: Optional[Sequence[float]] = None,
        *,
        tolerance: Optional[float] = None,
        method: Optional[str] = None,
        start: Optional[PointLike] = None,
        starts: Optional[int] = None,
        max_iterations: Optional[int] = None,
        kept_fields: Optional[str] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> KarcherMean:
        """The point of least weighted mean squared geodesic distance. It is a local minimum, of which there may be several.

        Args:
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
        computation = computations.karcher_mean(
            self.id, points, weights, tolerance, method, start, starts, max_iterations, kept_fields, deadline
        )
        return run(self._transport, computation, timeout, progress)

    def start_karcher_mean(
        self,
        points: Sequence[PointLike],
        weights: Optional[Sequence[float]] = None,
        *,
        tolerance: Optional[float] = None,
        method: Optional[str] = None,
        start: Optional[PointLike] = None,
        starts: Optional[int] = None,
        max_iterations: Optional[int] = None,
        kept_fields: Optional[str] = None,
        deadline: Optional[float] = None,
    ) -> Job[KarcherMean]:
        """`karcher_mean` as a job."""
        computation = computations.karcher_mean(
            self.id, points, weights, tolerance, method, start, starts, max_iterations, kept_fields, deadline
        )
        return submit(self._transport, computation)

    def relax_network(
        self,
        points: NetworkPoints,
        springs: NetworkSprings,
        fixed_points: Sequence[int] = (),
        *,
        membrane: Optional[Membrane] = None,
        host: Optional[Host] = None,
        options: Optional[RelaxationOptions] = None,
        paths: bool = False,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> RelaxedNetwork:
        """The equilibrium of an elastic network whose points slide on the surface: a local minimum of the energy E near the start.
        E is the sum of weight (length - rest_length)^2 over the springs, plus the energies of a membrane's triangles and of a
        deformable host.

        Args:
            points: the points at the start, at least one: a list of points, `PointsInFaces` or `PoissonDisk`.
            springs: a list of `Spring` or of pairs of indices of points, `AdjacentFaces` or `VoronoiDual`. A spring joins two
                different points of one component.
            fixed_points: indices of fixed points.
            membrane: triangles between the points, besides the springs or instead of them.
            host: a `Shell` or a `Solid` whose surface is the mesh and which deforms under the network, or a `Moving` surface; None
                for a rigid surface. `RelaxedNetwork.host` is its state at the end.
            options: options of the search.
            paths: whether the paths of the springs are returned.

        Raises `InvalidNetwork` if points and springs do not fit together, with the codes "network.spring",
        "network.triangle", "network.collapsed" (a triangle without area), "network.fixed_point", "network.unreachable" and
        "network.radius". Raises `InvalidHost` if the mesh is not suitable for the host ("host.open_surface",
        "solid.not_filled", ...). `faults` names the entries.
        """
        document = networks.relaxation_document(
            self.id, points, springs, fixed_points, options, paths, deadline, membrane, host
        )
        return run(self._transport, networks.relaxation(document), timeout, progress)

    def start_relax_network(
        self,
        points: NetworkPoints,
        springs: NetworkSprings,
        fixed_points: Sequence[int] = (),
        *,
        membrane: Optional[Membrane] = None,
        host: Optional[Host] = None,
        options: Optional[RelaxationOptions] = None,
        paths: bool = False,
        deadline: Optional[float] = None,
    ) -> Job[RelaxedNetwork]:
        """`relax_network` as a job, whose `status().partial` is the network after the latest iteration."""
        document = networks.relaxation_document(
            self.id, points, springs, fixed_points, options, paths, deadline, membrane, host
        )
        return submit(self._transport, networks.relaxation(document))

    def relaxed_network_file(
        self,
        points: NetworkPoints,
        springs: NetworkSprings,
        fixed_points: Sequence[int] = (),
        *,
        membrane: Optional[Membrane] = None,
        host: Optional[Host] = None,
        kind: str = "obj",
        options: Optional[RelaxationOptions] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> bytes:
        """A relaxed network as a file. `kind` is "obj" or "vtu" (a polyline along each spring's path, and the host if it
        deformed or moved, mesh units), or "svg" (energy and gradient norm over the iterations). The other arguments are those
        of `relax_network`."""
        document = networks.relaxation_document(
            self.id, points, springs, fixed_points, options, False, deadline, membrane, host
        )
        return run(self._transport, networks.network_file(document, kind), timeout, progress)

    def voronoi(
        self,
        sites: Sites,
        *,
        method: Optional[str] = None,
        relative_error: Optional[float] = None,
        border_deviation: Optional[float] = None,
        points: bool = False,
        pieces: bool = False,
        statistics: bool = True,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> VoronoiDiagram:
        """The geodesic Voronoi diagram of sites: each cell has the points that are nearer to its site than to any other site.

        Args:
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
        document = voronoi.diagram_document(
            self.id, sites, method, relative_error, points, pieces, statistics, deadline, border_deviation
        )
        return run(self._transport, voronoi.diagram(document), timeout, progress)

    def start_voronoi(
        self,
        sites: Sites,
        *,
        method: Optional[str] = None,
        relative_error: Optional[float] = None,
        border_deviation: Optional[float] = None,
        points: bool = False,
        pieces: bool = False,
        statistics: bool = True,
        deadline: Optional[float] = None,
    ) -> Job[VoronoiDiagram]:
        """`voronoi` as a job."""
        document = voronoi.diagram_document(
            self.id, sites, method, relative_error, points, pieces, statistics, deadline, border_deviation
        )
        return submit(self._transport, voronoi.diagram(document))

    def optimize_voronoi(
        self,
        sites: Sites,
        objectives: Mapping[str, float],
        fixed_sites: Sequence[int] = (),
        *,
        options: Optional[VoronoiOptions] = None,
        points: bool = False,
        pieces: bool = False,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> OptimizedVoronoi:
        """Moves sites until their Voronoi diagram has a local minimum of the weighted sum of objectives.

        Args:
            sites: the sites at the start: a list of points, or `RandomSites`.
            objectives: weights by name, at least 0, of "edge_length" (edges as long as `VoronoiOptions.target_length`),
                "planarity" (cells whose vertices lie in a plane), "regularity" (vertices near their sites), "centroidal"
                (sites at the centres of their cells) and "equal_area". Lengths are measured in units of the mean cell size, so that
                all objectives are dimensionless.
            fixed_sites: indices of fixed sites.
            options: options of the search.
            points, pieces: as in `voronoi`.

        Raises `InvalidVoronoi` with the codes of `voronoi`, "voronoi.no_objective" and "voronoi.fixed_site"; `faults` names
        the entries.
        """
        document = voronoi.optimization_document(
            self.id, sites, objectives, fixed_sites, options, points, pieces, deadline
        )
        return run(self._transport, voronoi.optimization(document), timeout, progress)

    def start_optimize_voronoi(
        self,
        sites: Sites,
        objectives: Mapping[str, float],
        fixed_sites: Sequence[int] = (),
        *,
        options: Optional[VoronoiOptions] = None,
        points: bool = False,
        pieces: bool = False,
        deadline: Optional[float] = None,
    ) -> Job[OptimizedVoronoi]:
        """`optimize_voronoi` as a job, whose `status().partial` is the diagram after the latest iteration
        (`PartialOptimization`)."""
        document = voronoi.optimization_document(
            self.id, sites, objectives, fixed_sites, options, points, pieces, deadline
        )
        return submit(self._transport, voronoi.optimization(document))

    def voronoi_file(
        self,
        sites: Sites,
        *,
        kind: str = "obj",
        method: Optional[str] = None,
        relative_error: Optional[float] = None,
        border_deviation: Optional[float] = None,
        panel_scale: Optional[float] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> bytes:
        """A Voronoi diagram as a file. `kind` is "obj" or "vtu" (borders and the surface cut along them, mesh units), "svg" (flat
        panels with numbered edges, `panel_scale` millimetres for each mesh unit, 1 by default) or "csv" (lengths and angles of
        the panels). For an optimized diagram, give its `sites`. The other arguments are those of `voronoi`."""
        document = voronoi.diagram_document(
            self.id, sites, method, relative_error, False, False, True, deadline, border_deviation
        )
        return run(self._transport, voronoi.diagram_file(document, kind, panel_scale), timeout, progress)

    def exponential_map(
        self,
        start: PointLike,
        tangent: Sequence[float],
        *,
        trace: bool = True,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
    ) -> ExponentialMap:
        """The end of the straightest path with a given direction and length.

        Args:
            start: where it starts.
            tangent: direction and length in mesh units. Three numbers are a vector in space, of which the part in the plane of the
                start's face is used; two are coordinates in the frame of that face.
            trace: whether the path is returned.
        """
        computation = computations.exponential_map(self.id, start, tangent, trace, deadline)
        return run(self._transport, computation, timeout, None)
