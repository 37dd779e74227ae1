"""Hostile connections with generated content, during which the server must answer other clients."""

from __future__ import annotations

import random
import socket
import struct
import threading
import time
from typing import Callable, Dict, Iterator, List

import pytest
import requests

from harness import ServerProcess

PROBE = b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n"
POST = b"POST /v1/geodesics HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
MIB = 2**20


def empty_lines(_: random.Random) -> Iterator[bytes]:
    while True:
        yield b"\r\n" * 700


def probes_that_nobody_reads(_: random.Random) -> Iterator[bytes]:
    while True:
        yield PROBE * 1000


def refusals_that_nobody_reads(_: random.Random) -> Iterator[bytes]:
    while True:
        yield b"GET /nothing HTTP/1.1\r\nHost: localhost\r\n\r\n" * 1000


def bodies_that_are_announced(_: random.Random) -> Iterator[bytes]:
    yield POST + b"Content-Length: %d\r\n\r\n" % (512 * MIB)
    while True:
        yield b""


def bodies_that_do_not_end(chance: random.Random) -> Iterator[bytes]:
    yield POST + b"Content-Length: %d\r\n\r\n" % (512 * MIB)
    for _ in range(chance.randint(1, 40)):
        yield b" " * MIB
    while True:
        yield b""


def small_chunks(_: random.Random) -> Iterator[bytes]:
    yield POST + b"Transfer-Encoding: chunked\r\n\r\n"
    while True:
        yield b"1\r\n \r\n" * 1000


def heads_in_single_bytes(_: random.Random) -> Iterator[bytes]:
    for byte in b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n" + b"X: y\r\n" * 10_000:
        yield bytes([byte])


def bytes_of_all_kinds(chance: random.Random) -> Iterator[bytes]:
    while True:
        yield chance.choice([b"\r", b"\n", b"\r\n", b"\0", b"GET ", b"POST ", b"/", b" HTTP/1.1\r\n", b"Host: localhost\r\n", b"\r\n\r\n",
                             PROBE, POST + b"\r\n", b"Content-Length: 3\r\n", b"Transfer-Encoding: chunked\r\n", b"0\r\n\r\n", b"f\r\n"])


KINDS: Dict[str, Callable[[random.Random], Iterator[bytes]]] = {
    kind.__name__: kind for kind in (empty_lines, probes_that_nobody_reads, refusals_that_nobody_reads, bodies_that_are_announced,
                                     bodies_that_do_not_end, small_chunks, heads_in_single_bytes, bytes_of_all_kinds)}


def send(port: int, kind: str, seed: int, ended: threading.Event) -> None:
    """Connects and sends the content of this kind. Repeats this when the server closes the connection or everything is sent."""
    chance = random.Random(f"{kind} {seed}")
    while not ended.is_set():
        try:
            with socket.create_connection(("127.0.0.1", port), timeout=0.2) as connection:
                if chance.random() < 0.5:  # closing it resets the connection
                    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
                for piece in KINDS[kind](chance):
                    if ended.is_set():
                        break
                    if not piece:
                        ended.wait(1)
                    while piece and not ended.is_set():
                        try:
                            piece = piece[connection.send(piece):]
                        except socket.timeout:
                            continue  # the server does not read at the moment
        except OSError:
            ended.wait(0.01)


def longest_waits(server: ServerProcess, kinds: List[str], connections: int, seconds: float) -> Dict[str, float]:
    """For each path the longest duration of an answer in seconds, with `connections` hostile connections of each kind."""
    ended = threading.Event()
    strangers = [threading.Thread(target=send, args=(server.port, kind, k, ended)) for kind in kinds for k in range(connections)]
    for stranger in strangers:
        stranger.start()
    waits: Dict[str, float] = {}
    try:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for method, path, body in (("GET", "/healthz", None), ("GET", "/readyz", None), ("POST", "/v1/geodesics", b"{}")):
                begin = time.monotonic()
                answer = requests.request(method, server.url + path, data=body, headers={"Content-Type": "application/json"}, timeout=30)
                waits[path] = max(waits.get(path, 0), time.monotonic() - begin)
                assert answer.status_code == (200 if body is None else 400), (path, answer.text)
    finally:
        ended.set()
        for stranger in strangers:
            stranger.join()
    return waits


@pytest.mark.parametrize("kind", list(KINDS))
def test_others_are_answered_while_strangers_send(new_server: Callable[..., ServerProcess], kind: str) -> None:
    server = new_server("--max-connections", "60", "--memory", "1GiB")
    print(kind, longest_waits(server, [kind], 10, 3))


def test_others_are_answered_while_strangers_of_all_kinds_send(new_server: Callable[..., ServerProcess]) -> None:
    server = new_server("--max-connections", "100", "--memory", "1GiB")
    print(longest_waits(server, list(KINDS), 3, 5))
