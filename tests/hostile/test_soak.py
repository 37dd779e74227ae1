"""A short run of `soak.py`, with each kind of fault at least once."""

from __future__ import annotations

from soak import run

WAITS = 0.5
"""Seconds. A request that waits for a long job would take several; another one takes up to a tenth on a busy machine."""


def test_nothing_is_lost_doubled_or_wrong_while_everything_around_the_server_fails() -> None:
    soak, measured = run(requests=2000, jobs=60, every=0.8, seed=3)
    assert soak.counts.wrong == []
    assert soak.counts.events["kill"] >= 3 and soak.counts.events["jobs"] >= 50, soak.counts.events
    assert measured["median"] < WAITS, "paced requests wait for long jobs"
