"""Networks on moving hosts: a surface with given positions, and a shell or a solid with moved vertices."""

from __future__ import annotations

from typing import Any, List

import numpy as np
import pytest

from elastic_networks import NETWORKS, SHELL, effect, net, springs
from harness import Api, pointers, problem_code
from shapes import sphere
from test_jobs import events, start_job


def moved(vertices: Any, chosen: Any, *ways: Any) -> List[Any]:
    return [{"vertex": int(i), "positions": [(vertices[i] + way).tolist() for way in ways]} for i in chosen]


def test_a_network_follows_a_surface_that_moves(api: Api, sphere_mesh: str) -> None:
    vertices, faces = sphere(3)
    stretched = [vertices * np.array([1 + share / 2, 1, 1]) for share in (0.25, 0.5, 0.75, 1)]
    answer = api.ok(NETWORKS, net(sphere_mesh, host={"kind": "moving", "positions": [p.tolist() for p in stretched]}))
    assert answer["stopped"] == "converged"
    stops = answer["host"]["stops"]
    assert [stop["stopped"] for stop in stops] == ["converged"] * 4
    assert sum(stop["iterations"] for stop in stops) <= answer["iterations"]
    assert stops[-1]["energy"] == answer["energy"]
    np.testing.assert_allclose(answer["host"]["vertices"], stretched[-1])
    assert answer["host"]["volume_ratio"] == pytest.approx(1.5)
    # The same points are in equilibrium on a mesh that has that shape from the start.
    same = api.upload(stretched[-1], faces)
    again = api.ok(NETWORKS, {**net(same), "points": answer["points"]})
    assert again["energy"] == pytest.approx(answer["energy"], rel=1e-9)
    np.testing.assert_allclose(again["positions"], answer["positions"], atol=1e-6)


def test_a_surface_that_turns_moves_no_point_of_its_network(api: Api, sphere_mesh: str) -> None:
    vertices = sphere(3)[0]
    # There are no fixed points, and springs are compressed, so that the network could rotate.
    request = {"mesh": sphere_mesh, "points": [{"vertex": 3}, {"vertex": 40}, {"vertex": 71}],
               "springs": springs((0, 1), (1, 2), (2, 0), rest_length=1.2)}
    rest = api.ok(NETWORKS, request)
    points = [{"face": p["face"], "barycentric": p["barycentric"]} for p in rest["points"]]
    cosine, sine = np.cos(0.4), np.sin(0.4)
    turned = vertices @ np.array([[1, 0, 0], [0, cosine, sine], [0, -sine, cosine]])
    positions = [vertices.tolist(), turned.tolist(), (turned * (1 + 1e-9)).tolist()]
    answer = api.ok(NETWORKS, {**request, "points": points, "host": {"kind": "moving", "positions": positions}})
    for stop in answer["host"]["stops"]:
        assert stop["jumps"] == 0 and stop["energy"] == pytest.approx(rest["energy"], rel=1e-7, abs=1e-14)
    assert [p["face"] for p in answer["points"]] == [p["face"] for p in points]
    np.testing.assert_allclose([p["barycentric"] for p in answer["points"]], [p["barycentric"] for p in points], atol=1e-6)
    assert not any("the equilibrium was lost" in warning for warning in answer["warnings"])


@pytest.mark.parametrize("kind", ["shell", "solid"])
def test_moved_vertices_take_host_and_network_along(api: Api, sphere_mesh: str, kind: str) -> None:
    vertices = sphere(3)[0]
    base = {**SHELL, "volume_weight": 0} if kind == "shell" else {"kind": "solid", "youngs_modulus": 100, "element_size": 0.5}
    bottom, top = np.flatnonzero(vertices[:, 2] < -0.7), np.flatnonzero(vertices[:, 2] > 0.9)
    ways = np.array([[0.1, 0, 0.1], [0.3, 0, 0.2]])
    host = {**base, "fixed_vertices": bottom.tolist(), "moved_vertices": moved(vertices, top, *ways)}
    answer = api.ok(NETWORKS, net(sphere_mesh, host=host))
    assert answer["stopped"] == "converged" and answer["gradient_norm"] <= answer["accuracy"]["gradient_tolerance"]
    stops = answer["host"]["stops"]
    assert [(stop["stopped"], stop["reached"]) for stop in stops] == [("converged", 1)] * 2
    assert stops[-1]["energy"] == answer["energy"] and sum(stop["iterations"] for stop in stops) <= answer["iterations"]
    seen = np.array(answer["host"]["vertices"])
    np.testing.assert_allclose(seen[top], vertices[top] + ways[1], atol=1e-12)
    np.testing.assert_array_equal(seen[bottom], vertices[bottom])
    assert effect(answer, "moved_vertices")["ran"] is True
    # A partial result has the surface between its positions.
    middle = np.abs(vertices[:, 2]) < 0.2
    assert 0 < (seen - vertices)[middle, 0].mean() < 0.3


def test_events_of_moved_vertices_show_them_on_their_way(api: Api, sphere_mesh: str) -> None:
    vertices = sphere(3)[0]
    bottom, top = np.flatnonzero(vertices[:, 2] < -0.7), np.flatnonzero(vertices[:, 2] > 0.9)
    host = {**SHELL, "volume_weight": 0, "fixed_vertices": bottom.tolist(),
            "moved_vertices": moved(vertices, top, *[np.array([0.05, 0, 0.05]) * k for k in range(1, 5)])}
    job = start_job(api, NETWORKS, net(sphere_mesh, host=host))
    documents = [document for _, document in events(api, job)]
    heights = [document["partial"]["vertices"][top[0]][0] - vertices[top[0], 0] for document in documents if document.get("partial")]
    assert heights[0] == 0 and any(0 < height < 0.2 for height in heights)
    shares = [document["progress"] for document in documents]
    assert shares == sorted(shares)


def test_moved_vertices_stop_where_a_solid_would_be_turned_inside_out(api: Api) -> None:
    vertices, faces = sphere(1)
    bottom, top = np.flatnonzero(vertices[:, 2] < -0.4), np.flatnonzero(vertices[:, 2] > 0.4)
    # The top would become its mirror image, and would be flat halfway.
    mirrored = [{"vertex": int(i), "positions": [(vertices[i] * [-1, 1, 1]).tolist(), vertices[i].tolist()]} for i in top]
    host = {"kind": "solid", "youngs_modulus": 100, "fixed_vertices": bottom.tolist(), "moved_vertices": mirrored}
    request = {"points": [{"vertex": 0}, {"vertex": 1}], "springs": springs((0, 1)), "fixed_points": [0]}
    answer = api.ok(NETWORKS, {**request, "mesh": api.upload(vertices, faces), "host": host})
    (stop,) = answer["host"]["stops"]
    assert 0.4 < stop["reached"] < 0.5 and stop["stopped"] == answer["stopped"] != "converged"
    assert any("Moved vertices came" in warning for warning in answer["warnings"])
    assert 0 < answer["host"]["volume_ratio"] < 1


def test_a_deadline_ends_the_way_of_moved_vertices(api: Api, sphere_mesh: str) -> None:
    vertices = sphere(3)[0]
    bottom, top = np.flatnonzero(vertices[:, 2] < -0.7), np.flatnonzero(vertices[:, 2] > 0.9)
    ways = [np.array([np.cos(a), np.sin(a), 1]) for a in np.linspace(0, 60, 1000)]
    host = {**SHELL, "volume_weight": 0, "fixed_vertices": bottom.tolist(), "moved_vertices": moved(vertices, top, *ways)}
    answer = api.ok(NETWORKS, net(sphere_mesh, host=host, deadline=1))
    assert answer["stopped"] == "deadline" and answer["warnings"][-1].startswith("The deadline passed ")


def test_positions_that_are_not_those_of_the_mesh_are_named(api: Api, sphere_mesh: str) -> None:
    vertices = sphere(3)[0]
    for wrong in (vertices[:-1], 0 * vertices):
        host = {"kind": "moving", "positions": [vertices.tolist(), wrong.tolist()]}
        response = api.post(NETWORKS, net(sphere_mesh, host=host))
        assert (response.status_code, problem_code(response)) == (422, "host.positions")
        assert pointers(response) == ["/host/positions/1"]
