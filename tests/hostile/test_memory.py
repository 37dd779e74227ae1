"""No request exceeds its memory limit, and none ends a server with little memory, tested with each operation's costliest
request, alone and sixteen at a time."""

from __future__ import annotations

import os
import random
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Callable, Iterator, List, Tuple

import pytest
import requests

from costly import CASES, Meshes, meshes_of, named, ply
from contract import ROOT, Contract
from harness import Api, ServerProcess
from processes import first_line, peak_bytes, reset_peak, sent_request
from shapes import flat_grid, torus

GIBIBYTE = 2**30
MARGIN = 1.25
"""Permitted ratio of real to accounted memory. Free memory that is not returned immediately and small blocks, which are
accounted together, are in addition to the accounted memory."""
AT_A_TIME = 16
CONTROL_GROUPS = Path("/sys/fs/cgroup/memory")


def uploaded(server: ServerProcess) -> Meshes:
    def upload(content: bytes) -> str:
        response = requests.post(server.url + "/v1/meshes", data=content, headers={"Content-Type": "model/ply"}, timeout=120)
        assert response.status_code in (200, 201), response.text
        return str(response.json()["id"])
    return meshes_of(upload)


@pytest.fixture(scope="module")
def bounded(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    """A server whose requests may take 1 GiB each."""
    process = ServerProcess(tmp_path_factory.mktemp("bounded") / "data", "--models", str(ROOT / "models"), "--max-request-memory", "1G")
    yield process.start()
    process.stop()


@pytest.fixture(scope="module")
def meshes(bounded: ServerProcess) -> Meshes:
    return uploaded(bounded)


LARGE = ["body_of_many_empty_texts", "layout_of_cusps", "network_on_a_large_shell", "optimization_of_many_sites", "sheet_of_circles",
         "sheet_of_many_strands", "upload_of_a_large_ply"]
"""The requests that would take most or more of the memory limit of a request."""


@pytest.mark.parametrize("name", LARGE)
def test_one_request_takes_what_one_request_may(bounded: ServerProcess, meshes: Meshes, name: str) -> None:
    server = bounded
    request = named(name, meshes, 2.5)
    reset_peak(server.pid)
    before = server.resident_bytes()
    connection = sent_request(server, request)
    status = first_line(connection)
    connection.close()
    assert status.split()[1] in ("200", "201", "400", "413", "504"), status
    body = len(request.body)  # the body is read before the computation and reserved separately
    assert peak_bytes(server.pid) - before < MARGIN * GIBIBYTE + body, f"{name}: {status}"


def test_an_optimization_of_sites_on_a_large_mesh_takes_less_than_a_gibibyte(bounded: ServerProcess, contract: Contract) -> None:
    api = Api(bounded, contract)
    mesh = api.upload(*torus(360, 140))
    reset_peak(bounded.pid)
    before = bounded.resident_bytes()
    answer = api.ok("/v1/voronoi-optimizations", {
        "mesh": mesh, "sites": {"count": 60}, "max_iterations": 1,  # then two states are in memory, as at any later time
        "objectives": {"edge_length": 1, "planarity": 1, "regularity": 1, "centroidal": 1, "equal_area": 1}})
    assert answer["stopped"] in ("iteration_limit", "step_too_small")
    assert peak_bytes(bounded.pid) - before < GIBIBYTE


def test_a_computation_that_needs_too_much_is_told_the_limit_and_its_setting(new_server: Callable[..., ServerProcess],
                                                                            contract: Contract) -> None:
    server = new_server("--max-request-memory", "64M")
    api = Api(server, contract)
    response = api.post("/v1/weave-simulations", {
        "weave": {"pattern": "regular", "sheet": {"columns": 60, "rows": 60}, "pitch": 1}, "deformed": "none",
        "supports": [{"at": {"box": [[-1, -1], [0.7, 61]]}}, {"at": {"box": [[59, -1], [61, 61]]}, "displacement": [1, 0, 0]}]})
    assert response.status_code == 413, response.text
    problem = response.json()
    assert problem["code"] == "request.too_much_memory"
    assert problem["limit"] == 64 * 2**20 and problem["value"] > problem["limit"] and problem["setting"] == "--max-request-memory"
    assert server.metrics()["supple_memory_used_bytes"] < 4 * 2**20


def test_a_download_is_never_in_memory_as_a_whole(new_server: Callable[..., ServerProcess]) -> None:
    server = new_server()
    uploaded = requests.post(server.url + "/v1/meshes", data=ply(*flat_grid(1000)), headers={"Content-Type": "model/ply"}, timeout=300)
    mesh = uploaded.json()["id"]
    job = requests.post(server.url + "/v1/geodesic-fields", headers={"Prefer": "respond-async"}, timeout=60,
                        json={"mesh": mesh, "sources": [{"vertex": 0}], "accuracy": {"method": "edge_graph"}}).json()["id"]
    while (state := requests.get(f"{server.url}/v1/jobs/{job}", timeout=60).json()["state"]) in ("accepted", "running"):
        time.sleep(0.1)
    assert state == "successful"
    assert server.terminate() == 0
    server.start()
    for path, expected in ((f"/v1/meshes/{mesh}/content", (server.data / "meshes" / f"{mesh}.ply").stat().st_size),
                           (f"/v1/jobs/{job}/result", None)):
        before = server.resident_bytes()
        reset_peak(server.pid)
        response = requests.get(server.url + path, timeout=60)
        assert response.status_code == 200
        assert int(response.headers["Content-Length"]) == len(response.content) > 10_000_000, "the length is told before"
        assert expected in (None, len(response.content))
        assert peak_bytes(server.pid) - before < 4 * 2**20, path


def group_of(test: str) -> Iterator[List[str]]:
    """A command that runs a process in a control group with 2 GiB. The group is removed afterwards."""
    group = CONTROL_GROUPS / f"supple_{test}_{os.getpid()}"
    try:
        group.mkdir()
    except OSError as error:
        pytest.skip(f"no control group can be made here: {error}")
    (group / "memory.limit_in_bytes").write_text(str(2 * GIBIBYTE))
    yield ["sh", "-c", f'echo $$ > {group}/cgroup.procs; exec "$@"', "sh"]
    group.rmdir()


@pytest.fixture(params=["control_group", "address_space"])
def small_server(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[ServerProcess]:
    """A server with a limit of 2 GiB, for all of its processes together or for each process."""
    groups = group_of("memory") if request.param == "control_group" else iter([["prlimit", f"--as={2 * GIBIBYTE}"]])
    process = ServerProcess(tmp_path / "data", "--models", str(ROOT / "models"), "--max-connections", "64", prefix=next(groups))
    yield process.start()
    process.stop()
    next(groups, None)


def test_the_costliest_requests_at_once_do_not_end_a_server_of_two_gibibytes(small_server: ServerProcess) -> None:
    meshes = uploaded(small_server)
    names = sorted(CASES)
    random.Random(5).shuffle(names)

    def send(name: str) -> Tuple[str, str]:
        try:
            connection = sent_request(small_server, named(name, meshes, 1))
        except ConnectionRefusedError:
            return name, "refused"  # the server has ended: its log says why
        try:
            return name, (first_line(connection).split() + ["", "closed"])[1]
        except ConnectionResetError:
            return name, "closed"  # a server that refuses a body while it arrives may close before the answer is read
        finally:
            connection.close()

    with ThreadPoolExecutor(AT_A_TIME) as pool:
        answers = list(pool.map(send, names))
    assert small_server.running(), f"the server died: {answers}\n{small_server.log_text()[-2000:]}"
    unexpected = {(name, status) for name, status in answers if status not in ("200", "201", "400", "413", "422", "429", "503", "504", "closed")}
    assert not unexpected
    assert {status for _, status in answers} & {"200", "201"}, "nothing was answered"
    # The server works as before and has returned the memory.
    assert requests.get(small_server.url + "/v1/families/IH21/structure?format=svg", timeout=60).status_code == 200
    assert small_server.metrics()["supple_memory_used_bytes"] < 4 * 2**20
