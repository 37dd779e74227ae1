"""Jobs: computations that run on the server in the background."""

from __future__ import annotations

import contextlib
import time
import uuid
from dataclasses import dataclass
from typing import Annotated, Any, Generic, Mapping, Optional, TypeVar, Union
from urllib.parse import quote

from .design_answers import PartialDesign, PartialRound
from .errors import RequestTimeout, SuppleError
from .network_answers import PartialRelaxation
from .part_simulations import PartialPartState
from .progress import Progress, Reporter
from .request import Request
from .rounds import Rounds
from .trainings import PartialTraining
from .transport import Answer, Transport
from .units import Number, without_unit
from .voronoi_answers import PartialOptimization
from .wire import At, decode

Result = TypeVar("Result")
Partial = Union[PartialDesign, PartialRound, PartialRelaxation, PartialOptimization, PartialPartState, PartialTraining]
"""An intermediate result of a job."""

FIRST_POLL_INTERVAL = 0.05
MAX_POLL_INTERVAL = 1.0
"""Seconds between two requests for a job's status: the interval doubles from the first value up to the second."""

UNFINISHED = frozenset({"accepted", "running"})


def _partial(job: Mapping[str, Any]) -> Optional[Partial]:
    partial = job.get("partial")
    if partial is None:
        return None
    if job["kind"] == "embedded-systems":
        return decode(PartialRelaxation, partial)
    if job["kind"] == "voronoi-optimizations":
        return decode(PartialOptimization, partial)
    if job["kind"] == "trainings":
        return decode(PartialTraining, partial)
    if job["kind"] == "part-simulations":
        return decode(PartialPartState, partial)
    return decode(PartialRound, partial) if "round" in partial else decode(PartialDesign, partial)


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
            simulated last. For a network or an optimized Voronoi diagram it is the state after the latest iteration, for a
            part under supports the latest state, and for a training the errors that it has reached. None for other
            computations.
        priority: "interactive", "normal" or "background", as the request asked.
        remaining_seconds: estimated seconds until a running job ends; None while it does not run, or has hardly begun.
    """

    id: str
    state: str
    kind: str
    mesh: Optional[str]
    progress: float
    stage: str
    created: str
    partial: Annotated[Optional[Partial], At("", read=_partial)] = None
    priority: str = "normal"
    remaining_seconds: Optional[float] = None

    @property
    def finished(self) -> bool:
        return self.state not in UNFINISHED


class Job(Generic[Result]):
    """A computation on the server.

    The server owns the job: closing a `Client` does not end it, and `client.job(id)` returns it again.
    """

    def __init__(self, transport: Transport, job_id: str, request: Request[Result]) -> None:
        self._transport = transport
        self._path = f"/v1/jobs/{quote(job_id, safe='')}"
        self._request = request
        self.id = job_id

    def __repr__(self) -> str:
        return f"Job({self.id!r})"

    def status(self) -> JobStatus:
        return decode(JobStatus, self._transport.request("GET", self._path).json())

    @property
    def remaining_seconds(self) -> Optional[float]:
        """Estimated seconds until the job ends, for which the server is asked; None while it does not run, or has hardly begun."""
        return self.status().remaining_seconds

    def cancel(self) -> None:
        """Ends the job if it has not finished; its later `result` raises `JobCancelled`."""
        self._transport.request("DELETE", self._path)

    def wait(self, *, timeout: Optional[Number] = None, progress: Optional[Progress] = None) -> JobStatus:
        """Returns once the job has finished, whether successfully or not.

        Raises `RequestTimeout` after `timeout`, which is in seconds or has a unit. Neither that nor an exception from `progress`, which reaches the
        caller, ends the job. Both are those of the request by default.
        """
        limit: Optional[float] = without_unit(self._request.timeout if timeout is None else timeout, "timeout", "duration")
        progress = self._request.progress if progress is None else progress
        end = None if limit is None else time.monotonic() + limit
        pause, rounds = FIRST_POLL_INTERVAL, Rounds()
        with Reporter(self._transport.progress if progress is None else progress) as report:
            while True:
                status = self.status()
                note = rounds.add(status.partial)
                remaining = "" if status.remaining_seconds is None else f"{status.remaining_seconds:.0f} s left"
                report(status.progress, status.stage, ", ".join(filter(None, (rounds.best(), remaining))), note)
                if status.finished:
                    return status
                if end is not None and time.monotonic() + pause > end:
                    raise RequestTimeout(f"job {self.id} is {status.state} after {limit:g} s")
                time.sleep(pause)
                pause = min(2 * pause, MAX_POLL_INTERVAL)

    def result(self, *, timeout: Optional[Number] = None, progress: Optional[Progress] = None) -> Result:
        """Waits and returns the result. Raises a `ProblemError` if the computation failed."""
        self.wait(timeout=timeout, progress=progress)
        answer = self._transport.request("GET", self._path + "/result", headers={"Accept": self._request.accept})
        return self._request.decode(answer)


def submit(transport: Transport, request: Request[Result]) -> Job[Result]:
    """Submits a request to the server as a job."""
    return Job(transport, _job_id(_send(transport, request, "respond-async")), request)


def run(
    transport: Transport,
    request: Request[Result],
    timeout: Optional[Number] = None,
    progress: Optional[Progress] = None,
) -> Result:
    """Computes and returns the result. A computation that takes longer than a second becomes a job, which is followed.

    Anything that interrupts the wait (a timeout, Ctrl-C, an exception from `progress`) cancels the computation on the server.
    """
    progress = request.progress if progress is None else progress
    answer = _send(transport, request, "wait=1")
    if answer.status != 202:
        # An immediate answer needs no bar.
        if callable(progress):
            progress(1.0, "")
        return request.decode(answer)
    job = Job(transport, _job_id(answer), request)
    try:
        return job.result(timeout=timeout, progress=progress)
    except BaseException:
        with contextlib.suppress(SuppleError):
            if not job.status().finished:
                job.cancel()
        raise


def _send(transport: Transport, request: Request[Result], preference: str) -> Answer:
    headers = {"Accept": request.accept, "Prefer": preference, "Idempotency-Key": uuid.uuid4().hex}
    return transport.request("POST", request.url(), document=request.to_wire(), headers=headers, repeatable=True)


def _job_id(answer: Answer) -> str:
    return answer.headers["Location"].rstrip("/").rsplit("/", 1)[-1]
