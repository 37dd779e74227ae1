"""Answers about designs and profiles as dataclasses and numpy arrays.

A profile is stress over strain in one direction, or stiffness or Poisson's ratio over directions, under a uniaxial load
whose lateral strain and shear are free. Stresses and stiffnesses are in MPa, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any, Dict, List, Optional, Tuple

import numpy as np

from ._arrays import Array, Flags
from .answers import Cost, Effect
from .drawing import GREY, ORANGE, RED, Band, Drawing, Line, curve, error_band
from .shown import Drawn, Shown, short_text
from .wire import ACCURACY, At

Name = Annotated[str, At("/name", missing="")]
DRAWN_BOUND = 0.01
"""Deviation from the target above which the nearest profile that a material can have is drawn."""


def profile_drawing(task: str, over_strains: bool, lines: Tuple[Line, ...], bands: Tuple[Band, ...] = ()) -> Drawing:
    """Curves of a profile with the axes for its task. Poisson's ratios, which may be negative, have straight axes in degrees."""
    if over_strains:
        return Drawing("curves", lines, (), "", "strain along the load", "stress / MPa", bands)
    if task == "stiffness":
        return Drawing("polar", lines, title="stiffness / MPa over the direction of the load", bands=bands)
    in_degrees = tuple(replace(line, points=line.points * [180 / np.pi, 1]) for line in lines)
    bands_in_degrees = tuple(replace(band, x=np.degrees(band.x)) for band in bands)
    return Drawing("curves", in_degrees, (), "", "direction of the load / degrees", "Poisson's ratio", bands_in_degrees)


def percent(deviation: Optional[float]) -> str:
    """A simulated deviation in words."""
    return "not simulated" if deviation is None else f"{100 * deviation:.3g} %"


@dataclass(frozen=True, repr=False)
class DesignError(Shown):
    """The deviations of profiles from their targets.

    Attributes:
        relative_rms: weighted root mean square of the deviations beyond the bands over that of the target, for all targets.
        max: largest deviation of the main target beyond its band, in its unit.
    """

    relative_rms: float
    max: float


@dataclass(frozen=True, repr=False)
class Verification(Shown):
    """A profile that was simulated at native scale.

    Attributes:
        x: strains or angles, shape (m,).
        target: values of the target, shape (m,).
        y: simulated values, shape (m,); nan where the simulation did not reach x.
        model: values of the neural model, shape (m,); nan where there is no simulated value.
        relative_rms: root mean square of the difference of model and simulation over that of the simulation; None if nothing
            was simulated.
        target_error: deviation of the simulation from the target, as `DesignError.relative_rms`; None if a sample is missing.
        discretization_error: estimated error due to the mesh, root mean square over that of the simulation; None if a sample
            is missing or the deadline passed.
    """

    x: Array
    target: Array
    y: Array
    model: Array
    relative_rms: Optional[float]
    target_error: Optional[float]
    discretization_error: Optional[float]


@dataclass(frozen=True, repr=False)
class Verdict(Shown):
    """How well a design meets its targets: by the simulation where it was verified, otherwise by the model.

    Attributes:
        grade: "reached" (at most 5 % off), "close" (at most 15 %), "missed" or "unknown": the model decides and is not trusted at
            half of the samples or more, a value is missing, or there is no such structure.
        source: "simulation" or "model".
        deviation: relative root mean square deviation of the worst target; None if a value is missing.
        sentence: the verdict in words, with the parts of the target that are reached.
        bound: what no material can have at rest of the targets that are missed, in words, such as "No material at rest comes
            nearer than 7 % to it."; empty if some material reaches them, or the design comes nearer.
    """

    grade: str
    source: str
    deviation: Optional[float]
    sentence: str
    bound: Annotated[str, At(missing="")]


@dataclass(frozen=True, repr=False)
class FitRange(Shown):
    """A part of a target that is met equally well.

    Attributes:
        from_, to: strains or angles at which it begins and ends.
        reached: whether each of its samples is within the band, or exceeds it by at most 1 % of the target's root mean square,
            for Poisson's ratios by at most 0.02 if that is more.
        deviation: its root mean square over that of the whole target; None if the simulation misses a sample of it.
    """

    from_: Annotated[float, At("/from")]
    to: float
    reached: bool
    deviation: Optional[float]


@dataclass(frozen=True, repr=False)
class PolishRound(Shown):
    """One structure that was simulated.

    Attributes:
        proposal: the method that proposed it: "search", "step", "probe", "new_search" or "survey".
        parameters: parameters of the structure, shape (p,).
        target_error: deviation of the simulation, as `DesignError.relative_rms`; None if the simulation failed.
        accepted: whether it was the best so far.
        reason: why it was not accepted; empty if it was.
        seconds: duration of the round.
        orientation: angle by which its tiling is rotated, radians.
    """

    proposal: str
    parameters: Array
    target_error: Optional[float]
    accepted: bool
    reason: str
    seconds: float
    orientation: float


@dataclass(frozen=True, repr=False)
class Polish(Shown):
    """The correction of a design by simulations.

    Attributes:
        target_error: deviation of the simulation for all targets, as `DesignError.relative_rms`; None if a sample is missing.
        stopped: "reached", "no_improvement", "round_limit", "time_limit", "deadline", "memory" or "not_simulated".
        rounds: the structures that were simulated; the first is the design that the search found.
    """

    target_error: Optional[float]
    stopped: str
    rounds: Tuple[PolishRound, ...]

    def _shown(self) -> List[Tuple[str, str]]:
        rounds = [(f"round {number}", f"{percent(one.target_error)} after {one.seconds:.3g} s, {one.proposal}, "
                                      f"{'kept' if one.accepted else 'not kept: ' + one.reason}")
                  for number, one in enumerate(self.rounds)]
        return [("deviation", f"{percent(self.target_error)} by the simulation"), ("stopped", short_text(self.stopped)), *rounds]


@dataclass(frozen=True, repr=False)
class PossibleProfile(Shown):
    """A profile that a material has at rest.

    Attributes:
        deviation: its deviation from the target, as `DesignError.relative_rms`.
        y: its values, shape (n,), MPa or dimensionless.
    """

    deviation: float
    y: Array


@dataclass(frozen=True, repr=False)
class MaterialBound(PossibleProfile):
    """The nearest that any material comes to a target at rest, whatever its structure; strain loosens it.

    Stiffness and Poisson's ratio over direction follow from one symmetric and positive definite compliance.

    Attributes:
        deviation: least deviation from this target alone, as `DesignError.relative_rms`.
        y: values of the material that is nearest to it, shape (n,), MPa or dimensionless.
        together: the same for the one material that is nearest to all targets of the design that have a bound; None if there is
            no other.
    """

    together: Optional[PossibleProfile]


@dataclass(frozen=True, repr=False)
class BeamWidthSensitivity(Shown):
    """Relative changes of a profile at rest if all beams are 5 % wider or narrower; for stress over strain of the initial modulus.

    Attributes:
        wider, narrower: root mean square of the change over that of the profile; None if there is no such structure.
    """

    wider: Optional[float]
    narrower: Optional[float]


@dataclass(frozen=True, repr=False)
class DesignProfile(Drawn):
    """A target and the profiles of designs, at n samples.

    Attributes:
        task: "stress_strain", "stiffness" or "poisson".
        direction: direction of the load; None if the profile is over directions.
        strain: strain along the load; None if the profile is over strains.
        strain_measure: "green" or "engineering".
        x: strains or angles, shape (n,).
        target: values of the target, shape (n,), MPa or dimensionless like the following values.
        initial: values of the first starting point, shape (n,); nan where it has no equilibrium.
        achieved: values of the design that was found, shape (n,).
        error_bar: bound of the difference between `achieved` and the simulated value in 90 of 100 cases, shape (n,); nan
            outside of what the model was trained on; None if the model has no error bars.
        in_range: whether each sample of `achieved` can be trusted: it is within what the model was trained on, and its error
            bar is at most 5 % of a stress, 10 % of a stiffness, 0.1 for a Poisson's ratio, shape (n,).
        reached: whether `achieved` is within the band of each sample, or exceeds it by at most 1 % of the target's root mean
            square, for Poisson's ratios by at most 0.02 if that is more.
        ranges: the parts of the target, from its first sample to its last one or over half a turn of directions: which are
            reached, by the simulation if there is one.
        lower, upper: least and greatest values over all designs that the search evaluated, shape (n,); None if there are none.
        verified: None if no simulation was requested.
        bound: the nearest that any material comes to the target at rest; None for stresses, and for strains beyond 0.05.
        beam_width_sensitivity: how much the profile changes with the beam width; None if that was not computed.
    """

    task: str
    direction: Optional[float]
    strain: Optional[float]
    strain_measure: str
    x: Array
    target: Array
    initial: Array
    achieved: Array
    error_bar: Optional[Array]
    in_range: Flags
    reached: Flags
    ranges: Tuple[FitRange, ...]
    lower: Annotated[Optional[Array], At("/envelope/lower")]
    upper: Annotated[Optional[Array], At("/envelope/upper")]
    verified: Optional[Verification]
    bound: Annotated[Optional[MaterialBound], At(missing=None)]
    beam_width_sensitivity: Annotated[Optional[BeamWidthSensitivity], At(missing=None)]

    def _drawing(self) -> Drawing:
        lines = [curve(self.x, self.target, color=ORANGE, label="target", width=4)]
        lines.append(curve(self.x, self.achieved, label="achieved"))
        over_strains = self.direction is not None
        if self.verified is not None:
            marks = over_strains
            lines.append(curve(self.verified.x, self.verified.y, color=RED, label="simulated", marks=marks, dashed=not marks))
        nearest = None if self.bound is None else self.bound.together or self.bound
        if nearest is not None and nearest.deviation > DRAWN_BOUND:
            lines.append(curve(self.x, nearest.y, color=GREY, label="nearest that any material can have at rest", dashed=True))
        return profile_drawing(self.task, over_strains, tuple(lines), error_band(self.x, self.achieved, self.error_bar))


@dataclass(frozen=True, repr=False)
class DesignCandidate(Shown):
    """The best design of one family.

    Attributes:
        error: its deviation from the targets.
        model_error: mean relative error of the model's stress on designs that it was not trained on; None if unknown.
        simulated_error: as `error.relative_rms`, but of the simulated structure; None if it was not simulated.
        orientation: angle by which the tiling is rotated, radians.
        material: its material, with the modulus that was found for this family if the request leaves a choice.
    """

    family: str
    model: str
    parameters: Array
    error: DesignError
    model_error: Optional[float]
    simulated_error: Optional[float]
    stopped: str
    orientation: float
    material: MadeOf

    def _deviation_text(self) -> str:
        if self.simulated_error is not None:
            return f"{percent(self.simulated_error)} simulated"
        return f"{percent(self.error.relative_rms)} by the model"

    def _shown(self) -> List[Tuple[str, str]]:
        first = [("family", short_text(self.family)), ("deviation", self._deviation_text()), ("parameters", short_text(self.parameters))]
        return first + [entry for entry in super()._shown() if entry[0] not in dict(first)]


@dataclass(frozen=True, repr=False)
class MadeOf(Shown):
    """The material of a design or profile.

    Attributes:
        name: empty if the request gives none.
        youngs_modulus: in MPa; the one that was found, if the request leaves a choice.
        law, poisson_ratio: those of the model's data.
        density: in g/cm^3.
    """

    name: Name
    youngs_modulus: float
    law: str
    poisson_ratio: float
    density: float


@dataclass(frozen=True, repr=False)
class WayOut(Shown):
    """A change of the request with which a missed target is reached, or nearly; everything else remains as requested.

    Attributes:
        change: "turn" (another orientation), "modulus" (another material), "turn_and_modulus", "shorten" (only a part of the
            range of strains) or "family".
        sentence: the change in words, with the deviation after and before it.
        family, model, parameters: the design that is then found.
        orientation: angle by which the tiling is rotated counterclockwise, radians.
        youngs_modulus: of the material, in MPa.
        range: least and greatest strain of the shortened target, shape (2,); None if the target remains.
        deviation: relative root mean square deviation by the model, which is not verified.
    """

    change: str
    sentence: str
    family: str
    model: str
    parameters: Array
    orientation: float
    youngs_modulus: float
    range: Optional[Array]
    deviation: float


@dataclass(frozen=True, repr=False)
class StructureSize(Shown):
    """The size and density of a design's structure; None where there is no such structure (the design's `message` says why).

    Attributes:
        beam_width: in mm.
        cell_size: square root of the area of a cell, in mm.
        relative_density: solid area / area of the cell.
        density: mass / volume of the structure, holes included, in g/cm^3.
    """

    beam_width: float
    cell_size: Optional[float]
    relative_density: Optional[float]
    density: Optional[float]


def _deviation_text(verdict: Verdict) -> str:
    if verdict.deviation is None:
        return "unknown"
    return f"{100 * verdict.deviation:.3g} % {'simulated' if verdict.source == 'simulation' else 'by the model'}"


def _files(structure: Any) -> Dict[str, str]:
    return {kind: structure[kind] for kind in ("svg", "dxf", "stl")}


@dataclass(frozen=True, repr=False)
class Design(Drawn):
    """A design that was found.

    Attributes:
        name: name of its region; may be empty.
        family, parameters: the structure; `Client.structure_file` writes it.
        model, sha256: the neural model of the search, and the checksum of its file.
        orientation: angle by which the tiling is rotated counterclockwise, radians; directions do not rotate with it.
        material: its material; `size` has the size and density of its structure.
        verdict: how well it meets its targets, with a sentence.
        profile: the main target and the profiles for it.
        also: the same for the further targets, in their order.
        error: its deviation from all targets.
        reached: whether all samples of all targets are reached: by the simulation if it has values at all of them, otherwise
            by the model. A target out of reach raises no exception.
        iterations, starts: iterations and starting points of the search in this family.
        stopped: "converged", "reached", "iteration_limit", "step_too_small", "no_free_parameters", "trusted", or
            "deadline" or "memory" if time or memory ran out, and the design is the best until then.
        message: facts that deserve attention; may be empty.
        polish: its correction by simulations; None if it was not simulated.
        ranking: the best design of each family that was searched, the best one first. They are compared by the simulated
            deviation, or without a simulation by the root of the summed squares of its deviation and its model's error.
        structure: paths of the structure's files on the server, by "svg", "dxf" and "stl".
        ways_out: what would help if the target is missed, the best one first; empty if nothing helps or nothing was sought.
    """

    name: Name
    family: str
    model: str
    sha256: str
    parameters: Array
    verdict: Verdict
    profile: DesignProfile
    also: Tuple[DesignProfile, ...]
    error: DesignError
    reached: bool
    iterations: int
    starts: int
    stopped: str
    message: str
    polish: Optional[Polish]
    ranking: Tuple[DesignCandidate, ...]
    structure: Annotated[Dict[str, str], At(read=_files)]
    orientation: float
    material: MadeOf
    size: Annotated[StructureSize, At("/structure")]
    ways_out: Annotated[Tuple[WayOut, ...], At(missing=())]

    def _shown(self) -> List[Tuple[str, str]]:
        ranking = "; ".join(f"{one.family}: {one._deviation_text()}" for one in self.ranking)
        first = [("deviation", _deviation_text(self.verdict)), ("parameters", short_text(self.parameters)),
                 ("family", short_text(self.family)), ("verdict", short_text(self.verdict.grade)), ("ranking", ranking)]
        if self.verdict.bound:
            first.append(("bound", self.verdict.bound))
        return first + [entry for entry in super()._shown() if entry[0] not in dict(first)]

    def _drawing(self) -> Drawing:
        title = f"{self.family} {short_text(self.parameters)}: {_deviation_text(self.verdict)}"
        return replace(self.profile._drawing(), title=title)


@dataclass(frozen=True, repr=False)
class DesignResult(Design):
    """A design, with the accuracy and the cost of the computation.

    Attributes:
        tolerance, equilibrium_tolerance: as requested.
        residual: largest residual of the design's equilibria.
        effects: "trust", "multi_start", "envelope", "modulus", "orientation", "limits", "verification",
            "polish", "beam_width_sensitivity" and "ways_out".
    """

    tolerance: Annotated[float, ACCURACY]
    equilibrium_tolerance: Annotated[float, ACCURACY]
    residual: Annotated[float, ACCURACY]
    effects: Tuple[Effect, ...]
    cost: Cost


@dataclass(frozen=True, repr=False)
class RegionDesigns(Shown):
    """The designs of several regions, in their order, with accuracy and cost; the fields are those of `DesignResult`."""

    regions: Tuple[Design, ...]
    tolerance: Annotated[float, ACCURACY]
    equilibrium_tolerance: Annotated[float, ACCURACY]
    residual: Annotated[float, ACCURACY]
    effects: Tuple[Effect, ...]
    cost: Cost


@dataclass(frozen=True, repr=False)
class PartialDesign(Shown):
    """The best design so far of a running job.

    Attributes:
        name: name of its region; may be empty.
        x, achieved: samples of the main target and the design's profile at them, shape (n,).
        iteration: iterations so far.
        orientation: angle by which the tiling is rotated, radians.
    """

    name: Name
    family: str
    model: str
    parameters: Array
    x: Array
    achieved: Array
    error: DesignError
    iteration: int
    orientation: float


@dataclass(frozen=True, repr=False)
class PartialRound(Shown):
    """The structure that a running job simulated last; `family` and `model` are those of its design.

    Attributes:
        name: name of its region; may be empty.
    """

    name: Name
    family: str
    model: str
    round: PolishRound


@dataclass(frozen=True, repr=False)
class ProfileCurve(Drawn):
    """The profile of given parameters.

    Attributes:
        task, direction, strain, strain_measure: as in `DesignProfile`.
        x: strains or angles, shape (n,).
        y: shape (n,), MPa or dimensionless; nan where no equilibrium was found.
        error_bar, in_range: as in `DesignProfile`, for y.
        orientation: angle by which the tiling is rotated counterclockwise, radians.
        material: the material of the structure.
        equilibrium_tolerance: as requested; `residual` is the largest residual of the equilibria.
        sha256: checksum of the model's file.
    """

    family: str
    model: str
    sha256: str
    parameters: Array
    task: str
    direction: Optional[float]
    strain: Optional[float]
    strain_measure: str
    x: Array
    y: Array
    error_bar: Optional[Array]
    in_range: Flags
    orientation: float
    material: MadeOf
    equilibrium_tolerance: Annotated[float, ACCURACY]
    residual: Annotated[float, ACCURACY]
    effects: Tuple[Effect, ...]
    cost: Cost

    def _drawing(self) -> Drawing:
        title = f"{self.family} {short_text(self.parameters)}"
        line = curve(self.x, self.y, label="neural model")
        band = error_band(self.x, self.y, self.error_bar)
        return replace(profile_drawing(self.task, self.direction is not None, (line,), band), title=title)
