"""Jobs: accepted, followed, cancelled, stopped by deadlines and by clients that disconnect."""

from __future__ import annotations

import json
import socket
from typing import Any, Callable, Dict, Iterator, List, Tuple

import pytest
import requests

from harness import Api, ServerProcess, problem_code
from shapes import bumpy_sphere
from working_time import PATIENCE_SECONDS, WorkingTime, comes_true, ends_within

ASYNC = {"Prefer": "respond-async"}
FIELDS = "/v1/geodesic-fields"


@pytest.fixture(scope="session")
def large_mesh(server: ServerProcess, contract: Any) -> str:
    """A mesh of 327,680 faces with many saddle vertices, whose exact field takes seconds."""
    return Api(server, contract).upload(*bumpy_sphere(7))


def long_request(mesh: str, **more: Any) -> Dict[str, Any]:
    return {"mesh": mesh, "sources": [{"vertex": 0}], **more}


def start_job(api: Api, path: str, request: Dict[str, Any]) -> str:
    response = api.post(path, request, headers=ASYNC)
    assert response.status_code == 202, response.text
    assert response.headers["Location"] == f"/v1/jobs/{response.json()['id']}"
    assert response.headers["Preference-Applied"] == "respond-async"
    return str(response.json()["id"])


def events(api: Api, job: str) -> Iterator[Tuple[str, Dict[str, Any]]]:
    """(event, job) of each server-sent event until the stream ends."""
    with requests.get(f"{api.server.url}/v1/jobs/{job}/events", stream=True, timeout=PATIENCE_SECONDS) as stream:
        assert stream.headers["Content-Type"].startswith("text/event-stream")
        name, data = "", ""
        for line in stream.iter_lines(decode_unicode=True):
            if line.startswith("event:"):
                name = line[6:].strip()
            elif line.startswith("data:"):
                data += line[5:].strip()
            elif not line and data:
                document = json.loads(data)
                api.contract.validate({"$ref": "#/components/schemas/Job"}, document, "an event")
                yield name, document
                name, data = "", ""


def test_a_job_has_the_result_of_the_immediate_answer(api: Api, sphere_mesh: str) -> None:
    for path, request in [
        ("/v1/geodesics", {"mesh": sphere_mesh, "pairs": [{"from": {"vertex": 0}, "to": {"vertex": 9}}], "paths": True}),
        (FIELDS, {"mesh": sphere_mesh, "sources": [{"vertex": 5}]}),
        ("/v1/karcher-means", {"mesh": sphere_mesh, "points": [{"vertex": 5}, {"vertex": 60}]}),
        ("/v1/exponential-maps", {"mesh": sphere_mesh, "start": {"vertex": 5}, "tangent": [0.1, 0.2, 0.0]}),
    ]:
        job = start_job(api, path, request)
        document = api.wait_for_job(job)
        assert (document["state"], document["progress"], document["kind"]) == ("successful", 1, path[4:])
        assert document["created"] <= document["started"] <= document["finished"] < document["expires"]
        result = api.get(document["result"]).json()
        immediate = api.ok(path, request)
        for answer in (result, immediate):
            del answer["cost"], answer["effects"]
        assert result == immediate


def test_the_result_has_the_media_type_that_the_request_asked_for(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "sources": [{"vertex": 5}]}
    response = api.post(FIELDS, request, headers={**ASYNC, "Accept": "application/octet-stream"})
    job = response.json()["id"]
    api.wait_for_job(job)
    result = api.get(f"/v1/jobs/{job}/result")
    assert result.headers["Content-Type"] == "application/octet-stream"
    immediate = api.post(FIELDS, request, headers={"Accept": "application/octet-stream"})
    assert result.content == immediate.content


def test_an_unfinished_job_has_no_result_yet_and_says_when_to_ask_again(api: Api, large_mesh: str) -> None:
    job = start_job(api, FIELDS, long_request(large_mesh))
    shown = api.get(f"/v1/jobs/{job}")
    assert shown.json()["state"] in ("accepted", "running") and int(shown.headers["Retry-After"]) >= 0
    result = api.get(f"/v1/jobs/{job}/result")
    assert (result.status_code, problem_code(result)) == (409, "job.not_finished")
    api.delete(f"/v1/jobs/{job}")


def test_events_show_rising_progress_and_end_with_the_finished_job(api: Api, sphere_mesh: str) -> None:
    # 642 searches with paths and derivatives take longer than the tenth of a second between two reports of progress.
    pairs = [{"from": {"vertex": start}, "to": {"vertex": (start + 16 * hop) % 642}}
             for start in range(642) for hop in range(1, 40)]
    job = start_job(api, "/v1/geodesics", {"mesh": sphere_mesh, "pairs": pairs, "derivatives": 2, "paths": True})
    seen: List[Tuple[str, Dict[str, Any]]] = list(events(api, job))
    assert len(seen) >= 3
    assert [name for name, _ in seen] == ["progress"] * (len(seen) - 1) + ["finished"]
    assert seen[-1][1]["state"] == "successful"
    for _, document in seen:
        may_tell = document["state"] == "running" and document["progress"] > 0.02
        assert (document["remaining_seconds"] is not None) == may_tell, document
    shares = [document["progress"] for _, document in seen]
    assert shares == sorted(shares) and shares[-1] == 1


def test_delete_dismisses_a_running_job_within_a_moment(api: Api, large_mesh: str) -> None:
    job = start_job(api, FIELDS, long_request(large_mesh))
    api.wait_for_job(job, ("running",))
    response = api.delete(f"/v1/jobs/{job}")
    assert (response.status_code, response.json()["state"]) == (200, "dismissed")
    ends_within(api.server.pid, api.busy, 1, "the computation goes on")
    result = api.get(f"/v1/jobs/{job}/result")
    assert (result.status_code, problem_code(result)) == (410, "job.dismissed")


def test_delete_removes_a_finished_job(api: Api, grid_mesh: str) -> None:
    job = start_job(api, FIELDS, {"mesh": grid_mesh, "sources": [{"vertex": 0}]})
    api.wait_for_job(job)
    assert api.delete(f"/v1/jobs/{job}").status_code == 204
    for response in (api.get(f"/v1/jobs/{job}"), api.get(f"/v1/jobs/{job}/result"), api.delete(f"/v1/jobs/{job}"),
                     api.get(f"/v1/jobs/{job}/events")):
        assert (response.status_code, problem_code(response)) == (404, "job.not_found")


def test_wait_answers_at_once_what_is_quick_and_makes_a_job_of_what_is_not(api: Api, grid_mesh: str, large_mesh: str) -> None:
    quick = api.post(FIELDS, {"mesh": grid_mesh, "sources": [{"vertex": 0}]}, headers={"Prefer": "wait=10"})
    assert (quick.status_code, quick.headers["Preference-Applied"]) == (200, "wait=10")
    work = WorkingTime(api.server.pid)
    slow = api.post(FIELDS, long_request(large_mesh), headers={"Prefer": "wait=0"})
    work.check(1, "the answer waits for the computation")
    assert slow.status_code == 202
    api.delete(slow.headers["Location"])


def test_a_deadline_ends_the_computation(api: Api, large_mesh: str) -> None:
    work = WorkingTime(api.server.pid)
    response = api.post(FIELDS, long_request(large_mesh, deadline=0.2))
    work.check(2, "the computation goes on")
    assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")
    job = start_job(api, FIELDS, long_request(large_mesh, deadline=0.2))
    document = api.wait_for_job(job)
    assert (document["state"], document["error"]["code"]) == ("failed", "job.deadline_exceeded")
    result = api.get(f"/v1/jobs/{job}/result")
    assert (result.status_code, problem_code(result)) == (504, "job.deadline_exceeded")


def test_a_client_that_hangs_up_cancels_its_computation(api: Api, large_mesh: str) -> None:
    body = json.dumps(long_request(large_mesh)).encode()
    request = (b"POST /v1/geodesic-fields HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
               b"Content-Length: %d\r\n\r\n" % len(body)) + body
    connection = socket.create_connection(("127.0.0.1", api.server.port))
    connection.sendall(request)
    comes_true(api.busy, "the computation starts")
    connection.close()
    ends_within(api.server.pid, api.busy, 1, "the computation outlives its client")


def test_a_client_that_hangs_up_leaves_a_job_running(api: Api, large_mesh: str) -> None:
    job = start_job(api, FIELDS, long_request(large_mesh))
    stream = requests.get(f"{api.server.url}/v1/jobs/{job}/events", stream=True, timeout=PATIENCE_SECONDS)
    next(stream.iter_lines())
    stream.close()
    assert api.wait_for_job(job)["state"] == "successful"


def test_a_computation_that_fails_is_a_failed_job_with_its_problem(api: Api, sphere_mesh: str) -> None:
    job = start_job(api, "/v1/karcher-means", {"mesh": sphere_mesh, "points": [{"vertex": 1}], "weights": [0]})
    document = api.wait_for_job(job)
    assert (document["state"], document["error"]["code"]) == ("failed", "karcher.weights")
    result = api.get(f"/v1/jobs/{job}/result")
    assert (result.status_code, problem_code(result)) == (422, "karcher.weights")


def test_a_mesh_in_use_is_not_deleted(api: Api) -> None:
    mesh = api.upload(*bumpy_sphere(6))
    job = start_job(api, FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]})
    response = api.delete(f"/v1/meshes/{mesh}")
    assert (response.status_code, problem_code(response)) == (409, "mesh.in_use")
    api.wait_for_job(job)
    assert api.delete(f"/v1/meshes/{mesh}").status_code == 204
    assert api.get(f"/v1/jobs/{job}/result").status_code == 200


def test_the_list_can_be_narrowed_to_a_state(api: Api, grid_mesh: str) -> None:
    job = start_job(api, FIELDS, {"mesh": grid_mesh, "sources": [{"vertex": 0}]})
    api.wait_for_job(job)
    successful = api.get("/v1/jobs?state=successful&limit=1000").json()["jobs"]
    assert job in [entry["id"] for entry in successful]
    assert {entry["state"] for entry in successful} == {"successful"}
    assert job not in [entry["id"] for entry in api.get("/v1/jobs?state=failed").json()["jobs"]]


@pytest.mark.parametrize("prefer", ["wait=abc", "wait=-1", "wait=1e9"])
def test_a_wait_that_is_no_number_of_seconds_is_refused_or_ignored(api: Api, grid_mesh: str, prefer: str) -> None:
    response = api.post(FIELDS, {"mesh": grid_mesh, "sources": [{"vertex": 0}]}, headers={"Prefer": prefer})
    assert response.status_code in (200, 400)


def test_a_full_queue_is_said_with_the_setting_and_a_time_to_come_back(
        new_server: Callable[..., ServerProcess], contract: Any) -> None:
    api = Api(new_server("--workers", "1", "--max-queue", "2"), contract)
    mesh = api.upload(*bumpy_sphere(7))
    refused = None
    for _ in range(8):
        response = api.post(FIELDS, long_request(mesh), headers=ASYNC)
        if response.status_code != 202:
            refused = response
            break
    assert refused is not None, "the queue never filled"
    assert (refused.status_code, problem_code(refused)) == (503, "job.queue_full")
    assert refused.json()["setting"] == "--max-queue" and "Retry-After" in refused.headers


