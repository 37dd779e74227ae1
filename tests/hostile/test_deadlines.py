"""No computation outlives its deadline or its client by more than a second, tested with each operation's costliest request."""

from __future__ import annotations

import os
import re
import select
import socket
from typing import Callable

import pytest
import requests

from costly import CASES, Meshes, meshes_of, named, ply, post
from harness import SLOWNESS, Api, ServerProcess
from shapes import flat_grid
from processes import cpu_within, first_line, sent_request
from working_time import PATIENCE_SECONDS, WorkingTime, comes_true, ends_within

DEADLINE = 1.0
"""The deadline of each request, seconds."""
LATE = 1.0 * SLOWNESS * min(2, os.cpu_count() or 1)
"""CPU seconds that the server may use after the deadline or after its client has disconnected: one second of two cores."""
QUIET = 0.2
"""CPU seconds that an idle server and its helpers may use in a second."""


@pytest.fixture(scope="module")
def meshes(api: Api) -> Meshes:
    def upload(content: bytes) -> str:
        response = requests.post(api.server.url + "/v1/meshes", data=content, headers={"Content-Type": "model/ply"}, timeout=120)
        assert response.status_code in (200, 201), response.text
        return str(response.json()["id"])
    return meshes_of(upload)


def is_answered(connection: socket.socket, seconds: float) -> bool:
    """Whether there is data to read within this time; nothing is read."""
    return bool(select.select([connection], [], [], seconds)[0])


def works_on(server: ServerProcess) -> bool:
    """Whether the server reports a computation, or it or a helper uses the processor."""
    ready = requests.get(server.url + "/readyz", timeout=PATIENCE_SECONDS).json()
    return bool(ready["jobs_running"] or ready["jobs_waiting"] or server.metrics()["supple_immediate_computations"]
                or cpu_within(server.pid, 0.25) >= QUIET * 0.25)


TAKES_NO_DEADLINE = {name for name in CASES if name.startswith(("upload_", "repair_", "body_", "picture_of_many_cells"))}


@pytest.mark.parametrize("name", sorted(set(CASES) - TAKES_NO_DEADLINE))
def test_an_answer_comes_within_a_second_of_its_deadline(server: ServerProcess, meshes: Meshes, name: str) -> None:
    connection = sent_request(server, named(name, meshes, DEADLINE))
    is_answered(connection, DEADLINE)
    late = WorkingTime(server.pid)
    while not is_answered(connection, 0.02):
        late.check(LATE, f"{name}: work after the deadline")
    status = first_line(connection)
    connection.close()
    assert re.match(r"HTTP/1.1 (504|200|422|413) ", status), status


def test_a_mesh_that_has_to_be_read_from_disk_keeps_to_deadline_and_client(new_server: Callable[..., ServerProcess]) -> None:
    server = new_server()
    uploaded = requests.post(server.url + "/v1/meshes", data=ply(*flat_grid(1000)), headers={"Content-Type": "model/ply"}, timeout=300)
    assert uploaded.status_code == 201, uploaded.text
    assert server.terminate() == 0
    server.start()
    pairs = [{"from": {"vertex": 0}, "to": {"vertex": 1}}]
    asked = {"mesh": uploaded.json()["id"], "pairs": pairs, "deadline": 0.05}
    work = WorkingTime(server.pid)
    response = requests.post(server.url + "/v1/geodesics", json=asked, timeout=60)
    assert response.status_code == 504, response.text
    work.check(0.05 + 0.3 * SLOWNESS, "it is read on after the deadline")
    work = WorkingTime(server.pid)
    connection = sent_request(server, post("/v1/geodesics", {**asked, "deadline": 60}))
    while work.seconds() < 0.05 and not is_answered(connection, 0.01):
        pass
    connection.close()
    ends_within(server.pid, lambda: works_on(server), 0.3 * SLOWNESS, "it is read for a client that has left")
    answered = requests.post(server.url + "/v1/geodesics", json={**asked, "deadline": 60}, timeout=60)
    assert answered.status_code == 200, answered.text


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_processor_is_free_a_second_after_its_client_has_left(server: ServerProcess, meshes: Meshes, name: str) -> None:
    work = WorkingTime(server.pid)
    connection = sent_request(server, named(name, meshes, None))
    comes_true(lambda: work.seconds() >= 0.3 or is_answered(connection, 0.02), name)
    connection.close()
    ends_within(server.pid, lambda: works_on(server), LATE, f"{name}: work for a client that has left")
