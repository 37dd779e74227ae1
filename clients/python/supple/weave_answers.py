"""Answers about weaves as dataclasses and numpy arrays. Lengths are in mm, forces in N, stresses per width in N/m."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, List, Mapping, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from .answers import Array, Cost, Effect, cost_from_wire, effects_from_wire
from .drawing import GREY, RED, Drawing, Line, curve, joined
from .shown import Drawn, Shown


@dataclass(frozen=True, repr=False)
class LaidStrand(Shown):
    """A strand at rest: `polyline` has the shape (n, 2); `translation` is zero unless `ends` is "periodic"."""

    ends: str
    translation: Array
    length: float
    radius: float
    polyline: Array


@dataclass(frozen=True, repr=False)
class CrossingMember(Shown):
    """A strand's part in a crossing: its place on the strand, which periodic copy of the strand, whether it slides, and how far
    (None for as far as its neighbours permit)."""

    strand: int
    coordinate: float
    shift: Tuple[int, int]
    slides: bool
    backward: Optional[float]
    forward: Optional[float]


@dataclass(frozen=True, repr=False)
class Crossing(Shown):
    """A place where strands meet; `position` has the shape (2,)."""

    position: Array
    members: Tuple[CrossingMember, ...]

    @property
    def slides(self) -> bool:
        return any(member.slides for member in self.members)


@dataclass(frozen=True, repr=False)
class WeaveLayout(Drawn):
    """A weave at rest.

    Attributes:
        strands, crossings: overrides, supports and forces refer to them by their indices.
        lattice: the cell's translations as rows, shape (2, 2); None for a sheet.
        warnings: a sentence for each likely mistake.
    """

    strands: Tuple[LaidStrand, ...]
    crossings: Tuple[Crossing, ...]
    lattice: Optional[Array]
    warnings: Tuple[str, ...]
    cost: Cost

    def _drawing(self) -> Drawing:
        strands = Line(joined([strand.polyline for strand in self.strands], 2))
        places = np.array([crossing.position for crossing in self.crossings]).reshape(-1, 2)
        slides = np.array([crossing.slides for crossing in self.crossings], dtype=bool)
        marks = [Line(places[~slides], color=GREY, label="fused", marks=True), Line(places[slides], color=RED, label="slides", marks=True)]
        title = f"{len(self.strands)} strands, {len(self.crossings)} crossings"
        return Drawing("map", (strands, *(mark for mark in marks if len(mark.points))), title=title)


@dataclass(frozen=True, repr=False)
class DeformedCell(Drawn):
    """A deformed cell. `direction` is the index of a direction or of a deformation gradient, `lattice` has the translations as
    rows, `strands` are polylines of shape (n, 3), and `sliding` is how far each slider has moved."""

    direction: int
    lattice: Array
    strands: Tuple[Array, ...]
    sliding: Array

    def _drawing(self) -> Drawing:
        return Drawing("map", (Line(joined(self.strands)),), title="deformed cell")


@dataclass(frozen=True, repr=False)
class WeaveDeformation(Shown):
    """Equilibria of a periodic weave, one entry for each deformation gradient.

    Attributes:
        deformation_gradient: shape (n, 2, 2). For a gradient that was not reached it is the last one on the path to it.
        nominal_stress, cauchy_stress: shape (n, 2, 2), N/m.
        energy_density: N/m, shape (n,).
        stopped: "converged", "iteration_limit" or "step_too_small".
        out_of_plane, stable: bool, shape (n,).
        message: how many gradients were not reached, and for which entries sliders are not exactly at their limits; may be
            empty.
        cells: the deformed cells that were requested, by the index of their gradient.
        tolerance, residual: the requested tolerance, and the largest residual relative to its bound (None if not finite).
        limit_tolerance, limit_error: the requested tolerance, and the largest relative error of an energy, estimated, because
            sliders do not quite reach their limits (None if not finite). `limit_errors` has that of each entry, shape (n,).
    """

    deformation_gradient: Array
    nominal_stress: Array
    cauchy_stress: Array
    energy_density: Array
    stopped: Tuple[str, ...]
    out_of_plane: NDArray[np.bool_]
    stable: NDArray[np.bool_]
    message: str
    cells: Mapping[int, DeformedCell]
    tolerance: float
    residual: Optional[float]
    limit_tolerance: float
    limit_error: Optional[float]
    limit_errors: Array
    effects: Tuple[Effect, ...]
    cost: Cost


@dataclass(frozen=True, repr=False)
class WeaveHomogenization(Drawn):
    """The response of a periodic weave to uniaxial strain, one entry for each direction.

    Attributes:
        strain: stretch minus one.
        directions: radians, shape (n,).
        youngs_modulus: N/m; nan where not converged. `youngs_modulus_mpa` is the same in MPa; None without a thickness.
        poisson_ratio: nan where not converged.
        deformation_gradient, nominal_stress, cauchy_stress: shape (n, 2, 2), N/m.
        energy_density: N/m.
        stopped: "converged", "iteration_limit", "step_too_small" or "folded_flat".
        out_of_plane, stable: bool, shape (n,).
        message: how many directions did not converge, and for which sliders are not exactly at their limits; may be empty.
        cells: the deformed cells that were requested.
        tolerance, residual: the requested tolerance, and the largest residual relative to its bound (None if not finite).
        limit_tolerance, limit_error: the requested tolerance, and the largest relative error of an energy, estimated, because
            sliders do not quite reach their limits (None if not finite). `limit_errors` has that of each entry, shape (n,).
    """

    strain: float
    directions: Array
    youngs_modulus: Array
    youngs_modulus_mpa: Optional[Array]
    poisson_ratio: Array
    deformation_gradient: Array
    nominal_stress: Array
    cauchy_stress: Array
    energy_density: Array
    stopped: Tuple[str, ...]
    out_of_plane: NDArray[np.bool_]
    stable: NDArray[np.bool_]
    message: str
    cells: Tuple[DeformedCell, ...]
    tolerance: float
    residual: Optional[float]
    limit_tolerance: float
    limit_error: Optional[float]
    limit_errors: Array
    effects: Tuple[Effect, ...]
    cost: Cost

    @property
    def converged(self) -> bool:
        """Whether the path of every direction reached the strain."""
        return all(stopped == "converged" for stopped in self.stopped)

    def _drawing(self) -> Drawing:
        title = f"Young's modulus / (N/m) at a strain of {self.strain:.4g}"
        return Drawing("polar", (curve(self.directions, self.youngs_modulus),), title=title)


@dataclass(frozen=True, repr=False)
class SheetState(Drawn):
    """One equilibrium of a sheet.

    Attributes:
        share: fraction of the loads, in (0, 1].
        energy: energy that the weave stores, N mm.
        crossings: positions of the crossings, shape (n, 3).
        sliding: how far each slider has moved along its strand, mm.
        reactions: reaction forces at `WeaveSimulation.supports`, shape (m, 3), N.
        out_of_plane, stable: whether it is computed in space, and whether its tangent stiffness is positive definite.
        stopped: "converged", "iteration_limit" or "step_too_small".
        residual: N; None if it is not finite.
        limit_error: relative error of the energy, estimated, because sliders do not quite reach their limits; None if it is not
            finite.
        iterations, load_steps, branches: numbers since the state before.
        strands: polylines of shape (n, 3); None unless deformed="json". `obj` and `vtu` likewise.
    """

    share: float
    energy: float
    crossings: Array
    sliding: Array
    reactions: Array
    out_of_plane: bool
    stable: bool
    stopped: str
    residual: Optional[float]
    limit_error: Optional[float]
    iterations: int
    load_steps: int
    branches: int
    strands: Optional[Tuple[Array, ...]]
    obj: Optional[str]
    vtu: Optional[str]

    @property
    def converged(self) -> bool:
        return self.stopped == "converged"

    def _drawing(self) -> Drawing:
        title = f"{self.share:.3g} of the load, energy {self.energy:.4g} N mm"
        if self.strands is None:
            return Drawing("map", (Line(self.crossings, marks=True),), title=title)
        return Drawing("map", (Line(joined(self.strands)),), title=title)


@dataclass(frozen=True, repr=False)
class HeldPlace(Shown):
    """A supported place: the index of its support in the request, and its position at rest, shape (2,)."""

    support: int
    strand: int
    coordinate: float
    position: Array


@dataclass(frozen=True, repr=False)
class WeaveSimulation(Drawn):
    """The states of a sheet along a load path.

    Attributes:
        supports: the supported places; a box may contain several.
        sliders: (crossing, member) of the sliding members, in the order of `SheetState.sliding`.
        states: one for each requested state, or fewer if the path ended early; the last one has then not converged.
        message: why the path ended early, and in which states sliders are not exactly at their limits; may be empty.
        limit_tolerance, limit_error: as in `WeaveHomogenization`.
        unknowns: number of unknowns of the largest system that was solved.
    """

    supports: Tuple[HeldPlace, ...]
    sliders: Tuple[Tuple[int, int], ...]
    states: Tuple[SheetState, ...]
    message: str
    tolerance: float
    residual: Optional[float]
    limit_tolerance: float
    limit_error: Optional[float]
    unknowns: int
    effects: Tuple[Effect, ...]
    cost: Cost

    @property
    def converged(self) -> bool:
        """Whether every state was reached."""
        return all(state.converged for state in self.states)

    def resultant(self, support: int) -> Array:
        """The sum of the reactions at a support of the request in every state, shape (states, 3), N."""
        places = [index for index, place in enumerate(self.supports) if place.support == support]
        return np.array([state.reactions[places].sum(axis=0) for state in self.states])

    def _drawing(self) -> Optional[Drawing]:
        return self.states[-1]._drawing() if self.states else None


def _array(values: Any) -> Array:
    return np.asarray(values, dtype=np.float64)


def _polylines(documents: List[Any]) -> Tuple[Array, ...]:
    return tuple(_array(points).reshape(-1, 3) for points in documents)


def _member(document: Mapping[str, Any]) -> CrossingMember:
    return CrossingMember(
        strand=int(document["strand"]),
        coordinate=float(document["coordinate"]),
        shift=(int(document["shift"][0]), int(document["shift"][1])),
        slides=bool(document["slides"]),
        backward=document.get("backward"),
        forward=document.get("forward"),
    )


def layout_from_wire(document: Mapping[str, Any]) -> WeaveLayout:
    lattice = document["lattice"]
    return WeaveLayout(
        strands=tuple(
            LaidStrand(
                ends=str(strand["ends"]),
                translation=_array(strand["translation"]),
                length=float(strand["length"]),
                radius=float(strand["radius"]),
                polyline=_array(strand["polyline"]).reshape(-1, 2),
            )
            for strand in document["strands"]
        ),
        crossings=tuple(
            Crossing(_array(crossing["position"]), tuple(_member(member) for member in crossing["members"]))
            for crossing in document["crossings"]
        ),
        lattice=None if lattice is None else _array(lattice),
        warnings=tuple(map(str, document["warnings"])),
        cost=cost_from_wire(document["cost"]),
    )


def _cell(document: Mapping[str, Any], index: str) -> DeformedCell:
    return DeformedCell(
        direction=int(document[index]),
        lattice=_array(document["lattice"]),
        strands=_polylines(document["strands"]),
        sliding=_array(document["sliding"]),
    )


def deformation_from_wire(document: Mapping[str, Any]) -> WeaveDeformation:
    cells = [_cell(cell, "state") for cell in document["cells"]]
    return WeaveDeformation(
        deformation_gradient=_array(document["deformation_gradient"]),
        nominal_stress=_array(document["nominal_stress"]),
        cauchy_stress=_array(document["cauchy_stress"]),
        energy_density=_array(document["energy_density"]),
        stopped=tuple(map(str, document["stopped"])),
        out_of_plane=np.asarray(document["out_of_plane"], dtype=np.bool_),
        stable=np.asarray(document["stable"], dtype=np.bool_),
        message=str(document["message"]),
        cells={cell.direction: cell for cell in cells},
        tolerance=float(document["accuracy"]["tolerance"]),
        residual=document["accuracy"]["residual"],
        limit_tolerance=float(document["accuracy"]["limit_tolerance"]),
        limit_error=document["accuracy"]["limit_error"],
        limit_errors=_array(document["limit_error"]),
        effects=effects_from_wire(document["effects"]),
        cost=cost_from_wire(document["cost"]),
    )


def homogenization_from_wire(document: Mapping[str, Any]) -> WeaveHomogenization:
    mpa = document.get("youngs_modulus_mpa")
    return WeaveHomogenization(
        strain=float(document["strain"]),
        directions=_array(document["directions"]),
        youngs_modulus=_array(document["youngs_modulus"]),
        youngs_modulus_mpa=None if mpa is None else _array(mpa),
        poisson_ratio=_array(document["poisson_ratio"]),
        deformation_gradient=_array(document["deformation_gradient"]),
        nominal_stress=_array(document["nominal_stress"]),
        cauchy_stress=_array(document["cauchy_stress"]),
        energy_density=_array(document["energy_density"]),
        stopped=tuple(map(str, document["stopped"])),
        out_of_plane=np.asarray(document["out_of_plane"], dtype=np.bool_),
        stable=np.asarray(document["stable"], dtype=np.bool_),
        message=str(document["message"]),
        cells=tuple(_cell(cell, "direction") for cell in document["cells"]),
        tolerance=float(document["accuracy"]["tolerance"]),
        residual=document["accuracy"]["residual"],
        limit_tolerance=float(document["accuracy"]["limit_tolerance"]),
        limit_error=document["accuracy"]["limit_error"],
        limit_errors=_array(document["limit_error"]),
        effects=effects_from_wire(document["effects"]),
        cost=cost_from_wire(document["cost"]),
    )


def _state(document: Mapping[str, Any]) -> SheetState:
    strands = document.get("strands")
    return SheetState(
        share=float(document["share"]),
        energy=float(document["energy"]),
        crossings=_array(document["crossings"]).reshape(-1, 3),
        sliding=_array(document["sliding"]),
        reactions=_array(document["reactions"]).reshape(-1, 3),
        out_of_plane=bool(document["out_of_plane"]),
        stable=bool(document["stable"]),
        stopped=str(document["stopped"]),
        residual=document["residual"],
        limit_error=document["limit_error"],
        iterations=int(document["iterations"]),
        load_steps=int(document["load_steps"]),
        branches=int(document["branches"]),
        strands=None if strands is None else _polylines(strands),
        obj=document.get("obj"),
        vtu=document.get("vtu"),
    )


def weave_simulation_from_wire(document: Mapping[str, Any]) -> WeaveSimulation:
    accuracy = document["accuracy"]
    return WeaveSimulation(
        supports=tuple(
            HeldPlace(int(p["support"]), int(p["strand"]), float(p["coordinate"]), _array(p["position"]))
            for p in document["supports"]
        ),
        sliders=tuple((int(slider["crossing"]), int(slider["member"])) for slider in document["sliders"]),
        states=tuple(_state(state) for state in document["states"]),
        message=str(document["message"]),
        tolerance=float(accuracy["tolerance"]),
        residual=accuracy["residual"],
        limit_tolerance=float(accuracy["limit_tolerance"]),
        limit_error=accuracy["limit_error"],
        unknowns=int(accuracy["unknowns"]),
        effects=effects_from_wire(document["effects"]),
        cost=cost_from_wire(document["cost"]),
    )
