"""Faulty bodies: each is answered with a 4xx problem that names the fault, and the server continues to work."""

from __future__ import annotations

import json
import random
import socket
from typing import Any, Dict

import pytest

from harness import Api, pointers, problem_code

COMPUTATIONS = ["/v1/geodesics", "/v1/geodesic-fields", "/v1/karcher-means", "/v1/embedded-systems",
                "/v1/exponential-maps", "/v1/voronoi-diagrams", "/v1/voronoi-optimizations"]
WEAVES = ["/v1/weave-layouts", "/v1/weave-homogenizations", "/v1/weave-deformations", "/v1/weave-simulations", "/v1/weave-toolpaths", "/v1/gcode-reports"]
ALL = [*COMPUTATIONS, "/v1/structures", "/v1/family-checks", "/v1/family-atlases", "/v1/measured-curves", "/v1/parts", "/v1/part-simulations",
       "/v1/simulations", *WEAVES]
JSON = {"Content-Type": "application/json"}
CORNER = {"vertex": 0}


def minimal(path: str, mesh: str) -> Dict[str, Any]:
    """The smallest valid request of each computation."""
    return {
        "/v1/geodesics": {"mesh": mesh, "pairs": [{"from": CORNER, "to": {"vertex": 1}}]},
        "/v1/geodesic-fields": {"mesh": mesh, "sources": [CORNER]},
        "/v1/karcher-means": {"mesh": mesh, "points": [CORNER, {"vertex": 1}]},
        "/v1/embedded-systems": {"mesh": mesh, "points": [CORNER, {"vertex": 1}], "springs": [{"between": [0, 1]}]},
        "/v1/exponential-maps": {"mesh": mesh, "start": CORNER, "tangent": [0.1, 0.05, 0.0]},
        "/v1/voronoi-diagrams": {"mesh": mesh, "sites": [CORNER, {"vertex": 1}]},
        "/v1/voronoi-optimizations": {"mesh": mesh, "sites": [CORNER, {"vertex": 1}], "objectives": {"centroidal": 1}},
        "/v1/structures": {"family": "IH01"},
        "/v1/family-checks": {"definition": {"id": "hexagons", "description": "Regular hexagons", "parameters": [], "beam_width": 0.1, "isohedral_type": 20}},
        "/v1/family-atlases": {"definition": {"id": "hexagons", "description": "Regular hexagons", "parameters": [], "beam_width": 0.1, "isohedral_type": 20}},
        "/v1/measured-curves": {"points": [[0, 0], [0.1, 1]]},
        "/v1/parts": {"outline": {"rectangle": [5, 5]}, "structure": {"family": "IH01"}},
        "/v1/part-simulations": {"part": {"outline": {"rectangle": [2, 2]}, "structure": {"family": "IH01"}, "frame": 2},
                                 "supports": [{"kind": "clamp", "box": [[-1, -1], [3, 0.1]]}]},
        "/v1/weave-layouts": {"weave": {"pattern": "regular"}},
        "/v1/weave-homogenizations": {"weave": {"pattern": "regular"}},
        "/v1/weave-deformations": {"weave": {"pattern": "regular"}, "deformation_gradients": [[[1, 0], [0, 1]]]},
        "/v1/weave-simulations": {"weave": {"pattern": "actuated_rings"}, "supports": [{"at": {"crossing": 0}}]},
        "/v1/weave-toolpaths": {"weave": {"pattern": "regular", "sheet": {"columns": 1, "rows": 1}}},
        "/v1/gcode-reports": {"gcode": "G28"},
        "/v1/simulations": {"family": "IH01", "load": {"green_strain": [[0.01, 0.0, 0.0]]}},
    }[path]


@pytest.mark.parametrize("path", ALL)
def test_a_valid_request_shows_that_the_faults_below_are_what_is_refused(api: Api, grid_mesh: str, path: str) -> None:
    answer = api.post(path, minimal(path, grid_mesh))
    assert answer.status_code == 200
    assert answer.json()["effects"], "every computation says which of its optional parts ran"


@pytest.mark.parametrize("path", [*ALL, "/v1/meshes"])
@pytest.mark.parametrize("body, code", [
    (b"", "request.malformed_json"),
    (b"not json", "request.malformed_json"),
    (b"{", "request.malformed_json"),
    (b'{"mesh": "a', "request.malformed_json"),
    (b'{"a": 1} trailing', "request.malformed_json"),
    (b'{"a": NaN}', "request.malformed_json"),
    (b'{"a": Infinity}', "request.malformed_json"),
    (b'{"a": -Infinity}', "request.malformed_json"),
    (b'{"mesh": "\xff\xfe"}', "request.not_utf8"),
    (b'{"mesh": "\xc3\x28"}', "request.not_utf8"),
    (b'{"mesh": "\xed\xa0\x80"}', "request.not_utf8"),
    (b"\x00\x01\x02\x03", "request.malformed_json"),
    (b"[" * 100_000, "request.too_deep"),
    (b'{"a":' * 100_000, "request.too_deep"),
    (b"[" * 5000 + b"]" * 5000, "request.too_deep"),
], ids=["empty", "text", "cut", "cut-in-string", "trailing", "nan", "infinity", "minus-infinity", "bytes", "cut-sequence",
        "surrogate", "binary", "deep-open-array", "deep-open-object", "deep-closed"])
def test_a_body_that_is_not_json_is_refused(api: Api, path: str, body: bytes, code: str) -> None:
    response = api.post(path, body=body, headers=JSON, faulty=True)
    assert response.status_code == 400
    assert problem_code(response) == code


@pytest.mark.parametrize("path", ALL)
@pytest.mark.parametrize("document", [None, True, 17, "text", [], [1, 2], {}], ids=repr)
def test_json_of_another_shape_is_refused(api: Api, path: str, document: Any) -> None:
    response = api.post(path, body=json.dumps(document).encode(), headers=JSON, faulty=True)
    assert response.status_code == 400
    assert problem_code(response) == "request.invalid"


@pytest.mark.parametrize("path", ALL)
def test_each_missing_field_is_pointed_to(api: Api, grid_mesh: str, path: str) -> None:
    document = minimal(path, grid_mesh)
    for name in document:
        rest = {key: value for key, value in document.items() if key != name}
        response = api.post(path, body=json.dumps(rest).encode(), headers=JSON, faulty=True)
        assert (response.status_code, problem_code(response)) == (400, "request.invalid")
        assert any(name in entry["detail"] or entry["pointer"].endswith(name) for entry in response.json()["errors"])


@pytest.mark.parametrize("path", ALL)
@pytest.mark.parametrize("wrong", [None, True, 3.5, "text", {}, [[]]], ids=repr)
def test_a_field_of_the_wrong_type_is_pointed_to(api: Api, grid_mesh: str, path: str, wrong: Any) -> None:
    document = minimal(path, grid_mesh)
    for name in document:
        if name in ("mesh", "family", "gcode") and isinstance(wrong, str):
            continue  # a string has the right type, although it names no object or is no valid G-code
        broken = json.dumps({**document, name: wrong}).encode()
        response = api.post(path, body=broken, headers=JSON, faulty=True)
        assert (response.status_code, problem_code(response)) == (400, "request.invalid"), (name, response.text)
        assert any(pointer.startswith(f"/{name}") for pointer in pointers(response)), response.text


@pytest.mark.parametrize("path", ALL)
def test_a_field_that_the_contract_does_not_know_is_refused(api: Api, grid_mesh: str, path: str) -> None:
    document = {**minimal(path, grid_mesh), "tolerence": 1e-9}
    response = api.post(path, body=json.dumps(document).encode(), headers=JSON, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert "/tolerence" in pointers(response)


@pytest.mark.parametrize("path", COMPUTATIONS)
@pytest.mark.parametrize("number", [b"1e999", b"-1e999", b"123456789012345678901234567890"])
def test_a_number_beyond_every_type_is_refused_as_a_vertex(api: Api, grid_mesh: str, path: str, number: bytes) -> None:
    body = json.dumps(minimal(path, grid_mesh)).encode().replace(b'"vertex": 0', b'"vertex": ' + number)
    response = api.post(path, body=body, headers=JSON, faulty=True)
    assert 400 <= response.status_code < 500


@pytest.mark.parametrize("path", COMPUTATIONS)
def test_an_unknown_mesh_is_not_found(api: Api, path: str) -> None:
    response = api.post(path, minimal(path, "0" * 64))
    assert (response.status_code, problem_code(response)) == (404, "mesh.not_found")


@pytest.mark.parametrize("point, code", [
    ({"vertex": 81}, "point.vertex_out_of_range"),
    ({"face": 128, "barycentric": [1, 0, 0]}, "point.face_out_of_range"),
    ({"face": 0, "barycentric": [2, -1, 0]}, "point.outside_face"),
    ({"face": 0, "barycentric": [0.3, 0.3, 0.3]}, "point.outside_face"),
])
@pytest.mark.parametrize("path", COMPUTATIONS)
def test_a_point_off_the_surface_is_named(api: Api, grid_mesh: str, path: str, point: Any, code: str) -> None:
    text = json.dumps(minimal(path, grid_mesh)).replace(json.dumps(CORNER), json.dumps(point))
    response = api.post(path, json.loads(text))
    assert (response.status_code, problem_code(response)) == (422, code)
    assert len(pointers(response)) == 1


@pytest.mark.parametrize("point", [
    {}, {"face": 0}, {"barycentric": [1, 0, 0]}, {"vertex": 0, "face": 0, "barycentric": [1, 0, 0]}, {"vertex": -1},
    {"vertex": 1.5}, {"vertex": "0"}, {"face": -1, "barycentric": [1, 0, 0]}, {"face": 0, "barycentric": [1, 0]},
    {"face": 0, "barycentric": [1, 0, 0, 0]}, {"face": 0, "barycentric": ["1", "0", "0"]},
], ids=json.dumps)
@pytest.mark.parametrize("path", COMPUTATIONS)
def test_what_is_no_point_is_refused(api: Api, grid_mesh: str, path: str, point: Any) -> None:
    body = json.dumps(minimal(path, grid_mesh)).replace(json.dumps(CORNER), json.dumps(point)).encode()
    response = api.post(path, body=body, headers=JSON, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")


def test_another_media_type_is_refused(api: Api, grid_mesh: str) -> None:
    body = json.dumps(minimal("/v1/geodesics", grid_mesh)).encode()
    response = api.post("/v1/geodesics", body=body, headers={"Content-Type": "text/html"}, faulty=True)
    assert (response.status_code, problem_code(response)) == (415, "http.unsupported_media_type")


def test_a_mesh_without_a_media_type_is_refused(api: Api) -> None:
    response = api.post("/v1/meshes", body=b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", faulty=True)
    assert (response.status_code, problem_code(response)) == (415, "http.unsupported_media_type")
    assert "model/obj" in response.json()["detail"]


def test_a_compressed_body_is_refused_rather_than_unpacked(api: Api, grid_mesh: str) -> None:
    import gzip

    body = gzip.compress(json.dumps(minimal("/v1/geodesics", grid_mesh)).encode())
    response = api.post("/v1/geodesics", body=body, headers={**JSON, "Content-Encoding": "gzip"}, faulty=True)
    assert response.status_code in (400, 415)


def raw_exchange(api: Api, message: bytes, seconds: float = 60) -> bytes:
    """Sends bytes unchanged and returns the answer until the server closes the connection or sends nothing more."""
    with socket.create_connection(("127.0.0.1", api.server.port), timeout=seconds) as connection:
        connection.sendall(message)
        connection.shutdown(socket.SHUT_WR)
        received = b""
        try:
            while chunk := connection.recv(65536):
                received += chunk
        except (socket.timeout, ConnectionError):
            pass
        return received


def test_a_body_announced_too_large_is_refused_without_being_read(api: Api) -> None:
    answer = raw_exchange(api, b"POST /v1/geodesics HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
                               b"Content-Length: 99999999999\r\n\r\n{")
    assert answer.startswith(b"HTTP/1.1 413"), answer[:200]
    assert b"request.body_too_large" in answer


@pytest.mark.parametrize("message", [
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
    b"GET\r\n\r\n",
    b"GET / HTTP/9.9\r\n\r\n",
    b"POST /v1/geodesics HTTP/1.1\r\nContent-Length: nonsense\r\n\r\n",
    b"POST /v1/geodesics HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\nshort",
    b"POST /v1/geodesics HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n",
    b"GET /" + b"a" * 100_000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n",
    b"GET /healthz HTTP/1.1\r\nHost: localhost\r\n" + b"X-Long: " + b"a" * 1_000_000 + b"\r\n\r\n",
    b"GET /%zz%00%ff HTTP/1.1\r\nHost: localhost\r\n\r\n",
], ids=["tls", "no-path", "version", "length", "short-body", "chunks", "long-path", "long-header", "escapes"])
def test_bytes_that_are_not_http_do_not_harm_the_server(api: Api, message: bytes) -> None:
    answer = raw_exchange(api, message)
    assert answer == b"" or answer.startswith((b"HTTP/1.1 4", b"HTTP/1.0 4")), answer[:200]
    assert api.get("/healthz").status_code == 200


def test_random_damage_to_valid_requests_never_causes_a_server_error(api: Api, grid_mesh: str) -> None:
    stream = random.Random(20240601)
    for _ in range(400):
        path = stream.choice(COMPUTATIONS)
        body = bytearray(json.dumps(minimal(path, grid_mesh)).encode())
        for _ in range(stream.randint(1, 4)):
            where = stream.randrange(len(body))
            action = stream.randrange(3)
            if action == 0:
                body[where] = stream.randrange(256)
            elif action == 1:
                del body[where:where + stream.randint(1, 8)]
            else:
                body[where:where] = bytes(stream.choice(b'{}[]",:0123456789eE-+.\\u') for _ in range(stream.randint(1, 4)))
            if not body:
                break
        response = api.post(path, body=bytes(body), headers=JSON, faulty=True)
        assert response.status_code < 500, (path, bytes(body), response.text)
