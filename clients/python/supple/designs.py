"""Inverse design: targets, problems and their requests."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Dict, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike

from . import checks
from .design_answers import (
    DesignResult,
    ProfileCurve,
    RegionDesigns,
    design_from_wire,
    profile_from_wire,
    regions_from_wire,
)
from .errors import InvalidRequest
from .jobs import Computation

if TYPE_CHECKING:
    from .client import Client


@dataclass(frozen=True)
class Target:
    """A wanted profile: a curve through control points. None stands for the server's default.

    Attributes:
        task: "stress_strain" (MPa over strain in one direction), "stiffness" (MPa over directions) or "poisson"
            (Poisson's ratio over directions).
        control_points: (x, y), shape (n, 2), x increasing: strains, or angles in radians of period pi.
        direction: angle of the load from the x axis, radians, for stress_strain. 0 by default.
        strain: strain along the load, for stiffness and poisson. 0.05 by default.
        strain_measure: "green" (Green strain, second Piola-Kirchhoff stress) or "engineering" (stretch - 1, force over rest
            width). "green" by default.
        interpolation: "cubic", "monotone" or "linear"; "cubic" by default.
        weights: weights of the deviations at the control points, shape (n,).
        bands: tolerated deviations at the control points, shape (n,), in the unit of y.
        samples: number of points at which profiles are compared with the target. 10 by default, 50 over directions.
        weight: weight of this target among several. 1 by default.
    """

    task: str
    control_points: ArrayLike
    direction: Optional[float] = None
    strain: Optional[float] = None
    strain_measure: Optional[str] = None
    interpolation: Optional[str] = None
    weights: Optional[ArrayLike] = None
    bands: Optional[ArrayLike] = None
    samples: Optional[int] = None
    weight: Optional[float] = None

    def __post_init__(self) -> None:
        checks.one_of(self.task, "task", checks.TASKS)
        points = checks.control_points(self.control_points, self.task, self.direction)
        if self.direction is not None:
            checks.radians(self.direction, "direction")
        if self.strain is not None:
            checks.number(self.strain, "strain")
        checks.one_of(self.strain_measure, "strain_measure", ("green", "engineering"))
        checks.one_of(self.interpolation, "interpolation", ("cubic", "monotone", "linear"))
        checks.one_for_each(self.weights, "weights", len(points))
        checks.one_for_each(self.bands, "bands", len(points))

    @classmethod
    def from_csv(cls, source: Union[str, Path], client: Optional["Client"] = None, **how: Any) -> "Target":
        """The target of a measured curve in a file, or in a text with line breaks. `how` are arguments of
        `Client.measured_curve`. Without a client, one with the environment's address and key is used."""
        return _measured(client, source, None, how)

    @classmethod
    def from_xy(cls, x: ArrayLike, y: ArrayLike, client: Optional["Client"] = None, **how: Any) -> "Target":
        """The same for measured points in the order of the measurement; x and y have the shape (n,)."""
        return _measured(client, None, np.column_stack([np.asarray(x, dtype=np.float64), np.asarray(y, dtype=np.float64)]), how)

    def to_wire(self) -> Dict[str, Any]:
        points = np.asarray(self.control_points, dtype=np.float64)
        spline = {
            "control_points": points.tolist(),
            "interpolation": self.interpolation,
            "weights": _numbers(self.weights),
            "bands": _numbers(self.bands),
        }
        return {
            "task": self.task,
            "target": _given(spline),
            **_given(
                {
                    "direction": self.direction,
                    "strain": self.strain,
                    "strain_measure": self.strain_measure,
                    "samples": self.samples,
                    "weight": self.weight,
                }
            ),
        }


def _measured(
    client: Optional["Client"], source: Union[str, Path, None], points: Optional[ArrayLike], how: Dict[str, Any]
) -> Target:
    if client is None:
        from .client import Client

        with Client() as own:
            return _measured(own, source, points, how)
    try:
        return client.measured_curve(source, points=points, **how).target()
    except InvalidRequest as refused:
        if source is None or not _holds_control_points(source):
            raise
        advice = " If the lines are control points rather than measurements, give them to supple.Target, for example by numpy.loadtxt."
        raise type(refused)(refused.status, refused.code, refused.title, refused.detail + advice, refused.faults) from None


def _holds_control_points(source: Union[str, Path]) -> bool:
    """Whether each line of a file or text, perhaps after a heading, has two to four numbers, as control points have."""
    from .measured import text_of

    lines = [line for line in text_of(source).splitlines() if line.strip() and not line.lstrip().startswith("#")]

    def is_point(line: str) -> bool:
        try:
            return 2 <= len([float(cell) for cell in line.split(",")]) <= 4
        except ValueError:
            return False

    return bool(lines) and all(map(is_point, lines[1:])) and (is_point(lines[0]) or len(lines) > 1)


@dataclass(frozen=True)
class Material:
    """The material of a structure. None stands for that of the model's data.

    Attributes:
        youngs_modulus: E in MPa, to which stresses and stiffnesses are proportional. With a pair (least, greatest) the search
            finds the best modulus for the targets. Each of several materials needs one.
        density: in g/cm^3. 1.2 by default.
        name: a name that the answer repeats.
        poisson_ratio, law: only those of the model's data are permitted (`InvalidDesign`).
    """

    youngs_modulus: Union[float, Tuple[float, float], None] = None
    density: Optional[float] = None
    name: Optional[str] = None
    poisson_ratio: Optional[float] = None
    law: Optional[str] = None

    def to_wire(self) -> Dict[str, Any]:
        modulus: Union[float, Sequence[float], None] = None
        if self.youngs_modulus is not None:
            values = np.asarray(self.youngs_modulus, dtype=np.float64)
            if values.shape not in ((), (2,)):
                raise ValueError(f"youngs_modulus has the shape {values.shape}; expected a number or a pair (least, most)")
            modulus = values.tolist()
        return _given(
            {
                "name": self.name,
                "youngs_modulus": modulus,
                "law": self.law,
                "poisson_ratio": self.poisson_ratio,
                "density": self.density,
            }
        )


@dataclass(frozen=True)
class Limits:
    """Limits of a structure's size and density: pairs (least, greatest), or None for no limit.

    Attributes:
        relative_density: solid area / area of the cell, dimensionless.
        cell_size: square root of a cell's area, mm, for beams of a given width.
        beam_width: width of the beams, mm, for cells of a given size; beams are the walls of a part.
    """

    relative_density: Optional[Tuple[float, float]] = None
    cell_size: Optional[Tuple[float, float]] = None
    beam_width: Optional[Tuple[float, float]] = None

    def to_wire(self) -> Dict[str, Any]:
        pairs = {"relative_density": self.relative_density, "cell_size": self.cell_size, "beam_width": self.beam_width}
        return {name: checks.pair(pair, name) for name, pair in pairs.items() if pair is not None}


def _orientation(orientation: Union[float, Tuple[float, float], None]) -> Union[float, Sequence[float], None]:
    if orientation is None or np.ndim(orientation) > 0:
        return None if orientation is None else checks.pair(orientation, "orientation")
    return checks.radians(orientation, "orientation")


def _materials(material: Union[Material, Sequence[Material], None]) -> Union[Dict[str, Any], Sequence[Dict[str, Any]], None]:
    if material is None or isinstance(material, Material):
        return None if material is None else material.to_wire()
    return [one.to_wire() for one in material]


@dataclass(frozen=True)
class Region:
    """The design problem of one region of a product; the fields are those of `Client.design`."""

    target: Target
    name: Optional[str] = None
    family: Optional[str] = None
    model: Optional[str] = None
    also: Sequence[Target] = field(default_factory=tuple)
    initial: Optional[Sequence[float]] = None
    fixed: Optional[Sequence[Optional[float]]] = None
    orientation: Union[float, Tuple[float, float], None] = None
    initial_orientation: Optional[float] = None
    material: Union[Material, Sequence[Material], None] = None
    beam_width: Optional[float] = None
    cell_size: Optional[float] = None
    limits: Optional[Limits] = None

    def to_wire(self) -> Dict[str, Any]:
        return {
            **self.target.to_wire(),
            **_given(
                {
                    "name": self.name,
                    "also": [target.to_wire() for target in self.also] or None,
                    "family": self.family,
                    "model": self.model,
                    "initial": _numbers(self.initial),
                    "fixed": None
                    if self.fixed is None
                    else [None if value is None else float(value) for value in self.fixed],
                    "orientation": _orientation(self.orientation),
                    "initial_orientation": None
                    if self.initial_orientation is None
                    else checks.radians(self.initial_orientation, "initial_orientation"),
                    "material": _materials(self.material),
                    "beam_width": self.beam_width,
                    "cell_size": self.cell_size,
                    "limits": None if self.limits is None else self.limits.to_wire(),
                }
            ),
        }


@dataclass(frozen=True)
class DesignOptions:
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
    """

    tolerance: Optional[float] = None
    equilibrium_tolerance: Optional[float] = None
    max_iterations: Optional[int] = None
    starts: Optional[int] = None
    candidates: Optional[int] = None
    verified_samples: Optional[int] = None
    multi_start: Optional[str] = None
    envelope: Optional[str] = None
    polish: Optional[str] = None
    polish_tolerance: Optional[float] = None
    polish_rounds: Optional[int] = None
    polish_seconds: Optional[float] = None
    trust: Optional[str] = None

    def to_wire(self) -> Dict[str, Any]:
        accuracy = _given(
            {
                "tolerance": self.tolerance,
                "equilibrium_tolerance": self.equilibrium_tolerance,
                "max_iterations": self.max_iterations,
                "starts": self.starts,
                "candidates": self.candidates,
                "verified_samples": self.verified_samples,
                "polish_tolerance": self.polish_tolerance,
                "polish_rounds": self.polish_rounds,
                "polish_seconds": self.polish_seconds,
            }
        )
        effects = _given({"trust": self.trust, "multi_start": self.multi_start, "envelope": self.envelope, "polish": self.polish})
        return _given({"accuracy": accuracy or None, "effects": effects or None})


def _given(values: Mapping[str, Any]) -> Dict[str, Any]:
    return {name: value for name, value in values.items() if value is not None}


def _numbers(values: Optional[ArrayLike]) -> Optional[Sequence[float]]:
    if values is None:
        return None
    array = np.asarray(values, dtype=np.float64)
    if array.ndim != 1:
        raise ValueError(f"a list has the shape {array.shape}; expected (n,)")
    return [float(value) for value in array]


def _shared(
    options: Optional[DesignOptions], verify: bool, session: Optional[str], deadline: Optional[float]
) -> Dict[str, Any]:
    wire = {} if options is None else options.to_wire()
    return {**wire, **_given({"verify": verify or None, "session": session, "deadline": deadline})}


def design(
    problem: Region, options: Optional[DesignOptions], verify: bool, session: Optional[str], deadline: Optional[float]
) -> Computation[DesignResult]:
    document = {**problem.to_wire(), **_shared(options, verify, session, deadline)}
    return Computation("/v1/designs", document, lambda answer: design_from_wire(answer.json()))


def design_regions(
    regions: Sequence[Region],
    options: Optional[DesignOptions],
    verify: bool,
    session: Optional[str],
    deadline: Optional[float],
) -> Computation[RegionDesigns]:
    document = {
        "regions": [region.to_wire() for region in regions],
        **_shared(options, verify, session, deadline),
    }
    return Computation("/v1/designs", document, lambda answer: regions_from_wire(answer.json()))


def profile(
    task: str,
    parameters: Sequence[float],
    family: Optional[str],
    model: Optional[str],
    direction: Optional[float],
    strain: Optional[float],
    strain_measure: Optional[str],
    x: Optional[ArrayLike],
    limits: Optional[Tuple[float, float]],
    samples: Optional[int],
    equilibrium_tolerance: Optional[float],
    orientation: Optional[float],
    material: Optional[Material],
    deadline: Optional[float],
) -> Computation[ProfileCurve]:
    checks.one_of(task, "task", checks.TASKS)
    document = {
        "task": task,
        "parameters": _numbers(parameters),
        **_given(
            {
                "family": family,
                "model": model,
                "direction": None if direction is None else checks.radians(direction, "direction"),
                "strain": None if strain is None else checks.number(strain, "strain"),
                "strain_measure": strain_measure,
                "x": _numbers(x),
                "range": _numbers(limits),
                "samples": samples,
                "orientation": _orientation(orientation),
                "material": _materials(material),
                "accuracy": None
                if equilibrium_tolerance is None
                else {"equilibrium_tolerance": equilibrium_tolerance},
                "deadline": deadline,
            }
        ),
    }
    return Computation("/v1/profiles", document, lambda answer: profile_from_wire(answer.json()))
