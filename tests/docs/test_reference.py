"""The reference of the engine's public headers: `doxygen docs/Doxyfile` writes it without a warning, and every name that a docstring
mentions exists. tests/run.sh writes it before these tests run."""

from __future__ import annotations

import re
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Dict, Iterator, List, Set, Tuple

import pytest

from pages import ROOT

REFERENCE = ROOT / "build" / "reference"
HEADERS = sorted(ROOT.glob("engine/*/include/**/*.h"))
#: What docstrings may name that the engine does not declare.
FOREIGN = ("std", "Eigen")


def code_of(header: str) -> str:
    return "\n".join(line.partition("//")[0] for line in header.split("\n"))


def comments_of(header: str) -> Iterator[Tuple[int, str]]:
    for number, line in enumerate(header.split("\n"), 1):
        yield number, line.partition("//")[2]


def declared_names() -> Set[str]:
    """The full names of what the reference describes."""
    names: Set[str] = set()
    for compound in ElementTree.parse(REFERENCE / "supple.tag").getroot():
        scope = "" if compound.get("kind") == "file" else f"{compound.findtext('name')}::"
        names.add(scope.removesuffix("::"))
        for member in compound.findall("member"):
            name = f"{scope}{member.findtext('name')}"
            names |= {name, *(f"{name}::{value.text}" for value in member.findall("enumvalue"))}
    return names


def unknown_names(header: str, declared: Set[str], words: Set[str]) -> List[str]:
    """Qualified names in comments that end no declared name, and names between backquotes that no header has."""
    found = []
    for number, comment in comments_of(header):
        for name in re.findall(r"(?<![\w:])(?:\w+::)+\w+", comment):
            if not name.startswith(FOREIGN) and not any(f"::{known}".endswith(f"::{name}") for known in declared):
                found.append(f"{number}: {name}")
        for code in re.findall(r"`([\w:.()]+)`", comment):
            found += [f"{number}: {word}" for word in re.findall(r"[A-Za-z_]\w+", code) if word not in words and not code.endswith(".h")]
    return found


def test_the_reference_has_a_page_for_each_header() -> None:
    assert (REFERENCE / "html" / "index.html").exists(), "run doxygen docs/Doxyfile in the root of the checkout"
    described = {compound.findtext("name") for compound in ElementTree.parse(REFERENCE / "supple.tag").getroot() if compound.get("kind") == "file"}
    assert {header.name for header in HEADERS} <= described


def test_docstrings_name_what_exists() -> None:
    texts: Dict[Path, str] = {header: header.read_text(encoding="utf-8") for header in HEADERS}
    words = set(re.findall(r"\w+", "\n".join(map(code_of, texts.values()))))
    declared = declared_names()
    found = [f"{header.relative_to(ROOT)}:{fault}" for header, text in texts.items() for fault in unknown_names(text, declared, words)]
    assert not found, "\n".join(found)


def test_a_name_that_does_not_exist_is_found() -> None:
    header = "/// Calls `solve` of Solver::solve and Solver::gone, which takes `nothing`.\nvoid f();  ///< std::vector\n"
    assert unknown_names(header, {"room::Solver", "room::Solver::solve"}, {"solve"}) == ["1: Solver::gone", "1: nothing"]


@pytest.mark.parametrize("comment, said", [("See @ref nowhere.", "unable to resolve reference"), (r"Has \mu in it.", "unknown command"),
                                           ("A <unit> thing.", "Unsupported xml/html tag"), ("Calls #gone().", "could not be resolved")])
def test_a_faulty_docstring_ends_doxygen(comment: str, said: str, tmp_path: Path) -> None:
    header = tmp_path / "engine" / "room" / "include" / "faulty.h"
    header.parent.mkdir(parents=True)
    header.write_text(f"#pragma once\n/// A room.\nnamespace room {{\n/// {comment}\nint f();\n}}\n", encoding="utf-8")
    (tmp_path / "build").mkdir()
    options = (ROOT / "docs" / "Doxyfile").read_text(encoding="utf-8") + "\nINPUT = engine\n"
    done = subprocess.run(["doxygen", "-"], input=options, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode != 0 and said in done.stderr, done.stderr
