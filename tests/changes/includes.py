"""The project's files that a source includes, found by reading the sources, without a compiler."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Dict, FrozenSet, List, Tuple

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*["<]([^">]+)[">]', re.MULTILINE)


class Includes:
    """The include relation. All paths, and the folders that are searched for headers, are relative to `root`."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.names: Dict[str, List[str]] = {}
        self.known: Dict[str, bool] = {}
        self.resolved: Dict[Tuple[str, Tuple[str, ...]], Tuple[str, ...]] = {}

    def names_in(self, file: str) -> List[str]:
        if file not in self.names:
            self.names[file] = INCLUDE.findall((self.root / file).read_text(encoding="utf-8", errors="replace"))
        return self.names[file]

    def is_file(self, file: str) -> bool:
        if file not in self.known:
            self.known[file] = (self.root / file).is_file()
        return self.known[file]

    def of_file(self, file: str, folders: Tuple[str, ...]) -> Tuple[str, ...]:
        """The project's files that this file includes under any condition of the preprocessor."""
        if (file, folders) not in self.resolved:
            found = []
            for name in self.names_in(file):
                candidates = (os.path.normpath(os.path.join(folder, name)) for folder in (os.path.dirname(file), *folders))
                if (first := next(filter(self.is_file, candidates), None)) is not None:
                    found.append(first)
            self.resolved[file, folders] = tuple(found)
        return self.resolved[file, folders]

    def closure(self, source: str, folders: Tuple[str, ...]) -> FrozenSet[str]:
        """The source and every file of the project that it includes, directly or not. Empty if there is no such source."""
        if os.path.isabs(source) or not self.is_file(source):
            return frozenset()
        reached, open_files = {source}, [source]
        while open_files:
            for file in self.of_file(open_files.pop(), folders):
                if file not in reached:
                    reached.add(file)
                    open_files.append(file)
        return frozenset(reached)
