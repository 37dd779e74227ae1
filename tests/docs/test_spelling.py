"""The words of the pages are English (hunspell, en_GB) or terms of the field (terms.txt)."""

from __future__ import annotations

import re
import subprocess
from functools import lru_cache
from pathlib import Path
from typing import Dict, FrozenSet, Iterable, List, Set

import pytest

from pages import WRITTEN, text_of, without_code

TERMS = Path(__file__).with_name("terms.txt")


def words_of(text: str) -> Dict[str, int]:
    """Each word of a page's prose with the line of its first occurrence. Acronyms, names with digits or underscores, formulas and
    names of files do not count as words."""
    found: Dict[str, int] = {}
    for number, line in enumerate(without_code(text).split("\n"), 1):
        if line.startswith("    ") and not re.match(r" *([-*]|\d+\.|\|) ", line) and not re.search(r"[a-z]{3,} [a-z]{2,} [a-z]{2,}", line):
            continue  # an indented formula
        line = re.sub(r"\]\([^)]*\)", "] ", line)
        line = re.sub(r"https?:\S+|&\w+;|\S*[_/\\=^|~<>]\S*|\S+\.(?:md|csv|h|cpp|py|h5|txt|svg|yaml)\b", " ", line)
        for word in re.findall(r"[^\W\d_]+(?:['’][^\W\d_]+)*\d*", line):
            if not word.isupper() and not word[-1].isdigit() and len(word) > 2:
                found.setdefault(word.replace("’", "'"), number)
    return found


def terms() -> List[str]:
    return [line for line in TERMS.read_text(encoding="utf-8").split("\n") if line and not line.startswith("#")]


def stem(word: str) -> str:
    return word.removesuffix("'s")


def misspelt(words: Iterable[str]) -> Set[str]:
    """The words that hunspell does not know."""
    done = subprocess.run(["hunspell", "-i", "UTF-8", "-d", "en_GB", "-l"], input="\n".join(sorted(set(words))) + "\n",
                          capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split("\n")) - {""}


def unknown(words: Iterable[str]) -> Set[str]:
    """The words that neither the dictionary nor the list of terms contains. A term in lower case may begin a sentence, and each word may
    have a genitive."""
    known = set(terms())
    asked = {word for word in words if known.isdisjoint({stem(word), stem(word).lower()})}
    wrong = misspelt(map(stem, asked))
    return {word for word in asked if stem(word) in wrong}


@lru_cache(maxsize=None)
def unknown_on_pages() -> FrozenSet[str]:
    """The unknown words of all pages, for which hunspell starts only once."""
    return frozenset(unknown(word for page in WRITTEN for word in words_of(text_of(page))))


@pytest.mark.parametrize("page", WRITTEN)
def test_words_are_english_or_terms_of_the_field(page: str) -> None:
    words = words_of(text_of(page))
    strange = sorted(unknown_on_pages() & words.keys(), key=str.lower)
    assert not strange, "\n".join(f"{page}:{words[word]}: {word}" for word in strange)


def test_a_misspelt_word_is_found() -> None:
    words = words_of("The strian of a structure is *recieved*.\n\n`cmake_minimum_requierd`\n")
    assert unknown(words) == {"recieved", "strian"}


def test_the_list_has_each_term_once_and_none_that_the_dictionary_has() -> None:
    listed = terms()
    assert listed == sorted(set(listed), key=lambda term: (term.lower(), term))
    assert sorted(set(listed) - misspelt(listed)) == []
