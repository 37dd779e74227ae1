"""Definitions of families over HTTP: all isohedral types are drawn as their table says, and faults are located."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any, Dict, List

import numpy as np
import pytest

import supple
from harness import CLI, Api, pointers, problem_code

CHECKS = "/v1/family-checks"


def value(expression: Any, parameters: List[float]) -> float:
    """An affine expression: a number, or a constant with the factors of parameters."""
    if not isinstance(expression, list):
        return float(expression)
    return expression[0] + sum(factor * parameter for factor, parameter in zip(expression[1:], parameters))


def points(rows: List[Any], parameters: List[float]) -> np.ndarray:
    return np.array([[value(x, parameters), value(y, parameters)] for x, y in rows])


def area(outline: np.ndarray) -> float:
    x, y = outline.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def definition_of(isohedral: Dict[str, Any], reach: float = 0.01) -> Dict[str, Any]:
    parameters = [{"description": "of a vertex", "lower": one - reach, "upper": one + reach, "default": one} for one in isohedral["defaults"]]
    return {"id": f"type{isohedral['number']}", "description": "", "parameters": parameters, "beam_width": 0.02, "isohedral_type": isohedral["number"]}


def squares(**more: Any) -> Dict[str, Any]:
    return {"id": "squares", "description": "Squares", "parameters": [], "beam_width": 0.1, **more,
            "tile": {"vertices": [[0, 0], [1, 0], [1, 1], [0, 1]], "translations": [[1, 0], [0, 1]],
                     "placements": [{"linear": [1, 0, 0, 1], "offset": [0, 0]}], **more.get("tile", {})}}


@pytest.fixture
def types(api: Api) -> List[Dict[str, Any]]:
    return api.get("/v1/isohedral-types").json()["types"]


def test_the_table_has_81_types_of_which_26_have_no_parameter(types: List[Dict[str, Any]]) -> None:
    numbers = [one["number"] for one in types]
    assert numbers == [n for n in range(1, 94) if n not in (19, 35, 48, 60, 63, 65, 70, 75, 80, 87, 89, 92)]
    assert sum(not one["defaults"] for one in types) == 26
    for one in types:
        assert len(one["tile"]["edges"]) == len(one["tile"]["vertices"])
        assert max(edge["shape"] for edge in one["tile"]["edges"]) == len(one["classes"]) - 1


def test_every_type_is_drawn_by_its_formulas(api: Api, types: List[Dict[str, Any]]) -> None:
    for one in types:
        parameters = [default + (0.009 if k % 2 else -0.008) for k, default in enumerate(one["defaults"])]
        answer = api.ok(CHECKS, {"definition": definition_of(one), "parameters": parameters})
        assert answer["good"], (one["number"], answer["faults"])
        drawn, tile = answer["tiling"], one["tile"]
        lattice = points(tile["translations"], parameters)
        np.testing.assert_allclose(drawn["lattice"], lattice, rtol=0, atol=1e-12)
        vertices = points(tile["vertices"], parameters)
        assert len(drawn["tiles"]) == len(tile["placements"])
        for placement, outline in zip(tile["placements"], drawn["tiles"]):
            linear = np.reshape(placement["linear"], (2, 2))
            expected = vertices @ linear.T + points([placement["offset"]], parameters)
            np.testing.assert_allclose(outline, expected[::-1] if np.linalg.det(linear) < 0 else expected, rtol=0, atol=1e-12)
        assert sum(area(np.array(outline)) for outline in drawn["tiles"]) == pytest.approx(abs(np.linalg.det(lattice)), rel=1e-9)


def test_the_shipped_families_have_no_faults(api: Api) -> None:
    for family in api.get("/v1/families").json()["families"]:
        if family["definition"]:
            answer = api.ok(CHECKS, {"definition": family["definition"]})
            assert answer["good"] and answer["tiling"]["parameters"] == family["parameters"]["default"]


def test_a_crossing_within_the_bounds_is_located(api: Api) -> None:
    definition = api.get("/v1/families/IH67").json()["definition"]
    crossing = next(one for one in api.ok(CHECKS, {"definition": definition})["warnings"] if one["flaw"] == "crossing")
    assert crossing["parameters"][1] == pytest.approx(7 / 6.9, abs=1e-5), "the trapezoid's upper side has the length 7 - 6.9 p2"
    assert len(crossing["point"]) == 2


@pytest.mark.parametrize("definition, flaw, pointer", [
    (squares(tile={"translations": [[1.2, 0], [0, 1]]}), "gap", "/definition/tile/vertices/1"),
    (squares(tile={"translations": [[0.8, 0], [0, 1]]}), "overlap", "/definition/tile/vertices/1"),
    (squares(tile={"translations": [[1, 0.5], [0, 1]]}), "unmatched", "/definition/tile/vertices/1"),
    (squares(parameters=[{"description": "nothing", "lower": 0, "upper": 1, "default": 0}]), "unused", "/definition/parameters/0"),
    (squares(parameters=[{"description": "too much", "lower": 0, "upper": 1, "default": 0}], beam_width=[1, 100000]), "too_large", "/definition/beam_width"),
    (squares(beam_width=-1), "field", "/definition/beam_width"),
    (squares(tile={"vertices": [[0, 0], [0, 1], [1, 1], [1, 0]]}), "field", "/definition/tile/vertices"),
    (squares(tile={"vertices": [[0, 0], [1, 1], [1, 0], [0, 1]]}), "crossing", "/definition/tile"),
])
def test_a_fault_is_named_and_located(api: Api, definition: Dict[str, Any], flaw: str, pointer: str) -> None:
    answer = api.ok(CHECKS, {"definition": definition})
    assert not answer["good"]
    fault = answer["faults"][0]
    assert (fault["flaw"], fault["pointer"]) == (flaw, pointer), fault["message"]
    if flaw in ("gap", "overlap", "unmatched", "crossing"):
        assert len(fault["point"]) == 2 and answer["tiling"]["tiles"]


def test_faults_of_the_request_are_pointed_to(api: Api) -> None:
    response = api.post(CHECKS, {"definition": squares(beam_width="thin", tile={"vertices": [[0, 0], [1], [1, 1]]})}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == ["/definition/beam_width", "/definition/tile/vertices/1"]
    bounded = squares(parameters=[{"description": "width", "lower": 0.1, "upper": 0.2, "default": 0.1}], beam_width=[0, 1])
    response = api.post(CHECKS, {"definition": bounded, "parameters": [0.3]})
    assert (response.status_code, problem_code(response)) == (422, "tiling.parameter_out_of_bounds")
    assert pointers(response) == ["/parameters/0"]


def test_the_python_client_checks_and_draws(api: Api) -> None:
    with supple.Client(api.server.url) as client:
        assert len(client.isohedral_types()) == 81
        check = client.check_family(squares(tile={"translations": [[1.2, 0], [0, 1]]}))
        assert not check.good and check.faults[0].flaw == "gap" and check.faults[0].point is not None
        assert check.faults[0].parameters.shape == (0,) and check.warnings == ()
        assert check.tiling is not None and check.tiling.tiles[0].shape == (4, 2)
        assert client.check_family(squares(beam_width=-1)).tiling is None
        definition = client.family("IH22").definition
        assert definition is not None and client.check_family(definition, [0.2, 0.5, 0.1]).good


def test_the_command_line_checks_a_file(api: Api, tmp_path: Path) -> None:
    def run(*arguments: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([str(CLI), "--server", api.server.url, *arguments], capture_output=True, text=True, timeout=60)

    described = run("families", "IH22")
    assert "Distance between the two upright sides" in described.stdout
    (tmp_path / "ih22.json").write_text(run("families", "IH22", "--json").stdout)
    checked = run("families", "--check", str(tmp_path / "ih22.json"))
    assert checked.returncode == 0 and "is one of a family" in checked.stdout, checked.stderr
    (tmp_path / "gap.json").write_text(json.dumps(squares(tile={"translations": [[1.2, 0], [0, 1]]})))
    checked = run("families", "--check", str(tmp_path / "gap.json"))
    assert checked.returncode == 6 and "fault (gap): /definition/tile/vertices/1 leaves a gap at (" in checked.stdout
