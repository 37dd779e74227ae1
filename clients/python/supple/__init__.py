"""Geodesics on triangle meshes, simulations of periodic structures and neural models of them, answered by a supple-server.

::

    import supple

    with supple.Client("http://127.0.0.1:8080") as client:
        mesh = client.upload("bunny.obj")
        geodesic = mesh.geodesic(0, 1200, derivatives=2, path=True)
        field = mesh.field([0])
        mean = mesh.karcher_mean([0, 300, (12, (0.2, 0.3, 0.5))])

        curve = client.simulate("IH01", None, supple.Uniaxial(0.0, [1.05, 1.1, 1.15]))
        curve.green_strain, curve.stress

        model = client.model("ih21")
        model.evaluate([0.15, 0.65], [[0.05, 0, 0], [0.1, 0, 0]]).stress

Points are vertex indices, `(face, (a, b, c))`, `Vertex` or `SurfacePoint`. Lengths are in mesh units, those of structures in
millimetres, stresses in MPa, angles in radians, times in seconds. Failures are the exceptions of `supple.errors`.
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
    InvalidStructure,
    JobCancelled,
    NotFound,
    ProblemError,
    RequestTimeout,
    ServerBusy,
    ServerError,
    SuppleError,
)
from .jobs import Job, JobStatus
from .loads import Biaxial, GreenStrain, Load, Uniaxial
from .mesh import Mesh
from .models import ErrorStatistics, Evaluation, Model, ModelInfo, SplitErrors, UniaxialCurve
from .points import PointLike, SurfacePoint, Vertex
from .simulations import DeformedPatch, PatchMesh, Simulation, State
from .tilings import CellMesh, Family, Structure, Tile

__version__ = "0.1.0"

__all__ = [
    "Biaxial",
    "CellMesh",
    "Client",
    "ConnectionFailed",
    "Cost",
    "DeadlineExceeded",
    "DeformedPatch",
    "Effect",
    "ErrorStatistics",
    "Evaluation",
    "ExponentialMap",
    "Family",
    "Fault",
    "Field",
    "Geodesic",
    "Gradient",
    "GreenStrain",
    "Hessian",
    "InvalidMesh",
    "InvalidPoint",
    "InvalidRequest",
    "InvalidStructure",
    "Job",
    "JobCancelled",
    "JobStatus",
    "KarcherMean",
    "KarcherStep",
    "Load",
    "Mesh",
    "MeshInfo",
    "Model",
    "ModelInfo",
    "NotFound",
    "PatchMesh",
    "Path",
    "PointLike",
    "ProblemError",
    "RequestTimeout",
    "ServerBusy",
    "ServerError",
    "Simulation",
    "SplitErrors",
    "State",
    "Structure",
    "SuppleError",
    "SurfacePoint",
    "Tile",
    "Uniaxial",
    "UniaxialCurve",
    "Vertex",
]
