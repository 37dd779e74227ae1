"""Simulations of parts over HTTP: supports, forces, files, jobs, and refusals that name the support and its limit."""

from __future__ import annotations

import csv
import io
import json
import math
import xml.etree.ElementTree as ElementTree
from typing import Any, Callable, Dict, List, Tuple

import numpy as np
import pytest
import requests

from contract import Contract
from harness import Api, ServerProcess, pointers, problem_code
from plane import polygon_area
from test_jobs import events, start_job
from test_simulations import vtu_array
from working_time import WorkingTime, comes_true, ends_within

SIMULATIONS = "/v1/part-simulations"
IH01 = {"family": "IH01"}
BLOCK = {"outline": {"block": {"width": 15, "height": 15}}, "structure": IH01}
COUPON = {"outline": {"coupon": {"width": 15, "length": 15, "grip_length": 2}}, "structure": IH01}
SHEET = {"outline": {"rectangle": [15, 15]}, "structure": IH01, "frame": 0.6}
FOOT = {"kind": "clamp", "box": [[-1, -1], [16, 0.3]]}
COARSE = {"mesh_size": 1, "corner_size": 0.5}
CHEAP = {"accuracy": COARSE, "effects": {"error_estimate": "off"}}
CSV, SVG, OBJ, VTU = "text/csv", "image/svg+xml", "model/obj", "application/x-vtu+xml"


def request(part: Dict[str, Any], **more: Any) -> Dict[str, Any]:
    """A cheap simulation on a coarse mesh."""
    return {"part": part, "states": 2, **CHEAP, **more}


def long_request(**more: Any) -> Dict[str, Any]:
    """A simulation that takes some seconds to minutes."""
    return request(BLOCK, states=200, strain=-0.3, accuracy={"mesh_size": 0.5, "max_load_step": 1e-3}, **more)


def converged(api: Api, document: Dict[str, Any]) -> Dict[str, Any]:
    answer = api.ok(SIMULATIONS, document)
    assert answer["message"] == "" and len(answer["states"]) == document.get("states", 10)
    assert {state["stopped"] for state in answer["states"]} == {"converged"}
    assert all(state["residual"] <= answer["accuracy"]["tolerance"] for state in answer["states"])
    return answer  # type: ignore[no-any-return]


def forces(answer: Dict[str, Any]) -> np.ndarray:
    """The force of each support in each state, shape (states, supports, 2), N."""
    return np.array([[support["force"] for support in state["supports"]] for state in answer["states"]])


def test_a_block_is_pressed_between_two_plates_by_default(api: Api) -> None:
    answer = converged(api, request({**BLOCK, "thickness": 4}, strain=-0.02))
    assert answer["part"]["size"] == pytest.approx([15, 17, 4]) and answer["part"]["message"] == ""
    assert [support["side"] for support in answer["supports"]] == ["bottom", "top"]
    assert answer["supports"][1]["displacement"] == pytest.approx([0, -0.3])
    assert answer["fixed_translation"] is True
    force = forces(answer)
    assert (force[:, 1, 1] < 0).all() and force[1, 1, 1] < force[0, 1, 1]
    np.testing.assert_allclose(force.sum(axis=1), 0, atol=1e-4 * abs(force).max())
    np.testing.assert_allclose(force[:, :, 0], 0, atol=1e-4 * abs(force).max())
    for state in answer["states"]:
        assert state["supports"][1]["displacement"] == pytest.approx([0, -0.3 * state["share"]])
        assert state["stable"] and state["energy"] > 0 and state["largest_strain"] > 0
        for support in state["supports"]:
            pressure = support["pressure"]
            total = 4 * pressure["length"] * sum(pressure["values"])
            assert total == pytest.approx(abs(support["force"][1]), rel=1e-9) and min(pressure["values"]) >= -1e-6
            np.testing.assert_allclose(np.diff(pressure["positions"]), pressure["length"])


def test_a_coupon_is_stretched_between_its_grips_by_default(api: Api) -> None:
    answer = converged(api, request(COUPON, strain=0.02))
    assert [support["kind"] for support in answer["supports"]] == ["clamp", "clamp"]
    force = forces(answer)
    assert (force[:, 1, 1] > 0).all()
    np.testing.assert_allclose(force[:, 0], -force[:, 1], rtol=1e-4, atol=1e-4 * abs(force).max())
    assert all(support["pressure"] is None for state in answer["states"] for support in state["supports"])


def test_twice_the_thickness_or_the_modulus_is_twice_the_force(api: Api) -> None:
    single = forces(converged(api, request(COUPON, strain=0.02)))
    for more in ({"part": {**COUPON, "thickness": 2}}, {"material": {"youngs_modulus": 52}}):
        doubled = forces(converged(api, {**request(COUPON, strain=0.02), **more}))
        np.testing.assert_allclose(doubled, 2 * single, rtol=1e-6, atol=1e-6 * abs(single).max())


def stress(s: float, t: float) -> float:
    """The first Piola-Kirchhoff stress of the default material along the stretch s, for the stretch t across it, MPa."""
    young, poisson = 26, 0.48
    mu = young / (2 * (1 + poisson))
    lame = 2 * mu * poisson / (1 - 2 * poisson)
    return mu * (s - 1 / s) + lame * math.log(s * t) / s


def free_stretch(s: float) -> float:
    """The stretch across at which there is no stress across."""
    low, high = 0.5, 2.0
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if stress(middle, s) < 0 else (low, middle)
    return low


def test_a_solid_block_has_the_force_of_a_closed_form(api: Api) -> None:
    solid = {"outline": {"rectangle": [6, 4]}, "structure": IH01, "frame": 4, "thickness": 2}
    supports = [{"kind": "plate", "side": "bottom"}, {"kind": "plate", "side": "top", "displacement": [0, -0.8]}]
    answer = converged(api, request(solid, supports=supports, states=4))
    assert answer["part"]["solid_area"] == pytest.approx(24)
    for state, force in zip(answer["states"], forces(answer)):
        s = 1 - 0.8 * state["share"] / 4
        expected = 6 * 2 * stress(s, free_stretch(s))
        assert force[1, 1] == pytest.approx(expected, rel=1e-6)


def test_a_block_of_more_cells_is_nearer_to_the_periodic_response(api: Api) -> None:
    strain = -0.01
    structure = api.ok("/v1/structures", {"family": "IH22"})
    side = math.sqrt(structure["cell_area"])
    load = {"uniaxial": {"direction": math.pi / 2, "stretches": [1 + strain], "frame": "material"}}
    (state,) = api.ok("/v1/simulations", {"family": "IH22", "load": load})["states"]
    nominal = (1 + strain) * state["stress"][1]
    deviations = []
    for cells in (3, 6):
        block = {"outline": {"block": {"width": cells * side, "height": cells * side}}, "structure": {"family": "IH22"}}
        answer = converged(api, request(block, strain=strain, states=1))
        deviations.append(forces(answer)[0, 1, 1] / (cells * side * nominal) - 1)
    # Solid plates and free sides take part in small blocks. Six cells are within a quarter of an endless tiling.
    assert abs(deviations[1]) < 0.25, deviations
    assert abs(deviations[1]) < abs(deviations[0]), deviations


def test_the_energy_is_the_work_of_the_supports(api: Api) -> None:
    answer = converged(api, request(COUPON, strain=0.04, states=20))
    work = np.einsum("ki,ki->k", forces(answer)[:, 1], np.tile(np.array([0, 15 * 0.04 / 20]), (20, 1)))
    energies = np.array([state["energy"] for state in answer["states"]])
    # Simpson's rule over two steps is exact up to the fourth derivative of the force.
    np.testing.assert_allclose(energies[2:] - energies[:-2], (work[:-2] + 4 * work[1:-1] + work[2:]) / 3, rtol=1e-6)


def test_a_plate_that_arrives_late_and_sticks(api: Api) -> None:
    supports = [FOOT, {"kind": "plate", "side": "top", "gap": 0.1, "friction": "stick", "displacement": [0.05, -0.3]}]
    answer = converged(api, request(SHEET, supports=supports, states=6))
    pressed = [state["supports"][1]["touching"] > 0 for state in answer["states"]]
    assert pressed == [False, False, True, True, True, True] or pressed == [False, True, True, True, True, True]
    assert forces(answer)[0, 1].tolist() == [0, 0] and forces(answer)[-1, 1, 1] < 0
    assert answer["fixed_translation"] is False


def test_the_answer_says_what_ran_and_what_was_reached(api: Api) -> None:
    answer = converged(api, {"part": BLOCK, "strain": -0.01, "states": 1, "accuracy": COARSE, "effects": {"contact": "off"}})
    effects = {effect["name"]: effect for effect in answer["effects"]}
    assert {"contact", "buckling", "error_estimate", "frame", "trimming"} <= set(effects)
    assert not effects["contact"]["ran"] and effects["error_estimate"]["ran"] and effects["error_estimate"]["seconds"] > 0
    assert all(effect["why"] for effect in effects.values())
    accuracy = answer["accuracy"]
    assert accuracy["mesh_size"] == 1 and accuracy["corner_size"] == 0.5 and accuracy["nodes"] > 100
    assert accuracy["triangles"] > 100 and accuracy["unknowns"] <= 2 * accuracy["nodes"]
    assert {"part", "meshing", "assembly", "factorization"} <= {stage["name"] for stage in answer["cost"]["stages"]}


def test_the_estimated_error_covers_the_difference_from_a_finer_mesh(api: Api) -> None:
    document = {"part": BLOCK, "strain": -0.02, "states": 2, "accuracy": {"mesh_size": 1, "corner_size": 0.2}}
    answer = converged(api, document)
    fine = converged(api, {**document, "accuracy": {"mesh_size": 0.3, "corner_size": 0.1}, "effects": {"error_estimate": "off"}})
    assert fine["accuracy"]["discretization_error"] is None
    difference = np.linalg.norm(forces(answer) - forces(fine)) / np.linalg.norm(forces(fine))
    assert difference < answer["accuracy"]["discretization_error"]["force"] < 0.3


def test_equal_requests_have_equal_answers(api: Api) -> None:
    document = request(BLOCK, strain=-0.05, deformed="json")
    first, second = (api.ok(SIMULATIONS, document) for _ in range(2))
    assert first["states"] == second["states"] and first["mesh"] == second["mesh"]


def test_deformed_parts_are_given_as_points_and_files(api: Api) -> None:
    as_json = converged(api, request(BLOCK, strain=-0.02, deformed="json", svg=True))
    rest, triangles = np.array(as_json["mesh"]["points"]), np.array(as_json["mesh"]["triangles"])
    assert len(rest) == as_json["accuracy"]["nodes"] and len(triangles) == as_json["accuracy"]["triangles"]
    area = sum(polygon_area(rest[corners[:3]]) for corners in triangles)
    assert area == pytest.approx(as_json["part"]["solid_area"], rel=1e-6)
    last = as_json["states"][-1]
    points = np.array(last["deformed"]["points"])
    assert points[:, 1].max() == pytest.approx(rest[:, 1].max() - 0.3, abs=1e-6), "nothing passes the plate"
    assert max(last["deformed"]["strains"]) == pytest.approx(last["largest_strain"], rel=1e-9)
    pictures = [ElementTree.fromstring(state["svg"]) for state in as_json["states"]]
    assert len({picture.attrib["viewBox"] for picture in pictures}) == 1, "they can be shown one after the other"
    as_vtu = converged(api, request(BLOCK, strain=-0.02, deformed="vtu"))
    (piece,) = ElementTree.fromstring(as_vtu["states"][-1]["vtu"]).iter("Piece")
    moved = (vtu_array(piece, "Points") + vtu_array(piece, "displacement")).reshape(-1, 3)[:, :2]
    np.testing.assert_allclose(moved, points, atol=1e-9)
    np.testing.assert_allclose(vtu_array(piece, "largest_strain"), last["deformed"]["strains"], rtol=1e-9, atol=1e-12)
    as_obj = converged(api, request(BLOCK, strain=-0.02, deformed="obj"))["states"][-1]["obj"]
    vertices = [list(map(float, line.split()[1:3])) for line in as_obj.splitlines() if line.startswith("v ")]
    np.testing.assert_allclose(vertices, points, atol=1e-9)
    assert sum(line.startswith("f ") for line in as_obj.splitlines()) == 4 * len(triangles)


def test_files_are_of_the_type_that_is_asked_for(api: Api) -> None:
    document = request(BLOCK, strain=-0.02)
    answer = converged(api, document)
    files = {kind: api.post(SIMULATIONS, document, headers={"Accept": kind}) for kind in (CSV, SVG, OBJ, VTU)}
    for kind, response in files.items():
        assert response.status_code == 200 and response.headers["Content-Type"] == kind, response.text[:500]
        assert response.headers["Supple-Stopped"] == "converged" and float(response.headers["Supple-Seconds"]) > 0
    rows = list(csv.DictReader(io.StringIO(files[CSV].text)))
    assert [float(row["share"]) for row in rows] == [0.5, 1] and rows[0]["stopped"] == "converged"
    for row, state in zip(rows, answer["states"]):
        for k, support in enumerate(state["supports"]):
            assert [float(row[f"force_{axis}_{k}"]) for axis in "xy"] == support["force"]
            assert [float(row[f"displacement_{axis}_{k}"]) for axis in "xy"] == support["displacement"]
    assert ElementTree.fromstring(files[SVG].content).tag.endswith("svg")
    assert ElementTree.fromstring(files[VTU].content).attrib["type"] == "UnstructuredGrid"
    assert files[OBJ].text.startswith("o part")
    refused = api.post(SIMULATIONS, document, headers={"Accept": "model/stl"})
    assert (refused.status_code, problem_code(refused)) == (406, "http.not_acceptable")


def test_a_long_path_is_a_job_that_shows_its_latest_state(api: Api) -> None:
    document = request(BLOCK, strain=-0.1, states=40)
    job = start_job(api, SIMULATIONS, document)
    seen = list(events(api, job))
    assert seen[-1][0] == "finished" and seen[-1][1]["state"] == "successful"
    shares = [document["progress"] for _, document in seen]
    assert shares == sorted(shares) and shares[-1] == 1
    partial = [event["partial"] for _, event in seen if "partial" in event]
    numbers = [one["number"] for one in partial]
    assert numbers and numbers == sorted(numbers) and all(one["states"] == 40 for one in partial)
    result = api.get(f"/v1/jobs/{job}/result").json()
    for one in partial:
        assert one["state"] == result["states"][one["number"] - 1]


def test_delete_dismisses_a_running_simulation_within_a_moment(api: Api) -> None:
    job = start_job(api, SIMULATIONS, long_request())
    comes_true(lambda: "partial" in api.get(f"/v1/jobs/{job}").json(), "the first state", 300)
    assert api.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
    ends_within(api.server.pid, api.busy, 2, "the computation goes on")


def test_a_deadline_ends_a_simulation(api: Api) -> None:
    work = WorkingTime(api.server.pid)
    response = api.post(SIMULATIONS, long_request(deadline=1.5))
    work.check(10, "the computation goes on")
    assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")


def test_a_job_outlives_the_server(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    server = new_server("--workers", "1", "--max-attempts", "100")
    api = Api(server, contract)
    document = request(BLOCK, strain=-0.1, states=40)
    expected = api.ok(SIMULATIONS, document)
    job = start_job(api, SIMULATIONS, document)
    api.wait_for_job(job, ("running", "successful"))
    server.kill()
    server.start()
    again = Api(server, contract)
    assert again.wait_for_job(job)["state"] == "successful"
    assert again.get(f"/v1/jobs/{job}/result").json()["states"] == expected["states"]


PLATE = {"kind": "plate", "side": "top"}
BELOW = {"kind": "plate", "side": "bottom"}
BAD_SUPPORTS: List[Tuple[str, List[Dict[str, Any]], str, str]] = [
    ("a-rigid-motion", [{**PLATE, "friction": "stick", "gap": 0.5}, {"kind": "plate", "side": "left"}], "/supports", "along y"),
    ("free-to-turn", [{**PLATE, "gap": 0.5}, {**BELOW, "gap": 0.5}], "/supports", "free to"),
    ("nothing-in-the-box", [FOOT, {"kind": "clamp", "box": [[20, 0], [25, 5]]}], "/supports/1/box", "at least 2"),
    ("a-box-upside-down", [{"kind": "clamp", "box": [[16, 1], [-1, -1]]}], "/supports/0/box", "lesser"),
    ("two-clamps-for-one-point", [FOOT, {"kind": "clamp", "box": [[-1, -1], [16, 1]]}], "/supports/1/box", "support 0"),
    ("two-plates-along-a-side", [FOOT, PLATE, PLATE], "/supports/2/side", "support 1"),
    ("a-plate-far-away", [FOOT, {**PLATE, "gap": 100}], "/supports/1/gap", "15 mm"),
    ("inside-out", [FOOT, {**PLATE, "displacement": [0, -16]}], "/supports/1/displacement", "15 mm"),
    ("into-a-clamp", [FOOT, {**PLATE, "displacement": [0, -14.9]}], "/supports/1/displacement", "support 0"),
    ("through-a-plate", [{**BELOW, "displacement": [0, 8]}, {**PLATE, "displacement": [0, -8]}], "/supports/1/displacement", "support 0"),
]


@pytest.mark.parametrize("supports, pointer, limit", [case[1:] for case in BAD_SUPPORTS], ids=[case[0] for case in BAD_SUPPORTS])
def test_a_problem_names_the_support_and_the_limit(api: Api, supports: List[Dict[str, Any]], pointer: str, limit: str) -> None:
    response = api.post(SIMULATIONS, request(SHEET, supports=supports))
    assert (response.status_code, problem_code(response)) == (422, "simulation.invalid_load"), response.text
    assert pointers(response)[0] == pointer, response.text
    assert limit in response.json()["errors"][0]["detail"], response.text


@pytest.mark.parametrize("fields, expected", [
    ({"supports": [{**PLATE, "gap": -1}]}, ["/supports/0/gap"]), ({"supports": []}, ["/supports"]),
    ({"supports": [{"kind": "plate", "side": "above"}]}, ["/supports/0/side"]),
    ({"supports": [{"kind": "clamp", "box": [[0, 0]]}]}, ["/supports/0/box"]),
    ({"supports": [{**FOOT, "displacement": [0, 0, 1]}]}, ["/supports/0/displacement"]),
    ({"supports": [{**FOOT, "side": "top"}]}, ["/supports/0/side"]),
    ({"supports": [FOOT], "strain": 0.1}, ["/strain"]), ({"strain": 0.1}, ["/supports"]),
    ({"supports": [FOOT], "states": 0}, ["/states"]), ({"supports": [FOOT], "deformed": "svg"}, ["/deformed"]),
    ({"supports": [FOOT], "accuracy": {"pressure_length": 0}}, ["/accuracy/pressure_length"]),
    ({"supports": [FOOT], "accuracy": {"mesh_region": "tile"}}, ["/accuracy/mesh_region"]),
    ({"supports": [FOOT], "effects": {"patch": "on"}}, ["/effects/patch"]),
    ({"supports": [FOOT], "material": {"density": 1}}, ["/material/density"]),
    ({"supports": [FOOT], "part": {**SHEET, "material": {"density": 1}, "deadline": 3}}, ["/part/material", "/part/deadline"]),
    ({"supports": [FOOT], "part": {**SHEET, "outline": {"rectangle": [0, 15]}}}, ["/part/outline/rectangle/0"]),
    ({"part": {**BLOCK, "axis": 1}}, ["/part/axis"]), ({"part": BLOCK, "strain": 0.1}, ["/strain"]),
], ids=lambda value: json.dumps(value)[:60])
def test_a_field_outside_its_range_is_pointed_to(api: Api, fields: Dict[str, Any], expected: List[str]) -> None:
    response = api.post(SIMULATIONS, {**request(SHEET), **fields}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid"), response.text
    assert sorted(pointers(response)) == sorted(expected)


def test_faults_of_the_part_are_pointed_to_within_it(api: Api) -> None:
    crossing = {"outline": {"polygons": [[[0, 0], [10, 10], [10, 0], [0, 10]]]}, "structure": IH01}
    response = api.post(SIMULATIONS, request(crossing, supports=[FOOT]))
    assert (response.status_code, problem_code(response)) == (422, "tiling.part")
    assert pointers(response)[0] == "/part/outline/polygons/0"
    response = api.post(SIMULATIONS, request({**BLOCK, "structure": {"family": "IH99"}}))
    assert (response.status_code, pointers(response)) == (404, ["/part/structure/family"])


def test_a_part_that_lost_an_end_is_not_supported_by_default(api: Api) -> None:
    broken = {"outline": {"block": {"width": 10, "height": 60, "plate": 3}}, "structure": {"family": "IH21"}, "beam_width": 0.8}
    response = api.post(SIMULATIONS, request(broken))
    assert (response.status_code, problem_code(response)) == (422, "simulation.invalid_load"), response.text
    assert pointers(response) == ["/part/outline"] and "plate is missing" in response.json()["detail"]


def test_a_mesh_of_more_than_the_memory_is_refused_before_it_is_made(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    server = new_server("--max-request-memory", "64M")
    api = Api(server, contract)
    work = WorkingTime(server.pid)
    response = api.post(SIMULATIONS, request({**BLOCK, "outline": {"block": {"width": 30, "height": 30}}}, accuracy={"mesh_size": 0.5}))
    work.check(10, "the mesh is made")
    assert (response.status_code, problem_code(response)) == (413, "request.too_much_memory"), response.text
    problem = response.json()
    assert problem["limit"] == 64 * 2**20 and problem["value"] > problem["limit"] and problem["setting"] == "--max-request-memory"
    assert pointers(response) == ["/accuracy/mesh_size"]


def test_a_mesh_of_more_nodes_than_the_limit_is_refused_before_it_is_made(api: Api) -> None:
    response = api.post(SIMULATIONS, request({**BLOCK, "outline": {"block": {"width": 200, "height": 200}}}, accuracy={"mesh_size": 0.02}))
    assert problem_code(response) in ("request.limit_exceeded", "request.too_much_memory"), response.text
    assert pointers(response) == ["/accuracy/mesh_size"]


def test_no_more_deformed_nodes_than_the_limit(api: Api) -> None:
    response = api.post(SIMULATIONS, request(BLOCK, states=1000, deformed="json"))
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == ["/states"] and response.json()["limit"] == 1_000_000


def test_a_client_that_hangs_up_ends_the_computation(api: Api) -> None:
    with pytest.raises(requests.exceptions.Timeout):
        requests.post(api.server.url + SIMULATIONS, json=long_request(), timeout=2)
    ends_within(api.server.pid, api.busy, 3, "the computation goes on")
