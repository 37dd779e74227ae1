"""Bars of progress, which are shown only on terminals and in notebooks."""

from __future__ import annotations

import builtins
import io
import sys
from types import ModuleType
from typing import Any, List, Tuple

import numpy as np
import pytest

from supple import DesignError, PartialDesign, PartialRound, PolishRound
from supple import progress as module
from supple.progress import Reporter
from supple.rounds import Rounds


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.fixture
def without_tqdm(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def no_tqdm(name: str, *arguments: Any, **more: Any) -> Any:
        if name.split(".")[0] == "tqdm":
            raise ImportError("no tqdm")
        return real(name, *arguments, **more)

    monkeypatch.setattr(builtins, "__import__", no_tqdm)


def test_a_function_is_called_wherever_it_runs() -> None:
    seen: List[Tuple[float, str]] = []
    with Reporter(lambda fraction, stage: seen.append((fraction, stage))) as report:
        report(0.5, "half")
    assert seen == [(0.5, "half")]


def test_nothing_is_shown_where_nobody_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    for progress in (True, False, None):
        stream = io.StringIO()
        monkeypatch.setattr(sys, "stderr", stream)
        with Reporter(progress) as report:
            report(0.5, "half")
        assert stream.getvalue() == ""


def test_without_tqdm_a_terminal_has_one_line_that_goes_away(monkeypatch: pytest.MonkeyPatch, without_tqdm: None) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    with Reporter(True) as report:
        report(0.25, "a long stage")
        report(1.5, "end")
    text = stream.getvalue()
    assert "\r 25 %  a long stage" in text and "100 %  end" in text and "\n" not in text
    assert text.endswith("\r")


def test_each_round_of_polishing_remains_above_the_bar(monkeypatch: pytest.MonkeyPatch, without_tqdm: None) -> None:
    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    with Reporter(True) as report:
        report(0.25, "polish", "best 4.5 %, 12 s left", "4.5 % off by the simulation after 2 s, best 4.5 %")
    assert "4.5 % off by the simulation after 2 s, best 4.5 %\n" in stream.getvalue() and " 25 %  polish, best 4.5 %, 12 s left" in stream.getvalue()
    seen: List[Tuple[float, str]] = []
    with Reporter(lambda fraction, stage: seen.append((fraction, stage))) as report:
        report(0.5, "polish", "best 4.5 %", "a round")
    assert seen == [(0.5, "polish")], "functions get the stage of the server"


def polished(name: str, error: Any, seconds: float) -> PartialRound:
    return PartialRound(name, "IH21", "ih21", PolishRound("step", np.array([0.1]), error, False, "", seconds, 0.0))


def test_the_best_of_several_regions_is_that_of_the_worst_one() -> None:
    rounds = Rounds()
    assert rounds.best() == "" and rounds.add(None) == ""
    assert rounds.add(polished("heel", 0.2, 2.0)) == "heel: 20 % off by the simulation after 2 s, best 20 %"
    assert rounds.add(polished("heel", 0.2, 2.0)) == "", "the same round is reported once more"
    assert rounds.add(polished("heel", 0.3, 1.5)) == "heel: 30 % off by the simulation after 1.5 s, best 20 %"
    assert rounds.best() == "best 20 %"
    assert rounds.add(polished("toe", None, 1.0)) == "toe: not simulated after 1 s"
    rounds.add(polished("toe", 0.01, 1.0))
    assert rounds.best() == "worst: heel, best 20 %"


def test_regions_without_a_name_are_told_apart_by_the_searches_between_them() -> None:
    rounds, search = Rounds(), PartialDesign("", "IH21", "ih21", np.array([0.1]), np.zeros(1), np.zeros(1), DesignError(0.1, 1.0), 3, 0.0)
    for error, seconds in ((0.2, 1.0), (0.01, 2.0)):
        rounds.add(search)
        rounds.add(polished("", error, seconds))
    assert rounds.best() == "worst: region 1, best 20 %"


def test_tqdm_is_used_where_it_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    made: List[Any] = []

    class Bar:
        def __init__(self, **options: Any) -> None:
            self.total, self.n, self.stages, self.closed = options["total"], 0.0, [], False
            made.append(self)

        def set_description_str(self, text: str, refresh: bool) -> None:
            self.stages.append(text)

        def update(self, more: float) -> None:
            self.n += more

        def close(self) -> None:
            self.closed = True

    fake = ModuleType("tqdm.auto")
    fake.tqdm = Bar  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "tqdm", ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", fake)
    monkeypatch.setattr(module, "in_notebook", lambda: True)
    with Reporter(True) as report:
        report(0.25, "first")
        report(0.75, "second")
        assert not made[0].closed
    assert len(made) == 1 and made[0].total == 100 and made[0].n == 75 and made[0].stages == ["first", "second"] and made[0].closed
