"""Which source files clang-tidy has found clean before, by the content of everything that it reads.

The entry of a file is an empty one whose name is a hash of the file, of the project's files that it includes, of its options and
the checks, and of the versions of clang-tidy and of the packages that headers come from. They lie in SUPPLE_TIDY_CACHE
(~/.cache/supple-tidy); with SUPPLE_TIDY_CACHE=off nothing is looked up or kept.
"""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Dict, List, Optional, Sequence, Tuple

sys.path.insert(0, str(Path(__file__).resolve().parent / "changes"))

from includes import Includes  # noqa: E402

KEPT_SECONDS = 60 * 24 * 3600
"""An entry that nobody asks for is removed after this time."""


def output_of(*command: str) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def versions() -> str:
    """Of clang-tidy and of each package of headers and of the compiler."""
    packages = output_of("dpkg-query", "-W", "-f", "${Package} ${Version}\n")
    return output_of("clang-tidy", "--version") + "".join(
        line + "\n" for line in sorted(packages.splitlines()) if "-dev " in line or line.startswith(("clang", "libclang", "llvm", "libllvm")))


class TidyCache:
    def __init__(self, root: Path, folder: Optional[Path], about: str) -> None:
        """`about` is everything besides files and their options on which a finding depends. Without a folder nothing is found or kept."""
        self.root, self.folder, self.about = root, folder, about
        self.includes = Includes(root)
        self.hashes: Dict[str, str] = {}
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            self.remove_old(folder)

    @staticmethod
    def remove_old(folder: Path) -> None:
        oldest = time.time() - KEPT_SECONDS
        for entry in folder.iterdir():
            try:
                if entry.stat().st_mtime < oldest:
                    entry.unlink()
            except FileNotFoundError:  # another run has removed it
                pass

    def hash_of(self, file: str) -> str:
        if file not in self.hashes:
            self.hashes[file] = hashlib.sha256((self.root / file).read_bytes()).hexdigest()
        return self.hashes[file]

    def key(self, file: Path, options: Sequence[str]) -> str:
        folders: List[str] = []
        for option in options:
            path = option[8:] if option.startswith("-isystem") else option[2:] if option.startswith("-I") else ""
            if path.startswith(f"{self.root}/"):
                folders.append(os.path.relpath(path, self.root))
        read = self.includes.closure(os.path.relpath(file, self.root), tuple(folders))
        told = hashlib.sha256(self.about.encode())
        for option in options:
            told.update(f"\n{option.replace(str(self.root), '.')}".encode())
        for name in sorted(read):
            told.update(f"\n{name} {self.hash_of(name)}".encode())
        return told.hexdigest()

    def is_clean(self, key: str) -> bool:
        if self.folder is None:
            return False
        try:
            os.utime(self.folder / key)
        except FileNotFoundError:
            return False
        return True

    def keep(self, keys: Sequence[str]) -> None:
        if self.folder is not None:
            for key in keys:
                (self.folder / key).touch()


def cache_of(root: Path, options: Sequence[str]) -> Tuple[TidyCache, str]:
    """The cache that the environment asks for, and where it is, in words."""
    asked = os.environ.get("SUPPLE_TIDY_CACHE", "")
    if asked == "off":
        return TidyCache(root, None, ""), "without a cache"
    folder = Path(asked) if asked else Path.home() / ".cache" / "supple-tidy"
    about = "\n".join([(root / ".clang-tidy").read_text(), *options, versions()])
    return TidyCache(root, folder, about), f"cache {folder}"
