"""Neural models of structures, and their answers as dataclasses and numpy arrays.

A model of a family of structures gives energy density, stress and tangent stiffness for tiling parameters and Green strains
without a simulation. Strains and stresses are (xx, yy, xy), tensor components; stresses, tangents and energy densities are
in MPa, per rest area of the whole cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Dict, Optional
from urllib.parse import quote

import numpy as np
from numpy.typing import ArrayLike

from ._arrays import Array, Flags, Indices, Numbers, Positions
from .answers import Cost
from .calls import named, runs_here, submits_here
from .checks import radians
from .drawing import Drawing, curve, error_band
from .request import Deadline, OfModel, Reported, Request, Resource, Result, Timeout, id_of
from .shown import Drawn, Shown
from .transport import Transport
from .units import ANGLE, RATIO, Number
from .wire import ACCURACY, At, Shape


@dataclass(frozen=True, repr=False)
class ErrorStatistics(Shown):
    """Relative errors |x - x*| / |x*| over samples, where x* is the simulated value."""

    mean: float
    root_mean_square: float
    median: float
    percentile_99: float


@dataclass(frozen=True, repr=False)
class SplitErrors(Shown):
    """Errors on samples that the model was not trained on.

    Attributes:
        gradient: errors of the stress, in the Euclidean norm of (S_xx, S_yy, S_xy).
        energy: errors of the energy density.
        designs, samples: numbers of designs and samples in the test.
    """

    gradient: ErrorStatistics
    energy: ErrorStatistics
    designs: int
    samples: int


@dataclass(frozen=True, repr=False)
class ModelInfo(Shown):
    """The description of a model.

    Attributes:
        id: its name, such as "ih21".
        family: id of the family of tilings.
        lower, upper: bounds of the parameters in its training data, shape (p,), dimensionless.
        smallest_principal, largest_principal: bounds of the principal Green strains in its training data.
        largest_relative_energy: greatest energy density in its training data, over the design's rest stiffness.
        design_split: errors on designs that were not in the training data at all; None if unknown.
        row_split: errors on other states of designs in the training data; None if unknown.
        error_bars: level, "judged_by" and, by quantity, the quality of the error bars of its answers; None if it has none.
        network: form, activation, width, numbers of layers and weights, and "corrects_mesh": whether it corrects the
            discretization error of its training data.
        provenance: data set, versions, seed and options, with which the model can be reproduced.
        youngs_modulus, poisson_ratio: those of the simulated solid; MPa and dimensionless.
        sha256: checksum of the model's file. A file with another one is another model, also under the same id.
    """

    id: str
    family: str
    lower: Annotated[Array, At("/parameters/lower")]
    upper: Annotated[Array, At("/parameters/upper")]
    smallest_principal: Annotated[float, At("/strain_range/")]
    largest_principal: Annotated[float, At("/strain_range/")]
    largest_relative_energy: Annotated[float, At("/strain_range/")]
    design_split: Annotated[Optional[SplitErrors], At("/errors/")]
    row_split: Annotated[Optional[SplitErrors], At("/errors/")]
    error_bars: Optional[Dict[str, Any]]
    network: Dict[str, Any]
    provenance: Dict[str, Any]
    youngs_modulus: Annotated[float, At("/material/")]
    poisson_ratio: Annotated[float, At("/material/")]
    sha256: str


@dataclass(frozen=True, repr=False)
class Evaluation(Shown):
    """The answer of a model for n strains.

    Attributes:
        energy_density: shape (n,), MPa.
        stress: second Piola-Kirchhoff (S_xx, S_yy, S_xy), shape (n, 3), MPa; None without derivatives.
        tangent: d (S_xx, S_yy, S_xy) / d (E_xx, E_yy, 2 E_xy), shape (n, 3, 3), MPa; None without second derivatives.
        stress_error_bar: bound of the Euclidean norm of the difference from the simulated stress in 90 of 100 cases, shape
            (n,), MPa; nan outside of what the model was trained on; None without derivatives, or if the model has no error
            bars.
        in_range: whether each strain is within what the model was trained on and, with derivatives, its error bar is at
            most 10 % of the stress, shape (n,).
        sha256: checksum of the model's file.
    """

    energy_density: Array
    stress: Optional[Positions]
    tangent: Optional[Annotated[Array, Shape(-1, 3, 3)]]
    stress_error_bar: Optional[Array]
    in_range: Flags
    sha256: str
    cost: Cost


@dataclass(frozen=True, repr=False)
class UniaxialCurve(Drawn):
    """Equilibria of a model under a uniaxial load along the direction d, at n states; lateral strain and shear are free.

    Attributes:
        direction: angle of d from the x axis, radians.
        green_strain: (E_xx, E_yy, E_xy), the free components included, shape (n, 3).
        stress: second Piola-Kirchhoff, shape (n, 3), MPa.
        directional_stress: d^T S d, shape (n,), MPa.
        error_bar: bound of the difference from the simulated directional stress in 90 of 100 cases, shape (n,), MPa; nan where
            it is unknown.
        energy_density: shape (n,), MPa.
        in_range: whether each state is within what the model was trained on and its error bar is at most 5 % of the stress,
            shape (n,).
        state_converged: whether each state is an equilibrium within the tolerance, shape (n,).
        residual: stress conjugate to the free strains over the largest stress, shape (n,); nan where a state has none.
        iterations: Newton iterations of each state, shape (n,).
        tolerance: the requested residual.
        sha256: checksum of the model's file.
    """

    direction: float
    green_strain: Annotated[Positions, At("/states/*/")]
    stress: Annotated[Positions, At("/states/*/")]
    directional_stress: Annotated[Array, At("/states/*/")]
    error_bar: Annotated[Array, At("/states/*/")]
    energy_density: Annotated[Array, At("/states/*/")]
    in_range: Annotated[Flags, At("/states/*/")]
    state_converged: Annotated[Flags, At("/states/*/converged")]
    residual: Annotated[Array, At("/states/*/")]
    iterations: Annotated[Indices, At("/states/*/")]
    tolerance: Annotated[float, ACCURACY]
    sha256: str
    cost: Cost

    @property
    def converged(self) -> bool:
        """Whether every state is an equilibrium within the tolerance."""
        return bool(self.state_converged.all())

    def _drawing(self) -> Drawing:
        c, s = np.cos(self.direction), np.sin(self.direction)
        strain = self.green_strain @ [c * c, s * s, 2 * c * s]
        title = f"uniaxial load along {np.degrees(self.direction):.4g} degrees"
        line = curve(strain, self.directional_stress, label="neural model")
        return Drawing("curves", (line,), (), title, "Green strain along the load", "stress along the load / MPa",
                       error_band(strain, self.directional_stress, self.error_bar))


def _rows(columns: Optional[int]) -> At:
    """The place of rows of numbers. A single row may lack the first axis."""

    def write(values: ArrayLike, name: str) -> Any:
        array = np.atleast_2d(np.asarray(values, dtype=np.float64))
        if array.ndim != 2 or 0 in array.shape or columns not in (None, array.shape[1]):
            expected = "(n, p)" if columns is None else f"(n, {columns})"
            raise ValueError(f"{name} has the shape {np.shape(values)}; expected {expected} or one row of it")
        return array.tolist()

    return At(write=write)


class _ModelRequest(Request[Result]):
    """A request to a model, whose id is part of the path."""

    model: OfModel

    def url(self) -> str:
        return self.path.format(model=quote(id_of(self.model), safe=""))


@dataclass(frozen=True)
class EvaluationRequest(_ModelRequest[Evaluation], path="/v1/models/{model}/evaluations"):
    """Energy density, stress and tangent of n strains.

    Attributes:
        model: the model, or its id.
        parameters: one design for all strains, shape (p,), or one for each, shape (n, p); dimensionless. Equal designs in
            succession cost less.
        green_strain: (E_xx, E_yy, E_xy), tensor components, shape (3,) or (n, 3).
        derivatives: 0 for energies, 1 for stresses too, 2 for tangents too.

    Strains and parameters outside of the training data are permitted: see `Evaluation.in_range`.
    """

    model: OfModel
    parameters: Annotated[ArrayLike, _rows(None)]
    green_strain: Annotated[ArrayLike, _rows(3), RATIO]
    derivatives: int = 1
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class UniaxialRequest(_ModelRequest[UniaxialCurve], path="/v1/models/{model}/uniaxial"):
    """Equilibria along a direction. The search for each one starts at the one before, and for the first one at rest.

    Attributes:
        model: the model, or its id.
        parameters: parameters of the design, shape (p,), dimensionless.
        direction: angle of the load from the x axis, radians.
        stretches: length over rest length along the direction, shape (n,).
        green_strains: Green strains along the direction instead of stretches, shape (n,), above -0.5.
        tolerance: relative residual of an equilibrium. 1e-10 by default.
        max_iterations: Newton iterations for one state. 50 by default.

    A state that is not reached raises no exception: see `UniaxialCurve.state_converged`.
    """

    model: OfModel
    parameters: Numbers
    direction: Annotated[Number, ANGLE]
    stretches: Annotated[Optional[Numbers], RATIO] = None
    green_strains: Annotated[Optional[Numbers], RATIO] = None
    tolerance: Annotated[Optional[float], ACCURACY] = None
    max_iterations: Annotated[Optional[int], ACCURACY] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None

    def __post_init__(self) -> None:
        super().__post_init__()
        radians(self.direction, "direction")
        if (self.stretches is None) == (self.green_strains is None):
            raise ValueError("a uniaxial load is given by stretches or by green_strains, one of the two")


@named
class Model(Resource):
    """A model on a server. `Client.model` and `Client.models` create it.

    Its file may be replaced on the server at any time; `Evaluation.sha256` identifies the one that was used. The arguments of its
    methods are the fields of `EvaluationRequest` and `UniaxialRequest` after the model.
    """

    def __init__(self, transport: Transport, info: ModelInfo) -> None:
        self._transport = transport
        self.info = info

    def __repr__(self) -> str:
        return f"Model({self.id!r}, family {self.info.family!r}, {len(self.info.lower)} parameters)"

    @property
    def id(self) -> str:
        return self.info.id

    evaluate = runs_here(EvaluationRequest)
    start_evaluation = submits_here(EvaluationRequest)
    uniaxial = runs_here(UniaxialRequest)
    start_uniaxial = submits_here(UniaxialRequest)
