"""Deviations of finished cases in a file, so that a run that was ended goes on where it was."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Dict, Iterable, Tuple

Outcome = Tuple[Dict[str, float], str]
"""The deviations of a case by their checks, and why it ended early; empty if it did not."""


def state_of(files: Iterable[Path]) -> str:
    """Tells the state of the suite and of the server apart: what an earlier one has found says nothing about this one."""
    digest = hashlib.sha256()
    for path in sorted(files):
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()[:16]


class KeptCases:
    """The cases of one wing, one seed and one state. Each is a line of JSON; a line that was cut off by the end of a run counts for nothing."""

    def __init__(self, path: Path, wing: str, seed: int, state: str) -> None:
        self._path = path
        self._of = {"wing": wing, "seed": seed, "state": state}
        self.outcomes: Dict[int, Outcome] = {}
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        for line in text.splitlines():
            try:
                entry = json.loads(line)
            except ValueError:
                continue
            if all(entry.get(key) == value for key, value in self._of.items()):
                self.outcomes[entry["case"]] = (entry["deviations"], entry["failure"])
        if text and not text.endswith("\n"):
            with path.open("a", encoding="utf-8") as file:
                file.write("\n")

    def add(self, case: int, outcome: Outcome) -> None:
        deviations, failure = outcome
        with self._path.open("a", encoding="utf-8") as file:
            file.write(json.dumps({**self._of, "case": case, "deviations": deviations, "failure": failure}) + "\n")
        self.outcomes[case] = outcome
