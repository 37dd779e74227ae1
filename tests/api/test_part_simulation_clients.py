"""Simulations of parts with the command line client and the Python package, and a real server."""

from __future__ import annotations

import csv
import json
import xml.etree.ElementTree as ElementTree
from typing import Any, Dict, List

import numpy as np
import pytest

import supple
from cli_program import Program, number_after
from harness import Api

COARSE = ("--mesh-size", "1", "--corner-size", "0.5", "--error-estimate", "off")
BLOCK = ("part", "simulate", "IH01", "--block", "15x15", *COARSE, "--states", "2", "--strain", "-2%")
PART = supple.PartRequest(supple.parts.block(15, 15), "IH01")


def test_a_part_is_simulated_and_written_as_files(program: Program) -> None:
    text = program.ok(*BLOCK, "--csv", "force.csv", "--svg", "state.svg", "--vtu", "state.vtu", "--plot", "force.svg")
    assert "the top plate" in text and text.count("converged") == 2 and "15 x 17 x 1 mm" in text
    with (program.folder / "force.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["share"]) for row in rows] == [0.5, 1]
    assert float(rows[1]["force_y_1"]) < float(rows[0]["force_y_1"]) < 0 and float(rows[1]["displacement_y_1"]) == pytest.approx(-0.3)
    for number in range(2):
        ElementTree.parse(program.folder / f"state-{number:04}.vtu")
        ElementTree.parse(program.folder / f"state-{number:04}.svg")
    assert "force (N)" in (program.folder / "force.svg").read_text()
    assert program.ok(*BLOCK, "--csv", "-") == (program.folder / "force.csv").read_text()


def test_the_command_line_has_the_servers_table_and_answer(program: Program, api: Api) -> None:
    answer = json.loads(program.ok("--json", *BLOCK))
    api.contract.validate({"$ref": "#/components/schemas/PartSimulationResponse"}, answer, "the CLI's output")
    request = {"part": {"outline": {"block": {"width": 15, "height": 15}}, "structure": {"family": "IH01"}}, "states": 2, "strain": -0.02,
               "accuracy": {"mesh_size": 1, "corner_size": 0.5}, "effects": {"error_estimate": "off"}}
    table = api.post("/v1/part-simulations", request, headers={"Accept": "text/csv"}).text.splitlines()
    own = program.ok(*BLOCK, "--csv", "-").splitlines()
    assert own[0] == table[0] and len(own) == len(table)
    for mine, theirs in zip(csv.DictReader(own), csv.DictReader(table)):
        for name, cell in mine.items():
            assert cell == theirs[name] or float(cell) == float(theirs[name]), name


def test_supports_are_given_by_options_or_a_file(program: Program) -> None:
    sheet = ("--json", "part", "--rectangle", "15x15", "--frame", "0.6", "simulate", "IH01", *COARSE, "--states", "1")
    by_options = json.loads(program.ok(*sheet, "--support=-1,-1,16,0.3mm", "--support", "top=0,-0.01cm", "--stick", "--gap", "0.05"))
    assert by_options["supports"] == [
        {"kind": "clamp", "box": [[-1, -1], [16, 0.3]], "displacement": [0, 0]},
        {"kind": "plate", "side": "top", "gap": 0.05, "friction": "stick", "displacement": [0, -0.1]}]
    (program.folder / "load.json").write_text(json.dumps({"supports": by_options["supports"]}))
    by_file = json.loads(program.ok(*sheet, "--load", "load.json"))
    assert by_file["states"] == by_options["states"]


def test_options_of_the_part_may_stand_on_either_side(program: Program) -> None:
    before = json.loads(program.ok("--json", "part", "IH01", "--block", "15x15", "--thickness", "2", "simulate", *COARSE, "--states", "1", "--strain", "-1%"))
    after = json.loads(program.ok("--json", "part", "simulate", "IH01", "--block", "15x15", "--thickness", "2", *COARSE, "--states", "1", "--strain", "-1%"))
    assert before["states"] == after["states"] and before["part"]["size"][2] == 2


def test_the_error_of_the_mesh_is_told(program: Program) -> None:
    arguments = [word for word in BLOCK if word not in ("--error-estimate", "off")]
    assert number_after("mesh error", program.ok(*arguments)) > 0
    assert "mesh error  unknown" in program.ok(*BLOCK)


@pytest.mark.parametrize("arguments, code, message", [
    (["part", "simulate"], 1, "no part"),
    (["part", "simulate", "IH01", "--rectangle", "15x15"], 2, "--support"),
    (["part", "simulate", "IH01", "--rectangle", "15x15", "--support", "above=0,1"], 1, "is no support"),
    (["part", "simulate", "IH01", "--rectangle", "15x15", "--support", "top=1"], 1, "is no support"),
    (["part", "simulate", "IH01", "--rectangle", "15x15", "--support", "0,0,1=0,1"], 1, "is no support"),
    (["part", "simulate", "IH01", "--rectangle", "15x15", "--support", "top=0,1MPa"], 1, "is no support"),
    (["part", "simulate", "IH01", "--block", "15x15", "--strain", "-1%", "--support", "top"], 1, "excludes"),
    (["part", "simulate", "IH01", "--block", "15x15", "--strain", "5%"], 2, "--strain"),
    (["part", "simulate", "IH01", "--rectangle", "15x15", *COARSE, "--support=-1,-1,16,0.3", "--support", "20,0,25,5=0,1"], 2, "--support at index 1"),
    (["part", "simulate", "IH01", "--block", "15x15", "--residual", "1"], 2, "--residual"),
    (["part", "simulate", "IH01", "--block", "15x15", "--beam-width", "200"], 2, "--beam-width"),
    (["part", "simulate", "IH99", "--block", "15x15"], 2, "tiling.family_not_found"),
    (["part", "simulate", "IH01", "--block", "15x15", "--stl", "a.stl"], 1, "--stl has no effect where the part is simulated"),
    (["part", "--svg", "a.svg", "simulate", "IH01", "--block", "15x15"], 1, "--svg has no effect before simulate"),
    (["part", "simulate", "IH01", "--block", "15x15", "--plot", "a.pdf"], 1, "--plot"),
], ids=lambda value: " ".join(value) if isinstance(value, list) else "")
def test_a_failure_has_its_exit_code_and_one_clear_message(program: Program, arguments: List[str], code: int, message: str) -> None:
    finished = program.run(*arguments)
    assert finished.returncode == code and message in finished.stderr, finished.stderr
    assert "/part/" not in finished.stderr and "supports/" not in finished.stderr


def test_python_simulates_a_part(client: supple.Client) -> None:
    seen: List[float] = []
    result = client.part_simulation(PART, strain="-2 %", states=2, mesh_size=1, corner_size=0.5, deformed="json",
                                    progress=lambda fraction, stage: seen.append(fraction))
    assert result.converged and seen[-1] == 1 and result.fixed_translation
    assert result.displacement == pytest.approx([0.15, 0.3]) and (result.force > 0).all()
    assert result.forces.shape == (2, 2, 2)
    np.testing.assert_allclose(result.forces.sum(axis=1), 0, atol=1e-4 * result.force.max())
    assert result.discretization_error is not None and 0 < result.discretization_error.force < 0.5
    assert isinstance(result.supports[1], supple.Plate) and result.supports[1].side == "top" and result.moving == 1
    assert {effect.name for effect in result.effects} >= {"contact", "buckling", "error_estimate"}
    deformed = result.states[-1].deformed
    assert result.mesh is not None and deformed is not None
    assert deformed.points.shape == result.mesh.points.shape and len(deformed.strains) == len(result.mesh.triangles)
    assert deformed.strains.max() == pytest.approx(result.states[-1].largest_strain)


def test_python_gives_supports_and_repeats_those_of_an_answer(client: supple.Client) -> None:
    sheet = supple.PartRequest(supple.parts.rectangle(15, 15), "IH01", options=supple.PartOptions(frame=0.6))
    supports: List[Any] = [supple.Clamp([[-1, -1], [16, 0.3]]), supple.Plate("top", (0, "-0.1 mm"), gap=0.05, friction="stick")]
    options: Dict[str, Any] = {"states": 1, "mesh_size": 1.0, "corner_size": 0.5, "error_estimate": "off"}
    first = client.part_simulation(sheet, supports, **options)
    again = client.part_simulation(sheet, first.supports, **options)
    np.testing.assert_array_equal(first.forces, again.forces)


def test_python_simulates_by_a_job_and_as_a_file(client: supple.Client) -> None:
    job = client.start_part_simulation(PART, strain=-0.02, states=2, mesh_size=1, corner_size=0.5, error_estimate="off", svg=True)
    result = job.result(timeout=300)
    assert job.status().kind == "part-simulations"
    ElementTree.fromstring(result.states[0].svg or "")
    table = client.part_simulation_file(PART, strain=-0.02, states=2, mesh_size=1, corner_size=0.5)
    rows = list(csv.DictReader(table.decode().splitlines()))
    assert [float(row["force_y_1"]) for row in rows] == result.forces[:, 1, 1].tolist()


def test_python_raises_what_supports_deserve(client: supple.Client) -> None:
    sheet = supple.PartRequest(supple.parts.rectangle(15, 15), "IH01")
    with pytest.raises(supple.InvalidRequest) as refused:
        client.part_simulation(sheet, [supple.Clamp([[20, 0], [25, 5]])], mesh_size=1)
    assert refused.value.code == "simulation.invalid_load" and refused.value.faults[0].where == "/supports/0/box"
    with pytest.raises(supple.InvalidRequest):
        client.part_simulation(sheet)
