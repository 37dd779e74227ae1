"""The key of a client: from arguments, files or the environment. No exception or warning ever contains a key."""

from __future__ import annotations

import os
import re
import stat
from pathlib import Path
from typing import Optional, Union

from requests import PreparedRequest

from .checks import warn

FORM = re.compile(r"\w+", re.ASCII)


class KeyReadableByOthers(UserWarning):
    """Other users of the machine may read the file of a key."""


class KeyHeader:
    """Adds the key to each request, and takes precedence over `~/.netrc`."""

    def __init__(self, key: str) -> None:
        self._key = key

    def __call__(self, request: PreparedRequest) -> PreparedRequest:
        request.headers["Authorization"] = f"Bearer {self._key}"
        return request


def find_key(key: Optional[str], key_file: Optional[Union[str, Path]]) -> str:
    """The key: `key` itself, the content of a file, or that of the environment's SUPPLE_KEY or SUPPLE_KEY_FILE. "" if there is
    none.

    Raises `ValueError` for text that is no key, `OSError` for a file that cannot be read.
    """
    if key is None and key_file is None:
        key, key_file = os.environ.get("SUPPLE_KEY") or None, os.environ.get("SUPPLE_KEY_FILE") or None
    where = "the key"
    if key is None:
        if key_file is None:
            return ""
        where = f"the file {key_file}"
        key = _read(Path(key_file))
    if not FORM.fullmatch(key):
        raise ValueError(f"{where} has not the form supple_ID_SECRET")
    return key


def _read(path: Path) -> str:
    if path.stat().st_mode & (stat.S_IRWXG | stat.S_IRWXO):
        warn(f"others may read the key in {path}; chmod 600 changes that", KeyReadableByOthers)
    return path.read_text(encoding="utf-8", errors="replace").strip()
