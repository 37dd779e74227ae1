"""Inverse design: problems and their requests."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Optional, Sequence, Tuple, Union

import numpy as np

from . import checks
from ._arrays import Numbers
from .design_answers import DesignResult, ProfileCurve, RegionDesigns
from .request import Deadline, Reported, Request, Timeout
from .targets import Target
from .units import ANGLE, DENSITY, DURATION, LENGTH, RATIO, STRAIN_OR_ANGLE, STRESS, Number, Pair
from .wire import ACCURACY, EFFECT, At, Sent, Shape


def _modulus(modulus: Any, name: str) -> Any:
    values = np.asarray(modulus, dtype=np.float64)
    if values.shape not in ((), (2,)):
        raise ValueError(f"{name} has the shape {values.shape}; expected a number or a pair (least, most)")
    return values.tolist()


@dataclass(frozen=True)
class Material(Sent):
    """The material of a structure. None stands for that of the model's data.

    Attributes:
        youngs_modulus: E in MPa, or with a unit as in "1.2 GPa", to which stresses and stiffnesses are proportional. With a pair
            (least, greatest) the search finds the best modulus for the targets. Each of several materials needs one.
        density: in g/cm^3. 1.2 by default.
        name: a name that the answer repeats.
        poisson_ratio, law: only those of the model's data are permitted (`InvalidDesign`).
    """

    youngs_modulus: Annotated[Union[Number, Pair, None], At(write=_modulus), STRESS] = None
    density: Annotated[Optional[Number], DENSITY] = None
    name: Optional[str] = None
    poisson_ratio: Optional[float] = None
    law: Optional[str] = None


@dataclass(frozen=True)
class Limits(Sent):
    """Limits of a structure's size and density: pairs (least, greatest), or None for no limit.

    Attributes:
        relative_density: solid area / area of the cell, dimensionless.
        cell_size: square root of a cell's area, mm, for beams of a given width.
        beam_width: width of the beams, mm, for cells of a given size; beams are the walls of a part.
    """

    relative_density: Annotated[Optional[Pair], At(write=checks.pair), RATIO] = None
    cell_size: Annotated[Optional[Pair], At(write=checks.pair), LENGTH] = None
    beam_width: Annotated[Optional[Pair], At(write=checks.pair), LENGTH] = None


def _orientation(orientation: Any, name: str) -> Union[float, Sequence[float]]:
    return checks.pair(orientation, name) if np.ndim(orientation) > 0 else checks.radians(orientation, name)


@dataclass(frozen=True)
class Region(Sent):
    """The design problem of one region of a product; the fields are those of `DesignRequest`."""

    target: Annotated[Target, At("")]
    name: Optional[str] = None
    family: Optional[str] = None
    model: Optional[str] = None
    also: Sequence[Target] = ()
    initial: Optional[Numbers] = None
    fixed: Optional[Sequence[Optional[float]]] = None
    orientation: Annotated[Union[Number, Pair, None], At(write=_orientation), ANGLE] = None
    initial_orientation: Annotated[Optional[Number], At(write=checks.radians), ANGLE] = None
    material: Union[Material, Sequence[Material], None] = None
    beam_width: Annotated[Optional[Number], LENGTH] = None
    cell_size: Annotated[Optional[Number], LENGTH] = None
    limits: Optional[Limits] = None


@dataclass(frozen=True)
class DesignOptions(Sent):
    """How designs are searched for. None stands for the server's default.

    Attributes:
        tolerance: the search ends once a step's predicted reduction of the relative deviation is at most this. 1e-6.
        equilibrium_tolerance: relative residual of an equilibrium. 1e-10.
        max_iterations: iterations from one starting point. 200.
        starts: largest number of starting points. 24, or 4 for each family if all are searched.
        candidates: number of designs, spread over the bounds, from which starting points are chosen.
        verified_samples: largest number of samples of each target that verification simulates. 12.
        polish_tolerance: polishing ends once the simulated relative deviation is at most this. 0.002.
        polish_rounds: largest number of structures that polishing simulates besides the first. 30.
        polish_seconds: a round that would end later than this is not begun. 120.
        trust: whether designs for which the model can be trusted are preferred to others with almost the same deviation:
            "automatic", "on" or "off".
        multi_start: whether there are further starting points: "automatic", "on" or "off".
        envelope: whether least and greatest values over all evaluated designs are returned: "automatic", "on" or "off".
        polish: whether the design is corrected by simulations until they follow the targets: "on" (which verifies it too),
            "off", or "automatic", which polishes a design that is verified.
        ways_out: whether changes are looked for with which a missed target is reached (`Design.ways_out`): "automatic", which
            does so if the design deviates by more than 5 % and the request has no `session`, "on" or "off". It takes up to 10 s.
        beam_width_sensitivity: whether the answer says how much the profile changes with the beam width
            (`DesignProfile.beam_width_sensitivity`): "automatic", which does so for designs that are simulated, "on" or "off".
    """

    tolerance: Annotated[Optional[Number], ACCURACY, RATIO] = None
    equilibrium_tolerance: Annotated[Optional[float], ACCURACY] = None
    max_iterations: Annotated[Optional[int], ACCURACY] = None
    starts: Annotated[Optional[int], ACCURACY] = None
    candidates: Annotated[Optional[int], ACCURACY] = None
    verified_samples: Annotated[Optional[int], ACCURACY] = None
    multi_start: Annotated[Optional[str], EFFECT] = None
    envelope: Annotated[Optional[str], EFFECT] = None
    polish: Annotated[Optional[str], EFFECT] = None
    polish_tolerance: Annotated[Optional[Number], ACCURACY, RATIO] = None
    polish_rounds: Annotated[Optional[int], ACCURACY] = None
    polish_seconds: Annotated[Optional[Number], ACCURACY, DURATION] = None
    trust: Annotated[Optional[str], EFFECT] = None
    ways_out: Annotated[Optional[str], EFFECT] = None
    beam_width_sensitivity: Annotated[Optional[str], EFFECT] = None


@dataclass(frozen=True)
class DesignRequest(Region, Request[DesignResult], path="/v1/designs"):
    """Tiling parameters whose response follows a target profile.

    Attributes:
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

    The `status().partial` of its job is the best design so far.

    A target that no design reaches raises no exception: see `Design.reached` and `Design.message`. Raises `InvalidDesign`.
    """

    verify: bool = False
    options: Annotated[Optional[DesignOptions], At("")] = None
    session: Optional[str] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class RegionsRequest(Request[RegionDesigns], path="/v1/designs"):
    """A design for each region of a product, for example forefoot, midfoot and heel of a sole; see `DesignRequest`."""

    regions: Sequence[Region]
    verify: bool = False
    options: Annotated[Optional[DesignOptions], At("")] = None
    session: Optional[str] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class ProfileRequest(Request[ProfileCurve], path="/v1/profiles"):
    """The profile of given parameters, by the neural model of their family.

    Attributes:
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

    task: str
    parameters: Numbers
    family: Optional[str] = None
    model: Optional[str] = None
    direction: Annotated[Optional[Number], At(write=checks.radians), ANGLE] = None
    strain: Annotated[Optional[Number], At(write=checks.number), RATIO] = None
    strain_measure: Optional[str] = None
    x: Annotated[Optional[Numbers], STRAIN_OR_ANGLE] = None
    limits: Annotated[Optional[Tuple[Number, Number]], Shape(2), At("/range"), STRAIN_OR_ANGLE] = None
    samples: Optional[int] = None
    equilibrium_tolerance: Annotated[Optional[float], ACCURACY] = None
    orientation: Annotated[Optional[Number], At(write=_orientation), ANGLE] = None
    material: Optional[Material] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.one_of(self.task, "task", checks.TASKS)
