"""Jobs: computations that run on the server in the background."""

from __future__ import annotations

import contextlib
import time
import uuid
from dataclasses import dataclass
from typing import Any, Callable, Dict, Generic, Mapping, Optional, TypeVar, Union

from .design_answers import PartialDesign, PartialRound, partial_from_wire
from .errors import RequestTimeout, SuppleError
from .network_answers import PartialRelaxation, partial_relaxation_from_wire
from .progress import Progress as Progress
from .progress import Reporter
from .transport import Answer, Transport
from .voronoi_answers import PartialOptimization, partial_optimization_from_wire

Result = TypeVar("Result")
Partial = Union[PartialDesign, PartialRound, PartialRelaxation, PartialOptimization]
"""An intermediate result of a job."""

FIRST_POLL_INTERVAL = 0.05
MAX_POLL_INTERVAL = 1.0
"""Seconds between two requests for a job's status: the interval doubles from the first value up to the second."""

UNFINISHED = frozenset({"accepted", "running"})


@dataclass(frozen=True)
class JobStatus:
    """The status of a job.

    Attributes:
        id: its identifier, as in /v1/jobs/{id}.
        state: "accepted", "running", "successful", "failed" or "dismissed".
        kind: the computation, such as "karcher-means" or "simulations".
        mesh: id of its mesh; None if the computation uses none.
        progress: fraction of the work that is done, in [0, 1].
        stage: the current stage; empty if nothing runs.
        created: when the job was accepted, RFC 3339 in UTC.
        partial: an intermediate result. While designs are searched it is the best one so far, and then the structure that was
            simulated last. For a network or an optimized Voronoi diagram it is the state after the latest iteration. None for
            other computations.
    """

    id: str
    state: str
    kind: str
    mesh: Optional[str]
    progress: float
    stage: str
    created: str
    partial: Optional[Partial] = None

    @property
    def finished(self) -> bool:
        return self.state not in UNFINISHED


def _partial(document: Mapping[str, Any]) -> Optional[Partial]:
    partial = document.get("partial")
    if partial is None:
        return None
    if document["kind"] == "embedded-systems":
        return partial_relaxation_from_wire(partial)
    if document["kind"] == "voronoi-optimizations":
        return partial_optimization_from_wire(partial)
    return partial_from_wire(partial)


def status_from_wire(document: Mapping[str, Any]) -> JobStatus:
    return JobStatus(
        id=str(document["id"]),
        state=str(document["state"]),
        kind=str(document["kind"]),
        mesh=document.get("mesh"),
        progress=float(document["progress"]),
        stage=str(document["stage"]),
        created=str(document["created"]),
        partial=_partial(document),
    )


@dataclass(frozen=True)
class Computation(Generic[Result]):
    """A request and the function that decodes its answer. Internal: see the methods of `Mesh` and `Client`."""

    path: str
    document: Dict[str, Any]
    decode: Callable[[Answer], Result]
    accept: str = "application/json"


class Job(Generic[Result]):
    """A computation on the server.

    The server owns the job: closing a `Client` does not end it, and `client.job(id)` returns it again.
    """

    def __init__(self, transport: Transport, job_id: str, decode: Callable[[Answer], Result], accept: str) -> None:
        self._transport = transport
        self._path = f"/v1/jobs/{job_id}"
        self._decode = decode
        self._accept = accept
        self.id = job_id

    def __repr__(self) -> str:
        return f"Job({self.id!r})"

    def status(self) -> JobStatus:
        return status_from_wire(self._transport.request("GET", self._path).json())

    def cancel(self) -> None:
        """Ends the job if it has not finished; its later `result` raises `JobCancelled`."""
        self._transport.request("DELETE", self._path)

    def wait(self, *, timeout: Optional[float] = None, progress: Optional[Progress] = None) -> JobStatus:
        """Returns once the job has finished, whether successfully or not.

        Raises `RequestTimeout` after `timeout` seconds. Neither that nor an exception from `progress`, which reaches the
        caller, ends the job.
        """
        end = None if timeout is None else time.monotonic() + timeout
        pause = FIRST_POLL_INTERVAL
        with Reporter(self._transport.progress if progress is None else progress) as report:
            while True:
                status = self.status()
                report(status.progress, status.stage)
                if status.finished:
                    return status
                if end is not None and time.monotonic() + pause > end:
                    raise RequestTimeout(f"job {self.id} is {status.state} after {timeout} s")
                time.sleep(pause)
                pause = min(2 * pause, MAX_POLL_INTERVAL)

    def result(self, *, timeout: Optional[float] = None, progress: Optional[Progress] = None) -> Result:
        """Waits and returns the result. Raises a `ProblemError` if the computation failed."""
        self.wait(timeout=timeout, progress=progress)
        return self._decode(self._transport.request("GET", self._path + "/result", headers={"Accept": self._accept}))


def submit(transport: Transport, computation: Computation[Result]) -> Job[Result]:
    """Submits a computation to the server as a job."""
    answer = transport.request(
        "POST",
        computation.path,
        document=computation.document,
        headers={"Accept": computation.accept, "Prefer": "respond-async", "Idempotency-Key": uuid.uuid4().hex},
        repeatable=True,
    )
    return Job(transport, _job_id(answer), computation.decode, computation.accept)


def run(
    transport: Transport, computation: Computation[Result], timeout: Optional[float], progress: Optional[Progress]
) -> Result:
    """Computes and returns the result. A computation that takes longer than a second becomes a job, which is followed.

    Anything that interrupts the wait (a timeout, Ctrl-C, an exception from `progress`) cancels the computation on the server.
    """
    answer = transport.request(
        "POST",
        computation.path,
        document=computation.document,
        headers={"Accept": computation.accept, "Prefer": "wait=1", "Idempotency-Key": uuid.uuid4().hex},
        repeatable=True,
    )
    if answer.status != 202:
        # An immediate answer needs no bar.
        if callable(progress):
            progress(1.0, "")
        return computation.decode(answer)
    job = Job(transport, _job_id(answer), computation.decode, computation.accept)
    try:
        return job.result(timeout=timeout, progress=progress)
    except BaseException:
        with contextlib.suppress(SuppleError):
            if not job.status().finished:
                job.cancel()
        raise


def _job_id(answer: Answer) -> str:
    return answer.headers["Location"].rstrip("/").rsplit("/", 1)[-1]
