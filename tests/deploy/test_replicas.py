"""A short run of `replicas.py`."""

from __future__ import annotations

from replicas import SERVERS, run


def test_servers_that_are_killed_and_replaced_lose_nothing() -> None:
    trial, wrong = run(jobs=90, every=1, requests=120, seed=5)
    assert wrong == {"kills": 0, "upgrade": 0}, trial.wrong[:10]
    assert trial.counts["killed"] >= SERVERS - 1, trial.counts
    assert trial.counts["requests during the upgrade"] >= 120
