#!/usr/bin/env python3
"""Prints which tests of programs of GoogleTest took longest: tests/slowest.py FOLDER, with what the programs have written there."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import List, Tuple

SHOWN = 12


def times_of(path: Path) -> List[Tuple[float, str]]:
    """Seconds and name of each test of a file that GoogleTest has written. A program that was ended leaves none, or an empty one."""
    text = path.read_text(encoding="utf-8")
    suites = json.loads(text)["testsuites"] if text else []
    program = path.name.split(".")[0]
    return [(float(test["time"].rstrip("s")), f"{program} {suite['name']}.{test['name']}") for suite in suites for test in suite["testsuite"]]


def main() -> None:
    times = sorted((time for path in Path(sys.argv[1]).glob("*.json") for time in times_of(path)), reverse=True)
    if times:
        print(f"the slowest of {len(times)} tests, which took {sum(seconds for seconds, _ in times):.0f} s one after the other, in seconds:")
    for seconds, name in times[:SHOWN]:
        print(f"  {seconds:.1f} {name}")


if __name__ == "__main__":
    main()
