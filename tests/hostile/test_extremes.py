"""A short run of `extremes.py`."""

from __future__ import annotations

import pytest

from extremes import Extremes
from harness import ServerProcess


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_extreme_numbers_are_answered_or_refused_by_field_and_in_time(server: ServerProcess, seed: int) -> None:
    extremes = Extremes(server, seed)
    extremes.run(150)
    assert extremes.broken == []
    assert extremes.statuses[200] > 30, "most requests are refused, so that little is tried"


@pytest.mark.parametrize("path, field", [("embedded-systems", "gravity"), ("voronoi-optimizations", "objectives")])
def test_what_a_field_may_hold_is_answered_or_refused(server: ServerProcess, path: str, field: str) -> None:
    extremes = Extremes(server, 1, path)
    asked = 0
    for base in extremes.bases:
        of_body = extremes.contract.resolve(base.schema)["properties"]
        fields = [((), name, schema) for name, schema in of_body.items() if name in base.body]
        for place, name, schema in [*fields, *extremes.growth.missing(base.schema, base.body)]:
            if name != field:
                continue
            for _ in range(5):
                body = extremes.with_field(base, place, name, schema)
                assert extremes.ask(base.path, body, base.accept) == "", body
                asked += 1
    assert asked >= 5
