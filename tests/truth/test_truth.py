"""The suite itself can fail: planted deviations, refusals and checks that nothing comes to are found, and the same seed gives the same case."""

from __future__ import annotations

import csv
import math
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, Iterator, Tuple

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

import run  # noqa: E402
from truth import ALL_EXAMINED_FROM, ANSWERED, Check, Refusal, Result, Server, generator, run_wing  # noqa: E402


def wing_of(examine: Any) -> ModuleType:
    wing = ModuleType("planted")
    wing.ABOUT = "A planted wing."  # type: ignore[attr-defined]
    wing.CHECKS = {"exact": Check("Something", 1e-9, "of something"), "rough": Check("Something else", 0.1, "of it")}  # type: ignore[attr-defined]
    wing.case = lambda rng: {"number": float(rng.uniform())}  # type: ignore[attr-defined]
    wing.examine = examine  # type: ignore[attr-defined]
    return wing


def result_of(examine: Any, cases: int = 20, first: int = 0, seed: int = 1) -> Result:
    return run_wing("planted", wing_of(examine), Server("http://127.0.0.1:1"), seed, first, cases)


def right(_: Server, case: Any) -> Iterator[Tuple[str, float]]:
    yield "exact", -1e-10
    yield "rough", 0.05 * case["number"]


def test_a_wing_whose_deviations_keep_their_limits_is_sound() -> None:
    result = result_of(right)
    assert result.sound and not result.found
    assert len(result.figures["exact"].deviations) == 20 and result.figures["exact"].largest == 1e-10


@pytest.mark.parametrize("wrong", [1e-8, -1e-8, math.nan, math.inf])
def test_a_deviation_beyond_its_limit_is_found_with_the_case_that_repeats_it(wrong: float) -> None:
    seen = []

    def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
        seen.append(case)
        yield "exact", wrong if len(seen) == 8 else 0.0
        yield "rough", 0

    result = result_of(examine)
    assert not result.sound and [(found.check, found.index) for found in result.found] == [("exact", 7)]
    assert result.figures["exact"].beyond == 1 and result.figures["exact"].worst_case == 7
    assert wing_of(right).case(generator(1, "planted", 7)) == seen[7]


def test_the_largest_of_several_deviations_of_a_case_counts() -> None:
    result = result_of(lambda server, case: iter([("rough", 0.01), ("rough", 0.2), ("rough", 0.02)]), cases=1)
    assert result.figures["rough"].deviations == {0: 0.2} and not result.sound


@pytest.mark.parametrize("error", [Refusal(422, {"code": "request.invalid", "detail": "No."}), ValueError("No."), KeyError("exact")])
def test_a_case_that_ends_in_a_refusal_or_an_exception_is_found_and_the_others_are_examined(error: Exception) -> None:
    calls = []
    revived = []

    def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
        calls.append(case)
        if len(calls) == 3:
            raise error
        yield "exact", 0

    result = run_wing("planted", wing_of(examine), Server("http://127.0.0.1:1"), 1, 0, 5, revive=lambda: revived.append(True))
    assert [(found.check, found.index) for found in result.found] == [(ANSWERED, 2)] and type(error).__name__ in result.found[0].message
    assert len(calls) == 5 and revived == [True]


def test_a_check_that_no_case_comes_to_is_a_fault_of_a_long_run() -> None:
    def examine(server: Server, case: Any) -> Iterator[Tuple[str, float]]:
        yield "exact", 0

    assert result_of(examine, cases=5).sound
    long = result_of(examine, cases=ALL_EXAMINED_FROM)
    assert long.unexamined == ["rough"] and not long.sound


def test_a_check_that_the_wing_does_not_name_is_found() -> None:
    assert not result_of(lambda server, case: iter([("unnamed", 0.0)]), cases=1).sound


def test_random_numbers_depend_on_seed_wing_and_index_alone() -> None:
    draw = lambda *key: generator(*key).uniform()  # noqa: E731
    assert draw(1, "a", 0) == draw(1, "a", 0)
    assert len({draw(1, "a", 0), draw(2, "a", 0), draw(1, "b", 0), draw(1, "a", 1)}) == 4


def test_tables_of_other_wings_and_the_text_between_them_stay(tmp_path: Path) -> None:
    page, numbers = tmp_path / "truth.md", tmp_path / "truth.csv"
    for wing in ("one", "two"):
        rows = [{**row, "wing": wing} for row in run.rows_of(result_of(right))]
        run.write_csv(numbers, rows)
        run.write_page(page, wing, f"About {wing}.", rows)
    page.write_text(page.read_text() + "\nWhat was found.\n")
    rows = [{**row, "wing": "one"} for row in run.rows_of(result_of(right, cases=3))]
    run.write_csv(numbers, rows)
    run.write_page(page, "one", "Another sentence.", rows)
    text = page.read_text()
    assert "Another sentence." in text and "About one." not in text and "About two." in text and text.endswith("What was found.\n")
    with numbers.open(newline="") as file:
        assert [(row["wing"], row["cases"]) for row in csv.DictReader(file) if row["check"] == "exact"] == [("one", "3"), ("two", "20")]


def test_every_wing_has_what_a_run_asks_for() -> None:
    assert run.wings()
    for name in run.wings():
        wing = run.load(name)
        assert wing.ABOUT.endswith(".") and wing.CHECKS and ANSWERED not in wing.CHECKS
        assert all(isinstance(check, Check) and np.isfinite(check.limit) and check.limit >= 0 for check in wing.CHECKS.values())
        assert wing.case(generator(1, name, 0)) is not None
