"""Answers about weaves as dataclasses and numpy arrays. Lengths are in mm, forces in N, stresses per width in N/m."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Mapping, Optional, Tuple

import numpy as np

from ._arrays import Array, Flags, Positions, Positions2
from .answers import Cost, Effect
from .drawing import GREY, RED, Drawing, Line, curve, joined
from .shown import Drawn, Shown
from .wire import ACCURACY, At, decode


@dataclass(frozen=True, repr=False)
class LaidStrand(Shown):
    """A strand at rest: `polyline` has the shape (n, 2); `translation` is zero unless `ends` is "periodic"."""

    ends: str
    translation: Array
    length: float
    radius: float
    polyline: Positions2


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
    strands: Tuple[Positions, ...]
    sliding: Array

    def _drawing(self) -> Drawing:
        return Drawing("map", (Line(joined(self.strands)),), title="deformed cell")


def _cells_of_gradients(cells: Any) -> Mapping[int, DeformedCell]:
    return {cell["state"]: decode(DeformedCell, {**cell, "direction": cell["state"]}) for cell in cells}


@dataclass(frozen=True, repr=False)
class WeaveDiscretizationError(Shown):
    """Estimated errors due to the rods' resolution, as root mean squares. They are relative except that of Poisson's ratio.

    Each answer has its own: homogenizations `youngs_modulus` and `poisson_ratio`, deformations `stress` and `energy`, simulations
    `reactions` and `energy`.
    """

    youngs_modulus: Optional[float] = None
    poisson_ratio: Optional[float] = None
    stress: Optional[float] = None
    reactions: Optional[float] = None
    energy: Optional[float] = None


@dataclass(frozen=True, repr=False)
class WeaveDeformation(Shown):
    """Equilibria of a periodic weave, one entry for each deformation gradient.

    Attributes:
        deformation_gradient: shape (n, 2, 2). For a gradient that was not reached it is the last one on the path to it.
        nominal_stress, cauchy_stress: shape (n, 2, 2), N/m.
        energy_density: N/m, shape (n,).
        cauchy_stress_error, energy_density_error: estimated errors in N/m, shape (n,), of the stress as a Frobenius norm; nan where
            they were not estimated (`WeaveOptions.error_estimate`). `discretization_error` has those of all together.
        stopped: "converged", "iteration_limit", "step_too_small", or "deadline" or "memory" if time or memory ran out.
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
    cauchy_stress_error: Array
    energy_density_error: Array
    stopped: Tuple[str, ...]
    out_of_plane: Flags
    stable: Flags
    message: str
    cells: Annotated[Mapping[int, DeformedCell], At(read=_cells_of_gradients)]
    tolerance: Annotated[float, ACCURACY]
    residual: Annotated[Optional[float], ACCURACY]
    limit_tolerance: Annotated[float, ACCURACY]
    limit_error: Annotated[Optional[float], ACCURACY]
    limit_errors: Annotated[Array, At("/limit_error")]
    discretization_error: Annotated[Optional[WeaveDiscretizationError], ACCURACY]
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
        youngs_modulus_error, poisson_ratio_error: estimated errors due to the rods' resolution, the first in N/m; at least 90 of 100
            directions err by less. nan where they were not estimated (`WeaveOptions.error_estimate`). `discretization_error` has
            those of all directions together.
        deformation_gradient, nominal_stress, cauchy_stress: shape (n, 2, 2), N/m.
        energy_density: N/m.
        stopped: "converged", "iteration_limit", "step_too_small", "folded_flat", or "deadline" or "memory" if time or
            memory ran out.
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
    youngs_modulus_error: Array
    poisson_ratio_error: Array
    deformation_gradient: Array
    nominal_stress: Array
    cauchy_stress: Array
    energy_density: Array
    stopped: Tuple[str, ...]
    out_of_plane: Flags
    stable: Flags
    message: str
    cells: Tuple[DeformedCell, ...]
    tolerance: Annotated[float, ACCURACY]
    residual: Annotated[Optional[float], ACCURACY]
    limit_tolerance: Annotated[float, ACCURACY]
    limit_error: Annotated[Optional[float], ACCURACY]
    limit_errors: Annotated[Array, At("/limit_error")]
    discretization_error: Annotated[Optional[WeaveDiscretizationError], ACCURACY]
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
        stopped: "converged", "iteration_limit", "step_too_small", or "deadline" or "memory" if time or memory ran out.
        residual: N; None if it is not finite.
        limit_error: relative error of the energy, estimated, because sliders do not quite reach their limits; None if it is not
            finite.
        energy_error, reaction_error: estimated errors of the energy (N mm) and of each reaction (N) due to the rods' resolution; None
            where they were not estimated (`WeaveOptions.error_estimate`).
        iterations, load_steps, branches: numbers since the state before.
        strands: polylines of shape (n, 3); None unless deformed="json". `obj` and `vtu` likewise.
    """

    share: float
    energy: float
    crossings: Positions
    sliding: Array
    reactions: Positions
    out_of_plane: bool
    stable: bool
    stopped: str
    residual: Optional[float]
    limit_error: Optional[float]
    energy_error: Optional[float]
    reaction_error: Optional[float]
    iterations: int
    load_steps: int
    branches: int
    strands: Optional[Tuple[Positions, ...]]
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


def _sliders(sliders: Any) -> Tuple[Tuple[int, int], ...]:
    return tuple((slider["crossing"], slider["member"]) for slider in sliders)


@dataclass(frozen=True, repr=False)
class WeaveSimulation(Drawn):
    """The states of a sheet along a load path.

    Attributes:
        supports: the supported places; a box may contain several.
        sliders: (crossing, member) of the sliding members, in the order of `SheetState.sliding`.
        states: one for each requested state, or fewer if the path ended early; the last one has then not converged.
        message: why the path ended early, and in which states sliders are not exactly at their limits; may be empty.
        limit_tolerance, limit_error: as in `WeaveHomogenization`.
        discretization_error: estimated errors of reactions and energies; None unless they were estimated.
        unknowns: number of unknowns of the largest system that was solved.
    """

    supports: Tuple[HeldPlace, ...]
    sliders: Annotated[Tuple[Tuple[int, int], ...], At(read=_sliders)]
    states: Tuple[SheetState, ...]
    message: str
    tolerance: Annotated[float, ACCURACY]
    residual: Annotated[Optional[float], ACCURACY]
    limit_tolerance: Annotated[float, ACCURACY]
    limit_error: Annotated[Optional[float], ACCURACY]
    discretization_error: Annotated[Optional[WeaveDiscretizationError], ACCURACY]
    unknowns: Annotated[int, ACCURACY]
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
