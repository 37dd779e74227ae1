"""Inverse design over HTTP: known designs are found again, targets out of reach, several targets, regions, effects."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Callable

import numpy as np
import pytest

from contract import Contract
from design_requests import DESIGNS, FEW, KNOWN, answers, effect, known_problem, profile, spline
from harness import ROOT, Api, ServerProcess, problem_code
from test_jobs import start_job


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
