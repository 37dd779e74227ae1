"""Probes, metrics, methods and paths."""

from __future__ import annotations

import re
import socket
import sqlite3
from contextlib import closing
from typing import Callable

import pytest
import requests

from contract import Contract
from harness import Api, ServerProcess, problem_code
from shapes import sphere
from working_time import PATIENCE_SECONDS


def test_the_probes_say_alive_and_ready(api: Api) -> None:
    health = api.get("/healthz").json()
    assert health["status"] == "ok" and health["uptime_seconds"] >= 0 and 0 <= health["silence_seconds"] < 60
    ready = api.get("/readyz").json()
    assert ready["status"] == "ready"


def test_a_server_without_room_on_its_disk_is_alive_and_not_ready(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    server = new_server("--min-free", "0")
    assert Api(server, contract).get("/readyz").json()["disk_free_bytes"] > 0
    server.stop()
    server.arguments = ("--min-free", "1000T")
    with pytest.raises(RuntimeError, match="not ready"):
        server.start(seconds=2)
    full = Api(server, contract)
    assert full.get("/healthz").json()["status"] == "ok"
    response = full.get("/readyz")
    assert (response.status_code, problem_code(response)) == (507, "store.full")
    problem = response.json()
    assert problem["setting"] == "--min-free" and problem["value"] < problem["limit"] == 1000 * 2**40
    assert full.get("/v1/families").status_code == 200, "what needs no room is answered"


def test_a_server_whose_database_is_gone_is_not_ready(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    server = new_server()
    with closing(sqlite3.connect(server.data / "supple.sqlite")) as database:
        database.execute("DROP TABLE jobs")
        database.commit()
    response = Api(server, contract).get("/readyz")
    assert (response.status_code, problem_code(response)) == (500, "store.corrupted")
    assert Api(server, contract).get("/healthz").status_code == 200


def test_an_immediate_answer_says_where_its_time_and_memory_went(api: Api) -> None:
    mesh = api.upload(*sphere(5))
    before = api.server.metrics()
    response = api.post("/v1/geodesic-fields", {"mesh": mesh, "sources": [{"vertex": 0}]})
    parts = dict(part.strip().split(";", 1) for part in response.headers["Server-Timing"].split(","))
    milliseconds = {name: float(value.removeprefix("dur=")) for name, value in parts.items() if name != "memory"}
    assert set(milliseconds) == {"read", "wait", "compute"}
    assert milliseconds["compute"] > 0 and milliseconds["wait"] < 1000
    held = int(re.fullmatch(r'desc="(\d+) bytes"', parts["memory"]).group(1))  # type: ignore[union-attr]
    assert 1_000_000 < held < 100_000_000, "a field on 20,480 faces"
    after = api.server.metrics()
    for stage in milliseconds:
        assert after[f'supple_stage_duration_seconds_count{{stage="{stage}"}}'] > before.get(f'supple_stage_duration_seconds_count{{stage="{stage}"}}', 0)
    assert after["supple_computation_memory_bytes_count"] > before["supple_computation_memory_bytes_count"]


def test_the_metrics_are_prometheus_text_and_count_requests(api: Api) -> None:
    before = api.server.metrics()
    text = api.get("/metrics").text
    for line in text.splitlines():
        assert line.startswith("# ") or re.fullmatch(r'[a-zA-Z_:][\w:]*(\{.*\})? [-+0-9.eEinfNa]+', line), line
    assert all(name.startswith(("supple_", "process_")) for name in before)
    for _ in range(5):
        api.get("/healthz")
    after = api.server.metrics()
    grown = [name for name in after if "request" in name and after[name] >= before.get(name, 0) + 5]
    assert grown, after


@pytest.mark.parametrize("path", ["/", "/v1", "/v1/", "/v1/nothing", "/v2/meshes", "/V1/meshes", "/healthz/", "/v1/jobs/a/b/c"])
def test_an_unknown_path_is_a_problem(api: Api, path: str) -> None:
    response = api.get(path, faulty=True)
    assert (response.status_code, problem_code(response)) == (404, "http.not_found")


@pytest.mark.parametrize("method, path", [
    ("DELETE", "/v1/geodesics"), ("GET", "/v1/geodesics"), ("PUT", "/v1/meshes"), ("POST", "/healthz"),
    ("PATCH", "/v1/meshes"), ("DELETE", "/v1/meshes"), ("POST", "/v1/jobs"), ("POST", f"/v1/meshes/{'0' * 64}"),
])
def test_a_method_that_a_path_does_not_have_is_refused_and_the_others_named(api: Api, method: str, path: str) -> None:
    response = api.call(method, path, faulty=True)
    assert (response.status_code, problem_code(response)) == (405, "http.method_not_allowed")
    allowed = {name.strip() for name in response.headers["Allow"].split(",")}
    contracted = {m for m, template in api.contract.operations()
                  if re.fullmatch(re.sub(r"\{[^}]+\}", "[^/]+", template), path)}
    assert contracted <= allowed and method not in allowed


@pytest.mark.parametrize("path", ["/v1/meshes?limit=0", "/v1/meshes?limit=abc", "/v1/jobs?limit=1001", "/v1/jobs?state=lost"])
def test_a_query_parameter_outside_its_range_is_refused(api: Api, path: str) -> None:
    response = api.get(path, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid_parameter")


@pytest.mark.parametrize("path", ["/v1/meshes/abc", "/v1/meshes/" + "g" * 64, "/v1/meshes/" + "0" * 63, "/v1/meshes/%2e%2e"])
def test_an_id_of_another_form_is_no_mesh(api: Api, path: str) -> None:
    response = api.get(path, faulty=True)
    assert response.status_code in (400, 404)


def test_head_answers_like_get_without_the_body(api: Api, grid_mesh: str) -> None:
    for path in ("/healthz", f"/v1/meshes/{grid_mesh}"):
        response = requests.head(api.server.url + path, timeout=PATIENCE_SECONDS)
        assert response.status_code == 200 and response.content == b""


def test_one_connection_serves_many_requests(api: Api) -> None:
    request = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
    with socket.create_connection(("127.0.0.1", api.server.port), timeout=60) as connection:
        reader = connection.makefile("rb")
        for number in range(200):
            connection.sendall(request)
            status = reader.readline()
            assert status.startswith(b"HTTP/1.1 200"), (number, status)
            length = 0
            while (line := reader.readline().strip()):
                name, _, value = line.partition(b":")
                if name.lower() == b"content-length":
                    length = int(value)
            reader.read(length)


def test_a_slow_sender_does_not_keep_others_waiting(api: Api) -> None:
    slow = [socket.create_connection(("127.0.0.1", api.server.port)) for _ in range(16)]
    try:
        for connection in slow:
            connection.sendall(b"POST /v1/geodesics HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n\r\n{")
        assert api.get("/healthz", timeout=PATIENCE_SECONDS / 2).status_code == 200, "far less than the senders would take"
    finally:
        for connection in slow:
            connection.close()
