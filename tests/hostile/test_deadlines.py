"""Nothing outlives its deadline or its client by more than a second: the costliest request of each operation."""

from __future__ import annotations

import re
import time
from typing import Callable, Iterator

import pytest
import requests

from costly import CASES, Meshes, meshes_of, named, ply, post
from harness import SLOWNESS, Api, ServerProcess
from shapes import flat_grid
from processes import cpu_seconds, cpu_within, first_line, quiet_within, sent_request

DEADLINE = 1.0
"""Seconds that each request asks for."""
LATE = 1.0
"""Seconds by which an answer, or the end of the computation, may come later; on an idle machine."""
QUIET = 0.2
"""CPU seconds that an idle server with its helpers may use in a second."""


@pytest.fixture(scope="module")
def meshes(api: Api) -> Meshes:
    def upload(content: bytes) -> str:
        response = requests.post(api.server.url + "/v1/meshes", data=content, headers={"Content-Type": "model/ply"}, timeout=120)
        assert response.status_code in (200, 201), response.text
        return str(response.json()["id"])
    return meshes_of(upload)


@pytest.fixture
def slowness(server: ServerProcess) -> Iterator[float]:
    """How much longer the server takes than an optimized one on an idle machine: n times where n want its core."""
    before, start = cpu_seconds(server.pid), time.monotonic()
    requests.get(server.url + "/v1/families/IH21/structure?cells=16,16&format=svg", timeout=120)
    wall = time.monotonic() - start
    used = sum(max(0.0, seconds - before.get(process, 0)) for process, seconds in cpu_seconds(server.pid).items())
    yield SLOWNESS * max(1.0, wall / max(used, 0.02))


TAKES_NO_DEADLINE = {name for name in CASES if name.startswith(("upload_", "repair_", "body_", "picture_of_many_cells"))}


@pytest.mark.parametrize("name", sorted(set(CASES) - TAKES_NO_DEADLINE))
def test_an_answer_comes_within_a_second_of_its_deadline(server: ServerProcess, meshes: Meshes, slowness: float, name: str) -> None:
    request = named(name, meshes, DEADLINE)
    start = time.monotonic()
    connection = sent_request(server, request)
    status = first_line(connection)
    took = time.monotonic() - start
    connection.close()
    assert re.match(r"HTTP/1.1 (504|200|422|413) ", status), status
    assert took < DEADLINE + LATE * slowness, f"{name}: {status} after {took:.2f} s, slowness {slowness:.2f}"


def test_a_mesh_that_has_to_be_read_from_disk_keeps_to_deadline_and_client(new_server: Callable[..., ServerProcess],
                                                                          slowness: float) -> None:
    server = new_server()
    uploaded = requests.post(server.url + "/v1/meshes", data=ply(*flat_grid(1000)), headers={"Content-Type": "model/ply"}, timeout=300)
    assert uploaded.status_code == 201, uploaded.text
    assert server.terminate() == 0
    server.start()
    pairs = [{"from": {"vertex": 0}, "to": {"vertex": 1}}]
    asked = {"mesh": uploaded.json()["id"], "pairs": pairs, "deadline": 0.05}
    start = time.monotonic()
    response = requests.post(server.url + "/v1/geodesics", json=asked, timeout=60)
    took = time.monotonic() - start
    assert response.status_code == 504, response.text
    assert took < 0.05 + 0.3 * slowness, f"{took:.2f} s, slowness {slowness:.2f}"
    connection = sent_request(server, post("/v1/geodesics", {**asked, "deadline": 60}))
    time.sleep(0.1)
    connection.close()
    time.sleep(0.3 * slowness)
    assert cpu_within(server.pid, 0.5) < QUIET * 0.5, "it is not read for a client that has left"
    answered = requests.post(server.url + "/v1/geodesics", json={**asked, "deadline": 60}, timeout=60)
    assert answered.status_code == 200, answered.text


@pytest.mark.parametrize("name", sorted(CASES))
def test_the_processor_is_free_a_second_after_its_client_has_left(server: ServerProcess, meshes: Meshes, slowness: float,
                                                                  name: str) -> None:
    connection = sent_request(server, named(name, meshes, None))
    time.sleep(0.5)
    connection.close()
    time.sleep(LATE)
    used = quiet_within(server.pid, LATE * (slowness - 1), QUIET * 0.5)
    assert used < QUIET * 0.5, f"{name}: {used:.2f} CPU seconds in the half second after, slowness {slowness:.2f}"
