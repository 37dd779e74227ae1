"""Requests for designs and profiles that are refused, with the code and the fields that say why."""

from __future__ import annotations

import json
from typing import Any, Dict, List, Optional

import pytest

from design_requests import DESIGNS, PROFILES
from harness import Api, pointers, problem_code
from test_jobs import ASYNC, start_job

GOOD = {"task": "stress_strain", "family": "IH67", "target": {"control_points": [[0, 0], [0.1, 1]]}}
TARGET = GOOD["target"]


def without(name: str) -> Dict[str, Any]:
    return {key: value for key, value in GOOD.items() if key != name}


def with_target(**more: Any) -> Dict[str, Any]:
    return {**GOOD, "target": {**TARGET, **more}}  # type: ignore[dict-item]


INVALID = [
    ([], [""]),
    ({}, ["/task", "/target"]),
    (without("task"), ["/task"]),
    (without("target"), ["/target"]),
    ({**GOOD, "task": "shear"}, ["/task"]),
    ({**GOOD, "target": {}}, ["/target/control_points"]),
    ({**GOOD, "target": [[0, 0], [1, 1]]}, ["/target"]),
    (with_target(control_points=[[0, 0]]), ["/target/control_points"]),
    (with_target(control_points=[[0, 0], [1]]), ["/target/control_points/1"]),
    (with_target(control_points=[[0, 0], [0.1, None]]), ["/target/control_points/1/1"]),
    (with_target(control_points=[[0, 0], [0.1, 1e7]]), ["/target/control_points/1/1"]),
    (with_target(interpolation="quintic"), ["/target/interpolation"]),
    (with_target(weights=[1, -1]), ["/target/weights/1"]),
    (with_target(bands=[0]), ["/target/bands"]),
    (with_target(band=1), ["/target/band"]),
    ({**GOOD, "samples": 1}, ["/samples"]),
    ({**GOOD, "samples": 501}, ["/samples"]),
    ({**GOOD, "weight": 0}, ["/weight"]),
    ({**GOOD, "direction": "x"}, ["/direction"]),
    ({**GOOD, "strain": -0.5}, ["/strain"]),
    ({**GOOD, "strain_measure": "true"}, ["/strain_measure"]),
    ({**GOOD, "model": "ih67"}, ["/model"]),
    ({**GOOD, "family": 67}, ["/family"]),
    ({**GOOD, "initial": []}, ["/initial"]),
    ({**GOOD, "initial": [0.2, "x"]}, ["/initial/1"]),
    ({**GOOD, "fixed": [None, True]}, ["/fixed/1"]),
    ({**GOOD, "also": [{"task": "poisson"}]}, ["/also/0/target"]),
    ({**GOOD, "also": [{**without("family"), "family": "IH67"}]}, ["/also/0/family"]),
    ({**GOOD, "verify": "yes"}, ["/verify"]),
    ({**GOOD, "accuracy": {"tolerance": 0}}, ["/accuracy/tolerance"]),
    ({**GOOD, "accuracy": {"max_iterations": 0, "starts": 65, "candidates": 5000, "verified_samples": 1}},
     ["/accuracy/max_iterations", "/accuracy/starts", "/accuracy/candidates", "/accuracy/verified_samples"]),
    ({**GOOD, "effects": {"multi_start": "perhaps", "polish": "maybe", "trust": True}},
     ["/effects/multi_start", "/effects/polish", "/effects/trust"]),
    ({**GOOD, "accuracy": {"polish_tolerance": 0, "polish_rounds": 0, "polish_seconds": 0}},
     ["/accuracy/polish_tolerance", "/accuracy/polish_rounds", "/accuracy/polish_seconds"]),
    ({**GOOD, "session": ""}, ["/session"]),
    ({**GOOD, "session": "a b"}, ["/session"]),
    ({**GOOD, "session": "x" * 65}, ["/session"]),
    ({**GOOD, "deadline": 0}, ["/deadline"]),
    ({**GOOD, "name": "x" * 101}, ["/name"]),
    ({**GOOD, "colour": 1}, ["/colour"]),
    ({"regions": []}, ["/regions"]),
    ({"regions": [GOOD, without("target")]}, ["/regions/1/target"]),
    ({"regions": [{**GOOD, "verify": True}]}, ["/regions/0/verify"]),
    ({**GOOD, "regions": [GOOD]}, None),
]


@pytest.mark.parametrize("document, expected", INVALID, ids=[json.dumps(d)[:90] for d, _ in INVALID])
def test_what_is_no_design_problem_is_refused(designs: Api, document: Any, expected: Optional[List[str]]) -> None:
    response = designs.post(DESIGNS, document, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert expected is None or sorted(pointers(response)) == sorted(expected)


@pytest.mark.parametrize("document, pointer", [
    (with_target(control_points=[[0.01 * i, 0] for i in range(65)]), "/target/control_points"),
    ({**GOOD, "also": [without("family")] * 9}, "/also"),
    ({"regions": [GOOD] * 21}, "/regions"),
    ({**GOOD, "initial": [0.1] * 9}, "/initial"),
], ids=["control_points", "also", "regions", "initial"])
def test_more_entries_than_the_contract_allows_are_refused(designs: Api, document: Any, pointer: str) -> None:
    response = designs.post(DESIGNS, document, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == [pointer]


MEANINGLESS = [
    (with_target(control_points=[[0, 0], [0, 1]]), "design.invalid_target", ["/target/control_points/1/0"]),
    (with_target(control_points=[[0, 0], [0.1, 1], [0.05, 1]]), "design.invalid_target", ["/target/control_points/2/0"]),
    (with_target(control_points=[[-0.6, 0], [0.1, 1]]), "design.invalid_target", ["/target/control_points/0/0"]),
    (with_target(control_points=[[0, 0], [8, 1]]), "design.invalid_target", ["/target/control_points/1/0"]),
    (with_target(weights=[1, 1, 1]), "design.invalid_target", ["/target/weights"]),
    (with_target(bands=[0.1, 0.1, 0.1]), "design.invalid_target", ["/target/bands"]),
    ({**GOOD, "task": "poisson", "target": {"control_points": [[0, 0], [3.2, 1]]}}, "design.invalid_target",
     ["/target/control_points/1/0"]),
    ({**GOOD, "task": "stiffness", "strain": 7, "strain_measure": "engineering"}, "design.invalid_target", ["/strain"]),
    ({**GOOD, "also": [without("family"), {**without("family"), "target": {"control_points": [[1, 0], [0, 1]]}}]},
     "design.invalid_target", ["/also/1/target/control_points/1/0"]),
    ({"regions": [GOOD, with_target(control_points=[[1, 0], [0, 1]])]}, "design.invalid_target",
     ["/regions/1/target/control_points/1/0"]),
    ({**GOOD, "family": "IH99"}, "design.no_model", ["/family"]),
    ({"regions": [GOOD, {**GOOD, "family": "IH01"}]}, "design.no_model", ["/regions/1/family"]),
    ({**without("family"), "initial": [0.2, 0.9]}, "design.needs_family", ["/initial"]),
    ({**GOOD, "family": "any", "fixed": [0.2, None]}, "design.needs_family", ["/fixed"]),
    ({**GOOD, "initial": [0.2]}, "design.parameter_count", ["/initial"]),
    ({**GOOD, "fixed": [None, None, 0.1]}, "design.parameter_count", ["/fixed"]),
    ({**GOOD, "initial": [0.2, 2.0]}, "design.parameter_out_of_bounds", ["/initial/1"]),
    ({**GOOD, "fixed": [0.9, None]}, "design.parameter_out_of_bounds", ["/fixed/0"]),
    ({"regions": [GOOD, {**GOOD, "initial": [0.9, 0.9]}], "accuracy": {"candidates": 2, "starts": 1}},
     "design.parameter_out_of_bounds", ["/regions/1/initial/0"]),
]


@pytest.mark.parametrize("document, code, expected", MEANINGLESS, ids=[json.dumps(d)[:90] for d, _, _ in MEANINGLESS])
def test_problems_that_mean_nothing_say_why_and_where(designs: Api, document: Any, code: str, expected: List[str]) -> None:
    response = designs.post(DESIGNS, document)
    assert (response.status_code, problem_code(response)) == (422, code), response.text
    assert pointers(response) == expected
    job = start_job(designs, DESIGNS, document) if code.startswith("design.parameter") else None
    if job is not None:
        assert designs.wait_for_job(job)["error"]["code"] == code


def test_an_unknown_model_is_not_found_and_pointed_to(designs: Api) -> None:
    for path, document in ((DESIGNS, {**without("family"), "model": "ih99"}),
                           (PROFILES, {"task": "poisson", "model": "ih99", "parameters": [0.1]})):
        response = designs.post(path, document)
        assert (response.status_code, problem_code(response), pointers(response)) == (404, "model.not_found", ["/model"])
    response = designs.post(DESIGNS, {"regions": [{**without("family"), "model": "ih99"}]})
    assert pointers(response) == ["/regions/0/model"]


def test_strains_without_any_equilibrium_are_an_error(designs: Api) -> None:
    response = designs.post(DESIGNS, {**with_target(control_points=[[-0.499, 0], [-0.49, 1]]),
                                      "accuracy": {"candidates": 4, "starts": 1}})
    if response.status_code == 422:
        assert problem_code(response) == "design.no_equilibrium"
    else:
        assert response.status_code == 200 and not any(response.json()["profile"]["in_range"])


PROFILE = {"task": "stress_strain", "family": "IH67", "parameters": [0.2, 0.9]}
PROFILE_FAULTS = [
    ([], 400, "request.invalid", None),
    ({}, 400, "request.invalid", ["", "/parameters", "/task"]),
    ({**PROFILE, "task": "energy"}, 400, "request.invalid", ["/task"]),
    ({**PROFILE, "model": "ih67"}, 400, "request.invalid", [""]),
    ({"task": "poisson", "parameters": [0.2]}, 400, "request.invalid", [""]),
    ({**PROFILE, "parameters": []}, 400, "request.invalid", ["/parameters"]),
    ({**PROFILE, "parameters": [0.2, None]}, 400, "request.invalid", ["/parameters/1"]),
    ({**PROFILE, "x": []}, 400, "request.invalid", ["/x"]),
    ({**PROFILE, "x": [0] * 1001}, 400, "request.invalid", ["/x"]),
    ({**PROFILE, "x": [0, "a"]}, 400, "request.invalid", ["/x/1"]),
    ({**PROFILE, "x": [0.1], "range": [0, 1]}, 400, "request.invalid", ["/x"]),
    ({**PROFILE, "x": [0.1], "samples": 5}, 400, "request.invalid", ["/x"]),
    ({**PROFILE, "samples": 1}, 400, "request.invalid", ["/samples"]),
    ({**PROFILE, "range": [0]}, 400, "request.invalid", ["/range"]),
    ({**PROFILE, "task": "poisson", "range": [0, 1]}, 400, "request.invalid", ["/range"]),
    ({**PROFILE, "accuracy": {"equilibrium_tolerance": 1}}, 400, "request.invalid", ["/accuracy/equilibrium_tolerance"]),
    ({**PROFILE, "session": "a"}, 400, "request.invalid", ["/session"]),
    ({**PROFILE, "family": "IH99"}, 422, "design.no_model", ["/family"]),
    ({**PROFILE, "parameters": [0.2]}, 422, "design.parameter_count", ["/parameters"]),
    ({**PROFILE, "x": [0.1, -0.5]}, 422, "model.invalid_load", ["/x/1"]),
    ({**PROFILE, "range": [-0.9, 0.1]}, 422, "model.invalid_load", None),
    ({**PROFILE, "task": "poisson", "strain": 7, "strain_measure": "engineering"}, 422, "model.invalid_load", ["/strain"]),
]


@pytest.mark.parametrize("document, status, code, expected", PROFILE_FAULTS,
                         ids=[json.dumps(d)[:90] for d, _, _, _ in PROFILE_FAULTS])
def test_what_is_no_profile_is_refused(
        designs: Api, document: Any, status: int, code: str, expected: Optional[List[str]]) -> None:
    response = designs.post(PROFILES, document, faulty=True)
    assert (response.status_code, problem_code(response)) == (status, code), response.text
    assert expected is None or sorted(pointers(response)) == sorted(expected)


def test_a_job_that_is_refused_is_refused_at_once(designs: Api) -> None:
    response = designs.post(DESIGNS, {**GOOD, "family": "IH99"}, headers=ASYNC)
    assert (response.status_code, problem_code(response)) == (422, "design.no_model")
