"""Resources of a server's processes, and requests that are sent without waiting for their answers."""

from __future__ import annotations

import re
import socket
import time
from pathlib import Path

import pytest

from costly import Costly
from harness import SANITIZED, ServerProcess
from working_time import cpu_seconds

memory_is_its_own = pytest.mark.skipif(SANITIZED, reason="the address sanitizer keeps freed memory and reserves any amount of addresses")
"""Marks tests that measure the server's memory."""


def cpu_within(pid: int, seconds: float) -> float:
    """CPU seconds that the processes use in the next `seconds`."""
    before = sum(cpu_seconds(pid).values())
    time.sleep(seconds)
    return max(0.0, sum(cpu_seconds(pid).values()) - before)


def reset_peak(pid: int) -> None:
    """Restarts the measurement of the process's peak memory."""
    Path(f"/proc/{pid}/clear_refs").write_text("5")


def peak_bytes(pid: int) -> int:
    """The process's peak resident memory since `reset_peak`."""
    status = Path(f"/proc/{pid}/status").read_text()
    return 1024 * int(re.search(r"VmHWM:\s+(\d+)", status).group(1))  # type: ignore[union-attr]


def sent_request(server: ServerProcess, request: Costly) -> socket.socket:
    connection = socket.create_connection(("127.0.0.1", server.port))
    connection.settimeout(600)
    head = (f"{request.method} {request.path} HTTP/1.1\r\nHost: localhost\r\nAccept: {request.accept}\r\nContent-Length: {len(request.body)}\r\n"
            f"Content-Type: {request.content_type}\r\n\r\n")
    try:
        connection.sendall((head if request.body else re.sub("Content-.*?\r\n", "", head)).encode() + request.body)
    except (BrokenPipeError, ConnectionResetError):
        pass  # the server refused the request before all of it had arrived; the answer says so
    return connection


def first_line(connection: socket.socket) -> str:
    return connection.recv(4096).split(b"\r\n", 1)[0].decode()
