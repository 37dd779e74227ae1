"""Inverse design over HTTP: known designs are found again, targets out of reach, regions, sessions, refusals."""

from __future__ import annotations

import json
import shutil
import threading
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional

import numpy as np
import pytest
import requests

from contract import Contract
from harness import ROOT, SLOWNESS, Api, ServerProcess, pointers, problem_code
from working_time import PATIENCE_SECONDS, WorkingTime, comes_true, ends_within
from test_jobs import ASYNC, events, start_job

DESIGNS = "/v1/designs"
PROFILES = "/v1/profiles"
KNOWN = {"IH67": [0.22, 0.85], "IH29": [0.15]}
FEW = {"candidates": 24, "starts": 3}
"""Options of a quick search that suffices for one or two parameters."""


def profile(api: Api, task: str, x: List[float], family: str = "IH67", parameters: Any = None, **more: Any) -> Any:
    document = {"task": task, "family": family, "parameters": parameters or KNOWN[family], "x": x, **more}
    return api.ok(PROFILES, document)


def spline(x: Any, y: Any, **more: Any) -> Dict[str, Any]:
    return {"control_points": [[float(a), float(b)] for a, b in zip(x, y)], "interpolation": "linear", **more}


def known_problem(api: Api, task: str = "stress_strain", family: str = "IH67", **more: Any) -> Dict[str, Any]:
    """A target that the known design of the family reaches at every sample."""
    x = np.linspace(-0.08, 0.12, 9) if task == "stress_strain" else np.pi * np.arange(12) / 12
    where = {"direction": more.pop("direction", 0.3)} if task == "stress_strain" else {"strain": more.pop("strain", 0.04)}
    y = profile(api, task, x.tolist(), family, **where)["y"]
    return {"task": task, "family": family, **where, "target": spline(x, y), "samples": len(x), "accuracy": FEW, **more}


def answers(document: Dict[str, Any]) -> Dict[str, Any]:
    """The parts of an answer that are equal for equal computations."""
    return {name: value for name, value in document.items() if name not in ("cost", "effects")}


def effect(answer: Dict[str, Any], name: str) -> Dict[str, Any]:
    (found,) = [entry for entry in answer["effects"] if entry["name"] == name]
    return dict(found)


def long_request(**more: Any) -> Dict[str, Any]:
    """A search that takes far longer than any test waits for it."""
    return {"task": "stiffness", "family": "IH67", "target": spline([0, 1, 2], [0.1, 0.4, 0.2]), "samples": 500,
            "accuracy": {"starts": 64, "max_iterations": 1000, "tolerance": 1e-12, "candidates": 4096},
            "effects": {"multi_start": "on"}, **more}


# --- results -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("task, family", [
    ("stress_strain", "IH67"), ("stress_strain", "IH29"), ("stiffness", "IH29"), ("poisson", "IH29"), ("poisson", "IH67")])
def test_a_known_design_is_found_again(designs: Api, task: str, family: str) -> None:
    request = known_problem(designs, task, family)
    answer = designs.ok(DESIGNS, request)
    assert answer["reached"] and answer["error"]["relative_rms"] < 1e-4 and answer["message"] == ""
    np.testing.assert_allclose(answer["profile"]["achieved"], answer["profile"]["target"],
                               rtol=2e-3, atol=2e-4 * np.abs(answer["profile"]["target"]).max())
    assert all(answer["profile"]["reached"]) and all(answer["profile"]["in_range"])
    bounds = designs.get(f"/v1/models/{answer['model']}").json()
    assert answer["sha256"] == bounds["sha256"] and answer["family"] == family
    for parameter, lower, upper in zip(answer["parameters"], *bounds["parameters"].values()):
        assert lower <= parameter <= upper


def test_the_parameters_of_a_known_design_are_found_again(designs: Api) -> None:
    answer = designs.ok(DESIGNS, known_problem(designs))
    np.testing.assert_allclose(answer["parameters"], KNOWN["IH67"], atol=1e-3)


def test_the_profile_of_the_design_found_is_that_of_its_parameters(designs: Api) -> None:
    answer = designs.ok(DESIGNS, {**known_problem(designs), "target": spline([-0.05, 0.1], [-0.02, 0.08])})
    again = profile(designs, "stress_strain", answer["profile"]["x"], parameters=answer["parameters"], direction=0.3)
    np.testing.assert_allclose(again["y"], answer["profile"]["achieved"], rtol=1e-8, atol=1e-12)
    assert again["in_range"] == answer["profile"]["in_range"]


def test_the_answer_links_to_the_files_of_the_structure(designs: Api) -> None:
    answer = designs.ok(DESIGNS, known_problem(designs, family="IH29"))
    picture = designs.get(answer["structure"]["svg"])
    assert picture.status_code == 200 and picture.headers["Content-Type"].startswith("image/svg+xml")
    same = designs.post("/v1/structures", {"family": "IH29", "parameters": answer["parameters"]},
                        headers={"Accept": "image/svg+xml"})
    assert picture.content == same.content
    assert designs.get(answer["structure"]["dxf"]).status_code == designs.get(answer["structure"]["stl"]).status_code == 200


def test_a_target_out_of_reach_is_answered_with_the_closest_design(designs: Api) -> None:
    request = {**known_problem(designs), "target": spline([-0.05, 0.1], [-50, 100])}
    answer = designs.ok(DESIGNS, request)
    main = answer["profile"]
    assert not answer["reached"] and not all(main["reached"]) and "reaches the target" in answer["message"]
    assert answer["error"]["relative_rms"] > 0.5
    assert answer["error"]["max"] == pytest.approx(np.abs(np.subtract(main["achieved"], main["target"])).max())
    lower, upper = (np.array(main["envelope"][side]) for side in ("lower", "upper"))
    assert (lower <= main["achieved"]).all() and (upper >= main["achieved"]).all()
    assert main["target"][-1] > upper[-1] and main["target"][0] < lower[0]


def test_the_relative_deviation_is_the_weighted_root_mean_square(designs: Api) -> None:
    weights = [1, 3, 2]
    request = {**known_problem(designs), "target": spline([-0.05, 0.05, 0.1], [-0.1, 0.02, 0.4], weights=weights),
               "samples": 3}
    answer = designs.ok(DESIGNS, request)
    main = answer["profile"]
    # Samples are evenly spaced: the second one is between the first two control points, at 0.75 of their distance.
    share = np.array([1, 1 + 0.75 * 2, 2])
    deviation = np.subtract(main["achieved"], main["target"])
    expected = np.sqrt((share * deviation**2).sum() / (share * np.square(main["target"])).sum())
    assert answer["error"]["relative_rms"] == pytest.approx(expected, rel=1e-6)


def test_what_has_no_weight_does_not_count(designs: Api) -> None:
    request = known_problem(designs)
    points = [list(point) for point in request["target"]["control_points"]]
    points[3][1] += 10
    weights = [1.0] * len(points)
    weights[3] = 0
    answer = designs.ok(DESIGNS, {**request, "target": {**request["target"], "control_points": points, "weights": weights}})
    assert answer["error"]["relative_rms"] < 1e-4
    np.testing.assert_allclose(answer["parameters"], KNOWN["IH67"], atol=1e-3)


def test_deviations_within_the_bands_count_as_none(designs: Api) -> None:
    request = known_problem(designs)
    points = request["target"]["control_points"]
    size = max(abs(y) for _, y in points)
    moved = [[x, y + (-1) ** i * 0.02 * size] for i, (x, y) in enumerate(points)]
    banded = {**request["target"], "control_points": moved, "bands": [0.05 * size] * len(points)}
    answer = designs.ok(DESIGNS, {**request, "target": banded})
    assert answer["reached"] and answer["error"]["relative_rms"] < 1e-5 and answer["error"]["max"] < 1e-5 * size
    deviation = np.abs(np.subtract(answer["profile"]["achieved"], answer["profile"]["target"]))
    assert 0.01 * size < deviation.max() <= 0.05 * size * (1 + 1e-4)


def test_several_targets_are_met_by_one_design(designs: Api) -> None:
    first = known_problem(designs, direction=0.0)
    further = [known_problem(designs, direction=1.2), known_problem(designs, "poisson")]
    also = [{name: value for name, value in target.items() if name not in ("family", "accuracy")} for target in further]
    answer = designs.ok(DESIGNS, {**first, "also": also})
    assert answer["reached"] and answer["error"]["relative_rms"] < 1e-4
    assert [p["task"] for p in answer["also"]] == ["stress_strain", "poisson"]
    assert answer["also"][0]["direction"] == 1.2 and answer["also"][1]["strain"] == 0.04
    for shown, target in zip(answer["also"], also):
        np.testing.assert_allclose(shown["target"], [y for _, y in target["target"]["control_points"]], atol=1e-9)
        assert shown["verified"] is None
    np.testing.assert_allclose(answer["parameters"], KNOWN["IH67"], atol=1e-3)


def test_the_weight_of_a_target_decides_between_targets_that_disagree(designs: Api) -> None:
    base = {"task": "stress_strain", "direction": 0.3, "samples": 5}
    wanted = {**base, "target": spline([0.02, 0.1], [0.002, 0.02])}
    other = {**base, "target": spline([0.02, 0.1], [0.006, 0.06])}
    errors = []
    for weight in (1e-3, 1e3):
        answer = designs.ok(DESIGNS, {**wanted, "also": [{**other, "weight": weight}], "family": "IH67", "accuracy": FEW})
        errors.append(np.abs(np.subtract(answer["profile"]["achieved"], answer["profile"]["target"])).max())
    assert errors[0] < errors[1]


def test_regions_are_answered_in_their_order_like_problems_of_their_own(designs: Api) -> None:
    problems = [known_problem(designs, family="IH29"), known_problem(designs, "poisson", "IH29")]
    regions = [{**{k: v for k, v in problem.items() if k != "accuracy"}, "name": name}
               for problem, name in zip(problems, ("heel", "toe <&>"))]
    together = designs.ok(DESIGNS, {"regions": regions, "accuracy": FEW})
    assert [region["name"] for region in together["regions"]] == ["heel", "toe <&>"]
    for region, problem in zip(together["regions"], problems):
        alone = designs.ok(DESIGNS, problem)
        for name in ("parameters", "profile", "error", "stopped", "ranking"):
            assert region[name] == alone[name]


def test_fixed_parameters_keep_their_values(designs: Api) -> None:
    request = known_problem(designs)
    answer = designs.ok(DESIGNS, {**request, "fixed": [0.25, None]})
    assert answer["parameters"][0] == 0.25 and not answer["reached"]
    right = designs.ok(DESIGNS, {**request, "fixed": [None, KNOWN["IH67"][1]]})
    assert right["parameters"][1] == KNOWN["IH67"][1] and right["parameters"][0] == pytest.approx(KNOWN["IH67"][0], abs=1e-3)


def test_where_all_parameters_are_fixed_there_is_nothing_to_search(designs: Api) -> None:
    answer = designs.ok(DESIGNS, {**known_problem(designs), "fixed": KNOWN["IH67"]})
    assert answer["stopped"] == "no_free_parameters" and answer["iterations"] == 0 and answer["reached"]
    assert answer["parameters"] == KNOWN["IH67"] and answer["error"]["relative_rms"] < 1e-8


def test_any_family_is_a_ranking_of_the_best_of_each(designs: Api) -> None:
    request = known_problem(designs, "poisson", "IH29")
    answer = designs.ok(DESIGNS, {**request, "family": "any"})
    assert [candidate["family"] for candidate in answer["ranking"]] == ["IH29", "IH67"]
    for candidate in answer["ranking"]:
        model = designs.get(f"/v1/models/{candidate['model']}").json()
        assert candidate["model_error"] == model["errors"]["design_split"]["gradient"]["mean"]
    errors = [candidate["error"]["relative_rms"] for candidate in answer["ranking"]]
    assert errors == sorted(errors) and errors[0] < 1e-4 < errors[1]
    best = answer["ranking"][0]
    assert (best["family"], best["model"], best["parameters"], best["error"]) == tuple(
        answer[name] for name in ("family", "model", "parameters", "error"))
    del request["family"]
    assert answers(designs.ok(DESIGNS, request)) == answers(answer), "any is the default"


def test_a_model_may_be_named_instead_of_its_family(designs: Api) -> None:
    request = known_problem(designs, family="IH29")
    by_family = designs.ok(DESIGNS, request)
    del request["family"]
    assert answers(designs.ok(DESIGNS, {**request, "model": "ih29"})) == answers(by_family)


def test_a_search_starts_where_the_request_says(designs: Api) -> None:
    near = [0.21, 0.87]
    request = {**known_problem(designs), "initial": near}
    answer = designs.ok(DESIGNS, request)
    there = profile(designs, "stress_strain", answer["profile"]["x"], parameters=near, direction=0.3)
    np.testing.assert_allclose(answer["profile"]["initial"], there["y"], rtol=1e-7, atol=1e-10)
    assert answer["starts"] == 1 and not effect(answer, "multi_start")["ran"] and answer["profile"]["envelope"] is None
    np.testing.assert_allclose(answer["parameters"], KNOWN["IH67"], atol=1e-3)


def test_effects_do_what_the_request_says(designs: Api) -> None:
    request = known_problem(designs, family="IH29")
    one = designs.ok(DESIGNS, {**request, "effects": {"multi_start": "off", "envelope": "off"}})
    assert one["starts"] == 1 and one["profile"]["envelope"] is None and not effect(one, "envelope")["ran"]
    many = designs.ok(DESIGNS, {**request, "initial": [0.15], "effects": {"multi_start": "on", "envelope": "on"}})
    assert many["starts"] == FEW["starts"] and effect(many, "multi_start")["ran"] and effect(many, "envelope")["ran"]
    assert len(many["profile"]["envelope"]["lower"]) == request["samples"]
    assert not effect(many, "verification")["ran"] and "does not ask" in effect(many, "verification")["why"]
    assert "trusted as much as any" in effect(one, "trust")["why"] and "says where to begin" in effect(many, "trust")["why"]
    nearest = designs.ok(DESIGNS, {**request, "effects": {"trust": "off"}})
    assert not effect(nearest, "trust")["ran"] and "turns it off" in effect(nearest, "trust")["why"]


def test_the_iteration_limit_is_said(designs: Api) -> None:
    request = {**known_problem(designs), "initial": [0.12, 0.7], "effects": {"multi_start": "off"},
               "accuracy": {"max_iterations": 1}}
    answer = designs.ok(DESIGNS, request)
    assert (answer["stopped"], answer["iterations"], answer["reached"]) == ("iteration_limit", 1, False)


def test_equal_requests_have_equal_answers(designs: Api) -> None:
    request = {**known_problem(designs), "target": {**spline([-0.05, 0.02, 0.1], [-0.02, 0.01, 0.07]),
                                                    "interpolation": "monotone"}}
    first, second = (designs.ok(DESIGNS, request) for _ in range(2))
    assert answers(first) == answers(second)
    job = start_job(designs, DESIGNS, request)
    assert (designs.wait_for_job(job)["state"], designs.get(f"/v1/jobs/{job}").json()["kind"]) == ("successful", "designs")
    assert answers(designs.get(f"/v1/jobs/{job}/result").json()) == answers(first)


def test_targets_over_directions_repeat_after_half_a_turn(designs: Api) -> None:
    request = known_problem(designs, "poisson", "IH29")
    points = request["target"]["control_points"]
    turned = [[x - np.pi, y] for x, y in points[6:]] + points[:6]
    answer = designs.ok(DESIGNS, {**request, "target": {**request["target"], "control_points": turned}})
    assert answer["reached"]
    np.testing.assert_allclose(answer["parameters"], KNOWN["IH29"], atol=1e-3)


def test_the_design_found_is_verified_by_simulation(designs: Api) -> None:
    x = np.linspace(0.01, 0.03, 3)
    y = profile(designs, "stress_strain", x.tolist(), "IH29", direction=0.0)["y"]
    request = {"task": "stress_strain", "family": "IH29", "target": spline(x, y), "samples": 3, "verify": True,
               "accuracy": {**FEW, "verified_samples": 2}}
    answer = designs.ok(DESIGNS, request)
    verified = answer["profile"]["verified"]
    assert verified["x"] == pytest.approx([0.01, 0.03]) and effect(answer, "verification")["ran"]
    assert verified["model"] == pytest.approx([answer["profile"]["achieved"][i] for i in (0, 2)], rel=1e-8)
    np.testing.assert_allclose(verified["y"], verified["model"], rtol=0.2)
    simulated, model = np.array(verified["y"]), np.array(verified["model"])
    assert verified["relative_rms"] == pytest.approx(np.sqrt(((simulated - model) ** 2).sum() / (simulated**2).sum()))


def test_parameters_without_a_structure_are_found_but_said(
        new_server: Callable[..., ServerProcess], contract: Contract, tmp_path: Path) -> None:
    """The bounds are a box, in this corner of which a tile consists almost only of beams."""
    (tmp_path / "models").mkdir()
    shutil.copy(ROOT / "models" / "ih28.h5", tmp_path / "models")
    designs = Api(new_server("--models", str(tmp_path / "models")), contract)
    tiny = [0.005, 0.5]
    refused = designs.post("/v1/structures", {"family": "IH28", "parameters": tiny})
    assert (refused.status_code, problem_code(refused)) == (422, "tiling.cell_too_small")
    answer = designs.ok(DESIGNS, {"task": "stress_strain", "family": "IH28", "target": spline([0.01, 0.02], [0.1, 0.2]),
                                  "samples": 2, "fixed": tiny, "verify": True})
    assert answer["parameters"] == tiny and "no such structure" in answer["message"]
    assert answer["profile"]["verified"]["y"] == [None, None] and "relative_rms" not in answer["profile"]["verified"]


# --- sessions, jobs ------------------------------------------------------------------------------------------------------


def in_background(api: Api, document: Dict[str, Any]) -> "tuple[threading.Thread, List[requests.Response]]":
    """Sends a request for an immediate answer in another thread."""
    received: List[requests.Response] = []
    thread = threading.Thread(target=lambda: received.append(
        requests.post(api.server.url + DESIGNS, json=document, timeout=PATIENCE_SECONDS)))
    thread.start()
    comes_true(api.busy, "the computation starts")
    return thread, received


def quick_request(**more: Any) -> Dict[str, Any]:
    return {"task": "stress_strain", "family": "IH29", "target": spline([0.01, 0.03], [0.01, 0.03]), "samples": 2,
            "accuracy": {"candidates": 4, "starts": 1}, **more}


def test_a_newer_request_of_a_session_replaces_an_immediate_one(designs: Api) -> None:
    thread, received = in_background(designs, long_request(session="drag-1"))
    work = WorkingTime(designs.server.pid)
    designs.ok(DESIGNS, quick_request(session="drag-1"))
    thread.join(PATIENCE_SECONDS)
    work.check(20, "the older request goes on")
    (older,) = received
    designs.contract.check_response("POST", DESIGNS, older.status_code, older.headers, older.content)
    assert (older.status_code, problem_code(older)) == (409, "design.superseded")


def test_a_newer_request_of_a_session_replaces_a_job(designs: Api) -> None:
    job = start_job(designs, DESIGNS, long_request(session="drag-2"))
    designs.wait_for_job(job, ("running",))
    other = start_job(designs, DESIGNS, quick_request(session="drag-2"))
    document = designs.wait_for_job(job)
    assert (document["state"], document["error"]["code"]) == ("failed", "design.superseded")
    result = designs.get(f"/v1/jobs/{job}/result")
    assert (result.status_code, problem_code(result)) == (409, "design.superseded")
    assert designs.wait_for_job(other)["state"] == "successful"


def test_other_sessions_go_on(designs: Api) -> None:
    jobs = [start_job(designs, DESIGNS, long_request(**more)) for more in ({"session": "a"}, {})]
    designs.ok(DESIGNS, quick_request(session="b"))
    designs.ok(DESIGNS, quick_request())
    for job in jobs:
        assert designs.get(f"/v1/jobs/{job}").json()["state"] in ("accepted", "running")
        designs.delete(f"/v1/jobs/{job}")


def test_a_session_that_has_ended_replaces_nothing(designs: Api) -> None:
    for _ in range(3):
        designs.ok(DESIGNS, quick_request(session="again"))


def test_events_carry_the_best_design_so_far(designs: Api) -> None:
    request = {**known_problem(designs), "target": spline([-0.05, 0.1], [-0.1, 0.3]), "samples": 60, "name": "heel",
               "accuracy": {"candidates": 64, "starts": 6, "tolerance": 1e-10}, "effects": {"multi_start": "on"}}
    job = start_job(designs, DESIGNS, request)
    seen = [document for _, document in events(designs, job)]
    partial = [document["partial"] for document in seen if "partial" in document]
    assert partial, "no event had a partial design"
    for best in partial:
        assert (best["family"], best["model"], best["name"]) == ("IH67", "ih67", "heel")
        assert len(best["x"]) == len(best["achieved"]) and len(best["parameters"]) == 2
        assert len(best["x"]) in (11, 60), "some of the samples at first, then all"
    errors = [best["error"]["relative_rms"] for best in partial]
    assert errors == sorted(errors, reverse=True), "partial designs only become better"
    answer = designs.get(f"/v1/jobs/{job}/result").json()
    assert "error" in answer, answer
    assert answer["error"]["relative_rms"] <= errors[-1] + 0.01, "errors at all samples and at some of them differ little"
    assert "partial" not in designs.get(f"/v1/jobs/{job}").json(), "a finished job has its result instead"


def test_delete_ends_a_search_within_a_moment(designs: Api) -> None:
    job = start_job(designs, DESIGNS, long_request())
    designs.wait_for_job(job, ("running",))
    work = WorkingTime(designs.server.pid)
    comes_true(lambda: work.seconds() > 0.3, "the search computes")
    assert designs.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
    ends_within(designs.server.pid, designs.busy, 5, "the search goes on")


@pytest.mark.parametrize("family", ["IH67", "any"])
def test_a_deadline_gives_the_best_design_until_then(designs: Api, family: str) -> None:
    late = {**long_request(deadline=2 * SLOWNESS), "family": family, "verify": True}
    late["accuracy"]["candidates"] = 64  # so that the first design is found in good time
    answer = designs.ok(DESIGNS, late)
    assert answer["stopped"] == "deadline" and answer["ways_out"] == [] and answer["polish"] is None
    assert answer["message"].endswith("The deadline passed before the search had ended: this is the best design until then.")
    assert answer["verdict"]["source"] == "model" and answer["profile"]["verified"] is None
    assert answer["ranking"][0]["parameters"] == answer["parameters"] and len(answer["profile"]["achieved"]) == 500
    for name, why in (("verification", "the deadline passed during the search"), ("ways_out", "the search for the design was stopped")):
        assert (effect(answer, name)["ran"], effect(answer, name)["why"]) == (False, why)
    job = start_job(designs, DESIGNS, late)
    assert designs.wait_for_job(job)["state"] == "successful"
    assert designs.get(f"/v1/jobs/{job}/result").json()["stopped"] == "deadline"


def test_a_deadline_before_the_first_design_is_an_error(designs: Api) -> None:
    response = designs.post(DESIGNS, long_request(deadline=1e-4))
    assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")


# --- profiles ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("direction", [0.0, 0.7, 2.0])
def test_stress_over_strain_is_that_of_the_models_uniaxial_load(designs: Api, direction: float) -> None:
    strains = [0.02, 0.05, 0.1]
    answer = profile(designs, "stress_strain", strains, direction=direction)
    states = designs.ok("/v1/models/ih67/uniaxial", {"parameters": KNOWN["IH67"], "direction": direction,
                                                     "green_strains": strains})["states"]
    np.testing.assert_allclose(answer["y"], [state["directional_stress"] for state in states], rtol=1e-7)
    assert answer["direction"] == direction and answer["model"] == "ih67" and "strain" not in answer


def test_the_profiles_at_rest_are_those_of_the_stiffness(designs: Api) -> None:
    x = [0.0, 0.4, 1.3, 2.2]
    tangent = np.array(designs.ok("/v1/models/ih67/evaluations", {
        "parameters": [KNOWN["IH67"]], "green_strain": [[0, 0, 0]], "derivatives": 2})["tangent"][0])
    compliance = np.linalg.inv(tangent)
    stiffness, poisson = (profile(designs, task, x, strain=0)["y"] for task in ("stiffness", "poisson"))
    for angle, modulus, ratio in zip(x, stiffness, poisson):
        c, s = np.cos(angle), np.sin(angle)
        along, across = np.array([c * c, s * s, c * s]), np.array([s * s, c * c, -c * s])
        strain = compliance @ along
        assert modulus == pytest.approx(1 / (along @ strain), rel=1e-6)
        assert ratio == pytest.approx(-(across @ strain) / (along @ strain), rel=1e-5, abs=1e-8)


def test_the_stiffness_of_a_profile_is_the_slope_of_stress_over_strain(designs: Api) -> None:
    step, direction = 1e-4, 0.6
    below, above = profile(designs, "stress_strain", [0.05 - step, 0.05 + step], direction=direction)["y"]
    (stiffness,) = profile(designs, "stiffness", [direction], strain=0.05)["y"]
    assert stiffness == pytest.approx((above - below) / (2 * step), rel=1e-5)


def test_engineering_strain_and_stress_are_stretch_and_force(designs: Api) -> None:
    green = [-0.05, 0.04, 0.1]
    stretches = [np.sqrt(1 + 2 * strain) for strain in green]
    second = profile(designs, "stress_strain", green)["y"]
    first = profile(designs, "stress_strain", [s - 1 for s in stretches], strain_measure="engineering")
    np.testing.assert_allclose(first["y"], np.multiply(second, stretches), rtol=1e-7)
    assert first["strain_measure"] == "engineering"
    moduli = [profile(designs, "stiffness", [0.3], **where)["y"][0] for where in (
        {"strain": 0.04}, {"strain": stretches[1] - 1, "strain_measure": "engineering"})]
    assert moduli[0] == pytest.approx(moduli[1], rel=1e-7), "stiffness stays that of Green strain"


def test_samples_may_come_in_any_order(designs: Api) -> None:
    x = [0.08, -0.04, 0.02, 0, -0.08]
    shuffled, ordered = (profile(designs, "stress_strain", places)["y"] for places in (x, sorted(x)))
    np.testing.assert_allclose(shuffled, [ordered[sorted(x).index(place)] for place in x], rtol=1e-8, atol=1e-14)


def test_ranges_and_samples_are_as_the_contract_says(designs: Api) -> None:
    request = {"family": "IH29", "parameters": KNOWN["IH29"]}
    strains = designs.ok(PROFILES, {**request, "task": "stress_strain"})
    np.testing.assert_allclose(strains["x"], np.linspace(-0.1, 0.2, 31), atol=1e-15)
    directions = designs.ok(PROFILES, {**request, "task": "poisson"})
    np.testing.assert_allclose(directions["x"], np.pi * np.arange(50) / 50)
    assert directions["strain"] == 0.05 and "direction" not in directions
    chosen = designs.ok(PROFILES, {**request, "task": "stress_strain", "range": [0, 0.1], "samples": 3})
    assert chosen["x"] == pytest.approx([0, 0.05, 0.1])
    assert len(designs.ok(PROFILES, {**request, "task": "stiffness", "samples": 7})["y"]) == 7


def test_a_profile_says_what_lies_outside_of_the_training(designs: Api) -> None:
    answer = profile(designs, "stress_strain", [0.02, 2.0])
    assert answer["in_range"] == [True, False]
    assert profile(designs, "stress_strain", [0.02], parameters=[0.5, 0.9])["in_range"] == [False]


@pytest.mark.parametrize("task, limit", [("stress_strain", 0.05), ("stiffness", 0.1), ("poisson", 0.1)])
def test_each_value_has_an_error_bar_and_long_ones_are_not_in_range(designs: Api, task: str, limit: float) -> None:
    x = [-0.2, -0.05, 0, 0.1, 0.4] if task == "stress_strain" else [0, 0.5, 1, 2, 3]
    said = set()
    for share in np.linspace(0, 1, 9):
        bounds = designs.get("/v1/models/ih67").json()["parameters"]
        parameters = [low + share * (high - low) for low, high in zip(bounds["lower"], bounds["upper"])]
        answer = designs.ok(PROFILES, {"task": task, "family": "IH67", "parameters": parameters, "x": x,
                                       **({} if task == "stress_strain" else {"strain": -0.1})})
        for y, bar, inside in zip(answer["y"], answer["error_bar"], answer["in_range"]):
            if bar is None:
                assert not inside
                continue
            longest = limit * (1 if task == "poisson" else abs(y))
            assert bar >= 0 and (bar == longest or inside == (bar <= longest))
            said.add(inside)
    assert said == {True, False}, "bars tell places apart"


@pytest.mark.parametrize("family", list(KNOWN))
def test_a_design_has_the_error_bars_of_designs_that_searches_find(designs: Api, family: str) -> None:
    """Searched designs have other error bars than given ones, as a profile has, since these come from other simulations."""
    assert "searched" in designs.get(f"/v1/models/{family.lower()}").json()["error_bars"]["stress_at_strain"]
    answer = designs.ok(DESIGNS, known_problem(designs, family=family))
    again = profile(designs, "stress_strain", answer["profile"]["x"], family=family, parameters=answer["parameters"],
                    direction=answer["profile"]["direction"])
    np.testing.assert_allclose(again["y"], answer["profile"]["achieved"], rtol=1e-6, atol=1e-12)
    ratios = np.array(answer["profile"]["error_bar"]) / np.array(again["error_bar"])
    assert ((ratios > 0.3) & (ratios < 5)).all() and (abs(ratios - 1) > 1e-3).any(), ratios


def test_error_bars_are_unknown_outside_of_the_training(designs: Api) -> None:
    answer = profile(designs, "stress_strain", [0, 0.02, 2.0])
    assert answer["error_bar"][0] < 1e-15 and answer["error_bar"][1] > 0 and answer["error_bar"][2] is None


def test_the_model_says_what_its_error_bars_are_worth(designs: Api) -> None:
    bars = designs.get("/v1/models/ih67").json()["error_bars"]
    assert bars["level"] == 0.9 and bars["judged_by"] in ("fresh", "held_out")
    for quantity in ("stress", "stiffness", "poisson", "stress_at_strain"):
        assert bars[quantity]["designs"] > 20 and 0.88 <= bars[quantity]["share"] <= 0.97


def test_profiles_are_jobs_where_the_client_prefers_it(designs: Api) -> None:
    request = {"task": "poisson", "family": "IH29", "parameters": KNOWN["IH29"]}
    job = start_job(designs, PROFILES, request)
    assert designs.wait_for_job(job)["kind"] == "profiles"
    assert answers(designs.get(f"/v1/jobs/{job}/result").json()) == answers(designs.ok(PROFILES, request))


def test_the_contract_names_the_defaults_that_the_server_has(designs: Api) -> None:
    schemas = designs.contract.spec["components"]["schemas"]
    accuracy = {name: schema.get("default") for name, schema in schemas["DesignAccuracy"]["properties"].items()}
    spelled = {**{name: value for name, value in accuracy.items() if value is not None}, "candidates": 40, "starts": 16}
    request = {**known_problem(designs, family="IH29"), "accuracy": {}}
    plain, explicit = (designs.ok(DESIGNS, {**request, **more}) for more in (
        {}, {"accuracy": spelled, "effects": {"multi_start": "automatic", "envelope": "automatic", "trust": "automatic"}, "verify": False,
             "strain_measure": "green"}))
    assert answers(plain) == answers(explicit)
    assert plain["accuracy"]["tolerance"] == accuracy["tolerance"]
    assert plain["accuracy"]["equilibrium_tolerance"] == accuracy["equilibrium_tolerance"]
    assert plain["accuracy"]["residual"] <= accuracy["equilibrium_tolerance"]


# --- refusals ----------------------------------------------------------------------------------------------------------

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
