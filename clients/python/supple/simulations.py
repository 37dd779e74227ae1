"""Simulations of a structure under load, as dataclasses and numpy arrays.

Stresses, tangents and energy densities are in MPa, per rest area of the whole cell, holes included; lengths in mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Mapping, Optional, Tuple

import numpy as np
from numpy.typing import NDArray

from ._arrays import Array, Numbers, Positions2
from .answers import Cost, Effect
from .drawing import BLUE, GREY, RED, Area, Drawing, curve
from .loads import Load
from .request import Deadline, Reported, Request, Timeout
from .shown import Drawn, Shown, short_text
from .transport import Answer
from .units import RATIO, Number, members_without_units
from .wire import ACCURACY, EFFECT, At, Shape, decode, decode_all, encode


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
    points: Positions2
    triangles: Annotated[NDArray[np.int32], Shape(-1, 6)]

    def _drawing(self) -> Drawing:
        return _drawn_patch(self, self.points)


@dataclass(frozen=True, repr=False)
class DeformedPatch(Drawn):
    """A deformed patch: its mesh at rest, and the deformed translations (2, 2) and points (n, 2), mm."""

    mesh: Annotated[PatchMesh, At(read=lambda mesh: mesh)]
    lattice: Array
    points: Positions2

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
    tolerance: Annotated[float, ACCURACY]
    residual: Annotated[Optional[float], ACCURACY]
    nodes: Annotated[int, ACCURACY]
    triangles: Annotated[int, ACCURACY]
    unknowns: Annotated[int, ACCURACY]
    effects: Tuple[Effect, ...]
    cost: Cost
    discretization_error: Annotated[Optional[DiscretizationError], ACCURACY]
    error_accepted: Annotated[Optional[bool], ACCURACY]
    extrapolated: Annotated[bool, ACCURACY]
    mesh_size: Annotated[float, ACCURACY]

    @property
    def converged(self) -> bool:
        """Whether every state of the load was reached."""
        return not self.message and all(state.converged for state in self.states)

    @property
    def green_strain(self) -> Array:
        """Green strain (E_xx, E_yy, E_xy) of each state, shape (n, 3)."""
        return np.array([state.green_strain for state in self.states]).reshape(-1, 3)

    @property
    def stress(self) -> Array:
        """Second Piola-Kirchhoff stress (S_xx, S_yy, S_xy) of each state, shape (n, 3), MPa."""
        return np.array([state.stress for state in self.states]).reshape(-1, 3)

    @property
    def energy_density(self) -> Array:
        """Energy density of each state, shape (n,), MPa."""
        return np.array([state.energy_density for state in self.states])

    @property
    def tangent(self) -> Array:
        """Tangent stiffness of each state, shape (n, 3, 3), MPa; nan where a state has none."""
        nothing = np.full((3, 3), np.nan)
        tangents = [nothing if state.tangent is None else state.tangent for state in self.states]
        return np.array(tangents).reshape(-1, 3, 3)

    @property
    def deformation_gradient(self) -> Array:
        """Macroscopic deformation gradient of each state, shape (n, 2, 2)."""
        return np.array([state.deformation_gradient for state in self.states]).reshape(-1, 2, 2)

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


def written_material(material: Mapping[str, Any], name: str) -> Any:
    """The JSON of a material, whose modulus may have a unit."""
    return encode(members_without_units(material, {"youngs_modulus": "stress"}))


@dataclass(frozen=True)
class SimulationRequest(Request[Simulation], path="/v1/simulations"):
    """The homogenized response of a structure along a load path from rest.

    Attributes:
        family, parameters: the structure, as in `StructureRequest`.
        load: `GreenStrain`, `Uniaxial` or `Biaxial`.
        material: "law", "youngs_modulus" (MPa) and "poisson_ratio"; a neo-Hookean law with 26 MPa and 0.48 by default.
        mesh_size, corner_size, mesh_region: as in `StructureRequest`. Without `mesh_size` the server chooses the mesh, and
            reduces its discretization error by extrapolation.
        discretization_error: permitted relative error of the stress due to the mesh; the server then chooses the mesh.
            `mesh_size` has precedence if both are given.
        tolerance: relative residual of an equilibrium. 1e-8 by default.
        max_load_step: largest change of a component of F in one internal load step.
        max_iterations: Newton iterations for one load step before it is halved.
        contact, patch, buckling: "on", "off" or "automatic".
        refinement: "on" extrapolates the states from the mesh and a finer one; "automatic" does so too, but only estimates
            the error if `mesh_size` is given; "off" does neither, in about half of the time.
        tangents: whether tangent stiffnesses are computed.
        deformed: "json" for the deformed points and triangles of each state, "vtu" for VTK files, "none".

    A path that cannot be followed to its end raises no exception: see `Simulation.message`.
    """

    family: str
    parameters: Optional[Numbers]
    load: Load
    material: Annotated[Optional[Mapping[str, Any]], At(write=written_material)] = None
    mesh_size: Annotated[Optional[float], ACCURACY] = None
    corner_size: Annotated[Optional[float], ACCURACY] = None
    mesh_region: Annotated[Optional[str], ACCURACY] = None
    discretization_error: Annotated[Optional[Number], ACCURACY, RATIO] = None
    tolerance: Annotated[Optional[float], ACCURACY] = None
    max_load_step: Annotated[Optional[float], ACCURACY] = None
    max_iterations: Annotated[Optional[int], ACCURACY] = None
    contact: Annotated[Optional[str], EFFECT] = None
    patch: Annotated[Optional[str], EFFECT] = None
    buckling: Annotated[Optional[str], EFFECT] = None
    refinement: Annotated[Optional[str], EFFECT] = None
    tangents: bool = True
    deformed: str = "none"
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def decode(self, answer: Answer) -> Simulation:
        document = answer.json()
        meshes = decode_all(PatchMesh, document.get("meshes", ()))
        for state in document["states"]:
            if "deformed" in state:  # refers to its mesh by the index
                state["deformed"]["mesh"] = meshes[state["deformed"]["mesh"]]
        return decode(Simulation, document)
