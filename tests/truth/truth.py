"""The basis of the wings in tests/truth: checks, the examined server, and the run of a wing."""

from __future__ import annotations

import json
import math
import statistics
import time
import zlib
from dataclasses import dataclass, field
from types import ModuleType
from typing import Any, Callable, Dict, List, Optional

import numpy as np
import requests

from kept import KeptCases, Outcome

ANSWERED = "answered"
"""The check that every wing has. A case that ends with a refusal or an exception deviates by 1."""
ALL_EXAMINED_FROM = 200
"""In a run of at least this many cases, a check that no case examined is a fault of the suite."""
SECONDS = 900.0
"""Time limit of an answer, which detects a hanging server but permits a busy machine."""


@dataclass(frozen=True)
class Check:
    """A comparison. Deviations up to `limit`, which the documents promise, are right; `unit` is their unit. A fraction `share` of the
    cases may exceed it if the documents say that this happens, for example at bifurcations."""
    about: str
    limit: float
    unit: str
    share: float = 0.0


class Refusal(Exception):
    """The server answered with a problem document."""

    def __init__(self, status: int, problem: Any) -> None:
        code = problem.get("code", "") if isinstance(problem, dict) else ""
        detail = problem.get("detail", "") if isinstance(problem, dict) else str(problem)
        super().__init__(f"{status} {code}: {detail}")
        self.status = status
        self.problem = problem
        self.code = str(code)


class Server:
    """The connection to a running server. It waits for answers, also if requests become jobs."""

    def __init__(self, url: str) -> None:
        self.url = url
        self._session = requests.Session()

    def _answer(self, method: str, path: str, **more: Any) -> requests.Response:
        response = self._session.request(method, self.url + path, timeout=SECONDS, **more)
        if response.status_code == 202:
            job = response.headers["Location"]
            while self._session.get(self.url + job, timeout=SECONDS).json()["state"] in ("accepted", "running"):
                time.sleep(0.02)
            response = self._session.get(self.url + job + "/result", timeout=SECONDS)
        if response.status_code >= 400:
            try:
                problem = response.json()
            except ValueError:
                problem = response.text
            raise Refusal(response.status_code, problem)
        return response

    def post(self, path: str, body: Any, content_type: str = "application/json") -> Any:
        """The JSON answer. A body of another content type is text or bytes."""
        return self._answer("POST", path, data=_bytes_of(body, content_type), headers={"Content-Type": content_type}).json()

    def file(self, path: str, body: Any, accept: str, content_type: str = "application/json") -> bytes:
        """The answer as a file of the requested media type."""
        return self._answer("POST", path, data=_bytes_of(body, content_type), headers={"Content-Type": content_type, "Accept": accept}).content

    def get(self, path: str) -> Any:
        return self._answer("GET", path).json()

    def delete(self, path: str) -> None:
        self._answer("DELETE", path)

    def upload(self, vertices: Any, faces: Any) -> Any:
        """Uploads a mesh given by arrays and returns its description, whose `id` identifies it in requests."""
        return self.post("/v1/meshes", {"vertices": np.asarray(vertices, dtype=float).tolist(), "faces": np.asarray(faces, dtype=int).tolist()})


def _bytes_of(body: Any, content_type: str) -> bytes:
    if isinstance(body, bytes):
        return body
    return body.encode() if isinstance(body, str) and content_type != "application/json" else json.dumps(body).encode()


@dataclass
class Found:
    """A deviation beyond the limit of its check, or the failure that ended a case."""
    check: str
    index: int
    deviation: float
    message: str = ""


@dataclass
class Figures:
    """The deviations of one check in the cases that examined it. If a case yields several, the largest one is used."""
    check: Check
    deviations: Dict[int, float] = field(default_factory=dict)

    def add(self, index: int, deviation: float) -> None:
        deviation = math.inf if math.isnan(deviation) else abs(deviation)
        self.deviations[index] = max(deviation, self.deviations.get(index, 0.0))

    @property
    def median(self) -> float:
        return statistics.median(self.deviations.values()) if self.deviations else math.nan

    @property
    def largest(self) -> float:
        return max(self.deviations.values(), default=math.nan)

    @property
    def worst_case(self) -> Optional[int]:
        return max(self.deviations, key=self.deviations.__getitem__) if self.deviations else None

    @property
    def beyond(self) -> int:
        return sum(deviation > self.check.limit for deviation in self.deviations.values())

    @property
    def sound(self) -> bool:
        return self.beyond <= self.check.share * len(self.deviations)


@dataclass
class Result:
    """The result of a wing's cases."""
    wing: str
    seed: int
    first: int
    cases: int
    figures: Dict[str, Figures]
    found: List[Found] = field(default_factory=list)

    @property
    def unexamined(self) -> List[str]:
        """Checks that no case examined, if the run is long enough to say so."""
        return [name for name, figures in self.figures.items() if not figures.deviations] if self.cases >= ALL_EXAMINED_FROM else []

    @property
    def sound(self) -> bool:
        return all(figures.sound for figures in self.figures.values()) and not self.unexamined


def generator(seed: int, wing: str, index: int) -> np.random.Generator:
    """The random numbers of one case. They depend only on the run's seed, the wing's name and the case's index."""
    return np.random.default_rng([seed, zlib.crc32(wing.encode()), index])


def run_wing(name: str, wing: ModuleType, server: Server, seed: int, first: int, cases: int,
             say: Callable[[str], None] = lambda line: None, revive: Callable[[], None] = lambda: None, kept: Optional[KeptCases] = None) -> Result:
    """Examines the cases first ... first + cases - 1 of a wing. `say` receives messages about progress and findings. `revive` is called
    after a case that ended with an exception, since the server may have ended. Cases that are `kept` are not examined again, and others
    are kept. An interrupted run returns the cases so far."""
    checks = {**wing.CHECKS, ANSWERED: Check("Cases that ended in a refusal or an exception", 0, "1 if it did")}
    result = Result(name, seed, first, cases, {key: Figures(check) for key, check in checks.items()})
    for index in range(first, first + cases):
        try:
            outcome = kept.outcomes.get(index) if kept else None
            if outcome is None:
                outcome = _outcome_of(wing, server, generator(seed, name, index), checks)
                if outcome[1]:
                    revive()
                if kept:
                    kept.add(index, outcome)
        except KeyboardInterrupt:
            result.cases = index - first
            say(f"  {name}: interrupted after {result.cases} cases")
            break
        deviations, failure = outcome
        for check, deviation in {**deviations, ANSWERED: 1.0 if failure else 0.0}.items():
            result.figures[check].add(index, deviation)
        for check, figures in result.figures.items():
            deviation = figures.deviations.get(index, 0.0)
            if deviation > figures.check.limit:
                result.found.append(Found(check, index, deviation, failure if check == ANSWERED else ""))
                say(f"  case {index}: {check}: {failure[:300] if check == ANSWERED else f'{deviation:.3g} where {figures.check.limit:.3g} is right'}")
        done = index - first + 1
        if cases >= 10 and done % (cases // 10) == 0:
            say(f"  {name}: {done} of {cases} cases, {len(result.found)} found")
    return result


def _outcome_of(wing: ModuleType, server: Server, rng: np.random.Generator, checks: Dict[str, Check]) -> Outcome:
    """The largest deviation of each check that a case comes to, and what has ended the case early."""
    figures = {key: Figures(check) for key, check in checks.items()}
    failure = ""
    try:
        for check, deviation in wing.examine(server, wing.case(rng)):
            figures[check].add(0, float(deviation))
    except Exception as error:  # any exception that ends a case is a finding
        failure = f"{type(error).__name__}: {error}"
    return {key: figure.deviations[0] for key, figure in figures.items() if figure.deviations}, failure
