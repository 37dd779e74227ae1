"""The connection to a server."""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, Type, Union
from urllib.parse import urlencode

import numpy as np
from numpy.typing import ArrayLike

from . import designs, simulations, tilings
from .answers import MeshInfo, mesh_info_from_wire, mesh_repair_from_wire
from .conversion import arrays_of
from .design_answers import DesignResult, ProfileCurve, RegionDesigns
from .designs import DesignOptions, Limits, Material, Region, Target
from .errors import ConnectionFailed, RequestTimeout, ServerBusy
from .jobs import Job, JobStatus, Progress, run, status_from_wire, submit
from .keys import find_key
from .loads import Load
from .maker_calls import MakerCalls
from .mesh import Mesh
from .models import Model, model_info_from_wire
from .simulations import Simulation
from .tilings import Family, Structure
from .transport import Answer, Transport
from .weave_calls import WeaveCalls

DEFAULT_URL = "http://127.0.0.1:8080"


class Client(WeaveCalls, MakerCalls):
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

    Threads may share a client as far as they may share a `requests.Session`; one client for each thread is always safe.
    """

    def __init__(
        self,
        url: Optional[str] = None,
        *,
        key: Optional[str] = None,
        key_file: Optional[Union[str, Path]] = None,
        timeout: float = 60.0,
        progress: Optional[Progress] = None,
    ) -> None:
        if url is None:
            url = os.environ.get("SUPPLE_SERVER", DEFAULT_URL)
        self._transport = Transport(url, timeout, key=find_key(key, key_file), progress=progress)

    def __enter__(self) -> "Client":
        return self

    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        error: Optional[BaseException],
        traceback: Optional[TracebackType],
    ) -> None:
        self.close()

    def close(self) -> None:
        """Closes the connections. Jobs on the server continue."""
        self._transport.close()

    @property
    def url(self) -> str:
        return self._transport.url

    def __repr__(self) -> str:
        return f"Client({self.url!r})"

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
        path = "/v1/meshes"
        query: Dict[str, str] = {}
        if repair:
            query["repair"] = ",".join(_repair_names(repair))
        if weld_tolerance is not None:
            query["weld_tolerance"] = repr(float(weld_tolerance))
        if query:
            path += "?" + urlencode(query, safe=",")
        return self._created(
            self._transport.request(
                "POST", path, body=content, headers={"Content-Type": "application/octet-stream"}, repeatable=True
            )
        )

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
        return self._created(self._transport.request("POST", "/v1/meshes", document=document, repeatable=True))

    def _created(self, answer: Answer) -> Mesh:
        document = answer.json()
        repair = mesh_repair_from_wire(document["repair"]) if "repair" in document else None
        return Mesh(self._transport, mesh_info_from_wire(document), repair)

    def mesh(self, mesh_id: str) -> Mesh:
        """A mesh that the server has. Raises `NotFound`."""
        return Mesh(self._transport, mesh_info_from_wire(self._transport.request("GET", f"/v1/meshes/{mesh_id}").json()))

    def meshes(self) -> Iterator[MeshInfo]:
        """The server's meshes, the newest first."""
        return map(mesh_info_from_wire, self._entries("/v1/meshes", "meshes", {}))

    def families(self) -> List[Family]:
        """The families of tilings that structures are made from."""
        return tilings.families_from_wire(self._transport.request("GET", "/v1/families").json()["families"])

    def family(self, family_id: str) -> Family:
        """A family by its id, such as "IH21". Raises `NotFound`."""
        return tilings.family_from_wire(self._transport.request("GET", f"/v1/families/{family_id}").json())

    def structure(
        self,
        family: str,
        parameters: Optional[Sequence[float]] = None,
        *,
        beam_width: Optional[float] = None,
        mesh_size: Optional[float] = None,
        corner_size: Optional[float] = None,
        mesh_region: Optional[str] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
    ) -> Structure:
        """The beam structure of a tiling: one periodic cell.

        Args:
            family: id of the family.
            parameters: within the family's bounds; None takes its defaults. Raises `InvalidStructure` if they give no valid
                structure.
            beam_width: in mm; the whole structure scales with it. 0.3 by default.
            mesh_size: side length of the triangles over beam width. With any mesh option the cell is meshed, and the result
                has the mesh's statistics.
            corner_size: side length at re-entrant corners over that elsewhere, in (0, 1].
            mesh_region: whether single tiles or the whole cell are meshed at a time: "automatic", "tile" or "cell".
        """
        computation = tilings.structure(family, parameters, beam_width, mesh_size, corner_size, mesh_region, deadline)
        return run(self._transport, computation, timeout, None)

    def structure_file(
        self,
        family: str,
        parameters: Optional[Sequence[float]] = None,
        *,
        kind: str = "svg",
        cells: Tuple[int, int] = (2, 2),
        height: float = 1.0,
        beam_width: Optional[float] = None,
        timeout: Optional[float] = None,
    ) -> bytes:
        """A structure as a file: `kind` is "svg", "dxf" or "stl" (binary, extruded by `height` mm). Lengths are in mm."""
        computation = tilings.structure_file(family, parameters, kind, cells, height, beam_width)
        return run(self._transport, computation, timeout, None)

    def simulate(
        self,
        family: str,
        parameters: Optional[Sequence[float]],
        load: Load,
        *,
        material: Optional[Mapping[str, Any]] = None,
        mesh_size: Optional[float] = None,
        corner_size: Optional[float] = None,
        mesh_region: Optional[str] = None,
        discretization_error: Optional[float] = None,
        tolerance: Optional[float] = None,
        max_load_step: Optional[float] = None,
        max_iterations: Optional[int] = None,
        contact: Optional[str] = None,
        patch: Optional[str] = None,
        buckling: Optional[str] = None,
        refinement: Optional[str] = None,
        tangents: bool = True,
        deformed: str = "none",
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> Simulation:
        """The homogenized response of a structure along a load path from rest.

        Args:
            family, parameters: the structure, as in `structure`.
            load: `GreenStrain`, `Uniaxial` or `Biaxial`.
            material: "law", "youngs_modulus" (MPa) and "poisson_ratio"; a neo-Hookean law with 26 MPa and 0.48 by default.
            mesh_size, corner_size, mesh_region: as in `structure`. Without `mesh_size` the server chooses the mesh, and reduces
                its discretization error by extrapolation.
            discretization_error: permitted relative error of the stress due to the mesh; the server then chooses the mesh.
                `mesh_size` has precedence if both are given.
            tolerance: relative residual of an equilibrium. 1e-8 by default.
            max_load_step: largest change of a component of F in one internal load step.
            max_iterations: Newton iterations for one load step before it is halved.
            contact, patch, buckling: "on", "off" or "automatic".
            refinement: "on" extrapolates the states from the mesh and a finer one; "automatic" does so too, but only estimates
                the error if `mesh_size` is given; "off" does neither, in about half of the time.
            tangents: whether tangent stiffnesses are computed.
            deformed: "json" for the deformed points and triangles of each state, "vtu" for VTK files, "none".

        A path that cannot be followed to its end raises no exception: see `Simulation.message`.
        """
        accuracy = _accuracy(
            mesh_size, corner_size, mesh_region, tolerance, max_load_step, max_iterations, discretization_error
        )
        effects = {"contact": contact, "patch": patch, "buckling": buckling, "refinement": refinement}
        computation = simulations.simulation(
            family, parameters, load, material, accuracy, effects, tangents, deformed, deadline
        )
        return run(self._transport, computation, timeout, progress)

    def start_simulation(
        self,
        family: str,
        parameters: Optional[Sequence[float]],
        load: Load,
        *,
        material: Optional[Mapping[str, Any]] = None,
        mesh_size: Optional[float] = None,
        corner_size: Optional[float] = None,
        mesh_region: Optional[str] = None,
        discretization_error: Optional[float] = None,
        tolerance: Optional[float] = None,
        max_load_step: Optional[float] = None,
        max_iterations: Optional[int] = None,
        contact: Optional[str] = None,
        patch: Optional[str] = None,
        buckling: Optional[str] = None,
        refinement: Optional[str] = None,
        tangents: bool = True,
        deformed: str = "none",
        deadline: Optional[float] = None,
    ) -> Job[Simulation]:
        """`simulate` as a job."""
        accuracy = _accuracy(
            mesh_size, corner_size, mesh_region, tolerance, max_load_step, max_iterations, discretization_error
        )
        effects = {"contact": contact, "patch": patch, "buckling": buckling, "refinement": refinement}
        computation = simulations.simulation(
            family, parameters, load, material, accuracy, effects, tangents, deformed, deadline
        )
        return submit(self._transport, computation)

    def models(self) -> List[Model]:
        """The neural models that the server has, in the order of their ids."""
        documents = self._transport.request("GET", "/v1/models").json()["models"]
        return [Model(self._transport, model_info_from_wire(document)) for document in documents]

    def model(self, model_id: str) -> Model:
        """A neural model by its id, such as "ih21". Raises `NotFound`."""
        return Model(self._transport, model_info_from_wire(self._transport.request("GET", f"/v1/models/{model_id}").json()))

    def design(
        self,
        target: Target,
        *,
        family: Optional[str] = None,
        model: Optional[str] = None,
        also: Sequence[Target] = (),
        initial: Optional[Sequence[float]] = None,
        fixed: Optional[Sequence[Optional[float]]] = None,
        orientation: Union[float, Tuple[float, float], None] = None,
        initial_orientation: Optional[float] = None,
        material: Union[Material, Sequence[Material], None] = None,
        beam_width: Optional[float] = None,
        cell_size: Optional[float] = None,
        limits: Optional[Limits] = None,
        verify: bool = False,
        options: Optional[DesignOptions] = None,
        session: Optional[str] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> DesignResult:
        """Tiling parameters whose response follows a target profile.

        Args:
            target: the wanted profile.
            family: id of the family to search; None searches every family that has a model.
            model: id of the model, instead of a family.
            also: further targets of the same design.
            initial: parameters to start from, shape (p,); with a family or model.
            fixed: values of fixed parameters, and None for those to be found, shape (p,); with a family or model.
            orientation: angle by which the tiling is rotated counterclockwise, radians, or a pair (least, greatest) at most pi
                apart, between which the search finds it. 0 by default. Directions do not rotate with the tiling.
            initial_orientation: the orientation that belongs to `initial`.
            material: the material of the structure, or several materials, of which the search chooses the best for the
                targets; None takes the material of the model's data.
            beam_width, cell_size: the size of the structure in mm, given by one of the two; its response does not depend on
                it. Beams of 0.3 mm by default.
            limits: limits of the structure's size and density. Raises `InvalidDesign` if no design is within them.
            verify: whether the design is also simulated at its native scale and corrected until the simulation follows the
                target (`DesignOptions.polish`); this takes seconds to minutes.
            session: a newer request of the same session replaces this one while it runs (`Superseded`).

        A target that no design reaches raises no exception: see `Design.reached` and `Design.message`. Raises `InvalidDesign`.
        """
        problem = Region(
            target, None, family, model, also, initial, fixed, orientation, initial_orientation, material, beam_width, cell_size,
            limits,
        )
        return run(self._transport, designs.design(problem, options, verify, session, deadline), timeout, progress)

    def start_design(
        self,
        target: Target,
        *,
        family: Optional[str] = None,
        model: Optional[str] = None,
        also: Sequence[Target] = (),
        initial: Optional[Sequence[float]] = None,
        fixed: Optional[Sequence[Optional[float]]] = None,
        orientation: Union[float, Tuple[float, float], None] = None,
        initial_orientation: Optional[float] = None,
        material: Union[Material, Sequence[Material], None] = None,
        beam_width: Optional[float] = None,
        cell_size: Optional[float] = None,
        limits: Optional[Limits] = None,
        verify: bool = False,
        options: Optional[DesignOptions] = None,
        session: Optional[str] = None,
        deadline: Optional[float] = None,
    ) -> Job[DesignResult]:
        """`design` as a job, whose `status().partial` is the best design so far."""
        problem = Region(
            target, None, family, model, also, initial, fixed, orientation, initial_orientation, material, beam_width, cell_size,
            limits,
        )
        return submit(self._transport, designs.design(problem, options, verify, session, deadline))

    def design_regions(
        self,
        regions: Sequence[Region],
        *,
        verify: bool = False,
        options: Optional[DesignOptions] = None,
        session: Optional[str] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> RegionDesigns:
        """A design for each region of a product, for example forefoot, midfoot and heel of a sole; see `design`."""
        computation = designs.design_regions(regions, options, verify, session, deadline)
        return run(self._transport, computation, timeout, progress)

    def start_design_regions(
        self,
        regions: Sequence[Region],
        *,
        verify: bool = False,
        options: Optional[DesignOptions] = None,
        session: Optional[str] = None,
        deadline: Optional[float] = None,
    ) -> Job[RegionDesigns]:
        """`design_regions` as a job."""
        return submit(self._transport, designs.design_regions(regions, options, verify, session, deadline))

    def profile(
        self,
        task: str,
        parameters: Sequence[float],
        *,
        family: Optional[str] = None,
        model: Optional[str] = None,
        direction: Optional[float] = None,
        strain: Optional[float] = None,
        strain_measure: Optional[str] = None,
        x: Optional[ArrayLike] = None,
        limits: Optional[Tuple[float, float]] = None,
        samples: Optional[int] = None,
        equilibrium_tolerance: Optional[float] = None,
        orientation: Optional[float] = None,
        material: Optional[Material] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> ProfileCurve:
        """The profile of given parameters, by the neural model of their family.

        Args:
            task, direction, strain, strain_measure: what the profile shows, as in `Target`.
            parameters: parameters of the design, shape (p,), dimensionless.
            family, model: the family or the model of the parameters; one of the two.
            x: strains or angles in radians, shape (n,), in any order.
            limits: first and last strain, instead of `x`; (-0.1, 0.2) by default. Directions always cover half a turn.
            samples: number of evenly spaced samples. 31 by default, 50 over directions.
            equilibrium_tolerance: relative residual of an equilibrium. 1e-10 by default.
            orientation: angle by which the tiling is rotated counterclockwise, radians. 0 by default.
            material: the material of the structure, with one Young's modulus; None takes that of the model's data.
        """
        computation = designs.profile(
            task, parameters, family, model, direction, strain, strain_measure, x, limits, samples,
            equilibrium_tolerance, orientation, material, deadline,
        )
        return run(self._transport, computation, timeout, progress)

    def start_profile(
        self,
        task: str,
        parameters: Sequence[float],
        *,
        family: Optional[str] = None,
        model: Optional[str] = None,
        direction: Optional[float] = None,
        strain: Optional[float] = None,
        strain_measure: Optional[str] = None,
        x: Optional[ArrayLike] = None,
        limits: Optional[Tuple[float, float]] = None,
        samples: Optional[int] = None,
        equilibrium_tolerance: Optional[float] = None,
        orientation: Optional[float] = None,
        material: Optional[Material] = None,
        deadline: Optional[float] = None,
    ) -> Job[ProfileCurve]:
        """`profile` as a job."""
        computation = designs.profile(
            task, parameters, family, model, direction, strain, strain_measure, x, limits, samples,
            equilibrium_tolerance, orientation, material, deadline,
        )
        return submit(self._transport, computation)

    def jobs(self, state: Optional[str] = None) -> Iterator[JobStatus]:
        """The server's jobs, the newest first; only those in `state` if it is given."""
        return map(status_from_wire, self._entries("/v1/jobs", "jobs", {} if state is None else {"state": state}))

    def job(self, job_id: str) -> Job[Any]:
        """A job by its id; its `result` is the decoded JSON, or bytes for a binary field or a file. Raises `NotFound`."""
        self._transport.request("GET", f"/v1/jobs/{job_id}")

        def decode(answer: Answer) -> Any:
            return answer.json() if answer.content_type == "application/json" else answer.content

        return Job(self._transport, job_id, decode, "*/*")

    def _entries(self, path: str, key: str, query: Dict[str, str]) -> Iterator[Dict[str, Any]]:
        """Every entry of a list that the server sends in pages."""
        while True:
            parameters = "&".join(f"{name}={value}" for name, value in query.items())
            page = self._transport.request("GET", path + ("?" + parameters if parameters else "")).json()
            yield from page[key]
            if "next" not in page:
                return
            query = {**query, "after": page["next"]}


def _repair_names(repair: Union[str, Sequence[str]]) -> List[str]:
    """The names as a list. A single text is a list of one name, and not of letters."""
    if repair == "automatic":
        return ["automatic"]
    if isinstance(repair, str):
        raise TypeError(f"repair is {repair!r}; expected a sequence of names such as [{repair!r}]")
    return list(repair)


def _accuracy(
    mesh_size: Optional[float],
    corner_size: Optional[float],
    mesh_region: Optional[str],
    tolerance: Optional[float],
    max_load_step: Optional[float],
    max_iterations: Optional[int],
    discretization_error: Optional[float],
) -> Dict[str, Any]:
    return {
        "mesh_size": mesh_size,
        "corner_size": corner_size,
        "mesh_region": mesh_region,
        "tolerance": tolerance,
        "max_load_step": max_load_step,
        "max_iterations": max_iterations,
        "discretization_error": discretization_error,
    }
