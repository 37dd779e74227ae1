"""Geodesics, Voronoi diagrams and elastic networks on triangle meshes; simulations, neural models and designs of periodic
structures; weaves of elastic strands; answered by a supple-server.

::

    import supple

    with supple.Client("http://127.0.0.1:8080") as client:
        mesh = client.upload("bunny.obj")
        geodesic = mesh.geodesic(0, 1200, derivatives=2, path=True)
        field = mesh.field([0])
        mean = mesh.karcher_mean([0, 300, (12, (0.2, 0.3, 0.5))])
        network = mesh.relax_network(supple.PoissonDisk(0.1), supple.VoronoiDual(rest_length=0.08))

        cells = mesh.optimize_voronoi(supple.RandomSites(100), {"centroidal": 1})

        curve = client.simulate("IH01", None, supple.Uniaxial(0.0, [1.05, 1.1, 1.15]))
        curve.green_strain, curve.stress

        model = client.model("ih21")
        model.evaluate([0.15, 0.65], [[0.05, 0, 0], [0.1, 0, 0]]).stress

        wanted = supple.Target("stress_strain", [(0, 0), (0.1, 0.6), (0.2, 0.9)])
        client.design(wanted).parameters

        client.weave_homogenization(supple.Weave.squares(2), strain=0.3).youngs_modulus

Points are vertex indices, `(face, (a, b, c))`, `Vertex`, `SurfacePoint` or `SpacePoint`. Lengths are in mesh units, those of structures in
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
    MeshRepair,
    Path,
)
from .checks import LikelyDegrees
from .client import Client
from .design_answers import (
    Design,
    DesignCandidate,
    DesignError,
    DesignProfile,
    DesignResult,
    MadeOf,
    PartialDesign,
    PartialRound,
    Polish,
    PolishRound,
    ProfileCurve,
    RegionDesigns,
    StructureSize,
    Verification,
)
from . import parts
from .designs import DesignOptions, Limits, Material, Region, Target
from .errors import (
    AccessDenied,
    ConnectionFailed,
    DeadlineExceeded,
    Fault,
    InvalidDesign,
    InvalidHost,
    InvalidMesh,
    InvalidNetwork,
    InvalidPoint,
    InvalidRequest,
    InvalidStructure,
    InvalidVoronoi,
    InvalidWeave,
    JobCancelled,
    NotFound,
    ProblemError,
    RequestTimeout,
    ServerBusy,
    ServerError,
    Superseded,
    SuppleError,
)
from .hosts import Host, Moving, Shell, Solid, SolidRegion
from .jobs import Job, JobStatus
from .keys import KeyReadableByOthers
from .loads import Biaxial, GreenStrain, Load, Uniaxial
from .mesh import Mesh
from .models import ErrorStatistics, Evaluation, Model, ModelInfo, SplitErrors, UniaxialCurve
from .network_answers import FollowedStop, HostState, PartialRelaxation, RelaxationStep, RelaxedNetwork
from .networks import AdjacentFaces, Membrane, PointsInFaces, PoissonDisk, RelaxationOptions, Spring, VoronoiDual
from .points import PlacedPoint, PointLike, SpacePoint, SurfacePoint, Vertex
from .progress import Progress
from .simulations import DeformedPatch, DiscretizationError, PatchMesh, Simulation, State
from .drawings import Drawing, DrawnPolygon
from .measured import CurveNote, MeasuredCurve
from .parts import Part, PartOptions, PartRegion
from .tilings import CellMesh, Family, Structure, Tile
from .voronoi import RandomSites, Sites, VoronoiOptions
from .voronoi_answers import (
    OptimizationStep,
    OptimizedVoronoi,
    PartialOptimization,
    SiteMoves,
    Spread,
    VoronoiCell,
    VoronoiDiagram,
    VoronoiEdge,
    VoronoiPiece,
    VoronoiPieces,
    VoronoiStatistics,
    VoronoiVertex,
)
from .weave_answers import (
    Crossing,
    CrossingMember,
    DeformedCell,
    HeldPlace,
    LaidStrand,
    SheetState,
    WeaveDeformation,
    WeaveHomogenization,
    WeaveLayout,
    WeaveSimulation,
)
from .weave_print_answers import FoundChannel, GcodeReport, PrintMove, PrintStatistics, Violation, WeaveToolpath
from .weave_printing import Grip, PrintOptions
from .weaves import Force, Place, Strand, Support, Weave, WeaveOptions

__version__ = "0.1.0"

__all__ = [
    "AccessDenied",
    "AdjacentFaces",
    "Biaxial",
    "CellMesh",
    "Client",
    "ConnectionFailed",
    "Cost",
    "Crossing",
    "CrossingMember",
    "DeadlineExceeded",
    "DeformedCell",
    "DeformedPatch",
    "Design",
    "DesignCandidate",
    "DesignError",
    "DesignOptions",
    "Limits",
    "MadeOf",
    "Material",
    "DesignProfile",
    "DesignResult",
    "DiscretizationError",
    "Effect",
    "ErrorStatistics",
    "Evaluation",
    "ExponentialMap",
    "Family",
    "Fault",
    "Field",
    "FollowedStop",
    "Force",
    "FoundChannel",
    "GcodeReport",
    "Geodesic",
    "Gradient",
    "GreenStrain",
    "Grip",
    "HeldPlace",
    "Hessian",
    "Host",
    "HostState",
    "InvalidDesign",
    "InvalidHost",
    "InvalidMesh",
    "InvalidNetwork",
    "InvalidPoint",
    "InvalidRequest",
    "InvalidStructure",
    "InvalidVoronoi",
    "InvalidWeave",
    "Job",
    "JobCancelled",
    "JobStatus",
    "KarcherMean",
    "KarcherStep",
    "LaidStrand",
    "KeyReadableByOthers",
    "LikelyDegrees",
    "Load",
    "Membrane",
    "Mesh",
    "MeshInfo",
    "MeshRepair",
    "Model",
    "ModelInfo",
    "Moving",
    "NotFound",
    "OptimizationStep",
    "OptimizedVoronoi",
    "PartialDesign",
    "PartialOptimization",
    "PartialRelaxation",
    "PartialRound",
    "PatchMesh",
    "Path",
    "Place",
    "PlacedPoint",
    "PointLike",
    "PointsInFaces",
    "PoissonDisk",
    "Polish",
    "PolishRound",
    "PrintMove",
    "PrintOptions",
    "PrintStatistics",
    "ProblemError",
    "Progress",
    "ProfileCurve",
    "RandomSites",
    "Region",
    "StructureSize",
    "RegionDesigns",
    "RelaxationOptions",
    "RelaxationStep",
    "RelaxedNetwork",
    "RequestTimeout",
    "ServerBusy",
    "ServerError",
    "SheetState",
    "Shell",
    "Simulation",
    "SiteMoves",
    "Sites",
    "Solid",
    "SolidRegion",
    "SplitErrors",
    "Spread",
    "Spring",
    "State",
    "Strand",
    "Structure",
    "Superseded",
    "SuppleError",
    "Support",
    "SpacePoint",
    "SurfacePoint",
    "Drawing",
    "DrawnPolygon",
    "CurveNote",
    "MeasuredCurve",
    "Part",
    "PartOptions",
    "PartRegion",
    "parts",
    "Target",
    "Tile",
    "Uniaxial",
    "UniaxialCurve",
    "Verification",
    "Vertex",
    "Violation",
    "VoronoiCell",
    "VoronoiDiagram",
    "VoronoiDual",
    "VoronoiEdge",
    "VoronoiOptions",
    "VoronoiPiece",
    "VoronoiPieces",
    "VoronoiStatistics",
    "VoronoiVertex",
    "Weave",
    "WeaveDeformation",
    "WeaveHomogenization",
    "WeaveLayout",
    "WeaveOptions",
    "WeaveSimulation",
    "WeaveToolpath",
]
