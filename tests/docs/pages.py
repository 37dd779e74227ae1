"""The project's pages, and what of them can be checked: links, anchors, words, and blocks of code."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Iterator, List, Optional, Set
from urllib.parse import unquote

ROOT = Path(__file__).resolve().parents[2]

#: Pages whose links are followed: all that the project has.
LINKED = sorted(path.relative_to(ROOT).as_posix() for folder in ("", "docs", "docs/notes", "docs/walkthroughs", "docs/bench", "deploy",
                                                                "deploy/kubernetes", "server", "models", "models/datasets", "clients/cli", "clients/python", "clients/web", "api/examples",
                                                                "api/examples/meshes", "api/examples/networks")
                for path in (ROOT / folder).glob("*.md"))
#: Pages that people write, whose words are spelt. Pages under docs/bench are written by programs, and so are models' cards.
WRITTEN = [page for page in LINKED if not page.startswith(("docs/bench/", "models/ih")) and page not in ("CHANGELOG.md", "docs/references.md")]
#: Pages whose blocks of code are run. The clients' own pages have tests beside the clients.
RUN = [page for page in WRITTEN if (page.startswith("docs/") or "/" not in page or page == "deploy/README.md")]


@dataclass
class Block:
    """A fenced block of code."""

    page: str
    line: int  #: of its first line of code, counted from 1
    language: str  #: empty where the fence names none
    code: str
    not_run: Optional[str] = None  #: the reason in a comment `<!-- not run: REASON -->` before it
    schema: Optional[str] = None  #: of `<!-- schema: NAME -->`: what a JSON block has to be
    file: Optional[str] = None  #: of `<!-- file: PATH -->`: the file that the block shows

    @property
    def place(self) -> str:
        return f"{self.page}:{self.line}"


MARK = re.compile(r"<!-- (not run|schema|file): (.*?) *-->")
FENCE = re.compile(r"^( *)```([\w+-]*) *$")


def text_of(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


def blocks_of(page: str, text: Optional[str] = None) -> List[Block]:
    """The page's fenced blocks in their order. A mark belongs to the block that begins on the next line."""
    blocks: List[Block] = []
    lines = (text_of(page) if text is None else text).split("\n")
    number = 0
    while number < len(lines):
        opened = FENCE.match(lines[number])
        if not opened:
            number += 1
            continue
        block = Block(page, number + 2, opened[2], "")
        before = number - 1
        while before >= 0 and (mark := MARK.fullmatch(lines[before].strip())):
            setattr(block, mark[1].replace(" ", "_"), mark[2])
            before -= 1
        code: List[str] = []
        number += 1
        while number < len(lines) and lines[number].strip() != "```":
            code.append(lines[number].removeprefix(opened[1]))
            number += 1
        assert number < len(lines), f"{block.place}: the block has no end"
        block.code = "\n".join(code) + "\n"
        blocks.append(block)
        number += 1
    return blocks


def without_code(text: str) -> str:
    """The page without fenced blocks, comments and code within lines; lines keep their numbers."""
    def blank(found: "re.Match[str]") -> str:
        return "\n" * found[0].count("\n")

    text = re.sub(r"^( *)```.*?^ *```[^\n]*$", blank, text, flags=re.S | re.M)
    text = re.sub(r"<!--.*?-->", blank, text, flags=re.S)
    return re.sub(r"`[^`\n]+`", " ", text)


def slug(heading: str) -> str:
    """The anchor that GitHub gives a heading."""
    heading = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    heading = re.sub(r"[^\w\- ]", "", heading.strip().lower())
    return heading.replace(" ", "-")


def anchors_of(page: str) -> Set[str]:
    anchors: Set[str] = set()
    fenced = re.sub(r"^( *)```.*?^ *```[^\n]*$", "", text_of(page), flags=re.S | re.M)
    for heading in re.findall(r"^#{1,6} +(.*?) *#*$", fenced, flags=re.M):
        anchor, again = slug(heading), 0
        while (anchor if not again else f"{anchor}-{again}") in anchors:
            again += 1
        anchors.add(anchor if not again else f"{anchor}-{again}")
    return anchors


@dataclass
class Link:
    line: int
    target: str


def links_of(text: str) -> Iterator[Link]:
    for number, line in enumerate(without_code(text).split("\n"), 1):
        for target in re.findall(r"\]\(([^()\s]*(?:\([^()\s]*\)[^()\s]*)*)\)", line):
            yield Link(number, target)


def fault_of(page: str, link: Link) -> Optional[str]:
    """What is wrong with a link, or None. Addresses of other sites are not asked."""
    if re.match(r"[a-z]+:", link.target):
        return None
    path, _, anchor = link.target.partition("#")
    target = (ROOT / page).parent / unquote(path) if path else ROOT / page
    if not target.exists():
        return f"{page}:{link.line}: there is no file {link.target}"
    if anchor:
        if target.suffix != ".md":
            return f"{page}:{link.line}: {link.target} names a place in a file that is no page"
        name = target.resolve().relative_to(ROOT).as_posix()
        if anchor not in anchors_of(name):
            return f"{page}:{link.line}: {name} has no heading #{anchor}"
    return None
