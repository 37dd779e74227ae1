"""The commands of the server's program for data folders: check, backup and restore."""

from __future__ import annotations

import os
import shutil
import sqlite3
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any, Callable, Dict

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from contract import Contract  # noqa: E402
from harness import SERVER, Api, ServerProcess, slow_relaxation, spoil_database  # noqa: E402
from shapes import bumpy_sphere, flat_grid, sphere  # noqa: E402
from shared_servers import Replicas  # noqa: E402

ASYNC = {"Prefer": "respond-async"}
FIELDS = "/v1/geodesic-fields"
NewServer = Callable[..., ServerProcess]


def command(*arguments: object, **environment: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([str(SERVER), *map(str, arguments)], capture_output=True, text=True, timeout=120, env={**os.environ, **environment})


def flip_a_byte(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


def submit(api: Api, mesh: str, vertex: int) -> str:
    response = api.post(FIELDS, {"mesh": mesh, "sources": [{"vertex": vertex}]}, headers=ASYNC)
    assert response.status_code == 202, response.text
    return str(response.json()["id"])


def answer(api: Api, job: str) -> Any:
    """The result of a job without its cost."""
    return {name: value for name, value in api.get(f"/v1/jobs/{job}/result").json().items() if name not in ("cost", "effects")}


def snapshot(api: Api) -> Dict[str, Any]:
    """Descriptions of meshes and finished jobs, with the bytes of meshes and results."""
    meshes = api.get("/v1/meshes?limit=1000").json()["meshes"]
    jobs = api.get("/v1/jobs?state=successful&limit=1000").json()["jobs"]
    return {"meshes": meshes, "jobs": jobs,
            "content": {mesh["id"]: api.get(f"/v1/meshes/{mesh['id']}/content").content for mesh in meshes},
            "results": {job["id"]: api.get(job["result"]).content for job in jobs}}


def test_check_names_each_changed_each_missing_and_each_unknown_file(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    changed, missing = api.upload(*flat_grid(4)), api.upload(*sphere(2))
    job = submit(api, changed, 0)
    api.wait_for_job(job)
    sound = command("check", "--data", server.data)
    assert (sound.returncode, sound.stderr) == (0, ""), sound.stdout
    assert "2 meshes, 1 results and 0 requests of jobs: 0 faults" in sound.stdout
    flip_a_byte(server.data / "meshes" / f"{changed}.ply")
    (server.data / "meshes" / f"{missing}.ply").unlink()
    flip_a_byte(server.data / "results" / f"{job}.result")
    (server.data / "results" / "mine.result").write_bytes(b"x")
    found = command("check", "--data", server.data)
    assert found.returncode == 1
    for sentence in (f"{changed}.ply has changed", f"{missing}.ply is missing", f"{job}.result has changed",
                     "does not name the file mine.result", "4 faults"):
        assert sentence in found.stdout, found.stdout


def test_repair_sets_aside_what_is_damaged_and_deletes_nothing(new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    changed, missing, sound = api.upload(*flat_grid(4)), api.upload(*sphere(2)), api.upload(*flat_grid(3))
    jobs = [submit(api, sound, vertex) for vertex in range(2)]
    documents = [api.wait_for_job(job) for job in jobs]
    refused = command("check", "--data", server.data, "--repair")
    assert refused.returncode == 1
    assert "in use by another server" in refused.stderr
    assert server.terminate() == 0
    flip_a_byte(server.data / "meshes" / f"{changed}.ply")
    (server.data / "meshes" / f"{missing}.ply").unlink()
    flip_a_byte(server.data / "results" / f"{jobs[0]}.result")
    assert command("check", "--data", server.data, "--repair").returncode == 1
    after = command("check", "--data", server.data)
    assert after.returncode == 0, after.stdout
    assert len(list((server.data / "quarantine").iterdir())) == 2
    server.start()
    api = Api(server, contract)
    assert [mesh["id"] for mesh in api.get("/v1/meshes").json()["meshes"]] == [sound]
    failed = api.get(f"/v1/jobs/{jobs[0]}").json()
    assert (failed["state"], failed["error"]["code"]) == ("failed", "store.corrupted")
    assert jobs[0] in failed["error"]["detail"]
    assert api.get(f"/v1/jobs/{jobs[1]}").json() == documents[1]
    assert api.upload(*flat_grid(4)) == changed, "it can be sent again"


@pytest.mark.parametrize("damage", ["overwritten", "lost"])
def test_repair_makes_a_folder_without_a_sound_database_sound(damage: str, new_server: NewServer, contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    job = submit(api, api.upload(*flat_grid(4)), 0)
    api.wait_for_job(job)
    before = snapshot(api)
    assert server.terminate() == 0
    spoil_database(server.data, damage)
    found = command("check", "--data", server.data)
    assert found.returncode == 1
    assert ("no database" in found.stderr) if damage == "lost" else ("database is damaged" in found.stdout)
    assert command("check", "--data", server.data, "--repair").returncode == 1
    assert command("check", "--data", server.data).returncode == 0
    server.start()
    after = snapshot(Api(server, contract))
    assert (after["jobs"], after["results"], after["content"]) == (before["jobs"], before["results"], before["content"])


def test_a_backup_of_a_running_server_restores_the_same_meshes_jobs_and_results(
        new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    server = new_server("--workers", "1")
    api = Api(server, contract)
    meshes = [api.upload(*flat_grid(4)), api.upload(*bumpy_sphere(3))]
    for mesh in meshes:
        for vertex in range(3):
            api.wait_for_job(submit(api, mesh, vertex))
    before = snapshot(api)
    long = slow_relaxation(meshes[1], 3000)
    waiting = [api.post("/v1/embedded-systems", long, headers=ASYNC).json()["id"]]
    waiting += [submit(api, meshes[1], vertex) for vertex in range(3)]
    backup = tmp_path / "backup"
    made = command("backup", "--data", server.data, "--to", backup)
    assert made.returncode == 0, made.stdout + made.stderr
    with sqlite3.connect(backup / "supple.sqlite") as copied:
        unfinished = {row[0] for row in copied.execute("SELECT id FROM jobs WHERE finished = 0")}
    assert unfinished == set(waiting), "they had ended before the backup"
    again = command("backup", "--data", server.data, "--to", backup)
    assert (again.returncode, "something in" in again.stderr) == (1, True), again.stderr
    checked = command("check", "--data", backup)
    assert checked.returncode == 0, checked.stdout
    expected = {job: api.wait_for_job(job) and answer(api, job) for job in waiting}
    restored = command("restore", "--from", backup, "--data", tmp_path / "restored")
    assert restored.returncode == 0, restored.stdout + restored.stderr
    copy = new_server("--workers", "1", data="restored")
    api = Api(copy, contract)
    listed = {job["id"] for job in api.get("/v1/jobs?limit=1000").json()["jobs"]}
    assert listed == {job["id"] for job in before["jobs"]} | set(waiting)
    for job in waiting:
        assert api.wait_for_job(job)["state"] == "successful"
        assert answer(api, job) == expected[job]
    after = snapshot(api)
    assert after["meshes"] == before["meshes"]
    assert after["content"] == before["content"]
    old = {job["id"] for job in before["jobs"]}
    assert [job for job in after["jobs"] if job["id"] in old] == before["jobs"]
    assert {job: after["results"][job] for job in old} == before["results"]


def test_backups_while_jobs_come_and_go_are_each_consistent(new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    server = new_server()
    api = Api(server, contract)
    mesh = api.upload(*flat_grid(4))
    stop = threading.Event()

    def churn() -> None:
        client = Api(server, contract)
        jobs = []
        while not stop.is_set():
            jobs.append(submit(client, mesh, 0))
            if len(jobs) > 4:
                client.delete(f"/v1/jobs/{jobs.pop(0)}")

    thread = threading.Thread(target=churn)
    thread.start()
    try:
        for i in range(5):
            made = command("backup", "--data", server.data, "--to", tmp_path / f"backup{i}")
            assert made.returncode == 0, made.stdout + made.stderr
            checked = command("check", "--data", tmp_path / f"backup{i}")
            assert checked.returncode == 0, checked.stdout
    finally:
        stop.set()
        thread.join()


def test_restore_refuses_what_is_no_backup_and_a_folder_with_content(new_server: NewServer, contract: Contract,
                                                                    tmp_path: Path) -> None:
    server = new_server()
    mesh = Api(server, contract).upload(*flat_grid(4))
    backup = tmp_path / "backup"
    assert command("backup", "--data", server.data, "--to", backup).returncode == 0
    in_use = command("restore", "--from", backup, "--data", server.data, "--replace")
    assert (in_use.returncode, "in use by another server" in in_use.stderr) == (1, True)
    other = Api(server, contract).upload(*sphere(1))
    assert server.terminate() == 0
    refused = command("restore", "--from", backup, "--data", server.data)
    assert (refused.returncode, "There is something in" in refused.stderr) == (1, True)
    incomplete = tmp_path / "incomplete"
    shutil.copytree(backup, incomplete)
    (incomplete / "backup").unlink()
    unfinished = command("restore", "--from", incomplete, "--data", tmp_path / "new")
    assert (unfinished.returncode, "no complete backup" in unfinished.stderr) == (1, True)
    replaced = command("restore", "--from", backup, "--data", server.data, "--replace")
    assert replaced.returncode == 0, replaced.stderr
    server.start()
    assert [entry["id"] for entry in Api(server, contract).get("/v1/meshes").json()["meshes"]] == [mesh]
    assert list((server.data / "quarantine").rglob(f"{other}.ply")) != [], "what was replaced is kept"


def test_backup_and_restore_tell_of_what_is_damaged(new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    server = new_server()
    mesh = Api(server, contract).upload(*flat_grid(4))
    missing = Api(server, contract).upload(*sphere(1))
    flip_a_byte(server.data / "meshes" / f"{mesh}.ply")
    (server.data / "meshes" / f"{missing}.ply").unlink()
    for made in (command("backup", "--data", server.data, "--to", tmp_path / "backup"),
                 command("restore", "--from", tmp_path / "backup", "--data", tmp_path / "restored")):
        assert made.returncode == 1
        assert f"{mesh}.ply has changed" in made.stdout
        assert f"{missing}.ply is missing" in made.stdout


def test_the_commands_know_a_store_that_servers_share(new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    replicas = Replicas(tmp_path, 2)
    data, backup = replicas.servers[0].data, tmp_path / "backup"
    place = ("--data", data, "--database", replicas.database + " password=secret")
    try:
        replicas.start()
        api, other = (Api(server, contract) for server in replicas.servers)
        mesh = api.upload(*flat_grid(4))
        api.wait_for_job(submit(other, mesh, 0))
        before = snapshot(api)
        calls = [command("check", *place),
                 command("backup", "--data", data, "--to", backup, SUPPLE_DATABASE=replicas.database),
                 command("check", "--data", backup, "--database", "", SUPPLE_DATABASE=replicas.database)]
        for call in calls:
            assert (call.returncode, call.stderr) == (0, ""), call.stdout + call.stderr
            assert ": 0 faults" in call.stdout
        assert "1 meshes, 1 results and 0 requests of jobs" in calls[0].stdout
        later = other.upload(*sphere(1))
        refused = [command("check", *place, "--repair"), command("restore", *place, "--from", backup, "--replace"),
                   command("restore", *place, "--from", backup)]
        for call in refused:
            assert (call.returncode, "in use by" in call.stderr) == (1, True), call.stderr
        for server in replicas.servers:
            assert server.terminate() == 0
        refused.append(command("restore", *place, "--from", backup))
        assert (refused[-1].returncode, "There is something in the database already" in refused[-1].stderr) == (1, True)
        flip_a_byte(data / "meshes" / f"{mesh}.ply")
        found = command("check", *place)
        assert (found.returncode, f"{mesh}.ply has changed" in found.stdout) == (1, True)
        replaced = command("restore", *place, "--from", backup, "--replace")
        assert replaced.returncode == 0, replaced.stderr
        assert "secret" not in "".join(call.stdout + call.stderr for call in [*calls, *refused, found, replaced])
        replicas.start()
        assert snapshot(Api(replicas.servers[0], contract)) == before
        assert list((data / "quarantine").rglob(f"{later}.ply")) != [], "what was replaced is kept"
    finally:
        replicas.close()
    assert command("restore", "--from", backup, "--data", tmp_path / "alone").returncode == 0
    assert snapshot(Api(new_server(data="alone"), contract)) == before, "a server with a database of its own understands it too"


def test_the_help_names_the_commands(tmp_path: Path) -> None:
    for name in ("backup", "check", "restore"):
        assert f"{name}: " in command("--help").stdout
        assert "--data" in command(name, "--help").stdout
        told = command(name, "--help", SUPPLE_DATABASE="postgresql://supple:secret@db.example/supple").stdout
        assert "--database" in told and "secret" not in told
    nothing = command("check", "--data", tmp_path)
    assert nothing.returncode == 1
    assert "There is no database" in nothing.stderr
