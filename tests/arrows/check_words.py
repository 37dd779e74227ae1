#!/usr/bin/python3
"""Fails where a comment begins as no sentence does, where a constant is not named as CONTRIBUTING.md says, and where a source is
cited that docs/references.md does not have, or is listed there and cited nowhere. Before it looks at the project, it reads lines of which it is known what is wrong with them."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CODE = ("engine", "server", "clients", "tests")
PAGES = ("docs", "README.md", "CONTRIBUTING.md", "models/datasets/README.md")
REFERENCES = "docs/references.md"

# A sentence that begins so leans on a name elsewhere, unless the main clause follows after a comma: "Of several candidates, the ...".
DANGLING = re.compile(r"(?:Of|By|That of|Those of|None of|What of|As|Nor|Which|Than)\b")
MAIN_CLAUSE = re.compile(r"[^.]{0,90},\s+(?:the|a|an|it|its|this|these|each|all|no|one|two|we|there|only|they)\b")
SENTENCE_END = re.compile(r"(?<=[.:;])\s+(?=[A-Z])")
CONSTANT = re.compile(r"\bconst(?:expr|init)?\b[^=;(){}]*?\b(\w+)\s*(?:=|\{)")
FORMER_LIMIT = re.compile(r"(?:most|least|enough|few)_\w+")
CAMEL_CASE = re.compile(r"k[A-Z]\w+")
SCREAMING_LIMIT = re.compile(r"\bconst\s+((?:MOST|LEAST|ENOUGH|FEW)_\w+)")
CITATION = re.compile(r"\[((?:[A-Z][A-Za-z]*|de[A-Z]\w*|van[A-Z]\w*)(?:18|19|20)\d\d|Thesis)(?:, [^\]\n]*)?\](?!\()")
IN_WORDS = re.compile(r"\b[Tt]hesis\b(?!')")


def files(folders: tuple[str, ...], pattern: str) -> list[str]:
    listed = subprocess.run(["git", "ls-files", "--", *folders], cwd=ROOT, capture_output=True, text=True, check=True)
    return [name for name in listed.stdout.splitlines() if re.search(pattern, name)]


def comments(text: str, name: str) -> list[tuple[int, str]]:
    """Line and text of each comment; lines of comment that follow each other are one."""
    found: list[tuple[int, str]] = []
    block: list[str] = []
    start = 0
    mark = r"#(?!!)" if name.endswith((".py", ".txt", ".sh")) else r"///?<?|\*(?!/)|/\*\*?"
    for number, line in enumerate(text.split("\n") + [""], 1):
        whole = re.match(rf"\s*(?:{mark})\s?(.*)$", line)
        beside = None if whole else re.search(r"\s///?<?\s(.*)$", line) if not name.endswith(".py") else re.search(r"\s{2}#\s(.*)$", line)
        if whole:
            if not block:
                start = number
            block.append(whole.group(1).strip())
            continue
        if block:
            found.append((start, " ".join(block)))
            block = []
        if beside:
            found.append((number, beside.group(1).strip()))
    return found


def faults_of_comments(text: str, name: str) -> list[str]:
    faults = []
    for number, comment in comments(text, name):
        for sentence in SENTENCE_END.split(comment):
            opening = DANGLING.match(sentence)
            if opening and not MAIN_CLAUSE.match(sentence[opening.end() :]):
                faults.append(f"{name}:{number}: this comment begins with \"{opening.group(0)}\" and leans on a name elsewhere: {sentence[:100]}")
        if IN_WORDS.search(CITATION.sub("", comment)) and not name.startswith("tests/arrows"):
            faults.append(f"{name}:{number}: cite the thesis by its key, as in [Thesis, eq. 3.13]: {comment[:100]}")
    return faults


def faults_of_constants(text: str, name: str) -> list[str]:
    faults = []
    for number, line in enumerate(text.split("\n"), 1):
        if re.match(r"\s*(//|#|\*)", line):
            continue
        for constant in CONSTANT.findall(line):
            if FORMER_LIMIT.fullmatch(constant):
                faults.append(f"{name}:{number}: limits are named max_... and min_...: {constant}")
            elif name.endswith((".h", ".cpp")) and CAMEL_CASE.fullmatch(constant):
                faults.append(f"{name}:{number}: constants are written in lower case: {constant}")
        for constant in SCREAMING_LIMIT.findall(line):
            faults.append(f"{name}:{number}: limits are named MAX_... and MIN_...: {constant}")
    return faults


def listed_references() -> list[str]:
    table = (ROOT / REFERENCES).read_text()
    return re.findall(r"^\| (\w+) \|", table, re.M)[1:]


#: Lines of a source file, and whether one of the rules finds a fault there.
SAMPLES = [
    ("/// Of a step, until it is known where it crossed one.", True),
    ("/// Fraction of the step at which it crossed a cut locus.", False),
    ("// The first is short. By those that are left.", True),
    ("// Of several candidates, the nearest is tried first.", False),
    ("int n = 0;  ///< that of the last state. As before", True),
    ("/// The mollifier (thesis eq. 3.12).", True),
    ("/// The mollifier [Thesis, eq. 3.12].", False),
    ("constexpr int most_rounds = 3;", True),
    ("constexpr std::size_t least_points{4};", True),
    ("constexpr double kTolerance = 1e-9;", True),
    ("constexpr int max_rounds = 3;", False),
    ("const std::size_t most = 3;", False),
]


def check_itself() -> None:
    for line, is_fault in SAMPLES:
        if bool(faults_of_comments(line, "sample.h") + faults_of_constants(line, "sample.h")) != is_fault:
            raise SystemExit(f"check_words.py finds {'nothing' if is_fault else 'a fault'} in: {line}")
    if CITATION.findall("see [Bonet2008, eq. 6.27] and [text](page.md), [deBoor1978]") != ["Bonet2008", "deBoor1978"]:
        raise SystemExit("check_words.py does not find citations")


def main() -> int:
    check_itself()
    faults = []
    cited: dict[str, str] = {}
    for name in files(CODE, r"\.(h|cpp|py|ts|mjs)$"):
        if name == "tests/arrows/check_words.py":
            continue
        text = (ROOT / name).read_text(errors="replace")
        faults += faults_of_comments(text, name) + faults_of_constants(text, name)
        for key in CITATION.findall(text):
            cited.setdefault(key, name)
    for name in files(PAGES, r"\.md$"):
        if name != REFERENCES:
            for key in CITATION.findall((ROOT / name).read_text()):
                cited.setdefault(key, name)
    listed = listed_references()
    faults += [f"{where}: [{key}] is not in {REFERENCES}" for key, where in cited.items() if key not in listed]
    faults += [f"{REFERENCES}: nothing cites {key}" for key in listed if key not in cited]
    faults += [f"{REFERENCES}: {key} stands there twice" for key in set(listed) if listed.count(key) > 1]
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
