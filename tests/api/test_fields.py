"""Distance fields as JSON and as raw doubles."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Api, problem_code
from shapes import bumpy_sphere, flat_grid, two_triangles_apart

OCTETS = {"Accept": "application/octet-stream"}


def binary_field(api: Api, request: dict) -> np.ndarray:
    response = api.post("/v1/geodesic-fields", request, headers=OCTETS)
    assert response.status_code == 200, response.text
    assert response.headers["Content-Type"] == "application/octet-stream"
    values = np.frombuffer(response.content, "<f8")
    assert int(response.headers["Supple-Vertices"]) == len(values)
    assert int(response.headers["Supple-Unreached"]) == (values == -1).sum()
    return values


def test_on_a_flat_square_the_field_is_the_straight_distance(api: Api, grid_mesh: str) -> None:
    vertices, _ = flat_grid(8)
    answer = api.ok("/v1/geodesic-fields", {"mesh": grid_mesh, "sources": [{"vertex": 30}]})
    np.testing.assert_allclose(answer["distances"], np.linalg.norm(vertices - vertices[30], axis=1), rtol=1e-12, atol=1e-14)
    assert answer["accuracy"] == {"method": "windows", "relative_error": 0, "relative_error_bound": 0}


def test_several_sources_give_the_distance_to_the_nearest(api: Api, sphere_mesh: str) -> None:
    sources = [{"vertex": 3}, {"face": 700, "barycentric": [0.2, 0.5, 0.3]}, {"vertex": 400}]
    together = binary_field(api, {"mesh": sphere_mesh, "sources": sources})
    alone = [binary_field(api, {"mesh": sphere_mesh, "sources": [source]}) for source in sources]
    np.testing.assert_allclose(together, np.min(alone, axis=0), rtol=1e-12)


def test_the_binary_field_has_the_very_numbers_of_the_json_field(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "sources": [{"face": 17, "barycentric": [0.1, 0.2, 0.7]}]}
    assert binary_field(api, request).tolist() == api.ok("/v1/geodesic-fields", request)["distances"]


def test_vertices_that_no_source_reaches_are_null_and_minus_one(api: Api) -> None:
    request = {"mesh": api.upload(*two_triangles_apart()), "sources": [{"vertex": 0}]}
    answer = api.ok("/v1/geodesic-fields", request)
    assert answer["distances"][3:] == [None] * 3 and answer["unreached"] == 3
    assert binary_field(api, request)[3:].tolist() == [-1, -1, -1]


def test_beyond_the_largest_distance_nothing_is_promised_and_within_it_everything(api: Api, grid_mesh: str) -> None:
    request = {"mesh": grid_mesh, "sources": [{"vertex": 0}]}
    full = binary_field(api, request)
    limited = binary_field(api, {**request, "max_distance": 0.5})
    np.testing.assert_allclose(limited[full <= 0.5], full[full <= 0.5], rtol=1e-12)
    assert (limited == -1).any()


@pytest.mark.parametrize("allowed", [0.1, 0.01, 0.001])
def test_an_allowed_error_is_kept_and_reported(api: Api, allowed: float) -> None:
    mesh = api.upload(*bumpy_sphere(3))
    request = {"mesh": mesh, "sources": [{"vertex": 0}]}
    exact = binary_field(api, request)
    answer = api.ok("/v1/geodesic-fields", {**request, "accuracy": {"relative_error": allowed}})
    approximate = np.array(answer["distances"])
    reached = np.abs(approximate[1:] - exact[1:]) / exact[1:]
    assert reached.max() <= answer["accuracy"]["relative_error_bound"] + 1e-12
    assert answer["accuracy"]["relative_error_bound"] <= allowed


def test_the_edge_graph_is_an_upper_bound_without_a_guarantee(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "sources": [{"vertex": 0}]}
    exact = binary_field(api, request)
    response = api.post("/v1/geodesic-fields", {**request, "accuracy": {"method": "edge_graph"}}, headers=OCTETS)
    bound = np.frombuffer(response.content, "<f8")
    assert (bound >= exact * (1 - 1e-12)).all() and (bound <= 1.3 * exact + 1e-12).all()
    assert response.headers["Supple-Method"] == "edge_graph"
    assert "Supple-Relative-Error-Bound" not in response.headers


def test_a_media_type_that_no_field_has_is_not_acceptable(api: Api, grid_mesh: str) -> None:
    request = {"mesh": grid_mesh, "sources": [{"vertex": 0}]}
    response = api.post("/v1/geodesic-fields", request, headers={"Accept": "text/html"})
    assert (response.status_code, problem_code(response)) == (406, "http.not_acceptable")


@pytest.mark.parametrize("accept", ["*/*", "application/*", "application/json;q=0.5, text/html", "text/html, */*;q=0.1"])
def test_accept_is_understood_as_http_defines_it(api: Api, grid_mesh: str, accept: str) -> None:
    request = {"mesh": grid_mesh, "sources": [{"vertex": 0}]}
    response = api.post("/v1/geodesic-fields", request, headers={"Accept": accept})
    assert response.headers["Content-Type"].startswith("application/json")
