"""Many simultaneous connections; tests/bench/server_load.py is the long version."""

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
"""Bytes. In the second half all caches are filled and all threads exist, so that further growth would be a leak."""


def test_64_connections_with_mixed_requests_see_no_error_and_memory_does_not_grow(new_server: Callable[..., ServerProcess]) -> None:
    server = new_server()
    load = Load(Workload(server), REQUESTS)
    _, memory = load.run(CONNECTIONS, server)
    assert load.failures == []
    assert load.done == REQUESTS
    assert memory_at(memory, 1.0) - memory_at(memory, 0.5) < ALLOWED_GROWTH
