"""Sections of the pages of measurements under docs/bench. Each program writes its own section between two comments of the page."""

from __future__ import annotations

from pathlib import Path


def write_section(folder: Path, page: str, name: str, text: str) -> None:
    """Puts the text in the place of the section that the page has, or at the page's end; Report::write in report.cpp does the same."""
    begin, end = f"<!-- section: {name} -->\n", f"<!-- /section: {name} -->\n"
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / f"{page}.md"
    old = file.read_text(encoding="utf-8") if file.exists() else f"# Measurements: {page}\n"
    section = begin + text.strip() + "\n" + end
    if begin in old:
        before, rest = old.split(begin, 1)
        new = before + section + rest.split(end, 1)[1]
    else:
        new = old + "\n" + section
    file.write_text(new, encoding="utf-8")
