"""The quick start and then the tests of a checkout, as on a new user's machine, can use the same build folder."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import Dict

import pytest

ROOT = Path(__file__).resolve().parents[2]


def options_of(build: Path) -> Dict[str, str]:
    return dict(re.findall(r"^(\w+):\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.MULTILINE))


def configure(*arguments: str) -> None:
    done = subprocess.run(["cmake", *arguments], cwd=ROOT, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr


@pytest.fixture()
def first_build(tmp_path: Path) -> Path:
    """A build folder that the quick start configures if there is none."""
    script = (ROOT / "deploy" / "quickstart.sh").read_text()
    first = re.search(r"first=\((.*?)\)", script[script.index("CMakeCache.txt"):], re.DOTALL)
    assert first
    configure("-S", ".", "-B", str(tmp_path / "build"), *first[1].split())
    return tmp_path / "build"


def test_the_tests_are_built_where_the_quick_start_has_built_without_them(first_build: Path) -> None:
    assert options_of(first_build)["SUPPLE_BUILD_TESTS"] == "OFF"
    configure("--preset", "release", "-B", str(first_build))
    options = options_of(first_build)
    assert (options["SUPPLE_BUILD_TESTS"], options["SUPPLE_TRAINING"]) == ("ON", "ON")
    assert options["SUPPLE_GROUPED"] == "ON", "what the quick start has compiled is of use to the tests"

