"""Starts of a server: the first one, after an orderly end, and after it was killed during its work."""

from __future__ import annotations

import json
import threading
import time
from pathlib import Path
from typing import Any, Callable, Dict, List

import pytest
import requests

from contract import Contract
from harness import Api, ServerProcess, problem_code
from shapes import bumpy_sphere, flat_grid, sphere
from working_time import PATIENCE_SECONDS

ASYNC = {"Prefer": "respond-async"}
FIELDS = "/v1/geodesic-fields"
NewServer = Callable[..., ServerProcess]


def finished_job(api: Api, mesh: str) -> Dict[str, Any]:
    """Runs a field as a job and returns its document and its result."""
    job = api.post(FIELDS, {"mesh": mesh, "sources": [{"vertex": 1}]}, headers=ASYNC).json()["id"]
    document = api.wait_for_job(job)
    assert document["state"] == "successful"
    return {"document": document, "result": api.get(f"/v1/jobs/{job}/result").content}


def assert_kept(api: Api, meshes: Dict[str, Any], jobs: List[Dict[str, Any]]) -> None:
    listed = {mesh["id"] for mesh in api.get("/v1/meshes?limit=1000").json()["meshes"]}
    assert set(meshes) <= listed
    for mesh, description in meshes.items():
        assert api.get(f"/v1/meshes/{mesh}").json() == description
    for job in jobs:
        name = job["document"]["id"]
        assert api.get(f"/v1/jobs/{name}").json() == job["document"]
        assert api.get(f"/v1/jobs/{name}/result").content == job["result"]


def test_a_fresh_server_is_empty(new_server: NewServer, contract: Contract) -> None:
    api = Api(new_server(), contract)
    assert api.get("/v1/meshes").json() == {"meshes": []}
    assert api.get("/v1/jobs").json() == {"jobs": []}


def test_a_restart_keeps_meshes_and_finished_jobs_and_computes_the_same(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    meshes = {name: api.get(f"/v1/meshes/{name}").json() for name in (api.upload(*flat_grid(4)), api.upload(*sphere(2)))}
    jobs = [finished_job(api, name) for name in meshes]
    request = {"mesh": next(iter(meshes)), "pairs": [{"from": {"vertex": 0}, "to": {"vertex": 24}}], "derivatives": 2}
    before = api.ok("/v1/geodesics", request)["results"]
    assert server.terminate() == 0
    server.start()
    api = Api(server, contract)
    assert_kept(api, meshes, jobs)
    assert api.ok("/v1/geodesics", request)["results"] == before


def test_kill_9_in_mid_job_loses_no_mesh_no_job_and_no_finished_result(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    large = api.upload(*bumpy_sphere(6))
    meshes = {name: api.get(f"/v1/meshes/{name}").json() for name in (large, api.upload(*sphere(2)))}
    jobs: List[Dict[str, Any]] = []
    for _ in range(3):
        jobs.append(finished_job(api, list(meshes)[1]))
        running = api.post(FIELDS, {"mesh": large, "sources": [{"vertex": 0}]}, headers=ASYNC).json()["id"]
        waiting = api.post(FIELDS, {"mesh": large, "sources": [{"vertex": 9}]}, headers=ASYNC).json()["id"]
        api.wait_for_job(running, ("running",))
        server.kill()
        server.start()
        api = Api(server, contract)
        assert_kept(api, meshes, jobs)
        for job in (running, waiting):
            assert api.wait_for_job(job)["state"] == "successful"


def test_kill_9_during_uploads_leaves_only_whole_meshes(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    bodies = [json.dumps({"vertices": v.tolist(), "faces": f.tolist()})
              for v, f in (bumpy_sphere(4, seed) for seed in range(12))]
    acknowledged: List[str] = []

    def upload_all() -> None:
        for body in bodies:
            try:
                response = requests.post(server.url + "/v1/meshes", body, headers={"Content-Type": "application/json"}, timeout=PATIENCE_SECONDS)
                acknowledged.append(response.json()["id"])
            except requests.RequestException:
                return

    uploads = threading.Thread(target=upload_all)
    uploads.start()
    while len(acknowledged) < 4:
        time.sleep(0.001)
    server.kill()
    uploads.join()
    server.start()
    api = Api(server, contract)
    listed = {mesh["id"] for mesh in api.get("/v1/meshes").json()["meshes"]}
    assert set(acknowledged) <= listed
    for mesh in listed:
        assert len(api.ok(FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]})["distances"]) == 2562


def test_sigterm_lets_a_request_finish_and_refuses_new_ones(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--grace", "120")
    api = Api(server, contract)
    large = api.upload(*bumpy_sphere(6))
    answers: List[requests.Response] = []
    body = json.dumps({"mesh": large, "sources": [{"vertex": 0}]})

    def compute() -> None:
        answers.append(requests.post(server.url + FIELDS, body, headers={"Content-Type": "application/json"}, timeout=PATIENCE_SECONDS))

    thread = threading.Thread(target=compute)
    thread.start()
    while not api.busy():
        assert thread.is_alive(), "the computation was too short to be caught"
    assert server.terminate() == 0
    thread.join()
    (answer,) = answers
    assert answer.status_code == 200, answer.text[:500]
    with pytest.raises(requests.ConnectionError):
        requests.get(server.url + "/healthz", timeout=1)


def test_sigterm_ends_an_idle_server_at_once_even_with_open_connections(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--grace", "300", "--idle-timeout", "300")
    api = Api(server, contract)
    api.get("/healthz")  # leaves a persistent connection open
    assert server.terminate() == 0, "long before the connection or a computation would have to end"


def test_a_second_server_on_the_same_port_or_the_same_data_says_why_it_ends(
        new_server: NewServer, tmp_path: Path) -> None:
    first = new_server()
    second = ServerProcess(tmp_path / "other")
    second.port = first.port
    with pytest.raises(RuntimeError) as same_port:
        second.start()
    assert str(first.port) in str(same_port.value)
    third = ServerProcess(first.data)
    third.log = tmp_path / "third.log"
    with pytest.raises(RuntimeError) as same_data:
        third.start()
    assert str(first.data) in str(same_data.value)


def test_a_damaged_mesh_file_is_an_error_that_names_it_and_not_a_wrong_answer(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    mesh = api.upload(*sphere(2))
    assert server.terminate() == 0
    (file,) = [path for path in server.data.rglob("*") if path.is_file() and mesh in path.name]
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 0xFF
    file.write_bytes(content)
    server.start()
    response = Api(server, contract).post(FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]})
    assert (response.status_code, problem_code(response)) == (500, "store.corrupted")
