"""Keys: authentication, permissions of keys, owners of meshes and jobs, sessions of browsers, and the log."""

from __future__ import annotations

import os
import re
import shutil
import stat
import subprocess
import time
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, Tuple

import pytest
import requests

from contract import Contract, ROOT
from design_requests import long_request as long_design, quick_request as quick_design
from harness import CLI, MESHES, SERVER, Api, ServerProcess, free_port, keys_command, problem_code
from shapes import bumpy_sphere, flat_grid
from working_time import PATIENCE_SECONDS
from test_jobs import start_job as start_named_job

NewServer = Callable[..., ServerProcess]
SHORT = {"pairs": [{"from": {"vertex": 0}, "to": {"vertex": 1}}]}
UNKNOWN_MESH = "0" * 64
UNKNOWN_JOB = "0" * 32


def add_key(data: Path, name: str, scopes: str, *more: str) -> str:
    return keys_command(data, "add", "--name", name, "--scopes", scopes, *more)


def id_of(key: str) -> str:
    return key.split("_")[1]


def secret_of(key: str) -> str:
    return key.split("_")[2]


def looks_at_keys(server: ServerProcess) -> int:
    """How often the server has read a changed file of keys."""
    return len(re.findall(r"keys: \d+ are in ", server.log_text()))


@contextmanager
def seen_by(server: ServerProcess) -> Iterator[None]:
    """A context for one change of the key file. At its end the server has read the file, which it does at a request, up to a second later."""
    before, end = looks_at_keys(server), time.monotonic() + 60
    yield
    while looks_at_keys(server) == before:
        assert time.monotonic() < end
        requests.get(f"{server.url}/v1/meshes", timeout=PATIENCE_SECONDS)
        time.sleep(0.02)


@pytest.fixture(scope="module")
def keyed(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """(process, keys by their names) of a server with keys."""
    data = tmp_path_factory.mktemp("keyed") / "data"
    keys = {
        "reader": add_key(data, "reader", "read"),
        "alice": add_key(data, "alice", "read,compute"),
        "bob": add_key(data, "bob", "read,compute"),
        "admin": add_key(data, "admin", "admin"),
    }
    server = ServerProcess(data, "--workers", "1").start()
    yield server, keys
    assert server.running()
    assert server.terminate() == 0


@pytest.fixture
def server(keyed: Tuple[ServerProcess, Dict[str, str]]) -> ServerProcess:
    return keyed[0]


@pytest.fixture
def keys(keyed: Tuple[ServerProcess, Dict[str, str]]) -> Dict[str, str]:
    return keyed[1]


@pytest.fixture
def alice(server: ServerProcess, keys: Dict[str, str], contract: Contract) -> Api:
    return Api(server, contract, keys["alice"])


@pytest.fixture
def bob(server: ServerProcess, keys: Dict[str, str], contract: Contract) -> Api:
    return Api(server, contract, keys["bob"])


@pytest.fixture
def admin(server: ServerProcess, keys: Dict[str, str], contract: Contract) -> Api:
    return Api(server, contract, keys["admin"])


@pytest.fixture
def nobody(server: ServerProcess, contract: Contract) -> Api:
    return Api(server, contract)


# --- authentication --------------------------------------------------------------------------------------------------


def test_without_a_key_nothing_of_v1_is_answered_and_the_answer_says_what_to_send(nobody: Api) -> None:
    for method, path in sorted(nobody.contract.operations()):
        concrete = (path.replace("{mesh}", UNKNOWN_MESH).replace("{job}", UNKNOWN_JOB)
                    .replace("{family}", "IH01").replace("{model}", "ih21"))
        if not path.startswith("/v1/") or path == "/v1/session":
            continue
        response = nobody.call(method, concrete, faulty=True)
        assert (response.status_code, problem_code(response)) == (401, "access.key_required"), (method, path)
        assert response.headers["WWW-Authenticate"].startswith("Bearer")
        assert "Authorization" in response.json()["hint"]


def test_probes_and_the_contract_need_no_key(nobody: Api) -> None:
    for path in ("/healthz", "/readyz", "/openapi.yaml", "/metrics"):
        assert nobody.get(path).status_code == 200, path
    assert nobody.get("/v1/nowhere", faulty=True).status_code == 404


def test_metrics_through_a_proxy_need_a_key(nobody: Api, alice: Api) -> None:
    passed_on = {"X-Forwarded-For": "203.0.113.7"}
    assert problem_code(nobody.get("/metrics", headers=passed_on)) == "access.key_required"
    assert alice.get("/metrics", headers=passed_on).status_code == 200


@pytest.mark.parametrize("authorization", [
    "Bearer", "Bearer x", "Basic YTpi", "supple_0123456789ab_" + "0" * 64, "Bearer supple_0123456789ab_" + "0" * 64,
], ids=["nothing", "nonsense", "basic", "no-scheme", "unknown"])
def test_a_key_of_another_form_or_an_unknown_one_is_not_accepted(nobody: Api, authorization: str) -> None:
    response = nobody.get("/v1/meshes", headers={"Authorization": authorization})
    assert (response.status_code, problem_code(response)) == (401, "access.key_invalid")


def test_a_wrong_secret_is_answered_like_an_unknown_key(nobody: Api, keys: Dict[str, str]) -> None:
    def detail(key: str) -> str:
        response = nobody.get("/v1/meshes", headers={"Authorization": "Bearer " + key})
        assert problem_code(response) == "access.key_invalid"
        return str(response.json()["detail"]).replace(id_of(key), "ID")

    assert detail(f"supple_{id_of(keys['alice'])}_{'0' * 64}") == detail("supple_0123456789ab_" + "0" * 64)
    assert detail(f"supple_{id_of(keys['alice'])}_{secret_of(keys['bob'])}") == detail("supple_0123456789ab_" + "0" * 64)


def test_a_key_is_asked_for_before_a_body_is_read(server: ServerProcess) -> None:
    import socket
    with socket.create_connection(("127.0.0.1", server.port), timeout=60) as connection:
        connection.sendall(b"POST /v1/meshes HTTP/1.1\r\nHost: localhost\r\nContent-Type: model/obj\r\n"
                           b"Content-Length: 400000000\r\n\r\n")
        assert connection.recv(100).startswith(b"HTTP/1.1 401")


def test_a_key_has_the_scopes_that_it_was_given(server: ServerProcess, keys: Dict[str, str], contract: Contract) -> None:
    reader = Api(server, contract, keys["reader"])
    assert reader.get("/v1/meshes").status_code == 200
    for response in (reader.post("/v1/geodesics", {"mesh": UNKNOWN_MESH, **SHORT}), reader.delete(f"/v1/jobs/{UNKNOWN_JOB}")):
        assert (response.status_code, problem_code(response)) == (403, "access.scope")
        assert "needs the scope compute" in response.json()["detail"]


def test_a_key_that_sends_too_much_waits_as_long_as_it_is_told(new_server: NewServer, tmp_path: Path,
                                                              contract: Contract) -> None:
    data = tmp_path / "data"
    slow = add_key(data, "slow", "read", "--rate", "30")
    quick = add_key(data, "quick", "read")
    server = new_server()
    api = Api(server, contract, slow)
    # One more request is permitted every two seconds, so that the refusal may come later on a slow machine.
    statuses = []
    while not statuses or statuses[-1] == 200:
        refused = api.get("/v1/meshes")
        statuses.append(refused.status_code)
    assert 30 <= statuses.count(200) < 60
    assert (refused.status_code, problem_code(refused)) == (429, "access.rate")
    assert {name: refused.json()[name] for name in ("limit", "value", "setting")} == {"limit": 30, "value": 31, "setting": "--rate"}
    assert Api(server, contract, quick).get("/v1/meshes").status_code == 200
    assert refused.headers["Retry-After"] in ("1", "2")
    time.sleep(int(refused.headers["Retry-After"]))
    assert api.get("/v1/meshes").status_code == 200


def long_request(mesh: str) -> Any:
    """A request that takes many seconds on a bumpy sphere."""
    return {"mesh": mesh, "sites": {"count": 300}, "objectives": {"edge_length": 1}, "accuracy": {"tolerance": 1e-12},
            "max_iterations": 1000}


def start_job(api: Api, mesh: str) -> str:
    response = api.post("/v1/voronoi-optimizations", long_request(mesh), headers={"Prefer": "respond-async"})
    assert response.status_code == 202, response.text
    return str(response.json()["id"])


def test_the_jobs_of_a_key_that_may_wait_are_bounded(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    key = add_key(tmp_path / "data", "few", "read,compute", "--max-waiting-jobs", "1")
    few = Api(new_server("--workers", "1"), contract, key)
    mesh = few.upload(*bumpy_sphere(5))
    few.wait_for_job(start_job(few, mesh), states=("running",))
    start_job(few, mesh)
    refused = few.post("/v1/voronoi-optimizations", long_request(mesh), headers={"Prefer": "respond-async"})
    assert (refused.status_code, problem_code(refused)) == (429, "job.client_queue_full")
    assert int(refused.headers["Retry-After"]) >= 1


def test_the_bytes_that_a_key_stores_are_bounded(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    data = tmp_path / "data"
    limit = 150_000
    small = add_key(data, "small", "read,compute", "--max-stored", str(limit))
    large = add_key(data, "large", "read,compute")
    header, *rows = keys_command(data, "list").splitlines()
    column = header.index("STORED")
    assert [row[column:].split()[0] for row in rows] == [str(limit), "-"]
    server = new_server()
    few, many = Api(server, contract, small), Api(server, contract, large)

    def field(api: Api, mesh: str, vertex: int) -> Any:
        response = api.post("/v1/geodesic-fields", {"mesh": mesh, "sources": [{"vertex": vertex}]}, headers={"Prefer": "respond-async"})
        assert response.status_code == 202, response.text
        return api.wait_for_job(response.json()["id"])

    mesh = few.upload(*flat_grid(30))
    others = many.upload(*flat_grid(100))
    assert field(many, others, 0)["state"] == "successful", "another key has no such limit"
    refused = few.post("/v1/meshes", {"vertices": [list(map(float, v)) for v in flat_grid(100)[0]],
                                      "faces": [list(map(int, f)) for f in flat_grid(100)[1]]})
    assert (refused.status_code, problem_code(refused)) == (507, "store.key_quota")
    problem = refused.json()
    assert (problem["limit"], problem["setting"]) == (limit, "--max-stored") and problem["value"] > limit
    assert meshes_of(few) == {mesh}, "what was refused is not its own"

    jobs = [field(few, mesh, vertex)["id"] for vertex in range(12)]
    kept = [job["id"] for job in few.get("/v1/jobs").json()["jobs"]]
    assert kept == jobs[::-1][:len(kept)] and 0 < len(kept) < len(jobs), "the oldest results make room for new ones"
    assert few.get(f"/v1/jobs/{kept[-1]}/result").status_code == 200
    assert "--max-stored" in server.log_text()
    stored = [path.stat().st_size for folder in ("meshes", "results", "requests") for path in (data / folder).iterdir()
              if path.stem in {mesh, *kept}]
    assert sum(stored) <= limit

    few.upload(*flat_grid(40))
    assert len(few.get("/v1/jobs").json()["jobs"]) < len(kept), "results go for a mesh too"
    assert len(jobs_of(many)) == 1, "nobody else's go"

    bytes_of_mesh = (data / "meshes" / f"{mesh}.ply").stat().st_size
    with seen_by(server):
        tiny = Api(server, contract, add_key(data, "tiny", "read,compute", "--max-stored", str(bytes_of_mesh + 4000)))
    assert tiny.upload(*flat_grid(30)) == mesh
    failed = field(tiny, mesh, 0)
    assert (failed["state"], failed["error"]["code"]) == ("failed", "store.key_quota")


# --- owners ----------------------------------------------------------------------------------------------------------


def meshes_of(api: Api) -> "set[str]":
    return {mesh["id"] for mesh in api.get("/v1/meshes?limit=1000").json()["meshes"]}


def jobs_of(api: Api) -> "set[str]":
    return {job["id"] for job in api.get("/v1/jobs?limit=1000").json()["jobs"]}


def same_answer(mine: requests.Response, unknown: requests.Response, id_: str, unknown_id: str) -> None:
    """Checks that the answer for an object of another owner is, word by word, that for one that does not exist."""
    assert mine.status_code == unknown.status_code == 404
    assert mine.text.replace(id_, "ID") == unknown.text.replace(unknown_id, "ID")


def test_a_mesh_is_its_owners_and_that_of_admins(alice: Api, bob: Api, admin: Api) -> None:
    mesh = alice.upload(*flat_grid(3))
    assert mesh in meshes_of(alice) and mesh in meshes_of(admin) and mesh not in meshes_of(bob)
    for method, path in (("GET", "/v1/meshes/{}"), ("GET", "/v1/meshes/{}/content"), ("DELETE", "/v1/meshes/{}")):
        same_answer(bob.call(method, path.format(mesh)), bob.call(method, path.format(UNKNOWN_MESH)), mesh, UNKNOWN_MESH)
    point = {"vertex": 0}
    for path, body in (
        ("/v1/geodesics", SHORT), ("/v1/geodesic-fields", {"sources": [point]}), ("/v1/karcher-means", {"points": [point, point]}),
        ("/v1/exponential-maps", {"start": point, "tangent": [0.1, 0.1, 0]}), ("/v1/voronoi-diagrams", {"sites": [point]}),
        ("/v1/voronoi-optimizations", {"sites": [point], "objectives": {"centroidal": 1}}),
        ("/v1/embedded-systems", {"points": [point, {"vertex": 1}], "springs": [{"between": [0, 1], "rest_length": 1}]}),
    ):
        same_answer(bob.post(path, {"mesh": mesh, **body}), bob.post(path, {"mesh": UNKNOWN_MESH, **body}), mesh, UNKNOWN_MESH)
    for api in (alice, admin):
        assert api.get(f"/v1/meshes/{mesh}").status_code == 200
        assert api.post("/v1/geodesics", {"mesh": mesh, **SHORT}).status_code == 200
    assert alice.delete(f"/v1/meshes/{mesh}").status_code == 204
    assert alice.get(f"/v1/meshes/{mesh}").status_code == 404


def test_one_mesh_of_two_owners_goes_with_the_last(alice: Api, bob: Api, admin: Api) -> None:
    body = (MESHES / "ball.obj").read_bytes()
    headers = {"Content-Type": "model/obj"}
    first = alice.call("POST", "/v1/meshes", body=body, headers=headers)
    second = bob.call("POST", "/v1/meshes", body=body, headers=headers)
    again = bob.call("POST", "/v1/meshes", body=body, headers=headers)
    assert [first.status_code, second.status_code, again.status_code] == [201, 201, 200]
    mesh = first.json()["id"]
    assert alice.delete(f"/v1/meshes/{mesh}").status_code == 204
    assert alice.get(f"/v1/meshes/{mesh}").status_code == 404
    assert bob.post("/v1/geodesics", {"mesh": mesh, **SHORT}).status_code == 200
    assert mesh in meshes_of(admin)
    assert bob.delete(f"/v1/meshes/{mesh}").status_code == 204
    assert mesh not in meshes_of(admin)


def test_an_admin_deletes_a_mesh_for_all(alice: Api, bob: Api, admin: Api) -> None:
    mesh = alice.upload(*flat_grid(4))
    assert bob.upload(*flat_grid(4)) == mesh
    assert admin.delete(f"/v1/meshes/{mesh}").status_code == 204
    assert alice.get(f"/v1/meshes/{mesh}").status_code == bob.get(f"/v1/meshes/{mesh}").status_code == 404


def test_a_mesh_that_a_job_uses_is_kept_for_its_last_owner_alone(alice: Api, bob: Api) -> None:
    mesh = alice.upload(*bumpy_sphere(5))
    job = start_job(alice, mesh)
    assert problem_code(alice.delete(f"/v1/meshes/{mesh}")) == "mesh.in_use"
    assert bob.upload(*bumpy_sphere(5)) == mesh
    assert alice.delete(f"/v1/meshes/{mesh}").status_code == 204
    assert alice.delete(f"/v1/jobs/{job}").status_code == 200
    assert bob.get(f"/v1/meshes/{mesh}").status_code == 200


def test_a_job_and_its_result_are_its_owners_and_that_of_admins(alice: Api, bob: Api, admin: Api) -> None:
    mesh = alice.upload(*flat_grid(5))
    response = alice.post("/v1/geodesics", {"mesh": mesh, **SHORT}, headers={"Prefer": "respond-async"})
    job = response.json()["id"]
    alice.wait_for_job(job)
    assert job in jobs_of(alice) and job in jobs_of(admin) and job not in jobs_of(bob)
    for method, path in (("GET", "/v1/jobs/{}"), ("GET", "/v1/jobs/{}/result"), ("GET", "/v1/jobs/{}/events"),
                         ("DELETE", "/v1/jobs/{}")):
        same_answer(bob.call(method, path.format(job)), bob.call(method, path.format(UNKNOWN_JOB)), job, UNKNOWN_JOB)
    assert admin.get(f"/v1/jobs/{job}/result").json() == alice.get(f"/v1/jobs/{job}/result").json()
    assert admin.delete(f"/v1/jobs/{job}").status_code == 204
    assert alice.get(f"/v1/jobs/{job}").status_code == 404


def test_an_answer_that_becomes_a_job_is_its_owners_too(alice: Api, bob: Api) -> None:
    mesh = alice.upload(*bumpy_sphere(5))
    response = alice.post("/v1/voronoi-optimizations", long_request(mesh), headers={"Prefer": "wait=0.2"})
    assert response.status_code == 202
    job = response.json()["id"]
    assert bob.get(f"/v1/jobs/{job}").status_code == bob.delete(f"/v1/jobs/{job}").status_code == 404
    assert job not in jobs_of(bob)
    assert alice.delete(f"/v1/jobs/{job}").status_code == 200


def test_one_keys_session_of_designs_replaces_nothing_of_anothers(new_server: NewServer, tmp_path: Path,
                                                                  contract: Contract) -> None:
    keys = [add_key(tmp_path / "data", name, "read,compute") for name in ("alice", "bob")]
    models = tmp_path / "models"
    models.mkdir()
    for name in ("ih29.h5", "ih67.h5"):
        shutil.copy(ROOT / "models" / name, models)
    server = new_server("--models", str(models), "--workers", "2")
    first, second = (Api(server, contract, key) for key in keys)
    job = start_named_job(first, "/v1/designs", long_design(session="drag"))
    first.wait_for_job(job, states=("running",))
    second.ok("/v1/designs", quick_design(session="drag"))
    # When a job reports progress, it also checks for stop requests.
    progress, end = first.get(f"/v1/jobs/{job}").json()["progress"], time.monotonic() + 60
    while (document := first.get(f"/v1/jobs/{job}").json())["progress"] == progress:
        assert document["state"] == "running" and time.monotonic() < end
        time.sleep(0.02)
    assert document["state"] == "running"
    first.ok("/v1/designs", quick_design(session="drag"))
    assert first.wait_for_job(job)["error"]["code"] == "design.superseded"


def test_lists_have_pages_of_ones_own(alice: Api, bob: Api) -> None:
    for api in (alice, bob):
        for mesh in meshes_of(api):
            api.delete(f"/v1/meshes/{mesh}")
    own = []
    for size in range(2, 7):
        own.insert(0, alice.upload(*flat_grid(size)))
        bob.upload(*flat_grid(size + 10))
    first = alice.get("/v1/meshes?limit=3").json()
    rest = alice.get(f"/v1/meshes?limit=3&after={first['next']}").json()
    assert [mesh["id"] for mesh in first["meshes"] + rest["meshes"]] == own
    assert "next" not in rest


def test_owners_outlive_a_restart(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    data = tmp_path / "data"
    alices, bobs = add_key(data, "alice", "read,compute"), add_key(data, "bob", "read,compute")
    server = new_server()
    mesh = Api(server, contract, alices).upload(*flat_grid(3))
    server.kill()
    server.start()
    assert Api(server, contract, alices).get(f"/v1/meshes/{mesh}").status_code == 200
    assert Api(server, contract, bobs).get(f"/v1/meshes/{mesh}").status_code == 404


# --- changes of keys -------------------------------------------------------------------------------------------------


def test_keys_are_added_rotated_and_revoked_without_a_restart(new_server: NewServer, tmp_path: Path,
                                                              contract: Contract) -> None:
    data = tmp_path / "data"
    server = new_server()
    assert Api(server, contract).get("/v1/meshes").status_code == 200
    with seen_by(server):
        first = add_key(data, "lab", "read,compute")
    assert problem_code(Api(server, contract).get("/v1/meshes")) == "access.key_required"
    mesh = Api(server, contract, first).upload(*flat_grid(3))

    with seen_by(server):
        second = keys_command(data, "rotate", id_of(first), "--overlap", "1h")
    for key in (first, second):
        assert Api(server, contract, key).get(f"/v1/meshes/{mesh}").status_code == 200
    with seen_by(server):
        third = keys_command(data, "rotate", id_of(first), "--overlap", "0")
    for key in (first, second):
        assert problem_code(Api(server, contract, key).get("/v1/meshes")) == "access.key_invalid"
    assert Api(server, contract, third).get(f"/v1/meshes/{mesh}").status_code == 200

    with seen_by(server):
        keys_command(data, "revoke", id_of(first))
    assert problem_code(Api(server, contract, third).get("/v1/meshes")) == "access.key_invalid"
    assert problem_code(Api(server, contract).get("/v1/meshes")) == "access.key_required"


def test_a_key_expires(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    add_key(tmp_path / "data", "long", "read")
    server = new_server()
    begin = time.time()
    with seen_by(server):
        api = Api(server, contract, add_key(tmp_path / "data", "short", "read", "--expires", "6s"))
    assert api.get("/v1/meshes").status_code == 200
    while (response := api.get("/v1/meshes")).status_code == 200:
        assert time.time() < begin + 60
        time.sleep(0.1)
    assert time.time() >= begin + 5  # expiry has a resolution of a second
    assert problem_code(response) == "access.key_invalid" and "has expired on" in response.json()["detail"]


def test_the_key_file_holds_no_secret_and_is_its_users_alone(tmp_path: Path) -> None:
    key = add_key(tmp_path / "data", "lab", "read")
    path = tmp_path / "data" / "keys"
    assert secret_of(key) not in path.read_text()
    assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert secret_of(key) not in keys_command(tmp_path / "data", "list")
    assert id_of(key) in keys_command(tmp_path / "data", "list")


@pytest.mark.parametrize("arguments, said", [
    (["add", "--name", "x", "--scopes", "all"], "no scope 'all'"),
    (["add", "--name", "x", "--scopes", "read", "--expires", "tomorrow"], "'tomorrow' is no duration"),
    (["add", "--name", "", "--scopes", "read"], "1 to 64"),
    (["add", "--scopes", "read"], "--name is required"),
    (["rotate", "0123456789ab"], "no key '0123456789ab'"),
    (["revoke", "0123456789ab"], "no key '0123456789ab'"),
    ([], "subcommand is required"),
])
def test_a_mistake_in_a_command_is_told(tmp_path: Path, arguments: "list[str]", said: str) -> None:
    done = subprocess.run([str(SERVER), "--data", str(tmp_path), "keys", *arguments], capture_output=True, text=True, timeout=60)
    assert done.returncode != 0 and said in done.stderr and done.stdout == ""
    assert not (tmp_path / "keys").exists()


# --- servers that require keys ---------------------------------------------------------------------------------------


def start_and_see(*arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([str(SERVER), "--port", str(free_port()), *arguments], capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1"])
def test_beyond_loopback_the_server_does_not_start_without_a_key(tmp_path: Path, host: str) -> None:
    ended = start_and_see("--host", host, "--data", str(tmp_path / "data"))
    assert ended.returncode == 1
    assert "supple-server keys add" in ended.stderr and "--open" in ended.stderr
    assert not (tmp_path / "data").exists()


def test_a_file_without_any_key_is_no_start_either(tmp_path: Path) -> None:
    keys_command(tmp_path, "revoke", id_of(add_key(tmp_path, "x", "read")))
    ended = start_and_see("--data", str(tmp_path))
    assert ended.returncode == 1 and "has no key" in ended.stderr


def test_a_file_that_others_may_write_is_no_start_either(tmp_path: Path) -> None:
    add_key(tmp_path, "x", "read")
    os.chmod(tmp_path / "keys", 0o666)
    ended = start_and_see("--data", str(tmp_path))
    assert ended.returncode == 1 and "chmod 600" in ended.stderr


def test_beyond_loopback_keys_are_needed_unless_the_server_is_open(new_server: NewServer, tmp_path: Path,
                                                                   contract: Contract) -> None:
    key = add_key(tmp_path / "closed", "x", "read")
    closed = new_server("--host", "0.0.0.0", data="closed")
    assert problem_code(Api(closed, contract).get("/v1/meshes")) == "access.key_required"
    assert Api(closed, contract, key).get("/v1/meshes").status_code == 200
    opened = new_server("--host", "0.0.0.0", "--open", data="opened")
    assert Api(opened, contract).get("/v1/meshes").status_code == 200


def test_an_open_server_takes_a_key_along_without_a_word(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    key = add_key(tmp_path / "data", "x", "read")
    opened = new_server("--open")
    for api in (Api(opened, contract), Api(opened, contract, key)):
        assert api.post("/v1/geodesics", {"mesh": UNKNOWN_MESH, **SHORT}).status_code == 404
        assert api.get("/v1/session").json() == {"key_required": False}


# --- sessions of browsers --------------------------------------------------------------------------------------------


def sign_in(server: ServerProcess, contract: Contract, key: str) -> Tuple[Api, str]:
    """An Api with the cookie of a session, and the header of the cookie."""
    api = Api(server, contract)
    response = api.post("/v1/session", {"key": key})
    assert response.status_code == 200, response.text
    return api, response.headers["Set-Cookie"]


def test_a_browser_signs_in_and_out(server: ServerProcess, keys: Dict[str, str], contract: Contract) -> None:
    own = {"Origin": server.url}
    api = Api(server, contract)
    assert api.get("/v1/session").json() == {"key_required": True}
    api, cookie = sign_in(server, contract, keys["alice"])
    assert secret_of(keys["alice"]) not in cookie
    assert {"HttpOnly", "SameSite=Strict", "Path=/", "Max-Age=28800"} <= {part.strip() for part in cookie.split(";")}
    assert "Secure" not in cookie
    session = api.get("/v1/session").json()
    assert session["key"] == {"id": id_of(keys["alice"]), "name": "alice", "scopes": ["read", "compute"]}
    assert api.get("/v1/meshes").status_code == 200
    assert api.post("/v1/geodesics", {"mesh": UNKNOWN_MESH, **SHORT}, headers=own).status_code == 404
    token = api.session.cookies["supple_session"]
    assert api.delete("/v1/session", headers=own).status_code == 204
    assert "supple_session" not in api.session.cookies
    assert problem_code(api.get("/v1/meshes")) == "access.key_required"
    kept = api.get("/v1/meshes", headers={"Cookie": f"supple_session={token}"})
    assert problem_code(kept) == "access.key_invalid", "the server has ended it too"


def test_another_page_does_not_act_for_who_has_signed_in(server: ServerProcess, keys: Dict[str, str],
                                                         contract: Contract) -> None:
    api, _ = sign_in(server, contract, keys["alice"])
    request = {"mesh": UNKNOWN_MESH, **SHORT}
    for headers in ({}, {"Origin": "http://localhost:1"}, {"Sec-Fetch-Site": "same-site"}):
        assert problem_code(api.post("/v1/geodesics", request, headers=headers)) == "access.key_required", headers


def test_over_tls_the_cookie_stays_there(server: ServerProcess, keys: Dict[str, str], contract: Contract) -> None:
    response = Api(server, contract).post("/v1/session", {"key": keys["alice"]}, headers={"Origin": "https://localhost"})
    assert response.headers["Set-Cookie"].endswith("; Secure")


def test_a_wrong_key_opens_no_session(nobody: Api) -> None:
    response = nobody.post("/v1/session", {"key": "supple_0123456789ab_" + "0" * 64})
    assert (response.status_code, problem_code(response)) == (401, "access.key_invalid")
    assert "Set-Cookie" not in response.headers
    assert nobody.post("/v1/session", {"key": 1}, faulty=True).status_code == 400
    assert nobody.call("POST", "/v1/session", body=b"{}", headers={"Content-Type": "text/plain"}, faulty=True).status_code == 415


def test_a_session_ends_with_its_key(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    data = tmp_path / "data"
    key = add_key(data, "x", "read")
    add_key(data, "other", "read")
    server = new_server()
    api, _ = sign_in(server, contract, key)
    assert api.get("/v1/meshes").status_code == 200
    with seen_by(server):
        keys_command(data, "revoke", id_of(key))
    assert problem_code(api.get("/v1/meshes")) == "access.key_invalid"


@pytest.mark.parametrize("signed_in", [False, True])
def test_a_stream_of_events_ends_with_what_allowed_it(new_server: NewServer, tmp_path: Path, contract: Contract,
                                                      signed_in: bool) -> None:
    data = tmp_path / "data"
    key = add_key(data, "x", "read,compute")
    add_key(data, "other", "read")
    server = new_server()
    owner = Api(server, contract, key)
    job = start_named_job(owner, "/v1/voronoi-optimizations", long_request(owner.upload(*bumpy_sphere(5))))
    follower = sign_in(server, contract, key)[0] if signed_in else owner
    with follower.session.get(f"{server.url}/v1/jobs/{job}/events", stream=True, timeout=PATIENCE_SECONDS) as stream:
        lines = stream.iter_lines(decode_unicode=True)
        assert next(lines) == "event: progress"
        if signed_in:
            assert follower.delete("/v1/session", headers={"Origin": server.url}).status_code == 204
        else:
            with seen_by(server):
                keys_command(data, "revoke", id_of(key))
        rest = list(lines)
    assert "event: finished" not in rest


def test_sessions_count_against_the_rate_of_their_key(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    key = add_key(tmp_path / "data", "x", "read", "--rate", "3")
    server = new_server()
    for _ in range(2):
        sign_in(server, contract, key)
    assert Api(server, contract, key).get("/v1/session").status_code == 200
    for response in (Api(server, contract).post("/v1/session", {"key": key}), Api(server, contract, key).get("/v1/session")):
        assert (response.status_code, problem_code(response)) == (429, "access.rate")


def test_the_page_itself_needs_no_key(new_server: NewServer, tmp_path: Path) -> None:
    web = tmp_path / "web"
    (web / "assets").mkdir(parents=True)
    (web / "index.html").write_text("<!doctype html><title>Supple</title>")
    (web / "assets" / "page-1234.js").write_text("// script")
    add_key(tmp_path / "data", "x", "read")
    server = new_server("--web", str(web))
    for path in ("/", "/index.html", "/assets/page-1234.js"):
        assert requests.get(server.url + path, timeout=PATIENCE_SECONDS).status_code == 200
    assert requests.get(server.url + "/v1/meshes", timeout=PATIENCE_SECONDS).status_code == 401


# --- the log ---------------------------------------------------------------------------------------------------------


def test_the_log_says_who_did_what_and_never_a_secret(new_server: NewServer, tmp_path: Path, contract: Contract) -> None:
    key = add_key(tmp_path / "data", "x", "read,compute")
    server = new_server("--access-log", "--log-level", "debug")
    api = Api(server, contract, key)
    mesh = api.upload(*flat_grid(3))
    api.delete(f"/v1/meshes/{mesh}")
    browser, cookie = sign_in(server, contract, key)
    browser.get("/v1/meshes")
    token = browser.session.cookies["supple_session"]
    Api(server, contract).get("/v1/meshes")
    wrong = "5" * 64
    Api(server, contract, f"supple_{id_of(key)}_{wrong}").get("/v1/meshes")
    Api(server, contract).post("/v1/session", {"key": f"supple_{id_of(key)}_{wrong}"})
    Api(server, contract).post("/v1/session", {"key": 7, key: key}, faulty=True)
    browser.delete("/v1/session", headers={"Origin": server.url})
    assert server.terminate() == 0

    log = server.log_text()
    audit = [line.split(" audit ", 1)[1] for line in log.splitlines() if " audit " in line]
    form = re.compile(r"[0-9a-f]{16} key=(\S+) address=127\.0\.0\.1 action=(\S+) method=\S+ object=(\S+) status=(\d+)")
    lines = [form.fullmatch(line).groups() for line in audit]  # type: ignore[union-attr]
    assert (id_of(key), "create", f"/v1/meshes/{mesh}", "201") in lines
    assert (id_of(key), "delete", f"/v1/meshes/{mesh}", "204") in lines
    assert lines.count(("-", "refused", "/v1/meshes", "401")) == 2
    assert (id_of(key), "sign-in", "/v1/session", "200") in lines
    assert ("-", "sign-in-refused", "/v1/session", "401") in lines
    assert (id_of(key), "sign-out", "/v1/session", "204") in lines
    for secret in (secret_of(key), token, wrong, cookie):
        assert secret not in log


# --- the clients -----------------------------------------------------------------------------------------------------


def test_the_command_line_client_sends_its_key(server: ServerProcess, keys: Dict[str, str], tmp_path: Path) -> None:
    path = tmp_path / "key"
    path.write_text(keys["alice"] + "\n")
    path.chmod(0o600)

    def run(*arguments: str, **environment: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([str(CLI), "--server", server.url, *arguments, "mesh", "list"], env=environment,
                              capture_output=True, text=True, timeout=60)

    refused = run()
    assert refused.returncode == 2 and "access.key_required" in refused.stderr and "supple-server keys add" in refused.stderr
    for done in (run("--key", keys["alice"]), run(SUPPLE_KEY=keys["alice"]), run("--key-file", str(path)),
                 run(SUPPLE_KEY_FILE=str(path))):
        assert (done.returncode, done.stderr) == (0, "")
    path.chmod(0o644)
    warned = run("--key-file", str(path))
    assert warned.returncode == 0 and "chmod 600" in warned.stderr
    path.write_text("two words")
    for wrong in (run("--key-file", str(path)), run("--key", keys["alice"] + "\nX: 1")):
        assert wrong.returncode == 1 and "no key of the form" in wrong.stderr and secret_of(keys["alice"]) not in wrong.stderr
    assert run("--key-file", str(tmp_path / "missing")).returncode == 5


def test_the_python_client_sends_its_key(server: ServerProcess, keys: Dict[str, str]) -> None:
    import supple
    with supple.Client(server.url) as client, pytest.raises(supple.AccessDenied) as refused:
        list(client.meshes())
    assert refused.value.code == "access.key_required"
    with supple.Client(server.url, key=keys["reader"]) as client:
        list(client.meshes())
        with pytest.raises(supple.AccessDenied) as refused:
            client.upload_arrays(*flat_grid(2))
    assert refused.value.code == "access.scope"
    with supple.Client(server.url, key=keys["alice"]) as client:
        mesh = client.upload_arrays(*flat_grid(2))
        assert mesh.geodesic(0, 1).distance > 0
