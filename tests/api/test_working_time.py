"""Time limits are exceeded by work and by a hang, and not by the work of other processes."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from typing import Callable, Iterator

import pytest

import working_time
from working_time import WorkingTime, comes_true, cpu_of_children, ends_within

Start = Callable[[str], int]


@pytest.fixture
def start() -> Iterator[Start]:
    """A function that starts a program of one line of Python and returns its process id."""
    started = []

    def run(line: str) -> int:
        started.append(subprocess.Popen([sys.executable, "-c", line], start_new_session=True))
        return started[-1].pid

    yield run
    for process in started:
        os.killpg(process.pid, signal.SIGKILL)  # with the processes that it has started
        process.wait()


SPINS = "while True: pass"
SLEEPS = "import time; time.sleep(600)"
STARTS_ONE_THAT_SPINS = f"import subprocess, sys; subprocess.run([sys.executable, '-c', '{SPINS}'])"


@pytest.mark.parametrize("line", [SPINS, STARTS_ONE_THAT_SPINS])
def test_work_that_goes_on_breaks_the_limit(start: Start, line: str) -> None:
    with pytest.raises(AssertionError, match="it goes on: .* CPU seconds"):
        ends_within(start(line), lambda: True, 0.3, "it goes on")


def test_waiting_breaks_no_limit_before_patience_ends(start: Start, monkeypatch: pytest.MonkeyPatch) -> None:
    pid = start(SLEEPS)
    time.sleep(0.2)
    work, end = WorkingTime(pid), time.monotonic() + 0.5
    ends_within(pid, lambda: time.monotonic() < end, 0.3, "it goes on")
    work.check(0.3, "it goes on")
    monkeypatch.setattr(working_time, "PATIENCE_SECONDS", 0.1)
    with pytest.raises(AssertionError, match="on the wall's clock, of which"):
        work.check(0.3, "it hangs")


def test_what_never_comes_fails() -> None:
    with pytest.raises(AssertionError, match="the answer: not within"):
        comes_true(lambda: False, "the answer", 0.1)


def test_the_work_of_children_that_have_ended_is_counted() -> None:
    before = cpu_of_children()
    subprocess.run([sys.executable, "-c", "import time\nwhile time.process_time() < 0.3: pass"], check=True)
    assert cpu_of_children() - before >= 0.3
