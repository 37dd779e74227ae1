"""Families, structures and simulations with the command line client and with the Python package."""

from __future__ import annotations

import csv
import json
import xml.etree.ElementTree as ElementTree
from typing import List, Tuple

import numpy as np
import pytest

import supple
from cli_program import Program, number_after
from harness import Api
from plane import dxf_polylines, polygon_area, stl_triangles, unmatched_edges

COARSE = ["--mesh-size", "1"]


def test_the_families_are_listed_and_described(program: Program, api: Api) -> None:
    text = program.ok("families")
    for family in api.get("/v1/families").json()["families"]:
        assert family["id"] in text
    described = program.ok("families", "IH21")
    assert "IH21" in described and "lower" in described and "0.3 mm" in described
    assert json.loads(program.ok("--json", "families")) == api.get("/v1/families").json()
    unknown = program.run("families", "IH99")
    assert unknown.returncode == 2 and "tiling.family_not_found" in unknown.stderr


def test_a_structure_is_described_and_written_as_files(program: Program) -> None:
    text = program.ok("structure", "IH01", "--cells", "2x1", "--svg", "a.svg", "--dxf", "a.dxf", "--stl", "a.stl",
                      "--height", "3", "--mesh-size", "0.5")
    assert number_after("beam width", text) == pytest.approx(0.3)
    assert 0 < number_after("solid", text) < 1 and number_after("mesh", text) > 10
    ElementTree.parse(program.folder / "a.svg")
    assert dxf_polylines((program.folder / "a.dxf").read_text())
    triangles = stl_triangles((program.folder / "a.stl").read_bytes())
    assert unmatched_edges(triangles) == 0 and triangles[..., 2].max() == 3
    assert program.ok("structure", "IH01", "--cells", "2x1", "--svg", "-") == (program.folder / "a.svg").read_text()


def test_a_simulation_is_shown_and_written_as_csv_and_vtu(program: Program) -> None:
    text = program.ok("simulate", "IH01", "--uniaxial", "0", "--stretches", "1.01:1.03:3", *COARSE, "--csv", "curve.csv",
                      "--vtu", "state.vtu", "--contact", "off")
    assert text.count("converged") == 3
    with (program.folder / "curve.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["F_xx"]) for row in rows] == pytest.approx([1.01, 1.02, 1.03])
    assert float(rows[0]["C_11"]) > 0 and rows[0]["smallest_gap"] == ""
    assert float(rows[0]["S_xx"]) < float(rows[1]["S_xx"]) < float(rows[2]["S_xx"])
    for number in range(3):
        ElementTree.parse(program.folder / f"state-{number:04}.vtu")
    assert program.ok("simulate", "IH01", "--uniaxial", "0", "--stretches", "1.01:1.03:3", *COARSE, "--csv", "-",
                      "--contact", "off") == (program.folder / "curve.csv").read_text()


def test_the_command_line_says_the_error_of_the_mesh_and_takes_one_that_is_accepted(program: Program) -> None:
    load = ["simulate", "IH01", "--uniaxial", "0", "--stretches", "1.02", "--no-tangents"]
    text = program.ok(*load, "--discretization-error", "0.01")
    assert "after extrapolation" in text and 0 < number_after("mesh error", text) <= 1
    assert "was asked for" in program.ok(*load, *COARSE, "--discretization-error", "0.001")
    assert "mesh error  unknown" in program.ok(*load, *COARSE, "--refinement", "off")
    rows = list(csv.DictReader(program.ok(*load, "--csv", "-").splitlines()))
    assert 0 < float(rows[0]["stress_error"]) < 0.01 * float(rows[0]["S_xx"]) and float(rows[0]["energy_density_error"]) > 0


def test_python_says_the_error_of_the_mesh_and_takes_one_that_is_accepted(client: supple.Client) -> None:
    load = supple.Uniaxial(0.0, [1.02])
    usual = client.simulate("IH01", None, load)
    assert usual.extrapolated and usual.error_accepted is None and usual.discretization_error is not None
    assert 0 < usual.discretization_error.stress < 0.01 and usual.states[0].stress_error is not None
    accepted = client.simulate("IH01", None, load, discretization_error=0.02)
    assert accepted.error_accepted is True and accepted.mesh_size > usual.mesh_size
    unknown = client.simulate("IH01", None, load, mesh_size=1, refinement="off")
    assert unknown.discretization_error is None and unknown.states[0].stress_error is None and not unknown.extrapolated


def test_strains_come_from_the_command_line_or_a_file(program: Program, api: Api) -> None:
    (program.folder / "strains.csv").write_text("# xx, yy, xy\n0.01, 0, 0\n\n0.02, -0.005, 0.001\n")
    answers = [json.loads(program.ok("--json", "simulate", "IH01", "--green-strain", argument, *COARSE, "--no-tangents"))
               for argument in ("strains.csv", "0.01,0,0;0.02,-0.005,0.001")]
    api.contract.validate({"$ref": "#/components/schemas/SimulationResponse"}, answers[0], "the CLI's output")
    assert answers[0]["states"] == answers[1]["states"] and len(answers[0]["states"]) == 2
    assert answers[0]["states"][0]["tangent"] is None


def test_biaxial_stretches_come_in_pairs_or_with_one_for_all(program: Program) -> None:
    answers = [json.loads(program.ok("--json", "simulate", "IH01", "--biaxial", "0.3", "--stretches", "1.01,1.02",
                                     "--orthogonal", orthogonal, *COARSE))["states"] for orthogonal in ("0.99", "0.99,0.99")]
    assert answers[0] == answers[1]


@pytest.mark.parametrize("arguments, code, message", [
    (["simulate", "IH01"], 1, "no load"),
    (["simulate", "IH01", "--uniaxial", "0"], 1, "--stretches"),
    (["simulate", "IH01", "--uniaxial", "x", "--stretches", "1"], 1, "radians"),
    (["simulate", "IH01", "--uniaxial", "0", "--stretches", "1:2"], 1, "first:last:n"),
    (["simulate", "IH01", "--biaxial", "0", "--stretches", "1.1"], 1, "--orthogonal"),
    (["simulate", "IH01", "--biaxial", "0", "--stretches", "1.1,1.2,1.3", "--orthogonal", "1,1"], 1, "as many"),
    (["simulate", "IH01", "--green-strain", "1,2"], 1, "no Green strain"),
    (["simulate", "IH01", "--uniaxial", "0", "--green-strain", "0,0,0"], 1, "excludes"),
    (["simulate", "IH01", "--uniaxial", "0", "--stretches", "1.1", "--contact", "maybe"], 1, "contact"),
    (["simulate", "IH01", "--uniaxial", "0", "--stretches", "100"], 2, "--stretches at index 0"),
    (["structure", "IH99"], 2, "tiling.family_not_found"),
    (["structure", "IH01", "--parameters", "1,2,x"], 1, "list of parameters"),
    (["structure", "IH01", "--parameters", "0.9,0.5,0.1,0.6"], 2, "tiling.parameter_out_of_bounds"),
    (["structure", "IH01", "--cells", "4", "--svg", "tiling.svg"], 1, "4x3"),
    (["structure", "IH01", "--svg", "no/such/folder.svg"], 5, "no/such/folder.svg"),
])
def test_a_failure_has_its_exit_code_and_one_clear_message(
        program: Program, arguments: List[str], code: int, message: str) -> None:
    finished = program.run(*arguments)
    assert finished.returncode == code, finished.stderr
    assert message in finished.stderr


def test_python_lists_families_and_makes_structures(client: supple.Client) -> None:
    families = {family.id: family for family in client.families()}
    family = client.family("IH21")
    assert family.id in families and family.lower.shape == family.upper.shape == family.default.shape == (2,)
    structure = client.structure("IH21", family.default.tolist(), mesh_size=0.5)
    assert structure.cell_area == pytest.approx(family.cell_area) and len(structure.tiles) == family.tiles
    assert sum(polygon_area(tile.outline) for tile in structure.tiles) == pytest.approx(structure.cell_area)
    assert structure.mesh is not None and structure.mesh.nodes > 100
    assert client.structure("IH21").mesh is None
    ElementTree.fromstring(client.structure_file("IH21"))
    assert unmatched_edges(stl_triangles(client.structure_file("IH21", kind="stl", cells=(1, 1), height=2))) == 0


def test_python_simulates_with_progress(client: supple.Client) -> None:
    seen: List[Tuple[float, str]] = []
    simulation = client.simulate("IH01", None, supple.Uniaxial(0.0, [1.01, 1.02]), mesh_size=1, deformed="json",
                                 patch="off", progress=lambda fraction, stage: seen.append((fraction, stage)))
    assert simulation.converged and seen[-1][0] == 1
    assert simulation.stress.shape == (2, 3) and simulation.tangent.shape == (2, 3, 3)
    np.testing.assert_allclose(simulation.deformation_gradient[:, 0, 0], [1.01, 1.02])
    assert {effect.name for effect in simulation.effects} >= {"contact", "patch", "buckling"}
    patch = simulation.states[1].deformed
    assert patch is not None and patch.points.shape == patch.mesh.points.shape
    assert simulation.cost.seconds > 0 and simulation.residual is not None
    assert simulation.residual <= simulation.tolerance


def test_python_simulates_by_a_job(client: supple.Client) -> None:
    job = client.start_simulation("IH01", None, supple.Biaxial(0.2, [(1.01, 0.99)]), mesh_size=1, deformed="vtu")
    simulation = job.result(timeout=60)
    assert job.status().mesh is None and job.status().kind == "simulations"
    ElementTree.fromstring(simulation.states[0].vtu or "")


def test_python_raises_what_parameters_and_loads_deserve(client: supple.Client) -> None:
    with pytest.raises(supple.InvalidStructure) as structure:
        client.structure("IH01", [0.9, 0.5, 0.1, 0.6])
    assert structure.value.faults[0].where == "/parameters/0"
    with pytest.raises(supple.NotFound):
        client.family("IH99")
    with pytest.raises(supple.InvalidRequest):
        client.simulate("IH01", None, supple.GreenStrain([[-0.6, 0, 0]]), mesh_size=1)
