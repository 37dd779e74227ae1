"""Simulations over HTTP: loads, states, deformed meshes, jobs, and refusals."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from typing import Any, Dict, List, Optional

import numpy as np
import pytest

from harness import Api, pointers, problem_code
from plane import polygon_area
from working_time import WorkingTime, comes_true, ends_within
from test_jobs import events, start_job

SIMULATIONS = "/v1/simulations"
COARSE = {"mesh_size": 1.0}


def request(load: Dict[str, Any], **more: Any) -> Dict[str, Any]:
    """A cheap simulation of IH01 on a coarse mesh."""
    return {"family": "IH01", "load": load, "accuracy": COARSE, **more}


def uniaxial(*stretches: float, direction: float = 0.0) -> Dict[str, Any]:
    return {"uniaxial": {"direction": direction, "stretches": list(stretches)}}


def long_request(**more: Any) -> Dict[str, Any]:
    """A simulation that takes seconds to minutes."""
    return {"family": "IH21", "load": uniaxial(*np.linspace(1.001, 1.4, 200).tolist()), "accuracy": {"mesh_size": 0.5},
            "effects": {"patch": "on"}, **more}


def coarse(family: str, parameters: "Optional[List[float]]" = None) -> Dict[str, Any]:
    """A simulation on so coarse a mesh that another mesh gives another energy."""
    document = {"family": family, "load": {"green_strain": [[0.02, 0.01, 0.005]]}, "accuracy": {"mesh_size": 1.0, "corner_size": 0.5}}
    return document if parameters is None else {**document, "parameters": parameters}


def tensor(components: List[float]) -> np.ndarray:
    xx, yy, xy = components
    return np.array([[xx, xy], [xy, yy]])


def converged(api: Api, document: Dict[str, Any]) -> Dict[str, Any]:
    answer = api.ok(SIMULATIONS, document)
    assert answer["message"] == "" and answer["states"]
    assert {state["stopped"] for state in answer["states"]} == {"converged"}
    return answer  # type: ignore[no-any-return]


def test_a_green_strain_is_imposed_exactly(api: Api) -> None:
    strains = [[0.02, 0.0, 0.0], [0.04, -0.01, 0.015]]
    answer = converged(api, request({"green_strain": strains}))
    for strain, state in zip(strains, answer["states"]):
        np.testing.assert_allclose(state["green_strain"], strain, atol=1e-12)
        f = np.array(state["deformation_gradient"])
        np.testing.assert_allclose((f.T @ f - np.eye(2)) / 2, tensor(strain), atol=1e-12)
        assert f[0, 1] == pytest.approx(f[1, 0], abs=1e-12), "no macroscopic rotation"
        assert state["residual"] <= answer["accuracy"]["tolerance"]
        assert state["smallest_jacobian"] > 0 and state["energy_density"] > 0


def test_rest_costs_no_energy(api: Api) -> None:
    (state,) = converged(api, request({"green_strain": [[0, 0, 0]]}))["states"]
    assert state["energy_density"] == pytest.approx(0, abs=1e-14)
    np.testing.assert_allclose(state["stress"], 0, atol=1e-9)
    assert np.linalg.eigvalsh(np.array(state["tangent"])).min() > 0


def test_the_same_question_has_the_same_answer_whatever_was_asked_before(api: Api) -> None:
    # If two triangles have equal size, the mesh generator takes the one with the lower address, and addresses depend on memory that was freed
    # before. The first structure once had 361 nodes after IH01, and 369 after IH21.
    question = coarse("IH01", [0.2331585676037134, 0.3836024173334007, 0.05851961954813489, 0.42516703505397263])
    first = converged(api, question)
    for other in ("IH21", "IH01", "IH50", "IH67"):
        converged(api, coarse(other))
        again = converged(api, question)
        assert (again["accuracy"], again["states"]) == (first["accuracy"], first["states"]), f"after {other}"
    rng = np.random.default_rng(1)
    bounds = {family["id"]: family["parameters"] for family in api.get("/v1/families").json()["families"]}

    def drawn(family: str) -> Dict[str, Any]:
        """A request with random parameters in the middle half of the bounds, where every structure is valid."""
        low, high = (np.array(bounds[family][end]) for end in ("lower", "upper"))
        return coarse(family, (low + (high - low) * rng.uniform(0.25, 0.75, size=len(low))).tolist())

    for family in ("IH01", "IH21", "IH28", "IH29", "IH50", "IH67"):
        question = drawn(family)
        first = converged(api, question)
        converged(api, drawn(str(rng.choice(list(bounds)))))
        again = converged(api, question)
        assert (again["accuracy"], again["states"]) == (first["accuracy"], first["states"]), question


@pytest.mark.parametrize("direction", [0.0, 0.7])
def test_uniaxial_loads_leave_the_lateral_sides_free(api: Api, direction: float) -> None:
    d, n = np.array([np.cos(direction), np.sin(direction)]), np.array([-np.sin(direction), np.cos(direction)])
    stretches = [1.02, 1.05]
    for stretch, state in zip(stretches, converged(api, request(uniaxial(*stretches, direction=direction)))["states"]):
        f = np.array(state["deformation_gradient"])
        np.testing.assert_allclose(f.T @ d, stretch * d, atol=1e-12)
        traction = f @ tensor(state["stress"])
        scale = abs(d @ traction @ d)
        assert scale > 0 and abs(n @ traction @ d) < 1e-5 * scale and abs(n @ traction @ n) < 1e-5 * scale


def test_biaxial_loads_impose_both_stretches(api: Api) -> None:
    direction, pairs = 0.4, [[1.02, 0.99], [1.04, 1.01]]
    d, n = np.array([np.cos(direction), np.sin(direction)]), np.array([-np.sin(direction), np.cos(direction)])
    answer = converged(api, request({"biaxial": {"direction": direction, "stretches": pairs}}))
    for (along, across), state in zip(pairs, answer["states"]):
        expected = along * np.outer(d, d) + across * np.outer(n, n)
        np.testing.assert_allclose(state["deformation_gradient"], expected, atol=1e-12)


def test_stress_and_tangent_are_derivatives_of_the_energy(api: Api) -> None:
    step = 1e-4
    strains = [[0.03 - step, 0.01, 0.005], [0.03, 0.01, 0.005], [0.03 + step, 0.01, 0.005]]
    answer = converged(api, request({"green_strain": strains}, accuracy={**COARSE, "tolerance": 1e-11}))
    before, middle, after = answer["states"]
    slope = (after["energy_density"] - before["energy_density"]) / (2 * step)
    assert middle["stress"][0] == pytest.approx(slope, rel=1e-5)
    difference = (np.array(after["stress"]) - np.array(before["stress"])) / (2 * step)
    tangent = np.array(middle["tangent"])
    np.testing.assert_allclose(tangent[:, 0], difference, rtol=1e-4, atol=1e-4 * abs(difference).max())
    np.testing.assert_allclose(tangent, tangent.T, rtol=1e-9, atol=1e-9 * abs(tangent).max())


def test_twice_the_modulus_is_twice_the_stress(api: Api) -> None:
    load = {"green_strain": [[0.02, 0.01, 0.0]]}
    soft, stiff = (converged(api, request(load, material={"youngs_modulus": modulus}))["states"][0] for modulus in (13, 26))
    np.testing.assert_allclose(stiff["stress"], 2 * np.array(soft["stress"]), rtol=1e-6, atol=1e-12)
    (default,) = converged(api, request(load))["states"]
    assert default["stress"] == stiff["stress"], "26 MPa is the default"
    (incompressible,) = converged(api, request(load, material={"law": "incompressible_plane_stress"}))["states"]
    assert abs(incompressible["stress"][0] / stiff["stress"][0] - 1) > 0.01


def test_the_answer_says_what_ran_and_what_was_reached(api: Api) -> None:
    answer = converged(api, request(uniaxial(1.02), effects={"contact": "off", "patch": "off"}))
    effects = {effect["name"]: effect for effect in answer["effects"]}
    assert {"contact", "patch", "buckling"} <= set(effects)
    assert not effects["contact"]["ran"] and not effects["patch"]["ran"]
    assert all(effect["why"] for effect in effects.values())
    accuracy = answer["accuracy"]
    assert accuracy["mesh_size"] == 1 and accuracy["corner_size"] == 0.1 and accuracy["tolerance"] == 1e-8
    assert accuracy["residual"] == max(state["residual"] for state in answer["states"]) <= 1e-8
    assert accuracy["nodes"] > 10 and accuracy["triangles"] > 10 and accuracy["unknowns"] >= 2 * accuracy["nodes"] - 2
    assert {"meshing", "assembly", "factorization"} <= {stage["name"] for stage in answer["cost"]["stages"]}
    (state,) = answer["states"]
    assert state["cells"] == 1 and state["contacts"] == 0 and state["smallest_gap"] is None


def test_the_contract_names_the_defaults_that_the_server_has(api: Api) -> None:
    schemas = api.contract.spec["components"]["schemas"]
    load = {"green_strain": [[0.001, 0, 0]]}
    answer = converged(api, {"family": "IH01", "load": load})
    defaults = schemas["SimulationRequest"]["properties"]["accuracy"]["properties"]
    assert answer["accuracy"]["tolerance"] == defaults["tolerance"]["default"]
    assert f"it is {answer['accuracy']['mesh_size']:g}," in defaults["mesh_size"]["description"]
    assert f"otherwise {answer['accuracy']['corner_size']:g}." in defaults["corner_size"]["description"]
    given = converged(api, {"family": "IH01", "load": load, "accuracy": {"mesh_size": 0.5}})
    assert given["accuracy"]["corner_size"] == schemas["CornerSize"]["default"]


def norm(components: List[float]) -> float:
    return float(np.linalg.norm(tensor(components)))


FINE = {"mesh_size": 0.2, "corner_size": 0.03}


@pytest.mark.parametrize("stretches", [[1.02, 1.06], [0.99, 0.98]], ids=["tension", "compression"])
def test_a_default_simulation_says_its_error_and_errs_by_less(api: Api, stretches: List[float]) -> None:
    load = uniaxial(*stretches, direction=0.4)
    answer = converged(api, {"family": "IH22", "load": load})
    fine = converged(api, {"family": "IH22", "load": load, "accuracy": FINE, "effects": {"refinement": "off"}})
    accuracy = answer["accuracy"]
    assert accuracy["extrapolated"] and accuracy["accepted_error"] is None and accuracy["error_accepted"] is None
    assert 0 < accuracy["discretization_error"]["stress"] < 0.01 and 0 < accuracy["discretization_error"]["energy"] < 0.01
    for state, wanted in zip(answer["states"], fine["states"]):
        error = norm(np.subtract(state["stress"], wanted["stress"]).tolist())
        assert error < 0.005 * norm(wanted["stress"]) and error < state["stress_error"]
        assert abs(state["energy_density"] - wanted["energy_density"]) < state["energy_density_error"]
    relative = [sum(norm(s["stress"]) ** 2 for s in answer["states"]), sum(s["stress_error"] ** 2 for s in answer["states"])]
    assert accuracy["discretization_error"]["stress"] == pytest.approx((relative[1] / relative[0]) ** 0.5, rel=1e-9)
    (effect,) = [effect for effect in answer["effects"] if effect["name"] == "refinement"]
    assert effect["ran"] and effect["count"] == 2 and effect["seconds"] > 0


def test_a_mesh_that_is_given_keeps_its_states_and_its_error_is_said(api: Api) -> None:
    document = request(uniaxial(1.02, 1.05))
    said = converged(api, document)
    plain = converged(api, {**document, "effects": {"refinement": "off"}})
    fine = converged(api, request(uniaxial(1.02, 1.05), accuracy=FINE, effects={"refinement": "off"}))
    extrapolated = converged(api, {**document, "effects": {"refinement": "on"}})
    assert not said["accuracy"]["extrapolated"] and extrapolated["accuracy"]["extrapolated"]
    for a, b, c, better in zip(said["states"], plain["states"], fine["states"], extrapolated["states"]):
        assert a["stress"] == b["stress"] and a["energy_density"] == b["energy_density"] and a["tangent"] == b["tangent"]
        assert b["stress_error"] is None and b["energy_density_error"] is None
        error = norm(np.subtract(b["stress"], c["stress"]).tolist())
        assert error < a["stress_error"] < 4 * error
        assert norm(np.subtract(better["stress"], c["stress"]).tolist()) < error / 2
    assert plain["accuracy"]["discretization_error"] is None
    (effect,) = [effect for effect in plain["effects"] if effect["name"] == "refinement"]
    assert not effect["ran"] and "request" in effect["why"]


def test_a_request_may_name_the_error_that_it_accepts(api: Api) -> None:
    sizes = []
    for accepted in (0.02, 0.001):
        accuracy = converged(api, request(uniaxial(1.03), accuracy={"discretization_error": accepted}))["accuracy"]
        assert accuracy["accepted_error"] == accepted and accuracy["error_accepted"] and accuracy["extrapolated"]
        assert accuracy["discretization_error"]["stress"] <= accepted
        sizes.append(accuracy["mesh_size"])
    assert sizes[1] < sizes[0]


def test_a_mesh_size_wins_over_an_accepted_error_and_the_error_is_still_said(api: Api) -> None:
    both = {"mesh_size": 1.0, "discretization_error": 0.0005}
    answer = converged(api, request(uniaxial(1.03), accuracy=both))
    accuracy = answer["accuracy"]
    assert accuracy["mesh_size"] == 1 and not accuracy["extrapolated"]
    assert accuracy["discretization_error"]["stress"] > 0.0005 and accuracy["error_accepted"] is False
    assert answer["states"][0]["stress"] == converged(api, request(uniaxial(1.03)))["states"][0]["stress"]


def test_an_error_cannot_be_named_where_it_is_not_looked_for(api: Api) -> None:
    document = request(uniaxial(1.03), accuracy={"discretization_error": 0.01}, effects={"refinement": "off"})
    response = api.post(SIMULATIONS, document)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == ["/accuracy/discretization_error"]


def test_a_patch_of_two_by_two_cells_is_used_where_it_is_asked_for(api: Api) -> None:
    one, four = (converged(api, request(uniaxial(1.02), effects={"patch": patch})) for patch in ("off", "on"))
    assert (one["states"][0]["cells"], four["states"][0]["cells"]) == (1, 2)
    assert four["accuracy"]["unknowns"] > 3 * one["accuracy"]["unknowns"]
    np.testing.assert_allclose(four["states"][0]["stress"], one["states"][0]["stress"], rtol=1e-5, atol=1e-7)


def test_tangents_are_left_out_on_request(api: Api) -> None:
    (state,) = converged(api, request(uniaxial(1.02), tangents=False))["states"]
    assert state["tangent"] is None


def test_equal_requests_have_equal_answers(api: Api) -> None:
    document = request(uniaxial(0.98, 0.95), deformed="json")
    first, second = (api.ok(SIMULATIONS, document) for _ in range(2))
    assert first["states"] == second["states"] and first["meshes"] == second["meshes"]


def test_deformed_meshes_are_periodic_and_without_inverted_triangles(api: Api) -> None:
    answer = converged(api, request(uniaxial(1.03, 0.97), deformed="json", effects={"patch": "off"}))
    (mesh,) = answer["meshes"]
    triangles, rest = np.array(mesh["triangles"]), np.array(mesh["points"])
    assert mesh["cells"] == 1 and len(triangles) == answer["accuracy"]["triangles"]
    assert len(rest) > answer["accuracy"]["nodes"], "points on opposite sides are both there"
    density = sum(polygon_area(rest[t[:3]]) for t in triangles) / abs(np.linalg.det(np.array(mesh["lattice"])))
    structure = api.ok("/v1/structures", {"family": "IH01"})
    assert density == pytest.approx(structure["relative_density"], rel=1e-4)
    np.testing.assert_allclose(rest[triangles[:, 3:]], (rest[triangles[:, :3]] + rest[triangles[:, [1, 2, 0]]]) / 2, atol=1e-12)
    for state in answer["states"]:
        deformed, f = state["deformed"], np.array(state["deformation_gradient"])
        points = np.array(deformed["points"])
        assert deformed["mesh"] == 0 and points.shape == rest.shape
        np.testing.assert_allclose(deformed["lattice"], np.array(mesh["lattice"]) @ f.T, atol=1e-9)
        assert min(polygon_area(points[t[[0, 3, 1, 4, 2, 5]]]) for t in triangles) > 0
        # The displacement without its macroscopic part is periodic: corresponding nodes on opposite sides have the same.
        fluctuation = points - rest @ f.T
        for translation in np.array(mesh["lattice"]):
            for i, point in enumerate(rest):
                partner = np.flatnonzero(np.linalg.norm(rest - point - translation, axis=1) < 1e-9)
                for j in partner:
                    np.testing.assert_allclose(fluctuation[i], fluctuation[j], atol=1e-9)


def vtu_array(piece: ElementTree.Element, name: str) -> np.ndarray:
    (array,) = [a for a in piece.iter("DataArray") if a.attrib.get("Name") == name]
    return np.array((array.text or "").split(), dtype=float)


def test_a_vtu_file_has_the_points_triangles_displacements_and_energies(api: Api) -> None:
    # There is only elastic energy, since there is no contact at this strain.
    document = request(uniaxial(1.03), effects={"patch": "off"})
    as_json = converged(api, {**document, "deformed": "json"})
    (state,) = converged(api, {**document, "deformed": "vtu"})["states"]
    root = ElementTree.fromstring(state["vtu"])
    assert root.tag == "VTKFile" and root.attrib["type"] == "UnstructuredGrid"
    (piece,) = root.iter("Piece")
    (mesh,) = as_json["meshes"]
    rest, triangles = np.array(mesh["points"]), np.array(mesh["triangles"])
    assert int(piece.attrib["NumberOfPoints"]) == len(rest) and int(piece.attrib["NumberOfCells"]) == len(triangles)
    points = vtu_array(piece, "Points").reshape(-1, 3)
    displacement = vtu_array(piece, "displacement").reshape(-1, 3)
    np.testing.assert_array_equal(points[:, :2], rest)
    assert not points[:, 2].any() and not displacement[:, 2].any()
    moved = np.array(as_json["states"][0]["deformed"]["points"])
    np.testing.assert_allclose((points + displacement)[:, :2], moved, atol=1e-12)
    np.testing.assert_array_equal(vtu_array(piece, "connectivity").reshape(-1, 6), triangles)
    np.testing.assert_array_equal(vtu_array(piece, "offsets"), 6 * np.arange(1, len(triangles) + 1))
    assert set(vtu_array(piece, "types")) == {22}, "quadratic triangles"
    areas = np.array([polygon_area(rest[t[:3]]) for t in triangles])
    energy = vtu_array(piece, "energy_density") @ areas / abs(np.linalg.det(np.array(mesh["lattice"])))
    assert energy == pytest.approx(state["energy_density"], rel=1e-9)


def test_no_more_deformed_nodes_than_the_limit(api: Api) -> None:
    document = {"family": "IH50", "load": {"green_strain": [[0, 0, 0]] * 1000}, "deformed": "json"}
    response = api.post(SIMULATIONS, document)
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == ["/deformed"] and response.json()["limit"] == 1_000_000


def test_a_long_path_is_a_job_that_shows_rising_progress(api: Api) -> None:
    stretches = np.linspace(1.0, 1.1, 60).tolist()
    job = start_job(api, SIMULATIONS, request(uniaxial(*stretches)))
    seen = list(events(api, job))
    assert seen[-1][0] == "finished" and seen[-1][1]["state"] == "successful"
    assert all(document["kind"] == "simulations" and "mesh" not in document for _, document in seen)
    shares = [document["progress"] for _, document in seen]
    assert shares == sorted(shares) and shares[-1] == 1
    result = api.get(f"/v1/jobs/{job}/result").json()
    assert len(result["states"]) == 60
    assert result["states"] == api.ok(SIMULATIONS, request(uniaxial(*stretches)))["states"]


def test_delete_dismisses_a_running_simulation_within_a_moment(api: Api) -> None:
    job = start_job(api, SIMULATIONS, long_request())
    comes_true(lambda: api.get(f"/v1/jobs/{job}").json()["progress"] > 0, "the first state", 180)
    assert api.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
    ends_within(api.server.pid, api.busy, 3, "the computation goes on")


def test_a_deadline_ends_a_simulation(api: Api) -> None:
    work = WorkingTime(api.server.pid)
    response = api.post(SIMULATIONS, long_request(deadline=1.5))
    work.check(10, "the computation goes on")
    assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")


def test_a_state_that_cannot_be_imposed_is_pointed_to(api: Api) -> None:
    response = api.post(SIMULATIONS, request({"green_strain": [[0, 0, 0], [-0.6, 0, 0]]}))
    assert (response.status_code, problem_code(response)) == (422, "simulation.invalid_load")
    assert pointers(response)[0] == "/load/green_strain/1"


def test_more_states_than_the_limit_are_refused_with_the_setting(api: Api) -> None:
    response = api.post(SIMULATIONS, request({"green_strain": [[0, 0, 0]] * 1001}), faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == ["/load/green_strain"] and response.json()["setting"] == "--max-states"


LOADS = [
    ({}, ["/load"]), (7, ["/load"]), ({"green_strain": []}, ["/load/green_strain"]),
    ({"green_strain": [[0, 0, 0]], "uniaxial": {"direction": 0, "stretches": [1]}}, ["/load"]),
    ({"green_strain": [[0, 0]]}, ["/load/green_strain/0"]), ({"green_strain": [[0, 0, None]]}, ["/load/green_strain/0/2"]),
    ({"uniaxial": {"stretches": [1]}}, ["/load/uniaxial/direction"]),
    ({"uniaxial": {"direction": 0}}, ["/load/uniaxial/stretches"]),
    ({"uniaxial": {"direction": 0, "stretches": [1.1, 0, -1, 9]}},
     ["/load/uniaxial/stretches/1", "/load/uniaxial/stretches/2", "/load/uniaxial/stretches/3"]),
    ({"biaxial": {"direction": 0, "stretches": [1.1]}}, ["/load/biaxial/stretches/0"]),
    ({"biaxial": {"direction": 0, "stretches": [[1.1, 0]]}}, ["/load/biaxial/stretches/0/1"]),
    ({"shear": [1]}, ["/load", "/load/shear"]),
]


@pytest.mark.parametrize("load, expected", LOADS, ids=[json.dumps(load) for load, _ in LOADS])
def test_what_is_no_load_is_refused(api: Api, load: Any, expected: List[str]) -> None:
    response = api.post(SIMULATIONS, request(load), faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == expected


@pytest.mark.parametrize("fields, pointer", [
    ({"material": {"law": "steel"}}, "/material/law"), ({"material": {"youngs_modulus": 0}}, "/material/youngs_modulus"),
    ({"material": {"poisson_ratio": 0.5}}, "/material/poisson_ratio"), ({"material": {"density": 1}}, "/material/density"),
    ({"accuracy": {"mesh_size": 0}}, "/accuracy/mesh_size"), ({"accuracy": {"tolerance": 1}}, "/accuracy/tolerance"),
    ({"accuracy": {"corner_size": 0}}, "/accuracy/corner_size"),
    ({"accuracy": {"discretization_error": 0}}, "/accuracy/discretization_error"),
    ({"accuracy": {"discretization_error": 0.2}}, "/accuracy/discretization_error"),
    ({"effects": {"refinement": True}}, "/effects/refinement"),
    ({"accuracy": {"max_iterations": 0}}, "/accuracy/max_iterations"),
    ({"accuracy": {"max_load_step": 0}}, "/accuracy/max_load_step"), ({"effects": {"contact": True}}, "/effects/contact"),
    ({"effects": {"patch": "2x2"}}, "/effects/patch"), ({"effects": {"gravity": "on"}}, "/effects/gravity"),
    ({"tangents": 1}, "/tangents"), ({"deformed": "obj"}, "/deformed"), ({"deadline": -1}, "/deadline"),
], ids=lambda value: str(value))
def test_a_field_outside_its_range_is_pointed_to(api: Api, fields: Dict[str, Any], pointer: str) -> None:
    response = api.post(SIMULATIONS, request(uniaxial(1.1), **fields), faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == [pointer]


def test_parameters_out_of_bounds_are_pointed_to_before_anything_is_computed(api: Api) -> None:
    document = request(uniaxial(1.1), parameters=[0.9, 0.5, 0.1, 0.6])
    response = api.post(SIMULATIONS, document, headers={"Prefer": "respond-async"})
    assert (response.status_code, problem_code(response)) == (422, "tiling.parameter_out_of_bounds")
    assert pointers(response) == ["/parameters/0"]
