"""Networks of families of one's own: what their training takes, and the training as a job."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Optional

from ._arrays import Array, Indices
from .answers import Cost
from .request import Deadline, Reported, Request, Timeout
from .shown import Shown
from .units import DURATION, RATIO, Number
from .wire import At


@dataclass(frozen=True, repr=False)
class TrainingPlan(Shown):
    """What a training of a network takes.

    Attributes:
        family: its id.
        simulation_seconds, training_seconds: core-seconds of the plan.
        designs: number of designs that are simulated.
        chosen_designs: number of those that a committee of small networks chooses.
    """

    family: str
    simulation_seconds: Annotated[float, At("/estimate/simulation")]
    training_seconds: Annotated[float, At("/estimate/training")]
    designs: Annotated[int, At("/estimate/designs")]
    chosen_designs: Annotated[int, At("/estimate/chosen_designs")]
    cost: Cost


@dataclass(frozen=True, repr=False)
class PartialTraining(Shown):
    """The errors that a running training has reached, in their order.

    Attributes:
        family: its id.
        designs: designs that were simulated by then, shape (n,).
        errors: mean relative errors of the stress on designs that were held out, shape (n,).
    """

    family: str
    designs: Annotated[Indices, At("/errors/*/designs")]
    errors: Annotated[Array, At("/errors/*/error")]


@dataclass(frozen=True, repr=False)
class Training(Shown):
    """A finished training.

    Attributes:
        model: id of the model, which designs of the family use from now on.
        family: its id.
        error: mean relative error of the stress on designs that were held out.
        designs: number of designs that were simulated.
        error_designs, errors: designs that were simulated, shape (n,), when networks were judged, and the errors that were measured, shape (n,).
            The last error is that of the network, the others are those of the committees that choose designs.
        simulation_seconds, training_seconds: core-seconds of the plan.
    """

    model: str
    family: str
    error: float
    designs: int
    error_designs: Annotated[Indices, At("/errors/*/designs")]
    errors: Annotated[Array, At("/errors/*/error")]
    simulation_seconds: Annotated[float, At("/estimate/simulation")]
    training_seconds: Annotated[float, At("/estimate/training")]
    cost: Cost


@dataclass(frozen=True)
class TrainingPlanRequest(Request[TrainingPlan], path="/v1/training-plans"):
    """Plans the training of a network, by the time of four designs. A budget that does not suffice raises an error that says which does.

    Attributes:
        family: id of a family of the server or of one's own.
        core_seconds: seconds of one core for all simulations and trainings, 60 to 1e7, or a text with a unit like "5h".
        error: mean error at which no more designs are simulated, 0 to 0.5, or a text like "2%"; None never ends earlier.
        seed: of the designs and loads; None takes 1.
    """

    family: str
    core_seconds: Annotated[Number, At("/budget/core_seconds"), DURATION]
    error: Annotated[Optional[Number], At("/accuracy/error"), RATIO] = None
    seed: Optional[int] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None


@dataclass(frozen=True)
class TrainingRequest(Request[Training], path="/v1/trainings"):
    """Trains a network of a family: simulates, chooses designs, trains, and serves the model. The same request goes on where an earlier
    one was stopped.

    Attributes:
        family, core_seconds, error, seed: as in `TrainingPlanRequest`.
    """

    family: str
    core_seconds: Annotated[Number, At("/budget/core_seconds"), DURATION]
    error: Annotated[Optional[Number], At("/accuracy/error"), RATIO] = None
    seed: Optional[int] = None
    deadline: Deadline = None
    timeout: Timeout = None
    progress: Reported = None
    priority: Optional[str] = None
