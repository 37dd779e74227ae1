"""Materials and sizes of designs over HTTP: moduli, choices of materials, sizes and their limits."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any, Dict
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

from design_requests import DESIGNS, FEW, KNOWN, PROFILES, effect, known_problem, profile
from harness import CLI, Api, pointers, problem_code

MODEL_MODULUS = 26.0


def scaled(problem: Dict[str, Any], factor: float) -> Dict[str, Any]:
    """The problem with the values of its target multiplied by `factor`."""
    points = [[x, factor * y] for x, y in problem["target"]["control_points"]]
    return {**problem, "target": {**problem["target"], "control_points": points}}


def structure_of(api: Api, answer: Dict[str, Any], **more: Any) -> Any:
    return api.ok("/v1/structures", {"family": answer["family"], "parameters": answer["parameters"], **more})


def test_without_a_material_it_is_that_of_the_models_data(designs: Api) -> None:
    answer = designs.ok(DESIGNS, known_problem(designs))
    model = designs.get(f"/v1/models/{answer['model']}").json()
    assert answer["material"]["youngs_modulus"] == model["material"]["youngs_modulus"] == MODEL_MODULUS
    assert answer["material"]["poisson_ratio"] == model["material"]["poisson_ratio"]
    structure = structure_of(designs, answer)
    assert answer["structure"]["beam_width"] == structure["beam_width"] == 0.3
    assert answer["structure"]["relative_density"] == pytest.approx(structure["relative_density"])
    assert answer["structure"]["cell_size"] == pytest.approx(structure["cell_area"] ** 0.5)
    assert answer["structure"]["density"] == pytest.approx(1.2 * structure["relative_density"])


@pytest.mark.parametrize("task", ["stress_strain", "stiffness", "poisson"])
def test_a_stiffer_material_has_the_same_design_for_a_stiffer_target(designs: Api, task: str) -> None:
    problem = known_problem(designs, task)
    plain = designs.ok(DESIGNS, problem)
    factor = 1 if task == "poisson" else 100
    material = {"name": "PLA", "youngs_modulus": 100 * MODEL_MODULUS, "density": 1.24}
    stiffer = designs.ok(DESIGNS, {**scaled(problem, factor), "material": material})
    assert stiffer["material"] == {**material, "law": "neo_hookean", "poisson_ratio": plain["material"]["poisson_ratio"]}
    np.testing.assert_allclose(stiffer["parameters"], plain["parameters"], rtol=1e-3)
    np.testing.assert_allclose(stiffer["profile"]["achieved"], factor * np.array(plain["profile"]["achieved"]),
                               rtol=1e-3, atol=1e-3 * factor * max(map(abs, plain["profile"]["achieved"])))
    np.testing.assert_allclose(stiffer["profile"]["error_bar"], factor * np.array(plain["profile"]["error_bar"]), rtol=0.02)
    assert stiffer["structure"]["density"] == pytest.approx(1.24 * stiffer["structure"]["relative_density"])


def test_a_profile_is_that_of_the_material(designs: Api) -> None:
    directions = [0.0, 0.4, 1.1]
    plain = designs.ok(PROFILES, {"task": "stiffness", "family": "IH67", "parameters": KNOWN["IH67"], "x": directions})
    for task, factor in (("stiffness", 3.0), ("poisson", 1.0)):
        request = {"task": task, "family": "IH67", "parameters": KNOWN["IH67"], "x": directions}
        soft = designs.ok(PROFILES, request)
        stiff = designs.ok(PROFILES, {**request, "material": {"youngs_modulus": 3 * MODEL_MODULUS}})
        np.testing.assert_allclose(stiff["y"], factor * np.array(soft["y"]), rtol=1e-12)
        np.testing.assert_allclose(stiff["error_bar"], factor * np.array(soft["error_bar"]), rtol=1e-12)
        assert stiff["material"]["youngs_modulus"] == 3 * MODEL_MODULUS
    assert plain["material"]["youngs_modulus"] == MODEL_MODULUS


def test_the_modulus_is_found_within_its_range(designs: Api) -> None:
    problem = scaled(known_problem(designs, "stiffness"), 7)
    held = designs.ok(DESIGNS, problem)
    assert not held["reached"], "without the freedom the target is out of reach"
    found = designs.ok(DESIGNS, {**problem, "material": {"youngs_modulus": [MODEL_MODULUS, 20 * MODEL_MODULUS]}})
    assert found["reached"] and found["error"]["relative_rms"] < 1e-3
    assert effect(found, "modulus")["ran"] and not effect(held, "modulus")["ran"]
    narrow = designs.ok(DESIGNS, {**problem, "material": {"youngs_modulus": [MODEL_MODULUS, 1.5 * MODEL_MODULUS]}})
    assert narrow["message"].endswith("Young's modulus is at its upper limit.")
    assert MODEL_MODULUS < found["material"]["youngs_modulus"] < 20 * MODEL_MODULUS
    again = profile(designs, "stiffness", found["profile"]["x"], parameters=found["parameters"],
                    strain=0.04, material={"youngs_modulus": found["material"]["youngs_modulus"]})
    np.testing.assert_allclose(again["y"], found["profile"]["achieved"], rtol=1e-6)


def test_of_several_materials_the_best_is_chosen(designs: Api) -> None:
    problem = scaled(known_problem(designs, "stiffness"), 7)
    materials = [{"name": "soft", "youngs_modulus": MODEL_MODULUS},
                 {"name": "right", "youngs_modulus": [6 * MODEL_MODULUS, 9 * MODEL_MODULUS], "density": 1.1},
                 {"name": "hard", "youngs_modulus": 3000}]
    answer = designs.ok(DESIGNS, {**problem, "material": materials})
    assert answer["material"]["name"] == "right" and answer["material"]["density"] == 1.1
    assert answer["ranking"][0]["material"] == answer["material"]
    assert answer["reached"]


def test_a_simulation_verifies_the_material_that_was_asked_for(designs: Api) -> None:
    problem = scaled(known_problem(designs, "stress_strain"), 10)
    request = {**problem, "material": {"youngs_modulus": 10 * MODEL_MODULUS}, "verify": True, "effects": {"polish": "off"},
               "accuracy": {**FEW, "verified_samples": 3}}
    verified = designs.ok(DESIGNS, request)["profile"]["verified"]
    assert verified["relative_rms"] < 0.1, "simulation and model are of the same modulus"
    assert verified["target_error"] < 0.1
    assert verified["discretization_error"] < 0.1


def test_a_structure_has_the_size_that_was_asked_for(designs: Api) -> None:
    problem = known_problem(designs)
    plain = designs.ok(DESIGNS, problem)
    wide = designs.ok(DESIGNS, {**problem, "beam_width": 0.6})
    assert wide["parameters"] == plain["parameters"] and wide["profile"] == plain["profile"]
    assert wide["structure"]["cell_size"] == pytest.approx(2 * plain["structure"]["cell_size"])
    cells = designs.ok(DESIGNS, {**problem, "cell_size": 10})
    assert cells["structure"]["cell_size"] == pytest.approx(10)
    width = cells["structure"]["beam_width"]
    assert width == pytest.approx(0.3 * 10 / plain["structure"]["cell_size"])
    # The links to files in the answer have that size.
    link = cells["structure"]["svg"]
    assert float(parse_qs(urlsplit(link).query)["beam_width"][0]) == width
    posted = designs.post("/v1/structures", {"family": "IH67", "parameters": cells["parameters"], "beam_width": width},
                          headers={"Accept": "image/svg+xml"})
    assert designs.get(link).text == posted.text
    assert designs.get(link).text != designs.get(plain["structure"]["svg"]).text
    structure = structure_of(designs, cells, beam_width=width)
    assert structure["cell_area"] == pytest.approx(100)


def test_a_search_keeps_within_the_limits(designs: Api) -> None:
    problem = known_problem(designs, "stiffness")
    free = designs.ok(DESIGNS, problem)
    density, cell = free["structure"]["relative_density"], free["structure"]["cell_size"]
    lighter = designs.ok(DESIGNS, {**problem, "limits": {"relative_density": [0, 0.9 * density]}})
    assert lighter["structure"]["relative_density"] <= 0.9 * density
    assert lighter["error"]["relative_rms"] > free["error"]["relative_rms"]
    assert effect(lighter, "limits")["ran"] and not effect(free, "limits")["ran"]
    denser = designs.ok(DESIGNS, {**problem, "limits": {"relative_density": [1.1 * density, 1]}})
    assert denser["structure"]["relative_density"] >= 1.1 * density
    finer = designs.ok(DESIGNS, {**problem, "limits": {"cell_size": [0, 0.9 * cell]}})
    assert finer["structure"]["cell_size"] <= 0.9 * cell
    strong = designs.ok(DESIGNS, {**problem, "cell_size": 5, "limits": {"beam_width": [5 * 0.3 / (0.9 * cell), 5]}})
    assert strong["structure"]["beam_width"] >= 5 * 0.3 / (0.9 * cell)
    # Limits that do not exclude the best design do not change it.
    wide = designs.ok(DESIGNS, {**problem, "limits": {"relative_density": [0.5 * density, 2 * density]}})
    np.testing.assert_allclose(wide["parameters"], free["parameters"], rtol=1e-5)


def test_limits_that_nothing_is_within_are_a_problem(designs: Api) -> None:
    answer = designs.post(DESIGNS, {**known_problem(designs, "stiffness"), "limits": {"relative_density": [0, 0.01]}})
    assert (answer.status_code, problem_code(answer)) == (422, "design.beyond_limits")
    assert pointers(answer) == ["/limits"]
    assert "Its relative density is" in answer.json()["detail"]


@pytest.mark.parametrize("material, pointer", [
    ({"poisson_ratio": 0.3}, "/material/poisson_ratio"),
    ({"law": "incompressible_plane_stress"}, "/material/law"),
    ([{"poisson_ratio": 0.1}], "/material/0/poisson_ratio"),
    ([{"youngs_modulus": 3}, {"youngs_modulus": 4, "poisson_ratio": 0.1}], "/material/1/poisson_ratio")])
def test_a_material_that_no_model_knows_is_refused_with_the_reason(designs: Api, material: Any, pointer: str) -> None:
    answer = designs.post(DESIGNS, {**known_problem(designs), "material": material})
    assert (answer.status_code, problem_code(answer), pointers(answer)) == (422, "design.other_material", [pointer])
    assert "proportional to Young's modulus alone" in answer.json()["detail"]


def test_a_region_names_the_place_of_its_material(designs: Api) -> None:
    problem = known_problem(designs)
    problem.pop("accuracy")
    answer = designs.post(DESIGNS, {"regions": [problem, {**problem, "material": {"poisson_ratio": 0.1}}]})
    assert pointers(answer) == ["/regions/1/material/poisson_ratio"]
    several = designs.post(DESIGNS, {"regions": [{**problem, "material": [{"name": "a"}, {"youngs_modulus": 3}]}]})
    assert (several.status_code, pointers(several)) == (400, ["/regions/0/material/0"])


def test_a_profile_refuses_other_materials_too(designs: Api) -> None:
    request = {"task": "poisson", "family": "IH67", "parameters": KNOWN["IH67"], "x": [0], "material": {"poisson_ratio": 0.1}}
    answer = designs.post(PROFILES, request)
    assert (answer.status_code, problem_code(answer), pointers(answer)) == (
        422, "design.other_material", ["/material/poisson_ratio"])


def test_equal_requests_with_a_choice_of_materials_have_equal_answers(designs: Api) -> None:
    request = {**scaled(known_problem(designs), 5), "material": {"youngs_modulus": [10, 1000]}}
    first, second = designs.ok(DESIGNS, request), designs.ok(DESIGNS, request)
    for name in ("parameters", "material", "structure", "profile"):
        assert first[name] == second[name]


def test_a_turned_target_has_the_same_design_turned(designs: Api, tmp_path: Path) -> None:
    angle = 0.6
    problem = known_problem(designs, "stiffness")
    directions = [point[0] for point in problem["target"]["control_points"]]
    values = profile(designs, "stiffness", directions, strain=problem["strain"], orientation=angle)["y"]
    turned = [[x, y] for x, y in zip(directions, values)]
    asked = {**problem, "target": {**problem["target"], "control_points": turned}}
    held = designs.ok(DESIGNS, {**asked, "orientation": angle})
    assert held["orientation"] == angle and held["error"]["relative_rms"] < 1e-4
    np.testing.assert_allclose(held["parameters"], KNOWN["IH67"], rtol=1e-2)
    found = designs.ok(DESIGNS, {**asked, "orientation": [0, np.pi]})
    assert found["error"]["relative_rms"] < 1e-3 and 0 <= found["orientation"] <= np.pi
    assert effect(found, "orientation")["ran"] and not effect(held, "orientation")["ran"]
    again = profile(designs, "stiffness", directions, parameters=found["parameters"], strain=problem["strain"],
                    orientation=found["orientation"])
    np.testing.assert_allclose(again["y"], found["profile"]["achieved"], rtol=1e-6)
    # With an initial design and its orientation, no other starting point is used.
    start = {"initial": KNOWN["IH67"], "initial_orientation": angle + 0.02}
    followed = designs.ok(DESIGNS, {**asked, **start, "orientation": [0, np.pi]})
    assert followed["starts"] == 1 and followed["orientation"] == pytest.approx(angle, abs=1e-3)
    # The command line sends the same request.
    request = tmp_path / "request.json"
    request.write_text(json.dumps(asked))
    shown = subprocess.run(
        [str(CLI), "--server", designs.server.url, "--json", "design", "--missed-ok", "--request", str(request), "--initial",
         ",".join(map(str, KNOWN["IH67"])), "--orientation", "0deg,180deg", "--initial-orientation", str(angle + 0.02)],
        capture_output=True, text=True, timeout=60, check=True)
    assert json.loads(shown.stdout)["parameters"] == followed["parameters"]


def test_a_turned_design_is_simulated_as_it_lies(designs: Api) -> None:
    problem = known_problem(designs, "stress_strain")
    request = {**problem, "initial": KNOWN["IH67"], "fixed": KNOWN["IH67"], "direction": 0.3 + 0.5, "orientation": 0.5,
               "verify": True, "effects": {"polish": "off"}, "accuracy": {**FEW, "verified_samples": 3}}
    answer = designs.ok(DESIGNS, request)
    straight = designs.ok(DESIGNS, {**request, "direction": 0.3, "orientation": 0})
    np.testing.assert_allclose(answer["profile"]["achieved"], straight["profile"]["achieved"], rtol=1e-9)
    np.testing.assert_allclose(answer["profile"]["verified"]["y"], straight["profile"]["verified"]["y"], rtol=1e-6)
    assert answer["polish"]["rounds"][0]["orientation"] == 0.5


@pytest.mark.parametrize("fields, pointer", [
    ({"orientation": [1, 0]}, "/orientation"), ({"orientation": [0, 4]}, "/orientation"),
    ({"initial_orientation": 1}, "/initial_orientation"),
    ({"initial": [0.22, 0.85], "orientation": [0, 1], "initial_orientation": 2}, "/initial_orientation")])
def test_orientations_that_are_none_are_refused(designs: Api, fields: Dict[str, Any], pointer: str) -> None:
    answer = designs.post(DESIGNS, {**known_problem(designs), **fields})
    assert (answer.status_code, pointers(answer)) == (400, [pointer])
