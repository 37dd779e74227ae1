"""The command line client as the tests run it."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path
from typing import Any

from harness import CLI
from shapes import obj_text


class Program:
    """Runs `supple` with a server and a separate folder."""

    def __init__(self, url: str, folder: Path) -> None:
        self.url = url
        self.folder = folder

    def run(self, *arguments: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([str(CLI), *arguments], cwd=self.folder, env={**os.environ, "SUPPLE_SERVER": self.url},
                              capture_output=True, text=True, timeout=60, check=False)

    def ok(self, *arguments: str) -> str:
        finished = self.run(*arguments)
        assert finished.returncode == 0, finished.stderr
        return finished.stdout

    def file(self, name: str, mesh: Any) -> str:
        (self.folder / name).write_text(obj_text(mesh))
        return name


def number_after(name: str, text: str) -> float:
    found = re.search(rf"{re.escape(name)}\s+([-+0-9.e]+)", text)
    assert found, text
    return float(found.group(1))
