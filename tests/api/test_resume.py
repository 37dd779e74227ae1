"""Waiting and running jobs outlive the process, whether it is killed or terminated."""

from __future__ import annotations

import random
import time
from datetime import datetime, timedelta, timezone
from pathlib import Path
from typing import Any, Callable, Dict, List

import pytest

from contract import Contract
from harness import Api, ServerProcess, keys_command, problem_code, slow_relaxation, spoil_database
from shapes import bumpy_sphere

ASYNC = {"Prefer": "respond-async"}
FIELDS = "/v1/geodesic-fields"
NETWORKS = "/v1/embedded-systems"
NewServer = Callable[..., ServerProcess]


def field(mesh: str, vertex: int, **more: Any) -> Dict[str, Any]:
    return {"mesh": mesh, "sources": [{"vertex": vertex}], **more}


def long(mesh: str, **more: Any) -> Dict[str, Any]:
    """A request that takes some seconds."""
    return slow_relaxation(mesh, 2000, **more)


def submit(api: Api, request: Dict[str, Any], **headers: str) -> str:
    response = api.post(FIELDS if "sources" in request else NETWORKS, request, headers={**ASYNC, **headers})
    assert response.status_code == 202, response.text
    return str(response.json()["id"])


def moment(text: str) -> datetime:
    return datetime.fromisoformat(text.replace("Z", "+00:00"))


def kill_while_it_runs(server: ServerProcess, contract: Contract, job: str) -> None:
    Api(server, contract).wait_for_job(job, ("running",))
    server.kill()


def test_twenty_jobs_outlive_kill_9_at_random_times(new_server: NewServer, contract: Contract) -> None:
    seed = random.randrange(1 << 30)
    print(f"seed {seed}")
    moments = random.Random(seed)
    server = new_server("--workers", "1", "--max-attempts", "100")
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(3))
    expected = [api.ok(FIELDS, field(mesh, vertex))["distances"] for vertex in range(20)]
    jobs = [submit(api, field(mesh, vertex)) for vertex in range(20)]
    finished: Dict[str, Any] = {}
    for _ in range(6):
        time.sleep(moments.uniform(0, 0.2))
        server.kill()
        server.start()
        api = Api(server, contract)
        assert [job["id"] for job in api.get("/v1/jobs").json()["jobs"]] == jobs[::-1]
        for job in api.get("/v1/jobs?state=successful").json()["jobs"]:
            assert finished.setdefault(job["id"], job) == job, "a job that has ended is not run again"
    documents = [api.wait_for_job(job) for job in jobs]
    assert [document["state"] for document in documents] == 20 * ["successful"]
    started = [document["started"] for document in documents]
    assert started == sorted(started), "in the old order"
    for job, distances in zip(jobs, expected):
        assert api.get(f"/v1/jobs/{job}/result").json()["distances"] == distances


def test_a_job_that_the_server_ends_in_three_times_is_given_up(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--workers", "1")
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(3))
    poison = submit(api, long(mesh))
    harmless = submit(api, field(mesh, 0))
    for attempt in range(3):
        assert api.get(f"/v1/jobs/{poison}").json()["state"] in ("accepted", "running"), attempt
        kill_while_it_runs(server, contract, poison)
        server.start()
        api = Api(server, contract)
    document = api.get(f"/v1/jobs/{poison}").json()
    assert (document["state"], document["error"]["code"]) == ("failed", "job.given_up")
    assert [document["error"][name] for name in ("limit", "value", "setting")] == [3, 3, "--max-attempts"]
    result = api.get(f"/v1/jobs/{poison}/result")
    assert (result.status_code, problem_code(result)) == (500, "job.given_up")
    assert api.wait_for_job(harmless)["state"] == "successful"


def test_sigterm_leaves_what_does_not_end_in_its_grace_to_the_next_server(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--workers", "1", "--grace", "0.1", "--max-attempts", "1")
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(3))
    jobs = [submit(api, long(mesh)) for _ in range(2)]
    for _ in range(2):
        Api(server, contract).wait_for_job(jobs[0], ("running",))
        assert server.terminate() == 0
        server.start()
    api = Api(server, contract)
    assert [api.wait_for_job(job)["state"] for job in jobs] == 2 * ["successful"]


def test_a_resumed_job_answers_in_the_form_that_was_asked_for(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--workers", "1")
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(3))
    accept = "application/octet-stream"
    expected = api.post(FIELDS, field(mesh, 3), headers={"Accept": accept}).content
    first = submit(api, slow_relaxation(mesh, 100_000))  # still runs when the server is killed, and is removed then
    job = submit(api, field(mesh, 3), Accept=accept)
    points = [{"vertex": vertex % 640} for vertex in range(5000)]
    large = submit(api, {"mesh": mesh, "sources": points * 4})
    files = {path.stem for path in (server.data / "requests").iterdir()}
    assert {job, large} <= files, "each request has a file"
    server.kill()
    server.start()
    api = Api(server, contract)
    assert api.delete(f"/v1/jobs/{first}").status_code == 200
    assert api.wait_for_job(job)["state"] == "successful"
    result = api.get(f"/v1/jobs/{job}/result")
    assert (result.headers["Content-Type"], result.content) == (accept, expected)
    assert api.wait_for_job(large)["state"] == "successful"
    assert list((server.data / "requests").iterdir()) == []


@pytest.mark.parametrize("damage", ["overwritten", "lost"])
def test_jobs_that_wait_outlive_the_database_in_their_order_with_their_owner(damage: str, new_server: NewServer, tmp_path: Path,
                                                                            contract: Contract) -> None:
    keys = [keys_command(tmp_path / "data", "add", "--name", name, "--scopes", "read,compute") for name in ("alice", "bob")]
    server = new_server("--workers", "1")
    alice, bob = (Api(server, contract, key) for key in keys)
    mesh = alice.upload(*bumpy_sphere(3))
    assert bob.upload(*bumpy_sphere(3)) == mesh
    runs = submit(alice, long(mesh))
    alice.wait_for_job(runs, ("running",))
    expected = [alice.ok(FIELDS, field(mesh, vertex))["distances"] for vertex in range(5)]
    jobs = [submit(alice, field(mesh, vertex)) for vertex in range(5)]
    of_bob = submit(bob, field(mesh, 0))
    server.kill()
    for rest in server.data.glob("supple.sqlite-*"):
        rest.unlink()  # the database's log would repair the overwritten file
    spoil_database(server.data, damage)
    server.start()
    assert [job["id"] for job in alice.get("/v1/jobs").json()["jobs"]] == [*jobs[::-1], runs]
    assert [job["id"] for job in bob.get("/v1/jobs").json()["jobs"]] == [of_bob]
    assert alice.delete(f"/v1/jobs/{runs}").status_code == 200, "it has shown what it is there for"
    documents = [alice.wait_for_job(job) for job in jobs]
    assert [document["state"] for document in documents] == 5 * ["successful"]
    started = [document["started"] for document in documents]
    assert started == sorted(started)
    assert [alice.get(f"/v1/jobs/{job}/result").json()["distances"] for job in jobs] == expected


def test_a_job_that_a_client_has_waited_for_goes_on_as_well_and_is_listed_as_running(
        new_server: NewServer, contract: Contract) -> None:
    server = new_server("--workers", "1")
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(3))
    response = api.post(NETWORKS, long(mesh), headers={"Prefer": "wait=0.2"})
    assert response.status_code == 202
    job = response.json()["id"]
    assert [entry["id"] for entry in api.get("/v1/jobs?state=running").json()["jobs"]] == [job]
    kill_while_it_runs(server, contract, job)
    server.start()
    assert Api(server, contract).wait_for_job(job)["state"] == "successful"


def test_the_deadline_of_a_resumed_job_counts_from_the_start_of_its_server(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--workers", "1")
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(3))
    points = [{"vertex": vertex} for vertex in range(500)]
    endless = {"mesh": mesh, "points": points, "starts": 1000, "tolerance": 1e-15}  # takes at least ten seconds
    deadlines = {api.post("/v1/karcher-means", {**endless, "deadline": deadline}, headers=ASYNC).json()["id"]: deadline
                 for deadline in (4, 3)}
    running, waiting = deadlines
    created = api.get(f"/v1/jobs/{running}").json()["created"]
    kill_while_it_runs(server, contract, running)
    # A deadline that counted from the creation would pass too early by this time.
    while datetime.now(timezone.utc) < moment(created) + timedelta(seconds=1):
        time.sleep(0.02)
    begin = datetime.now(timezone.utc)
    server.start()
    api = Api(server, contract)
    for job in (waiting, running):
        document = api.wait_for_job(job)
        assert (document["error"]["code"], document["deadline"]) == ("job.deadline_exceeded", deadlines[job])
        lasted = moment(document["finished"]) - begin
        assert lasted.total_seconds() >= deadlines[job], "the time before the start does not count"
    assert api.get(f"/v1/jobs/{running}").json()["created"] == created


def test_a_job_that_is_dismissed_while_it_waits_again_does_not_run(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--workers", "1")
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(3))
    jobs: List[str] = [submit(api, long(mesh)) for _ in range(2)]
    kill_while_it_runs(server, contract, jobs[0])
    server.start()
    api = Api(server, contract)
    assert api.delete(f"/v1/jobs/{jobs[1]}").json()["state"] == "dismissed"
    assert api.delete(f"/v1/meshes/{mesh}").status_code == 409, "the first job works on it"
    server.kill()
    server.start()
    api = Api(server, contract)
    assert api.get(f"/v1/jobs/{jobs[1]}").json()["state"] == "dismissed"
    assert api.wait_for_job(jobs[0])["state"] == "successful"
    assert api.delete(f"/v1/meshes/{mesh}").status_code == 204


def test_a_job_is_not_made_twice_though_its_server_was_killed(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--workers", "1")
    mesh = Api(server, contract).upload(*bumpy_sphere(2))
    key = {"Idempotency-Key": "a-name-of-my-own"}
    job = submit(Api(server, contract), field(mesh, 1), **key)
    server.kill()
    server.start()
    assert submit(Api(server, contract), field(mesh, 1), **key) == job
    server.terminate()
    spoil_database(server.data, "lost")
    server.start()
    api = Api(server, contract)
    assert submit(api, field(mesh, 1), **key) == job
    refused = api.post(FIELDS, field(mesh, 2), headers={**ASYNC, **key})
    assert problem_code(refused) == "job.key_reused" and refused.status_code == 422
    assert submit(api, field(mesh, 1), **{"Idempotency-Key": "another-name"}) != job


def test_a_name_of_a_job_is_not_taken_for_another_format(new_server: NewServer, contract: Contract) -> None:
    api = Api(new_server(), contract)
    mesh = api.upload(*bumpy_sphere(2))
    key = {"Idempotency-Key": "a-name-of-my-own"}
    job = submit(api, field(mesh, 1), Accept="application/json", **key)
    refused = api.post(FIELDS, field(mesh, 1), headers={**ASYNC, **key, "Accept": "application/octet-stream"})
    assert problem_code(refused) == "job.key_reused" and refused.status_code == 422
    assert submit(api, field(mesh, 1), Accept="*/*", **key) == job, "the same format in other words"
