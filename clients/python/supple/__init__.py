"""Exact geodesics on triangle meshes, answered by a supple-server.

::

    import supple

    with supple.Client("http://127.0.0.1:8080") as client:
        mesh = client.upload("bunny.obj")
        geodesic = mesh.geodesic(0, 1200, derivatives=2, path=True)
        field = mesh.field([0])
        mean = mesh.karcher_mean([0, 300, (12, (0.2, 0.3, 0.5))])

Points are vertex indices, `(face, (a, b, c))`, `Vertex` or `SurfacePoint`. Lengths are in mesh units, angles in radians,
times in seconds. Failures are the exceptions of `supple.errors`.
"""

from .answers import (
    Cost,
    Effect,
    ExponentialMap,
    Field,
    Geodesic,
    Gradient,
    Hessian,
    KarcherMean,
    KarcherStep,
    MeshInfo,
    Path,
)
from .client import Client
from .errors import (
    ConnectionFailed,
    DeadlineExceeded,
    Fault,
    InvalidMesh,
    InvalidPoint,
    InvalidRequest,
    JobCancelled,
    NotFound,
    ProblemError,
    RequestTimeout,
    ServerBusy,
    ServerError,
    SuppleError,
)
from .jobs import Job, JobStatus
from .mesh import Mesh
from .points import PointLike, SurfacePoint, Vertex

__version__ = "0.1.0"

__all__ = [
    "Client",
    "ConnectionFailed",
    "Cost",
    "DeadlineExceeded",
    "Effect",
    "ExponentialMap",
    "Fault",
    "Field",
    "Geodesic",
    "Gradient",
    "Hessian",
    "InvalidMesh",
    "InvalidPoint",
    "InvalidRequest",
    "Job",
    "JobCancelled",
    "JobStatus",
    "KarcherMean",
    "KarcherStep",
    "Mesh",
    "MeshInfo",
    "NotFound",
    "Path",
    "PointLike",
    "ProblemError",
    "RequestTimeout",
    "ServerBusy",
    "ServerError",
    "SuppleError",
    "SurfacePoint",
    "Vertex",
]
