"""Repairs of uploaded meshes, and their answers."""

from __future__ import annotations

from typing import Any, Callable, Dict, List

import numpy as np
import pytest

from contract import Contract
from harness import Api, ServerProcess, pointers, problem_code
from shapes import Mesh, obj_text, sphere

OCTETS = {"Content-Type": "application/octet-stream"}
ALL = ["weld", "drop_degenerate", "drop_duplicates", "split_non_manifold"]
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
CROSS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]


def single_triangles(mesh: Mesh) -> Mesh:
    """The mesh with three vertices for each face."""
    vertices, faces = mesh
    return vertices[faces.ravel()], np.arange(faces.size).reshape(-1, 3)


def mapped(document: Dict[str, Any], faces: List[List[int]], of_mesh: List[List[int]]) -> bool:
    """Whether the corners of each remaining face are images of the corners of its uploaded face."""
    repair = document["repair"]
    places = [[] if p is None else [p] if isinstance(p, int) else p for p in repair["vertices"]]
    return all(now is None or all(corner in places[v] for corner, v in zip(sorted_as(of_mesh[now], places, face), face))
               for now, face in zip(repair["faces"], faces))


def sorted_as(corners: List[int], places: List[List[int]], face: List[int]) -> List[int]:
    """The corners in the order of those of the uploaded face, since a face may have another first corner."""
    return [next((c for c in corners if c in places[v]), -1) for v in face]


@pytest.mark.parametrize("by", ["query", "body"])
@pytest.mark.parametrize("vertices, faces, code, repair, counts", [
    (SQUARE, [[0, 1, 2], [0, 2, 2], [0, 2, 3]], "mesh.degenerate_face", "drop_degenerate", {"dropped_degenerate_faces": 1}),
    (SQUARE, [[0, 1, 2], [2, 1, 0], [0, 2, 3]], "mesh.non_manifold_edge", "drop_duplicates", {"dropped_duplicate_faces": 1}),
    ([*SQUARE, [0, 0, 1]], [[0, 1, 2], [0, 2, 3], [0, 2, 4]], "mesh.non_manifold_edge", "split_non_manifold",
     {"split_edges": 1, "split_vertices": 2}),
    (CROSS, [[0, 1, 2], [0, 3, 4]], "mesh.non_manifold_vertex", "split_non_manifold", {"split_vertices": 1}),
])
def test_a_fault_names_the_repair_and_the_repair_removes_the_fault(
        api: Api, vertices: list, faces: list, code: str, repair: str, counts: Dict[str, int], by: str) -> None:
    document = {"vertices": vertices, "faces": faces}
    refused = api.post("/v1/meshes", document)
    assert (refused.status_code, problem_code(refused)) == (422, code)
    assert repair in refused.json()["detail"] and "repair=" in refused.json()["hint"]
    if by == "query":
        response = api.post(f"/v1/meshes?repair={repair}", document)
    else:
        response = api.post("/v1/meshes", {**document, "repair": [repair]})
    assert response.status_code in (200, 201), response.text
    made = response.json()["repair"]
    assert made["made"] == [repair]
    assert {name: value for name, value in made.items() if isinstance(value, int) and value} == counts
    # There is a warning for each count, and another one if split vertices are now at the same place.
    assert len(response.json()["warnings"]) == len(counts) + ("split_vertices" in counts)
    assert len(made["vertices"]) == len(vertices) and len(made["faces"]) == len(faces)
    ply = api.get(f"/v1/meshes/{response.json()['id']}/content").content
    start = ply.index(b"end_header\n") + 11 + 24 * response.json()["vertices"]
    now = [list(map(int, row)) for row in np.frombuffer(ply[start:], dtype=[("n", "u1"), ("v", "<i4", 3)])["v"]]
    assert mapped(response.json(), faces, now)


def test_single_triangles_are_welded_to_one_closed_surface(api: Api) -> None:
    vertices, faces = single_triangles(sphere(2))
    moved = vertices + np.random.default_rng(1).uniform(-2e-7, 2e-7, vertices.shape)
    response = api.post("/v1/meshes?repair=weld", body=obj_text((moved, faces)).encode(), headers=OCTETS)
    document = response.json()
    assert (document["vertices"], document["boundary_loops"], document["genus"]) == (162, 0, 0)
    assert document["repair"]["welded_vertices"] == len(vertices) - 162
    assert 1e-7 < document["repair"]["weld_distance"] < 4e-7 * 3**0.5
    named = api.post("/v1/meshes?repair=weld&weld_tolerance=1e-6", body=obj_text((moved, faces)).encode(), headers=OCTETS).json()
    assert named["id"] == document["id"]
    assert named["repair"]["weld_distance"] == pytest.approx(1e-6 * document["bounding_box"]["diagonal"], rel=1e-3)
    assert document["repair"]["faces"] == list(range(320))
    apart = api.post("/v1/meshes?repair=weld&weld_tolerance=0", body=obj_text((moved, faces)).encode(), headers=OCTETS)
    assert apart.json()["vertices"] == 960 and apart.json()["repair"]["welded_vertices"] == 0


def test_a_repaired_mesh_is_a_mesh_like_any_other_after_a_restart_too(
        new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    faulty = {"vertices": CROSS, "faces": [[0, 1, 2], [0, 3, 4], [1, 1, 2]], "repair": ALL}
    first = api.post("/v1/meshes", faulty)
    assert first.status_code == 201
    stored = {name: value for name, value in first.json().items() if name != "repair"}
    assert stored["warnings"] == ["1 degenerate face was dropped.",
                                  "1 vertex was duplicated, once for each further fan of faces.",
                                  "1 vertex has the coordinates of an earlier one; the surface is not joined there."]
    assert server.terminate() == 0
    server.start()
    api = Api(server, contract)
    assert api.get(f"/v1/meshes/{stored['id']}").json() == stored
    again = api.post("/v1/meshes", faulty)
    assert (again.status_code, again.json()) == (200, first.json())
    assert api.ok("/v1/geodesics", {"mesh": stored["id"], "pairs": [{"from": {"vertex": 1}, "to": {"vertex": 2}}]})


def test_the_limits_hold_for_what_the_repairs_make(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    api = Api(new_server("--max-vertices", "5"), contract)
    response = api.post("/v1/meshes?repair=split_non_manifold", {"vertices": CROSS, "faces": [[0, 1, 2], [0, 3, 4]]})
    assert (response.status_code, problem_code(response)) == (413, "mesh.too_large")
    assert "6 vertices after the repairs, the limit is 5" in response.json()["detail"]


def test_faults_that_no_repair_is_for_are_still_refused(api: Api) -> None:
    for vertices, faces, code in [(SQUARE, [[0, 1, 4]], "mesh.index_out_of_range"), (SQUARE, [[0, 1, 1]], "mesh.empty")]:
        response = api.post("/v1/meshes", {"vertices": vertices, "faces": faces, "repair": ALL})
        assert (response.status_code, problem_code(response)) == (422, code)


@pytest.mark.parametrize("query, places", [
    ("repair=", ["query repair"]), ("repair=weld,", ["query repair"]), ("repair=weld,fill_holes", ["query repair"]),
    ("repair=weld&weld_tolerance=0.02", ["query weld_tolerance"]), ("repair=weld&weld_tolerance=nan", ["query weld_tolerance"]),
    ("repair=drop_degenerate&weld_tolerance=1e-4", ["query weld_tolerance"]), ("weld_tolerance=1e-4", ["query weld_tolerance"]),
    ("repiar=weld", ["query repiar"]), ("repair=all&units=mm", ["query repair", "query units"]),
])
def test_a_query_that_cannot_be_read_is_refused_and_named(api: Api, query: str, places: List[str]) -> None:
    response = api.post(f"/v1/meshes?{query}", {"vertices": SQUARE, "faces": [[0, 1, 2]]}, faulty=True)
    assert (response.status_code, problem_code(response), pointers(response)) == (400, "request.invalid_parameter", places)


def test_repairs_are_asked_for_in_one_place(api: Api) -> None:
    response = api.post("/v1/meshes?repair=weld", {"vertices": SQUARE, "faces": [[0, 1, 2]], "repair": ["weld"]})
    assert (response.status_code, problem_code(response)) == (400, "request.invalid_parameter")


def test_a_body_whose_repairs_cannot_be_read_is_refused_and_named(api: Api) -> None:
    document = {"vertices": SQUARE, "faces": [[0, 1, 2]], "repair": ["weld", "heal"], "weld_tolerance": -1}
    response = api.post("/v1/meshes", document, faulty=True)
    assert (response.status_code, pointers(response)) == (400, ["/repair/1", "/weld_tolerance"])
