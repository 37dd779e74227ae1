"""Rows of a benchmark that are saved in a CSV file, so that a run that was interrupted goes on from there."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, Callable, Dict, List, Sequence


def written(value: Any) -> str:
    """A cell: lists of numbers separated by spaces, numbers with six digits."""
    if isinstance(value, list):
        return " ".join(f"{part:.6g}" for part in value)
    return f"{value:.6g}" if isinstance(value, float) else str(value)


class SavedRows:
    """The rows of a file, which is written anew with each row that is added. `order` sorts them."""

    def __init__(self, path: Path, columns: Sequence[str], order: "Callable[[Dict[str, str]], Any]") -> None:
        self.path = path
        self.columns = columns
        self.order = order
        self.rows: List[Dict[str, str]] = []
        if path.exists():
            with path.open(encoding="utf-8", newline="") as file:
                self.rows = list(csv.DictReader(file))

    def __contains__(self, key: Any) -> bool:
        """Whether there is a row of this key, which is what `order` makes of it."""
        return any(self.order(row) == key for row in self.rows)

    def add(self, values: Dict[str, Any]) -> Dict[str, str]:
        """Adds a row, in which values that are not given are empty, and returns it as it is written."""
        row = {name: written(values.get(name, "")) for name in self.columns}
        self.rows.append(row)
        self.rows.sort(key=self.order)
        with self.path.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, self.columns, lineterminator="\n")
            writer.writeheader()
            writer.writerows(self.rows)
        return row
