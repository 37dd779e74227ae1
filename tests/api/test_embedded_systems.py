"""Elastic networks on surfaces over HTTP."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, Callable, Dict, List
from xml.etree import ElementTree

import numpy as np
import pytest

from contract import Contract
from elastic_networks import CENTRES, CORNERS, NETWORKS, SHELL, at_vertices, effect, net, springs, volume
from harness import SLOWNESS, Api, ServerProcess, pointers, problem_code
from shapes import bumpy_sphere, flat_grid, sphere, two_triangles_apart
from working_time import WorkingTime, comes_true, ends_within
from test_jobs import events, start_job


def two_free_points(mesh: str, **more: Any) -> Dict[str, Any]:
    """The corners of a square, and two points with springs to them and to each other."""
    return {"mesh": mesh, "points": at_vertices(*CORNERS, 31, 50),
            "springs": [{"between": [0, 4], "weight": 2}, *springs((1, 4), (2, 5), (3, 5)),
                        {"between": [4, 5], "weight": 0.5}],
            "fixed_points": [3, 0, 1, 2], **more}


# --- equilibria ----------------------------------------------------------------------------------------------------------


def test_a_membrane_whose_border_is_stretched_is_stretched_alike_inside(api: Api, grid_mesh: str) -> None:
    vertices = flat_grid(8)[0]
    places = np.array([[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75], [0.5, 0.375]])
    points = at_vertices(*(int(np.argmin(np.linalg.norm(vertices[:, :2] - place, axis=1))) for place in places))
    request = {"mesh": grid_mesh, "points": points, "springs": [], "fixed_points": [0, 1, 2, 3],
               "triangles": [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]],
               "membrane": {"youngs_modulus": 3, "poisson_ratio": 0.4, "thickness": 0.1, "rest_scale": 0.8}}
    answer = api.ok(NETWORKS, request)
    assert answer["stopped"] == "converged" and answer["triangles"] == request["triangles"]
    # The start is an equilibrium, stretched by 1 / 0.8 in both directions.
    np.testing.assert_allclose(answer["positions"][4], [0.5, 0.375, 0], atol=1e-7)
    assert [t["stretches"] for t in answer["membrane"]] == [pytest.approx([1.25, 1.25], rel=1e-6)] * 4
    mu, lame = 3 / 2.8, 3 * 0.4 / (1.4 * 0.2)
    density = mu / 2 * (2 * 1.25 ** 2 - 2 - 4 * np.log(1.25)) + lame / 2 * (2 * np.log(1.25)) ** 2
    assert answer["energy"] == pytest.approx(0.1 * 0.25 * 0.64 * density, rel=1e-9)
    assert answer["terms"] == [{"name": "membrane", "energy": answer["energy"]}]
    assert effect(answer, "membrane")["ran"] is True
    assert answer["accuracy"]["gradient_tolerance"] == pytest.approx(1e-9 * 0.3 * np.sqrt(2))


def test_a_membrane_from_voronoi_cells_relaxes_with_its_springs(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": {"kind": "poisson_disk", "radius": 0.5}, "springs": {"kind": "voronoi_dual"},
               "triangles": {"kind": "voronoi_dual"}, "membrane": {"rest_scale": 0.9}, "fixed_points": [0]}
    answer = api.ok(NETWORKS, request)
    assert answer["stopped"] == "converged"
    assert len(answer["membrane"]) == len(answer["triangles"]) > 20
    terms = {term["name"]: term["energy"] for term in answer["terms"]}
    assert sum(terms.values()) == pytest.approx(answer["energy"], rel=1e-9)
    assert terms["membrane"] == pytest.approx(sum(t["energy"] for t in answer["membrane"]), rel=1e-9)
    assert all(step["energy"] <= before["energy"] * (1 + 1e-12)
               for before, step in zip(answer["history"], answer["history"][1:]))


# --- deformable hosts ----------------------------------------------------------------------------------------------------


EXAMPLES = Path(__file__).resolve().parents[2] / "api" / "examples"


def test_reins_converge_on_meshes_that_differ_in_their_last_digits(api: Api) -> None:
    # A point comes so near to a saddle vertex that only rounding separates it from the vertex. The directions of its paths are
    # not defined beyond the vertex.
    lines = [line.split() for line in (EXAMPLES / "meshes" / "rabbit.obj").read_text().splitlines()]
    vertices = np.array([[float(word) for word in line[1:4]] for line in lines if line[:1] == ["v"]])
    faces = [[int(word.split("/")[0]) - 1 for word in line[1:4]] for line in lines if line[:1] == ["f"]]
    reins = json.loads((EXAMPLES / "networks" / "rabbit.json").read_text())
    energies = []
    for seed in range(12):
        rounding = 1e-15 * np.random.default_rng(seed).normal(size=(2, *vertices.shape))
        answer = api.ok(NETWORKS, {**reins, "mesh": api.upload(vertices * (1 + rounding[0]) + rounding[1], faces)})
        assert answer["stopped"] == "converged"
        energies.append(answer["energy"])
    np.testing.assert_allclose(energies, energies[0], rtol=1e-9)


def test_a_network_dents_a_shell_that_keeps_its_volume(api: Api, sphere_mesh: str) -> None:
    vertices, faces = sphere(3)
    answer = api.ok(NETWORKS, net(sphere_mesh, host=SHELL))
    assert answer["stopped"] == "converged"
    moved = answer["host"]["vertices"]
    displacement = np.linalg.norm(np.asarray(moved) - vertices, axis=1).max()
    assert displacement == pytest.approx(answer["host"]["largest_displacement"]) and displacement > 1e-3
    ratio = volume(moved, faces) / volume(vertices, faces)
    assert ratio == pytest.approx(answer["host"]["volume_ratio"], rel=1e-9)
    terms = {term["name"]: term["energy"] for term in answer["terms"]}
    assert list(terms) == ["geodesic_springs", "shell_membrane", "shell_bending", "shell_volume"]
    assert sum(terms.values()) == pytest.approx(answer["energy"], rel=1e-9)
    assert terms["shell_volume"] == pytest.approx(100 / 2 * (ratio - 1) ** 2 * volume(vertices, faces), rel=1e-6)
    # The points are on the deformed surface.
    for point, position in zip(answer["points"], answer["positions"]):
        corners = np.asarray(moved)[faces[point["face"]]]
        np.testing.assert_allclose(np.asarray(point["barycentric"]) @ corners, position, atol=1e-12)
    assert effect(answer, "shell_bending")["ran"] and effect(answer, "shell_volume")["ran"]
    assert not effect(answer, "self_contact")["ran"]
    assert any("No fixed vertices" in warning for warning in answer["warnings"])
    # A stiffer host deforms less, and a rigid one not at all.
    stiff = api.ok(NETWORKS, net(sphere_mesh, host={**SHELL, "youngs_modulus": 1e6, "volume_weight": 1e5}))
    assert stiff["host"]["largest_displacement"] < 0.1 * displacement
    rigid = api.ok(NETWORKS, net(sphere_mesh))
    assert "host" not in rigid and rigid["energy"] > stiff["energy"] > answer["energy"]


def test_bending_and_volume_of_a_shell_are_there_only_where_they_are_asked_for(api: Api, sphere_mesh: str) -> None:
    host = {name: SHELL[name] for name in ("kind", "thickness", "youngs_modulus")}
    answer = api.ok(NETWORKS, net(sphere_mesh, host=host, effects={"bending": "off"}, max_iterations=3))
    assert [term["name"] for term in answer["terms"]] == ["geodesic_springs", "shell_membrane"]
    assert all(e["name"] not in ("shell_bending", "shell_volume") for e in answer["effects"])


def test_a_network_squeezes_a_solid_whose_fixed_vertices_stay(api: Api, sphere_mesh: str) -> None:
    vertices = sphere(3)[0]
    low = [int(i) for i in np.flatnonzero(vertices[:, 2] < -0.8)]
    host = {"kind": "solid", "youngs_modulus": 10, "poisson_ratio": 0.3, "fixed_vertices": low, "element_size": 0.4}
    answer = api.ok(NETWORKS, net(sphere_mesh, host=host))
    assert answer["stopped"] == "converged"
    moved = np.asarray(answer["host"]["vertices"])
    np.testing.assert_array_equal(moved[low], vertices[low])
    assert answer["host"]["tetrahedra"] > 100 and answer["host"]["nodes"] > len(vertices)
    assert answer["host"]["volume_ratio"] < 1
    assert [term["name"] for term in answer["terms"]] == ["geodesic_springs", "solid"]
    # Gravity lowers the solid, and a region of another stiffness changes the answer.
    heavy = api.ok(NETWORKS, net(sphere_mesh, host={**host, "gravity": [0, 0, -2]}))
    assert np.asarray(heavy["host"]["vertices"])[:, 2].mean() < moved[:, 2].mean()
    assert [term["name"] for term in heavy["terms"]] == ["geodesic_springs", "solid", "gravity"]
    region = {"lower": [-2, -2, 0], "upper": [2, 2, 2], "youngs_modulus": 1000}
    stiffer = api.ok(NETWORKS, net(sphere_mesh, host={**host, "regions": [region]}))
    assert stiffer["energy"] > answer["energy"]


def test_files_show_the_host_as_it_came_to_be(api: Api, sphere_mesh: str) -> None:
    vertices, faces = sphere(3)
    request = net(sphere_mesh, host=SHELL)
    answer = api.ok(NETWORKS, request)
    lines = api.post(NETWORKS, request, headers={"Accept": "model/obj"}).text.splitlines()
    assert "o network" in lines and "o host" in lines
    own = lines[lines.index("o host") + 1:]
    written = np.array([[float(x) for x in line.split()[1:]] for line in own if line.startswith("v ")])
    np.testing.assert_array_equal(written, answer["host"]["vertices"])
    first = sum(line.startswith("v ") for line in lines[:lines.index("o host")])
    corners = np.array([[int(x) for x in line.split()[1:]] for line in own if line.startswith("f ")]) - first - 1
    np.testing.assert_array_equal(corners, faces)
    response = api.post(NETWORKS, request, headers={"Accept": "application/x-vtu+xml"})
    piece = ElementTree.fromstring(response.content).find(".//Piece")
    assert piece is not None
    cells = int(piece.attrib["NumberOfCells"])
    assert cells == len(request["springs"]) + len(faces)
    arrays = {array.attrib["Name"]: (array.text or "").split() for array in piece.iter("DataArray")}
    assert [int(x) for x in arrays["host"]] == [0] * len(request["springs"]) + [1] * len(faces)
    assert all(len(arrays[name]) == cells for name in ("energy", "length", "types", "offsets"))


@pytest.mark.parametrize("host, code, places", [
    ({**SHELL, "fixed_vertices": [3, 5000]}, "host.fixed_vertex", ["/host/fixed_vertices/1"]),
    ({**SHELL, "fixed_vertices": [3], "moved_vertices": [{"vertex": 3, "positions": [[0, 0, 0]]},
                                                         {"vertex": 4, "positions": [[0, 0, 0]]},
                                                         {"vertex": 4, "positions": [[0, 0, 0]]},
                                                         {"vertex": 5000, "positions": [[0, 0, 0]]}]},
     "host.moved_vertex", ["/host/moved_vertices/0/vertex", "/host/moved_vertices/2/vertex", "/host/moved_vertices/3/vertex"]),
    ({**SHELL, "fixed_vertices": [3], "moved_vertices": [{"vertex": 4, "positions": [[0, 0, 0]]}]}, "host.unsupported",
     ["/host/moved_vertices"]),
    ({"kind": "solid", "youngs_modulus": 1, "gravity": [0, 0, -1]}, "host.unsupported", ["/host/fixed_vertices"]),
    ({"kind": "solid", "youngs_modulus": 1, "regions": [{"lower": [1, 0, 0], "upper": [0, 1, 1], "youngs_modulus": 1}]},
     "host.invalid", ["/host/regions/0/lower"]),
])
def test_what_is_wrong_with_a_host_is_named(api: Api, sphere_mesh: str, host: Any, code: str, places: List[str]) -> None:
    response = api.post(NETWORKS, net(sphere_mesh, host=host))
    assert (response.status_code, problem_code(response)) == (422, code)
    assert pointers(response) == places


def test_an_open_surface_keeps_no_volume_and_is_no_solid(api: Api, grid_mesh: str) -> None:
    kept = api.post(NETWORKS, two_free_points(grid_mesh, host=SHELL))
    assert (kept.status_code, problem_code(kept)) == (422, "host.open_surface")
    filled = api.post(NETWORKS, two_free_points(grid_mesh, host={"kind": "solid", "youngs_modulus": 1}))
    assert (filled.status_code, problem_code(filled)) == (422, "solid.open_surface")


def test_a_host_that_gives_way_has_neither_straight_springs_nor_a_mollifier(api: Api, sphere_mesh: str) -> None:
    for change in ({"spring_length": "euclidean"}, {"effects": {"mollifier": "on"}}):
        response = api.post(NETWORKS, net(sphere_mesh, host=SHELL, **change))
        assert (response.status_code, problem_code(response)) == (422, "network.invalid_option")


def test_events_carry_the_host_on_its_way(api: Api, sphere_mesh: str) -> None:
    job = start_job(api, NETWORKS, net(sphere_mesh, host={**SHELL, "youngs_modulus": 100}))
    partial = [document["partial"] for _, document in events(api, job) if document.get("partial")]
    assert partial and all(len(state["vertices"]) == 642 for state in partial)


def test_faults_of_a_membrane_are_pointed_to(api: Api, grid_mesh: str) -> None:
    request = two_free_points(grid_mesh)
    response = api.post(NETWORKS, {**request, "triangles": [[0, 4, 5], [0, 4, 4], [0, 1, 99]]}, faulty=True)
    assert (response.status_code, problem_code(response)) == (422, "network.triangle")
    assert "/triangles/2/2" in pointers(response)
    # Three collinear points on the border of the square.
    response = api.post(NETWORKS, {**request, "points": at_vertices(0, 4, 8, 72, 31, 50), "triangles": [[0, 1, 2]]},
                        faulty=True)
    assert (response.status_code, problem_code(response)) == (422, "network.triangle")
    assert pointers(response) == ["/triangles/0"]
    response = api.post(NETWORKS, {**request, "triangles": [[0, 4, 5]], "spring_length": "euclidean"}, faulty=True)
    assert (response.status_code, problem_code(response)) == (422, "network.invalid_option")
    response = api.post(NETWORKS, {**request, "triangles": [[0, 4, 5]] * 300_001}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == ["/triangles"] and response.json()["setting"] == "--max-springs"



@pytest.mark.parametrize("method", ["newton", "lbfgs", "gradient_descent"])
@pytest.mark.parametrize("length", ["geodesic", "euclidean"])
def test_on_a_flat_square_springs_without_rest_length_solve_a_linear_system(
        api: Api, grid_mesh: str, method: str, length: str) -> None:
    answer = api.ok(NETWORKS, two_free_points(grid_mesh, method=method, spring_length=length, max_iterations=2000))
    corners = flat_grid(8)[0][CORNERS]
    expected = np.linalg.solve([[3.5, -0.5], [-0.5, 2.5]], [2 * corners[0] + corners[1], corners[2] + corners[3]])
    assert answer["stopped"] == "converged"
    np.testing.assert_allclose(answer["positions"][:4], corners, atol=1e-15)
    np.testing.assert_allclose(answer["positions"][4:], expected, atol=1e-8)
    assert answer["terms"] == [{"name": f"{length}_springs", "energy": answer["energy"]}]
    assert effect(answer, f"{length}_springs")["ran"] is True


def test_a_spring_of_zero_energy_has_its_rest_length(api: Api, grid_mesh: str) -> None:
    request = {"mesh": grid_mesh, "points": at_vertices(0, 40), "springs": springs((0, 1), rest_length=0.3, weight=5),
               "fixed_points": [0]}
    answer = api.ok(NETWORKS, request)
    assert answer["stopped"] == "converged"
    assert answer["springs"][0]["length"] == pytest.approx(0.3, abs=1e-9)
    assert answer["energy"] == pytest.approx(0, abs=1e-15)


def test_lengths_energies_and_paths_are_those_of_the_geodesics_between_the_points(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": {"kind": "poisson_disk", "radius": 0.5},
               "springs": {"kind": "voronoi_dual", "rest_length": 0.2, "weight": 3}, "fixed_points": [0, 1, 2], "paths": True,
               "max_iterations": 3}
    answer = api.ok(NETWORKS, request)
    pairs = [{"from": answer["points"][i], "to": answer["points"][j]}
             for i, j in (spring["between"] for spring in answer["springs"])]
    distances = [result["distance"] for result in api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": pairs})["results"]]
    lengths = [spring["length"] for spring in answer["springs"]]
    np.testing.assert_allclose(lengths, distances, rtol=1e-9)
    energies = [spring["energy"] for spring in answer["springs"]]
    np.testing.assert_allclose(energies, 3 * (np.array(distances) - 0.2) ** 2, rtol=1e-7, atol=1e-15)
    assert answer["energy"] == pytest.approx(sum(energies), rel=1e-9)
    for spring in answer["springs"]:
        path = np.array([point["position"] for point in spring["path"]])
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).sum() == pytest.approx(spring["length"], rel=1e-9)
        for end, place in zip(spring["between"], (path[0], path[-1])):
            np.testing.assert_allclose(answer["positions"][end], place, atol=1e-9)


def test_newton_converges_to_the_tolerance_and_its_energy_never_rises(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": CENTRES, "springs": {"kind": "adjacent_faces", "weight": 2},
               "fixed_points": list(range(0, 1280, 40)), "accuracy": {"tolerance": 1e-8}}
    answer = api.ok(NETWORKS, request)
    assert answer["stopped"] == "converged", answer["history"]
    accuracy = answer["accuracy"]
    assert accuracy["gradient_tolerance"] == pytest.approx(1e-8 * 2 * 12**0.5, rel=0.01), "the diagonal is that of a sphere"
    assert answer["gradient_norm"] == accuracy["gradient_norm"] <= accuracy["gradient_tolerance"]
    energies = [step["energy"] for step in answer["history"]]
    assert all(later <= earlier * (1 + 1e-12) for earlier, later in zip(energies, energies[1:]))
    assert len(energies) == answer["iterations"] + 1 and energies[-1] == pytest.approx(answer["energy"])


def test_kept_strips_never_change_the_answer(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": {"kind": "poisson_disk", "radius": 0.6}, "springs": {"kind": "voronoi_dual"},
               "fixed_points": [0, 5, 9]}
    answers = []
    for switch in ("on", "off"):
        answer = api.ok(NETWORKS, {**request, "effects": {"kept_strips": switch, "mollifier": "off"}})
        assert effect(answer, "kept_strips")["ran"] is (switch == "on") and effect(answer, "kept_strips")["why"]
        assert answer["mollified"] is False and effect(answer, "mollifier")["ran"] is False
        answers.append(answer)
    np.testing.assert_allclose(answers[0]["positions"], answers[1]["positions"], atol=1e-6)


def test_a_mollified_energy_says_so(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": at_vertices(0, 5, 77), "springs": springs((0, 1), (1, 2)), "fixed_points": [0, 2],
               "effects": {"mollifier": "on"}, "accuracy": {"mollifier_length": 1e-3}}
    answer = api.ok(NETWORKS, request)
    assert answer["mollified"] is True and effect(answer, "mollifier")["ran"] is True
    assert answer["accuracy"]["mollifier_length"] == 1e-3


def test_points_that_nothing_holds_stay_and_are_named(api: Api, grid_mesh: str) -> None:
    request = {"mesh": grid_mesh, "points": at_vertices(0, 80, 40, 22), "springs": springs((0, 1)), "fixed_points": [0, 1]}
    answer = api.ok(NETWORKS, request)
    assert answer["loose_points"] == [2, 3] and len(answer["warnings"]) == 1
    np.testing.assert_allclose(answer["positions"], flat_grid(8)[0][[0, 80, 40, 22]], atol=1e-15)


def test_a_spring_under_compression_is_marked(api: Api, grid_mesh: str) -> None:
    request = {"mesh": grid_mesh, "points": at_vertices(0, 8), "springs": springs((0, 1), rest_length=2),
               "fixed_points": [0, 1]}
    (spring,) = api.ok(NETWORKS, request)["springs"]
    assert spring["compressed"] is True and spring["energy"] == pytest.approx(1)


def test_the_iteration_limit_is_kept_and_reported(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": at_vertices(5, 77, 130), "springs": springs((0, 1), (1, 2)),
               "fixed_points": [0, 2], "method": "gradient_descent", "max_iterations": 1, "accuracy": {"tolerance": 1e-12}}
    answer = api.ok(NETWORKS, request)
    assert (answer["stopped"], answer["iterations"], len(answer["history"])) == ("iteration_limit", 1, 2)


# --- builders ------------------------------------------------------------------------------------------------------------


def test_one_point_in_each_face_and_springs_across_edges_are_the_dual_graph(api: Api, grid_mesh: str) -> None:
    request = {"mesh": grid_mesh, "points": CENTRES, "springs": {"kind": "adjacent_faces"}, "max_iterations": 1}
    answer = api.ok(NETWORKS, request)
    vertices, faces = flat_grid(8)
    edges: Dict[Any, List[int]] = {}
    for number, face in enumerate(faces):
        for k in range(3):
            edges.setdefault(frozenset((int(face[k]), int(face[(k + 1) % 3]))), []).append(number)
    expected = sorted(sorted(pair) for pair in edges.values() if len(pair) == 2)
    assert sorted(spring["between"] for spring in answer["springs"]) == expected
    assert "triangles" not in answer
    stages = {stage["name"] for stage in answer["cost"]["stages"]}
    assert {"points", "springs"} <= stages, "builders are on the bill"


def test_random_points_keep_their_distance_and_are_those_of_their_seed(api: Api, sphere_mesh: str) -> None:
    def made(seed: int) -> Any:
        disks = {"kind": "poisson_disk", "radius": 0.7, "seed": seed}
        return api.ok(NETWORKS, {"mesh": sphere_mesh, "points": disks, "springs": []})["points"]

    points = made(3)
    pairs = [{"from": a, "to": b} for i, a in enumerate(points) for b in points[:i]]
    distances = [result["distance"] for result in api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": pairs})["results"]]
    assert min(distances) >= 0.7 * (1 - 1e-12)
    assert points == made(3) and points != made(4)


def test_the_dual_of_voronoi_cells_triangulates_a_sphere(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": {"kind": "poisson_disk", "radius": 0.4}, "springs": {"kind": "voronoi_dual"},
               "max_iterations": 1}
    answer = api.ok(NETWORKS, request)
    corners = {corner for triangle in answer["triangles"] for corner in triangle}
    assert corners == set(range(len(answer["points"])))
    assert len(answer["points"]) - len(answer["springs"]) + len(answer["triangles"]) == 2


# --- faults --------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("change, status, code, where", [
    ({"points": at_vertices(0, 9999)}, 422, "point.vertex_out_of_range", ["/points/1"]),
    ({"points": [{"face": 0, "barycentric": [0.5, 0.5, 0.5]}]}, 422, "point.outside_face", ["/points/0"]),
    ({"points": []}, 400, "request.invalid", ["/points"]),
    ({"points": {"kind": "everywhere"}}, 400, "request.invalid", ["/points/kind"]),
    ({"points": {"kind": "per_face", "barycentric": [1, 1, 1]}}, 422, "point.outside_face", ["/points/barycentric"]),
    ({"points": {"kind": "poisson_disk", "radius": 0}}, 400, "request.invalid", ["/points/radius"]),
    ({"points": {"kind": "poisson_disk", "radius": 1e-9}}, 422, "network.radius", ["/points/radius"]),
    ({"springs": springs((0, 1), (1, 2))}, 422, "network.spring", ["/springs/1/between/1"]),
    ({"springs": springs((1, 1))}, 422, "network.spring", ["/springs/0/between"]),
    ({"springs": springs((0, -1))}, 400, "request.invalid", ["/springs/0/between/1"]),
    ({"springs": springs((0, 1), weight=-1)}, 400, "request.invalid", ["/springs/0/weight"]),
    ({"springs": springs((0, 1), rest_length=-0.1)}, 400, "request.invalid", ["/springs/0/rest_length"]),
    ({"springs": {"kind": "adjacent_faces", "weight": -1}}, 400, "request.invalid", ["/springs/weight"]),
    ({"springs": {"kind": "all_pairs"}}, 400, "request.invalid", ["/springs/kind"]),
    ({"fixed_points": [0, 2]}, 422, "network.fixed_point", ["/fixed_points/1"]),
    ({"fixed_points": [0.5]}, 400, "request.invalid", ["/fixed_points/0"]),
    ({"host": {"kind": "elastic"}}, 400, "request.invalid", ["/host/kind"]),
    ({"method": "magic"}, 400, "request.invalid", ["/method"]),
    ({"spring_length": "longest"}, 400, "request.invalid", ["/spring_length"]),
    ({"accuracy": {"tolerance": 0}}, 400, "request.invalid", ["/accuracy/tolerance"]),
    ({"accuracy": {"mollifier_length": 0.6}}, 400, "request.invalid", ["/accuracy/mollifier_length"]),
    ({"max_iterations": 0}, 400, "request.invalid", ["/max_iterations"]),
    ({"effects": {"kept_fields": "on"}}, 400, "request.invalid", ["/effects/kept_fields"]),
    ({"mesh": "0" * 64}, 404, "mesh.not_found", ["/mesh"]),
])
def test_what_is_wrong_is_named_with_its_place(api: Api, grid_mesh: str, change: Any, status: int, code: str,
                                               where: List[str]) -> None:
    request = {"mesh": grid_mesh, "points": at_vertices(0, 80), "springs": springs((0, 1)), **change}
    response = api.post(NETWORKS, request, faulty=True)
    assert (response.status_code, problem_code(response)) == (status, code), response.text
    assert pointers(response) == where


@pytest.mark.parametrize("number", ["1e999", "NaN", "-Infinity"])
def test_numbers_that_are_not_finite_are_no_json(api: Api, grid_mesh: str, number: str) -> None:
    body = (f'{{"mesh": "{grid_mesh}", "points": [{{"vertex": 0}}, {{"vertex": 1}}], '
            f'"springs": [{{"between": [0, 1], "weight": {number}}}]}}')
    response = api.call("POST", NETWORKS, body=body.encode(), headers={"Content-Type": "application/json"}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.malformed_json")


def test_numbers_whose_energy_would_overflow_are_refused_by_field(api: Api, grid_mesh: str) -> None:
    request = {"mesh": grid_mesh, "points": at_vertices(0, 80)}
    largest = api.post(NETWORKS, {**request, "springs": springs((0, 1), rest_length=1e100, weight=1e30)})
    assert largest.status_code == 200 and math.isfinite(largest.json()["energy"]), largest.text
    beyond = api.post(NETWORKS, {**request, "springs": springs((0, 1), rest_length=1e101, weight=1e31)}, faulty=True)
    assert (beyond.status_code, problem_code(beyond)) == (400, "request.invalid")
    assert pointers(beyond) == ["/springs/0/rest_length", "/springs/0/weight"]


def test_a_spring_between_components_is_named(api: Api) -> None:
    mesh = api.upload(*two_triangles_apart())
    response = api.post(NETWORKS, {"mesh": mesh, "points": at_vertices(0, 1, 4), "springs": springs((0, 1), (1, 2))})
    assert (response.status_code, problem_code(response)) == (422, "network.unreachable")
    assert pointers(response) == ["/springs/1/between"]


def test_limits_of_points_and_springs_are_named_with_their_settings(
        new_server: Callable[..., ServerProcess], contract: Contract) -> None:
    api = Api(new_server("--max-points", "100", "--max-springs", "3"), contract)
    mesh = api.upload(*flat_grid(8))
    pair = {"mesh": mesh, "points": at_vertices(0, 80), "springs": springs((0, 1))}
    assert api.post(NETWORKS, {**pair, "springs": springs(*[(0, 1)] * 3)}).status_code == 200
    for change, field, setting, limit, value in [
        ({"points": at_vertices(*[0] * 101)}, "/points", "--max-points", 100, 101),
        ({"points": CENTRES}, "/points", "--max-points", 100, 128),
        ({"fixed_points": [0] * 101}, "/fixed_points", "--max-points", 100, 101),
        ({"springs": springs(*[(0, 1)] * 4)}, "/springs", "--max-springs", 3, 4),
        ({"points": [{"face": f, "barycentric": [0.3, 0.3, 0.4]} for f in (0, 64)] * 5, "springs": {"kind": "adjacent_faces"}},
         "/springs", "--max-springs", 3, 25),
    ]:
        response = api.post(NETWORKS, {**pair, **change})
        assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded"), response.text
        problem = response.json()
        assert pointers(response) == [field]
        assert (problem["setting"], problem["limit"], problem["value"]) == (setting, limit, value)


def test_more_springs_than_anyone_draws_are_refused_before_they_are_read_as_springs(api: Api, grid_mesh: str) -> None:
    spring = b'{"between":[0,1]}'
    body = (f'{{"mesh":"{grid_mesh}","points":[{{"vertex":0}},{{"vertex":1}}],"springs":['.encode()
            + b",".join([spring] * 300_001) + b"]}")
    response = api.call("POST", NETWORKS, body=body, headers={"Content-Type": "application/json"}, faulty=True)
    assert problem_code(response) == "request.limit_exceeded" and pointers(response) == ["/springs"]
    assert (response.json()["limit"], response.json()["setting"]) == (300_000, "--max-springs")


# --- files ---------------------------------------------------------------------------------------------------------------


def test_an_obj_has_a_polyline_along_each_path(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "points": at_vertices(0, 5, 77), "springs": springs((0, 1), (1, 2)), "fixed_points": [0, 2]}
    response = api.post(NETWORKS, request, headers={"Accept": "model/obj"})
    assert response.status_code == 200 and response.headers["Content-Type"] == "model/obj"
    assert response.headers["Supple-Stopped"] == "converged" and float(response.headers["Supple-Seconds"]) > 0
    lines = response.text.splitlines()
    points = np.array([[float(x) for x in line.split()[1:]] for line in lines if line.startswith("v ")])
    polylines = [[int(i) - 1 for i in line.split()[1:]] for line in lines if line.startswith("l ")]
    paths = [[p["position"] for p in s["path"]] for s in api.ok(NETWORKS, {**request, "paths": True})["springs"]]
    assert len(polylines) == 2
    for polyline, path in zip(polylines, paths):
        np.testing.assert_allclose(points[polyline], path, atol=1e-12)


def test_a_vtu_is_xml_whose_arrays_have_an_entry_for_each_spring(api: Api, grid_mesh: str) -> None:
    response = api.post(NETWORKS, two_free_points(grid_mesh), headers={"Accept": "application/x-vtu+xml"})
    assert response.headers["Content-Type"] == "application/x-vtu+xml"
    piece = ElementTree.fromstring(response.content).find(".//Piece")
    assert piece is not None and piece.attrib["NumberOfCells"] == "5"
    arrays = {a.attrib["Name"]: np.array((a.text or "").split(), float) for a in piece.iter("DataArray")}
    assert arrays["offsets"][-1] == len(arrays["connectivity"]) == int(piece.attrib["NumberOfPoints"])
    assert arrays["Points"].size == 3 * len(arrays["connectivity"]) and set(arrays["types"]) == {4}
    answer = api.ok(NETWORKS, two_free_points(grid_mesh))
    np.testing.assert_allclose(arrays["length"], [spring["length"] for spring in answer["springs"]], atol=1e-9)
    np.testing.assert_allclose(arrays["weight"], [2, 1, 1, 1, 0.5])


def test_an_svg_shows_how_energy_and_gradient_fell(api: Api, grid_mesh: str) -> None:
    request = two_free_points(grid_mesh, method="gradient_descent", max_iterations=20)
    response = api.post(NETWORKS, request, headers={"Accept": "image/svg+xml"})
    assert response.headers["Content-Type"] == "image/svg+xml"
    marks = list(ElementTree.fromstring(response.content).iter("{http://www.w3.org/2000/svg}circle"))
    assert len(marks) == 2 * len(api.ok(NETWORKS, request)["history"])


def test_a_form_that_there_is_not_is_refused(api: Api, grid_mesh: str) -> None:
    response = api.post(NETWORKS, two_free_points(grid_mesh), headers={"Accept": "model/stl"})
    assert (response.status_code, problem_code(response)) == (406, "http.not_acceptable")


def test_a_job_keeps_the_form_that_was_asked_for(api: Api, grid_mesh: str) -> None:
    headers = {"Prefer": "respond-async", "Accept": "model/obj"}
    job = api.post(NETWORKS, two_free_points(grid_mesh), headers=headers).json()["id"]
    assert api.wait_for_job(job)["kind"] == "embedded-systems"
    result = api.get(f"/v1/jobs/{job}/result")
    assert result.headers["Content-Type"] == "model/obj" and result.text.count("\nl ") == 5


# --- jobs ----------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def slow_network(server: ServerProcess, contract: Contract) -> Dict[str, Any]:
    """Gradient descent for 1280 points, which takes minutes."""
    mesh = Api(server, contract).upload(*bumpy_sphere(3))
    return {"mesh": mesh, "points": CENTRES, "springs": {"kind": "adjacent_faces", "rest_length": 0.01},
            "fixed_points": [0, 400, 900], "method": "gradient_descent", "max_iterations": 100_000,
            "accuracy": {"tolerance": 1e-14}}


def test_events_carry_the_network_on_its_way(api: Api, slow_network: Dict[str, Any]) -> None:
    job = start_job(api, NETWORKS, slow_network)
    partial: List[Dict[str, Any]] = []
    for _, document in events(api, job):
        if "partial" not in document:
            continue
        partial.append(document["partial"])
        if len(partial) == 5:
            assert api.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
    assert len(partial) >= 5
    assert {len(state["positions"]) for state in partial} == {1280}
    iterations = [state["iteration"] for state in partial]
    assert iterations == sorted(iterations) and iterations[-1] > iterations[0]
    energies = [state["energy"] for state in partial]
    assert all(later <= earlier for earlier, later in zip(energies, energies[1:])) and energies[-1] < energies[0]
    assert partial[0]["positions"] != partial[-1]["positions"]


def test_a_large_network_sends_no_positions_on_its_way(api: Api) -> None:
    mesh = api.upload(*sphere(4))
    job = start_job(api, NETWORKS, {"mesh": mesh, "points": CENTRES, "springs": {"kind": "adjacent_faces"},
                                    "method": "gradient_descent"})
    for _, document in events(api, job):
        if "partial" in document:
            assert set(document["partial"]) == {"iteration", "energy", "gradient_norm"}
            break
    else:
        pytest.fail("no event had an intermediate state")
    api.delete(f"/v1/jobs/{job}")


def test_delete_ends_a_relaxation_within_a_moment(api: Api, slow_network: Dict[str, Any]) -> None:
    job = start_job(api, NETWORKS, slow_network)
    api.wait_for_job(job, ("running",))
    work = WorkingTime(api.server.pid)
    comes_true(lambda: work.seconds() > 0.2, "the relaxation computes")
    assert api.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
    ends_within(api.server.pid, api.busy, 2, "the computation goes on")


@pytest.mark.parametrize("builders", [
    {"points": {"kind": "poisson_disk", "radius": 0.016}, "springs": []},
    {"points": {"kind": "poisson_disk", "radius": 0.05}, "springs": {"kind": "voronoi_dual"}},
])
def test_a_deadline_ends_builders_and_relaxations(api: Api, slow_network: Dict[str, Any], builders: Dict[str, Any]) -> None:
    work = WorkingTime(api.server.pid)
    response = api.post(NETWORKS, {**slow_network, "fixed_points": [], **builders, "deadline": 0.3})
    work.check(3, "the computation goes on")
    if response.status_code == 200 and builders["springs"]:  # the network was built in time
        assert response.json()["stopped"] == "deadline"
    else:
        assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded"), response.text[:300]


def test_a_deadline_gives_the_best_state_until_then(api: Api, slow_network: Dict[str, Any]) -> None:
    late = {**slow_network, "deadline": 2 * SLOWNESS}
    answer = api.ok(NETWORKS, late)
    assert answer["stopped"] == "deadline"
    energies = [state["energy"] for state in answer["history"]]
    assert answer["energy"] == energies[-1] < energies[0] and answer["iterations"] == len(energies) - 1
    assert sum(term["energy"] for term in answer["terms"]) == pytest.approx(answer["energy"], rel=1e-9)
    assert any(f"The deadline passed after {answer['iterations']} iteration" in warning for warning in answer["warnings"])
    # The builder would join other points, now that they lie elsewhere.
    springs = [{"between": spring["between"], "rest_length": 0.01} for spring in answer["springs"]]
    going_on = api.ok(NETWORKS, {**slow_network, "points": answer["points"], "springs": springs, "max_iterations": 1})
    assert going_on["history"][0]["energy"] == pytest.approx(answer["energy"], rel=1e-9)
    job = start_job(api, NETWORKS, late)
    assert api.wait_for_job(job)["state"] == "successful"
    file = api.post(NETWORKS, late, headers={"Accept": "model/obj"})
    assert (file.status_code, file.headers["Supple-Stopped"]) == (200, "deadline")
