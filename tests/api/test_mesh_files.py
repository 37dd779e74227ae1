"""Mesh files of users: cracks, variants of the formats, and files that are refused with a reason."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np
import pytest

import supple
from harness import CLI, Api, pointers, problem_code
from shapes import obj_text, sphere

OCTETS = {"Content-Type": "application/octet-stream"}
# A tube of three sides whose last column is the first one up to rounding, from cos(2 pi) and sin(2 pi).
SEAM = """v 1 0 0
v 1 0 1
v -0.49999999999999978 0.86602540378443871 0
v -0.49999999999999978 0.86602540378443871 1
v -0.50000000000000044 -0.86602540378443837 0
v -0.50000000000000044 -0.86602540378443837 1
v 1 -2.4492935982947064e-16 0
v 1 -2.4492935982947064e-16 1
f 1 3 4
f 1 4 2
f 3 5 6
f 3 6 4
f 5 7 8
f 5 8 6
"""


def stl(*triangles: Tuple[str, str, str]) -> str:
    facets = ["facet normal 0 0 1\nouter loop\n" + "".join(f"vertex {corner}\n" for corner in triangle) + "endloop\nendfacet\n"
              for triangle in triangles]
    return "solid s\n" + "".join(facets) + "endsolid s\n"


ONE_END_OFF = stl(("0 0 0", "1 0 0", "1 1 0"), ("0 0 0", "1 1 1e-07", "0 1 0"))
DOUBLED = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 3 2 1\nf 2 1 3\nf 1 1 2\n"


def post(api: Api, content: Any, query: str = "") -> Any:
    return api.post("/v1/meshes" + query, body=content if isinstance(content, bytes) else content.encode(), headers=OCTETS)


def uploaded(api: Api, content: Any, query: str = "") -> Dict[str, Any]:
    response = post(api, content, query)
    assert response.status_code in (200, 201), response.text
    return dict(response.json())


def test_a_seam_that_differs_in_its_last_digits_is_told_with_the_repair_that_joins_it(api: Api) -> None:
    open_tube = uploaded(api, SEAM)
    assert open_tube["boundary_loops"] == 1
    assert open_tube["warnings"] == ["The surface is open along cracks: 2 vertices differ from earlier ones in the last digits, by "
                                     "up to 2.4e-16 mesh units; uploaded with repair=weld they are joined."]
    for query in ("?repair=weld", "?repair=automatic"):
        closed = uploaded(api, SEAM, query)
        assert (closed["boundary_loops"], closed["vertices"], closed["repair"]["made"]) == (2, 6, ["weld"])
        assert closed["warnings"] == ["2 vertices were welded to an earlier one."]
        assert 0 < closed["repair"]["weld_distance"] < 3e-16
        assert closed["repair"]["vertices"] == [0, 1, 2, 3, 4, 5, 0, 1]


def test_one_corner_that_is_off_is_a_fault_that_names_weld_alone(api: Api) -> None:
    refused = post(api, ONE_END_OFF)
    assert (refused.status_code, problem_code(refused)) == (422, "mesh.non_manifold_vertex")
    assert "uploaded with repair=weld the mesh is sound" in refused.json()["detail"]
    assert "split" not in refused.text
    assert uploaded(api, ONE_END_OFF, "?repair=automatic")["components"] == 1


@pytest.mark.parametrize("seed", range(3))
def test_corners_that_are_off_in_many_places_are_counted_and_joined(api: Api, seed: int) -> None:
    """A sphere of separate triangles, with slight noise and rounded to single precision."""
    vertices, faces = sphere(2)
    random = np.random.default_rng(seed)
    apart = vertices[faces.ravel()].astype(np.float32)
    apart = np.nextafter(apart, random.choice([-9, 9], apart.shape).astype(np.float32))
    soup = obj_text((apart.astype(float), np.arange(faces.size).reshape(-1, 3)))
    assert "798 vertices differ" in " ".join(uploaded(api, soup)["warnings"])
    whole = uploaded(api, soup, "?repair=automatic")
    assert (whole["vertices"], whole["boundary_loops"], whole["components"]) == (len(vertices), 0, 1)


def test_automatic_takes_what_is_needed_and_leaves_sound_meshes_alone(api: Api) -> None:
    made = uploaded(api, DOUBLED, "?repair=automatic")["repair"]
    assert made["made"] == ["drop_degenerate", "drop_duplicates"] and made["faces"] == [0, None, None, None]
    sound = uploaded(api, obj_text(sphere(1)), "?repair=automatic")
    assert sound["repair"]["made"] == [] and sound["warnings"] == []
    body = {"vertices": [[0, 0, 0], [1, 0, 0], [1, 1, 0]], "faces": [[0, 1, 2], [2, 1, 0], [1, 2, 0]], "repair": ["automatic"]}
    assert api.post("/v1/meshes", body).json()["repair"]["made"] == ["drop_duplicates"]
    moebius = "".join(f"v {np.cos(2 * k)} {np.sin(2 * k)} {k % 3}\n" for k in range(5))
    moebius += "".join(f"f {k + 1} {(k + 1) % 5 + 1} {(k + 2) % 5 + 1}\n" for k in range(5))
    refused = post(api, moebius, "?repair=automatic")
    assert (refused.status_code, problem_code(refused)) == (422, "mesh.not_orientable")
    assert "no repair removes this fault" in refused.json()["detail"]


@pytest.mark.parametrize("query", ["?repair=automatic,weld", "?repair=weld,automatic", "?repair=automatic&weld_tolerance=1e-6"])
def test_automatic_stands_alone(api: Api, query: str) -> None:
    response = api.post("/v1/meshes" + query, body=SEAM.encode(), headers=OCTETS, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid_parameter")


@pytest.mark.parametrize("thickness", [1e-3, 1e-6, 1e-9])
def test_weld_leaves_thin_walls_alone(api: Api, thickness: float) -> None:
    vertices, faces = sphere(2)
    thin = obj_text((vertices * [1, 1, thickness], faces))
    assert uploaded(api, thin, "?repair=weld")["repair"]["welded_vertices"] == 0


PLY_POINTS = "property float x\nproperty float y\nproperty float z\n"


@pytest.mark.parametrize("content, faces", [
    (stl(("0 0 0", "1 0 0", "1 1 0")).upper(), 1),
    ("# by hand\n; so it is\n" + stl(("0 0 0", "1 0 0", "1 1 0")), 1),
    (stl(("0 0 0", "1 0 0", "1 1 0")).replace("normal 0 0 1", "normal -1.#IND 1.#QNAN nan(ind)"), 1),
    (f"ply\nformat ascii 1.0\nelement vertex 4\n{PLY_POINTS}element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
     "0 0 0\n1 0 0\n0 1 0\n1 1 0\n4 0 1 2 3\n", 2),
    ("OFF4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", 2),
    ("off 4 2 0 0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2 3 0 2 3", 2),
    ("OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1\n2\n3\n", 2),
    ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 \\\n3 \\\n4\n", 2),
    ("v 0 0 0\nv 1 0 0\nv 1 1 0\nv nan inf -1.#IND\nf 1 2 3\n", 1),
])
def test_variants_of_the_formats_are_read(api: Api, content: str, faces: int) -> None:
    assert uploaded(api, content)["faces"] == faces


@pytest.mark.parametrize("content, code, place, reason", [
    (b"v 0 0 -1.#IND\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "mesh.non_finite", "vertex 0", "not a finite number"),
    (b"v 0 0 0\nv 1 1.#QNAN 0\nv 1 1 0\nf 1 2 3\n", "mesh.non_finite", "vertex 1", "not a finite number"),
    (b"v 0 0 0\nv 1 0 0\nv 1 1 nan(ind)\nf 1 2 3\n", "mesh.non_finite", "vertex 2", "not a finite number"),
    (b"v 0 0 1.#INF\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "mesh.non_finite", "vertex 0", "not a finite number"),
    ("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n".encode("utf-16"), "mesh.malformed", "byte 0", "UTF-16"),
    (b"v 0 0 0\nv 1,5 0 0\n", "mesh.malformed", "line 2", "decimals take a point"),
    (b"v 0 0 0\nv 1 0 0\nv 1 1 0 red\nf 1 2 3\n", "mesh.malformed", "line 3", "'red'"),
    (b"PK\x03\x04 and so on", "mesh.malformed", "byte 0", "3MF"),
    (b"solid from a scanner".ljust(80, b"\0") + b"\2\0\0\0" + bytes(50), "mesh.malformed", "byte 134", "expected facet 1 of 2"),
])
def test_what_cannot_be_read_right_is_refused_with_the_reason(api: Api, content: bytes, code: str, place: str, reason: str) -> None:
    refused = post(api, content)
    assert (refused.status_code, problem_code(refused), pointers(refused)) == (422, code, [place])
    assert reason in json.dumps(refused.json()["errors"])


def test_a_surface_that_crosses_itself_is_no_solid_and_the_place_is_named(api: Api) -> None:
    vertices, faces = sphere(2)
    vertices = vertices.copy()
    vertices[0] *= -1.3
    mesh = api.upload(vertices, faces)
    request = {"mesh": mesh, "points": [{"vertex": 3}, {"vertex": 9}], "springs": [{"between": [0, 1], "rest_length": 0.1}],
               "host": {"kind": "solid", "youngs_modulus": 10}}
    refused = api.post("/v1/embedded-systems", request)
    assert (refused.status_code, problem_code(refused)) == (422, "solid.self_crossing")
    first = refused.json()["errors"][0]
    assert first["pointer"].startswith("face ") and " at (" in first["detail"]
    # Geodesics and shell hosts can still use the mesh.
    api.ok("/v1/geodesics", {"mesh": mesh, "pairs": [{"from": {"vertex": 3}, "to": {"vertex": 9}}]})


def run(api: Api, folder: Path, *arguments: str) -> str:
    finished = subprocess.run([str(CLI), *arguments], cwd=folder, env={**os.environ, "SUPPLE_SERVER": api.server.url},
                              capture_output=True, text=True, timeout=60, check=False)
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


def test_the_command_line_client_repairs_automatically_and_says_what_it_did(api: Api, tmp_path: Path) -> None:
    (tmp_path / "seam.obj").write_text(SEAM)
    (tmp_path / "doubled.obj").write_text(DOUBLED)
    (tmp_path / "sound.obj").write_text(obj_text(sphere(1)))
    assert "uploaded with repair=weld they are joined" in run(api, tmp_path, "mesh", "add", "seam.obj")
    said = run(api, tmp_path, "mesh", "add", "--repair", "automatic", "seam.obj", "doubled.obj", "sound.obj")
    lines: List[str] = [line.split("made", 1)[1].strip() for line in said.splitlines() if line.startswith("repairs made")]
    assert lines == ["weld", "drop_degenerate, drop_duplicates", "none; nothing had to be repaired"]


def test_the_python_package_repairs_automatically(api: Api) -> None:
    with supple.Client(api.server.url) as client:
        mesh = client.upload(SEAM.encode(), repair="automatic")
        assert mesh.repair is not None and mesh.repair.made == ("weld",) and mesh.info.boundary_loops == 2
        mesh = client.upload_arrays([[0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 1, 2], [2, 1, 0], [1, 2, 0]], repair="automatic")
        assert mesh.repair is not None and mesh.repair.made == ("drop_duplicates",)
        with pytest.raises(supple.InvalidMesh, match="repair=weld"):
            client.upload(ONE_END_OFF.encode())
