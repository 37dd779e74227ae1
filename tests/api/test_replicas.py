"""Servers that share a database also share meshes and jobs, and jobs outlive the server that has accepted them."""

from __future__ import annotations

import re
import sys
import time
import uuid
from pathlib import Path
from typing import Any, Dict, Iterator, List

import pytest
import requests

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from contract import Contract  # noqa: E402
from harness import SLOWNESS, Api, ServerProcess, make_model  # noqa: E402
from shared_servers import Replicas  # noqa: E402
from shapes import flat_grid, sphere  # noqa: E402

LONG = 300.0 * SLOWNESS
ASYNC = {"Prefer": "respond-async"}


@pytest.fixture(scope="module")
def replicas(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Replicas]:
    folder = tmp_path_factory.mktemp("replicas")
    make_model(folder / "models" / "ih21.h5")
    made = Replicas(folder, 2, "--models", str(folder / "models"), "--workers", "1")
    try:
        made.start()
        yield made
    finally:
        made.close()


@pytest.fixture
def apis(replicas: Replicas, contract: Contract) -> List[Api]:
    for server in replicas.servers:
        if not server.running():
            server.start()
    return [Api(server, contract) for server in replicas.servers]


def mean(mesh: str, seed: int, **more: Any) -> Dict[str, Any]:
    return {"mesh": mesh, "points": [{"vertex": (7 * k + seed) % 600} for k in range(6)], **more}


def long_simulation() -> Dict[str, Any]:
    """A simulation that takes some seconds and reports progress."""
    return {"family": "IH21", "load": {"uniaxial": {"direction": 0.3, "stretches": [1 - 0.001 * i for i in range(1, 60)]}},
            "accuracy": {"mesh_size": 0.3, "max_load_step": 1e-3}}


def finished(api: Api, job: str, seconds: float = LONG) -> Dict[str, Any]:
    end = time.monotonic() + seconds
    while True:
        status = api.get(f"/v1/jobs/{job}").json()
        if status["state"] not in ("accepted", "running") or time.monotonic() > end:
            return status  # type: ignore[no-any-return]
        time.sleep(0.05)


def test_a_mesh_is_there_at_all_servers(apis: List[Api]) -> None:
    one, two = apis
    mesh = one.upload(*flat_grid(4))
    assert two.get(f"/v1/meshes/{mesh}").json()["id"] == mesh
    assert two.get(f"/v1/meshes/{mesh}/content").content == one.get(f"/v1/meshes/{mesh}/content").content
    pair = {"mesh": mesh, "pairs": [{"from": {"vertex": 0}, "to": {"vertex": 24}}]}
    assert two.post("/v1/geodesics", pair).status_code == one.post("/v1/geodesics", pair).status_code == 200
    assert two.delete(f"/v1/meshes/{mesh}").status_code == 204
    end = time.monotonic() + LONG
    while one.post("/v1/geodesics", pair).status_code == 200 and time.monotonic() < end:
        time.sleep(0.1)
    refused = one.post("/v1/geodesics", pair)
    assert refused.status_code == 404 and refused.json()["code"] == "mesh.not_found"


def test_a_job_is_seen_followed_and_read_at_all_servers(apis: List[Api]) -> None:
    one, two = apis
    mesh = one.upload(*sphere(3))
    accepted = one.post("/v1/karcher-means", mean(mesh, 1), headers=ASYNC)
    assert accepted.status_code == 202
    job = accepted.json()["id"]
    assert two.get(f"/v1/jobs/{job}").status_code == 200
    assert finished(two, job)["state"] == "successful"
    assert two.get(f"/v1/jobs/{job}/result").content == one.get(f"/v1/jobs/{job}/result").content
    events = requests.get(f"{two.server.url}/v1/jobs/{job}/events", timeout=LONG).text
    assert "event: finished" in events
    assert job in [entry["id"] for entry in two.get("/v1/jobs?limit=1000").json()["jobs"]]
    assert two.delete(f"/v1/jobs/{job}").status_code == 204
    assert one.get(f"/v1/jobs/{job}").status_code == 404


def test_the_same_request_with_the_same_key_is_one_job(apis: List[Api]) -> None:
    one, two = apis
    mesh = one.upload(*sphere(3))
    key = {**ASYNC, "Idempotency-Key": uuid.uuid4().hex}
    first = one.post("/v1/karcher-means", mean(mesh, 2), headers=key).json()["id"]
    again = two.post("/v1/karcher-means", mean(mesh, 2), headers=key)
    assert again.status_code == 202 and again.json()["id"] == first
    assert again.headers["Location"] == f"/v1/jobs/{first}"
    waited = two.post("/v1/karcher-means", mean(mesh, 2), headers={**key, "Prefer": "wait=5"})
    assert waited.status_code == 202 and waited.json()["id"] == first
    other = two.post("/v1/karcher-means", mean(mesh, 3), headers=key)
    assert other.status_code == 422 and other.json()["code"] == "job.key_reused"
    for wrong in ("two words", "x" * 256):
        refused = one.post("/v1/karcher-means", mean(mesh, 2), headers={**ASYNC, "Idempotency-Key": wrong}, faulty=True)
        assert refused.status_code == 400 and refused.json()["code"] == "request.invalid_parameter", wrong
    assert finished(two, first)["state"] == "successful"


def test_a_job_of_a_server_that_is_killed_ends_at_another_one(apis: List[Api], replicas: Replicas) -> None:
    one, two = apis
    running = one.post("/v1/simulations", long_simulation(), headers=ASYNC).json()["id"]
    end = time.monotonic() + LONG
    while one.get(f"/v1/jobs/{running}").json()["state"] != "running" and time.monotonic() < end:
        time.sleep(0.02)
    where = [api for api in apis if 'supple_jobs{state="running"} 1' in requests.get(api.server.url + "/metrics", timeout=LONG).text]
    victim = where[0] if where else one
    other = two if victim is one else one
    victim.server.kill()
    status = finished(other, running, 600 * SLOWNESS)
    assert status["state"] == "successful", status
    victim.server.start()
    assert victim.get(f"/v1/jobs/{running}/result").status_code == 200


def test_a_job_is_dismissed_and_followed_through_another_server(apis: List[Api]) -> None:
    one, two = apis
    jobs = [one.post("/v1/simulations", long_simulation(), headers=ASYNC).json()["id"] for _ in range(2)]
    end = time.monotonic() + LONG
    progress = 0.0
    while progress == 0 and time.monotonic() < end:
        progress = max(two.get(f"/v1/jobs/{job}").json()["progress"] for job in jobs)
        time.sleep(0.1)
    assert progress > 0
    with requests.get(f"{two.server.url}/v1/jobs/{jobs[0]}/events", stream=True, timeout=LONG) as stream:
        first = next(stream.iter_lines())
        assert first == b"event: progress"
    for job in jobs:
        assert two.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
        assert finished(one, job)["state"] == "dismissed"
    end = time.monotonic() + LONG
    while time.monotonic() < end and any(api.get("/readyz").json()["jobs_running"] for api in apis):
        time.sleep(0.1)
    assert not any(api.get("/readyz").json()["jobs_running"] for api in apis), "dismissed jobs are stopped where they run"


def test_servers_go_on_once_the_database_is_back(apis: List[Api], replicas: Replicas) -> None:
    one, two = apis
    mesh = one.upload(*sphere(3))
    replicas.kill_database()
    try:
        for api in apis:
            assert api.get("/healthz").status_code == 200
            refused = api.get("/readyz")
            assert refused.status_code == 503 and refused.json()["code"] == "store.unavailable"
            assert api.post("/v1/karcher-means", mean(mesh, 4), headers=ASYNC).status_code == 503
    finally:
        replicas.start_database()
    assert finished(two, one.post("/v1/karcher-means", mean(mesh, 4), headers=ASYNC).json()["id"])["state"] == "successful"


def test_a_server_that_drains_answers_but_is_not_ready(replicas: Replicas, contract: Contract) -> None:
    first = replicas.servers[0]
    server = ServerProcess(first.data, *first.arguments, "--drain", "4")
    server.log = first.log.with_name("drained.log")
    server.start()
    try:
        api = Api(server, contract)
        server._process.terminate()  # type: ignore[union-attr]
        end = time.monotonic() + LONG
        while api.get("/readyz").status_code == 200 and time.monotonic() < end:
            time.sleep(0.01)
        assert api.get("/readyz").json()["code"] == "server.shutting_down"
        assert api.get("/v1/jobs").status_code == 200
        assert server._process.wait(LONG) == 0  # type: ignore[union-attr]
        assert re.search(r"not ready any more", server.log_text())
    finally:
        server.stop()


def test_a_folder_of_another_database_is_refused(replicas: Replicas, tmp_path: Path) -> None:
    first = replicas.servers[0]
    server = ServerProcess(tmp_path / "elsewhere", *first.arguments)
    with pytest.raises(RuntimeError, match="is not the one that this database belongs to"):
        server.start()
