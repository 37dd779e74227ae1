"""The notebooks of the Python package, with a real server and shipped models."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Set

import nbformat
import pytest
from nbclient import NotebookClient

from contract import ROOT
from harness import ServerProcess

NOTEBOOKS = sorted((ROOT / "clients" / "python" / "notebooks").glob("*.ipynb"))
CELL_SECONDS = 120


def shown_kinds(notebook: Any) -> Set[str]:
    """The media types of all outputs of the notebook."""
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    return {kind for output in outputs if output.output_type in ("execute_result", "display_data") for kind in output.data}


def test_there_are_notebooks_of_every_kind() -> None:
    assert [path.stem for path in NOTEBOOKS] == ["design", "geodesics", "networks", "voronoi", "weaves"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_notebook_is_kept_without_results_and_runs(
        design_server: ServerProcess, monkeypatch: pytest.MonkeyPatch, path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(not cell.outputs and cell.execution_count is None for cell in code)
    monkeypatch.setenv("SUPPLE_SERVER", design_server.url)
    monkeypatch.setenv("PYTHONPATH", str(ROOT / "clients" / "python"))
    # A cell that fails raises an exception with its traceback.
    NotebookClient(notebook, timeout=CELL_SECONDS, kernel_name="python3").execute()
    assert all(cell.execution_count for cell in code)
    assert {"text/html", "image/png"} <= shown_kinds(notebook)
    warned = [output.text for cell in code for output in cell.outputs if output.output_type == "stream" and output.name == "stderr"]
    assert not [text for text in warned if "Warning" in text]
