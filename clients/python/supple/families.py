"""Definitions of families of tilings: what a family's file holds, checked and drawn. Lengths are in tiling units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Mapping, Optional, Tuple

from ._arrays import Array, Numbers
from .answers import Cost
from .request import Deadline, Reported, Request, Timeout
from .shown import Shown
from .tilings import Family
from .wire import At


@dataclass(frozen=True, repr=False)
class FamilyFinding(Shown):
    """Something that a check of a definition found.

    Attributes:
        flaw: "field", "unused", "too_large", "gap", "overlap", "unmatched", "crossing" or "sliver".
        pointer: JSON pointer to what is meant, such as "/definition/tile/edges/2".
        message: what was found, without its subject.
        parameters: at which it was found, shape (n,); empty if it does not depend on them.
        point: where it is in the plane at these parameters, shape (2,); None if it has no place.
    """

    flaw: str
    message: str
    pointer: str
    parameters: Array
    point: Optional[Array]


@dataclass(frozen=True, repr=False)
class FamilyTiling(Shown):
    """One cell of a tiling: the outlines of its tiles counterclockwise, each of shape (n, 2), and the two translations as rows."""

    parameters: Array
    beam_width: float
    lattice: Array
    tiles: Tuple[Array, ...]


@dataclass(frozen=True, repr=False)
class FamilyCheck(Shown):
    """Whether a definition is one of a family: `good` without faults. Warnings are of places within the bounds that are to be avoided.

    `tiling` is None if fields at fault leave nothing to draw.
    """

    good: bool
    faults: Tuple[FamilyFinding, ...]
    warnings: Tuple[FamilyFinding, ...]
    tiling: Optional[FamilyTiling]
    cost: Cost


@dataclass(frozen=True, repr=False)
class AddedFamily(Shown):
    """A family that was added. Warnings are of places within its bounds that are to be avoided."""

    family: Family
    warnings: Tuple[FamilyFinding, ...]


@dataclass(frozen=True)
class FamilyCheckRequest(Request[FamilyCheck], path="/v1/family-checks"):
    """Checks the definition of a family of tilings, and draws it.

    Attributes:
        definition: as in `Family.definition` (schema `FamilyDefinition` of the contract). With "isohedral_type" in place of
            "tile" it takes the tile of one of the 81 types.
        parameters: within the definition's bounds; None takes its defaults.
    """

    definition: Mapping[str, Any]
    parameters: Optional[Numbers] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True, repr=False)
class AtlasSample(Shown):
    """One point of a family's bounds.

    Attributes:
        parameters: shape (n,), dimensionless.
        place: "good", "sliver", "crossing", "closed" or "unsolved".
        relative_density: fraction of the cell that is solid; 0 if there is no structure.
        compliance: at rest, strain (xx, yy, 2 xy) = compliance @ stress (xx, yy, xy), shape (3, 3), 1/MPa; None if it was not solved.
        stiffness: lowest and highest over all directions, shape (2,), MPa; None if it was not solved. So is `poisson_ratio`, dimensionless.
        error: relative difference of the stiffness from that on a finer mesh; None if it was solved once.
    """

    parameters: Array
    place: str
    relative_density: float
    compliance: Optional[Array]
    stiffness: Optional[Array]
    poisson_ratio: Optional[Array]
    error: Optional[float]


@dataclass(frozen=True, repr=False)
class AtlasNearest(Shown):
    """How near other families come to a reference profile: the nearest family, as in `AtlasProfile`."""

    family: str
    deviation: float
    met: bool


@dataclass(frozen=True, repr=False)
class AtlasProfile(Shown):
    """How near a family comes to a reference profile.

    Attributes:
        name: such as "poisson_-0.5" or "stiffness_elliptic_5".
        deviation: root mean square over directions, relative to the profile.
        met: whether it is at most 0.02, or that of Poisson's ratio at most 0.02 in itself.
        sample: index of the nearest sample; `orientation` is the angle by which it is turned counterclockwise, rad.
        others: the nearest of all other families; None if there is no atlas of others.
    """

    name: str
    deviation: float
    met: bool
    sample: int
    orientation: float
    others: Optional[AtlasNearest]


@dataclass(frozen=True, repr=False)
class AtlasMeshError(Shown):
    """Relative error of the stiffness at the samples that were solved on two meshes."""

    samples: int
    median: float
    largest: float


@dataclass(frozen=True, repr=False)
class AtlasComparison(Shown):
    """What a family adds to others: distances of its stiffnesses at rest from the nearest ones of all `families`, apart from size and
    orientation. 0.1 is a tenth of the tensor.

    `new_fraction` is the fraction of its samples that are farther than 0.1. `same_as` is a family that has all samples of this one.
    """

    families: Tuple[str, ...]
    median_distance: float
    largest_distance: float
    farthest_sample: int
    new_fraction: float
    same_as: Optional[str]


@dataclass(frozen=True, repr=False)
class FamilyAtlas(Shown):
    """What a family of tilings can do at rest.

    Attributes:
        family: its id.
        lower, upper, default: bounds and default of each parameter, shape (n,), dimensionless.
        definition: the definition that the atlas is of; None for "square".
        mesh_size, crossings: as in the request.
        kept: whether it was computed before this request.
        places: number of samples at each kind of place; `good_fraction` is the fraction that is good.
        mesh_error: None if no sample was solved twice.
        profiles: one for each reference profile.
        comparison: with the other families of the server; None if none of them has an atlas.
        warnings: where in the bounds tiles begin to cross themselves, and slivers.
        samples: the first is at the default parameters.
        stopped: why there are fewer samples than asked for: "none", "deadline" or "memory".
    """

    family: str
    lower: Annotated[Array, At("/parameters/lower")]
    upper: Annotated[Array, At("/parameters/upper")]
    default: Annotated[Array, At("/parameters/default")]
    definition: Optional[Dict[str, Any]]
    mesh_size: float
    crossings: bool
    kept: bool
    places: Dict[str, int]
    good_fraction: float
    mesh_error: Optional[AtlasMeshError]
    profiles: Tuple[AtlasProfile, ...]
    comparison: Optional[AtlasComparison]
    warnings: Tuple[FamilyFinding, ...]
    samples: Tuple[AtlasSample, ...]
    stopped: str
    cost: Cost


@dataclass(frozen=True)
class FamilyAtlasRequest(Request[FamilyAtlas], path="/v1/family-atlases"):
    """The atlas of a family: what it can do at rest, and what it adds to the other families. One that the server has comes at once.

    Attributes:
        family: id of a family of the server or of one's own. Or give one of the two following in its place.
        isohedral_type: number of one of the 81 types.
        definition: as in `Family.definition`.
        samples: points of the bounds, 1 to 4096; None takes 256, which need up to a minute.
        mesh_size: side length of triangles in beam widths, 0.1 to 2; None takes 1.
        error_samples: samples at which the error of the mesh is measured; None takes 8.
        crossings: whether tilings that cross themselves are solved; None solves those of families of the server.
        recompute: whether it is computed even if the server has it.
    """

    family: Optional[str] = None
    isohedral_type: Optional[int] = None
    definition: Optional[Mapping[str, Any]] = None
    samples: Optional[int] = None
    mesh_size: Optional[float] = None
    error_samples: Optional[int] = None
    crossings: Optional[bool] = None
    recompute: Optional[bool] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None
