"""Bars of progress, which are shown only on terminals and in notebooks."""

from __future__ import annotations

import builtins
import io
import sys
from types import ModuleType
from typing import Any, List, Tuple

import pytest

from supple import progress as module
from supple.progress import Reporter


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
