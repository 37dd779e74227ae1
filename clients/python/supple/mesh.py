"""A mesh on the server and the computations on it."""

from __future__ import annotations

from typing import Any, List, Optional, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import conversion
from ._arrays import Array
from .answers import Geodesic, MeshInfo, MeshRepair
from .calls import named, runs_here, submits_here
from .drawing import plot_surface
from .geodesics import ExponentialMapRequest, FieldRequest, GeodesicsRequest, KarcherMeanRequest
from .nearest import nearest_points
from .networks import NetworkFileRequest, RelaxationRequest
from .points import PointLike, SurfacePoint
from .request import Resource
from .transport import Transport
from .voronoi import VoronoiFileRequest, VoronoiOptimizationRequest, VoronoiRequest

_VERTEX = np.dtype("<f8")
_FACE = np.dtype([("corners", "u1"), ("vertices", "<i4", (3,))])


@named
class Mesh(Resource):
    """A mesh on a server. Methods of `Client` create it.

    Every computation has two forms: `geodesics(...)` waits and returns the result, `start_geodesics(...)` returns a `Job`
    immediately. Their arguments are the fields of a request, such as `GeodesicsRequest`, after its mesh; `Request` describes
    `deadline`, `timeout`, `progress` and `priority`. Anything that interrupts the wait cancels the computation.

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

    geodesics = runs_here(GeodesicsRequest)
    start_geodesics = submits_here(GeodesicsRequest)
    field = runs_here(FieldRequest)
    start_field = submits_here(FieldRequest)
    karcher_mean = runs_here(KarcherMeanRequest)
    start_karcher_mean = submits_here(KarcherMeanRequest)
    exponential_map = runs_here(ExponentialMapRequest)

    relax_network = runs_here(RelaxationRequest)
    start_relax_network = submits_here(RelaxationRequest)
    relaxed_network_file = runs_here(NetworkFileRequest)

    voronoi = runs_here(VoronoiRequest)
    start_voronoi = submits_here(VoronoiRequest)
    optimize_voronoi = runs_here(VoronoiOptimizationRequest)
    start_optimize_voronoi = submits_here(VoronoiOptimizationRequest)
    voronoi_file = runs_here(VoronoiFileRequest)
