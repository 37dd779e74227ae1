"""Fixtures of the package's tests."""

from __future__ import annotations

from typing import Callable, Iterator, List

import pytest

from listener import Listener


@pytest.fixture
def listen() -> Iterator[Callable[..., Listener]]:
    opened: List[Listener] = []

    def open_one(answers: List[bytes], delay: float = 0.0) -> Listener:
        opened.append(Listener(answers, delay))
        return opened[-1]

    yield open_one
    for listener in opened:
        listener.close()
