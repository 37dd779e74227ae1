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
        test = client.part_simulation(supple.PartRequest(supple.parts.block(30, 20), "IH21"), strain=-0.1)
        test.displacement, test.force

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
    BeamWidthSensitivity,
    Design,
    DesignCandidate,
    DesignError,
    DesignProfile,
    DesignResult,
    FitRange,
    MadeOf,
    MaterialBound,
    PartialDesign,
    PartialRound,
    Polish,
    PolishRound,
    PossibleProfile,
    ProfileCurve,
    RegionDesigns,
    StructureSize,
    Verdict,
    Verification,
    WayOut,
)
from . import parts
from .designs import DesignOptions, DesignRequest, Limits, Material, ProfileRequest, Region, RegionsRequest
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
from .families import (
    AddedFamily,
    AtlasComparison,
    AtlasMeshError,
    AtlasNearest,
    AtlasProfile,
    AtlasSample,
    FamilyAtlas,
    FamilyAtlasRequest,
    FamilyCheck,
    FamilyCheckRequest,
    FamilyFinding,
    FamilyTiling,
)
from .geodesics import ExponentialMapRequest, FieldRequest, GeodesicsRequest, KarcherMeanRequest
from .hosts import Host, Moving, Shell, Solid, SolidRegion
from .jobs import Job, JobStatus
from .keys import KeyReadableByOthers
from .loads import Biaxial, GreenStrain, Load, Uniaxial
from .mesh import Mesh
from .models import (
    ErrorStatistics,
    Evaluation,
    EvaluationRequest,
    Model,
    ModelInfo,
    SplitErrors,
    UniaxialCurve,
    UniaxialRequest,
)
from .network_answers import FollowedStop, HostState, PartialRelaxation, RelaxationStep, RelaxedNetwork
from .networks import (
    AdjacentFaces,
    Membrane,
    NetworkFileRequest,
    PointsInFaces,
    PoissonDisk,
    RelaxationOptions,
    RelaxationRequest,
    Spring,
    VoronoiDual,
)
from .points import PlacedPoint, PointLike, SpacePoint, SurfacePoint, Vertex
from .progress import Progress
from .request import Request
from .simulations import DeformedPatch, DiscretizationError, PatchMesh, Simulation, SimulationRequest, State
from .drawings import Drawing, DrawingRequest, DrawnPolygon
from .targets import CurveNote, MeasuredCurve, MeasuredCurveRequest, Target
from .parts import Part, PartFileRequest, PartOptions, PartRegion, PartRequest
from .part_simulations import (
    Clamp,
    DeformedPart,
    PartialPartState,
    PartMesh,
    PartMeshError,
    PartSimulation,
    PartSimulationFileRequest,
    PartSimulationRequest,
    PartState,
    Plate,
    PlatePressure,
    SupportState,
)
from .tilings import CellMesh, Family, Structure, StructureFileRequest, StructureRequest, Tile
from .trainings import PartialTraining, Training, TrainingPlan, TrainingPlanRequest, TrainingRequest
from .voronoi import (
    RandomSites,
    Sites,
    VoronoiFileRequest,
    VoronoiOptimizationRequest,
    VoronoiOptions,
    VoronoiRequest,
)
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
    WeaveDiscretizationError,
    WeaveHomogenization,
    WeaveLayout,
    WeaveSimulation,
)
from .weave_print_answers import FoundChannel, GcodeReport, PrintMove, PrintStatistics, Violation, WeaveToolpath
from .weave_printing import GcodeReportRequest, Grip, PrintOptions, WeaveToolpathRequest
from .weaves import (
    Force,
    Place,
    Strand,
    Support,
    Weave,
    WeaveDeformationRequest,
    WeaveHomogenizationRequest,
    WeaveLayoutRequest,
    WeaveOptions,
    WeavePictureRequest,
    WeaveSimulationRequest,
)

__version__ = "0.1.0"

__all__ = [
    "AccessDenied", "AddedFamily", "AdjacentFaces", "AtlasComparison", "AtlasMeshError", "AtlasNearest", "AtlasProfile", "AtlasSample",
    "BeamWidthSensitivity", "Biaxial", "CellMesh", "Clamp", "Client", "ConnectionFailed", "Cost", "Crossing",
    "CrossingMember", "CurveNote", "DeadlineExceeded", "DeformedCell", "DeformedPart", "DeformedPatch", "Design", "DesignCandidate",
    "DesignError", "DesignOptions", "DesignProfile", "DesignRequest", "DesignResult", "DiscretizationError", "Drawing",
    "DrawingRequest", "DrawnPolygon", "Effect", "ErrorStatistics", "Evaluation", "EvaluationRequest", "ExponentialMap",
    "ExponentialMapRequest", "Family", "FamilyAtlas", "FamilyAtlasRequest", "FamilyCheck", "FamilyCheckRequest", "FamilyFinding", "FamilyTiling", "Fault", "Field", "FieldRequest", "FitRange", "FollowedStop", "Force", "FoundChannel",
    "GcodeReport", "GcodeReportRequest", "Geodesic", "GeodesicsRequest", "Gradient", "GreenStrain", "Grip", "HeldPlace",
    "Hessian", "Host", "HostState", "InvalidDesign", "InvalidHost", "InvalidMesh", "InvalidNetwork", "InvalidPoint",
    "InvalidRequest", "InvalidStructure", "InvalidVoronoi", "InvalidWeave", "Job", "JobCancelled", "JobStatus",
    "KarcherMean", "KarcherMeanRequest", "KarcherStep", "KeyReadableByOthers", "LaidStrand", "LikelyDegrees", "Limits",
    "Load", "MadeOf", "Material", "MaterialBound", "MeasuredCurve", "MeasuredCurveRequest", "Membrane", "Mesh", "MeshInfo", "MeshRepair",
    "Model", "ModelInfo", "Moving", "NetworkFileRequest", "NotFound", "OptimizationStep", "OptimizedVoronoi", "Part",
    "PartFileRequest", "PartMesh", "PartMeshError", "PartOptions", "PartRegion", "PartRequest", "PartSimulation", "PartSimulationFileRequest",
    "PartSimulationRequest", "PartState", "PartialDesign", "PartialOptimization", "PartialPartState",
    "PartialRelaxation", "PartialRound", "PartialTraining", "PatchMesh", "Path", "Place", "PlacedPoint", "Plate", "PlatePressure", "PointLike", "PointsInFaces",
    "PoissonDisk", "Polish", "PolishRound", "PossibleProfile", "PrintMove", "PrintOptions", "PrintStatistics", "ProblemError", "ProfileCurve",
    "ProfileRequest", "Progress", "RandomSites", "Region", "RegionDesigns", "RegionsRequest", "RelaxationOptions",
    "RelaxationRequest", "RelaxationStep", "RelaxedNetwork", "Request", "RequestTimeout", "ServerBusy", "ServerError",
    "SheetState", "Shell", "Simulation", "SimulationRequest", "SiteMoves", "Sites", "Solid", "SolidRegion", "SpacePoint",
    "SplitErrors", "Spread", "Spring", "State", "Strand", "Structure", "StructureFileRequest", "StructureRequest",
    "StructureSize", "Superseded", "SuppleError", "Support", "SupportState", "SurfacePoint", "Target", "Tile", "Training", "TrainingPlan", "TrainingPlanRequest", "TrainingRequest", "Uniaxial", "UniaxialCurve",
    "UniaxialRequest", "Verdict", "Verification", "Vertex", "Violation", "VoronoiCell", "VoronoiDiagram", "VoronoiDual", "VoronoiEdge",
    "VoronoiFileRequest", "VoronoiOptimizationRequest", "VoronoiOptions", "VoronoiPiece", "VoronoiPieces", "VoronoiRequest",
    "VoronoiStatistics", "VoronoiVertex", "WayOut", "Weave", "WeaveDeformation", "WeaveDeformationRequest", "WeaveDiscretizationError",
    "WeaveHomogenization", "WeaveHomogenizationRequest", "WeaveLayout", "WeaveLayoutRequest", "WeaveOptions", "WeavePictureRequest",
    "WeaveSimulation", "WeaveSimulationRequest", "WeaveToolpath", "WeaveToolpathRequest", "parts",
]
