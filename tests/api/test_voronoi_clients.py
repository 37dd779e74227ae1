"""Voronoi diagrams from the command line and from Python, with a real server."""

from __future__ import annotations

import csv
import io
import json
import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import supple
from cli_program import Program, number_after
from harness import CLI, Api
from shapes import bumpy_sphere, flat_grid, sphere


@pytest.fixture
def cli(api: Api, tmp_path: Path) -> Program:
    return Program(api.server.url, tmp_path)


def spread(text: str, name: str) -> Any:
    """Mean, least value, greatest value and standard deviation in a line of the printed statistics."""
    (line,) = [line for line in text.splitlines() if line.startswith(name + "  ")]
    return [float(value) for value in line[len(name):].split()]


def test_a_diagram_is_printed_and_written_in_four_forms(cli: Program) -> None:
    file = cli.file("sphere.obj", sphere(3))
    command = ("voronoi", file, "--random", "12", "--seed", "3")
    text = cli.ok(*command, "--obj", "cells.obj", "--vtu", "cells.vtu", "--svg", "panels.svg", "--csv", "panels.csv",
                  "--panel-scale", "50")
    assert "diagram     12 cells, 30 edges, 20 vertices" in text
    answer = json.loads(cli.ok("--json", *command))
    areas = [cell["area"] for cell in answer["cells"]]
    np.testing.assert_allclose(spread(text, "cell area")[:3], [np.mean(areas), min(areas), max(areas)], rtol=1e-5)
    read = {name: (cli.folder / name).read_text() for name in ("cells.obj", "cells.vtu", "panels.svg", "panels.csv")}
    assert sum(line.startswith("l ") for line in read["cells.obj"].splitlines()) == 30
    assert "UnstructuredGrid" in read["cells.vtu"] and "<svg" in read["panels.svg"]
    assert len(list(csv.DictReader(io.StringIO(read["panels.csv"])))) == 60
    assert cli.ok(*command, "--csv", "-") == read["panels.csv"]


def test_sites_come_from_the_command_line_or_from_an_earlier_answer(cli: Program) -> None:
    file = cli.file("sphere.obj", sphere(3))
    given = json.loads(cli.ok("--json", "voronoi", file, "v3", "v40", "12:0.2,0.3,0.5", "--relative-error", "0.1"))
    assert len(given["cells"]) == 3 and given["accuracy"]["relative_error_bound"] == 0.1
    (cli.folder / "answer.json").write_text(json.dumps(given))
    again = json.loads(cli.ok("--json", "voronoi", file, "--sites", "answer.json", "--method", "edges"))
    assert again["sites"] == given["sites"] and again["accuracy"]["method"] == "edges"


def test_curved_borders_are_drawn_as_finely_as_the_command_line_says(cli: Program) -> None:
    file = cli.file("bumpy.obj", bumpy_sphere(2))
    command = ("voronoi", file, "--random", "5", "--seed", "2", "--border-deviation")
    counts = []
    for deviation in ("1", "1e-6"):
        answer = json.loads(cli.ok("--json", *command, deviation, "--obj", "cells.obj"))
        counts.append(len(answer["positions"]))
        lines = (cli.folder / "cells.obj").read_text().split("o cells")[0].splitlines()
        assert sum(line.startswith("v ") for line in lines) == counts[-1], "the file has the answer's points"
    assert counts[0] < counts[1]
    optimized = json.loads(cli.ok("--json", *command, "1e-6", "--optimize", "centroidal", "--max-iterations", "1"))
    assert optimized["accuracy"]["border_deviation"] == 1e-6
    refused = cli.run(*command, "2")
    assert refused.returncode == 2 and "--border-deviation: must be at least 1e-07 and at most 1" in refused.stderr


def test_an_optimization_is_printed_with_its_history_and_both_statistics(cli: Program) -> None:
    file = cli.file("sphere.obj", sphere(3))
    text = cli.ok("voronoi", file, "--random", "20", "--optimize", "centroidal,equal_area=0.5", "--tolerance", "1e-3",
                  "--max-iterations", "20", "--fixed", "0,4", "--history", "--obj", "cells.obj")
    assert "stopped" in text and "  centroidal" in text and "  equal_area" in text
    history = [line.split() for line in text.splitlines() if line.strip() and line.split()[0].isdigit()]
    energies = [float(row[1]) for row in history]
    assert energies == sorted(energies, reverse=True) and energies[-1] < energies[0]
    assert energies[-1] == pytest.approx(number_after("energy", text), rel=1e-8)
    assert spread(text, "cell area, after")[3] < spread(text, "cell area, before")[3]
    assert sum(line.startswith("l ") for line in (cli.folder / "cells.obj").read_text().splitlines()) == 54


@pytest.mark.parametrize("arguments, words", [
    ((), "give sites"), (("v0", "--random", "3"), "give sites"), (("--random", "3", "--optimize", "=1"), "names no objectives"),
    (("--random", "3", "--optimize", "centroidal=x"), "weight of an objective"),
    (("--random", "3", "--optimize", "centroidal", "--method", "edges"), "exact distances"),
    (("--random", "3", "--optimize", "centroidal", "--fixed", "1.5"), "names no site"),
])
def test_what_makes_no_diagram_is_said(cli: Program, arguments: Any, words: str) -> None:
    refused = cli.run("voronoi", cli.file("grid.obj", flat_grid(2)), *arguments)
    assert refused.returncode == 1 and words in refused.stderr


def test_an_unknown_objective_is_the_servers_refusal(cli: Program) -> None:
    refused = cli.run("voronoi", cli.file("grid.obj", flat_grid(2)), "--random", "3", "--optimize", "beauty")
    assert refused.returncode == 2 and "--optimize 'beauty'" in refused.stderr


def test_python_has_diagrams_with_borders_pieces_and_files(client: supple.Client) -> None:
    mesh = client.upload_arrays(*sphere(3))
    found = mesh.voronoi(supple.RandomSites(12, seed=3), points=True, pieces=True)
    assert len(found.cells) == 12 and len(found.vertices) == 20 and found.dual.shape == (20, 3)
    assert found.points is not None and len(found.points) == len(found.positions)
    assert found.pieces is not None and set(found.pieces.vertex_sites.tolist()) == set(range(12))
    for cell in found.cells:
        for border in found.borders(cell.site):
            assert border.shape[1] == 3 and (border[0] == border[-1]).all() and len(border) > 10
    assert found.statistics is not None and found.relative_error_bound == 0
    fine = mesh.voronoi(found.sites, pieces=True, border_deviation=1e-6)
    assert fine.border_deviation == 1e-6 and found.border_deviation == 1e-5 and fine.pieces is not None
    for cell in fine.cells:
        whole = sum(piece.area for piece in fine.pieces.cut_faces if piece.site == cell.site)
        assert 0 < whole < cell.area
    assert mesh.voronoi([0, 5], relative_error=0.2, statistics=False).relative_error_bound == 0.2
    assert b"\no cells\n" in mesh.voronoi_file(found.sites, kind="obj")
    assert b"<svg" in mesh.voronoi_file([0, 40, 90, 200], kind="svg", panel_scale=250)
    assert mesh.start_voronoi(found.sites, statistics=False).result().statistics is None
    with pytest.raises(supple.InvalidRequest, match="--max-points"):
        mesh.voronoi(supple.RandomSites(10_000_000))
    with pytest.raises(supple.InvalidPoint):
        mesh.voronoi([10_000])


def test_python_optimizes_diagrams_and_sees_them_on_their_way(client: supple.Client) -> None:
    mesh = client.upload_arrays(*sphere(3))
    options = supple.VoronoiOptions(tolerance=1e-3, max_iterations=20)
    found = mesh.optimize_voronoi(supple.RandomSites(20), {"centroidal": 1}, [0], options=options)
    assert found.history[-1].energy < found.history[0].energy and found.terms == {"centroidal": pytest.approx(found.energy)}
    assert found.diagram.statistics is not None
    assert found.diagram.statistics.area.deviation < found.before.area.deviation
    job = mesh.start_optimize_voronoi(supple.RandomSites(20), {"planarity": 1}, options=options)
    assert job.result().iterations <= 20
    with pytest.raises(supple.InvalidVoronoi) as refusal:
        mesh.optimize_voronoi([0, 1], {"centroidal": 0})
    assert refusal.value.code == "voronoi.no_objective"


def test_an_optimization_that_was_interrupted_goes_on_from_its_file(cli: Program) -> None:
    file = cli.file("bumpy.obj", bumpy_sphere(5))
    command = ["voronoi", file, "--random", "300", "--optimize", "centroidal,regularity", "--tolerance", "1e-12",
               "--continue", "way.json"]
    way = cli.folder / "way.json"
    process = subprocess.Popen([str(CLI), *command, "--max-iterations", "1000"], cwd=cli.folder, stderr=subprocess.PIPE,
                               env={**os.environ, "SUPPLE_SERVER": cli.url}, text=True)
    end = time.monotonic() + 60
    while not way.exists() or json.loads(way.read_text())["iteration"] < 3:
        assert process.poll() is None and time.monotonic() < end
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    kept = json.loads(way.read_text())
    assert len(kept["sites"]) == 300 and not (cli.folder / "way.json.part").exists()
    first = json.loads(cli.ok("--json", *command[:-2], "--max-iterations", "1"))
    rest = json.loads(cli.ok("--json", *command, "--max-iterations", "1"))
    # It starts with less energy than the end of the interrupted iteration from the random sites, and decreases the energy further.
    assert rest["history"][0]["energy"] < first["energy"] and rest["energy"] < rest["history"][0]["energy"]
    assert json.loads(way.read_text())["sites"] == rest["sites"]


def test_a_file_to_continue_from_must_suit_the_command(cli: Program) -> None:
    file = cli.file("sphere.obj", sphere(2))
    alone = cli.run("voronoi", file, "--random", "5", "--continue", "way.json")
    assert alone.returncode == 1 and "--optimize" in alone.stderr
    edges = cli.run("voronoi", file, "--random", "5", "--optimize", "edge_length", "--continue", "way.json")
    assert edges.returncode == 1 and "--target-length" in edges.stderr
    (cli.folder / "way.json").write_text("{}")
    empty = cli.run("voronoi", file, "--random", "5", "--optimize", "centroidal", "--continue", "way.json")
    assert empty.returncode != 0 and "no field sites" in empty.stderr


def test_an_optimization_goes_on_from_what_a_job_has_found(client: supple.Client) -> None:
    mesh = client.upload_arrays(*bumpy_sphere(4))
    options = supple.VoronoiOptions(max_iterations=500, tolerance=1e-12)
    job = mesh.start_optimize_voronoi(supple.RandomSites(80, seed=4), {"centroidal": 1}, options=options)
    partial = None
    end = time.monotonic() + 60
    while not isinstance(partial, supple.PartialOptimization) or partial.iteration < 2:
        assert time.monotonic() < end
        time.sleep(0.02)
        partial = job.status().partial
    job.cancel()
    assert partial.sites is not None
    rest = mesh.optimize_voronoi(partial.sites, {"centroidal": 1}, options=supple.VoronoiOptions(max_iterations=1))
    assert rest.history[0].energy == pytest.approx(partial.energy, rel=1e-12)
