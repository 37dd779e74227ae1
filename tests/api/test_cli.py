"""The command line client against a live server."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import time
from pathlib import Path
from typing import Iterator, List, Tuple

import numpy as np
import pytest

from cli_program import Program, number_after
from harness import Api, CLI, MESHES, free_port, needs_terminals
from shapes import bumpy_sphere, flat_grid, sphere, two_triangles_apart
from working_time import PATIENCE_SECONDS


@pytest.fixture
def supple(api: Api, tmp_path: Path) -> Program:
    return Program(api.server.url, tmp_path)


def test_help_lists_the_commands_examples_and_exit_codes(supple: Program) -> None:
    text = supple.ok("--help")
    for word in ("geodesic", "karcher", "exponential-map", "Examples", "Exit status", "SUPPLE_SERVER"):
        assert word in text
    for command in ("mesh", "geodesic", "field", "karcher", "relax", "exponential-map", "job"):
        assert "Usage: supple " + command in supple.ok(command, "--help")


def test_a_mesh_is_added_listed_shown_downloaded_and_deleted(supple: Program) -> None:
    file = supple.file("grid.obj", flat_grid(3, 7.5))
    added = supple.ok("mesh", "add", file)
    mesh = re.search(r"[0-9a-f]{64}", added).group(0)  # type: ignore[union-attr]
    assert number_after("faces", added) == 18
    assert mesh in supple.ok("mesh", "list")
    assert supple.ok("mesh", "show", mesh[:20]) == added == supple.ok("mesh", "show", file)
    supple.ok("mesh", "get", mesh, "-o", "copy.obj")
    assert json.loads(supple.ok("--json", "mesh", "add", "copy.obj"))["id"] == mesh
    supple.ok("mesh", "delete", mesh)
    assert mesh not in supple.ok("mesh", "list")


def test_a_geodesic_is_printed_and_its_path_written(supple: Program) -> None:
    file = supple.file("grid.obj", flat_grid(8))
    text = supple.ok("geodesic", file, "v0", "v80", "v0", "0:0.2,0.3,0.5", "--path", "path.obj", "--derivatives", "2")
    assert "vertex 0 -> vertex 80: distance 1.414213562373095" in text
    assert "face 0 (0.2, 0.3, 0.5)" in text and text.count("gradient") == 2 and text.count("Hessian") == 8
    lines = (supple.folder / "path.obj").read_text().splitlines()
    points = np.array([[float(x) for x in line.split()[1:]] for line in lines if line.startswith("v ")])
    polylines = [[int(i) for i in line.split()[1:]] for line in lines if line.startswith("l ")]
    assert len(polylines) == 2
    first = points[np.array(polylines[0]) - 1]
    assert np.linalg.norm(np.diff(first, axis=0), axis=1).sum() == pytest.approx(2**0.5)
    supple.ok("geodesic", file, "v0", "v80", "-p", "path.json")
    assert json.loads((supple.folder / "path.json").read_text())[0][-1]["position"] == [1, 1, 0]


def test_json_is_the_servers_answer(supple: Program, api: Api) -> None:
    file = supple.file("grid.obj", flat_grid(8))
    answer = json.loads(supple.ok("--json", "geodesic", file, "v0", "v8"))
    api.contract.validate({"$ref": "#/components/schemas/GeodesicsResponse"}, answer, "the CLI's output")


def test_points_of_different_components_are_said_to_be_unreachable(supple: Program) -> None:
    text = supple.ok("geodesic", supple.file("two.obj", two_triangles_apart()), "v0", "v3")
    assert "unreachable" in text


def test_a_field_is_written_as_csv_as_doubles_and_as_a_coloured_mesh(supple: Program) -> None:
    mesh = flat_grid(8)
    file = supple.file("grid.obj", mesh)
    expected = np.linalg.norm(mesh[0] - mesh[0][5], axis=1)
    summary = supple.ok("field", file, "v5", "-o", "field.csv")
    assert number_after("largest", summary) == pytest.approx(expected.max())
    table = np.genfromtxt(supple.folder / "field.csv", delimiter=",", skip_header=1)
    np.testing.assert_allclose(table[:, 1], expected, atol=1e-12)
    supple.ok("field", file, "v5", "-o", "field.f64")
    np.testing.assert_allclose(np.fromfile(supple.folder / "field.f64", "<f8"), expected, atol=1e-12)
    assert supple.ok("field", file, "v5", "-o", "-") == (supple.folder / "field.csv").read_text()
    supple.ok("field", file, "v5", "-o", "field.ply")
    header, body = (supple.folder / "field.ply").read_bytes().split(b"end_header\n", 1)
    assert b"element vertex 81" in header and b"element face 128" in header
    vertex = np.dtype([("position", "<f8", 3), ("colour", "u1", 3), ("quality", "<f8")])
    vertices = np.frombuffer(body[:81 * vertex.itemsize], vertex)
    np.testing.assert_allclose(vertices["position"], mesh[0])
    np.testing.assert_allclose(vertices["quality"], expected, atol=1e-12)
    assert len({tuple(colour) for colour in vertices["colour"].tolist()}) > 10


def test_the_coloured_mesh_can_be_uploaded_again(supple: Program) -> None:
    file = supple.file("grid.obj", flat_grid(8))
    supple.ok("field", file, "v5", "-o", "field.ply")
    first, second = (json.loads(supple.ok("--json", "mesh", "add", name))["id"] for name in (file, "field.ply"))
    assert first == second


def test_a_weighted_mean_is_found_and_its_history_shown(supple: Program) -> None:
    file = supple.file("grid.obj", flat_grid(8))
    text = supple.ok("karcher", file, "v0", "v80", "--weights", "1,3", "--history")
    assert number_after("position", text) == pytest.approx(0.75, abs=1e-7)
    assert "converged" in text and "step" in text


def test_of_several_starts_the_one_that_led_to_the_mean_is_named(supple: Program) -> None:
    mean = ("karcher", supple.file("sphere.obj", sphere(2)), "v11", "v133", "v30")
    won = json.loads(supple.ok("--json", *mean, "--starts", "4"))["start"]
    assert won > 0
    assert re.search(rf"^start +{won} led here, of 4 counted from 0$", supple.ok(*mean, "--starts", "4"), re.MULTILINE)
    assert "led here" not in supple.ok(*mean)


def test_a_network_is_relaxed_and_written_in_three_forms(supple: Program) -> None:
    file = supple.file("grid.obj", flat_grid(8))
    network = ("relax", file, "v0", "v80", "v40", "--spring", "0,2,0,3", "-s", "1,2", "--fixed", "0,1")
    text = supple.ok(*network, "--history", "--obj", "network.obj", "--vtu", "network.vtu", "--plot", "convergence.svg")
    assert number_after("energy", text) == pytest.approx(2 * 0.75)
    assert "3 points, 2 springs" in text and "converged" in text and "step" in text
    lines = (supple.folder / "network.obj").read_text().splitlines()
    points = np.array([[float(x) for x in line.split()[1:]] for line in lines if line.startswith("v ")])
    ends = [int(line.split()[-1]) - 1 for line in lines if line.startswith("l ")]
    np.testing.assert_allclose(points[ends], [[0.25, 0.25, 0]] * 2, atol=1e-7)
    assert "NumberOfCells=\"2\"" in (supple.folder / "network.vtu").read_text()
    assert (supple.folder / "convergence.svg").read_text().startswith("<svg")
    answer = json.loads(supple.ok("--json", *network, "--method", "lbfgs", "--euclidean"))
    assert answer["terms"][0]["name"] == "euclidean_springs"
    np.testing.assert_allclose(answer["positions"][2], [0.25, 0.25, 0], atol=1e-7)


def test_a_membrane_is_relaxed_and_written(supple: Program) -> None:
    file = supple.file("grid.obj", flat_grid(8))
    membrane = ("relax", file, "v0", "v8", "v80", "v72", "v31", "--triangle", "0,1,4", "--triangle", "1,2,4", "--triangle", "2,3,4",
                "--triangle", "3,0,4", "--rest-scale", "0.8", "--youngs-modulus", "2", "--poisson-ratio", "0.2", "--thickness", "0.5",
                "--fixed", "0,1,2,3")
    text = supple.ok(*membrane, "--obj", "membrane.obj", "--vtu", "membrane.vtu")
    assert "5 points, 0 springs, 4 triangles stretched 1.25 to 1.25 times" in text and "converged" in text
    assert len([line for line in (supple.folder / "membrane.obj").read_text().splitlines() if line.startswith("f ")]) == 4
    assert "greater_stretch" in (supple.folder / "membrane.vtu").read_text()
    sphere_file = supple.file("sphere.obj", sphere(2))
    every = json.loads(supple.ok("--json", "relax", sphere_file, "--poisson-disk", "0.6", "--membrane", "--rest-scale", "0.9"))
    assert len(every["membrane"]) == len(every["triangles"]) > 10 and every["springs"] == []


def test_a_network_pulls_at_a_shell(supple: Program) -> None:
    vertices, faces = sphere(2)
    shell = ("relax", supple.file("sphere.obj", (vertices, faces)), "v0", "v5", "v1", "--spring", "0,1,0.5", "--spring", "1,2,0.5",
             "--host-kind", "shell", "--host-thickness", "0.02", "--host-youngs-modulus", "1000", "--host-poisson-ratio", "0.4",
             "--volume-weight", "1000", "--volume-scale", "1.05", "--fix-vertex", "3", "--fix-vertex", "4,9")
    text = supple.ok(*shell, "--obj", "tight.obj", "--vtu", "tight.vtu")
    assert "converged" in text and "shell of 162 vertices" in text
    answer = json.loads(supple.ok("--json", *shell))
    host = answer["host"]
    assert number_after("moved by up to", text) == pytest.approx(host["largest_displacement"], rel=1e-5) and host["volume_ratio"] > 1.02
    assert number_after("encloses", text) == pytest.approx(host["volume_ratio"], rel=1e-5)
    for term in answer["terms"]:
        assert number_after(term["name"], text) == pytest.approx(term["energy"], rel=1e-6)
    assert {term["name"] for term in answer["terms"]} == {"geodesic_springs", "shell_membrane", "shell_bending", "shell_volume"}
    np.testing.assert_array_equal(np.array(host["vertices"])[[3, 4, 9]], vertices[[3, 4, 9]])
    own = (supple.folder / "tight.obj").read_text().split("o host\n")[1].splitlines()
    written = np.array([[float(x) for x in line.split()[1:]] for line in own if line.startswith("v ")])
    np.testing.assert_allclose(written, host["vertices"], atol=1e-9)
    assert f'NumberOfCells="{2 + len(faces)}"' in (supple.folder / "tight.vtu").read_text()
    assert "shell_bending" not in supple.ok(*shell, "--no-bending")


def test_a_solid_sags_and_a_file_may_say_the_host(supple: Program) -> None:
    vertices, faces = sphere(2)
    bottom = np.flatnonzero(vertices[:, 2] < -0.7).tolist()
    solid = ("relax", supple.file("sphere.obj", (vertices, faces)), "v0", "v5", "--spring", "0,1", "--fixed", "0",
             "--host-kind", "solid", "--host-youngs-modulus", "100", "--host-poisson-ratio", "0.2", "--element-size", "0.4",
             "--gravity", "0,0,-5", "--region", "-2,-2,0.3,2,2,2,30", "--region", "-2,-2,0.6,2,2,2,20",
             "--fix-vertex", ",".join(map(str, bottom)))
    text = supple.ok(*solid)
    assert re.search(r"solid of \d+ tetrahedra and \d+ nodes, moved by up to", text) and number_after("gravity", text) < 0
    answer = json.loads(supple.ok("--json", *solid))
    host = {"kind": "solid", "youngs_modulus": 100, "poisson_ratio": 0.2, "element_size": 0.4, "gravity": [0, 0, -5],
            "fixed_vertices": bottom, "regions": [{"lower": [-2, -2, low], "upper": [2, 2, 2], "youngs_modulus": modulus}
                                                  for low, modulus in ((0.3, 30), (0.6, 20))]}
    network = {"points": [{"vertex": 0}, {"vertex": 5}], "springs": [{"between": [0, 1]}], "fixed_points": [0], "host": host}
    (supple.folder / "network.json").write_text(json.dumps(network))
    read = ("--json", "relax", "sphere.obj", "--network", "network.json")
    assert json.loads(supple.ok(*read))["energy"] == answer["energy"]
    # Options take precedence over the host in the file, and another kind replaces that host.
    assert json.loads(supple.ok(*read, "--host-youngs-modulus", "200"))["energy"] != answer["energy"]
    assert "host" not in json.loads(supple.ok(*read, "--host-kind", "rigid"))


def test_a_file_may_say_where_the_surface_moves(supple: Program) -> None:
    vertices, faces = flat_grid(2)
    network = {"points": [{"vertex": 0}, {"vertex": 8}], "springs": [{"between": [0, 1]}], "fixed_points": [0, 1],
               "host": {"kind": "moving", "positions": [(vertices * scale).tolist() for scale in (1.5, 2)]}}
    (supple.folder / "network.json").write_text(json.dumps(network))
    moving = ("relax", supple.file("grid.obj", (vertices, faces)), "--network", "network.json")
    assert "moving surface of 9 vertices, 2 positions, moved by up to 1.41421" in supple.ok(*moving)
    refused = supple.run(*moving, "--fix-vertex", "0")
    assert refused.returncode == 1 and "--fix-vertex needs --host-kind" in refused.stderr


def test_options_say_where_the_surface_moves_and_where_vertices_are_taken(supple: Program) -> None:
    vertices, faces = flat_grid(2)
    supple.file("once.obj", (1.5 * vertices, faces))
    (supple.folder / "twice.txt").write_text("# the same, larger\n" + "\n".join(f"{x}, {y}, {z}" for x, y, z in 2 * vertices))
    moving = ("relax", supple.file("grid.obj", (vertices, faces)), "v0", "v8", "--spring", "0,1", "--fixed", "0,1",
              "--host-kind", "moving", "--positions", "once.obj", "--positions", "twice.txt")
    answer = json.loads(supple.ok("--json", *moving))
    assert len(answer["host"]["stops"]) == 2
    np.testing.assert_allclose(answer["host"]["vertices"], 2 * vertices)
    (supple.folder / "wrong.txt").write_text("0 0 0\n1 0\n")
    refused = supple.run(*moving[:-1], "wrong.txt")
    assert refused.returncode == 1 and "line 2 of" in refused.stderr and "no position of a vertex" in refused.stderr
    shell = (*moving[:8], "--host-kind", "shell", "--host-thickness", "0.1", "--host-youngs-modulus", "10",
             "--fix-vertex", "0,1,2,3", "--move-vertex", "8,1.1,1,0,1.2,1,0.3")
    assert "shell of 9 vertices, 2 positions, moved by up to" in supple.ok(*shell)
    answer = json.loads(supple.ok("--json", *shell))
    assert [stop["reached"] for stop in answer["host"]["stops"]] == [1, 1]
    np.testing.assert_allclose(answer["host"]["vertices"][8], [1.2, 1, 0.3], atol=1e-12)


@pytest.mark.parametrize("name", ["torus", "ball", "rabbit", "rabbit-pricks", "cushion"])
def test_sample_networks_are_read_as_they_are(supple: Program, name: str) -> None:
    mesh = MESHES / f"{name.split('-')[0]}.obj"
    text = supple.ok("relax", str(mesh), "--network", str(MESHES.parent / "networks" / f"{name}.json"))
    assert "converged" in text and ("host " in text) == (name != "torus")


def test_networks_are_built_or_read_from_a_file(supple: Program) -> None:
    file = supple.file("sphere.obj", sphere(2))
    built = json.loads(supple.ok("--json", "relax", file, "--poisson-disk", "0.7", "--seed", "4", "--voronoi-dual",
                                 "--rest-length", "0.5", "--weight", "2", "--max-iterations", "1"))
    assert built["triangles"] and len(built["history"]) <= 2
    dual = json.loads(supple.ok("--json", "relax", file, "--per-face", "0.3,0.3,0.4", "--adjacent-faces",
                                "--max-iterations", "1"))
    assert (len(dual["points"]), len(dual["springs"])) == (320, 480)
    (supple.folder / "network.json").write_text(json.dumps(
        {"points": [{"vertex": 0}, {"vertex": 9}], "springs": [{"between": [0, 1], "rest_length": 0.1}], "fixed_points": [1]}))
    read = json.loads(supple.ok("--json", "relax", file, "--network", "network.json"))
    assert read["springs"][0]["length"] == pytest.approx(0.1)


@pytest.mark.parametrize("arguments, message", [
    ([], "give points"),
    (["v0", "--per-face", "1,0,0", "--adjacent-faces"], "give points"),
    (["v0", "v1"], "give springs"),
    (["v0", "v1", "--spring", "0"], "is no spring"),
    (["v0", "v1", "--spring", "0,1.5"], "names no point"),
    (["v0", "v1", "--spring", "0,1", "--fixed", "-1"], "names no point"),
    (["v0", "v1", "--triangle", "0,1"], "is no triangle"),
    (["v0", "v1", "--triangle", "0,1,2", "--membrane"], "give triangles"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "shell", "--host-thickness", "1"], "a shell needs --host-youngs-modulus"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "shell", "--host-youngs-modulus", "1"], "a shell needs --host-thickness"),
    (["v0", "v1", "-s", "0,1", "--fix-vertex", "1"], "--fix-vertex needs --host-kind shell or --host-kind solid"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "solid", "--volume-weight", "1"], "--volume-weight needs --host-kind shell"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "shell", "--gravity", "0,0,1"], "--gravity needs --host-kind solid"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "solid", "--host-youngs-modulus", "1", "--gravity", "0,1"], "'0,1' is no force"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "solid", "--host-youngs-modulus", "1", "--region", "0,1"], "'0,1' is no region"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "solid", "--host-youngs-modulus", "1", "--fix-vertex", "0.5"], "names no vertex"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "jelly"], "jelly"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "moving"], "a moving surface needs --positions"),
    (["v0", "v1", "-s", "0,1", "--move-vertex", "1,0,0,0"], "--move-vertex needs --host-kind shell or --host-kind solid"),
    (["v0", "v1", "-s", "0,1", "--host-kind", "solid", "--host-youngs-modulus", "1", "--move-vertex", "1,0,0"], "moves no vertex"),
])
def test_a_network_that_is_not_told_in_full_is_a_usage_error(supple: Program, arguments: "list[str]", message: str) -> None:
    refused = supple.run("relax", supple.file("grid.obj", flat_grid(2)), *arguments)
    assert refused.returncode == 1 and message in refused.stderr


def test_a_straightest_path_is_traced(supple: Program) -> None:
    file = supple.file("grid.obj", flat_grid(8))
    text = supple.ok("exponential-map", file, "v40", "--tangent", "-0.1,0.2,0", "--path", "trace.obj")
    assert number_after("position", text) == pytest.approx(0.4)
    assert number_after("length", text) == pytest.approx(0.05**0.5)
    assert (supple.folder / "trace.obj").read_text().count("\nl ") == 1


@pytest.mark.parametrize("arguments, code, message", [
    (["geodesic"], 1, "required"),
    (["fly"], 1, ""),
    (["geodesic", "abc", "v0", "v1", "v2"], 1, "pairs"),
    (["geodesic", "abc", "v0", "x1"], 1, "'x1' is not a surface point"),
    (["geodesic", "abc", "v0", "1:0.5"], 1, "is not a surface point"),
    (["geodesic", "nosuchfile.obj", "v0", "v1"], 5, "no such file"),
    (["geodesic", "nosuchmesh", "v0", "v1"], 1, "neither a mesh file nor the id"),
    (["geodesic", "0" * 64, "v0", "v1"], 2, "mesh.not_found"),
    (["geodesic", "0000000000", "v0", "v1"], 2, "no mesh of"),
    (["mesh", "add", "nosuchfile.obj"], 5, "no such file"),
    (["job", "show", "0" * 32], 2, "job.not_found"),
    (["--server", "ftp://x", "mesh", "list"], 1, "not a server address"),
])
def test_a_failure_has_its_exit_code_and_one_clear_message(
        supple: Program, arguments: List[str], code: int, message: str) -> None:
    finished = supple.run(*arguments)
    assert finished.returncode == code, finished.stderr
    assert message in finished.stderr and finished.stderr.strip()
    assert finished.stdout == ""


def test_a_faulty_mesh_names_its_elements(supple: Program) -> None:
    (supple.folder / "bad.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\n")
    finished = supple.run("mesh", "add", "bad.obj")
    assert finished.returncode == 2
    assert "mesh.degenerate_face" in finished.stderr and "face 0" in finished.stderr


def test_a_faulty_mesh_is_repaired_on_request(supple: Program) -> None:
    (supple.folder / "bad.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1e-4 1 0\nv 1 1 0\nf 1 2 2\nf 1 2 3\nf 4 2 5\n")
    text = supple.ok("mesh", "add", "--repair", "weld,drop_degenerate", "--weld-tolerance", "1e-4", "bad.obj")
    assert "1 vertex was welded" in text and "1 degenerate face was dropped" in text
    assert number_after("faces", text) == 2 and number_after("components", text) == 1
    document = json.loads(supple.ok("--json", "mesh", "add", "bad.obj", "--repair", "drop_degenerate,split_non_manifold"))
    assert document["repair"]["faces"] == [None, 0, 1]
    for arguments, status, message in ((["--repair", "heal"], 2, "split_non_manifold"), (["--repair", "a&b"], 1, "no repairs"),
                                       (["--weld-tolerance", "1e-4"], 1, "--repair"),
                                       (["--repair", "weld", "--weld-tolerance", "x"], 1, "weld tolerance")):
        finished = supple.run("mesh", "add", "bad.obj", *arguments)
        assert finished.returncode == status and message in finished.stderr, finished.stderr


def test_a_file_that_cannot_be_written_is_said(supple: Program) -> None:
    file = supple.file("grid.obj", flat_grid(2))
    finished = supple.run("field", file, "v0", "-o", "no/such/folder.csv")
    assert finished.returncode == 5 and "no/such/folder.csv" in finished.stderr


def test_without_a_server_it_says_where_it_looked(tmp_path: Path) -> None:
    url = f"http://127.0.0.1:{free_port()}"
    finished = Program(url, tmp_path).run("mesh", "list")
    assert finished.returncode == 4 and url in finished.stderr


def start_long_field(supple: Program, sub: int = 7) -> Tuple["subprocess.Popen[str]", str]:
    mesh = json.loads(supple.ok("--json", "mesh", "add", supple.file("large.obj", bumpy_sphere(sub))))["id"]
    process = subprocess.Popen([str(CLI), "field", mesh, "v0", "-o", "large.f64"], cwd=supple.folder, text=True,
                               env={**os.environ, "SUPPLE_SERVER": supple.url}, stderr=subprocess.PIPE, stdout=subprocess.PIPE)
    return process, mesh


def test_what_takes_longer_than_a_second_is_followed_as_a_job(supple: Program, api: Api) -> None:
    process, mesh = start_long_field(supple)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    assert errors == "", "no bar is drawn where standard error is no terminal"
    assert (supple.folder / "large.f64").stat().st_size == 8 * api.get(f"/v1/meshes/{mesh}").json()["vertices"]


def test_a_relaxation_that_takes_longer_than_a_second_is_followed_to_its_limit(supple: Program) -> None:
    file = supple.file("bumpy.obj", bumpy_sphere(4))
    network = {"points": {"kind": "per_face", "barycentric": [0.3, 0.3, 0.4]}, "fixed_points": [0, 400, 900],
               "springs": {"kind": "adjacent_faces", "rest_length": 0.01}, "method": "gradient_descent"}
    (supple.folder / "network.json").write_text(json.dumps(network))
    start = time.monotonic()
    printed = supple.ok("relax", file, "--network", "network.json", "--max-iterations", "500", "--tolerance", "1e-14")
    assert time.monotonic() - start > 1, "it was no job: nothing was followed"
    assert "after 500 iterations" in printed


@pytest.fixture
def queue_of_jobs(api: Api) -> Iterator[List[str]]:
    """Long jobs that occupy every worker for some seconds, so that later jobs wait."""
    yield from queued(api, 7)


@pytest.fixture
def queue_of_shorter_jobs(api: Api) -> Iterator[List[str]]:
    """Jobs of a second or more, for a test that waits until they have ended."""
    yield from queued(api, 6)


def queued(api: Api, subdivisions: int) -> Iterator[List[str]]:
    mesh = api.upload(*bumpy_sphere(subdivisions))
    jobs = [api.post("/v1/geodesic-fields", {"mesh": mesh, "sources": [{"vertex": v}]},
                     headers={"Prefer": "respond-async"}).json()["id"] for v in range(12)]
    yield jobs
    for job in jobs:
        api.delete(f"/v1/jobs/{job}")


@pytest.mark.parametrize("delay", [0.3, 1.6], ids=["while-immediate", "while-a-job"])
def test_ctrl_c_cancels_the_computation_on_the_server(
        supple: Program, api: Api, queue_of_jobs: List[str], delay: float) -> None:
    process, _ = start_long_field(supple)
    time.sleep(delay)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=PATIENCE_SECONDS)
    assert process.returncode == 130 and "interrupted" in errors
    end = time.monotonic() + PATIENCE_SECONDS
    while True:
        ready = api.get("/readyz").json()
        unfinished = [job for job in queue_of_jobs if api.get(f"/v1/jobs/{job}").json()["state"] in ("accepted", "running")]
        assert unfinished, "the other jobs ended before it could be seen"
        if ready["jobs_running"] + ready["jobs_waiting"] <= len(unfinished):
            break
        assert time.monotonic() < end, "the computation still waits for its turn"


@needs_terminals
def test_a_progress_bar_is_drawn_on_a_terminal(supple: Program, queue_of_shorter_jobs: List[str]) -> None:
    process = subprocess.run(["script", "-qec", f"{CLI} job wait {queue_of_shorter_jobs[-1]}", "/dev/null"], cwd=supple.folder,
                             env={**os.environ, "SUPPLE_SERVER": supple.url}, capture_output=True, timeout=120, check=False)
    assert process.returncode == 0
    assert re.search(rb"\[#*\.*\]\s+\d+ %  \d+ s  waiting", process.stdout), process.stdout[-400:]


def test_jobs_are_listed_shown_waited_for_and_removed(supple: Program, api: Api) -> None:
    mesh = api.upload(*sphere(2))
    request = {"mesh": mesh, "points": [{"vertex": 0}, {"vertex": 7}]}
    job = api.post("/v1/karcher-means", request, headers={"Prefer": "respond-async"}).json()["id"]
    assert json.loads(supple.ok("job", "wait", job))["mesh"] == mesh
    assert json.loads(supple.ok("job", "result", job))["mesh"] == mesh
    assert "successful" in supple.ok("job", "show", job)
    assert job in supple.ok("job", "list", "--state", "successful")
    assert supple.run("job", "cancel", job).returncode == 2
    supple.ok("job", "remove", job)
    assert supple.run("job", "show", job).returncode == 2


def test_a_running_job_is_cancelled_by_its_id(supple: Program, api: Api) -> None:
    mesh = api.upload(*bumpy_sphere(7))
    job = api.post("/v1/geodesic-fields", {"mesh": mesh, "sources": [{"vertex": 0}]},
                   headers={"Prefer": "respond-async"}).json()["id"]
    supple.ok("job", "cancel", job)
    assert "dismissed" in supple.ok("job", "show", job)
    finished = supple.run("job", "result", job)
    assert finished.returncode == 2 and "job.dismissed" in finished.stderr
