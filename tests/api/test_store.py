"""What becomes of the data folder when the disk or the files in it fail."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Callable, Iterator

import pytest

from contract import Contract
from harness import Api, ServerProcess
from shapes import bumpy_sphere

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
