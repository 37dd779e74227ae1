"""A file counts as clean as long as nothing that clang-tidy reads for it has changed."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from tidy_cache import KEPT_SECONDS, TidyCache, cache_of, versions  # noqa: E402

OPTIONS = ["-O1", "-DNAME=1"]


@pytest.fixture
def root(tmp_path: Path) -> Path:
    for name, text in {"a.cpp": '#include "a.h"\n', "include/a.h": '#include <b.h>\n', "include/b.h": "#pragma once\n", "include/c.h": "\n"}.items():
        (tmp_path / "project" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "project" / name).write_text(text)
    return tmp_path / "project"


def key(root: Path, folder: Path, about: str = "checks", options: "list[str] | None" = None) -> str:
    return TidyCache(root, folder, about).key(root / "a.cpp", [*(options or OPTIONS), f"-I{root}/include"])


def test_a_file_is_clean_until_what_it_reads_its_options_or_the_checks_change(root: Path, tmp_path: Path) -> None:
    folder = tmp_path / "cache"
    first = key(root, folder)
    cache = TidyCache(root, folder, "checks")
    assert not cache.is_clean(first)
    cache.keep([first])
    assert cache.is_clean(key(root, folder))
    (root / "include/c.h").write_text("// nobody reads this\n")
    assert key(root, folder) == first
    for changed in (key(root, folder, about="other checks"), key(root, folder, options=["-O1", "-DNAME=2"])):
        assert changed != first and not cache.is_clean(changed)
    for name in ("a.cpp", "include/a.h", "include/b.h"):
        before = (root / name).read_text()
        (root / name).write_text(before + "// NOLINT\n")
        assert not cache.is_clean(key(root, folder)), name
        (root / name).write_text(before)
    assert cache.is_clean(key(root, folder))


def test_another_checkout_with_the_same_content_has_the_same_entries(root: Path, tmp_path: Path) -> None:
    first = key(root, tmp_path / "cache")
    assert key(root.rename(tmp_path / "moved"), tmp_path / "cache") == first


def test_an_entry_that_nobody_asks_for_is_removed(root: Path, tmp_path: Path) -> None:
    folder = tmp_path / "cache"
    TidyCache(root, folder, "checks").keep(["old", "asked"])
    for name in ("old", "asked"):
        os.utime(folder / name, (time.time() - KEPT_SECONDS - 60,) * 2)
    cache = TidyCache.__new__(TidyCache)
    cache.folder = folder
    assert cache.is_clean("asked")
    TidyCache(root, folder, "checks")
    assert sorted(entry.name for entry in folder.iterdir()) == ["asked"]


def test_the_cache_can_be_switched_off(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (root / ".clang-tidy").write_text("Checks: '*'\n")
    monkeypatch.setenv("SUPPLE_TIDY_CACHE", "off")
    cache, where = cache_of(root, [])
    cache.keep(["any"])
    assert not cache.is_clean("any") and where == "without a cache"
    monkeypatch.setenv("SUPPLE_TIDY_CACHE", str(tmp_path / "cache"))
    cache, where = cache_of(root, [])
    cache.keep(["any"])
    assert cache.is_clean("any") and str(tmp_path) in where


def test_the_versions_tell_clang_and_the_packages_of_headers() -> None:
    told = versions()
    assert "LLVM version" in told and "libeigen3-dev 3" in told
