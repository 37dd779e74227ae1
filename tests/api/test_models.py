"""Neural models over HTTP: descriptions, evaluations, uniaxial loads, changes of files, and refusals."""

from __future__ import annotations

import json
import shutil
import time
from pathlib import Path
from typing import Any, Callable, Dict, List

import numpy as np
import pytest
import requests

from contract import Contract
from harness import Api, ServerProcess, make_model, pointers, problem_code
from working_time import PATIENCE_SECONDS
from test_jobs import start_job

MODEL = "/v1/models/ih21"
EVALUATIONS = f"{MODEL}/evaluations"
UNIAXIAL = f"{MODEL}/uniaxial"
DESIGN = [0.15, 0.65]
STRAIN = [0.04, -0.02, 0.015]
NewServer = Callable[..., ServerProcess]


def evaluation(strains: List[List[float]], designs: Any = None, **more: Any) -> Dict[str, Any]:
    return {"parameters": designs or [DESIGN], "green_strain": strains, **more}


def answers(document: Dict[str, Any]) -> Dict[str, Any]:
    """The parts of an answer that are equal for equal computations."""
    return {name: value for name, value in document.items() if name != "cost"}


def soon(condition: Callable[[], bool], seconds: float = 300) -> bool:
    """Waits until the server has read its folder again and the condition is true."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


# --- descriptions --------------------------------------------------------------------------------------------------


def test_models_are_listed_and_described_alike(api: Api) -> None:
    (listed,) = api.get("/v1/models").json()["models"]
    shown = api.get(MODEL)
    assert shown.json() == listed and listed["id"] == "ih21" and listed["family"] == "IH21"
    assert listed["parameters"] == {"lower": [0.105, 0.505], "upper": [0.195, 0.795]}
    assert listed["errors"]["design_split"]["samples"] == 300 and listed["errors"]["row_split"] is None
    assert listed["network"]["width"] == 16 and listed["provenance"]["options"] == {"kind": "random"}
    family = api.get("/v1/families/IH21").json()["parameters"]
    assert {name: family[name] for name in ("lower", "upper")} == listed["parameters"]


def test_the_tag_of_a_model_is_its_file(api: Api) -> None:
    response = api.get(MODEL)
    tag = response.headers["ETag"]
    assert tag == f'"{response.json()["sha256"]}"'
    current = api.get(MODEL, headers={"If-None-Match": tag})
    assert (current.status_code, current.content, current.headers["ETag"]) == (304, b"", tag)
    assert api.get(MODEL, headers={"If-None-Match": '"other"'}).status_code == 200


@pytest.mark.parametrize("method, path", [
    ("GET", "/v1/models/ih99"), ("POST", "/v1/models/ih99/evaluations"), ("POST", "/v1/models/ih99/uniaxial")])
def test_an_unknown_model_is_not_found_and_the_known_are_named(api: Api, method: str, path: str) -> None:
    body = b"{}" if method == "POST" else None
    response = api.call(method, path, body=body, headers={"Content-Type": "application/json"} if body else {}, faulty=True)
    assert (response.status_code, problem_code(response)) == (404, "model.not_found")
    assert "ih21" in response.json()["detail"]


def test_the_metrics_count_models_and_evaluated_strains(api: Api) -> None:
    series = 'supple_model_evaluations_total{model="ih21"}'
    before = api.server.metrics().get(series, 0)
    api.ok(EVALUATIONS, evaluation([STRAIN] * 7))
    api.ok(UNIAXIAL, {"parameters": DESIGN, "direction": 0, "stretches": [1.01, 1.02]})
    after = api.server.metrics()
    assert after[series] == before + 9 and after["supple_models_loaded"] == 1
    assert api.get("/readyz").json()["models_loaded"] == 1


# --- evaluations -----------------------------------------------------------------------------------------------------


def test_rest_costs_no_energy(api: Api) -> None:
    answer = api.ok(EVALUATIONS, evaluation([[0, 0, 0]], derivatives=2))
    assert answer["energy_density"] == pytest.approx([0], abs=1e-15)
    np.testing.assert_allclose(answer["stress"], 0, atol=1e-13)
    assert np.linalg.eigvalsh(np.array(answer["tangent"][0])).min() > 0


def test_stresses_are_derivatives_of_the_energy_by_tensor_components(api: Api) -> None:
    step = 1e-5
    moved = [list(np.array(STRAIN) + sign * step * np.eye(3)[k]) for k in range(3) for sign in (1, -1)]
    answer = api.ok(EVALUATIONS, evaluation([STRAIN, *moved]))
    energy = np.array(answer["energy_density"][1:]).reshape(3, 2)
    slope = (energy[:, 0] - energy[:, 1]) / (2 * step)
    # A change of E_xy changes E_yx too, so that the derivative of the energy is twice the stress.
    np.testing.assert_allclose(answer["stress"][0], slope / [1, 1, 2], rtol=1e-7, atol=1e-9 * abs(slope).max())


def test_tangents_are_derivatives_of_the_stress_by_twice_the_shear(api: Api) -> None:
    step = 1e-5
    moved = [list(np.array(STRAIN) + sign * step * np.eye(3)[k]) for k in range(3) for sign in (1, -1)]
    answer = api.ok(EVALUATIONS, evaluation([STRAIN, *moved], derivatives=2))
    stress = np.array(answer["stress"][1:]).reshape(3, 2, 3)
    slope = (stress[:, 0] - stress[:, 1]).T / (2 * step) / np.array([1, 1, 2])
    np.testing.assert_allclose(answer["tangent"][0], slope, rtol=1e-6, atol=1e-8 * abs(slope).max())


def test_what_was_not_asked_for_is_left_out(api: Api) -> None:
    energies, default, tangents = (api.ok(EVALUATIONS, evaluation([STRAIN], **more))
                                   for more in ({"derivatives": 0}, {}, {"derivatives": 2}))
    assert "stress" not in energies and "tangent" not in default and "stress" in default
    assert energies["energy_density"] == pytest.approx(tangents["energy_density"], rel=1e-13)
    np.testing.assert_allclose(default["stress"], tangents["stress"], rtol=1e-12)


def test_the_answer_names_the_file_and_what_it_cost(api: Api) -> None:
    answer = api.ok(EVALUATIONS, evaluation([STRAIN] * 5))
    assert answer["model"] == "ih21" and answer["sha256"] == api.get(MODEL).json()["sha256"]
    assert answer["cost"]["quantities"] == {"designs": 1, "strains": 5}
    assert {stage["name"] for stage in answer["cost"]["stages"]} == {"designs", "evaluation"}


def test_each_strain_has_its_own_design_and_equal_neighbours_are_prepared_once(api: Api) -> None:
    random = np.random.default_rng(7)
    designs = [[0.12, 0.6]] * 300 + [[0.15, 0.7]] * 50 + [[0.12, 0.6]] * 100
    strains = random.uniform(-0.05, 0.05, (len(designs), 3)).tolist()
    together = api.ok(EVALUATIONS, evaluation(strains, designs, derivatives=2))
    assert together["cost"]["quantities"] == {"designs": 3, "strains": 450}
    apart = [api.ok(EVALUATIONS, evaluation(strains[begin:end], [designs[begin]], derivatives=2))
             for begin, end in ((0, 300), (300, 350), (350, 450))]
    for name in ("energy_density", "stress", "tangent", "in_range"):
        expected = np.concatenate([np.array(part[name]) for part in apart])
        np.testing.assert_allclose(np.array(together[name], float), expected.astype(float), rtol=1e-11, atol=1e-13)
    assert together["energy_density"][0] != pytest.approx(api.ok(EVALUATIONS, evaluation([strains[0]], [[0.15, 0.7]]))
                                                          ["energy_density"][0], rel=1e-6), "designs matter"


def test_more_designs_than_are_held_at_once_keep_their_order(api: Api) -> None:
    designs = [[0.105 + 0.0001 * i, 0.6] for i in range(700)]
    together = api.ok(EVALUATIONS, evaluation([STRAIN] * 700, designs))
    assert together["cost"]["quantities"] == {"designs": 700, "strains": 700}
    for i in (0, 255, 256, 511, 512, 699):
        alone = api.ok(EVALUATIONS, evaluation([STRAIN], [designs[i]]))
        assert together["stress"][i] == pytest.approx(alone["stress"][0], rel=1e-11)


def test_equal_requests_have_equal_answers(api: Api) -> None:
    strains = np.random.default_rng(3).uniform(-0.1, 0.1, (1000, 3)).tolist()
    first, second = (api.ok(EVALUATIONS, evaluation(strains, derivatives=2)) for _ in range(2))
    assert answers(first) == answers(second)


def test_the_answer_says_what_lies_within_the_training(api: Api) -> None:
    strains = [[0, 0, 0], [0.001, 0, 0], [0.35, 0, 0], [-0.25, 0, 0], [0.02, 0.02, 0.3], [0.29, 0.29, 0]]
    inside = api.ok(EVALUATIONS, evaluation(strains))["in_range"]
    assert inside == [True, True, False, False, False, False], \
        "the last strain is allowed, its energy is not; that before has large principal strains"
    designs = [[0.105, 0.505], [0.195, 0.795], [0.1, 0.65], [0.15, 0.8]]
    assert api.ok(EVALUATIONS, evaluation([[0, 0, 0]] * 4, designs))["in_range"] == [True, True, False, False]


def test_stresses_have_error_bars_within_the_training(api: Api) -> None:
    answer = api.ok(EVALUATIONS, evaluation([[0.02, 0, 0], [0.35, 0, 0]]))
    assert answer["stress_error_bar"][0] == pytest.approx(0.08 * np.linalg.norm(answer["stress"][0]))
    assert answer["stress_error_bar"][1] is None and answer["in_range"] == [True, False]
    assert "stress_error_bar" not in api.ok(EVALUATIONS, evaluation([[0.02, 0, 0]], derivatives=0))
    load = {"parameters": [0.15, 0.65], "direction": 0.3, "green_strains": [0, 0.02, 3]}
    rest, state, far = api.ok(UNIAXIAL, load)["states"]
    assert rest["error_bar"] < 1e-15 and far["error_bar"] is None and not far["in_range"]
    assert state["error_bar"] == pytest.approx(0.02 * abs(state["directional_stress"])) and state["in_range"]


def test_the_most_strains_that_a_request_may_have_are_answered(api: Api) -> None:
    strains = np.random.default_rng(5).uniform(-0.05, 0.05, (100_000, 3)).round(6).tolist()
    body = json.dumps(evaluation(strains)).encode()
    # The answer is too large for a quick validation by the schema; it has the form of small answers.
    response = requests.post(api.server.url + EVALUATIONS, body, headers={"Content-Type": "application/json"}, timeout=PATIENCE_SECONDS)
    assert response.status_code == 200, response.text[:500]
    answer = response.json()
    assert len(answer["stress"]) == len(answer["in_range"]) == 100_000
    last = api.ok(EVALUATIONS, evaluation(strains[-1:]))
    assert answer["stress"][-1] == pytest.approx(last["stress"][0], rel=1e-11)


@pytest.mark.parametrize("field", ["green_strain", "parameters"])
def test_more_entries_than_the_limit_are_refused_with_the_setting(api: Api, field: str) -> None:
    document = evaluation([[0, 0, 0]])
    document[field] = document[field] * 100_001
    response = api.post(EVALUATIONS, document, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == [f"/{field}"] and response.json()["setting"] == "--max-strains"


def test_designs_that_fit_neither_the_model_nor_the_strains_are_pointed_to(api: Api) -> None:
    response = api.post(EVALUATIONS, evaluation([STRAIN] * 3, [DESIGN, [0.1], [0.1, 0.2, 0.3]]))
    assert (response.status_code, problem_code(response)) == (422, "model.parameter_count")
    assert pointers(response) == ["/parameters/1", "/parameters/2"]
    response = api.post(EVALUATIONS, evaluation([STRAIN] * 3, [DESIGN] * 2))
    assert (response.status_code, problem_code(response)) == (422, "model.design_count")
    assert pointers(response) == ["/parameters"]
    response = api.post(UNIAXIAL, {"parameters": [0.1], "direction": 0, "stretches": [1.1]})
    assert (response.status_code, problem_code(response)) == (422, "model.parameter_count")
    assert pointers(response) == ["/parameters"]


def test_a_value_that_overflows_is_an_error_and_no_number(
        new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    make_model(tmp_path / "models" / "huge.h5", "huge", gain=1e160)
    api = Api(new_server("--models", str(tmp_path / "models")), contract)
    path = "/v1/models/huge"
    response = api.post(f"{path}/evaluations", evaluation([[0, 0, 0], STRAIN], derivatives=0))
    assert (response.status_code, problem_code(response)) == (422, "model.not_finite")
    assert pointers(response) == ["/green_strain/1"]
    for derivatives in (1, 2):
        response = api.post(f"{path}/evaluations", evaluation([STRAIN], derivatives=derivatives))
        assert (response.status_code, problem_code(response)) == (422, "model.not_finite")
    response = api.post(f"{path}/uniaxial", {"parameters": DESIGN, "direction": 0, "stretches": [1.1]})
    assert (response.status_code, problem_code(response)) == (422, "model.not_finite")


def test_a_deadline_ends_an_evaluation(api: Api) -> None:
    strains = [[0.01, 0, 0]] * 100_000
    designs = [[0.12, 0.6], [0.15, 0.7]] * 50_000
    response = requests.post(api.server.url + EVALUATIONS, json=evaluation(strains, designs, derivatives=2, deadline=0.01),
                             timeout=PATIENCE_SECONDS)
    assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")


def test_computations_with_models_are_jobs_where_the_client_prefers_it(api: Api) -> None:
    uniaxial = {"parameters": DESIGN, "direction": 0.3, "stretches": [1.01, 1.02]}
    for path, kind, request in ((EVALUATIONS, "model-evaluations", evaluation([STRAIN] * 20, derivatives=2)),
                                (UNIAXIAL, "model-uniaxial", uniaxial)):
        job = start_job(api, path, request)
        document = api.wait_for_job(job)
        assert (document["state"], document["kind"], "mesh" in document) == ("successful", kind, False)
        assert answers(api.get(f"/v1/jobs/{job}/result").json()) == answers(api.ok(path, request))


EVALUATION_FAULTS = [
    ({}, ["/parameters", "/green_strain"]), (evaluation([]), ["/green_strain"]), (evaluation([[0, 0]]), ["/green_strain/0"]),
    (evaluation([[0, 0, None]]), ["/green_strain/0/2"]), (evaluation([[0, 101, 0]]), ["/green_strain/0/1"]),
    (evaluation([[0, 0, 0]], 0.15), ["/parameters"]), (evaluation([[0, 0, 0]], DESIGN), ["/parameters/0", "/parameters/1"]),
    (evaluation([[0, 0, 0]], [["x", 0.6]]), ["/parameters/0/0"]), (evaluation([[0, 0, 0]], [[1e9, 0.6]]), ["/parameters/0/0"]),
    (evaluation([[0, 0, 0]], derivatives=3), ["/derivatives"]), (evaluation([[0, 0, 0]], derivatives=1.5), ["/derivatives"]),
    (evaluation([[0, 0, 0]], deadline=0), ["/deadline"]), (evaluation([[0, 0, 0]], order=1), ["/order"]), ([], [""]),
]


@pytest.mark.parametrize("document, expected", EVALUATION_FAULTS, ids=[json.dumps(d)[:80] for d, _ in EVALUATION_FAULTS])
def test_what_is_no_evaluation_is_refused(api: Api, document: Any, expected: List[str]) -> None:
    response = api.post(EVALUATIONS, document, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == expected


# --- uniaxial loads --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("direction", [0.0, 0.7, 2.5])
def test_uniaxial_loads_leave_lateral_strain_and_shear_free(api: Api, direction: float) -> None:
    d, n = np.array([np.cos(direction), np.sin(direction)]), np.array([-np.sin(direction), np.cos(direction)])
    stretches = [1.01, 1.03, 0.98]
    answer = api.ok(UNIAXIAL, {"parameters": DESIGN, "direction": direction, "stretches": stretches})
    assert answer["direction"] == direction and answer["parameters"] == DESIGN
    for stretch, state in zip(stretches, answer["states"]):
        (xx, yy, xy), (sxx, syy, sxy) = state["green_strain"], state["stress"]
        strain, stress = np.array([[xx, xy], [xy, yy]]), np.array([[sxx, sxy], [sxy, syy]])
        assert state["converged"] and state["residual"] <= answer["accuracy"]["tolerance"] == 1e-10
        assert d @ strain @ d == pytest.approx((stretch**2 - 1) / 2, abs=1e-12)
        assert d @ stress @ d == pytest.approx(state["directional_stress"], rel=1e-10)
        assert max(abs(n @ stress @ n), abs(n @ stress @ d)) < 1e-9 * abs(d @ stress @ d)
        there = api.ok(EVALUATIONS, evaluation([state["green_strain"]]))
        assert there["energy_density"][0] == pytest.approx(state["energy_density"], rel=1e-9)
        np.testing.assert_allclose(there["stress"][0], state["stress"], rtol=1e-7, atol=1e-9 * abs(d @ stress @ d))
    assert answer["accuracy"]["residual"] == max(state["residual"] for state in answer["states"])


def test_the_stress_along_the_load_is_the_slope_of_the_energy(api: Api) -> None:
    step = 1e-4
    states = api.ok(UNIAXIAL, {"parameters": DESIGN, "direction": 0.4, "green_strains": [0.03 - step, 0.03, 0.03 + step]})["states"]
    slope = (states[2]["energy_density"] - states[0]["energy_density"]) / (2 * step)
    assert states[1]["directional_stress"] == pytest.approx(slope, rel=1e-6)


def test_stretches_and_green_strains_say_the_same(api: Api) -> None:
    stretches = [1.01, 1.02]
    request = {"parameters": DESIGN, "direction": 0.2}
    by_stretch = api.ok(UNIAXIAL, {**request, "stretches": stretches})
    by_strain = api.ok(UNIAXIAL, {**request, "green_strains": [(s * s - 1) / 2 for s in stretches]})
    for a, b in zip(by_stretch["states"], by_strain["states"]):
        np.testing.assert_allclose(a["green_strain"], b["green_strain"], atol=1e-12)


def test_a_state_that_is_not_reached_says_so_and_is_no_error(api: Api) -> None:
    answer = api.ok(UNIAXIAL, {"parameters": DESIGN, "direction": 0.3, "stretches": [1.05, 1.2],
                               "accuracy": {"tolerance": 1e-14, "max_iterations": 1}})
    assert len(answer["states"]) == 2 and not all(state["converged"] for state in answer["states"])
    assert answer["accuracy"]["tolerance"] == 1e-14


UNIAXIAL_FAULTS = [
    ({"stretches": [1.1]}, ["/parameters", "/direction"]),
    ({"parameters": DESIGN, "direction": 0}, [""]),
    ({"parameters": DESIGN, "direction": 0, "stretches": [1.1], "green_strains": [0.1]}, [""]),
    ({"parameters": [DESIGN], "direction": 0, "stretches": [1.1]}, ["/parameters/0"]),
    ({"parameters": DESIGN, "direction": "x", "stretches": [1.1]}, ["/direction"]),
    ({"parameters": DESIGN, "direction": 0, "stretches": [1.1, 0, 9]}, ["/stretches/1", "/stretches/2"]),
    ({"parameters": DESIGN, "direction": 0, "green_strains": [-0.5]}, ["/green_strains/0"]),
    ({"parameters": DESIGN, "direction": 0, "stretches": []}, ["/stretches"]),
    ({"parameters": DESIGN, "direction": 0, "stretches": [1.1], "accuracy": {"tolerance": 0}}, ["/accuracy/tolerance"]),
    ({"parameters": DESIGN, "direction": 0, "stretches": [1.1], "load": 1}, ["/load"]),
]


@pytest.mark.parametrize("document, expected", UNIAXIAL_FAULTS, ids=[json.dumps(d)[:80] for d, _ in UNIAXIAL_FAULTS])
def test_what_is_no_uniaxial_load_is_refused(api: Api, document: Any, expected: List[str]) -> None:
    response = api.post(UNIAXIAL, document, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == expected


def test_more_states_than_the_limit_are_refused_with_the_setting(api: Api) -> None:
    response = api.post(UNIAXIAL, {"parameters": DESIGN, "direction": 0, "stretches": [1.0] * 1001}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == ["/stretches"] and response.json()["setting"] == "--max-states"


def test_the_contract_names_the_defaults_that_the_server_has(api: Api) -> None:
    schemas = api.contract.spec["components"]["schemas"]
    answer = api.ok(UNIAXIAL, {"parameters": DESIGN, "direction": 0, "stretches": [1.01]})
    accuracy = schemas["UniaxialRequest"]["properties"]["accuracy"]["properties"]
    assert answer["accuracy"]["tolerance"] == accuracy["tolerance"]["default"]


# --- files -----------------------------------------------------------------------------------------------------------


def test_a_server_without_models_says_so(new_server: NewServer, contract: Contract) -> None:
    api = Api(new_server(), contract)
    assert api.get("/v1/models").json() == {"models": []}
    response = api.get("/v1/models/ih21")
    assert (response.status_code, problem_code(response)) == (404, "model.not_found")
    assert "no model is loaded" in response.json()["detail"]


def test_a_folder_of_models_that_does_not_exist_ends_the_server(new_server: NewServer, tmp_path: Path) -> None:
    with pytest.raises(RuntimeError, match="no-such-folder"):
        new_server("--models", str(tmp_path / "no-such-folder"))


def test_ready_means_that_every_model_has_been_read(new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    made, models = make_model(tmp_path / "made.h5"), tmp_path / "models"
    make_model(models / "last.h5", "last")
    for number in range(300):
        shutil.copy(made, models / f"copy-{number:03}.h5")
    api = Api(new_server("--models", str(models)), contract)
    assert [model["id"] for model in api.get("/v1/models").json()["models"]] == ["ih21", "last"]


def test_files_that_come_change_and_go_count_without_a_restart(
        new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    models = tmp_path / "models"
    models.mkdir()
    server = new_server("--models", str(models))
    api = Api(server, contract)

    def hash_served() -> str:
        response = api.get(MODEL)
        return str(response.json()["sha256"]) if response.status_code == 200 else ""

    assert hash_served() == ""
    make_model(models / "ih21.h5", seed=1)
    assert soon(lambda: hash_served() != "")
    first = hash_served()
    energy = api.ok(EVALUATIONS, evaluation([STRAIN]))["energy_density"]
    make_model(models / "ih21.h5", seed=2)
    assert soon(lambda: hash_served() != first)
    second = api.ok(EVALUATIONS, evaluation([STRAIN]))
    assert second["sha256"] == hash_served() and second["energy_density"] != energy
    content = (models / "ih21.h5").read_bytes()
    (models / "ih21.h5").write_bytes(content[:len(content) // 2])
    assert soon(lambda: "its earlier version stays" in server.log_text())
    assert answers(api.ok(EVALUATIONS, evaluation([STRAIN]))) == answers(second)
    make_model(models / "other.h5", "other")
    assert soon(lambda: api.get("/v1/models/other").status_code == 200)
    make_model(models / "zz.h5", "other", seed=5)
    assert soon(lambda: "zz.h5 is left out" in server.log_text())
    (models / "ih21.h5").unlink()
    assert soon(lambda: hash_served() == "")
    assert [model["id"] for model in api.get("/v1/models").json()["models"]] == ["other"]
    assert server.metrics()["supple_models_loaded"] == 1
    assert server.terminate() == 0


def test_damaged_files_leave_the_other_models_served_after_a_start(
        new_server: NewServer, contract: Contract, tmp_path: Path) -> None:
    models = tmp_path / "models"
    content = make_model(models / "m.h5", "m").read_bytes()
    (models / "a.h5").write_bytes(b"")
    (models / "z.h5").write_bytes(b"no HDF5")
    cuts = np.linspace(1, len(content) - 1, 40).astype(int)
    for number, cut in enumerate(cuts):
        (models / f"cut-{number}.h5").write_bytes(content[:cut])
        changed = bytearray(content)
        changed[cut] ^= 1 << (number % 8)
        (models / f"changed-{number}.h5").write_bytes(changed)
    server = new_server("--models", str(models))
    api = Api(server, contract)
    assert [model["id"] for model in api.get("/v1/models").json()["models"]] == ["m"]
    damaged = [f"{fault}-{number}.h5" for number in range(len(cuts)) for fault in ("cut", "changed")]
    for name in ("a.h5", "z.h5", *damaged):
        assert f"{name} is left out" in server.log_text()
