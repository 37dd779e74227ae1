"""How long a server works, counted so that a test means the same on a machine that is busy with something else.

A clock on the wall also counts the time in which other processes had the processor. So limits count CPU seconds of the server and of
the processes that it started. What waits without computing uses none: therefore the wall's clock is looked at too, with much patience.
"""

from __future__ import annotations

import os
import resource
import subprocess
import time
from pathlib import Path
from typing import Callable, Dict, List

TICKS = float(os.sysconf("SC_CLK_TCK"))
PATIENCE_SECONDS = 300.0
"""After so long on the wall's clock something does not work slowly: it hangs."""


def processes(pid: int) -> List[int]:
    """The process and all that it has started."""
    found, children = [], [pid]
    while children:
        found += children
        shown = subprocess.run(["ps", "-o", "pid=", "--ppid", ",".join(map(str, children))], stdout=subprocess.PIPE,
                               check=False, text=True)
        children = [int(text) for text in shown.stdout.split()]
    return found


def cpu_seconds(pid: int) -> Dict[int, float]:
    """CPU seconds by process, of this one and of all that it has started and that have not ended. Those of a process that has ended are with the one
    that waited for it: sums over all of them never fall, while those of one process may rise by what another one has used."""
    used = {}
    for process in processes(pid):
        try:
            fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
            used[process] = sum(map(int, fields[11:15])) / TICKS
        except OSError:
            pass  # it has just ended
    return used


def cpu_of_children() -> float:
    """CPU seconds of all processes that this one has started and that have ended, with those that they started."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class WorkingTime:
    """CPU seconds that a server uses from now on."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self.before = sum(cpu_seconds(pid).values())
        self.begin = time.monotonic()

    def seconds(self) -> float:
        return max(0.0, sum(cpu_seconds(self.pid).values()) - self.before)

    def check(self, seconds: float, what: str) -> None:
        """Fails where the server has worked for as long, or where nothing has come of much patience."""
        used, waited = self.seconds(), time.monotonic() - self.begin
        assert used < seconds, f"{what}: {used:.2f} CPU seconds, {waited:.2f} on the wall's clock"
        assert waited < PATIENCE_SECONDS + seconds, f"{what}: {waited:.2f} seconds on the wall's clock, of which {used:.2f} were work"


def ends_within(pid: int, goes_on: Callable[[], bool], seconds: float, what: str) -> None:
    """Waits until something no longer goes on. Fails where the server works for as many CPU seconds until then."""
    work = WorkingTime(pid)
    while goes_on():
        work.check(seconds, what)
        time.sleep(0.02)


def comes_true(condition: Callable[[], bool], what: str, seconds: float = PATIENCE_SECONDS) -> None:
    """Waits for something that comes by itself; how soon does not matter."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"{what}: not within {seconds:.0f} seconds"
        time.sleep(0.02)
