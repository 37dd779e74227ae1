"""Answers about designs and profiles as dataclasses and numpy arrays.

A profile is stress over strain in one direction, or stiffness or Poisson's ratio over directions, under a uniaxial load
whose lateral strain and shear are free. Stresses and stiffnesses are in MPa, angles in radians.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Dict, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import NDArray

from .answers import Array, Cost, Effect, cost_from_wire, effects_from_wire
from .drawing import ORANGE, RED, Drawing, Line, curve
from .shown import Drawn, Shown, short_text

Flags = NDArray[np.bool_]


def profile_drawing(task: str, over_strains: bool, lines: Tuple[Line, ...]) -> Drawing:
    """Curves of a profile with the axes for its task. Poisson's ratios, which may be negative, have straight axes in degrees."""
    if over_strains:
        return Drawing("curves", lines, (), "", "strain along the load", "stress / MPa")
    if task == "stiffness":
        return Drawing("polar", lines, title="stiffness / MPa over the direction of the load")
    in_degrees = tuple(replace(line, points=line.points * [180 / np.pi, 1]) for line in lines)
    return Drawing("curves", in_degrees, (), "", "direction of the load / degrees", "Poisson's ratio")


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
        stopped: "reached", "no_improvement", "round_limit", "time_limit", "deadline" or "not_simulated".
        rounds: the structures that were simulated; the first is the design that the search found.
    """

    target_error: Optional[float]
    stopped: str
    rounds: Tuple[PolishRound, ...]


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
            square.
        lower, upper: least and greatest values over all designs that the search evaluated, shape (n,); None if there are none.
        verified: None if no simulation was requested.
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
    lower: Optional[Array]
    upper: Optional[Array]
    verified: Optional[Verification]

    def _drawing(self) -> Drawing:
        lines = [curve(self.x, self.target, color=ORANGE, label="target", width=4)]
        lines.append(curve(self.x, self.achieved, label="achieved"))
        over_strains = self.direction is not None
        if self.verified is not None:
            marks = over_strains
            lines.append(curve(self.verified.x, self.verified.y, color=RED, label="simulated", marks=marks, dashed=not marks))
        return profile_drawing(self.task, over_strains, tuple(lines))


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


@dataclass(frozen=True, repr=False)
class MadeOf(Shown):
    """The material of a design or profile.

    Attributes:
        name: empty if the request gives none.
        youngs_modulus: in MPa; the one that was found, if the request leaves a choice.
        law, poisson_ratio: those of the model's data.
        density: in g/cm^3.
    """

    name: str
    youngs_modulus: float
    law: str
    poisson_ratio: float
    density: float


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


@dataclass(frozen=True, repr=False)
class Design(Drawn):
    """A design that was found.

    Attributes:
        name: name of its region; may be empty.
        family, parameters: the structure; `Client.structure_file` writes it.
        model, sha256: the neural model of the search, and the checksum of its file.
        orientation: angle by which the tiling is rotated counterclockwise, radians; directions do not rotate with it.
        material: its material; `size` has the size and density of its structure.
        profile: the main target and the profiles for it.
        also: the same for the further targets, in their order.
        error: its deviation from all targets.
        reached: whether all samples of all targets are reached: by the simulation if it has values at all of them, otherwise
            by the model. A target out of reach raises no exception.
        iterations, starts: iterations and starting points of the search in this family.
        stopped: "converged", "reached", "iteration_limit", "step_too_small", "no_free_parameters" or "trusted".
        message: facts that deserve attention; may be empty.
        polish: its correction by simulations; None if it was not simulated.
        ranking: the best design of each family that was searched, the best one first. They are compared by the simulated
            deviation, or without a simulation by the root of the summed squares of its deviation and its model's error.
        structure: paths of the structure's files on the server, by "svg", "dxf" and "stl".
    """

    name: str
    family: str
    model: str
    sha256: str
    parameters: Array
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
    structure: Dict[str, str]
    orientation: float
    material: MadeOf
    size: StructureSize

    def _drawing(self) -> Drawing:
        off = 100 * self.error.relative_rms
        title = f"{self.family} {short_text(self.parameters)}: {off:.2g} % from the target by the model"
        return replace(self.profile._drawing(), title=title)


@dataclass(frozen=True, repr=False)
class DesignResult(Design):
    """A design, with the accuracy and the cost of the computation.

    Attributes:
        tolerance, equilibrium_tolerance: as requested.
        residual: largest residual of the design's equilibria.
        effects: "trust", "multi_start", "envelope", "modulus", "orientation", "limits", "verification" and "polish".
    """

    tolerance: float
    equilibrium_tolerance: float
    residual: float
    effects: Tuple[Effect, ...]
    cost: Cost


@dataclass(frozen=True, repr=False)
class RegionDesigns(Shown):
    """The designs of several regions, in their order, with accuracy and cost; the fields are those of `DesignResult`."""

    regions: Tuple[Design, ...]
    tolerance: float
    equilibrium_tolerance: float
    residual: float
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

    name: str
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

    name: str
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
    equilibrium_tolerance: float
    residual: float
    effects: Tuple[Effect, ...]
    cost: Cost

    def _drawing(self) -> Drawing:
        title = f"{self.family} {short_text(self.parameters)}"
        line = curve(self.x, self.y, label="neural model")
        return replace(profile_drawing(self.task, self.direction is not None, (line,)), title=title)


def _array(values: Any) -> Array:
    """The values as an array, with nan for None."""
    return np.asarray([np.nan if value is None else value for value in values], dtype=np.float64)


def _flags(values: Any) -> Flags:
    return np.asarray(values, dtype=np.bool_)


def _optional(document: Mapping[str, Any], name: str) -> Optional[float]:
    return float(document[name]) if name in document else None


def _number_or_none(value: Any) -> Optional[float]:
    return None if value is None else float(value)


def _error(document: Mapping[str, Any]) -> DesignError:
    return DesignError(relative_rms=float(document["relative_rms"]), max=float(document["max"]))


def _verification(document: Optional[Mapping[str, Any]]) -> Optional[Verification]:
    if document is None:
        return None
    return Verification(
        x=_array(document["x"]),
        y=_array(document["y"]),
        target=_array(document["target"]),
        model=_array(document["model"]),
        relative_rms=_optional(document, "relative_rms"),
        target_error=_number_or_none(document["target_error"]),
        discretization_error=_number_or_none(document["discretization_error"]),
    )


def _round(document: Mapping[str, Any]) -> PolishRound:
    return PolishRound(
        proposal=str(document["proposal"]),
        parameters=_array(document["parameters"]),
        target_error=_number_or_none(document["target_error"]),
        accepted=bool(document["accepted"]),
        reason=str(document["reason"]),
        seconds=float(document["seconds"]),
        orientation=float(document["orientation"]),
    )


def _polish(document: Optional[Mapping[str, Any]]) -> Optional[Polish]:
    if document is None:
        return None
    return Polish(
        target_error=_number_or_none(document["target_error"]),
        stopped=str(document["stopped"]),
        rounds=tuple(_round(one) for one in document["rounds"]),
    )


def _bars(values: Optional[Sequence[Optional[float]]]) -> Optional[Array]:
    return None if values is None else _array(values)


def _profile(document: Mapping[str, Any]) -> DesignProfile:
    envelope = document["envelope"]
    return DesignProfile(
        task=str(document["task"]),
        direction=_optional(document, "direction"),
        strain=_optional(document, "strain"),
        strain_measure=str(document["strain_measure"]),
        x=_array(document["x"]),
        target=_array(document["target"]),
        initial=_array(document["initial"]),
        achieved=_array(document["achieved"]),
        error_bar=_bars(document["error_bar"]),
        in_range=_flags(document["in_range"]),
        reached=_flags(document["reached"]),
        lower=None if envelope is None else _array(envelope["lower"]),
        upper=None if envelope is None else _array(envelope["upper"]),
        verified=_verification(document["verified"]),
    )


def _made_of(document: Mapping[str, Any]) -> MadeOf:
    return MadeOf(
        name=str(document.get("name", "")),
        youngs_modulus=float(document["youngs_modulus"]),
        law=str(document["law"]),
        poisson_ratio=float(document["poisson_ratio"]),
        density=float(document["density"]),
    )


def _candidate(document: Mapping[str, Any]) -> DesignCandidate:
    return DesignCandidate(
        family=str(document["family"]),
        model=str(document["model"]),
        parameters=_array(document["parameters"]),
        error=_error(document["error"]),
        model_error=_number_or_none(document["model_error"]),
        simulated_error=_number_or_none(document["simulated_error"]),
        stopped=str(document["stopped"]),
        orientation=float(document["orientation"]),
        material=_made_of(document["material"]),
    )


def _design_fields(document: Mapping[str, Any]) -> Dict[str, Any]:
    return {
        "name": str(document.get("name", "")),
        "family": str(document["family"]),
        "model": str(document["model"]),
        "sha256": str(document["sha256"]),
        "parameters": _array(document["parameters"]),
        "profile": _profile(document["profile"]),
        "also": tuple(_profile(profile) for profile in document["also"]),
        "error": _error(document["error"]),
        "reached": bool(document["reached"]),
        "iterations": int(document["iterations"]),
        "starts": int(document["starts"]),
        "stopped": str(document["stopped"]),
        "message": str(document["message"]),
        "polish": _polish(document["polish"]),
        "ranking": tuple(_candidate(candidate) for candidate in document["ranking"]),
        "structure": {kind: str(document["structure"][kind]) for kind in ("svg", "dxf", "stl")},
        "orientation": float(document["orientation"]),
        "material": _made_of(document["material"]),
        "size": StructureSize(
            beam_width=float(document["structure"]["beam_width"]),
            cell_size=_number_or_none(document["structure"]["cell_size"]),
            relative_density=_number_or_none(document["structure"]["relative_density"]),
            density=_number_or_none(document["structure"]["density"]),
        ),
    }


def _bill_fields(document: Mapping[str, Any]) -> Dict[str, Any]:
    accuracy = document["accuracy"]
    return {
        "tolerance": float(accuracy["tolerance"]),
        "equilibrium_tolerance": float(accuracy["equilibrium_tolerance"]),
        "residual": float(accuracy["residual"]),
        "effects": effects_from_wire(document["effects"]),
        "cost": cost_from_wire(document["cost"]),
    }


def design_from_wire(document: Mapping[str, Any]) -> DesignResult:
    return DesignResult(**_design_fields(document), **_bill_fields(document))


def regions_from_wire(document: Mapping[str, Any]) -> RegionDesigns:
    return RegionDesigns(
        regions=tuple(Design(**_design_fields(region)) for region in document["regions"]), **_bill_fields(document)
    )


def partial_from_wire(document: Mapping[str, Any]) -> Union[PartialDesign, PartialRound]:
    if "round" in document:
        return PartialRound(
            name=str(document.get("name", "")),
            family=str(document["family"]),
            model=str(document["model"]),
            round=_round(document["round"]),
        )
    return PartialDesign(
        name=str(document.get("name", "")),
        family=str(document["family"]),
        model=str(document["model"]),
        parameters=_array(document["parameters"]),
        x=_array(document["x"]),
        achieved=_array(document["achieved"]),
        error=_error(document["error"]),
        iteration=int(document["iteration"]),
        orientation=float(document["orientation"]),
    )


def profile_from_wire(document: Mapping[str, Any]) -> ProfileCurve:
    return ProfileCurve(
        family=str(document["family"]),
        model=str(document["model"]),
        sha256=str(document["sha256"]),
        parameters=_array(document["parameters"]),
        task=str(document["task"]),
        direction=_optional(document, "direction"),
        strain=_optional(document, "strain"),
        strain_measure=str(document["strain_measure"]),
        x=_array(document["x"]),
        y=_array(document["y"]),
        error_bar=_bars(document["error_bar"]),
        in_range=_flags(document["in_range"]),
        orientation=float(document["orientation"]),
        material=_made_of(document["material"]),
        equilibrium_tolerance=float(document["accuracy"]["equilibrium_tolerance"]),
        residual=float(document["accuracy"]["residual"]),
        effects=effects_from_wire(document["effects"]),
        cost=cost_from_wire(document["cost"]),
    )
