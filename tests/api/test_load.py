"""Many connections at once; the long version is tests/bench/server_load.py."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Callable

from harness import ServerProcess

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bench"))

from server_load import Load, Workload, memory_at  # noqa: E402

REQUESTS = 3000
CONNECTIONS = 64
ALLOWED_GROWTH = 32 * 1024 * 1024
"""Bytes; after the first half every cache and thread is warm, so what still grows would grow for ever."""


def test_64_connections_with_mixed_requests_see_no_error_and_memory_does_not_grow(new_server: Callable[..., ServerProcess]) -> None:
    server = new_server()
    load = Load(Workload(server), REQUESTS)
    _, memory = load.run(CONNECTIONS, server)
    assert load.failures == []
    assert load.done == REQUESTS
    assert memory_at(memory, 1.0) - memory_at(memory, 0.5) < ALLOWED_GROWTH
