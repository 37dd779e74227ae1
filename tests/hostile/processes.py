"""What a server's processes use, and requests that are sent without waiting for their answers."""

from __future__ import annotations

import os
import re
import socket
import subprocess
import time
from pathlib import Path
from typing import List

import pytest

from costly import Costly
from harness import SANITIZED, ServerProcess

memory_is_its_own = pytest.mark.skipif(SANITIZED, reason="the address sanitizer keeps freed memory and reserves any amount of addresses")
"""For tests of how much memory the server takes."""

TICKS = float(os.sysconf("SC_CLK_TCK"))


def processes(pid: int) -> List[int]:
    """The process and all that it has started."""
    found, children = [], [pid]
    while children:
        found += children
        shown = subprocess.run(["ps", "-o", "pid=", "--ppid", ",".join(map(str, children))], stdout=subprocess.PIPE,
                               check=False, text=True)
        children = [int(text) for text in shown.stdout.split()]
    return found


def cpu_seconds(pid: int) -> "dict[int, float]":
    used = {}
    for process in processes(pid):
        try:
            fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
            used[process] = (int(fields[11]) + int(fields[12])) / TICKS
        except OSError:
            pass  # it has just ended
    return used


def cpu_within(pid: int, seconds: float) -> float:
    """CPU seconds that the processes use from now on."""
    before = cpu_seconds(pid)
    time.sleep(seconds)
    return sum(max(0.0, used - before.get(process, 0)) for process, used in cpu_seconds(pid).items())


def quiet_within(pid: int, seconds: float, quiet: float) -> float:
    """CPU seconds of the first half second in which they are below `quiet`, or of the last that began in time."""
    end = time.monotonic() + seconds
    while True:
        used = cpu_within(pid, 0.5)
        if used < quiet or time.monotonic() >= end:
            return used


def reset_peak(pid: int) -> None:
    """From now on the peak of the process's memory is counted anew."""
    Path(f"/proc/{pid}/clear_refs").write_text("5")


def peak_bytes(pid: int) -> int:
    """The most main memory that the process had since `reset_peak`."""
    status = Path(f"/proc/{pid}/status").read_text()
    return 1024 * int(re.search(r"VmHWM:\s+(\d+)", status).group(1))  # type: ignore[union-attr]


def sent_request(server: ServerProcess, request: Costly) -> socket.socket:
    connection = socket.create_connection(("127.0.0.1", server.port))
    connection.settimeout(120)
    head = (f"{request.method} {request.path} HTTP/1.1\r\nHost: localhost\r\nAccept: {request.accept}\r\nContent-Length: {len(request.body)}\r\n"
            f"Content-Type: {request.content_type}\r\n\r\n")
    try:
        connection.sendall((head if request.body else re.sub("Content-.*?\r\n", "", head)).encode() + request.body)
    except (BrokenPipeError, ConnectionResetError):
        pass  # it was refused before all of it had arrived; the answer says so
    return connection


def first_line(connection: socket.socket) -> str:
    return connection.recv(4096).split(b"\r\n", 1)[0].decode()
