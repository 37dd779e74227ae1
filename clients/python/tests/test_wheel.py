"""The installed package: a wheel is built and installed without network access."""

from __future__ import annotations

import email
import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import supple

PACKAGE = Path(__file__).resolve().parents[1]


def command(*arguments: str, folder: Path, **environment: str) -> str:
    """Runs Python in a folder outside of the package's sources, and returns its output."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "PIP_"))}
    # Nothing listens at this address, so that any network access fails.
    offline = {"http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9", "PIP_CONFIG_FILE": os.devnull}
    done = subprocess.run([sys.executable, *arguments], cwd=folder, env={**kept, **offline, **environment},
                          capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    shutil.copytree(PACKAGE, source, ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__", ".mypy_cache"))
    command("-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder / "out"), str(source), folder=folder)
    (built,) = (folder / "out").iterdir()
    return built


def test_the_wheel_holds_every_module_and_the_mark_of_types(wheel: Path) -> None:
    assert wheel.name == f"supple-{supple.__version__}-py3-none-any.whl"
    with zipfile.ZipFile(wheel) as archive:
        held = {name for name in archive.namelist() if name.startswith("supple/")}
    sources = {f"supple/{path.name}" for path in (PACKAGE / "supple").iterdir() if path.is_file()}
    assert held == sources and "supple/py.typed" in held


def test_its_metadata_is_complete(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [entry for entry in archive.namelist() if entry.endswith(".dist-info/METADATA")]
        metadata = email.message_from_bytes(archive.read(name))
    for field in ("Name", "Version", "Summary", "Author", "License", "Keywords", "Requires-Python", "Description-Content-Type"):
        assert metadata[field], field
    assert metadata["Version"] == supple.__version__ and metadata["Requires-Python"] == ">=3.9"
    needed = [entry for entry in metadata.get_all("Requires-Dist", []) if "extra ==" not in entry]
    assert sorted(entry.split()[0].split(">")[0] for entry in needed) == ["numpy", "requests"]
    assert set(metadata.get_all("Provides-Extra", [])) == {"plot", "progress", "meshes"}
    assert "Typing :: Typed" in metadata.get_all("Classifier", [])
    assert "# supple, the Python package" in str(metadata.get_payload())


def test_the_wheel_is_installed_without_a_network_and_imported(wheel: Path, tmp_path: Path) -> None:
    command("-m", "pip", "install", "--no-index", "--no-deps", "--target", str(tmp_path / "site"), str(wheel), folder=tmp_path)
    program = "import supple; print(supple.__version__, supple.__file__); print(supple.Client('http://127.0.0.1:9', timeout=1).ready())"
    version, answer = command("-c", program, folder=tmp_path, PYTHONPATH=str(tmp_path / "site")).splitlines()
    assert version == f"{supple.__version__} {tmp_path / 'site' / 'supple' / '__init__.py'}" and answer == "False"
