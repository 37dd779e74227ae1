"""Simulations of a structure under load, as dataclasses and numpy arrays.

Stresses, tangents and energy densities are in MPa, per rest area of the whole cell, holes included; lengths in mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import NDArray

from .answers import Array, Cost, Effect, cost_from_wire, effects_from_wire
from .drawing import BLUE, GREY, RED, Area, Drawing, curve
from .jobs import Computation
from .loads import Load
from .shown import Drawn, Shown, short_text
from .tilings import structure_to_wire


@dataclass(frozen=True, repr=False)
class PatchMesh(Drawn):
    """The mesh of a patch at rest, cut along its periodic boundary for drawing.

    Attributes:
        cells: number of cells along each side of the patch, 1 or 2.
        lattice: the patch's translations at rest as rows, shape (2, 2), mm.
        points: positions at rest, shape (n, 2), mm.
        triangles: points of each quadratic triangle, shape (m, 6): the corners counterclockwise, then the midpoints of the
            sides 01, 12, 20.
    """

    cells: int
    lattice: Array
    points: Array
    triangles: NDArray[np.int32]

    def _drawing(self) -> Drawing:
        return _drawn_patch(self, self.points)


@dataclass(frozen=True, repr=False)
class DeformedPatch(Drawn):
    """A deformed patch: its mesh at rest, and the deformed translations (2, 2) and points (n, 2), mm."""

    mesh: PatchMesh
    lattice: Array
    points: Array

    def _drawing(self) -> Drawing:
        return _drawn_patch(self.mesh, self.points)


@dataclass(frozen=True, repr=False)
class State(Drawn):
    """One equilibrium.

    Attributes:
        green_strain: (E_xx, E_yy, E_xy), tensor components, including the free ones of a uniaxial load.
        stress: second Piola-Kirchhoff (S_xx, S_yy, S_xy), MPa.
        stress_error: estimated error of the stress due to the mesh (Frobenius norm), MPa; None if there is no estimate.
        energy_density: MPa, contact included; `energy_density_error` is its estimated error.
        tangent: d (S_xx, S_yy, S_xy) / d (E_xx, E_yy, 2 E_xy), shape (3, 3), MPa; None if it was not requested or the state is
            singular.
        deformation_gradient: macroscopic F, shape (2, 2).
        stopped: "converged", "iteration_limit" or "step_too_small".
        residual: norm of the unbalanced forces, relative; None if it is not finite.
        iterations, load_steps: Newton iterations and internal load steps since the state before.
        contacts: number of pairs of boundary points and sides in contact. The range of contact is reduced until it does not
            affect the result.
        smallest_gap: least distance between sides that are not neighbours, mm; None if it was not computed.
        smallest_jacobian: least determinant of the deformation gradient over all triangles.
        stable: whether the stiffness is positive definite for all modes that were tested.
        branch: how often the path has left an unstable branch.
        cells: number of cells along each side of the patch, 1 or 2.
        deformed: None unless deformed="json" was requested; `vtu` likewise for "vtu".
    """

    green_strain: Array
    stress: Array
    energy_density: float
    tangent: Optional[Array]
    deformation_gradient: Array
    stopped: str
    residual: Optional[float]
    iterations: int
    load_steps: int
    contacts: int
    smallest_gap: Optional[float]
    smallest_jacobian: float
    stable: bool
    branch: int
    cells: int
    deformed: Optional[DeformedPatch]
    vtu: Optional[str]
    stress_error: Optional[float]
    energy_density_error: Optional[float]

    @property
    def converged(self) -> bool:
        return self.stopped == "converged"

    def _drawing(self) -> Optional[Drawing]:
        return None if self.deformed is None else self.deformed._drawing()


@dataclass(frozen=True, repr=False)
class DiscretizationError(Shown):
    """Estimated relative errors due to the mesh, as root mean squares over the states of a path."""

    stress: float
    energy: float


@dataclass(frozen=True, repr=False)
class Simulation(Drawn):
    """The states of a structure along a load path.

    Attributes:
        family, parameters: the structure.
        states: one for each state of the load, or fewer if the path ended early; the last one has then not converged.
        message: why the path ended early; empty if it did not.
        tolerance, residual: the requested residual, and the largest one that was reached (None if one is not finite).
        nodes, triangles: numbers for the mesh of one cell; `unknowns` is that of the largest system that was solved.
        discretization_error: estimated error due to the mesh; None if it is unknown.
        error_accepted: whether that is within the error that the request permits; None if the request names none.
        extrapolated: whether the states are extrapolated from the mesh and a finer one.
        mesh_size: sides of the triangles over the beam width.
    """

    family: str
    parameters: Array
    states: Tuple[State, ...]
    message: str
    tolerance: float
    residual: Optional[float]
    nodes: int
    triangles: int
    unknowns: int
    effects: Tuple[Effect, ...]
    cost: Cost
    discretization_error: Optional[DiscretizationError]
    error_accepted: Optional[bool]
    extrapolated: bool
    mesh_size: float

    @property
    def converged(self) -> bool:
        """Whether every state of the load was reached."""
        return not self.message and all(state.converged for state in self.states)

    @property
    def green_strain(self) -> Array:
        """Green strain (E_xx, E_yy, E_xy) of each state, shape (n, 3)."""
        return _array([state.green_strain for state in self.states]).reshape(-1, 3)

    @property
    def stress(self) -> Array:
        """Second Piola-Kirchhoff stress (S_xx, S_yy, S_xy) of each state, shape (n, 3), MPa."""
        return _array([state.stress for state in self.states]).reshape(-1, 3)

    @property
    def energy_density(self) -> Array:
        """Energy density of each state, shape (n,), MPa."""
        return _array([state.energy_density for state in self.states])

    @property
    def tangent(self) -> Array:
        """Tangent stiffness of each state, shape (n, 3, 3), MPa; nan where a state has none."""
        nothing = np.full((3, 3), np.nan)
        tangents = [nothing if state.tangent is None else state.tangent for state in self.states]
        return _array(tangents).reshape(-1, 3, 3)

    @property
    def deformation_gradient(self) -> Array:
        """Macroscopic deformation gradient of each state, shape (n, 2, 2)."""
        return _array([state.deformation_gradient for state in self.states]).reshape(-1, 2, 2)

    def _drawing(self) -> Optional[Drawing]:
        if not self.states:
            return None
        names = ("xx", "yy", "xy")
        loaded = int(np.argmax(np.abs(self.green_strain).max(axis=0)))
        lines = tuple(
            curve(self.green_strain[:, loaded], self.stress[:, i], label=f"S_{names[i]}", color=(BLUE, RED, GREY)[i])
            for i in range(3)
        )
        title = f"{self.family} {short_text(self.parameters)}"
        return Drawing("curves", lines, (), title, f"Green strain E_{names[loaded]}", "stress / MPa")


def _drawn_patch(mesh: PatchMesh, points: Array) -> Drawing:
    return Drawing("map", (), tuple(Area((points[corners],)) for corners in mesh.triangles[:, :3]), title="patch")


def _array(values: Any) -> Array:
    return np.asarray(values, dtype=np.float64)


def _patch_mesh(document: Mapping[str, Any]) -> PatchMesh:
    return PatchMesh(
        cells=int(document["cells"]),
        lattice=_array(document["lattice"]),
        points=_array(document["points"]).reshape(-1, 2),
        triangles=np.asarray(document["triangles"], dtype=np.int32).reshape(-1, 6),
    )


def _state(document: Mapping[str, Any], meshes: List[PatchMesh]) -> State:
    deformed = document.get("deformed")
    return State(
        green_strain=_array(document["green_strain"]),
        stress=_array(document["stress"]),
        energy_density=float(document["energy_density"]),
        tangent=None if document["tangent"] is None else _array(document["tangent"]),
        deformation_gradient=_array(document["deformation_gradient"]),
        stopped=str(document["stopped"]),
        residual=document["residual"],
        iterations=int(document["iterations"]),
        load_steps=int(document["load_steps"]),
        contacts=int(document["contacts"]),
        smallest_gap=document["smallest_gap"],
        smallest_jacobian=float(document["smallest_jacobian"]),
        stable=bool(document["stable"]),
        branch=int(document["branch"]),
        cells=int(document["cells"]),
        deformed=None
        if deformed is None
        else DeformedPatch(
            mesh=meshes[deformed["mesh"]],
            lattice=_array(deformed["lattice"]),
            points=_array(deformed["points"]).reshape(-1, 2),
        ),
        vtu=document.get("vtu"),
        stress_error=document["stress_error"],
        energy_density_error=document["energy_density_error"],
    )


def simulation_from_wire(document: Mapping[str, Any]) -> Simulation:
    meshes = [_patch_mesh(mesh) for mesh in document.get("meshes", [])]
    accuracy = document["accuracy"]
    return Simulation(
        family=str(document["family"]),
        parameters=_array(document["parameters"]),
        states=tuple(_state(state, meshes) for state in document["states"]),
        message=str(document["message"]),
        tolerance=float(accuracy["tolerance"]),
        residual=accuracy["residual"],
        nodes=int(accuracy["nodes"]),
        triangles=int(accuracy["triangles"]),
        unknowns=int(accuracy["unknowns"]),
        effects=effects_from_wire(document["effects"]),
        cost=cost_from_wire(document["cost"]),
        discretization_error=None
        if accuracy["discretization_error"] is None
        else DiscretizationError(**accuracy["discretization_error"]),
        error_accepted=accuracy["error_accepted"],
        extrapolated=bool(accuracy["extrapolated"]),
        mesh_size=float(accuracy["mesh_size"]),
    )


def simulation(
    family: str,
    parameters: Optional[Sequence[float]],
    load: Load,
    material: Optional[Mapping[str, Any]],
    accuracy: Mapping[str, Any],
    effects: Mapping[str, Optional[str]],
    tangents: bool,
    deformed: str,
    deadline: Optional[float],
) -> Computation[Simulation]:
    document: Dict[str, Any] = {
        **structure_to_wire(family, parameters),
        "load": load.to_wire(),
        "accuracy": {name: value for name, value in accuracy.items() if value is not None},
        "effects": {name: value for name, value in effects.items() if value is not None},
        "tangents": tangents,
        "deformed": deformed,
    }
    if material is not None:
        document["material"] = dict(material)
    if deadline is not None:
        document["deadline"] = deadline
    return Computation("/v1/simulations", document, lambda answer: simulation_from_wire(answer.json()))
