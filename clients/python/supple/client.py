"""The connection to a server."""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import Any, Dict, Iterator, Optional, Type, Union

import numpy as np
from numpy.typing import ArrayLike

from .answers import MeshInfo, mesh_info_from_wire
from .errors import ConnectionFailed, RequestTimeout, ServerBusy
from .jobs import Job, JobStatus, status_from_wire
from .mesh import Mesh
from .transport import Answer, Transport

DEFAULT_URL = "http://127.0.0.1:8080"


class Client:
    """Speaks to one supple-server.

    ::

        with supple.Client() as client:
            mesh = client.upload("bunny.obj")
            print(mesh.geodesic(0, 1200).distance)

    Args:
        url: the server's address; None takes the environment's SUPPLE_SERVER, or http://127.0.0.1:8080.
        timeout: seconds that a single request may take to be answered (`RequestTimeout`). Computations that take longer
            than a second are followed as jobs, so it need not be long for them.

    A client may be shared by threads as far as `requests.Session` may; one client for each thread is safe in any case.
    """

    def __init__(self, url: Optional[str] = None, *, timeout: float = 60.0) -> None:
        if url is None:
            url = os.environ.get("SUPPLE_SERVER", DEFAULT_URL)
        self._transport = Transport(url, timeout)

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
        """Closes the connections. Jobs on the server go on."""
        self._transport.close()

    @property
    def url(self) -> str:
        return self._transport.url

    def ready(self) -> bool:
        """Whether a server answers there and accepts requests."""
        try:
            self._transport.request("GET", "/readyz", repeatable=False)
            return True
        except (ConnectionFailed, RequestTimeout, ServerBusy):
            return False

    def upload(self, mesh: Union[str, Path, bytes]) -> Mesh:
        """Uploads a mesh file (OBJ, OFF, PLY or STL), given by its path or its bytes.

        Uploading the same content twice gives the same mesh. Raises `InvalidMesh`, whose `faults` name the elements.
        """
        content = mesh if isinstance(mesh, bytes) else Path(mesh).read_bytes()
        return self._created(
            self._transport.request(
                "POST", "/v1/meshes", body=content, headers={"Content-Type": "application/octet-stream"}, repeatable=True
            )
        )

    def upload_arrays(self, vertices: ArrayLike, faces: ArrayLike) -> Mesh:
        """Uploads a mesh given by arrays.

        Args:
            vertices: positions in mesh units, shape (n, 3).
            faces: vertex indices from 0, shape (m, 3), counterclockwise seen from outside.
        """
        positions = np.asarray(vertices, dtype=np.float64)
        triangles = np.asarray(faces)
        for name, array in (("vertices", positions), ("faces", triangles)):
            if array.ndim != 2 or array.shape[1] != 3:
                raise ValueError(f"{name} have the shape {array.shape}; expected (n, 3)")
        if not np.issubdtype(triangles.dtype, np.integer):
            raise ValueError(f"faces hold {triangles.dtype}; expected integers")
        document = {"vertices": positions.tolist(), "faces": triangles.tolist()}
        return self._created(self._transport.request("POST", "/v1/meshes", document=document, repeatable=True))

    def _created(self, answer: Answer) -> Mesh:
        return Mesh(self._transport, mesh_info_from_wire(answer.json()))

    def mesh(self, mesh_id: str) -> Mesh:
        """A mesh that the server has. Raises `NotFound`."""
        return Mesh(self._transport, mesh_info_from_wire(self._transport.request("GET", f"/v1/meshes/{mesh_id}").json()))

    def meshes(self) -> Iterator[MeshInfo]:
        """The server's meshes, the newest first."""
        return map(mesh_info_from_wire, self._entries("/v1/meshes", "meshes", {}))

    def jobs(self, state: Optional[str] = None) -> Iterator[JobStatus]:
        """The server's jobs, the newest first; only those in `state` where one is given."""
        return map(status_from_wire, self._entries("/v1/jobs", "jobs", {} if state is None else {"state": state}))

    def job(self, job_id: str) -> Job[Any]:
        """A job by its id; its `result` is the decoded JSON, or bytes for a binary field. Raises `NotFound`."""
        self._transport.request("GET", f"/v1/jobs/{job_id}")

        def decode(answer: Answer) -> Any:
            return answer.json() if answer.content_type == "application/json" else answer.content

        return Job(self._transport, job_id, decode, "*/*")

    def _entries(self, path: str, key: str, query: Dict[str, str]) -> Iterator[Dict[str, Any]]:
        """Every entry of a list that comes in pages."""
        while True:
            parameters = "&".join(f"{name}={value}" for name, value in query.items())
            page = self._transport.request("GET", path + ("?" + parameters if parameters else "")).json()
            yield from page[key]
            if "next" not in page:
                return
            query = {**query, "after": page["next"]}
