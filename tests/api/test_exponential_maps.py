"""Straightest paths over HTTP."""

from __future__ import annotations

import numpy as np
import pytest

from harness import Api
from shapes import flat_grid

MAPS = "/v1/exponential-maps"


def test_on_a_flat_square_the_end_is_start_plus_tangent(api: Api, grid_mesh: str) -> None:
    vertices, faces = flat_grid(8)
    start = {"face": 50, "barycentric": [0.2, 0.3, 0.5]}
    tangent = [-0.21, -0.17, 0.0]
    answer = api.ok(MAPS, {"mesh": grid_mesh, "start": start, "tangent": tangent})
    origin = np.array(start["barycentric"]) @ vertices[faces[50]]
    np.testing.assert_allclose(answer["position"], origin + tangent, atol=1e-12)
    assert answer["length"] == pytest.approx(np.linalg.norm(tangent)) and not answer["reached_boundary"]
    trace = np.array([point["position"] for point in answer["trace"]])
    assert np.linalg.norm(np.diff(trace, axis=0), axis=1).sum() == pytest.approx(answer["length"], rel=1e-12)


def test_at_the_boundary_the_path_stops_and_says_so(api: Api, grid_mesh: str) -> None:
    answer = api.ok(MAPS, {"mesh": grid_mesh, "start": {"face": 50, "barycentric": [0.2, 0.3, 0.5]}, "tangent": [5.0, 0, 0]})
    assert answer["reached_boundary"] and answer["length"] < 1
    assert answer["position"][0] == pytest.approx(1)
    assert answer["accuracy"]["requested_length"] == pytest.approx(5)


def test_for_short_steps_it_is_undone_by_the_geodesic_back(api: Api, sphere_mesh: str) -> None:
    start = {"face": 100, "barycentric": [0.3, 0.3, 0.4]}
    answer = api.ok(MAPS, {"mesh": sphere_mesh, "start": start, "tangent": [0.05, 0.02], "trace": False})
    assert "trace" not in answer
    request = {"mesh": sphere_mesh, "pairs": [{"from": start, "to": answer["end"]}], "derivatives": 1}
    (result,) = api.ok("/v1/geodesics", request)["results"]
    assert result["distance"] == pytest.approx(np.hypot(0.05, 0.02), rel=1e-9)
    np.testing.assert_allclose(-result["distance"] * np.array(result["gradient"]["tangent"][:2]), [0.05, 0.02], atol=1e-9)


def test_a_zero_vector_stays_where_it_is(api: Api, sphere_mesh: str) -> None:
    start = {"face": 100, "barycentric": [0.3, 0.3, 0.4]}
    answer = api.ok(MAPS, {"mesh": sphere_mesh, "start": start, "tangent": [0, 0, 0]})
    assert (answer["length"], answer["end_direction"], answer["end"]["face"]) == (0, [0, 0, 0], 100)
