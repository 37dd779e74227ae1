"""Neural models of structures, and their answers as dataclasses and numpy arrays.

A model of a family of structures gives energy density, stress and tangent stiffness for tiling parameters and Green strains
without a simulation. Strains and stresses are (xx, yy, xy), tensor components; stresses, tangents and energy densities are
in MPa, per rest area of the whole cell.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .answers import Array, Cost, cost_from_wire
from .checks import radians
from .drawing import Drawing, curve
from .jobs import Computation, Job, Progress, run, submit
from .shown import Drawn, Shown
from .transport import Transport

Flags = NDArray[np.bool_]


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
    lower: Array
    upper: Array
    smallest_principal: float
    largest_principal: float
    largest_relative_energy: float
    design_split: Optional[SplitErrors]
    row_split: Optional[SplitErrors]
    error_bars: Optional[Dict[str, Any]]
    network: Dict[str, Any]
    provenance: Dict[str, Any]
    youngs_modulus: float
    poisson_ratio: float
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
    stress: Optional[Array]
    tangent: Optional[Array]
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
    green_strain: Array
    stress: Array
    directional_stress: Array
    error_bar: Array
    energy_density: Array
    in_range: Flags
    state_converged: Flags
    residual: Array
    iterations: NDArray[np.int64]
    tolerance: float
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
        return Drawing("curves", (line,), (), title, "Green strain along the load", "stress along the load / MPa")


class Model:
    """A model on a server. `Client.model` and `Client.models` create it.

    Its file may be replaced on the server at any time; `Evaluation.sha256` identifies the one that was used. `deadline` bounds
    the computation on the server (seconds; `DeadlineExceeded`), `timeout` the wait for it (`RequestTimeout`).
    """

    def __init__(self, transport: Transport, info: ModelInfo) -> None:
        self._transport = transport
        self.info = info

    def __repr__(self) -> str:
        return f"Model({self.id!r}, family {self.info.family!r}, {len(self.info.lower)} parameters)"

    @property
    def id(self) -> str:
        return self.info.id

    def evaluate(
        self,
        parameters: ArrayLike,
        green_strain: ArrayLike,
        derivatives: int = 1,
        *,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> Evaluation:
        """Energy density, stress and tangent of n strains.

        Args:
            parameters: one design for all strains, shape (p,), or one for each, shape (n, p); dimensionless. Equal designs in
                succession cost less.
            green_strain: (E_xx, E_yy, E_xy), tensor components, shape (3,) or (n, 3).
            derivatives: 0 for energies, 1 for stresses too, 2 for tangents too.

        Strains and parameters outside of the training data are permitted: see `Evaluation.in_range`.
        """
        computation = evaluation(self.id, parameters, green_strain, derivatives, deadline)
        return run(self._transport, computation, timeout, progress)

    def start_evaluation(
        self,
        parameters: ArrayLike,
        green_strain: ArrayLike,
        derivatives: int = 1,
        *,
        deadline: Optional[float] = None,
    ) -> Job[Evaluation]:
        """`evaluate` as a job."""
        return submit(self._transport, evaluation(self.id, parameters, green_strain, derivatives, deadline))

    def uniaxial(
        self,
        parameters: Sequence[float],
        direction: float,
        *,
        stretches: Optional[Sequence[float]] = None,
        green_strains: Optional[Sequence[float]] = None,
        tolerance: Optional[float] = None,
        max_iterations: Optional[int] = None,
        deadline: Optional[float] = None,
        timeout: Optional[float] = None,
        progress: Optional[Progress] = None,
    ) -> UniaxialCurve:
        """Equilibria along a direction. The search for each one starts at the one before, and for the first one at rest.

        Args:
            parameters: parameters of the design, shape (p,), dimensionless.
            direction: angle of the load from the x axis, radians.
            stretches: length over rest length along the direction, shape (n,).
            green_strains: Green strains along the direction instead of stretches, shape (n,), above -0.5.
            tolerance: relative residual of an equilibrium. 1e-10 by default.
            max_iterations: Newton iterations for one state. 50 by default.

        A state that is not reached raises no exception: see `UniaxialCurve.state_converged`.
        """
        computation = uniaxial(
            self.id, parameters, direction, stretches, green_strains, tolerance, max_iterations, deadline
        )
        return run(self._transport, computation, timeout, progress)

    def start_uniaxial(
        self,
        parameters: Sequence[float],
        direction: float,
        *,
        stretches: Optional[Sequence[float]] = None,
        green_strains: Optional[Sequence[float]] = None,
        tolerance: Optional[float] = None,
        max_iterations: Optional[int] = None,
        deadline: Optional[float] = None,
    ) -> Job[UniaxialCurve]:
        """`uniaxial` as a job."""
        computation = uniaxial(
            self.id, parameters, direction, stretches, green_strains, tolerance, max_iterations, deadline
        )
        return submit(self._transport, computation)


def _array(values: Any) -> Array:
    return np.asarray(values, dtype=np.float64)


def _statistics(document: Mapping[str, Any]) -> ErrorStatistics:
    return ErrorStatistics(
        mean=float(document["mean"]),
        root_mean_square=float(document["root_mean_square"]),
        median=float(document["median"]),
        percentile_99=float(document["percentile_99"]),
    )


def _split(document: Optional[Mapping[str, Any]]) -> Optional[SplitErrors]:
    if document is None:
        return None
    return SplitErrors(
        gradient=_statistics(document["gradient"]),
        energy=_statistics(document["energy"]),
        designs=int(document["designs"]),
        samples=int(document["samples"]),
    )


def model_info_from_wire(document: Mapping[str, Any]) -> ModelInfo:
    parameters, strains = document["parameters"], document["strain_range"]
    return ModelInfo(
        id=str(document["id"]),
        family=str(document["family"]),
        lower=_array(parameters["lower"]),
        upper=_array(parameters["upper"]),
        smallest_principal=float(strains["smallest_principal"]),
        largest_principal=float(strains["largest_principal"]),
        largest_relative_energy=float(strains["largest_relative_energy"]),
        design_split=_split(document["errors"]["design_split"]),
        row_split=_split(document["errors"]["row_split"]),
        error_bars=None if document["error_bars"] is None else dict(document["error_bars"]),
        network=dict(document["network"]),
        provenance=dict(document["provenance"]),
        youngs_modulus=float(document["material"]["youngs_modulus"]),
        poisson_ratio=float(document["material"]["poisson_ratio"]),
        sha256=str(document["sha256"]),
    )


def _optional_bars(values: Optional[Sequence[Optional[float]]]) -> Optional[Array]:
    return None if values is None else _array([np.nan if bar is None else bar for bar in values])


def evaluation_from_wire(document: Mapping[str, Any]) -> Evaluation:
    return Evaluation(
        energy_density=_array(document["energy_density"]),
        stress=_array(document["stress"]).reshape(-1, 3) if "stress" in document else None,
        tangent=_array(document["tangent"]).reshape(-1, 3, 3) if "tangent" in document else None,
        stress_error_bar=_optional_bars(document.get("stress_error_bar")),
        in_range=np.asarray(document["in_range"], dtype=np.bool_),
        sha256=str(document["sha256"]),
        cost=cost_from_wire(document["cost"]),
    )


def uniaxial_from_wire(document: Mapping[str, Any]) -> UniaxialCurve:
    states: List[Mapping[str, Any]] = document["states"]

    def column(name: str) -> List[Any]:
        return [state[name] for state in states]

    residuals = [np.nan if residual is None else residual for residual in column("residual")]
    return UniaxialCurve(
        direction=float(document["direction"]),
        green_strain=_array(column("green_strain")).reshape(-1, 3),
        stress=_array(column("stress")).reshape(-1, 3),
        directional_stress=_array(column("directional_stress")),
        error_bar=_array([np.nan if bar is None else bar for bar in column("error_bar")]),
        energy_density=_array(column("energy_density")),
        in_range=np.asarray(column("in_range"), dtype=np.bool_),
        state_converged=np.asarray(column("converged"), dtype=np.bool_),
        residual=_array(residuals),
        iterations=np.asarray(column("iterations"), dtype=np.int64),
        tolerance=float(document["accuracy"]["tolerance"]),
        sha256=str(document["sha256"]),
        cost=cost_from_wire(document["cost"]),
    )


def _rows(name: str, values: ArrayLike, columns: Optional[int]) -> Array:
    """The values as an array of shape (n, columns). A single row may lack the first axis."""
    array = np.atleast_2d(_array(values))
    if array.ndim != 2 or 0 in array.shape or columns not in (None, array.shape[1]):
        expected = "(n, p)" if columns is None else f"(n, {columns})"
        raise ValueError(f"{name} has the shape {np.shape(values)}; expected {expected} or one row of it")
    return array


def evaluation(
    model: str, parameters: ArrayLike, green_strain: ArrayLike, derivatives: int, deadline: Optional[float]
) -> Computation[Evaluation]:
    document: Dict[str, Any] = {
        "parameters": _rows("parameters", parameters, None).tolist(),
        "green_strain": _rows("green_strain", green_strain, 3).tolist(),
        "derivatives": int(derivatives),
    }
    if deadline is not None:
        document["deadline"] = deadline
    return Computation(
        f"/v1/models/{model}/evaluations", document, lambda answer: evaluation_from_wire(answer.json())
    )


def uniaxial(
    model: str,
    parameters: Sequence[float],
    direction: float,
    stretches: Optional[Sequence[float]],
    green_strains: Optional[Sequence[float]],
    tolerance: Optional[float],
    max_iterations: Optional[int],
    deadline: Optional[float],
) -> Computation[UniaxialCurve]:
    given: Tuple[Tuple[str, Optional[Sequence[float]]], ...] = (
        ("stretches", stretches),
        ("green_strains", green_strains),
    )
    load = {name: [float(value) for value in values] for name, values in given if values is not None}
    if len(load) != 1:
        raise ValueError("a uniaxial load is given by stretches or by green_strains, one of the two")
    accuracy = {"tolerance": tolerance, "max_iterations": max_iterations}
    document: Dict[str, Any] = {
        "parameters": [float(parameter) for parameter in parameters],
        "direction": radians(direction, "direction"),
        **load,
        "accuracy": {name: value for name, value in accuracy.items() if value is not None},
    }
    if deadline is not None:
        document["deadline"] = deadline
    return Computation(f"/v1/models/{model}/uniaxial", document, lambda answer: uniaxial_from_wire(answer.json()))
