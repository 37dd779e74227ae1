"""Uploading, describing, downloading and deleting meshes."""

from __future__ import annotations

import hashlib
import struct
from typing import Callable

import numpy as np
import pytest

from contract import Contract
from harness import Api, ServerProcess, pointers, problem_code
from shapes import Mesh, flat_grid, obj_text, sphere, two_triangles_apart

OCTETS = {"Content-Type": "application/octet-stream"}


def off_text(mesh: Mesh) -> str:
    vertices, faces = mesh
    lines = ["OFF", f"{len(vertices)} {len(faces)} 0", *(" ".join(map(repr, v)) for v in vertices.tolist())]
    return "\n".join(lines + ["3 " + " ".join(map(str, f)) for f in faces.tolist()]) + "\n"


def ply_header(mesh: Mesh, encoding: str) -> str:
    return (f"ply\nformat {encoding} 1.0\nelement vertex {len(mesh[0])}\nproperty double x\nproperty double y\n"
            f"property double z\nelement face {len(mesh[1])}\nproperty list uchar int vertex_indices\nend_header\n")


def ply_ascii(mesh: Mesh) -> bytes:
    lines = [" ".join(map(repr, v)) for v in mesh[0].tolist()] + ["3 " + " ".join(map(str, f)) for f in mesh[1].tolist()]
    return (ply_header(mesh, "ascii") + "\n".join(lines) + "\n").encode()


def ply_binary(mesh: Mesh, order: str) -> bytes:
    name = "binary_little_endian" if order == "<" else "binary_big_endian"
    body = mesh[0].astype(order + "f8").tobytes()
    return ply_header(mesh, name).encode() + body + b"".join(struct.pack(order + "B3i", 3, *f) for f in mesh[1].tolist())


def stl_binary(mesh: Mesh) -> bytes:
    triangles = mesh[0][mesh[1]].astype("<f4")
    return b"\0" * 80 + struct.pack("<I", len(triangles)) + b"".join(
        struct.pack("<3f", 0, 0, 0) + t.tobytes() + b"\0\0" for t in triangles)


def upload(api: Api, content: bytes) -> dict:
    response = api.post("/v1/meshes", body=content, headers=OCTETS)
    assert response.status_code in (200, 201), response.text
    return dict(response.json())


def test_every_format_of_one_mesh_is_one_mesh(api: Api) -> None:
    mesh = flat_grid(5)
    ids = {upload(api, content)["id"] for content in (
        obj_text(mesh).encode(), off_text(mesh).encode(), ply_ascii(mesh), ply_binary(mesh, "<"), ply_binary(mesh, ">"))}
    ids.add(api.upload(*mesh))
    assert len(ids) == 1


def test_stl_corners_are_merged(api: Api) -> None:
    document = upload(api, stl_binary(sphere(1)))
    assert (document["vertices"], document["faces"], document["components"]) == (42, 80, 1)


def test_the_report_knows_the_topology_and_the_lengths(api: Api) -> None:
    document = api.get(f"/v1/meshes/{api.upload(*flat_grid(4, 2.0))}").json()
    assert (document["vertices"], document["faces"], document["edges"]) == (25, 32, 56)
    assert (document["components"], document["boundary_loops"], document["genus"]) == (1, 1, 0)
    assert document["bounding_box"]["lower"] == [0, 0, 0] and document["bounding_box"]["upper"] == [2, 2, 0]
    assert document["area"] == pytest.approx(4)
    assert document["edge_length"]["min"] == pytest.approx(0.5)
    assert document["edge_length"]["max"] == pytest.approx(0.5 * 2**0.5)
    assert api.get(f"/v1/meshes/{api.upload(*two_triangles_apart())}").json()["components"] == 2


def test_the_first_upload_creates_and_the_second_finds(api: Api) -> None:
    content = obj_text(flat_grid(3, 0.123)).encode()
    first = api.post("/v1/meshes", body=content, headers=OCTETS)
    second = api.post("/v1/meshes", body=content, headers=OCTETS)
    assert (first.status_code, second.status_code) == (201, 200)
    assert first.headers["ETag"] == second.headers["ETag"]
    assert first.headers["Location"] == second.headers["Location"] == f"/v1/meshes/{first.json()['id']}"


def test_each_upload_is_answered_with_its_own_warnings(new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    server = new_server()
    api = Api(server, contract)
    vertices, faces = sphere(1)
    turned = faces.copy()
    turned[7] = turned[7][[0, 2, 1]]
    sound = {"vertices": vertices.tolist(), "faces": faces.tolist()}
    first = api.post("/v1/meshes", {**sound, "faces": turned.tolist()})
    assert first.status_code == 201
    stored = first.json()
    assert len(stored["warnings"]) == 1 and stored["warnings"][0].startswith("1 face was turned")
    for restarted in (False, True):
        if restarted:
            assert server.terminate() == 0
            server.start()
            api = Api(server, contract)
        again = api.post("/v1/meshes", sound)
        assert (again.status_code, again.json()) == (200, {**stored, "warnings": []})
        turned[9] = faces[9][[0, 2, 1]]
        two = api.post("/v1/meshes", {**sound, "faces": turned.tolist()}).json()
        assert two["id"] == stored["id"] and two["created"] == stored["created"]
        assert two["warnings"] == ["2 faces were turned to agree with their neighbours: their second and third corner are swapped."]
        assert api.get(f"/v1/meshes/{stored['id']}").json() == stored
        assert api.get("/v1/meshes").json() == {"meshes": [stored]}


def test_a_file_whose_mesh_exists_is_answered_with_the_warnings_of_reading_it(api: Api) -> None:
    api.upload([[0, 0, 0], [1, 0, 0], [1, 7, 0], [0, 7, 0]], [[0, 1, 2], [0, 2, 3]])
    response = api.post("/v1/meshes", body=b"v 0 0 0\nv 1 0 0\nv 1 7 0\nv 0 7 0\nl 1 2\nf 1 2 3 4\n", headers=OCTETS)
    assert response.status_code == 200
    assert response.json()["warnings"] == ["1 line or point elements were left out.", "1 polygon was cut into triangles."]


def test_the_canonical_file_has_the_id_as_its_sha256_and_reads_back_as_the_same_mesh(api: Api, sphere_mesh: str) -> None:
    content = api.get(f"/v1/meshes/{sphere_mesh}/content").content
    assert hashlib.sha256(content).hexdigest() == sphere_mesh
    assert upload(api, content)["id"] == sphere_mesh
    obj = api.get(f"/v1/meshes/{sphere_mesh}/content", headers={"Accept": "model/obj"}).content
    assert upload(api, obj)["id"] == sphere_mesh


@pytest.mark.parametrize("suffix", ["", "/content"])
def test_a_current_copy_is_answered_with_304_and_no_body(api: Api, sphere_mesh: str, suffix: str) -> None:
    path = f"/v1/meshes/{sphere_mesh}{suffix}"
    tag = api.get(path).headers["ETag"]
    response = api.get(path, headers={"If-None-Match": tag})
    assert (response.status_code, response.content, response.headers["ETag"]) == (304, b"", tag)
    assert api.get(path, headers={"If-None-Match": '"other", ' + tag}).status_code == 304
    assert api.get(path, headers={"If-None-Match": '"other"'}).status_code == 200


def test_a_deleted_mesh_is_gone_and_can_be_uploaded_again(api: Api) -> None:
    mesh = flat_grid(2, 3.21)
    name = api.upload(*mesh)
    assert api.delete(f"/v1/meshes/{name}").status_code == 204
    for response in (api.get(f"/v1/meshes/{name}"), api.delete(f"/v1/meshes/{name}"),
                     api.get(f"/v1/meshes/{name}/content"),
                     api.post("/v1/geodesic-fields", {"mesh": name, "sources": [{"vertex": 0}]})):
        assert (response.status_code, problem_code(response)) == (404, "mesh.not_found")
    assert api.upload(*mesh) == name


def test_the_list_comes_in_pages_that_hold_every_mesh_once(api: Api) -> None:
    uploaded = {api.upload(*flat_grid(2, 1 + k / 8)) for k in range(5)}
    seen = []
    path = "/v1/meshes?limit=2"
    while True:
        page = api.get(path).json()
        assert len(page["meshes"]) <= 2
        seen += [mesh["id"] for mesh in page["meshes"]]
        if "next" not in page:
            break
        path = f"/v1/meshes?limit=2&after={page['next']}"
    assert len(seen) == len(set(seen))
    assert uploaded <= set(seen)


SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
L_SHAPE = "3 0 0", "3 1 0", "1 1 0", "1 3 0", "0 3 0", "0 0 0"


@pytest.mark.parametrize("content", [
    "".join(f"v {p}\n" for p in L_SHAPE) + "f 1 2 3 4 5 6\n",
    "OFF\n6 1 0\n" + "\n".join(L_SHAPE) + "\n6 0 1 2 3 4 5\n",
], ids=["obj", "off"])
def test_a_polygon_that_is_not_convex_is_covered_once(api: Api, content: str) -> None:
    document = upload(api, content.encode())
    assert (document["faces"], document["boundary_loops"]) == (4, 1)
    assert document["area"] == pytest.approx(5)


def test_a_polygon_that_crosses_itself_is_refused_and_named(api: Api) -> None:
    content = b"v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 1 0\nv 0 5 0\nf 1 3 5\nf 1 2 3 4\n"
    response = api.post("/v1/meshes", body=content, headers=OCTETS)
    assert (response.status_code, problem_code(response), pointers(response)) == (422, "mesh.invalid_polygon", ["face 1"])


@pytest.mark.parametrize("vertices, faces, code, element", [
    (SQUARE, [[0, 1, 2], [0, 2, 4]], "mesh.index_out_of_range", "face 1"),
    (SQUARE, [[0, 1, 2], [0, 2, 2]], "mesh.degenerate_face", "face 1"),
    ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], "mesh.degenerate_face", "face 0"),
    ([*SQUARE, [0, 0, 1]], [[0, 1, 2], [0, 2, 3], [0, 2, 4]], "mesh.non_manifold_edge", "edge 0 2"),
    ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], [[0, 1, 2], [0, 3, 4]], "mesh.non_manifold_vertex", "vertex 0"),
])
def test_a_faulty_mesh_is_refused_and_the_element_named(api: Api, vertices: list, faces: list, code: str, element: str) -> None:
    response = api.post("/v1/meshes", {"vertices": vertices, "faces": faces})
    assert (response.status_code, problem_code(response)) == (422, code)
    assert element in pointers(response)


def test_a_moebius_strip_is_refused(api: Api) -> None:
    n = 12
    t = np.arange(n) * 2 * np.pi / n
    rows = [np.stack([(1 + s * np.cos(t / 2)) * np.cos(t), (1 + s * np.cos(t / 2)) * np.sin(t), s * np.sin(t / 2)], axis=1)
            for s in (-0.3, 0.3)]
    faces = []
    for i in range(n):
        a, b = i, n + i
        c, d = (i + 1, n + i + 1) if i + 1 < n else (n, 0)
        faces += [[a, c, d], [a, d, b]]
    response = api.post("/v1/meshes", {"vertices": np.concatenate(rows).tolist(), "faces": faces})
    assert (response.status_code, problem_code(response)) == (422, "mesh.not_orientable")


def test_at_most_twenty_elements_are_named_and_the_sentence_gives_the_total(api: Api) -> None:
    response = api.post("/v1/meshes", {"vertices": SQUARE, "faces": [[0, 1, 1]] * 50})
    assert len(pointers(response)) == 20
    assert "50" in response.json()["detail"]


def test_faces_turned_against_their_neighbours_are_turned_back_with_a_warning(api: Api) -> None:
    vertices, faces = sphere(1)
    faces = faces.copy()
    faces[7] = faces[7][::-1]
    response = api.post("/v1/meshes", {"vertices": vertices.tolist(), "faces": faces.tolist()})
    assert response.status_code == 201
    assert len(response.json()["warnings"]) == 1


@pytest.mark.parametrize("content, place", [
    (b"v 0 0 0\nv 1 0 x\n", "line 2"),
    (b"OFF\n3 1 0\n0 0 0\n1 0 0\n", None),
    (b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\nproperty double x\nproperty double y\n"
     b"property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n1234", None),
    (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", None),
    (b"\x89PNG\r\n\x1a\n" + bytes(range(256)), None),
    (b"", None),
], ids=["obj-number", "off-cut", "ply-lies", "obj-index", "png", "empty"])
def test_a_file_that_is_no_mesh_is_refused(api: Api, content: bytes, place: str) -> None:
    response = api.post("/v1/meshes", body=content, headers=OCTETS, faulty=True)
    assert 400 <= response.status_code < 500
    if place:
        assert (response.status_code, problem_code(response)) == (422, "mesh.malformed")
        assert place in pointers(response)


def test_a_coordinate_that_overflows_is_not_finite(api: Api) -> None:
    response = api.post("/v1/meshes", body=b"v 0 0 0\nv 1e999 0 0\nv 0 1 0\nf 1 2 3\n", headers=OCTETS)
    assert response.status_code == 422
    assert problem_code(response) in ("mesh.non_finite", "mesh.malformed")
