"""The short version of `soak.py`: each kind of fault at least once."""

from __future__ import annotations

from soak import run

WAITS = 0.5
"""Seconds. A request that waited for a long job would take several; on a busy machine one that does not may take a tenth."""


def test_nothing_is_lost_doubled_or_wrong_while_everything_around_the_server_fails() -> None:
    soak, measured = run(requests=2000, jobs=60, every=0.8, seed=3)
    assert soak.counts.wrong == []
    assert soak.counts.events["kill"] >= 3 and soak.counts.events["jobs"] >= 50, soak.counts.events
    assert measured["median"] < WAITS, "paced requests wait for long jobs"
