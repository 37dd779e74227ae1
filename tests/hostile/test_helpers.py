"""Helper processes: no request waits for the mesh of another one, and a helper that ends does not end the server."""

from __future__ import annotations

import os
import signal
import threading
import time
from pathlib import Path
from typing import Any, Callable, Dict, List

import pytest
import requests

from contract import Contract
from costly import named
from harness import SANITIZED, SLOWNESS, Api, ServerProcess, problem_code
from processes import cpu_within, memory_is_its_own, sent_request
from working_time import comes_true, cpu_of_children, cpu_seconds, processes

SOLID = "/v1/families/IH21/structure?cells=100,100&format=stl"
"""A request for which the mesh generator works for a minute."""
CELL: Dict[str, Any] = {"family": "IH21", "mesh": {"mesh_size": 1.0}, "deadline": 20 * SLOWNESS}
"""A short request, which would miss its deadline if it waited for the solid."""


def helpers_of(server: ServerProcess) -> List[int]:
    return [process for process in processes(server.pid) if process != server.pid]


def runs(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] not in "ZX"
    except OSError:
        return False


def get_in_background(server: ServerProcess, path: str) -> "tuple[threading.Thread, List[requests.Response]]":
    answers: List[requests.Response] = []
    thread = threading.Thread(target=lambda: answers.append(requests.get(server.url + path, timeout=120)))
    thread.start()
    return thread, answers


def at_work(server: ServerProcess) -> List[int]:
    """The processes of a helper that computes: the helper, then its child."""
    for _ in range(200):
        for helper in helpers_of(server):
            both = processes(helper)
            if len(both) > 1 and cpu_within(helper, 0.05) > 0.02:
                return both
    raise AssertionError("no helper is at work")


def test_a_mesh_does_not_wait_for_one_that_takes_a_minute(api: Api, server: ServerProcess) -> None:
    connection = sent_request(server, named("solid_of_many_cells", {}, None))
    try:
        at_work(server)
        assert api.post("/v1/structures", CELL).status_code == 200
    finally:
        connection.close()


@pytest.mark.skipif(SANITIZED, reason="the address sanitizer takes the signal for a finding")
@pytest.mark.parametrize("process", [0, 1], ids=["helper", "child"])
def test_a_process_that_crashes_is_a_problem_of_its_request_alone(server: ServerProcess, api: Api, process: int) -> None:
    thread, answers = get_in_background(server, SOLID)
    os.kill(at_work(server)[process], signal.SIGSEGV)
    thread.join(120)
    assert answers and (answers[0].status_code, problem_code(answers[0])) == (500, "server.helper_ended")
    assert "tiling/stl" in answers[0].json()["detail"] and "signal 11" in answers[0].json()["detail"]
    api.contract.check_response("GET", SOLID, 500, answers[0].headers, answers[0].content)
    assert api.post("/v1/structures", CELL).status_code == 200


def test_nothing_is_left_of_a_helper_whose_request_nobody_waits_for(server: ServerProcess, api: Api) -> None:
    connection = sent_request(server, named("solid_of_many_cells", {}, None))
    both = at_work(server)
    connection.close()
    comes_true(lambda: not any(Path(f"/proc/{process}").exists() for process in both), "the helper and its child are gone")
    assert api.post("/v1/structures", CELL).status_code == 200


@memory_is_its_own
def test_a_helper_is_refused_memory_beyond_its_setting(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    api = Api(new_server("--helper-memory", "200MB"), contract)
    response = api.get(SOLID, timeout=120)
    # The helper ends if the library does not report that memory was refused.
    assert problem_code(response) in ("server.out_of_memory", "server.helper_ended"), response.text
    assert "209715200 bytes" in response.json()["detail"]
    assert api.post("/v1/structures", CELL).status_code == 200


def test_meshing_works_without_helpers_too(new_server: Callable[..., ServerProcess], contract: Contract, api: Api) -> None:
    alone = Api(new_server("--helper", ""), contract)
    assert helpers_of(alone.server) == []
    path = "/v1/families/IH67/structure?cells=6,6&format=stl"
    assert alone.get(path).content == api.get(path).content, "the same bytes"


@pytest.mark.parametrize("name", ["layout_of_cusps", "solid_of_many_cells", "sheet_of_circles"])
def test_the_server_ends_when_told_to_whatever_it_computes(new_server: Callable[..., ServerProcess], name: str) -> None:
    server = new_server("--grace", "0.2")
    connection = sent_request(server, named(name, {}, None))
    time.sleep(0.5)
    everything = processes(server.pid)
    used, reaped = sum(cpu_seconds(server.pid).values()), cpu_of_children()
    assert server.terminate() == 0
    assert cpu_of_children() - reaped - used < 3 * SLOWNESS, "CPU seconds of the server and its helpers after the signal"
    connection.close()
    if SANITIZED:
        time.sleep(1)  # such a helper ends after its server, and remains as a zombie process
    for process in everything:
        left = runs(process) if SANITIZED else Path(f"/proc/{process}").exists()
        assert not left, f"process {process} is left"


def test_helpers_end_with_a_server_that_is_killed(new_server: Callable[..., ServerProcess]) -> None:
    server = new_server()
    connection = sent_request(server, named("solid_of_many_cells", {}, None))
    both = at_work(server)
    server.kill()
    connection.close()
    comes_true(lambda: not any(runs(process) for process in both), "the helper and its child end")
