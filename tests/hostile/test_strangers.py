"""Hostile requests, sent directly or through another user's browser."""

from __future__ import annotations

import socket
import threading
import time
from contextlib import ExitStack
from typing import Callable, Dict, List

import pytest
import requests

from contract import Contract
from harness import Api, ServerProcess, problem_code
from processes import memory_is_its_own
from shapes import flat_grid

JSON = {"Content-Type": "application/json"}


def exchange(server: ServerProcess, message: bytes, seconds: float = 60) -> bytes:
    """Sends bytes unchanged and returns everything that the server answers."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=seconds) as connection:
        connection.sendall(message)
        received = b""
        try:
            while chunk := connection.recv(65536):
                received += chunk
                if b"\r\n\r\n" in received and b"Connection: close" not in received:
                    break
        except (socket.timeout, ConnectionError):
            pass
        return received


@pytest.mark.parametrize("host", ["evil.example", "localhost.evil.example:8080", "127.0.0.1.evil.example", "192.168.0.7"])
@pytest.mark.parametrize("path", ["/healthz", "/v1/meshes", "/nothing"])
def test_a_name_that_somebody_made_point_here_is_not_answered(api: Api, host: str, path: str) -> None:
    response = api.get(path, headers={"Host": host}, faulty=True)
    assert (response.status_code, problem_code(response)) == (421, "http.misdirected_request")


@pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://localhost.evil.example"])
def test_a_page_of_another_site_neither_lists_nor_deletes_nor_computes(api: Api, grid_mesh: str, origin: str) -> None:
    for method, path in [("GET", "/v1/meshes"), ("DELETE", f"/v1/meshes/{grid_mesh}"), ("POST", "/v1/meshes")]:
        response = api.call(method, path, headers={"Origin": origin, **JSON}, body=b"{}" if method == "POST" else None, faulty=True)
        assert (response.status_code, problem_code(response)) == (403, "http.cross_origin")
    assert api.get(f"/v1/meshes/{grid_mesh}").status_code == 200


def test_the_servers_own_page_is_answered(api: Api) -> None:
    assert api.get("/v1/meshes", headers={"Origin": api.server.url, "Sec-Fetch-Site": "same-origin"}).status_code == 200


@pytest.mark.parametrize("kind", ["", "text/plain", "application/x-www-form-urlencoded"])
def test_what_a_page_may_post_anywhere_without_asking_is_refused(api: Api, grid_mesh: str, kind: str) -> None:
    body = f'{{"mesh": "{grid_mesh}", "pairs": []}}'.encode()
    answer = exchange(api.server, b"POST /v1/geodesics HTTP/1.1\r\nHost: localhost\r\n"
                      + (b"Content-Type: " + kind.encode() + b"\r\n" if kind else b"")
                      + b"Content-Length: " + str(len(body)).encode() + b"\r\n\r\n" + body)
    assert answer.startswith(b"HTTP/1.1 415"), answer[:200]


@pytest.mark.parametrize("framing", [
    b"Content-Length: 2\r\nContent-Length: 2\r\n", b"Content-Length: +2\r\n", b"Content-Length: -2\r\n", b"Content-Length: 2x\r\n",
    b"Content-Length : 2\r\n", b"Content-Length: 2, 2\r\n", b"X: a\r\n folded\r\nContent-Length: 2\r\n", b"X: a\0b\r\nContent-Length: 2\r\n",
    b"Transfer-Encoding: chunked\r\nContent-Length: 2\r\n", b"Transfer-Encoding: chunked, identity\r\n", b"Host: localhost\r\n",
], ids=["twice", "plus", "minus", "letter", "space", "list", "folded", "nul", "both", "codings", "two-hosts"])
def test_framing_that_two_readers_understand_differently_is_refused_and_the_connection_closed(api: Api, framing: bytes) -> None:
    smuggled = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
    answer = exchange(api.server, b"POST /v1/geodesics HTTP/1.1\r\nHost: localhost\r\n" + framing + b"\r\n{}" + smuggled)
    assert answer.startswith(b"HTTP/1.1 400"), answer[:200]
    assert answer.count(b"HTTP/1.1") == 1 and b"Connection: close" in answer


def test_a_request_without_a_host_is_refused(api: Api) -> None:
    assert exchange(api.server, b"GET /healthz HTTP/1.1\r\n\r\n").startswith(b"HTTP/1.1 400")
    assert exchange(api.server, b"GET /healthz HTTP/1.0\r\n\r\n").startswith(b"HTTP/1.1 200")


def test_a_range_that_is_none_is_ignored(api: Api) -> None:
    for value in ("bytes=5-2", "bytes=0-5,9-3", "pages=1-2", "bytes=-", "bytes=999999999999999999999-"):
        assert api.get("/healthz", headers={"Range": value}).status_code == 200


@pytest.mark.parametrize("path", ["/healthz", "/v1/meshes", "/metrics", "/openapi.yaml", "/nothing"])
def test_every_answer_tells_browsers_what_not_to_do_with_it(api: Api, path: str) -> None:
    headers = api.get(path, faulty=True).headers
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["Cross-Origin-Resource-Policy"] == "same-origin"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert len(headers["Supple-Request-Id"]) == 16


HALF = {
    "head": b"GET /v1/meshes HTTP/1.1\r\nHost: localh",
    "body": b"POST /v1/geodesics HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: 1000\r\n\r\n{",
    "nothing": b"",
}


@pytest.mark.parametrize("part", list(HALF))
def test_many_half_sent_requests_keep_nobody_from_being_answered(new_server: Callable[..., ServerProcess], part: str) -> None:
    server = new_server("--max-connections", "300")
    with ExitStack() as stack:
        for _ in range(400):
            connection = stack.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=60))
            try:
                connection.sendall(HALF[part])
            except ConnectionError:
                pass  # the server has closed it in favour of a later connection
        for path in ("/healthz", "/readyz", "/metrics", "/v1/meshes"):
            assert requests.get(server.url + path, timeout=60).status_code == 200
    assert server.metrics()["supple_connections_evicted"] > 0


def test_slow_bodies_take_no_thread(new_server: Callable[..., ServerProcess]) -> None:
    server = new_server("--max-requests", "2", "--request-timeout", "5")
    with ExitStack() as stack:
        slow = [stack.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=60)) for _ in range(20)]
        for connection in slow:
            connection.sendall(HALF["body"])
        for _ in range(10):
            assert requests.get(server.url + "/v1/meshes", timeout=4).status_code == 200
        answer = slow[0].recv(65536)  # the answer comes after its time limit
        assert answer.startswith(b"HTTP/1.1 408") and b"http.request_timeout" in answer


@memory_is_its_own
def test_large_json_is_refused_before_it_takes_the_memory(new_server: Callable[..., ServerProcess]) -> None:
    """A body of 60 MB with small arrays once took 840 MB; six at once took 5.1 GB, of which 4.2 GB remained allocated."""
    server = new_server("--memory", "400MiB", "--max-request-memory", "300MiB", "--max-json-values", "100000000")
    body = b"[" + b"[]," * 20_000_000 + b"0"
    before = server.resident_bytes()
    peak: List[int] = [before]
    ended = threading.Event()

    def watch() -> None:
        while not ended.is_set():
            peak[0] = max(peak[0], server.resident_bytes())
            time.sleep(0.01)

    statuses: Dict[int, List[str]] = {}

    def send() -> None:
        try:
            response = requests.post(server.url + "/v1/geodesics", data=body, headers=JSON, timeout=60)
            statuses.setdefault(response.status_code, []).append(str(response.json()["code"]))
        except requests.ConnectionError:
            statuses.setdefault(0, []).append("closed")  # refused before the body was sent

    watcher = threading.Thread(target=watch)
    watcher.start()
    senders = [threading.Thread(target=send) for _ in range(6)]
    for sender in senders:
        sender.start()
    for sender in senders:
        sender.join()
    time.sleep(1)
    ended.set()
    watcher.join()
    assert server.running()
    assert set(statuses) <= {0, 413, 429, 503}, statuses
    assert {code for codes in statuses.values() for code in codes} <= {"request.too_much_memory", "server.client_share", "server.out_of_memory", "closed"}
    assert peak[0] - before < 700 * 2**20, f"{(peak[0] - before) / 2**20:.0f} MiB more than before"
    assert server.resident_bytes() - before < 200 * 2**20
    assert requests.get(server.url + "/healthz", timeout=60).status_code == 200


def test_an_answer_beyond_its_limit_is_refused(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    api = Api(new_server("--max-answer", "64KiB"), contract)
    request = {"mesh": api.upload(*flat_grid(80)), "sources": [{"vertex": 0}]}
    response = api.post("/v1/geodesic-fields", request, headers={"Accept": "application/json"})
    assert (response.status_code, problem_code(response)) == (422, "answer.too_large")
    assert response.json()["setting"] == "--max-answer"
