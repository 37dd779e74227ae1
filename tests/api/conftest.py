"""Fixtures of the API tests. The server and the CLI are those of SUPPLE_BUILD (build/release); SUPPLE_TEST_SERVER names another server."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path
from typing import Callable, Iterator

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "clients" / "python"))

import supple  # noqa: E402
from cli_program import Program  # noqa: E402
from contract import Contract, ROOT  # noqa: E402
from harness import Api, MODEL_MAKER, SERVER, ServerProcess, make_model, servers_of_a_test  # noqa: E402
from shapes import flat_grid, sphere  # noqa: E402


def pytest_sessionstart(session: pytest.Session) -> None:
    for program in (SERVER, MODEL_MAKER):
        if not program.exists():
            pytest.exit(f"{program} is missing: build the target {program.name}, or set SUPPLE_BUILD", returncode=3)


@pytest.fixture(scope="session")
def contract() -> Contract:
    return Contract()


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    """One server, with the model ih21, for all tests that do not change its state lastingly."""
    folder = tmp_path_factory.mktemp("shared")
    make_model(folder / "models" / "ih21.h5")
    process = ServerProcess(folder / "data", "--models", str(folder / "models")).start()
    yield process
    assert process.running(), f"the server died during the tests:\n{process.log_text()[-4000:]}"
    assert process.terminate() == 0


@pytest.fixture(scope="session")
def design_server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServerProcess]:
    """One server with two of the shipped models, ih29 and ih67, since designs need trained models."""
    folder = tmp_path_factory.mktemp("designs")
    (folder / "models").mkdir()
    for name in ("ih29.h5", "ih67.h5"):
        shutil.copy(ROOT / "models" / name, folder / "models")
    process = ServerProcess(folder / "data", "--models", str(folder / "models")).start()
    yield process
    assert process.running(), f"the server died during the tests:\n{process.log_text()[-4000:]}"
    assert process.terminate() == 0


@pytest.fixture
def designs(design_server: ServerProcess, contract: Contract) -> Api:
    return Api(design_server, contract)


@pytest.fixture
def api(server: ServerProcess, contract: Contract) -> Api:
    return Api(server, contract)


@pytest.fixture
def program(api: Api, tmp_path: Path) -> Program:
    return Program(api.server.url, tmp_path)


@pytest.fixture
def client(api: Api) -> Iterator[supple.Client]:
    with supple.Client(api.server.url) as opened:
        yield opened


@pytest.fixture
def new_server(tmp_path: Path) -> Iterator[Callable[..., ServerProcess]]:
    """Starts servers for a single test, which may kill and restart them."""
    yield from servers_of_a_test(tmp_path)


@pytest.fixture(scope="session")
def grid_mesh(server: ServerProcess, contract: Contract) -> str:
    """The id of a flat unit square of 8 x 8 cells."""
    return Api(server, contract).upload(*flat_grid(8))


@pytest.fixture(scope="session")
def sphere_mesh(server: ServerProcess, contract: Contract) -> str:
    """The id of a unit sphere of 1280 faces."""
    return Api(server, contract).upload(*sphere(3))
