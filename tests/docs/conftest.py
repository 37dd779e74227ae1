"""Fixtures of the tests of pages. The server and the CLI are those of SUPPLE_BUILD (build/release), as in the API tests."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, Iterator

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

from harness import BUILD, CLI, ROOT, SERVER, ServerProcess  # noqa: E402
from pages import RUN, blocks_of  # noqa: E402


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    """A server with the shipped models."""
    examples = [BUILD / "engine" / "examples" / path.stem for path in (ROOT / "engine" / "examples").glob("*.cpp")]
    for program in (SERVER, CLI, *examples):
        if not program.exists():
            pytest.fail(f"{program} is missing: build it, or set SUPPLE_BUILD")
    process = ServerProcess(tmp_path_factory.mktemp("docs") / "data", "--models", str(ROOT / "models")).start()
    yield process
    assert process.running(), f"the server died during the tests:\n{process.log_text()[-4000:]}"
    assert process.terminate() == 0


def pytest_terminal_summary(terminalreporter: Any) -> None:
    blocks = [block for page in RUN for block in blocks_of(page)]
    left_out = [block for block in blocks if block.not_run]
    terminalreporter.write_line(f"{len(blocks)} blocks of code on {len(RUN)} pages, {len(left_out)} of them are not run:")
    for block in left_out:
        terminalreporter.write_line(f"  {block.place}: {block.not_run}")
