"""Neural models with the command line client and with the Python package."""

from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
from typing import List

import numpy as np
import pytest

import supple
from cli_program import Program, number_after
from contract import ROOT
from harness import Api

DESIGN = ["--parameters", "0.15,0.65"]


def test_the_models_are_listed_and_described(program: Program, api: Api) -> None:
    assert "ih21" in program.ok("models") and "1 %" in program.ok("models")
    described = program.ok("model", "ih21")
    assert "IH21" in described and api.get("/v1/models/ih21").json()["sha256"] in described
    assert "new designs" in described and "new states" not in described, "errors that are not known are not shown"
    assert json.loads(program.ok("--json", "models")) == api.get("/v1/models").json()
    assert json.loads(program.ok("--json", "model", "ih21")) == api.get("/v1/models/ih21").json()


def test_strains_are_evaluated_and_written_as_csv(program: Program, api: Api) -> None:
    strains = ["--strain", "-0.05,0,0", "--strain", "0.1,-0.02,0.01;0.9,0,0"]
    text = program.ok("evaluate", "ih21", *DESIGN, *strains, "--derivatives", "2", "--csv", "answer.csv")
    assert text.count("tangent") == 9 and text.count(" yes") == 2 and text.count(" no") == 1
    answer = json.loads(program.ok("--json", "evaluate", "ih21", *DESIGN, *strains, "--derivatives", "2"))
    api.contract.validate({"$ref": "#/components/schemas/EvaluationResponse"}, answer, "the CLI's output")
    with (program.folder / "answer.csv").open() as file:
        rows = list(csv.DictReader(file))
    for i, row in enumerate(rows):
        assert [float(row[name]) for name in ("S_xx", "S_yy", "S_xy")] == answer["stress"][i]
        assert float(row["C_12"]) == answer["tangent"][i][0][1] and row["in_range"] == ("false" if i == 2 else "true")
    assert [float(rows[1][name]) for name in ("E_xx", "E_yy", "E_xy")] == [0.1, -0.02, 0.01]
    assert program.ok("evaluate", "ih21", *DESIGN, *strains, "-d", "2", "--csv", "-") == \
        (program.folder / "answer.csv").read_text()
    energies = program.ok("evaluate", "ih21", *DESIGN, "--strain", "0.1,0,0", "-d", "0", "--csv", "-").splitlines()
    assert energies[0] == "strain,E_xx,E_yy,E_xy,energy_density,in_range"


def test_strains_and_designs_come_from_files_too(program: Program) -> None:
    (program.folder / "strains.csv").write_text("# xx, yy, xy\n0.05, 0, 0\n0.1, -0.02, 0.01\n")
    (program.folder / "designs.csv").write_text("0.15, 0.65\n0.12, 0.7\n")
    answers = [json.loads(program.ok("--json", "evaluate", "ih21", "-p", designs, "-s", strains)) for designs, strains in (
        ("designs.csv", "strains.csv"), ("0.15,0.65;0.12,0.7", "0.05,0,0;0.1,-0.02,0.01"))]
    assert answers[0]["stress"] == answers[1]["stress"] and len(answers[0]["stress"]) == 2


def test_a_uniaxial_load_is_shown_and_written_as_csv(program: Program, api: Api) -> None:
    load = ["--direction", "0.3", "--stretches", "0.99:0.95:3"]
    text = program.ok("uniaxial", "ih21", *DESIGN, *load, "--csv", "curve.csv")
    assert text.count(" yes") == 3 and number_after("residual", text) <= 1e-10
    answer = json.loads(program.ok("--json", "uniaxial", "ih21", *DESIGN, *load))
    api.contract.validate({"$ref": "#/components/schemas/UniaxialResponse"}, answer, "the CLI's output")
    with (program.folder / "curve.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["directional_stress"]) for row in rows] == [s["directional_stress"] for s in answer["states"]]
    assert {row["converged"] for row in rows} == {"true"}
    strains = [str((s * s - 1) / 2) for s in (0.99, 0.97, 0.95)]
    same = json.loads(program.ok("--json", "uniaxial", "ih21", *DESIGN, "--direction", "0.3", "--green-strains",
                                 ",".join(strains), "--tolerance", "1e-8"))
    assert same["accuracy"]["tolerance"] == 1e-8
    np.testing.assert_allclose(same["states"][2]["green_strain"], answer["states"][2]["green_strain"], atol=1e-6)


@pytest.mark.parametrize("arguments, code, message", [
    (["model", "ih99"], 2, "model.not_found"),
    (["evaluate", "ih99", *DESIGN, "--strain", "0,0,0"], 2, "model.not_found"),
    (["evaluate", "ih21", "--strain", "0,0,0"], 1, "--parameters"),
    (["evaluate", "ih21", *DESIGN], 1, "--strain"),
    (["evaluate", "ih21", *DESIGN, "--strain", "0,0"], 1, "no Green strain"),
    (["evaluate", "ih21", "--parameters", "a,b", "--strain", "0,0,0"], 1, "list of parameters"),
    (["evaluate", "ih21", *DESIGN, "--strain", "0,0,0", "-d", "3"], 1, "derivatives"),
    (["evaluate", "ih21", "--parameters", "0.1", "--strain", "0,0,0"], 2, "--parameters at index 0: must be 2 numbers"),
    (["evaluate", "ih21", *DESIGN, "--strain", "0,0,0", "--csv", "no/such/folder.csv"], 5, "no/such/folder.csv"),
    (["uniaxial", "ih21", *DESIGN, "--direction", "0"], 1, "no load"),
    (["uniaxial", "ih21", *DESIGN, "--direction", "x", "--stretches", "1.1"], 1, "radians"),
    (["uniaxial", "ih21", *DESIGN, "--direction", "0", "--stretches", "1.1", "--green-strains", "0.1"], 1, "excludes"),
    (["uniaxial", "ih21", *DESIGN, "--direction", "0", "--stretches", "100"], 2, "--stretches at index 0"),
])
def test_a_failure_has_its_exit_code_and_one_clear_message(
        program: Program, arguments: List[str], code: int, message: str) -> None:
    finished = program.run(*arguments)
    assert finished.returncode == code, finished.stderr
    assert message in finished.stderr


def test_python_describes_models(client: supple.Client, api: Api) -> None:
    (model,) = client.models()
    document = api.get("/v1/models/ih21").json()
    assert model.id == "ih21" and "ih21" in repr(model) and client.model("ih21").info.sha256 == document["sha256"]
    info = model.info
    assert info.family == "IH21" and info.lower.tolist() == document["parameters"]["lower"]
    assert info.design_split is not None and info.design_split.gradient.percentile_99 == 0.05 and info.row_split is None
    with pytest.raises(supple.NotFound, match="ih21"):
        client.model("ih99")


def test_python_evaluates_in_numpy_arrays(client: supple.Client) -> None:
    model = client.model("ih21")
    strains = np.random.default_rng(1).uniform(-0.05, 0.05, (50, 3))
    energies, stresses, tangents = (model.evaluate([0.15, 0.65], strains, derivatives) for derivatives in range(3))
    assert energies.energy_density.shape == energies.in_range.shape == (50,) and energies.stress is None
    assert stresses.stress is not None and stresses.stress.shape == (50, 3) and stresses.tangent is None
    assert tangents.tangent is not None and tangents.tangent.shape == (50, 3, 3)
    assert tangents.in_range.all() and tangents.cost.quantities["strains"] == 50
    designs = np.repeat([[0.15, 0.65]], 50, axis=0)
    np.testing.assert_allclose(model.evaluate(designs, strains).stress, stresses.stress, rtol=1e-12)
    np.testing.assert_allclose(model.start_evaluation([0.15, 0.65], strains).result(timeout=60).stress, stresses.stress)
    with pytest.raises(supple.InvalidRequest) as error:
        model.evaluate([0.15], strains)
    assert error.value.faults[0].where == "/parameters/0"


def test_python_follows_uniaxial_loads(client: supple.Client) -> None:
    model = client.model("ih21")
    curve = model.uniaxial([0.15, 0.65], 0.3, stretches=[0.99, 0.97])
    assert curve.converged and curve.in_range.all() and curve.green_strain.shape == (2, 3)
    assert curve.directional_stress[1] < curve.directional_stress[0] < 0 and (curve.residual <= curve.tolerance).all()
    again = model.start_uniaxial([0.15, 0.65], 0.3, green_strains=[(s * s - 1) / 2 for s in (0.99, 0.97)]).result(timeout=60)
    np.testing.assert_allclose(again.stress, curve.stress, rtol=1e-7, atol=1e-12)
    hasty = model.uniaxial([0.15, 0.65], 0.3, stretches=[1.2], tolerance=1e-14, max_iterations=1)
    assert not hasty.converged


def test_the_example_prints_a_stiffness_for_every_direction(api: Api) -> None:
    finished = subprocess.run(
        [sys.executable, str(ROOT / "clients" / "python" / "examples" / "directional_stiffness.py"), "ih21", "0.15,0.65"],
        env={**os.environ, "SUPPLE_SERVER": api.server.url, "PYTHONPATH": str(ROOT / "clients" / "python")},
        capture_output=True, text=True, timeout=60, check=False)
    assert finished.returncode == 0, finished.stderr
    rows = [[float(word) for word in line.split()[:3]] for line in finished.stdout.splitlines()[2:]]
    assert len(rows) == 12 and all(rest > 0 for _, rest, _ in rows)
    assert all(abs(secant / rest - 1) < 0.5 for _, rest, secant in rows), "the secant is near the slope at rest"
