"""A mesh on the server and what can be asked of it."""

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
    """A mesh that a server holds. Made by the methods of `Client`.

    Every computation has two forms: `geodesics(...)` waits and returns the result, `start_geodesics(...)` returns a `Job`
    at once. The waiting forms take `timeout` (seconds after which `RequestTimeout` is raised; None waits for ever) and
    `progress` (see `Progress`); whatever interrupts the wait cancels the computation. `deadline` bounds the computation on
    the server (seconds; `DeadlineExceeded`).

    All forms raise `InvalidPoint` where a point does not lie on the mesh.

    `info` describes the mesh; `repair` says what the repairs of its upload have changed, None where none were asked for.
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
        """The mesh as a trimesh.Trimesh. Raises `ImportError` where trimesh is not installed."""
        return conversion.to_trimesh(*self.arrays())

    def to_meshio(self) -> Any:
        """The mesh as a meshio.Mesh. Raises `ImportError` where meshio is not installed."""
        return conversion.to_meshio(*self.arrays())

    def to_pyvista(self) -> Any:
        """The mesh as a pyvista.PolyData. Raises `ImportError` where pyvista is not installed."""
        return conversion.to_pyvista(*self.arrays())

    def nearest_point(self, position: ArrayLike) -> SurfacePoint:
        """The point of the surface that is nearest, through space, to a position, shape (3,), mesh units."""
        return self.nearest_points(np.asarray(position, dtype=np.float64).reshape(1, -1))[0][0]

    def nearest_points(self, positions: ArrayLike) -> Tuple[List[SurfacePoint], Array, Array]:
        """The points of the surface that are nearest, through space, to positions of shape (n, 3), mesh units.

        Returns the points, their positions, shape (n, 3), and their distances, shape (n,), mesh units. The mesh is fetched
        from the server once; each position is then compared with every face here, in O(n faces).
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
        """The shortest path between two points. See `geodesics` for what the options mean."""
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
            pairs: start and end of each; pairs with a common start share a search where that is less work.
            derivatives: 0 for distances, 1 for gradients, 2 for Hessians too.
            paths: whether the paths are returned.
            mollifier: "on", "off" or "automatic": smooths derivatives near vertices.
            mollifier_length: its smoothing length as a fraction of an edge, in (0, 0.5]; 1e-6 on the server's side.
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
            relative_error: allowed relative error of every distance, a guarantee; 0 is exact.
            method: "windows", or "edge_graph" for the cheapest upper bound, without a guarantee.
            max_distance: distances beyond it need not be found. Mesh units.
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
        """The point of least weighted mean squared geodesic distance: a local minimum, a problem may have several.

        Args:
            points: at least one, all on one component.
            weights: one for each point, at least 0 and not all 0; None weighs all the same.
            tolerance: the iteration stops once |grad E| <= tolerance * diagonal of the bounding box. 1e-9 on the server's
                side.
            method: "newton" (with exact second derivatives), "lbfgs" or "gradient_descent".
            start: where to start; None starts at the given point of least objective.
            starts: searches that are made; those after the first begin far from the ones before, and the lowest minimum
                is the answer. 1 on the server's side.
            max_iterations: 200 on the server's side.
            kept_fields: "on", "off" or "automatic": keep one distance field for each point over all iterations.
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
        """The equilibrium of an elastic network whose points slide on the surface: a local minimum of
        E = sum weight (length - rest_length)^2 near the start, plus the energy of a membrane's triangles, and of a host that
        gives way.

        Args:
            points: where they start, at least one: points one by one, `PointsInFaces` or `PoissonDisk`.
            springs: `Spring` or pairs of indices of points, `AdjacentFaces` or `VoronoiDual`; a spring joins two different
                points of one component.
            fixed_points: indices of points that stay where they are.
            membrane: triangles between the points, besides the springs, of which there may then be none.
            host: a `Shell` or a `Solid` whose surface is the mesh and which gives way under the network, or a surface that is
                `Moving`; None: it is rigid.
                `RelaxedNetwork.host` is where it came to be.
            options: how the equilibrium is found.
            paths: whether the paths of the springs are returned.

        Raises `InvalidNetwork` where points and springs do not fit together, with the codes "network.spring",
        "network.triangle", "network.collapsed" (a triangle without area), "network.fixed_point", "network.unreachable" and
        "network.radius", and `InvalidHost` where the mesh is no such host ("host.open_surface", "solid.not_filled", ...);
        `faults` names the entries.
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
        """`relax_network` as a job, whose `status().partial` is the network on its way."""
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
        """A relaxed network as a file: `kind` is "obj" or "vtu" (a polyline along each spring's path and the deformed host
        where there is one, mesh units), or "svg" (energy and gradient norm over the iterations). The arguments are those of `relax_network`."""
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
        """The geodesic Voronoi diagram of sites: each cell has the points that are nearer to its site than to any other.

        Args:
            sites: one by one, or `RandomSites`.
            method: "exact" (as without it), "bounded" (each distance within `relative_error`, with less work) or "edges"
                (along edges and across pairs of faces, without a bound).
            relative_error: allowed for every distance, in (0, 1]; means "bounded". 0.01 on the server's side.
            border_deviation: largest distance of a border from the straight lines between its points, in units of the
                diagonal of the mesh's bounding box, from 1e-7 to 1. 1e-5 on the server's side. Areas and lengths are those of
                the curves for any value.
            points: whether `VoronoiDiagram.points` are returned, which lie where `positions` do.
            pieces: whether `VoronoiDiagram.pieces` are returned, by which cells are coloured.
            statistics: whether edges, cells and vertices are measured.

        Raises `InvalidVoronoi` (codes "voronoi.no_sites", "voronoi.too_many_sites", "voronoi.invalid_option"), and
        `InvalidRequest` (code "request.limit_exceeded") where there are more sites than the server takes.
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
            sites: where they start: one by one, or `RandomSites`.
            objectives: weights by name, at least 0, of "edge_length" (edges as long as `VoronoiOptions.target_length`),
                "planarity" (cells whose vertices lie in a plane), "regularity" (vertices near their sites), "centroidal"
                (sites at the centres of their cells) and "equal_area". Lengths count in units of the mean cell size, so
                that all of them are numbers without a unit.
            fixed_sites: indices of sites that stay where they are.
            options: how the minimum is found.
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
        """`optimize_voronoi` as a job, whose `status().partial` is the diagram on its way (`PartialOptimization`)."""
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
        """A Voronoi diagram as a file: `kind` is "obj" or "vtu" (borders and the surface cut along them, mesh units), "svg"
        (flat panels with numbered edges, `panel_scale` millimetres for each mesh unit, 1 on the server's side) or "csv" (the
        panels' lengths and angles). Of an optimized diagram, give its `sites`. The other arguments are those of `voronoi`."""
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
        """Where the straightest path of a given direction and length ends.

        Args:
            start: where it starts.
            tangent: direction and length in mesh units: three numbers are a vector in space, whose part within the start's
                face counts; two are coordinates in the frame of that face.
            trace: whether the path is returned.
        """
        computation = computations.exponential_map(self.id, start, tangent, trace, deadline)
        return run(self._transport, computation, timeout, None)
