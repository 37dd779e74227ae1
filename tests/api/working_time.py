"""The working time of a server, measured so that a test has the same meaning on a busy machine.

Wall-clock time includes the time in which other processes used the processor. So limits are in CPU seconds of the server and of the
processes that it started. A process that waits uses no CPU time; therefore there is also a long limit in wall-clock time.
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
"""Wall-clock seconds after which a process counts as hanging."""


def processes(pid: int) -> List[int]:
    """The process and all processes that it has started."""
    found, children = [], [pid]
    while children:
        found += children
        shown = subprocess.run(["ps", "-o", "pid=", "--ppid", ",".join(map(str, children))], stdout=subprocess.PIPE,
                               check=False, text=True)
        children = [int(text) for text in shown.stdout.split()]
    return found


def cpu_seconds(pid: int) -> Dict[int, float]:
    """CPU seconds by process, for this one and all running processes that it has started. Those of an ended process are added to the process that
    waited for it. The sum over all processes never decreases, but the value of one process may increase by that of an ended one."""
    used = {}
    for process in processes(pid):
        try:
            fields = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
            used[process] = sum(map(int, fields[11:15])) / TICKS
        except OSError:
            pass  # the process has just ended
    return used


def cpu_of_children() -> float:
    """CPU seconds of all ended processes that this one has started, directly or not."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class WorkingTime:
    """Measures the CPU seconds that a server uses from now on."""

    def __init__(self, pid: int) -> None:
        self.pid = pid
        self.before = sum(cpu_seconds(pid).values())
        self.begin = time.monotonic()

    def seconds(self) -> float:
        return max(0.0, sum(cpu_seconds(self.pid).values()) - self.before)

    def check(self, seconds: float, what: str) -> None:
        """Fails if the server has used this many CPU seconds, or if PATIENCE_SECONDS have passed."""
        used, waited = self.seconds(), time.monotonic() - self.begin
        assert used < seconds, f"{what}: {used:.2f} CPU seconds, {waited:.2f} on the wall's clock"
        assert waited < PATIENCE_SECONDS + seconds, f"{what}: {waited:.2f} seconds on the wall's clock, of which {used:.2f} were work"


def ends_within(pid: int, goes_on: Callable[[], bool], seconds: float, what: str) -> None:
    """Waits until `goes_on` is false. Fails if the server uses this many CPU seconds until then."""
    work = WorkingTime(pid)
    while goes_on():
        work.check(seconds, what)
        time.sleep(0.02)


def comes_true(condition: Callable[[], bool], what: str, seconds: float = PATIENCE_SECONDS) -> None:
    """Waits until the condition is true, however long this takes."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, f"{what}: not within {seconds:.0f} seconds"
        time.sleep(0.02)
