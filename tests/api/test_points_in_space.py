"""Points in space, and coordinates of single precision, in all requests that accept a point of a surface."""

from __future__ import annotations

import http.client
import json
import os
import subprocess
import time
from pathlib import Path
from typing import Any, Callable, Dict, List

import numpy as np
import pytest

import supple
from contract import Contract
from harness import CLI, Api, ServerProcess, pointers, problem_code, slow_relaxation
from shapes import bumpy_sphere, flat_grid, obj_text
from working_time import PATIENCE_SECONDS

# Points for the grid of side 1 in the plane z = 0: above the interior of a face, beyond a corner, and at a vertex.
ABOVE = {"position": [0.3, 0.1, 0.25]}
BEYOND = {"position": [1.3, 1.4, 0]}
ON_VERTEX = {"position": [0, 0.5, 0]}


@pytest.fixture(scope="module")
def grid() -> Any:
    return flat_grid(4)


@pytest.fixture
def mesh(api: Api, grid: Any) -> str:
    return api.upload(*grid)


def requests_with(mesh: str, points: List[Dict[str, Any]]) -> Dict[str, Dict[str, Any]]:
    a, b, c = points
    springs = [{"between": [0, 1], "rest_length": 0.1}, {"between": [1, 2], "rest_length": 0.1}]
    return {
        "geodesics": {"mesh": mesh, "pairs": [{"from": a, "to": b}, {"from": b, "to": c}]},
        "geodesic-fields": {"mesh": mesh, "sources": points},
        "karcher-means": {"mesh": mesh, "points": points, "start": a},
        "exponential-maps": {"mesh": mesh, "start": a, "tangent": [0.1, 0.1, 0]},
        "voronoi-diagrams": {"mesh": mesh, "sites": points},
        "voronoi-optimizations": {"mesh": mesh, "sites": points, "objectives": {"centroidal": 1}, "max_iterations": 2},
        "embedded-systems": {"mesh": mesh, "points": points, "springs": springs, "max_iterations": 3},
    }


POINTERS = {
    "geodesics": ["/pairs/0/from", "/pairs/0/to", "/pairs/1/from", "/pairs/1/to"],
    "geodesic-fields": ["/sources/0", "/sources/1", "/sources/2"],
    "karcher-means": ["/points/0", "/points/1", "/points/2", "/start"],
    "exponential-maps": ["/start"],
    "voronoi-diagrams": ["/sites/0", "/sites/1", "/sites/2"],
    "voronoi-optimizations": ["/sites/0", "/sites/1", "/sites/2"],
    "embedded-systems": ["/points/0", "/points/1", "/points/2"],
}
DISTANCES = {str(ABOVE): 0.25, str(BEYOND): 0.5, str(ON_VERTEX): 0.0}


@pytest.mark.parametrize("endpoint", POINTERS)
def test_the_nearest_point_is_used_and_the_answer_says_which_and_how_far(api: Api, mesh: str, grid: Any, endpoint: str) -> None:
    points = [ABOVE, BEYOND, ON_VERTEX]
    request = requests_with(mesh, points)[endpoint]
    answer = api.ok(f"/v1/{endpoint}", request)
    placed = answer["points_in_space"]
    assert [entry["pointer"] for entry in placed] == POINTERS[endpoint]
    vertices, faces = grid
    by_position = {tuple(entry["position"]): entry for entry in placed}
    for entry in placed:
        np.testing.assert_allclose(np.array(entry["barycentric"]) @ vertices[faces[entry["face"]]], entry["position"], atol=1e-15)
    assert by_position[(0.3, 0.1, 0.0)]["distance"] == 0.25
    if endpoint != "exponential-maps":
        assert by_position[(1.0, 1.0, 0.0)]["distance"] == pytest.approx(0.5)
        assert by_position[(0.0, 0.5, 0.0)]["distance"] == 0
    # The same points, given by their faces, give the same answer.
    named = {entry["pointer"]: {"face": entry["face"], "barycentric": entry["barycentric"]} for entry in placed}
    by_face = [named[p] for p in POINTERS[endpoint]][:3]
    if endpoint == "geodesics":
        by_face = [named["/pairs/0/from"], named["/pairs/0/to"], named["/pairs/1/to"]]
    elif endpoint == "exponential-maps":
        by_face = [named["/start"]] * 3
    again = api.ok(f"/v1/{endpoint}", requests_with(mesh, by_face)[endpoint])
    assert "points_in_space" not in again
    for key in again.keys() - {"cost", "effects"}:
        assert again[key] == answer[key], key


def test_files_tell_the_largest_distance_in_a_header(api: Api, mesh: str) -> None:
    points = [ABOVE, BEYOND, ON_VERTEX]
    for endpoint, accept in [("geodesic-fields", "application/octet-stream"), ("voronoi-diagrams", "model/obj"),
                             ("embedded-systems", "model/obj")]:
        answer = api.post(f"/v1/{endpoint}", requests_with(mesh, points)[endpoint], headers={"Accept": accept})
        assert float(answer.headers["Supple-Largest-Distance"]) == pytest.approx(0.5), endpoint
        vertices = [{"vertex": 0}, {"vertex": 7}, {"vertex": 20}]
        answer = api.post(f"/v1/{endpoint}", requests_with(mesh, vertices)[endpoint], headers={"Accept": accept})
        assert "Supple-Largest-Distance" not in answer.headers


@pytest.mark.parametrize("point, place", [
    ({"position": [0, 1]}, "/pairs/0/from/position"), ({"position": [0, 1, "2"]}, "/pairs/0/from/position/2"),
    ({"position": [0, 1, 2e70]}, "/pairs/0/from/position/2"), ({"position": [0, 1, 2], "vertex": 3}, "/pairs/0/from/vertex"),
    ({"position": None}, "/pairs/0/from/position"),
])
def test_a_position_that_is_none_is_refused_and_named(api: Api, mesh: str, point: Dict[str, Any], place: str) -> None:
    request = {"mesh": mesh, "pairs": [{"from": point, "to": {"vertex": 0}}]}
    response = api.post("/v1/geodesics", request, faulty=True)
    assert (response.status_code, pointers(response)) == (400, [place])


def test_a_known_path_may_run_through_points_in_space(api: Api, mesh: str) -> None:
    pair = {"from": {"vertex": 0}, "to": {"position": [0.1, 0.2, 1]}}
    pair["known_path"] = [pair["from"], pair["to"]]
    answer = api.ok("/v1/geodesics", {"mesh": mesh, "pairs": [pair]})
    assert answer["results"][0]["distance"] == pytest.approx(np.hypot(0.1, 0.2))
    assert [entry["pointer"] for entry in answer["points_in_space"]] == ["/pairs/0/to", "/pairs/0/known_path/1"]


@pytest.mark.parametrize("seed", range(3))
def test_coordinates_of_single_precision_are_normalized(api: Api, mesh: str, seed: int) -> None:
    random = np.random.default_rng(seed)
    coordinates = random.dirichlet([1, 1, 1], 50).astype(np.float32)
    coordinates[:10, 2] = 0
    coordinates[:10, 1] = 1 - coordinates[:10, 0]
    coordinates[:5, 2] = np.float32(-3e-6)
    sources = [{"face": int(random.integers(32)), "barycentric": [float(b) for b in row]} for row in coordinates]
    answer = api.ok("/v1/voronoi-diagrams", {"mesh": mesh, "sites": sources[10:14], "statistics": False})
    for given, site in zip(sources[10:14], answer["sites"]):
        assert sum(site["barycentric"]) == pytest.approx(1, abs=4e-16)
        np.testing.assert_allclose(site["barycentric"], given["barycentric"], atol=1e-6)
    api.ok("/v1/geodesic-fields", {"mesh": mesh, "sources": sources})
    for off in ([0.5, 0.5, 1.2e-5], [0.5, 0.500012, -1.2e-5]):
        refused = api.post("/v1/geodesic-fields", {"mesh": mesh, "sources": [{"face": 0, "barycentric": off}]})
        assert (refused.status_code, problem_code(refused)) == (422, "point.outside_face")


def test_the_command_line_client_takes_points_in_space(api: Api, grid: Any, tmp_path: Path) -> None:
    (tmp_path / "grid.obj").write_text(obj_text(grid))

    def run(*arguments: str) -> "subprocess.CompletedProcess[str]":
        return subprocess.run([str(CLI), *arguments], cwd=tmp_path, env={**os.environ, "SUPPLE_SERVER": api.server.url},
                              capture_output=True, text=True, timeout=60, check=False)

    said = run("geodesic", "grid.obj", "v0", "@0.3,0.1,-0.25").stdout
    assert f"vertex 0 -> the point nearest to (0.3, 0.1, -0.25): distance {np.hypot(0.3, 0.1):.9g}"[:60] in said
    assert "/pairs/0/to lies 0.25 from the surface, nearest to face" in said
    for command in (("karcher", "grid.obj", "v0", "v20", "@-1,0,0"), ("exponential-map", "grid.obj", "@-1,0,0", "--tangent", "0.1,0.1,0"),
                    ("voronoi", "grid.obj", "v20", "@-1,0,0"), ("field", "grid.obj", "@-1,0,0")):
        finished = run(*command)
        assert finished.returncode == 0 and "1 from the surface" in finished.stdout, (command, finished.stdout, finished.stderr)
    refused = run("geodesic", "grid.obj", "v0", "@0.3,0.1")
    assert refused.returncode != 0 and "@1,2.5,-3" in refused.stderr


def test_the_python_package_takes_points_in_space(api: Api, grid: Any) -> None:
    with supple.Client(api.server.url) as client:
        mesh = client.upload_arrays(*grid)
        above = supple.SpacePoint(0.3, 0.1, 0.25)
        geodesic, other = mesh.geodesics([(0, above), (0, 20)])
        assert geodesic.distance == pytest.approx(np.hypot(0.3, 0.1)) and other.points_in_space == ()
        placed = geodesic.points_in_space[0]
        assert (placed.pointer, placed.distance, placed.position) == ("/pairs/0/to", 0.25, (0.3, 0.1, 0.0))
        assert mesh.field([above]).largest_distance == 0.25 and mesh.field([0]).largest_distance is None
        assert mesh.karcher_mean([0, 20, above]).points_in_space[0].pointer == "/points/2"
        assert mesh.voronoi([0, 20, above]).points_in_space[0].distance == 0.25
        assert mesh.exponential_map(above, (0.1, 0, 0)).points_in_space[0].point.face == placed.point.face
        with pytest.raises(ValueError):
            mesh.field([supple.SpacePoint(0, float("nan"), 0)])


def test_the_search_of_a_large_mesh_waits_for_its_turn_and_its_deadline(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    server = new_server("--immediate", "1")
    api = Api(server, contract)
    large, small = api.upload(*flat_grid(110)), api.upload(*flat_grid(4))
    respond_async = {"Prefer": "respond-async"}
    late = {"mesh": small, "sources": [{"vertex": 0}], "deadline": 0.5}
    computing = http.client.HTTPConnection("127.0.0.1", server.port, timeout=PATIENCE_SECONDS)
    body = json.dumps(slow_relaxation(api.upload(*bumpy_sphere(3)), 100_000))
    computing.request("POST", "/v1/embedded-systems", body, {"Content-Type": "application/json"})
    end = time.monotonic() + 60
    while api.post("/v1/geodesic-fields", late).status_code != 504:  # until the other request computes
        assert time.monotonic() < end
    late["sources"] = [ABOVE]
    waited = api.post("/v1/geodesic-fields", {**late, "mesh": large}, headers=respond_async)
    assert (waited.status_code, problem_code(waited)) == (504, "job.deadline_exceeded")
    assert api.post("/v1/geodesic-fields", late, headers=respond_async).status_code == 202, "it takes no time worth waiting for"
    computing.close()
    answer = api.ok("/v1/geodesic-fields", {"mesh": large, "sources": [ABOVE]})
    assert answer["points_in_space"][0]["distance"] == pytest.approx(0.25)
