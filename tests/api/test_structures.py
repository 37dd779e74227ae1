"""Structures over HTTP: outlines, meshes, files, and parameters without a structure."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from typing import Any, Dict, List

import numpy as np
import pytest
import requests

from harness import Api, pointers, problem_code
from plane import (dxf_pairs, dxf_polylines, enclosed_volume, perimeter, polygon_area, stl_triangles, svg_polygons,
                   unmatched_edges)

STRUCTURES = "/v1/structures"
FAMILIES = ["IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67", "square"]
SVG = "{http://www.w3.org/2000/svg}"


def file_of(api: Api, request: Dict[str, Any], media_type: str) -> requests.Response:
    response = api.post(STRUCTURES, request, headers={"Accept": media_type})
    assert response.status_code == 200, response.text
    assert response.headers["Content-Type"].startswith(media_type)
    assert float(response.headers["Supple-Seconds"]) >= 0
    return response


@pytest.mark.parametrize("family", FAMILIES)
def test_tiles_fill_the_cell_and_the_holes_are_what_is_not_solid(api: Api, family: str) -> None:
    structure = api.ok(STRUCTURES, {"family": family})
    (ax, ay), (bx, by) = structure["lattice"]
    assert structure["cell_area"] == pytest.approx(abs(ax * by - ay * bx), rel=1e-9)
    tiles = [polygon_area(tile["outline"]) for tile in structure["tiles"]]
    holes = [polygon_area(hole) for tile in structure["tiles"] for hole in tile["holes"]]
    assert min(tiles) > 0 and min(holes) > 0, "corners run counterclockwise"
    assert sum(tiles) == pytest.approx(structure["cell_area"], rel=1e-9)
    assert structure["solid_area"] == pytest.approx(structure["cell_area"] - sum(holes), rel=1e-5)
    assert structure["relative_density"] == pytest.approx(structure["solid_area"] / structure["cell_area"])
    assert 0 < structure["relative_density"] < 1
    assert structure["beam_width"] == pytest.approx(0.3)
    assert "mesh" not in structure and "svg" not in structure


def test_the_mesh_of_a_cell_covers_its_solid_and_refines_with_its_size(api: Api) -> None:
    meshes = []
    for mesh in ({"mesh_size": 0.3, "corner_size": 1}, {"corner_size": 1}, {}):
        structure = api.ok(STRUCTURES, {"family": "IH01", "mesh": mesh})
        meshes.append(structure["mesh"])
        assert structure["mesh"]["relative_density"] == pytest.approx(structure["relative_density"], rel=1e-4)
        assert "meshing" in [stage["name"] for stage in structure["cost"]["stages"]]
    fine, coarse, graded = meshes
    assert graded["mesh_size"] == 0.5 and graded["corner_size"] == 0.1
    assert coarse["nodes"] < graded["nodes"] and coarse["nodes"] < fine["nodes"]
    assert graded["shortest_side"] < coarse["shortest_side"]
    assert all(0.1 < mesh["smallest_angle"] < np.pi / 3 for mesh in meshes)


def test_a_cell_can_be_meshed_by_tiles_or_at_once(api: Api) -> None:
    by_tile, at_once = (api.ok(STRUCTURES, {"family": "IH01", "mesh": {"mesh_region": region}})
                        for region in ("tile", "cell"))
    assert by_tile["mesh"]["nodes"] != at_once["mesh"]["nodes"]
    assert at_once["mesh"]["relative_density"] == pytest.approx(by_tile["mesh"]["relative_density"], rel=1e-4)


def test_equal_requests_have_equal_answers(api: Api) -> None:
    request = {"family": "IH21", "parameters": [0.12, 0.7], "mesh": {"mesh_size": 0.5}, "svg": True}
    first, second = (api.ok(STRUCTURES, request) for _ in range(2))
    del first["cost"], second["cost"]
    assert first == second


def assert_solid_of(structure: Dict[str, Any], cells: int, polygons: List[np.ndarray]) -> None:
    """Checks the polygons of a patch: one outline, in which beams at the rim are complete, and the holes of all its cells."""
    outline, *holes = sorted(polygons, key=lambda polygon: -abs(polygon_area(polygon)))
    assert len(holes) == cells * sum(len(tile["holes"]) for tile in structure["tiles"])
    void = cells * (structure["cell_area"] - structure["solid_area"])
    assert sum(abs(polygon_area(hole)) for hole in holes) == pytest.approx(void, rel=1e-4)
    rim = abs(polygon_area(outline)) - cells * structure["cell_area"]
    assert 0 < rim <= structure["beam_width"] / 2 * perimeter(outline)


@pytest.mark.parametrize("family", FAMILIES)
def test_an_svg_is_true_to_scale_and_has_the_solid_of_all_its_cells(api: Api, family: str) -> None:
    structure = api.ok(STRUCTURES, {"family": family})
    response = file_of(api, {"family": family, "cells": [3, 2]}, "image/svg+xml")
    root = ElementTree.fromstring(response.text)
    assert root.tag == SVG + "svg"
    left, top, width, height = map(float, re.split(r"[ ,]+", root.attrib["viewBox"]))
    assert root.attrib["width"].endswith("mm") and root.attrib["height"].endswith("mm")
    assert float(root.attrib["width"][:-2]) == pytest.approx(width, rel=1e-3), "one unit is one millimetre"
    (path,) = root.iter(SVG + "path")
    assert path.attrib["fill-rule"] == "evenodd"
    polygons = svg_polygons(path.attrib["d"])
    assert_solid_of(structure, 6, polygons)
    corners = np.concatenate(polygons)
    assert (corners >= np.array([left, top]) - 1e-3).all()
    assert (corners <= np.array([left + width, top + height]) + 1e-3).all()


def test_the_json_answer_holds_the_very_svg_on_request(api: Api) -> None:
    request = {"family": "IH22", "cells": [1, 2]}
    inline = api.ok(STRUCTURES, {**request, "svg": True})["svg"]
    assert inline == file_of(api, request, "image/svg+xml").content.decode()


@pytest.mark.parametrize("media_type", ["image/vnd.dxf", "application/dxf"])
def test_a_dxf_has_closed_polylines_of_the_outlines_and_the_holes(api: Api, media_type: str) -> None:
    structure = api.ok(STRUCTURES, {"family": "IH01"})
    text = file_of(api, {"family": "IH01", "cells": [2, 2]}, media_type).content.decode("ascii")
    pairs = list(dxf_pairs(text))
    assert pairs[-1] == (0, "EOF")
    assert (1, "AC1015") in pairs, "AutoCAD R2000"
    polylines = dxf_polylines(text)
    polygons = []
    for polyline in polylines:
        assert polyline["flag"] & 1, "closed"
        assert len(polyline["x"]) == len(polyline["y"]) == polyline["count"] >= 3
        polygons.append(np.column_stack([polyline["x"], polyline["y"]]))
    assert_solid_of(structure, 4, polygons)


@pytest.mark.parametrize("family", ["IH01", "IH28", "square"])
def test_an_stl_is_closed_oriented_and_has_the_volume_of_the_solid(api: Api, family: str) -> None:
    request = {"family": family, "cells": [2, 1], "height": 2.5}
    triangles = stl_triangles(file_of(api, request, "model/stl").content)
    assert unmatched_edges(triangles) == 0
    assert triangles[..., 2].min() == 0 and triangles[..., 2].max() == 2.5
    path = ElementTree.fromstring(file_of(api, request, "image/svg+xml").text).find(f".//{SVG}path")
    assert path is not None
    outline, *holes = sorted((abs(polygon_area(polygon)) for polygon in svg_polygons(path.attrib["d"])), reverse=True)
    assert enclosed_volume(triangles) == pytest.approx(2.5 * (outline - sum(holes)), rel=1e-3)


def test_a_structure_can_be_a_job_in_the_media_type_that_was_asked_for(api: Api) -> None:
    request = {"family": "IH01"}
    headers = {"Prefer": "respond-async", "Accept": "model/stl"}
    job = api.post(STRUCTURES, request, headers=headers).json()
    document = api.wait_for_job(job["id"])
    assert (document["state"], document["kind"]) == ("successful", "structures") and "mesh" not in document
    result = api.get(f"/v1/jobs/{job['id']}/result")
    assert result.headers["Content-Type"] == "model/stl"
    assert result.content == file_of(api, request, "model/stl").content


def test_a_media_type_that_no_structure_has_is_not_acceptable(api: Api) -> None:
    response = api.post(STRUCTURES, {"family": "IH01"}, headers={"Accept": "image/png"})
    assert (response.status_code, problem_code(response)) == (406, "http.not_acceptable")


@pytest.mark.parametrize("fields, pointer", [
    ({"family": ""}, "/family"), ({"family": "../IH01"}, "/family"), ({"parameters": 0.1}, "/parameters"),
    ({"parameters": [0.1, "0.5"]}, "/parameters/1"), ({"cells": [0, 1]}, "/cells"), ({"cells": [1]}, "/cells"),
    ({"cells": [101, 1]}, "/cells"), ({"height": 0}, "/height"), ({"mesh": {"mesh_size": 0}}, "/mesh/mesh_size"),
    ({"mesh": {"mesh_size": 3}}, "/mesh/mesh_size"), ({"mesh": {"corner_size": 1.5}}, "/mesh/corner_size"),
    ({"mesh": {"size": 1}}, "/mesh/size"), ({"mesh": {"mesh_region": "all"}}, "/mesh/mesh_region"),
    ({"svg": "yes"}, "/svg"), ({"deadline": 0}, "/deadline"),
], ids=lambda value: str(value))
def test_a_field_outside_its_range_is_pointed_to(api: Api, fields: Dict[str, Any], pointer: str) -> None:
    response = api.post(STRUCTURES, {"family": "IH01", **fields}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == [pointer]


def test_another_number_of_parameters_is_refused(api: Api) -> None:
    response = api.post(STRUCTURES, {"family": "IH01", "parameters": [0.1, 0.5]})
    assert (response.status_code, problem_code(response)) == (422, "tiling.parameter_count")
    assert pointers(response) == ["/parameters"]


def test_parameters_out_of_bounds_are_pointed_to_with_their_bounds(api: Api) -> None:
    bounds = api.get("/v1/families/IH01").json()["parameters"]
    parameters = [*bounds["default"]]
    parameters[1] = bounds["upper"][1] + 0.1
    parameters[3] = bounds["lower"][3] - 0.1
    response = api.post(STRUCTURES, {"family": "IH01", "parameters": parameters})
    assert (response.status_code, problem_code(response)) == (422, "tiling.parameter_out_of_bounds")
    assert pointers(response) == ["/parameters/1", "/parameters/3"]


def test_a_mesh_of_too_many_nodes_is_refused_with_the_limit(api: Api) -> None:
    response = api.post(STRUCTURES, {"family": "IH50", "mesh": {"mesh_size": 0.01}})
    assert (response.status_code, problem_code(response)) == (422, "tiling.mesh_too_large")
    assert "100000" in response.json()["detail"] and pointers(response) == ["/mesh/mesh_size"]


def test_a_deadline_ends_the_meshing(api: Api) -> None:
    response = api.post(STRUCTURES, {"family": "IH50", "mesh": {"mesh_size": 0.2}, "deadline": 0.001})
    assert (response.status_code, problem_code(response)) == (504, "job.deadline_exceeded")


def link(family: str, **query: Any) -> str:
    return f"/v1/families/{family}/structure" + ("?" + "&".join(f"{k}={v}" for k, v in query.items()) if query else "")


@pytest.mark.parametrize("file_format, media_type",
                         [("svg", "image/svg+xml"), ("dxf", "image/vnd.dxf"), ("stl", "model/stl")])
def test_a_link_gives_the_file_that_a_request_gives(api: Api, file_format: str, media_type: str) -> None:
    response = api.get(link("IH21", parameters="0.12,0.7", cells="3,1", format=file_format, height="2.5"))
    assert response.status_code == 200, response.text
    assert response.headers["Content-Type"] == media_type
    assert "max-age=" in response.headers["Cache-Control"]
    request = {"family": "IH21", "parameters": [0.12, 0.7], "cells": [3, 1], "height": 2.5}
    assert response.content == file_of(api, request, media_type).content


def test_a_link_without_a_query_is_the_picture_of_the_default(api: Api) -> None:
    response = api.get(link("IH01"), headers={"Prefer": "respond-async", "Accept": "image/png"})
    assert (response.status_code, response.headers["Content-Type"]) == (200, "image/svg+xml")
    assert response.content == file_of(api, {"family": "IH01"}, "image/svg+xml").content


@pytest.mark.parametrize("name, text", [
    ("parameters", ""), ("parameters", "0.1,"), ("parameters", "0.1,nan"), ("parameters", "0.1,inf"), ("parameters", "a"),
    ("parameters", "0.1%200.5"), ("parameters", ",".join(["0"] * 33)), ("parameters", "0." + "0" * 1000),
    ("cells", "2"), ("cells", "2,"), ("cells", "0,1"), ("cells", "2,101"), ("cells", "2,2,2"), ("cells", "-1,2"),
    ("cells", "1.5,2"), ("format", "png"), ("format", ""), ("height", "0"), ("height", "1001"), ("height", "nan"),
    ("height", "tall"), ("parameter", "0.1"), ("PARAMETERS", "0.1"),
])
def test_a_bad_query_is_refused_by_the_name_of_its_parameter(api: Api, name: str, text: str) -> None:
    response = api.get(link("IH21", **{name: text}), faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid_parameter")
    assert pointers(response) == [f"query {name}"] and name in response.json()["detail"]
    assert response.headers["Cache-Control"] == "no-cache"


def test_all_bad_parts_of_a_query_are_named_at_once(api: Api) -> None:
    response = api.get(link("IH21", cells="0,0", format="png", hieght="2"), faulty=True)
    assert sorted(pointers(response)) == ["query cells", "query format", "query hieght"]


def test_a_link_to_parameters_out_of_bounds_names_them(api: Api) -> None:
    response = api.get(link("IH21", parameters="0.12,0.95"))
    assert (response.status_code, problem_code(response)) == (422, "tiling.parameter_out_of_bounds")
    assert pointers(response) == ["query parameters/1"]
    response = api.get(link("IH21", parameters="0.12"))
    assert (response.status_code, problem_code(response)) == (422, "tiling.parameter_count")
    assert pointers(response) == ["query parameters"]


def test_a_link_to_an_unknown_family_is_not_found(api: Api) -> None:
    response = api.get(link("IH99", cells="2,2"))
    assert (response.status_code, problem_code(response)) == (404, "tiling.family_not_found")
