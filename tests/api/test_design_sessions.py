"""Searches for a design that others wait for: sessions, jobs and their events, cancellation, deadlines."""

from __future__ import annotations

import threading
from typing import Any, Dict, List

import pytest
import requests

from design_requests import DESIGNS, effect, known_problem, long_request, quick_request, spline
from harness import SLOWNESS, Api, problem_code
from test_jobs import events, start_job
from working_time import PATIENCE_SECONDS, WorkingTime, comes_true, ends_within


def in_background(api: Api, document: Dict[str, Any]) -> "tuple[threading.Thread, List[requests.Response]]":
    """Sends a request for an immediate answer in another thread."""
    received: List[requests.Response] = []
    thread = threading.Thread(target=lambda: received.append(
        requests.post(api.server.url + DESIGNS, json=document, timeout=PATIENCE_SECONDS)))
    thread.start()
    comes_true(api.busy, "the computation starts")
    return thread, received


def test_a_newer_request_of_a_session_replaces_an_immediate_one(designs: Api) -> None:
    thread, received = in_background(designs, long_request(session="drag-1"))
    work = WorkingTime(designs.server.pid)
    designs.ok(DESIGNS, quick_request(session="drag-1"))
    thread.join(PATIENCE_SECONDS)
    work.check(20, "the older request goes on")
    (older,) = received
    designs.contract.check_response("POST", DESIGNS, older.status_code, older.headers, older.content)
    assert (older.status_code, problem_code(older)) == (409, "design.superseded")


def test_a_newer_request_of_a_session_replaces_a_job(designs: Api) -> None:
    job = start_job(designs, DESIGNS, long_request(session="drag-2"))
    designs.wait_for_job(job, ("running",))
    other = start_job(designs, DESIGNS, quick_request(session="drag-2"))
    document = designs.wait_for_job(job)
    assert (document["state"], document["error"]["code"]) == ("failed", "design.superseded")
    result = designs.get(f"/v1/jobs/{job}/result")
    assert (result.status_code, problem_code(result)) == (409, "design.superseded")
    assert designs.wait_for_job(other)["state"] == "successful"


def test_other_sessions_go_on(designs: Api) -> None:
    jobs = [start_job(designs, DESIGNS, long_request(**more)) for more in ({"session": "a"}, {})]
    designs.ok(DESIGNS, quick_request(session="b"))
    designs.ok(DESIGNS, quick_request())
    for job in jobs:
        assert designs.get(f"/v1/jobs/{job}").json()["state"] in ("accepted", "running")
        designs.delete(f"/v1/jobs/{job}")


def test_a_session_that_has_ended_replaces_nothing(designs: Api) -> None:
    for _ in range(3):
        designs.ok(DESIGNS, quick_request(session="again"))


def test_events_carry_the_best_design_so_far(designs: Api) -> None:
    request = {**known_problem(designs), "target": spline([-0.05, 0.1], [-0.1, 0.3]), "samples": 60, "name": "heel",
               "accuracy": {"candidates": 64, "starts": 6, "tolerance": 1e-10}, "effects": {"multi_start": "on"}}
    job = start_job(designs, DESIGNS, request)
    seen = [document for _, document in events(designs, job)]
    partial = [document["partial"] for document in seen if "partial" in document]
    assert partial, "no event had a partial design"
    for best in partial:
        assert (best["family"], best["model"], best["name"]) == ("IH67", "ih67", "heel")
        assert len(best["x"]) == len(best["achieved"]) and len(best["parameters"]) == 2
        assert len(best["x"]) in (11, 60), "some of the samples at first, then all"
    errors = [best["error"]["relative_rms"] for best in partial]
    assert errors == sorted(errors, reverse=True), "partial designs only become better"
    answer = designs.get(f"/v1/jobs/{job}/result").json()
    assert "error" in answer, answer
    assert answer["error"]["relative_rms"] <= errors[-1] + 0.01, "errors at all samples and at some of them differ little"
    assert "partial" not in designs.get(f"/v1/jobs/{job}").json(), "a finished job has its result instead"


def test_delete_ends_a_search_within_a_moment(designs: Api) -> None:
    job = start_job(designs, DESIGNS, long_request())
    designs.wait_for_job(job, ("running",))
    work = WorkingTime(designs.server.pid)
    comes_true(lambda: work.seconds() > 0.3, "the search computes")
    assert designs.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
    ends_within(designs.server.pid, designs.busy, 5, "the search goes on")


@pytest.mark.parametrize("family", ["IH67", "any"])
def test_a_deadline_gives_the_best_design_until_then(designs: Api, family: str) -> None:
    late = {**long_request(deadline=2 * SLOWNESS), "family": family, "verify": True}
    late["accuracy"]["candidates"] = 64  # so that the first design is found in good time
    answer = designs.ok(DESIGNS, late)
    assert answer["stopped"] == "deadline" and answer["ways_out"] == [] and answer["polish"] is None
    assert answer["message"].endswith("The deadline passed before the search had ended: this is the best design until then.")
    assert answer["verdict"]["source"] == "model" and answer["profile"]["verified"] is None
    assert answer["ranking"][0]["parameters"] == answer["parameters"] and len(answer["profile"]["achieved"]) == 500
    for name, why in (("verification", "the deadline passed during the search"), ("ways_out", "the search for the design was stopped")):
        assert (effect(answer, name)["ran"], effect(answer, name)["why"]) == (False, why)
    job = start_job(designs, DESIGNS, late)
    assert designs.wait_for_job(job)["state"] == "successful"
    assert designs.get(f"/v1/jobs/{job}/result").json()["stopped"] == "deadline"


def test_a_deadline_before_the_first_design_is_an_error(designs: Api) -> None:
    response = designs.post(DESIGNS, long_request(deadline=1e-4))
    assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")
