"""The connection to a server."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Union
from urllib.parse import quote

import numpy as np
from numpy.typing import ArrayLike

from .answers import MeshInfo, MeshRepair
from .calls import named, runs, submits
from .connection import Connection
from .conversion import arrays_of
from .designs import DesignRequest, ProfileRequest, RegionsRequest
from .drawings import DrawingRequest
from .errors import ConnectionFailed, RequestTimeout, ServerBusy
from .families import AddedFamily, FamilyAtlasRequest, FamilyCheckRequest
from .jobs import Job, JobStatus
from .mesh import Mesh
from .models import Model, ModelInfo
from .part_simulations import PartSimulationFileRequest, PartSimulationRequest
from .parts import PartFileRequest, PartRequest
from .request import Request
from .simulations import SimulationRequest
from .targets import MeasuredCurveRequest
from .tilings import Family, StructureFileRequest, StructureRequest
from .trainings import TrainingPlanRequest, TrainingRequest
from .transport import Answer
from .weave_printing import GcodeReportRequest, WeaveToolpathRequest
from .weaves import (
    WeaveDeformationRequest,
    WeaveHomogenizationRequest,
    WeaveLayoutRequest,
    WeavePictureRequest,
    WeaveSimulationRequest,
)
from .wire import decode, decode_all


@named
class Client(Connection):
    """A connection to one supple-server.

    ::

        with supple.Client() as client:
            mesh = client.upload("bunny.obj")
            print(mesh.geodesic(0, 1200).distance)

    Args:
        url: the server's address; None takes the environment variable SUPPLE_SERVER, or http://127.0.0.1:8080.
        key: the key that the server requires, "supple_ID_SECRET"; None takes that of `key_file`, or the environment variable
            SUPPLE_KEY. It is sent as a header, so use https:// beyond this machine.
        key_file: a file with the key; None takes the environment variable SUPPLE_KEY_FILE. A file that other users may read
            causes a warning (`KeyReadableByOthers`).
        timeout: seconds that a single request may take to be answered (`RequestTimeout`). Computations that take longer
            than a second are followed as jobs, so it need not be long for them.
        progress: the `progress` of calls that have none of their own; True shows a bar for all that take longer than a second,
            on a terminal or in a notebook.

    The methods of computations, such as `simulate`, make a request of their arguments and run it: `client.simulate(...)` is
    `client.run(SimulationRequest(...))`, and `client.start_simulation(...)` is `client.submit(SimulationRequest(...))`, a `Job`.
    The request's class describes the arguments, and `Request` those that all have: `deadline`, `timeout`, `progress`
    and `priority`.

    Threads may share a client as far as they may share a `requests.Session`; one client for each thread is always safe.
    """

    def ready(self) -> bool:
        """Whether a server answers at the address and accepts requests."""
        try:
            self._transport.request("GET", "/readyz", repeatable=False)
            return True
        except (ConnectionFailed, RequestTimeout, ServerBusy):
            return False

    def upload(
        self,
        mesh: Any,
        *,
        repair: Union[str, Sequence[str]] = (),
        weld_tolerance: Optional[float] = None,
    ) -> Mesh:
        """Uploads a mesh: a file (OBJ, OFF, PLY or STL), given by its path or its bytes, or a mesh of trimesh, meshio or
        pyvista.

        Args:
            mesh: str, Path or bytes; or a trimesh.Trimesh, meshio.Mesh, pyvista.PolyData or similar object.
            repair: "automatic" for the repairs that are needed, or names of repairs: "weld" (joins the corners of cracks),
                "drop_degenerate" (faces without area), "drop_duplicates" (repeated faces) and "split_non_manifold" (separates
                faces at an edge with more than two of them, and fans of faces at a vertex with several). `Mesh.repair` says what
                they have changed, and gives the new vertices and face of each old one.
            weld_tolerance: distance up to which "weld" joins any vertices, over the diagonal of the bounding box, in
                [0, 0.01]. Without it only the corners of cracks are joined.

        Uploading the same content twice gives the same mesh. Raises `InvalidMesh`, whose `faults` name the elements, also if
        faults remain after the repairs.
        """
        if not isinstance(mesh, (str, Path, bytes)):
            arrays = arrays_of(mesh)
            if arrays is None:
                raise TypeError(f"{type(mesh).__name__} is neither a file nor a mesh of trimesh, meshio or pyvista")
            return self.upload_arrays(*arrays, repair=repair, weld_tolerance=weld_tolerance)
        content = mesh if isinstance(mesh, bytes) else Path(mesh).read_bytes()
        query: Dict[str, str] = {}
        if repair:
            query["repair"] = ",".join(_repair_names(repair))
        if weld_tolerance is not None:
            query["weld_tolerance"] = repr(float(weld_tolerance))
        headers = {"Content-Type": "application/octet-stream"}
        return self._created(query=query, body=content, headers=headers)

    def upload_arrays(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        repair: Union[str, Sequence[str]] = (),
        weld_tolerance: Optional[float] = None,
    ) -> Mesh:
        """Uploads a mesh given by arrays.

        Args:
            vertices: positions in mesh units, shape (n, 3).
            faces: vertex indices from 0, shape (m, 3), counterclockwise seen from outside.
            repair, weld_tolerance: as in `upload`.
        """
        positions = np.asarray(vertices, dtype=np.float64)
        triangles = np.asarray(faces)
        for name, array in (("vertices", positions), ("faces", triangles)):
            if array.ndim != 2 or array.shape[1] != 3:
                raise ValueError(f"{name} have the shape {array.shape}; expected (n, 3)")
        if not np.issubdtype(triangles.dtype, np.integer):
            raise ValueError(f"faces hold {triangles.dtype}; expected integers")
        document: Dict[str, Any] = {"vertices": positions.tolist(), "faces": triangles.tolist()}
        if repair:
            document["repair"] = _repair_names(repair)
        if weld_tolerance is not None:
            document["weld_tolerance"] = float(weld_tolerance)
        return self._created(document=document)

    def _created(self, **sent: Any) -> Mesh:
        document = self._transport.request("POST", "/v1/meshes", repeatable=True, **sent).json()
        repair = decode(MeshRepair, document["repair"]) if "repair" in document else None
        return Mesh(self._transport, decode(MeshInfo, document), repair)

    def mesh(self, mesh_id: str) -> Mesh:
        """A mesh that the server has. Raises `NotFound`."""
        return Mesh(self._transport, decode(MeshInfo, self._get("/v1/meshes", mesh_id)))

    def meshes(self) -> Iterator[MeshInfo]:
        """The server's meshes, the newest first."""
        return (decode(MeshInfo, mesh) for mesh in self._entries("/v1/meshes", "meshes", {}))

    def families(self) -> List[Family]:
        """The families of tilings that structures are made from."""
        return decode_all(Family, self._get("/v1/families")["families"])

    def add_family(self, definition: Mapping[str, Any]) -> AddedFamily:
        """Adds a family of one's own, which the server checks and stores. A definition with faults raises `InvalidStructure`, whose `faults` say
        where they are.

        Args:
            definition: as in `Family.definition` (schema `FamilyDefinition` of the contract).
        """
        return decode(AddedFamily, self._transport.request("POST", "/v1/families", document={"definition": dict(definition)}, repeatable=True).json())

    def add_drawn_family(
        self,
        svg: Union[str, Path],
        isohedral_type: str,
        family_id: str,
        *,
        description: str = "",
        reach: Optional[float] = None,
        beam_width: Optional[float] = None,
        shape_parameters: bool = False,
    ) -> AddedFamily:
        """Adds the family of a tile that is drawn. A drawing that is no tile of the type raises `InvalidStructure`, which says why.

        Args:
            svg: path of an SVG file with one closed curve.
            isohedral_type: its type, such as "IH21".
            family_id: id of the family.
            description: what the family is.
            reach: greatest distance of the parameters' bounds from those of the drawn tile, dimensionless; None takes 0.05.
            beam_width: width of the beams in tiling units; None takes 5 % of the square root of the tile's area.
            shape_parameters: whether the heights of curved edges become parameters.
        """
        document: Dict[str, Any] = {"svg": Path(svg).read_text(encoding="utf-8"), "type": isohedral_type, "id": family_id,
                                    "description": description, "shape_parameters": shape_parameters}
        document.update({name: float(value) for name, value in (("reach", reach), ("beam_width", beam_width)) if value is not None})
        return decode(AddedFamily, self._transport.request("POST", "/v1/families", document=document, repeatable=True).json())

    def remove_family(self, family_id: str) -> None:
        """Removes a family that was added. Raises `InvalidStructure` for one that an unfinished job needs or that comes
        with the server, and `NotFound`."""
        self._transport.request("DELETE", f"/v1/families/{quote(family_id, safe='')}")

    def family(self, family_id: str) -> Family:
        """A family by its id, such as "IH21". Raises `NotFound`."""
        return decode(Family, self._get("/v1/families", family_id))

    def family_definition(self, family_id: str) -> str:
        """The definition of a family as text, which `supple-lab learn --definition` reads. Raises `NotFound`."""
        return self._transport.request("GET", f"/v1/families/{quote(family_id, safe='')}/definition", headers={"Accept": "text/plain"}).content.decode()

    def isohedral_types(self) -> List[Dict[str, Any]]:
        """The table of the 81 isohedral types, by their numbers (schema `IsohedralType` of the contract)."""
        types: List[Dict[str, Any]] = self._get("/v1/isohedral-types")["types"]
        return types

    def models(self) -> List[Model]:
        """The neural models that the server has, in the order of their ids."""
        return [Model(self._transport, info) for info in decode_all(ModelInfo, self._get("/v1/models")["models"])]

    def model(self, model_id: str) -> Model:
        """A neural model by its id, such as "ih21". Raises `NotFound`."""
        return Model(self._transport, decode(ModelInfo, self._get("/v1/models", model_id)))

    check_family = runs(FamilyCheckRequest)
    family_atlas = runs(FamilyAtlasRequest)
    start_family_atlas = submits(FamilyAtlasRequest)
    plan_training = runs(TrainingPlanRequest)
    train = runs(TrainingRequest)
    start_training = submits(TrainingRequest)
    structure = runs(StructureRequest)
    structure_file = runs(StructureFileRequest)
    simulate = runs(SimulationRequest)
    start_simulation = submits(SimulationRequest)

    design = runs(DesignRequest)
    start_design = submits(DesignRequest)
    design_regions = runs(RegionsRequest)
    start_design_regions = submits(RegionsRequest)
    profile = runs(ProfileRequest)
    start_profile = submits(ProfileRequest)
    measured_curve = runs(MeasuredCurveRequest)

    drawing = runs(DrawingRequest)
    part = runs(PartRequest)
    part_file = runs(PartFileRequest)
    part_simulation = runs(PartSimulationRequest)
    start_part_simulation = submits(PartSimulationRequest)
    part_simulation_file = runs(PartSimulationFileRequest)

    weave_layout = runs(WeaveLayoutRequest)
    weave_picture = runs(WeavePictureRequest)
    weave_homogenization = runs(WeaveHomogenizationRequest)
    start_weave_homogenization = submits(WeaveHomogenizationRequest)
    weave_deformation = runs(WeaveDeformationRequest)
    start_weave_deformation = submits(WeaveDeformationRequest)
    weave_simulation = runs(WeaveSimulationRequest)
    start_weave_simulation = submits(WeaveSimulationRequest)
    weave_toolpath = runs(WeaveToolpathRequest)
    start_weave_toolpath = submits(WeaveToolpathRequest)
    gcode_report = runs(GcodeReportRequest)
    start_gcode_report = submits(GcodeReportRequest)

    def jobs(self, state: Optional[str] = None) -> Iterator[JobStatus]:
        """The server's jobs, the newest first; only those in `state` if it is given."""
        query = {} if state is None else {"state": state}
        return (decode(JobStatus, job) for job in self._entries("/v1/jobs", "jobs", query))

    def job(self, job_id: str) -> Job[Any]:
        """A job by its id; its `result` is the decoded JSON, or bytes for a binary field or a file. Raises `NotFound`."""
        self._get("/v1/jobs", job_id)
        return Job(self._transport, job_id, _AnyRequest())

    def _get(self, path: str, of: Optional[str] = None) -> Any:
        return self._transport.request("GET", path if of is None else f"{path}/{quote(of, safe='')}").json()

    def _entries(self, path: str, key: str, query: Dict[str, str]) -> Iterator[Dict[str, Any]]:
        """Every entry of a list that the server sends in pages."""
        while True:
            page = self._transport.request("GET", path, query=query).json()
            yield from page[key]
            if "next" not in page:
                return
            query = {**query, "after": page["next"]}


class _AnyRequest(Request[Any]):
    """The request of a job that another client submitted."""

    timeout = None
    progress = None

    @property
    def accept(self) -> str:
        return "*/*"

    def decode(self, answer: Answer) -> Any:
        return answer.json() if answer.content_type == "application/json" else answer.content


def _repair_names(repair: Union[str, Sequence[str]]) -> List[str]:
    """The names as a list. A single text is a list of one name, and not of letters."""
    if repair == "automatic":
        return ["automatic"]
    if isinstance(repair, str):
        raise TypeError(f"repair is {repair!r}; expected a sequence of names such as [{repair!r}]")
    return list(repair)
