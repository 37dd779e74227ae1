"""Fixtures of the hostile tests: harness and contract of the API tests, and separate servers."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Callable, Iterator

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

from contract import ROOT, Contract  # noqa: E402
from harness import MODEL_MAKER, SERVER, Api, ServerProcess, servers_of_a_test  # noqa: E402
from shapes import flat_grid  # noqa: E402


def pytest_sessionstart(session: pytest.Session) -> None:
    for program in (SERVER, MODEL_MAKER):
        if not program.exists():
            pytest.exit(f"{program} is missing: build the target {program.name}, or set SUPPLE_BUILD", returncode=3)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    """One server for each file of tests, with the shipped models."""
    folder = tmp_path_factory.mktemp("hostile")
    process = ServerProcess(folder / "data", "--models", str(ROOT / "models")).start()
    yield process
    assert process.running(), f"the server died during the tests:\n{process.log_text()[-4000:]}"
    process.stop()


@pytest.fixture(scope="module")
def contract() -> Contract:
    return Contract()


@pytest.fixture(scope="module")
def api(server: ServerProcess, contract: Contract) -> Api:
    return Api(server, contract)


@pytest.fixture()
def new_server(tmp_path: Path) -> Iterator[Callable[..., ServerProcess]]:
    """Starts servers for a single test."""
    yield from servers_of_a_test(tmp_path)


@pytest.fixture(scope="module")
def grid_mesh(api: Api) -> str:
    """The id of a flat unit square of 8 x 8 cells."""
    return api.upload(*flat_grid(8))
