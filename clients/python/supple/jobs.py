"""Jobs: computations that the server runs while the caller does something else."""

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
"""What a job has found so far."""

FIRST_POLL = 0.05
LONGEST_POLL = 1.0
"""Seconds between two looks at a job: the pause starts at the first and doubles up to the second."""

UNFINISHED = frozenset({"accepted", "running"})


@dataclass(frozen=True)
class JobStatus:
    """How far a job is.

    Attributes:
        id: names the job in /v1/jobs/{id}.
        state: "accepted", "running", "successful", "failed" or "dismissed".
        kind: the computation, such as "karcher-means" or "simulations".
        mesh: id of the mesh that it works on; None where it works on none.
        progress: share of the work that is done, in [0, 1].
        stage: what runs now; empty where nothing does.
        created: when the job was accepted, RFC 3339 in UTC.
        partial: the best design so far while designs are being searched for, then the structure that was simulated last; of
            a network that is relaxed or a Voronoi diagram that is optimized, its state after the latest iteration; None
            elsewhere.
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
    """A request that is ready to be sent and what makes its answer a value. Internal: see the methods of `Mesh` and `Client`."""

    path: str
    document: Dict[str, Any]
    decode: Callable[[Answer], Result]
    accept: str = "application/json"


class Job(Generic[Result]):
    """A computation on the server.

    The job belongs to the server: leaving a `Client` does not end it. `client.job(id)` finds it again.
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
        """Returns once the job has finished, however it ended.

        Raises `RequestTimeout` after `timeout` seconds; the job goes on. An exception from `progress` reaches the caller
        and leaves the job running too.
        """
        end = None if timeout is None else time.monotonic() + timeout
        pause = FIRST_POLL
        with Reporter(self._transport.progress if progress is None else progress) as report:
            while True:
                status = self.status()
                report(status.progress, status.stage)
                if status.finished:
                    return status
                if end is not None and time.monotonic() + pause > end:
                    raise RequestTimeout(f"job {self.id} is {status.state} after {timeout} s")
                time.sleep(pause)
                pause = min(2 * pause, LONGEST_POLL)

    def result(self, *, timeout: Optional[float] = None, progress: Optional[Progress] = None) -> Result:
        """Waits and returns the result. Raises what the computation failed with, as a `ProblemError`."""
        self.wait(timeout=timeout, progress=progress)
        return self._decode(self._transport.request("GET", self._path + "/result", headers={"Accept": self._accept}))


def submit(transport: Transport, computation: Computation[Result]) -> Job[Result]:
    """Hands a computation to the server as a job."""
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
    """Computes and returns the result, at once or by way of a job where it takes longer than a second.

    Whatever interrupts the wait (a timeout, Ctrl-C, an exception from `progress`) cancels the computation on the server.
    """
    answer = transport.request(
        "POST",
        computation.path,
        document=computation.document,
        headers={"Accept": computation.accept, "Prefer": "wait=1", "Idempotency-Key": uuid.uuid4().hex},
        repeatable=True,
    )
    if answer.status != 202:
        # An answer that came at once needs no bar.
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
