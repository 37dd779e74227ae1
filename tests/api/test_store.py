"""What becomes of the data folder when the disk or the files in it fail."""

from __future__ import annotations

import os
import resource
import subprocess
from pathlib import Path
from typing import Callable, Iterator

import pytest

from contract import Contract
from harness import Api, ServerProcess, problem_code
from shapes import bumpy_sphere, flat_grid, sphere

ASYNC = {"Prefer": "respond-async"}
FIELDS = "/v1/geodesic-fields"
NewServer = Callable[..., ServerProcess]


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 64 MiB, where the servers of the test have their folder "disk"."""
    folder = tmp_path / "disk"
    folder.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", str(folder)], capture_output=True).returncode:
        pytest.skip("mounting takes root")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=True)


def fill(folder: Path) -> Path:
    """Takes all the space that is left, and returns the file that has it."""
    ballast = folder / "ballast"
    with ballast.open("wb") as file:
        space = os.statvfs(folder)
        os.posix_fallocate(file.fileno(), 0, space.f_bavail * space.f_frsize)
    return ballast


def test_a_job_that_ends_on_a_full_disk_fails_with_the_reason(small_disk: Path, new_server: NewServer,
                                                              contract: Contract) -> None:
    server = new_server(data=small_disk.name)
    api = Api(server, contract)
    mesh = api.upload(*bumpy_sphere(7))
    job = api.post(FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]}, headers=ASYNC).json()["id"]
    api.wait_for_job(job, ("running",))
    ballast = fill(small_disk)
    document = api.wait_for_job(job)
    assert (document["state"], document["error"]["code"]) == ("failed", "store.full")
    assert api.get(f"/v1/jobs/{job}/result").status_code == 507
    assert [entry["id"] for entry in api.get("/v1/jobs?state=failed").json()["jobs"]] == [job]
    assert api.get("/v1/jobs?state=accepted").json()["jobs"] == []
    events = api.get(f"/v1/jobs/{job}/events", timeout=10).text
    assert events.startswith("event: finished\n") and events.count("event:") == 1
    assert job in server.log_text()
    ballast.unlink()
    assert api.get("/v1/jobs").json()["jobs"] == [document]
    assert server.terminate() == 0
    server.start()
    assert Api(server, contract).get(f"/v1/jobs/{job}").json() == document
    server.stop()


@pytest.mark.parametrize("damage", ["overwritten", "lost"])
def test_a_start_without_a_sound_database_keeps_the_meshes_and_deletes_nothing(damage: str, new_server: NewServer,
                                                                              contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    mesh = api.upload(*flat_grid(8))
    before = api.get(f"/v1/meshes/{mesh}").json()
    job = api.post(FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]}, headers=ASYNC).json()["id"]
    api.wait_for_job(job)
    result = api.get(f"/v1/jobs/{job}/result").content
    assert server.terminate() == 0
    database = server.data / "supple.sqlite"
    if damage == "lost":
        database.unlink()
    else:
        database.write_bytes(b"not a database" * 1000)
    server.start()
    api = Api(server, contract)
    after = api.get(f"/v1/meshes/{mesh}").json()
    assert {**after, "created": ""} == {**before, "created": ""}
    api.ok(FIELDS, {"mesh": mesh, "sources": [{"vertex": 0}]})
    assert api.get(f"/v1/jobs/{job}").status_code == 404
    kept = [path.read_bytes() for path in (server.data / "quarantine").iterdir()]
    assert result in kept
    assert len(kept) == (1 if damage == "lost" else 2)
    assert f"{job}.result is moved to quarantine" in server.log_text()
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
    assert (response.status_code, problem_code(response)) == (503, "store.unavailable")
    assert "File too large" in response.json()["detail"]
    api.upload(*flat_grid(2))
    assert list((server.data / "meshes").glob("*.part")) == []
