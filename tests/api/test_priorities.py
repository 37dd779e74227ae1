"""Priorities: what starts first, and that what is computed in the background delays nobody."""

from __future__ import annotations

import statistics
import subprocess
import time
from typing import Any, Callable, Dict, List

import pytest

from contract import Contract
from harness import CLI, Api, ServerProcess, pointers, problem_code, slow_relaxation
from shapes import sphere
from working_time import PATIENCE_SECONDS

ASYNC = {"Prefer": "respond-async"}
FIELDS = "/v1/geodesic-fields"
NewServer = Callable[..., ServerProcess]
ENDLESS = 100_000
"""Iterations of a relaxation that no test waits for."""


def start_endless(api: Api, mesh: str, priority: str) -> str:
    response = api.post("/v1/embedded-systems", slow_relaxation(mesh, ENDLESS, priority=priority, deadline=3600), headers=ASYNC)
    assert response.status_code == 202, response.text
    assert response.json()["priority"] == priority
    return str(response.json()["id"])


def median_seconds(api: Api, mesh: str, headers: Dict[str, str]) -> float:
    """The median time of some interactive requests."""
    seconds: List[float] = []
    for vertex in range(7):
        begin = time.monotonic()
        api.ok(FIELDS, {"mesh": mesh, "sources": [{"vertex": vertex}], "priority": "interactive"}, headers=headers)
        seconds.append(time.monotonic() - begin)
    return statistics.median(seconds)


@pytest.mark.parametrize("headers", [{}, {"Prefer": f"wait={PATIENCE_SECONDS:.0f}"}], ids=["immediate", "on a worker"])
def test_an_interactive_request_does_not_wait_for_jobs_in_the_background(
        new_server: NewServer, contract: Contract, headers: Dict[str, str]) -> None:
    api = Api(new_server("--workers", "1", "--immediate", "1"), contract)
    mesh = api.upload(*sphere(3))
    idle = median_seconds(api, mesh, headers)
    jobs = [start_endless(api, mesh, "background") for _ in range(3)]
    api.wait_for_job(jobs[0], ("running",))
    busy = median_seconds(api, mesh, headers)
    assert busy < 5 * idle + 0.5, f"{busy:.3f} s while jobs run in the background, {idle:.3f} s without"
    assert api.get(f"/v1/jobs/{jobs[0]}").json()["state"] == "running"
    for job in jobs:
        api.delete(f"/v1/jobs/{job}")


def test_urgent_jobs_begin_before_others_that_came_earlier(new_server: NewServer, contract: Contract) -> None:
    api = Api(new_server("--workers", "1"), contract)
    mesh = api.upload(*sphere(3))
    first = start_endless(api, mesh, "normal")
    api.wait_for_job(first, ("running",))
    beyond = start_endless(api, mesh, "interactive")
    api.wait_for_job(beyond, ("running",))
    normal, interactive = start_endless(api, mesh, "normal"), start_endless(api, mesh, "interactive")
    assert api.server.metrics()['supple_jobs_waiting{priority="interactive"}'] == 1
    api.delete(f"/v1/jobs/{beyond}")
    api.wait_for_job(interactive, ("running",))
    assert api.get(f"/v1/jobs/{normal}").json()["state"] == "accepted"
    for job in (first, normal, interactive):
        api.delete(f"/v1/jobs/{job}")


def test_a_request_without_a_priority_is_normal(api: Api, grid_mesh: str) -> None:
    job = api.post(FIELDS, {"mesh": grid_mesh, "sources": [{"vertex": 0}]}, headers=ASYNC).json()
    assert (job["priority"], job["remaining_seconds"]) == ("normal", None)
    assert api.wait_for_job(job["id"])["priority"] == "normal"


def test_an_answer_that_is_computed_in_the_background_is_the_same(api: Api, grid_mesh: str) -> None:
    request = {"mesh": grid_mesh, "sources": [{"vertex": 3}]}
    answers: List[Any] = [api.ok(FIELDS, {**request, "priority": priority}) for priority in ("interactive", "background")]
    assert answers[0]["distances"] == answers[1]["distances"]


@pytest.mark.parametrize("priority", ["urgent", "", 1, None])
def test_an_unknown_priority_is_refused_with_its_field(api: Api, grid_mesh: str, priority: Any) -> None:
    for headers in ({}, ASYNC):
        response = api.post(FIELDS, {"mesh": grid_mesh, "sources": [{"vertex": 0}], "priority": priority}, headers=headers, faulty=True)
        assert (response.status_code, problem_code(response)) == (400, "request.invalid")
        assert pointers(response) == ["/priority"]


def test_a_job_keeps_its_priority_over_a_restart(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    job = start_endless(api, api.upload(*sphere(3)), "background")
    api.wait_for_job(job, ("running",))
    server.kill()
    server.start()
    api = Api(server, contract)
    shown = api.wait_for_job(job, ("running",))
    assert shown["priority"] == "background"
    assert [entry["priority"] for entry in api.get("/v1/jobs").json()["jobs"]] == ["background"]
    assert api.delete(f"/v1/jobs/{job}").json()["priority"] == "background"


def test_the_command_line_client_takes_a_priority_that_there_is(api: Api, grid_mesh: str) -> None:
    def field(priority: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([str(CLI), "--server", api.server.url, "--priority", priority, "field", grid_mesh, "v0", "-o", "-"],
                              capture_output=True, text=True, timeout=PATIENCE_SECONDS, check=False)

    done = field("background")
    assert done.returncode == 0, done.stderr
    refused = field("urgent")
    assert refused.returncode == 1 and "--priority" in refused.stderr
