"""Distances, derivatives and paths over HTTP, for cases with known answers."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np
import pytest

from harness import Api
from shapes import flat_grid, sphere, two_triangles_apart

Point = Dict[str, Any]


def positions(mesh: Any, point: Point) -> np.ndarray:
    vertices, faces = mesh
    if "vertex" in point:
        return vertices[point["vertex"]]
    return np.asarray(point["barycentric"]) @ vertices[faces[point["face"]]]


def random_point(stream: np.random.Generator, faces: int) -> Point:
    b = stream.dirichlet([1, 1, 1])
    return {"face": int(stream.integers(faces)), "barycentric": [float(b[0]), float(b[1]), float(1 - b[0] - b[1])]}


def test_on_a_flat_square_geodesics_are_straight_lines(api: Api, grid_mesh: str) -> None:
    mesh = flat_grid(8)
    stream = np.random.default_rng(1)
    pairs = [{"from": random_point(stream, 128), "to": random_point(stream, 128)} for _ in range(200)]
    answer = api.ok("/v1/geodesics", {"mesh": grid_mesh, "pairs": pairs, "paths": True, "derivatives": 2})
    assert len(answer["results"]) == 200
    for pair, result in zip(pairs, answer["results"]):
        a, b = positions(mesh, pair["from"]), positions(mesh, pair["to"])
        length = np.linalg.norm(b - a)
        assert result["distance"] == pytest.approx(length, rel=1e-9)
        path = np.array([point["position"] for point in result["path"]])
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).sum() == pytest.approx(length, rel=1e-9)
        np.testing.assert_allclose(path[[0, -1]], [a, b], atol=1e-12)
        along, across = (b - a) / length, np.cross([0, 0, 1], b - a) / length
        frames = [np.array(result["frames"][end]["axes"]) for end in ("from", "to")]
        gradient = np.concatenate([frames[0] @ -along, frames[1] @ along])
        np.testing.assert_allclose(result["gradient"]["tangent"], gradient, atol=1e-9)
        normal = np.concatenate([frames[0] @ across, -(frames[1] @ across)])
        np.testing.assert_allclose(result["hessian"]["tangent"], np.outer(normal, normal) / length, atol=1e-8 / length)


def test_a_distance_does_not_depend_on_the_order_of_the_ends(api: Api, sphere_mesh: str) -> None:
    stream = np.random.default_rng(2)
    ends = [(random_point(stream, 1280), random_point(stream, 1280)) for _ in range(50)]
    forth = api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": [{"from": a, "to": b} for a, b in ends]})
    back = api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": [{"from": b, "to": a} for a, b in ends]})
    for one, other in zip(forth["results"], back["results"]):
        assert one["distance"] == pytest.approx(other["distance"], rel=1e-10)


def test_the_gradient_is_what_finite_differences_show(api: Api, sphere_mesh: str) -> None:
    start = {"face": 5, "barycentric": [0.3, 0.3, 0.4]}
    step = 1e-5

    def end(shift: float) -> Point:
        return {"face": 700, "barycentric": [0.3 + shift, 0.4 - shift, 0.3]}

    pairs = [{"from": start, "to": end(s)} for s in (-step, 0, step)]
    low, middle, high = api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": pairs, "derivatives": 2})["results"]
    direction = np.array([0, 0, 0, 1, -1, 0])
    slope = (high["distance"] - low["distance"]) / (2 * step)
    curvature = (np.array(high["gradient"]["barycentric"]) - low["gradient"]["barycentric"]) @ direction / (2 * step)
    assert np.array(middle["gradient"]["barycentric"]) @ direction == pytest.approx(slope, rel=1e-6, abs=1e-9)
    assert direction @ np.array(middle["hessian"]["barycentric"]) @ direction == pytest.approx(curvature, rel=1e-5, abs=1e-7)


def test_points_of_different_components_are_unreachable_rather_than_an_error(api: Api) -> None:
    mesh = api.upload(*two_triangles_apart())
    pairs = [{"from": {"vertex": 0}, "to": {"vertex": 4}}, {"from": {"vertex": 0}, "to": {"vertex": 1}}]
    apart, near = api.ok("/v1/geodesics", {"mesh": mesh, "pairs": pairs, "derivatives": 2, "paths": True})["results"]
    assert apart == {"distance": None, "unreachable": True}
    assert near["unreachable"] is False and near["distance"] == pytest.approx(1)


def test_coincident_ends_have_distance_zero_and_no_derivatives(api: Api, sphere_mesh: str) -> None:
    point = {"face": 3, "barycentric": [0.25, 0.25, 0.5]}
    result = api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": [{"from": point, "to": point}], "derivatives": 2})
    (result,) = result["results"]
    assert result["distance"] == 0 and result["differentiable"] is False
    assert "gradient" not in result and "hessian" not in result


def test_opposite_points_of_a_sphere_are_near_the_cut_locus(api: Api) -> None:
    vertices, faces = sphere(2)
    mesh = api.upload(vertices, faces)
    opposite = int(np.argmin(vertices @ vertices[0]))
    pairs = [{"from": {"vertex": 0}, "to": {"vertex": opposite}}, {"from": {"vertex": 0}, "to": {"vertex": 50}}]
    far, near = api.ok("/v1/geodesics", {"mesh": mesh, "pairs": pairs})["results"]
    assert far["near_cut_locus"] is True
    assert near["near_cut_locus"] is False


def test_a_known_path_changes_nothing_but_the_work(api: Api, sphere_mesh: str) -> None:
    pair = {"from": {"vertex": 1}, "to": {"vertex": 400}}
    (first,) = api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": [pair], "paths": True})["results"]
    known = [{"face": p["face"], "barycentric": p["barycentric"]} for p in first["path"]]
    (second,) = api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": [{**pair, "known_path": known}]})["results"]
    assert second["distance"] == pytest.approx(first["distance"], rel=1e-12)


def test_the_same_request_has_the_same_answer_to_the_last_bit(api: Api, sphere_mesh: str) -> None:
    stream = np.random.default_rng(3)
    pairs = [{"from": random_point(stream, 1280), "to": random_point(stream, 1280)} for _ in range(20)]
    request = {"mesh": sphere_mesh, "pairs": pairs, "derivatives": 2, "paths": True}
    assert api.ok("/v1/geodesics", request)["results"] == api.ok("/v1/geodesics", request)["results"]


def test_the_mollifier_runs_only_where_it_is_asked_for_and_says_so(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "pairs": [{"from": {"vertex": 0}, "to": {"vertex": 99}}], "derivatives": 1}
    for switch, expected in (("automatic", False), ("off", False), ("on", True)):
        answer = api.ok("/v1/geodesics", {**request, "effects": {"mollifier": switch}})
        (effect,) = [e for e in answer["effects"] if e["name"] == "mollifier"]
        assert effect["ran"] is expected and effect["why"], switch


def test_too_many_pairs_name_the_limit_the_value_and_the_setting(api: Api, grid_mesh: str) -> None:
    pair = {"from": {"vertex": 0}, "to": {"vertex": 1}}
    response = api.post("/v1/geodesics", {"mesh": grid_mesh, "pairs": [pair] * 100_001}, faulty=True)
    problem = response.json()
    assert (response.status_code, problem["code"]) == (400, "request.limit_exceeded")
    assert (problem["limit"], problem["value"], problem["setting"]) == (100_000, 100_001, "--max-pairs")
