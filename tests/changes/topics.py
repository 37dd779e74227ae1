"""The tests over HTTP, in the browser and of the pages that a change in a room of the engine can affect.

If no other room uses a room, and the server includes its headers only in files with the room's words in their names, then only
requests about its subject reach it. A test makes no such request if neither it nor the modules that it imports contain these words.
Whether this is true for a room is determined from the sources each time; for every other room all tests run.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Dict, Optional, Set

from targets import Graph

WORDS: Dict[str, str] = {
    "engine/voronoi": "voronoi|diagram",
    "engine/weave": "weav",
    "engine/embedded": "embedded|network|membrane|host|spring",
}
"""Regular expressions in lower case. A superfluous word costs time; a missing one omits tests."""

READS_A_FOLDER = re.compile(r"glob\(|openapi\.yaml|\"examples\"")
"""Matches tests that make the requests of a folder or of the contract, and do not name a subject."""

OF_ALL = {"conftest.py", "harness.py", "contract.py", "harness.mjs"}
"""Modules that each test imports. Their words, such as those of the contract, do not count as words of the test."""

OUTSIDE_THE_SERVER = re.compile(r"tests/|engine/(examples|lab|helper)/")


def words_of(graph: Graph, path: str) -> Optional[str]:
    """The words of the room of this file, or None if a change of the file can affect other requests than those about the room."""
    room = next((room for room in WORDS if path.startswith(f"{room}/")), None)
    if room is None:
        return None
    for (_, source), files in graph.read.items():
        if source.startswith(f"{room}/") or OUTSIDE_THE_SERVER.match(source):
            continue
        if any(file.startswith(f"{room}/") for file in files) and not re.search(WORDS[room], Path(source).stem):
            return None
    return WORDS[room]


def text_of_test(path: Path) -> str:
    """The text of the test and of the test modules that it imports, in lower case."""
    reached, open_paths, texts = {path}, [path], []
    while open_paths:
        text = open_paths.pop().read_text(encoding="utf-8")
        texts.append(text)
        names = [f"{name}.py" for name in re.findall(r"^\s*(?:from|import) (\w+)", text, re.MULTILINE)]
        names += re.findall(r"from \"\./([\w.]+)\"", text)
        for name in names:
            for folder in (path.parent, path.parents[1] / "api", path.parents[1] / "bench", path.parents[1] / "support"):
                if name not in OF_ALL and (folder / name).is_file() and folder / name not in reached:
                    reached.add(folder / name)
                    open_paths.append(folder / name)
    return "\n".join(texts).lower()


def files_about(root: Path, folder: str, pattern: str, words: str) -> Set[str]:
    """Names of the tests in a folder that can make a request whose subject is one of these words."""
    found = set()
    for path in (root / folder).glob(pattern):
        text = text_of_test(path)
        if re.search(words, text) or READS_A_FOLDER.search(text):
            found.add(path.name)
    return found


def pages_about(root: Path, words: str) -> Set[str]:
    pages = [*root.glob("*.md"), *root.glob("docs/*.md"), *root.glob("docs/notes/*.md"), root / "deploy/README.md"]
    return {path.relative_to(root).as_posix() for path in pages if re.search(words, path.read_text(encoding="utf-8").lower())}
