"""Which tests over HTTP, in the browser and on the pages a change in a room of the engine can reach.

A room that no other room uses, and whose headers the server reads in files with the room's words in their names alone, is reached
by requests about its subject only. A test without these words, in itself and in the modules that it imports, makes no such request.
Whether a room is still like that is looked up in the sources each time; for every other room all tests run.
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
"""In lower case. A word too many costs time, and a word too few tests."""

READS_A_FOLDER = re.compile(r"glob\(|openapi\.yaml|\"examples\"")
"""Tests that make the requests of a folder or of the contract, and name no subject."""

OF_ALL = {"conftest.py", "harness.py", "contract.py", "harness.mjs"}
"""What each test imports: the words of the contract in it are not the test's own."""

OUTSIDE_THE_SERVER = re.compile(r"tests/|engine/(examples|lab|helper)/")


def words_of(graph: Graph, path: str) -> Optional[str]:
    """The words of the room that this file belongs to, or None where its change can reach other requests than the room's."""
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
    """The test's own text and that of the modules beside it that it imports, in lower case."""
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
    """Names of the tests in a folder that can make a request of which one of these words is the subject."""
    found = set()
    for path in (root / folder).glob(pattern):
        text = text_of_test(path)
        if re.search(words, text) or READS_A_FOLDER.search(text):
            found.add(path.name)
    return found


def pages_about(root: Path, words: str) -> Set[str]:
    pages = [*root.glob("*.md"), *root.glob("docs/*.md"), *root.glob("docs/notes/*.md"), root / "deploy/README.md"]
    return {path.relative_to(root).as_posix() for path in pages if re.search(words, path.read_text(encoding="utf-8").lower())}
