"""Simulations of parts under supports that move, as dataclasses and numpy arrays.

Lengths are in mm, forces in N, those of the part's whole thickness, pressures in MPa.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Mapping, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import Array, Positions2, Vector2Like
from .answers import Cost, Effect
from .checks import one_of
from .drawing import Area, Drawing, curve, to_matplotlib
from .parts import PartRequest
from .request import Deadline, FileRequest, Kind, Reported, Request, Timeout
from .shown import Drawn, Shown
from .simulations import written_material
from .units import LENGTH, RATIO, Number
from .wire import ACCURACY, EFFECT, At, Sent, Shape

STRAIN_COLORS = ("#20124d", "#2c3e88", "#206e8e", "#269c80", "#78c852", "#f5e43c")
"""Colours of strains from 0 to the largest one of a picture."""


@dataclass(frozen=True)
class Plate(Sent, kind="plate"):
    """A rigid plate along a side of a part. It pushes what touches it and never pulls.

    Attributes:
        side: "bottom", "top", "left" or "right" of the part's bounding box at rest.
        displacement: how far it has moved at the end of the path, shape (2,), mm; None for a plate that does not move.
        gap: its distance from the part at rest, mm. 0 by default.
        friction: "none" (the part slides along it) or "stick" (what touches it moves along with it). "none" by default.
    """

    side: str
    displacement: Annotated[Optional[Vector2Like], LENGTH] = None
    gap: Annotated[Optional[Number], LENGTH] = None
    friction: Optional[str] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        one_of(self.side, "side", ("bottom", "top", "left", "right"))
        one_of(self.friction, "friction", ("none", "stick"))


@dataclass(frozen=True)
class Clamp(Sent, kind="clamp"):
    """A clamp, which moves all points that lie in a box at rest and holds their distances.

    Attributes:
        box: lower left and upper right corner in the coordinates of the outline, shape (2, 2), mm.
        displacement: how far it has moved at the end of the path, shape (2,), mm; None for a clamp that does not move.
    """

    box: Annotated[ArrayLike, Shape(2, 2), LENGTH]
    displacement: Annotated[Optional[Vector2Like], LENGTH] = None


PartSupport = Union[Plate, Clamp]


def _read_support(document: Mapping[str, Any]) -> PartSupport:
    members = {name: value for name, value in document.items() if name != "kind"}
    return Plate(**members) if document["kind"] == "plate" else Clamp(**members)


def _read_supports(documents: Sequence[Mapping[str, Any]]) -> Tuple[PartSupport, ...]:
    return tuple(map(_read_support, documents))


def _motion(support: PartSupport) -> Array:
    """The displacement of a support at the end of the path, shape (2,), mm."""
    return np.zeros(2) if support.displacement is None else np.asarray(support.displacement, dtype=np.float64)


@dataclass(frozen=True, repr=False)
class PlatePressure(Shown):
    """The pressure of a plate on the part, averaged over intervals of equal length along the plate.

    Attributes:
        length: length of an interval, mm.
        positions: middles of the intervals, coordinates of the part at rest, shape (n,), mm.
        values: normal force over thickness and length, shape (n,), MPa.
    """

    length: float
    positions: Array
    values: Array


@dataclass(frozen=True, repr=False)
class SupportState(Shown):
    """What a support exerts on the part.

    Attributes:
        force: shape (2,), N.
        displacement: how far it has moved, shape (2,), mm.
        touching: number of nodes of the mesh that it holds.
        pressure: that of a plate; None for a clamp.
    """

    force: Array
    displacement: Array
    touching: int
    pressure: Optional[PlatePressure]


@dataclass(frozen=True, repr=False)
class PartMesh(Shown):
    """The mesh of a part at rest.

    Attributes:
        points: positions of the nodes, shape (n, 2), mm.
        triangles: nodes of each quadratic triangle, shape (m, 6): the corners counterclockwise, then the midpoints of the
            sides 01, 12, 20.
    """

    points: Positions2
    triangles: Annotated[NDArray[np.int32], Shape(-1, 6)]


@dataclass(frozen=True, repr=False)
class DeformedPart(Shown):
    """A deformed part.

    Attributes:
        points: positions of the nodes of `PartSimulation.mesh`, shape (n, 2), mm.
        strains: the largest |principal stretch - 1| of each triangle, shape (m,).
    """

    points: Positions2
    strains: Array


@dataclass(frozen=True, repr=False)
class PartState(Shown):
    """One equilibrium of a part.

    Attributes:
        share: fraction of the supports' displacements, in [0, 1].
        stopped: "converged", "iteration_limit", "step_too_small" or "lost_support" (beyond this state, the part could move as a
            rigid body).
        residual: norm of the unbalanced forces, relative; None if it is not finite.
        iterations, load_steps: Newton iterations and internal load steps since the state before.
        supports: what each support exerts, in the order of `PartSimulation.supports`.
        energy: elastic energy of the part, contact included, N mm.
        stable: whether the stiffness of all nodes that no support holds is positive definite.
        branch: how often the path has left an unstable branch.
        contacts: number of pairs of boundary points and sides of beams in contact.
        largest_strain: the largest |principal stretch - 1| at an integration point.
        deformed: None unless deformed="json" was requested; `obj` and `vtu` likewise, and `svg` with svg=True.
    """

    share: float
    stopped: str
    residual: Optional[float]
    iterations: int
    load_steps: int
    supports: Tuple[SupportState, ...]
    energy: float
    stable: bool
    branch: int
    contacts: int
    largest_strain: float
    deformed: Optional[DeformedPart]
    obj: Optional[str]
    vtu: Optional[str]
    svg: Optional[str]

    @property
    def converged(self) -> bool:
        return self.stopped == "converged"


@dataclass(frozen=True, repr=False)
class PartialPartState(Shown):
    """The state of a part that a running job has reached last: which of how many `states` it is, counted from 1."""

    number: int
    states: int
    state: PartState


@dataclass(frozen=True, repr=False)
class PartMeshError(Shown):
    """Estimated relative errors due to the mesh, as root mean squares over the states: of the supports' forces and of the
    energy."""

    force: float
    energy: float


@dataclass(frozen=True, repr=False)
class PartSimulation(Drawn):
    """The states of a part whose supports move.

    Attributes:
        states: one for each that was requested, or fewer if the path ended early; the last one has then not converged.
        supports: the supports, also those that a coupon or a block has by default.
        message: why the path ended early; empty if it did not.
        fixed_translation: whether one displacement was fixed because no support keeps the part from moving along its plates.
        size: width, height and thickness of the part, mm.
        solid_area: mm^2; `relative_density` is its ratio to the area of the outline.
        missing_solids: grips and plates that the part has lost; `part_message` says what helps.
        mesh: the mesh at rest; None unless deformed="json" was requested.
        tolerance, residual: the requested residual, and the largest one that was reached (None if one is not finite).
        discretization_error: estimated error due to the mesh; None if it is unknown.
        mesh_size: sides of the triangles over the width of the finest beams; `corner_size` is the ratio at corners.
        nodes, triangles: numbers for the mesh; `unknowns` is that of the largest system that was solved.
        effects, cost: what ran, and the bill of the computation.
    """

    states: Tuple[PartState, ...]
    supports: Annotated[Tuple[PartSupport, ...], At(read=_read_supports)]
    message: str
    fixed_translation: bool
    size: Annotated[Tuple[float, float, float], At("/part/")]
    solid_area: Annotated[float, At("/part/")]
    relative_density: Annotated[float, At("/part/")]
    missing_solids: Annotated[Tuple[str, ...], At("/part/")]
    part_message: Annotated[str, At("/part/message")]
    mesh: Optional[PartMesh]
    tolerance: Annotated[float, ACCURACY]
    residual: Annotated[Optional[float], ACCURACY]
    discretization_error: Annotated[Optional[PartMeshError], ACCURACY]
    mesh_size: Annotated[float, ACCURACY]
    corner_size: Annotated[float, ACCURACY]
    nodes: Annotated[int, ACCURACY]
    triangles: Annotated[int, ACCURACY]
    unknowns: Annotated[int, ACCURACY]
    effects: Tuple[Effect, ...]
    cost: Cost

    @property
    def converged(self) -> bool:
        """Whether every state was reached."""
        return not self.message and all(state.converged for state in self.states)

    @property
    def share(self) -> Array:
        """Fraction of the supports' displacements in each state, shape (n,)."""
        return np.array([state.share for state in self.states])

    @property
    def forces(self) -> Array:
        """Force of each support on the part in each state, shape (n, m, 2), N."""
        return np.array([[support.force for support in state.supports] for state in self.states])

    @property
    def displacements(self) -> Array:
        """Displacement of each support in each state, shape (n, m, 2), mm."""
        return np.array([[support.displacement for support in state.supports] for state in self.states])

    @property
    def energy(self) -> Array:
        """Elastic energy of each state, shape (n,), N mm."""
        return np.array([state.energy for state in self.states])

    @property
    def largest_strain(self) -> Array:
        """The largest |principal stretch - 1| of each state, shape (n,)."""
        return np.array([state.largest_strain for state in self.states])

    @property
    def moving(self) -> int:
        """Index of the support that moves farthest; of several the last one."""
        lengths = [float(np.linalg.norm(_motion(support))) for support in self.supports]
        return len(lengths) - 1 - int(np.argmax(lengths[::-1]))

    @property
    def displacement(self) -> Array:
        """Distance that the support `moving` has moved in each state, shape (n,), mm."""
        return np.asarray(np.linalg.norm(self.displacements[:, self.moving], axis=1), dtype=np.float64)

    @property
    def force(self) -> Array:
        """Force of the support `moving` along its motion in each state, shape (n,), N. It is positive if the support does work."""
        motion = _motion(self.supports[self.moving])
        length = float(np.linalg.norm(motion))
        along = motion / length if length > 0 else np.array([0.0, 1.0])
        return np.asarray(self.forces[:, self.moving] @ along, dtype=np.float64)

    def _drawing(self) -> Optional[Drawing]:
        if not self.states:
            return None
        from_rest = [np.concatenate([[0.0], values]) for values in (self.displacement, self.force)]
        title = f"{self.size[0]:.6g} x {self.size[1]:.6g} x {self.size[2]:.6g} mm"
        return Drawing("curves", (curve(*from_rest),), (), title, "displacement / mm", "force / N")

    def plot_state(self, state: int = -1, ax: Optional[Any] = None) -> Any:
        """Draws the deformed part of a state with matplotlib, coloured by strain, into the axes `ax` or into new ones, and returns
        them. Colours reach to the strain that 99 of 100 triangles do not exceed.

        Raises `ImportError` if matplotlib is not installed, and `ValueError` unless deformed="json" was requested.
        """
        deformed = self.states[state].deformed
        if deformed is None or self.mesh is None:
            raise ValueError('this PartSimulation has no deformed parts: request them with deformed="json"')
        full = max(float(np.quantile(deformed.strains, 0.99)), 1e-6)
        places = np.minimum(deformed.strains / full * len(STRAIN_COLORS), len(STRAIN_COLORS) - 1).astype(int)
        order = [0, 3, 1, 4, 2, 5]
        areas = tuple(Area((deformed.points[corners[order]],), STRAIN_COLORS[place])
                      for corners, place in zip(self.mesh.triangles, places))
        return to_matplotlib(Drawing("map", (), areas, title=f"strain from 0 to {100 * full:.3g} % and more"), ax)


def _written_part(part: PartRequest, name: str) -> Any:
    """The JSON of a part without what its simulation does not take: the material is said beside it."""
    document = part.to_wire()
    for unused in ("material", "deadline", "priority"):
        document.pop(unused, None)
    return document


@dataclass(frozen=True)
class _PartSimulationFields(Sent):
    """The fields of both requests."""

    part: Annotated[PartRequest, At(write=_written_part)]
    supports: Sequence[PartSupport] = ()
    strain: Annotated[Optional[Number], RATIO] = None
    material: Annotated[Optional[Mapping[str, Any]], At(write=written_material)] = None
    states: Optional[int] = None
    mesh_size: Annotated[Optional[float], ACCURACY] = None
    corner_size: Annotated[Optional[float], ACCURACY] = None
    tolerance: Annotated[Optional[float], ACCURACY] = None
    max_iterations: Annotated[Optional[int], ACCURACY] = None
    max_load_step: Annotated[Optional[float], ACCURACY] = None
    pressure_length: Annotated[Optional[Number], ACCURACY, LENGTH] = None
    contact: Annotated[Optional[str], EFFECT] = None
    buckling: Annotated[Optional[str], EFFECT] = None
    error_estimate: Annotated[Optional[str], EFFECT] = None
    deformed: str = "none"
    svg: bool = False
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class PartSimulationRequest(_PartSimulationFields, Request[PartSimulation], path="/v1/part-simulations"):
    """The states of a part whose supports move: `client.part_simulation(supple.PartRequest(supple.parts.block(30, 20), "IH21"))`.

    Attributes:
        part: the part, as `Client.part` takes it; its density, deadline, progress and priority are not used.
        supports: `Plate` and `Clamp`. Without them a coupon is clamped at its grips and a block lies between two plates without
            friction, and the upper support moves along y.
        strain: without supports, by how much the structure of a coupon or a block is stretched at the end. 0.2 of a coupon, -0.2
            of a block.
        material: "law", "youngs_modulus" (MPa) and "poisson_ratio"; a neo-Hookean law with 26 MPa and 0.48 by default.
        states: number of states, evenly along the path. 10 by default.
        mesh_size: sides of the triangles over the width of the finest beams. 0.5 by default.
        corner_size: sides at re-entrant corners over those elsewhere. 0.1 by default.
        tolerance: relative residual of an equilibrium. 1e-8 by default.
        max_iterations: Newton iterations for one load step before it is halved. 60 by default.
        max_load_step: largest motion of a support in one internal load step, over the length of the part. 0.05 by default.
        pressure_length: length along a plate over which its pressure is averaged, mm. 1 by default.
        contact, buckling: "on", "off" or "automatic".
        error_estimate: "on" follows the path once more on a mesh of twice the size, which tells what the mesh makes of error;
            "automatic" does so for meshes of at most 100,000 nodes, "off" never.
        deformed: "json" for the deformed points and the strains of each state, "obj" or "vtu" for files, "none".
        svg: whether each state has a picture of the deformed part.

    A path that cannot be followed to its end raises no exception: see `PartSimulation.message`. Supports that the part cannot have
    raise `InvalidRequest`, whose `faults` name the support and the limit; a mesh that needs more memory than the server permits
    is refused before it is made. The time grows somewhat faster than the number of nodes, times the load steps (docs/parts.md). The
    `status().partial` of its job is the latest state (`PartialPartState`).
    """


@dataclass(frozen=True)
class PartSimulationFileRequest(_PartSimulationFields, FileRequest, path="/v1/part-simulations"):
    """The same simulation as a file: `kind` is "csv" (the displacements and forces of all states), or "svg", "obj" or "vtu" for the
    deformed part of the last state. The arguments are those of `PartSimulationRequest`."""

    TYPES = {"csv": "text/csv", "svg": "image/svg+xml", "obj": "model/obj", "vtu": "application/x-vtu+xml"}
    kind: Kind = "csv"
