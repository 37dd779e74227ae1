"""The data folder when the disk or files in it fail."""

from __future__ import annotations

import os
import re
import resource
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, NamedTuple, Tuple

import pytest
import requests

from contract import Contract
from harness import Api, ServerProcess, problem_code, spoil_database
from shapes import bumpy_sphere, flat_grid, sphere
from working_time import PATIENCE_SECONDS

ASYNC = {"Prefer": "respond-async"}
FIELDS = "/v1/geodesic-fields"
NewServer = Callable[..., ServerProcess]


class SmallDisk(NamedTuple):
    """A disk of 64 MiB, which is the data folder of the test's servers."""
    data: Path  # for the servers
    path: Path  # of the same folder, for the test
    prefix: "Tuple[str, ...]" = ()  # of the command that starts a server


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[SmallDisk]:
    """A user who is not root mounts it in namespaces of a process that holds them. SUPPLE_TEST_SMALL_DISK names one where nobody may mount."""
    if mounted := os.environ.get("SUPPLE_TEST_SMALL_DISK"):
        yield SmallDisk(Path(mounted), Path(mounted))
        for path in Path(mounted).iterdir():
            shutil.rmtree(path) if path.is_dir() else path.unlink()
        return
    folder = tmp_path / "disk"
    folder.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", str(folder)], capture_output=True).returncode == 0:
        yield SmallDisk(folder, folder)
        subprocess.run(["umount", "--lazy", str(folder)], check=True)
        return
    mount = 'mount -t tmpfs -o size=64m tmpfs "$0" && echo mounted && exec sleep infinity'
    with subprocess.Popen(["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", mount, str(folder)],
                          stdout=subprocess.PIPE) as holder:
        try:
            assert holder.stdout is not None
            assert holder.stdout.readline() == b"mounted\n", "mounting takes root, or user namespaces"
            yield SmallDisk(folder, Path(f"/proc/{holder.pid}/root{folder}"),
                            ("nsenter", "--user", "--preserve-credentials", "--mount", "--target", str(holder.pid)))
        finally:
            holder.kill()


def fill(folder: Path) -> Path:
    """Fills the remaining space of a disk with a file, and returns it."""
    ballast = folder / "ballast"
    with ballast.open("wb") as file:
        space = os.statvfs(folder)
        os.posix_fallocate(file.fileno(), 0, space.f_bavail * space.f_frsize)
    return ballast


def test_a_job_that_ends_on_a_full_disk_fails_with_the_reason(small_disk: SmallDisk, new_server: NewServer,
                                                              contract: Contract) -> None:
    server = new_server("--min-free", "1mb", data=str(small_disk.data), prefix=small_disk.prefix)
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(7))
    job = api.post(FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]}, headers=ASYNC).json()["id"]
    api.wait_for_job(job, ("running",))
    ballast = fill(small_disk.path)
    document = api.wait_for_job(job)
    assert (document["state"], document["error"]["code"]) == ("failed", "store.full")
    assert api.get(f"/v1/jobs/{job}/result").status_code == 507
    assert [entry["id"] for entry in api.get("/v1/jobs?state=failed").json()["jobs"]] == [job]
    assert api.get("/v1/jobs?state=accepted").json()["jobs"] == []
    events = api.get(f"/v1/jobs/{job}/events").text
    assert events.startswith("event: finished\n") and events.count("event:") == 1
    assert job in server.log_text()
    ballast.unlink()
    assert api.get("/v1/jobs").json()["jobs"] == [document]
    assert server.terminate() == 0
    server.start()
    assert Api(server, contract).get(f"/v1/jobs/{job}").json() == document
    server.stop()


def test_a_full_disk_lets_jobs_and_meshes_be_deleted(small_disk: SmallDisk, new_server: NewServer, contract: Contract) -> None:
    api = Api(new_server("--min-free", "1mb", data=str(small_disk.data), prefix=small_disk.prefix), contract)
    meshes = [api.upload(*flat_grid(8)), api.upload(*sphere(2))]
    job = api.post(FIELDS, {"mesh": meshes[0], "sources": [{"vertex": 0}]}, headers=ASYNC).json()["id"]
    api.wait_for_job(job)
    # Several removals exhaust the free space in the database's log, and one reserve.
    for path in (f"/v1/jobs/{job}", *(f"/v1/meshes/{mesh}" for mesh in meshes)):
        wait_for_reserve(small_disk.path)
        ballast = fill(small_disk.path)
        assert api.delete(path).status_code == 204
        ballast.unlink()
    assert new_upload(api, 7).status_code == 201


def wait_for_reserve(data: Path) -> None:
    """Waits until the server has restored the reserve file, whose space it frees when a removal needs it."""
    deadline = time.monotonic() + PATIENCE_SECONDS
    while not (data / "reserve").exists():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def new_upload(api: Api, cells: int) -> requests.Response:
    vertices, faces = flat_grid(cells)
    return api.post("/v1/meshes", {"vertices": [list(map(float, v)) for v in vertices],
                                   "faces": [list(map(int, f)) for f in faces]})


def stored_bytes(server: ServerProcess) -> Dict[str, float]:
    """The bytes in the data folder by kind, from the metrics."""
    return {name.split('"')[1]: value for name, value in server.metrics().items() if name.startswith("supple_store_bytes")}


def quick_field(mesh: str, vertex: int) -> Dict[str, Any]:
    """A request whose result is as large as that of an exact field and takes no time."""
    return {"mesh": mesh, "sources": [{"vertex": vertex}], "accuracy": {"method": "edge_graph"}}


def test_the_oldest_results_go_where_there_is_no_room_and_then_the_answer_names_number_limit_and_setting(
        new_server: NewServer, contract: Contract) -> None:
    limit = 7_000_000  # bytes, of which the database's log takes up to 4 MB
    server = new_server("--max-store", str(limit))
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(5))
    jobs = []
    for vertex in range(30):
        jobs.append(api.post(FIELDS, quick_field(mesh, vertex), headers=ASYNC).json()["id"])
        assert api.wait_for_job(jobs[-1])["state"] == "successful"
        assert sum(stored_bytes(server).values()) <= limit
    assert server.metrics()["supple_store_limit_bytes"] == limit
    kept = [job["id"] for job in api.get("/v1/jobs").json()["jobs"]]
    assert kept == jobs[::-1][:len(kept)], "the newest are kept"
    assert 0 < len(kept) < 30
    assert api.get(f"/v1/jobs/{jobs[0]}").status_code == 404
    assert api.get(f"/v1/jobs/{kept[-1]}/result").status_code == 200
    refused = new_upload(api, 400)
    assert (refused.status_code, problem_code(refused)) == (507, "store.quota")
    problem = refused.json()
    assert (problem["limit"], problem["setting"]) == (limit, "--max-store")
    assert problem["value"] > limit
    assert [job["id"] for job in api.get("/v1/jobs").json()["jobs"]] == kept, "nothing goes in vain"
    before = stored_bytes(server)
    server.kill()
    server.start()
    after = stored_bytes(server)
    assert {**after, "database": 0} == {**before, "database": 0}, "counted exactly"
    for part in ("meshes", "results", "requests"):
        assert after[part] == sum(path.stat().st_size for path in (server.data / part).iterdir())


def test_lines_of_the_log_name_the_request_or_the_job_that_they_were_written_for(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--max-store", "7000000")
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(5))
    jobs = []
    for vertex in range(30):
        jobs.append(api.post(FIELDS, quick_field(mesh, vertex), headers=ASYNC).json()["id"])
        assert api.wait_for_job(jobs[-1])["state"] == "successful"
    upload = new_upload(api, 180)
    assert upload.status_code == 201, upload.text
    expired = [line for line in server.log_text().splitlines() if "have expired to make room" in line]
    writers = [re.search(r" warning (request|job)=([0-9a-f]+) \d+ finished jobs", line) for line in expired]
    assert all(writers), expired
    named = [writer.groups() for writer in writers if writer]
    assert ("request", upload.headers["Supple-Request-Id"]) in named
    of_jobs = {id_ for kind, id_ in named if kind == "job"}
    assert of_jobs and of_jobs <= set(jobs)


def test_meshes_are_limited_in_bytes_and_go_when_nobody_uses_them(new_server: NewServer, contract: Contract) -> None:
    server = new_server("--max-mesh-bytes", "20kb")
    api = Api(server, contract)
    mesh = new_upload(api, 10).json()["id"]
    refused = new_upload(api, 20)
    assert (refused.status_code, problem_code(refused), refused.json()["setting"]) == (507, "store.quota", "--max-mesh-bytes")
    assert new_upload(api, 10).status_code == 200, "it is stored already"
    assert server.terminate() == 0
    server.arguments = ("--mesh-retention", "3600")
    server.start()
    assert Api(server, contract).get(f"/v1/meshes/{mesh}").status_code == 200
    assert server.terminate() == 0
    server.arguments = ("--mesh-retention", "0.5")
    server.start()
    deadline = time.monotonic() + PATIENCE_SECONDS
    # A request for the mesh would count as a use of it.
    while (server.data / "meshes" / f"{mesh}.ply").exists():
        assert time.monotonic() < deadline
        time.sleep(0.05)
    assert Api(server, contract).get(f"/v1/meshes/{mesh}").status_code == 404
    assert "--mesh-retention" in server.log_text()


@pytest.mark.parametrize("damage", ["overwritten", "lost"])
def test_a_start_without_a_sound_database_keeps_meshes_and_results_and_deletes_nothing(damage: str, new_server: NewServer,
                                                                              contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    mesh = api.upload(*flat_grid(8))
    before = api.get(f"/v1/meshes/{mesh}").json()
    job = api.post(FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]}, headers=ASYNC).json()["id"]
    document = api.wait_for_job(job)
    result = api.get(f"/v1/jobs/{job}/result")
    (server.data / "results" / "unknown.result").write_bytes(b"not a result")
    assert server.terminate() == 0
    spoil_database(server.data, damage)
    server.start()
    api = Api(server, contract)
    after = api.get(f"/v1/meshes/{mesh}").json()
    assert {**after, "created": ""} == {**before, "created": ""}
    api.ok(FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]})
    assert api.get(f"/v1/jobs/{job}").json() == document
    again = api.get(f"/v1/jobs/{job}/result")
    assert (again.content, again.headers["Content-Type"]) == (result.content, result.headers["Content-Type"])
    assert api.get("/v1/jobs").json()["jobs"] == [document]
    kept = [path.read_bytes() for path in (server.data / "quarantine").iterdir()]
    assert b"not a result" in kept
    assert len(kept) == (1 if damage == "lost" else 2)
    assert "unknown.result is moved to quarantine" in server.log_text()
    assert f"the result of job {job} had no row and is indexed again" in server.log_text()
    assert f"the mesh {mesh} had no row and is indexed again" in server.log_text()


def test_the_data_folder_is_for_the_user_of_the_server_alone(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    Api(server, contract).upload(*flat_grid(2))
    assert server.data.stat().st_mode & 0o777 == 0o700
    assert server.terminate() == 0
    server.data.chmod(0o755)
    server.start()
    assert server.data.stat().st_mode & 0o777 == 0o700
    assert "0700" in server.log_text()
    assert [oct(path.stat().st_mode & 0o777) for path in (server.data / "meshes").iterdir()] == ["0o600"]


def test_a_file_beyond_the_limit_of_its_size_is_refused_and_ends_nothing(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    vertices, faces = sphere(5)
    resource.prlimit(server.pid, resource.RLIMIT_FSIZE, (300_000, 300_000))
    response = api.post("/v1/meshes", {"vertices": [list(map(float, v)) for v in vertices],
                                       "faces": [list(map(int, f)) for f in faces]})
    assert (response.status_code, problem_code(response)) == (507, "store.full")
    assert "File too large" in response.json()["detail"]
    api.upload(*flat_grid(2))
    assert list((server.data / "meshes").glob("*.part")) == []
