"""Karcher means over HTTP."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Api, pointers, problem_code
from shapes import flat_grid, two_triangles_apart

MEANS = "/v1/karcher-means"


@pytest.mark.parametrize("method", ["newton", "lbfgs", "gradient_descent"])
def test_on_a_flat_square_the_mean_is_the_weighted_average(api: Api, grid_mesh: str, method: str) -> None:
    vertices, _ = flat_grid(8)
    chosen, weights = [3, 40, 70, 22], [1.0, 2.5, 0.5, 0.0]
    request = {"mesh": grid_mesh, "points": [{"vertex": v} for v in chosen], "weights": weights, "method": method}
    answer = api.ok(MEANS, request)
    assert answer["stopped"] == "converged"
    np.testing.assert_allclose(answer["position"], np.average(vertices[chosen], axis=0, weights=weights), atol=1e-8)


def test_newton_converges_quadratically_to_the_tolerance_and_shows_its_history(api: Api, sphere_mesh: str) -> None:
    points = [{"vertex": v} for v in (5, 77, 130, 300, 411)]
    answer = api.ok(MEANS, {"mesh": sphere_mesh, "points": points, "tolerance": 1e-9})
    assert answer["stopped"] in ("converged", "kink")
    assert answer["gradient_norm"] <= answer["accuracy"]["gradient_tolerance"] or answer["stopped"] == "kink"
    assert len(answer["history"]) == answer["iterations"] + 1
    objectives = [step["objective"] for step in answer["history"]]
    assert all(later <= earlier * (1 + 1e-12) for earlier, later in zip(objectives, objectives[1:]))
    assert answer["objective"] == pytest.approx(objectives[-1], rel=1e-9)
    assert answer["iterations"] <= 30


def test_the_mean_is_where_the_weighted_gradients_cancel(api: Api, sphere_mesh: str) -> None:
    points = [{"face": f, "barycentric": [0.3, 0.4, 0.3]} for f in (10, 200, 333)]
    answer = api.ok(MEANS, {"mesh": sphere_mesh, "points": points})
    assert answer["stopped"] == "converged"
    pairs = [{"from": point, "to": answer["mean"]} for point in points]
    results = api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": pairs, "derivatives": 1})["results"]
    gradient = sum(r["distance"] * np.array(r["gradient"]["tangent"][2:]) for r in results) / 3
    assert np.linalg.norm(gradient) <= 10 * answer["accuracy"]["gradient_tolerance"]
    assert answer["objective"] == pytest.approx(sum(r["distance"] ** 2 for r in results) / 6, rel=1e-9)


def test_one_point_is_its_own_mean(api: Api, sphere_mesh: str) -> None:
    point = {"face": 9, "barycentric": [0.2, 0.2, 0.6]}
    answer = api.ok(MEANS, {"mesh": sphere_mesh, "points": [point]})
    assert answer["objective"] == pytest.approx(0, abs=1e-16)


def test_kept_fields_and_pair_searches_find_the_same_mean(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": [{"vertex": v} for v in (5, 77, 130)]}
    answers = []
    for switch in ("on", "off"):
        answer = api.ok(MEANS, {**request, "effects": {"kept_fields": switch}})
        (effect,) = [e for e in answer["effects"] if e["name"] == "kept_fields"]
        assert effect["ran"] is (switch == "on") and effect["why"]
        answers.append(answer)
    np.testing.assert_allclose(answers[0]["position"], answers[1]["position"], atol=1e-7)


def test_several_starts_find_a_mean_that_is_no_higher_and_say_which_start_it_was(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": [{"vertex": v} for v in (5, 77, 130, 300, 411)]}
    one = api.ok(MEANS, request)
    several = api.ok(MEANS, {**request, "starts": 6})
    assert one["start"] == 0 and several["start"] in range(6)
    assert several["objective"] <= one["objective"] * (1 + 1e-9)
    assert (several["start"] > 0) is (several["objective"] < one["objective"] * (1 - 1e-9))
    (effect,) = [e for e in several["effects"] if e["name"] == "multi_start"]
    assert effect["ran"] and effect["count"] == 5


def test_the_iteration_limit_is_kept_and_reported(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": [{"vertex": v} for v in (5, 77, 130)], "method": "gradient_descent",
               "max_iterations": 1, "tolerance": 1e-12}
    answer = api.ok(MEANS, request)
    assert (answer["stopped"], answer["iterations"]) == ("iteration_limit", 1)


def test_points_on_different_components_have_no_mean_and_are_named(api: Api) -> None:
    mesh = api.upload(*two_triangles_apart())
    response = api.post(MEANS, {"mesh": mesh, "points": [{"vertex": 0}, {"vertex": 1}, {"vertex": 4}]})
    assert (response.status_code, problem_code(response)) == (422, "karcher.unreachable")
    assert pointers(response) == ["/points/2"]


@pytest.mark.parametrize("weights", [[1.0], [1.0, -1.0], [0.0, 0.0], [1.0, 1.0, 1.0]])
def test_weights_that_mean_nothing_are_refused(api: Api, grid_mesh: str, weights: list) -> None:
    request = {"mesh": grid_mesh, "points": [{"vertex": 0}, {"vertex": 1}], "weights": weights}
    response = api.post(MEANS, request)
    assert (response.status_code, problem_code(response)) == (422, "karcher.weights")


@pytest.mark.parametrize("field, value", [("tolerance", 0), ("tolerance", -1), ("max_iterations", 0), ("starts", 0),
                                          ("starts", 1001), ("method", "magic")])
def test_an_option_outside_its_range_is_pointed_to(api: Api, grid_mesh: str, field: str, value: object) -> None:
    response = api.post(MEANS, {"mesh": grid_mesh, "points": [{"vertex": 0}], field: value}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == [f"/{field}"]
