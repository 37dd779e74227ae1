"""Geodesic Voronoi diagrams and their optimization over HTTP."""

from __future__ import annotations

import csv
import io
import time
from typing import Any, Callable, Dict, List
from xml.etree import ElementTree

import numpy as np
import pytest

from contract import Contract
from harness import SLOWNESS, Api, ServerProcess, pointers, problem_code
from shapes import bumpy_sphere, exported_ring, flat_grid, sphere, torus, two_triangles_apart
from working_time import WorkingTime
from test_jobs import events, start_job

DIAGRAMS = "/v1/voronoi-diagrams"
OPTIMIZATIONS = "/v1/voronoi-optimizations"
CORNERS = [0, 56, 63, 7]
"""Corner vertices of a grid of 7 x 7 cells, counterclockwise. No border between their Voronoi cells is on an edge of the grid."""


@pytest.fixture
def odd_grid(api: Api) -> str:
    return api.upload(*flat_grid(7))


def at_vertices(*vertices: int) -> List[Dict[str, int]]:
    return [{"vertex": v} for v in vertices]


def four_sites(mesh: str, **more: Any) -> Dict[str, Any]:
    """A request with the corners of the unit square as sites, whose cells are the four squares of half its side."""
    return {"mesh": mesh, "sites": at_vertices(*CORNERS), **more}


def length(positions: Any) -> float:
    return float(np.linalg.norm(np.diff(np.asarray(positions), axis=0), axis=1).sum())


# --- diagrams ------------------------------------------------------------------------------------------------------------


def test_four_sites_divide_a_square_into_four(api: Api, odd_grid: str) -> None:
    answer = api.ok(DIAGRAMS, four_sites(odd_grid))
    assert [cell["area"] for cell in answer["cells"]] == pytest.approx([0.25] * 4, rel=1e-12)
    assert answer["unreached_area"] == 0 and answer["warnings"] == []
    (vertex,) = answer["vertices"]
    np.testing.assert_allclose(vertex["position"], [0.5, 0.5, 0], atol=1e-12)
    np.testing.assert_allclose(answer["positions"][vertex["index"]], vertex["position"])
    assert sorted(vertex["sites"]) == [0, 1, 2, 3] and vertex["distance"] == pytest.approx(np.sqrt(0.5), rel=1e-12)
    # The sites are numbered counterclockwise, seen from above.
    turn = vertex["sites"].index(0)
    assert vertex["sites"][turn:] + vertex["sites"][:turn] == [0, 1, 2, 3]
    assert len(answer["dual"]) == 2 and {site for triangle in answer["dual"] for site in triangle} == {0, 1, 2, 3}
    assert len(answer["edges"]) == 4 and all(edge["length"] == pytest.approx(0.5, rel=1e-12) for edge in answer["edges"])
    for edge in answer["edges"]:
        ends = edge["vertices"]
        assert sorted(ends, key=lambda end: end is None) == [0, None], "from the middle to the rim"
        assert length([answer["positions"][p] for p in edge["points"]]) == pytest.approx(edge["length"], rel=1e-12)
    assert answer["cells"][0]["neighbours"] == [1, 3]
    accuracy = {"method": "exact", "relative_error": 0, "relative_error_bound": 0, "border_deviation": 1e-5}
    assert answer["accuracy"] == accuracy and {stage["name"] for stage in answer["cost"]["stages"]} >= {"propagation", "cells"}
    spread = answer["statistics"]["area"]
    assert (spread["mean"], spread["least"]) == pytest.approx((0.25, 0.25)) and spread["deviation"] == pytest.approx(0, abs=1e-9)


def test_borders_are_polygons_with_their_cells_on_the_left(api: Api, odd_grid: str) -> None:
    answer = api.ok(DIAGRAMS, four_sites(odd_grid))
    for cell in answer["cells"]:
        (border,) = cell["boundary"]
        x, y, _ = np.asarray([answer["positions"][p] for p in border]).T
        assert 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) == pytest.approx(cell["area"], rel=1e-12)


def test_surface_points_pieces_and_statistics_come_where_they_are_asked_for(api: Api, sphere_mesh: str) -> None:
    vertices, faces = sphere(3)
    request = {"mesh": sphere_mesh, "sites": {"count": 20, "seed": 4}}
    plain = api.ok(DIAGRAMS, {**request, "statistics": False})
    assert not plain.keys() & {"points", "pieces", "statistics"}
    full = api.ok(DIAGRAMS, {**request, "points": True, "pieces": True})
    assert full["cells"] == plain["cells"], "the same seed gives the same sites"
    for point, position in zip(full["points"], full["positions"]):
        np.testing.assert_allclose(np.asarray(point["barycentric"]) @ vertices[faces[point["face"]]], position, atol=1e-12)
    pieces = full["pieces"]
    assert len(pieces["vertex_sites"]) == len(vertices) and len(pieces["face_sites"]) == len(faces)
    areas = np.zeros(20)
    for face, site in enumerate(pieces["face_sites"]):
        if site is not None:
            a, b, c = vertices[faces[face]]
            areas[site] += np.linalg.norm(np.cross(b - a, c - a)) / 2
    for piece in pieces["cut_faces"]:
        assert pieces["face_sites"][piece["face"]] is None
        corners = np.asarray(piece["corners"])
        areas[piece["site"]] += sum(np.linalg.norm(np.cross(corners[k] - corners[0], corners[k + 1] - corners[0])) / 2
                                    for k in range(1, len(corners) - 1))
    # Polygonal pieces only approximate the areas of cells with curved borders.
    np.testing.assert_allclose(areas, [cell["area"] for cell in full["cells"]], rtol=0.02)


def polygon_area(corners: Any) -> float:
    """Area of a planar polygon, which may be concave."""
    corners = np.asarray(corners)
    return float(np.linalg.norm(sum(np.cross(corners[k] - corners[0], corners[k + 1] - corners[0])
                                    for k in range(1, len(corners) - 1))) / 2)


def test_a_border_that_bends_in_a_face_is_drawn_where_it_runs(api: Api) -> None:
    """Windows of one site meet within a face, where its border has a corner. Positions, points and pieces contain this corner."""
    vertices = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], dtype=float)
    faces = np.array([(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)])
    sites = [{"face": 0, "barycentric": [0.2, 0.6, 0.2]}, {"face": 3, "barycentric": [0.2, 0.3, 0.5]}]
    answer = api.ok(DIAGRAMS, {"mesh": api.upload(vertices, faces), "sites": sites, "pieces": True, "points": True})
    (edge,) = answer["edges"]
    line = np.asarray([answer["positions"][k] for k in edge["points"]])
    assert edge["length"] == pytest.approx(6.3996209946, abs=1e-9)
    assert np.linalg.norm(np.diff(line, axis=0), axis=1).sum() == pytest.approx(edge["length"], rel=1e-9)
    areas = np.zeros(2)
    for piece in answer["pieces"]["cut_faces"]:
        assert polygon_area(piece["corners"]) == pytest.approx(piece["area"], abs=1e-9)
        areas[piece["site"]] += piece["area"]
    np.testing.assert_allclose(areas, [cell["area"] for cell in answer["cells"]], rtol=1e-9)


def test_curved_borders_are_drawn_as_finely_as_is_asked_for(api: Api) -> None:
    """Beyond saddle vertices borders are arcs of hyperbolas."""
    vertices, faces = bumpy_sphere(2)
    mesh = api.upload(vertices, faces)
    lengths, counts, cells = [], [], []
    for deviation in (1, 1e-3, 1e-5, 1e-7):
        request = {"mesh": mesh, "sites": {"count": 5, "seed": 2}, "pieces": True, "accuracy": {"border_deviation": deviation}}
        answer = api.ok(DIAGRAMS, request)
        assert answer["accuracy"]["border_deviation"] == deviation
        positions = np.asarray(answer["positions"])
        lengths.append(sum(np.linalg.norm(np.diff(positions[edge["points"]], axis=0), axis=1).sum() for edge in answer["edges"]))
        counts.append(len(positions))
        cells.append([cell["area"] for cell in answer["cells"]])
        # Whole faces and pieces cover the cells.
        areas = np.zeros(5)
        for face, site in enumerate(answer["pieces"]["face_sites"]):
            if site is not None:
                areas[site] += polygon_area(vertices[faces[face]])
        diagonal = np.linalg.norm(np.ptp(vertices, axis=0))
        for piece in answer["pieces"]["cut_faces"]:
            areas[piece["site"]] += piece["area"]
            assert abs(polygon_area(piece["corners"]) - piece["area"]) <= deviation * diagonal * sum(
                np.linalg.norm(np.diff(np.asarray(piece["corners"]), axis=0), axis=1))
        np.testing.assert_allclose(areas, cells[-1], rtol=1e-9)
    assert counts[0] <= counts[1] < counts[2] < counts[3]
    assert lengths[0] < lengths[1] < lengths[2] < lengths[3] == pytest.approx(sum(edge["length"] for edge in answer["edges"]), rel=1e-6)
    for areas in cells[:-1]:
        np.testing.assert_allclose(areas, cells[-1], rtol=1e-6)


def test_a_kept_diagram_is_not_taken_for_one_that_is_drawn_finer(api: Api) -> None:
    mesh = api.upload(*bumpy_sphere(2))
    request = {"mesh": mesh, "sites": {"count": 5, "seed": 2}, "keep": True, "statistics": False}
    coarse = api.ok(DIAGRAMS, {**request, "accuracy": {"border_deviation": 1}})
    fine = api.ok(DIAGRAMS, {**request, "accuracy": {"border_deviation": 1e-7}})
    assert len(fine["positions"]) > len(coarse["positions"])


def test_opposite_sites_of_a_symmetric_ring_have_half_of_it_each(api: Api) -> None:
    """Their borders are along edges of the mesh, where the distances are equal up to rounding."""
    vertices, faces = exported_ring()
    answer = api.ok(DIAGRAMS, {"mesh": api.upload(vertices, faces), "sites": at_vertices(0, 16), "pieces": True})
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    face_areas = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
    areas = [cell["area"] for cell in answer["cells"]]
    assert areas == pytest.approx([face_areas.sum() / 2] * 2, rel=1e-9)
    assert [len(cell["boundary"]) for cell in answer["cells"]] == [2, 2], "a piece of a tube ends twice"
    assert len(answer["edges"]) == 2 and answer["vertices"] == [] and answer["warnings"] == []
    pieces = answer["pieces"]
    by_pieces = np.zeros(2)
    for face, site in enumerate(pieces["face_sites"]):
        if site is not None:
            by_pieces[site] += face_areas[face]
    for piece in pieces["cut_faces"]:
        corners = np.asarray(piece["corners"])
        by_pieces[piece["site"]] += sum(np.linalg.norm(np.cross(corners[k] - corners[0], corners[k + 1] - corners[0])) / 2
                                        for k in range(1, len(corners) - 1))
    np.testing.assert_allclose(by_pieces, areas, rtol=1e-8)


def test_vertices_are_equally_far_from_their_sites(api: Api, sphere_mesh: str) -> None:
    answer = api.ok(DIAGRAMS, {"mesh": sphere_mesh, "sites": {"count": 12}})
    assert len(answer["vertices"]) == 20 and len(answer["edges"]) == 30, "V - E + F = 2, three edges at each vertex"
    pairs = [{"from": vertex["point"], "to": answer["sites"][site]} for vertex in answer["vertices"] for site in vertex["sites"]]
    found = [result["distance"] for result in api.ok("/v1/geodesics", {"mesh": sphere_mesh, "pairs": pairs})["results"]]
    expected = [vertex["distance"] for vertex in answer["vertices"] for _ in vertex["sites"]]
    np.testing.assert_allclose(found, expected, rtol=1e-9)


@pytest.mark.parametrize("accuracy, bound", [({"method": "bounded", "relative_error": 0.1}, 0.1),
                                             ({"method": "bounded"}, 0.01), ({"method": "edges"}, None)])
def test_less_exact_distances_give_a_diagram_near_the_exact_one(api: Api, sphere_mesh: str, accuracy: Dict[str, Any],
                                                                bound: Any) -> None:
    request = {"mesh": sphere_mesh, "sites": {"count": 12}}
    exact = api.ok(DIAGRAMS, request)
    answer = api.ok(DIAGRAMS, {**request, "accuracy": accuracy})
    assert answer["accuracy"]["relative_error_bound"] == bound
    assert [cell["area"] for cell in answer["cells"]] == pytest.approx([cell["area"] for cell in exact["cells"]], rel=0.25)
    assert sum(cell["area"] for cell in answer["cells"]) == pytest.approx(sum(cell["area"] for cell in exact["cells"]), rel=1e-9)


def test_components_without_a_site_and_sites_in_one_place_are_told(api: Api) -> None:
    mesh = api.upload(*two_triangles_apart())
    answer = api.ok(DIAGRAMS, {"mesh": mesh, "sites": at_vertices(0, 0), "pieces": True})
    assert answer["unreached_area"] > 0 and len(answer["warnings"]) == 2
    assert answer["cells"][1]["area"] == 0 and answer["cells"][1]["boundary"] == []
    assert answer["cells"][0]["area"] + answer["unreached_area"] == pytest.approx(api.get(f"/v1/meshes/{mesh}").json()["area"])
    assert None in answer["pieces"]["vertex_sites"] and None in answer["pieces"]["face_sites"]


def test_one_site_has_the_whole_component(api: Api, sphere_mesh: str) -> None:
    answer = api.ok(DIAGRAMS, {"mesh": sphere_mesh, "sites": at_vertices(5)})
    (cell,) = answer["cells"]
    assert cell["boundary"] == [] and cell["neighbours"] == [] and answer["edges"] == []
    assert answer["statistics"]["edge_length"] == {"mean": 0, "least": 0, "greatest": 0, "deviation": 0}


def test_a_border_without_vertices_is_closed(api: Api, sphere_mesh: str) -> None:
    answer = api.ok(DIAGRAMS, {"mesh": sphere_mesh, "sites": {"count": 2, "seed": 3}})
    (edge,) = answer["edges"]
    assert edge["vertices"] == [None, None] and edge["points"][0] == edge["points"][-1]
    assert answer["vertices"] == [] and answer["dual"] == []
    assert edge["length"] == pytest.approx(2 * np.pi, rel=0.01), "a great circle"
    for cell in answer["cells"]:
        (border,) = cell["boundary"]
        assert set(border) == set(edge["points"]) and cell["area"] == pytest.approx(2 * np.pi, rel=0.02)


def test_more_sites_than_faces_divide_them(api: Api, grid_mesh: str) -> None:
    answer = api.ok(DIAGRAMS, {"mesh": grid_mesh, "sites": {"count": 2000, "seed": 5}})
    assert sum(cell["area"] for cell in answer["cells"]) == pytest.approx(1, rel=1e-9)
    assert min(cell["area"] for cell in answer["cells"]) > 0
    corners = [answer["site_positions"][site] for triangle in answer["dual"] for site in triangle]
    a, b, c = np.asarray(corners).reshape(-1, 3, 3).transpose(1, 0, 2)
    assert (np.cross(b - a, c - a)[:, 2] > 0).all(), "counterclockwise"


# --- refusals ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("change, where", [
    ({"sites": []}, "/sites"), ({"sites": {"count": 0}}, "/sites/count"), ({"sites": {"seed": 3}}, "/sites/count"),
    ({"accuracy": {"method": "fast"}}, "/accuracy/method"),
    ({"accuracy": {"border_deviation": 1e-8}}, "/accuracy/border_deviation"), ({"accuracy": {"relative_error": 0.1}}, "/accuracy/relative_error"),
    ({"pieces": 1}, "/pieces"), ({"panel_scale": 0}, "/panel_scale"), ({"objectives": {}}, "/objectives"),
])
def test_bad_diagrams_are_pointed_to(api: Api, grid_mesh: str, change: Dict[str, Any], where: str) -> None:
    response = api.post(DIAGRAMS, four_sites(grid_mesh, **change), faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == [where]


@pytest.mark.parametrize("change, where", [
    ({"objectives": {"areas": 1}}, "/objectives/areas"), ({"objectives": {"planarity": -1}}, "/objectives/planarity"),
    ({"method": "newton"}, "/method"), ({"accuracy": {"tolerance": 0}}, "/accuracy/tolerance"),
    ({"target_length": 0}, "/target_length"), ({"fixed_sites": [-1]}, "/fixed_sites/0"), ({"statistics": True}, "/statistics"),
])
def test_bad_optimizations_are_pointed_to(api: Api, grid_mesh: str, change: Dict[str, Any], where: str) -> None:
    request = four_sites(grid_mesh, objectives={"centroidal": 1})
    response = api.post(OPTIMIZATIONS, {**request, **change}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == [where]


def test_sites_that_are_not_on_the_mesh_are_pointed_to(api: Api, grid_mesh: str) -> None:
    for path, more in ((DIAGRAMS, {}), (OPTIMIZATIONS, {"objectives": {"centroidal": 1}})):
        response = api.post(path, four_sites(grid_mesh, **more) | {"sites": [{"vertex": 0}, {"face": 128, "barycentric": [1, 0, 0]}]})
        assert (response.status_code, problem_code(response)) == (422, "point.face_out_of_range")
        assert pointers(response) == ["/sites/1"]
    response = api.post(DIAGRAMS, four_sites("0" * 64))
    assert (response.status_code, problem_code(response)) == (404, "mesh.not_found")


def test_ten_million_sites_are_refused_at_once(api: Api, grid_mesh: str) -> None:
    work = WorkingTime(api.server.pid)
    response = api.post(DIAGRAMS, four_sites(grid_mesh, sites={"count": 10_000_000}), faulty=True)
    work.check(1, "sites are made before they are counted")
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    problem = response.json()
    assert pointers(response) == ["/sites/count"]
    assert (problem["setting"], problem["limit"], problem["value"]) == ("--max-points", 100_000, 10_000_000)


def test_the_limit_of_sites_is_the_setting_of_points(new_server: Callable[..., ServerProcess], contract: Any) -> None:
    api = Api(new_server("--max-points", "3"), contract)
    mesh = api.upload(*flat_grid(7))
    response = api.post(DIAGRAMS, four_sites(mesh))
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == ["/sites"] and response.json()["setting"] == "--max-points"
    assert api.post(DIAGRAMS, four_sites(mesh) | {"sites": at_vertices(0, 7, 56)}).status_code == 200


def test_an_optimization_needs_an_objective_and_fixed_sites_that_exist(api: Api, grid_mesh: str) -> None:
    response = api.post(OPTIMIZATIONS, four_sites(grid_mesh, objectives={"centroidal": 0}))
    assert (response.status_code, problem_code(response)) == (422, "voronoi.no_objective")
    response = api.post(OPTIMIZATIONS, four_sites(grid_mesh, objectives={"centroidal": 1}, fixed_sites=[0, 4]))
    assert (response.status_code, problem_code(response)) == (422, "voronoi.fixed_site")
    assert pointers(response) == ["/fixed_sites/1"]


# --- files ---------------------------------------------------------------------------------------------------------------


def test_a_diagram_is_sent_as_files(api: Api, sphere_mesh: str) -> None:
    request = {"mesh": sphere_mesh, "sites": {"count": 12}}
    obj = api.post(DIAGRAMS, request, headers={"Accept": "model/obj"})
    assert obj.headers["Content-Type"].startswith("model/obj") and float(obj.headers["Supple-Seconds"]) > 0
    assert sum(line.startswith("l ") for line in obj.text.splitlines()) == 30 and "\no cells\n" in obj.text
    vtu = api.post(DIAGRAMS, request, headers={"Accept": "application/x-vtu+xml"})
    assert ElementTree.fromstring(vtu.content).get("type") == "UnstructuredGrid"
    svg = api.post(DIAGRAMS, {**request, "panel_scale": 50}, headers={"Accept": "image/svg+xml"})
    assert ElementTree.fromstring(svg.content).tag.endswith("svg")
    assert svg.content != api.post(DIAGRAMS, request, headers={"Accept": "image/svg+xml"}).content
    table = api.post(DIAGRAMS, request, headers={"Accept": "text/csv"})
    rows = list(csv.DictReader(io.StringIO(table.text)))
    assert len(rows) == 60, "each of 30 edges is a side of two panels"
    assert {row["panel"] for row in rows} == {str(site) for site in range(12)}
    response = api.post(DIAGRAMS, request, headers={"Accept": "model/stl"})
    assert (response.status_code, problem_code(response)) == (406, "http.not_acceptable")


def test_a_kept_diagram_is_made_anew_only_where_a_site_has_moved(api: Api) -> None:
    mesh = api.upload(*sphere(3))
    start = api.ok(DIAGRAMS, {"mesh": mesh, "sites": {"count": 40, "seed": 2}, "keep": True})
    assert "local_rebuilds" not in start["cost"]["quantities"]
    sites = start["sites"]
    sites[7] = {"face": sites[7]["face"], "barycentric": [0.2, 0.3, 0.5]}
    moved = api.ok(DIAGRAMS, {"mesh": mesh, "sites": sites, "keep": True, "statistics": False})
    assert moved["cost"]["quantities"]["local_rebuilds"] == 1
    anew = api.ok(DIAGRAMS, {"mesh": mesh, "sites": sites, "statistics": False})
    assert "local_rebuilds" not in anew["cost"]["quantities"]
    assert [cell["area"] for cell in moved["cells"]] == pytest.approx([cell["area"] for cell in anew["cells"]], abs=1e-12)
    assert [vertex["sites"] for vertex in moved["vertices"]] == [vertex["sites"] for vertex in anew["vertices"]]
    places = [[vertex["position"] for vertex in answer["vertices"]] for answer in (moved, anew)]
    np.testing.assert_allclose(places[0], places[1], atol=1e-12)
    # Other cached diagrams replace it only when there are four.
    for seed in range(3):
        api.ok(DIAGRAMS, {"mesh": mesh, "sites": {"count": 12, "seed": seed}, "keep": True})
    assert api.ok(DIAGRAMS, {"mesh": mesh, "sites": sites, "keep": True})["cost"]["quantities"]["local_rebuilds"] == 1
    for seed in range(4):
        api.ok(DIAGRAMS, {"mesh": mesh, "sites": {"count": 12, "seed": 10 + seed}, "keep": True})
    assert "local_rebuilds" not in api.ok(DIAGRAMS, {"mesh": mesh, "sites": sites, "keep": True})["cost"]["quantities"]


# --- optimization --------------------------------------------------------------------------------------------------------


def optimization(mesh: str, **more: Any) -> Dict[str, Any]:
    return {"mesh": mesh, "sites": {"count": 30, "seed": 2}, "objectives": {"centroidal": 1},
            "accuracy": {"tolerance": 1e-2}, **more}


def test_sites_move_to_the_centres_of_their_cells(api: Api, sphere_mesh: str) -> None:
    answer = api.ok(OPTIMIZATIONS, optimization(sphere_mesh))
    history = answer["history"]
    assert len(history) == answer["iterations"] + 1 and history[0]["step_length"] == 0
    energies = [step["energy"] for step in history]
    assert all(later <= earlier for earlier, later in zip(energies, energies[1:])) and energies[-1] < 0.95 * energies[0]
    assert answer["energy"] == energies[-1] and answer["gradient_norm"] == history[-1]["gradient_norm"]
    assert [term["name"] for term in answer["terms"]] == ["centroidal"]
    if answer["stopped"] == "converged":
        assert answer["gradient_norm"] <= answer["accuracy"]["gradient_tolerance"]
    before, after = answer["statistics"]["before"], answer["statistics"]["after"]
    assert after["area"]["deviation"] < before["area"]["deviation"]
    again = api.ok(DIAGRAMS, {"mesh": sphere_mesh, "sites": answer["sites"]})
    assert [cell["area"] for cell in again["cells"]] == pytest.approx([cell["area"] for cell in answer["cells"]], rel=1e-9)


def test_sites_that_no_common_step_moves_are_moved_one_by_one(api: Api, sphere_mesh: str) -> None:
    answer = api.ok(OPTIMIZATIONS, optimization(api.upload(*torus(24, 12)), sites={"count": 20, "seed": 3}, objectives={"planarity": 1},
                                                accuracy={"tolerance": 1e-6}, max_iterations=160))
    moves = answer["site_moves"]
    assert answer["energy"] < 0.5 * moves["energy_before"] < 0.5 * answer["history"][0]["energy"]
    assert moves["held_searches"] >= 1 and 1 <= moves["taken"] <= moves["tried"] and 0 < moves["last_gain"] < 1
    # If steps of all sites suffice, single sites are not moved, and the answer has no such field.
    assert "site_moves" not in api.ok(OPTIMIZATIONS, optimization(sphere_mesh, objectives={"equal_area": 1}))


def test_fixed_sites_stay_and_every_objective_has_its_term(api: Api, sphere_mesh: str) -> None:
    weights = {"edge_length": 1, "planarity": 2, "regularity": 1, "centroidal": 1, "equal_area": 0.5}
    start = api.ok(DIAGRAMS, {"mesh": sphere_mesh, "sites": {"count": 30, "seed": 2}})
    answer = api.ok(OPTIMIZATIONS, optimization(sphere_mesh, objectives=weights, fixed_sites=[3, 0], max_iterations=4,
                                                points=True, pieces=True, target_length=0.4))
    np.testing.assert_allclose([answer["site_positions"][k] for k in (0, 3)], [start["site_positions"][k] for k in (0, 3)], atol=1e-12)
    assert answer["site_positions"][1] != start["site_positions"][1]
    terms = {term["name"]: term["energy"] for term in answer["terms"]}
    assert terms.keys() == weights.keys() and sum(terms.values()) == pytest.approx(answer["energy"], rel=1e-9)
    assert answer["stopped"] in ("iteration_limit", "converged", "step_too_small") and answer["iterations"] <= 4
    assert "points" in answer and "pieces" in answer
    assert {effect["name"] for effect in answer["effects"]} >= weights.keys()


def test_as_many_iterations_may_be_asked_for_as_the_contract_says(api: Api, sphere_mesh: str) -> None:
    field = Contract().spec["components"]["schemas"]["VoronoiOptimizationRequest"]["properties"]["max_iterations"]
    assert api.ok(OPTIMIZATIONS, optimization(sphere_mesh, max_iterations=field["maximum"]))["iterations"] > 0
    response = api.post(OPTIMIZATIONS, optimization(sphere_mesh, max_iterations=field["maximum"] + 1), faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == ["/max_iterations"]


def test_lbfgs_lowers_the_energy_too(api: Api, sphere_mesh: str) -> None:
    answer = api.ok(OPTIMIZATIONS, optimization(sphere_mesh, method="lbfgs", max_iterations=15))
    assert answer["history"][-1]["energy"] < answer["history"][0]["energy"]


def test_the_diagram_at_the_end_is_sent_as_a_file(api: Api, sphere_mesh: str) -> None:
    request = optimization(sphere_mesh, max_iterations=3)
    response = api.post(OPTIMIZATIONS, request, headers={"Accept": "model/obj"})
    assert response.headers["Supple-Stopped"] == api.ok(OPTIMIZATIONS, request)["stopped"]
    assert sum(line.startswith("l ") for line in response.text.splitlines()) > 50


@pytest.fixture
def slow_optimization(api: Api) -> Dict[str, Any]:
    mesh = api.upload(*bumpy_sphere(3))
    return optimization(mesh, sites={"count": 60}, accuracy={"tolerance": 1e-12}, max_iterations=1000,
                        objectives={"centroidal": 1, "regularity": 1})


def test_events_carry_the_diagram_on_its_way_until_the_job_is_cancelled(api: Api, slow_optimization: Dict[str, Any]) -> None:
    job = start_job(api, OPTIMIZATIONS, slow_optimization)
    partial: List[Dict[str, Any]] = []
    kind = ""
    for _, document in events(api, job):
        kind = document["kind"]
        if "partial" not in document or (partial and document["partial"]["iteration"] == partial[-1]["iteration"]):
            continue
        partial.append(document["partial"])
        if len(partial) == 3:
            assert api.delete(f"/v1/jobs/{job}").json()["state"] == "dismissed"
    assert kind == "voronoi-optimizations" and len(partial) >= 3
    for state in partial:
        assert len(state["site_positions"]) == len(state["sites"]) == 60
        assert len(state["borders"]) > 150 and max(max(border) for border in state["borders"]) < len(state["positions"])
        assert len(state["vertices"]) > 100
    assert partial[0]["iteration"] == 0 and partial[0]["step_length"] == 0
    energies = [state["energy"] for state in partial]
    assert energies == sorted(energies, reverse=True) and energies[-1] < energies[0]
    assert partial[0]["site_positions"] != partial[-1]["site_positions"]
    assert api.get(f"/v1/jobs/{job}/result").status_code == 410


def test_a_deadline_gives_the_best_diagram_until_then(api: Api, slow_optimization: Dict[str, Any]) -> None:
    late = {**slow_optimization, "deadline": 3 * SLOWNESS}
    answer = api.ok(OPTIMIZATIONS, late)
    assert answer["stopped"] == "deadline"
    energies = [state["energy"] for state in answer["history"]]
    assert energies == sorted(energies, reverse=True)
    assert (answer["energy"], answer["iterations"]) == (energies[-1], len(energies) - 1)
    assert sum(term["energy"] for term in answer["terms"]) == pytest.approx(answer["energy"], rel=1e-9)
    assert any(f"The deadline passed after {answer['iterations']} iteration" in warning for warning in answer["warnings"])
    assert answer["statistics"]["after"]["edge_length"]["mean"] > 0 and len(answer["sites"]) == 60
    going_on = api.ok(OPTIMIZATIONS, {**slow_optimization, "sites": answer["sites"], "max_iterations": 1})
    assert going_on["history"][0]["energy"] == pytest.approx(answer["energy"], rel=1e-9)
    job = start_job(api, OPTIMIZATIONS, late)
    assert api.wait_for_job(job)["state"] == "successful"
    assert api.get(f"/v1/jobs/{job}/result").json()["stopped"] == "deadline"
    file = api.post(OPTIMIZATIONS, late, headers={"Accept": "model/obj"})
    assert (file.status_code, file.headers["Supple-Stopped"]) == (200, "deadline")


def test_a_deadline_before_the_first_diagram_is_an_error(api: Api, slow_optimization: Dict[str, Any]) -> None:
    response = api.post(OPTIMIZATIONS, {**slow_optimization, "mesh": api.upload(*bumpy_sphere(6)), "deadline": 0.01})
    assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")


def test_a_finished_job_survives_a_restart_and_an_unfinished_one_begins_again(
        new_server: Callable[..., ServerProcess], contract: Any) -> None:
    process = new_server()
    api = Api(process, contract)
    done = start_job(api, OPTIMIZATIONS, optimization(api.upload(*sphere(2)), max_iterations=2))
    list(events(api, done))
    answer = api.get(f"/v1/jobs/{done}/result").json()
    slow = optimization(api.upload(*bumpy_sphere(5)), sites={"count": 300}, accuracy={"tolerance": 1e-12}, max_iterations=1000)
    running = start_job(api, OPTIMIZATIONS, slow)
    found: Dict[str, Any] = {}
    while found.get("iteration", 0) < 2:
        time.sleep(0.02)
        found = api.get(f"/v1/jobs/{running}").json().get("partial", {})
    process.kill()
    process.start()
    assert api.get(f"/v1/jobs/{done}/result").json() == answer
    assert api.wait_for_job(running, ("running",))["created"] <= api.get(f"/v1/jobs/{running}").json()["started"]
    assert api.delete(f"/v1/jobs/{running}").json()["state"] == "dismissed"
    # A search from the sites of the partial result continues with its energy.
    rest = api.ok(OPTIMIZATIONS, {**slow, "sites": found["sites"], "max_iterations": 1})
    assert rest["history"][0]["energy"] == pytest.approx(found["energy"], rel=1e-12)
    assert rest["energy"] < found["energy"]


def test_borders_that_run_along_edges_of_the_mesh_are_borders_like_others(api: Api, grid_mesh: str) -> None:
    answer = api.ok(DIAGRAMS, {"mesh": grid_mesh, "sites": at_vertices(0, 72, 80, 8)})
    assert [cell["area"] for cell in answer["cells"]] == pytest.approx([0.25] * 4, rel=1e-9)
    assert len(answer["vertices"]) == 1 and len(answer["edges"]) == 4
