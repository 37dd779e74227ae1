"""Parts over HTTP: coupons, outlines and regions as files for printers and lasers."""

from __future__ import annotations

import io
import json
import re
import struct
import xml.etree.ElementTree as ElementTree
import zipfile
from collections import Counter
from typing import Any, Dict, List, Tuple

import numpy as np
import pytest

from harness import ROOT, Api, pointers, problem_code

PARTS = "/v1/parts"
IH21 = {"family": "IH21"}
COUPON = {"outline": {"coupon": {"width": 12, "length": 30, "grip_length": 8}}, "structure": IH21, "thickness": 2}
CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


def stl_triangles(content: bytes) -> Any:
    (count,) = struct.unpack_from("<I", content, 80)
    assert len(content) == 84 + 50 * count
    record = np.dtype([("normal", "<3f4"), ("corners", "<3,3f4"), ("attribute", "<u2")])
    return np.frombuffer(content, record, count, 84)["corners"]


def assert_watertight(corners: Any) -> float:
    """Checks that each edge belongs to two triangles, in opposite directions, and returns the volume."""
    points, triangles = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    edges = Counter((int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3))
    assert all(uses == 1 and edges[(b, a)] == 1 for (a, b), uses in edges.items())
    a, b, c = (points[triangles[:, k]].astype(float) for k in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def size_of(corners: Any) -> Tuple[float, ...]:
    flat = corners.reshape(-1, 3)
    return tuple((flat.max(axis=0) - flat.min(axis=0)).tolist())


def test_a_coupon_is_watertight_and_of_the_size_asked_for(api: Api) -> None:
    described = api.ok(PARTS, {**COUPON, "material": {"density": 1.1}})
    assert described["size"] == pytest.approx([12, 46, 2])
    assert described["checks"]["pieces"] == 1 and described["checks"]["smallest_wall"] == pytest.approx(0.2)
    assert described["outline_area"] == pytest.approx(12 * 46)
    assert described["mass"] == pytest.approx(described["volume"] * 1.1e-3)
    assert described["volume"] == pytest.approx(2 * described["solid_area"])
    response = api.post(PARTS, COUPON, headers={"Accept": "model/stl"})
    assert response.headers["Content-Disposition"] == 'attachment; filename="supple-IH21-12x46x2mm.stl"'
    assert response.content.startswith(b"Supple part, 12 x 46 x 2 mm")
    corners = stl_triangles(response.content)
    assert assert_watertight(corners) == pytest.approx(described["volume"], rel=1e-4)
    assert size_of(corners) == pytest.approx((12, 46, 2), abs=1e-5)


def test_a_3mf_package_holds_the_same_solid(api: Api) -> None:
    content = api.post(PARTS, COUPON, headers={"Accept": "model/3mf"}).content
    assert content == api.post(PARTS, COUPON, headers={"Accept": "model/3mf"}).content, "equal requests have equal files"
    package = zipfile.ZipFile(io.BytesIO(content))
    assert package.testzip() is None
    assert set(package.namelist()) == {"[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"}
    model = ElementTree.fromstring(package.read("3D/3dmodel.model"))
    assert model.get("unit") == "millimeter"
    points = np.asarray([[float(v.get(k)) for k in "xyz"] for v in model.iter(f"{CORE}vertex")])
    triangles = np.asarray([[int(t.get(k)) for k in ("v1", "v2", "v3")] for t in model.iter(f"{CORE}triangle")])
    edges = Counter((int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3))
    assert all(uses == 1 and edges[(b, a)] == 1 for (a, b), uses in edges.items()), "watertight by its indices"
    stl = api.post(PARTS, COUPON, headers={"Accept": "model/stl"}).content
    assert assert_watertight(points[triangles]) == pytest.approx(assert_watertight(stl_triangles(stl)), rel=1e-5)


def objects_of_3mf(content: bytes) -> Tuple[Dict[str, Any], List[str]]:
    """The corners of the triangles of each object that has a mesh, by its name, and the names of those that the one item of the build consists of. The file is read
    by the standard library alone."""
    model = ElementTree.fromstring(zipfile.ZipFile(io.BytesIO(content)).read("3D/3dmodel.model"))
    meshes, names, components = {}, {}, {}
    for element in model.iter(f"{CORE}object"):
        number, name = element.get("id"), str(element.get("name"))
        names[number] = name
        components[number] = [component.get("objectid") for component in element.iter(f"{CORE}component")]
        if element.find(f"{CORE}mesh") is None:
            continue
        points = np.asarray([[float(v.get(k)) for k in "xyz"] for v in element.iter(f"{CORE}vertex")])
        triangles = np.asarray([[int(t.get(k)) for k in ("v1", "v2", "v3")] for t in element.iter(f"{CORE}triangle")])
        edges = Counter((int(t[k]), int(t[(k + 1) % 3])) for t in triangles for k in range(3))
        assert all(uses == 1 and edges[(b, a)] == 1 for (a, b), uses in edges.items()), f"{name} is closed by its indices"
        meshes[name] = points[triangles]
    (item,) = model.iter(f"{CORE}item")
    return meshes, [names[number] for number in components[item.get("objectid")] or [item.get("objectid")]]


FIELDS = [{"name": "heel", "outline": [[0, 0], [20, 0], [20, 15], [0, 15]], "structure": {"family": "IH29"}, "beam_width": 0.5},
          {"name": "arch & <ball>", "outline": [[20, 0], [40, 0], [40, 15], [20, 15]], "structure": IH21, "beam_width": 0.4},
          {"outline": [[40, 2], [55, 2], [55, 13], [40, 13]], "structure": {"family": "IH50"}, "beam_width": 0.4}]


def test_a_3mf_package_has_an_object_for_each_region(api: Api) -> None:
    request = {"outline": {"polygons": [[[-2, -2], [57, -2], [57, 17], [-2, 17]]]}, "structure": {"family": "IH22"}, "beam_width": 0.4, "frame": 1.5, "thickness": 3,
               "regions": FIELDS}
    content = api.post(PARTS, request, headers={"Accept": "model/3mf"}).content
    meshes, components = objects_of_3mf(content)
    assert components == list(meshes) == ["heel", "arch & <ball>", "Region 3", "Rest"]
    volumes = {name: assert_watertight(corners) for name, corners in meshes.items()}
    whole = assert_watertight(stl_triangles(api.post(PARTS, request, headers={"Accept": "model/stl"}).content))
    assert sum(volumes.values()) == pytest.approx(whole, rel=2e-3) and min(volumes.values()) > 0.02 * whole
    for region, name in zip(FIELDS, volumes):
        low, high = np.min(region["outline"], axis=0), np.max(region["outline"], axis=0)
        flat = meshes[name].reshape(-1, 3)[:, :2]
        assert (flat.min(axis=0) >= low - 1e-3).all() and (flat.max(axis=0) <= high + 1e-3).all(), f"{name} lies within its outline"
    alone, item = objects_of_3mf(api.post(PARTS, COUPON, headers={"Accept": "model/3mf"}).content)
    assert list(alone) == item == ["Supple part, 12 x 46 x 2 mm"], "a part without regions is one object"


def test_regions_that_touch_need_no_curve_around_them(api: Api) -> None:
    request = {"outline": {"regions": True}, "structure": IH21, "frame": 1, "regions": FIELDS}
    answer = api.ok(PARTS, request)
    assert answer["outline_area"] == pytest.approx(2 * 20 * 15 + 15 * 11, rel=1e-4) and answer["checks"]["pieces"] == 1
    assert answer["size"][:2] == pytest.approx([55, 15], abs=1e-3)
    assert answer["checks"]["smallest_wall"] == pytest.approx(0.4 * 2 / 3), "the structure of the rest, which fills nothing, does not count"
    meshes, _ = objects_of_3mf(api.post(PARTS, request, headers={"Accept": "model/3mf"}).content)
    assert list(meshes) == ["heel", "arch & <ball>", "Region 3"]
    # Two drawings of one border differ by the tolerance of their chords; a gap as wide is closed.
    gap = [FIELDS[0], {**FIELDS[1], "outline": [[20.05, 0], [40, 0], [40, 15], [20.04, 15]]}, FIELDS[2]]
    closed = api.ok(PARTS, {**request, "regions": gap})
    assert closed["outline_area"] == pytest.approx(answer["outline_area"], rel=1e-4) and closed["checks"]["pieces"] == 1


def test_regions_that_are_several_pieces_are_named(api: Api) -> None:
    apart = [{**FIELDS[0], "outline": [[-30, 0], [-10, 0], [-10, 15], [-30, 15]]}, *FIELDS[1:]]
    answer = api.post(PARTS, {"outline": {"regions": True}, "structure": IH21, "regions": apart})
    assert answer.status_code == 422 and pointers(answer) == ["/regions/0/outline"], answer.text
    assert "2 pieces instead of one" in answer.json()["detail"] and "heel" in answer.json()["detail"] and "Region 3" in answer.json()["detail"]


def test_a_step_file_is_a_closed_solid_of_planes(api: Api) -> None:
    response = api.post(PARTS, COUPON, headers={"Accept": "model/step"})
    assert response.headers["Content-Disposition"] == 'attachment; filename="supple-IH21-12x46x2mm.step"'
    step = response.text
    assert step == api.post(PARTS, COUPON, headers={"Accept": "model/step"}).text, "equal requests have equal files"
    entities = dict(re.findall(r"^#(\d+)=(.*);$", step, re.MULTILINE))
    kinds = Counter(entity.split("(")[0] for entity in entities.values())
    faces, edges, vertices = kinds["ADVANCED_FACE"], kinds["EDGE_CURVE"], kinds["VERTEX_POINT"]
    holes = api.ok(PARTS, COUPON)["holes"]
    assert vertices - edges + faces - 2 * holes == 2 * (1 - holes), "Euler and Poincare: top and bottom have the holes as rings"
    uses = Counter((edge, way) for edge, way in re.findall(r"ORIENTED_EDGE\('',\*,\*,#(\d+),\.(T|F)\.\)", step))
    assert len(uses) == 2 * edges and set(uses.values()) == {1}, "every edge once in each direction"
    places = np.asarray([[float(x) for x in entity[20:-2].split(",")] for entity in entities.values() if entity.startswith("CARTESIAN_POINT")])
    assert np.ptp(places, axis=0) == pytest.approx([12, 46, 2])


def test_a_step_file_of_too_many_corners_is_refused(api: Api) -> None:
    request = {"outline": {"rectangle": [600, 500]}, "structure": {"family": "IH22"}}
    answer = api.post(PARTS, request, headers={"Accept": "model/step"})
    assert answer.status_code == 422 and pointers(answer) == ["/beam_width"] and "at most 50000" in answer.text


def test_drawings_are_true_to_scale(api: Api) -> None:
    svg = api.post(PARTS, COUPON, headers={"Accept": "image/svg+xml"}).text
    assert 'width="12mm" height="46mm"' in svg and "<title>Supple part, 12 x 46 x 2 mm</title>" in svg
    assert api.ok(PARTS, {**COUPON, "svg": True})["svg"] == svg
    dxf = api.post(PARTS, COUPON, headers={"Accept": "image/vnd.dxf"}).text
    lines = [line.strip() for line in dxf.splitlines()]
    assert lines[:2] == ["999", "Supple part, 12 x 46 x 2 mm"] and lines.count("LWPOLYLINE") > 10


def test_a_sole_of_three_regions_is_one_piece(api: Api) -> None:
    """The shoe of [Thesis, fig. 4.1]: heel, midfoot and forefoot have different structures, which are joined at closed seams."""
    angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    sole = [[float(40 + 30 * np.cos(a) * (1 + 0.25 * np.sin(a))), float(110 + 105 * np.sin(a))] for a in angle]
    band = lambda y0, y1: [[0, y0], [90, y0], [90, y1], [0, y1]]  # noqa: E731
    request = {"outline": {"polygons": [sole]}, "structure": {"family": "IH50"}, "beam_width": 0.8, "frame": 1.2, "thickness": 8,
               "regions": [{"name": "heel", "outline": band(0, 75), "structure": {"family": "IH29"}, "beam_width": 0.9},
                           {"name": "forefoot", "outline": band(140, 220), "structure": IH21, "beam_width": 0.7, "orientation": 0.4}]}
    answer = api.ok(PARTS, request)
    assert answer["checks"]["pieces"] == 1 and answer["checks"]["crumb_area"] < 0.01 * answer["solid_area"]
    assert answer["size"][1] == pytest.approx(210, abs=0.5) and answer["size"][2] == 8
    corners = stl_triangles(api.post(PARTS, request, headers={"Accept": "model/stl"}).content)
    assert assert_watertight(corners) == pytest.approx(answer["volume"], rel=1e-4)
    ran = {effect["name"]: effect["ran"] for effect in answer["effects"]}
    assert ran["frame"] and ran["seam"] and ran["trimming"]
    bare = api.ok(PARTS, {**request, "seam": 0, "frame": 0, "smallest_wall": 0})
    assert not any(effect["ran"] for effect in bare["effects"])


@pytest.mark.parametrize("outline, ends", [
    ({"coupon": {"width": 10, "length": 60, "grip_length": 8}}, ["lower_grip", "upper_grip"]),
    ({"block": {"width": 10, "height": 60, "plate": 3}}, ["lower_plate", "upper_plate"]),
])
def test_a_part_that_lost_an_end_says_which_and_what_helps(api: Api, outline: Dict[str, Any], ends: List[str]) -> None:
    request = {"outline": outline, "structure": IH21, "beam_width": 0.8}
    whole = api.ok(PARTS, {**request, "beam_width": 0.3})
    assert whole["checks"]["missing_solids"] == [] and whole["message"] == ""
    assert "Supple-Message" not in api.post(PARTS, {**request, "beam_width": 0.3}, headers={"Accept": "model/stl"}).headers
    broken = api.ok(PARTS, request)
    (missing,) = broken["checks"]["missing_solids"]
    assert missing in ends and broken["size"][1] < whole["size"][1] - 2
    near = broken["lower"][1] if missing == ends[0] else whole["upper"][1] - broken["upper"][1]
    assert near > 2, "the end that is named is the one that is gone"
    assert missing.replace("_", " ") in broken["message"] and "a frame" in broken["message"]
    file = api.post(PARTS, request, headers={"Accept": "model/stl"})
    assert file.headers["Supple-Message"] == broken["message"]
    assert api.ok(PARTS, {**request, "frame": 1})["message"] == ""


def test_pieces_that_are_left_out_are_told_where_they_are_many(api: Api) -> None:
    islands = {"polygons": [[[0, 0], [10, 0], [10, 10], [0, 10]], [[20, 0], [30, 0], [30, 9], [20, 9]]]}
    answer = api.ok(PARTS, {"outline": islands, "structure": IH21, "frame": 1})
    assert answer["checks"]["missing_solids"] == [] and answer["checks"]["crumbs"] == 1
    share = answer["checks"]["crumb_area"] / (answer["checks"]["crumb_area"] + answer["solid_area"])
    assert f"{100 * share:.0f} %" in answer["message"]


def test_grips_do_not_hang_by_necks(api: Api) -> None:
    coupon = {"width": 18.9, "length": 23.7, "grip_length": 4}
    request = {"outline": {"coupon": coupon}, "structure": {"family": "IH29", "parameters": [0.732]}, "beam_width": 0.4, "orientation": -1.5}
    answer = api.ok(PARTS, request)
    checks = answer["checks"]
    assert checks["widened_necks"] == 2 and checks["cut_necks"] == 0 and checks["missing_solids"] == []
    assert 0.98 * checks["smallest_wall"] <= checks["smallest_neck"] <= 0.4
    (necks,) = [effect for effect in answer["effects"] if effect["name"] == "necks"]
    assert necks["ran"] and necks["count"] == 2
    assert answer["size"][:2] == pytest.approx([18.9, 31.7]), "what widens them lies within the outline"
    assert_watertight(stl_triangles(api.post(PARTS, request, headers={"Accept": "model/stl"}).content))
    # Without a smallest wall the part has narrow necks, and the answer has their width.
    bare = api.ok(PARTS, {**request, "smallest_wall": 0})["checks"]
    assert bare["widened_necks"] == 0 and 0 < bare["smallest_neck"] < 0.1


def test_whole_tiles_stay_within_the_outline(api: Api) -> None:
    request = {"outline": {"rectangle": [20, 20]}, "structure": IH21}
    clipped, whole = api.ok(PARTS, request), api.ok(PARTS, {**request, "rim": "whole"})
    assert clipped["size"][:2] == pytest.approx([20, 20])
    assert max(whole["size"][:2]) < 20 and whole["solid_area"] < clipped["solid_area"]


@pytest.mark.parametrize("change, place", [
    ({"outline": {"polygons": [[[0, 0], [10, 10], [10, 0], [0, 10]]]}}, "/outline/polygons/0"),
    ({"outline": {"rectangle": [1900, 1900]}}, "/beam_width"),
    ({"smallest_wall": 0.5}, "/smallest_wall"),
    ({"outline": {"rectangle": [1, 1]}, "rim": "whole"}, "/outline"),
    ({"regions": [{"outline": [[0, 0], [1, 0], [2, 0]], "structure": IH21}]}, "/regions/0/outline"),
    ({"structure": {"family": "IH99"}}, "/structure/family"),
    ({"structure": {"family": "IH21", "parameters": [9, 9]}}, "/structure/parameters/0"),
])
def test_what_no_part_has_is_named(api: Api, change: Dict[str, Any], place: str) -> None:
    answer = api.post(PARTS, {**COUPON, **change})
    assert answer.status_code in (404, 422) and place in pointers(answer), answer.text


@pytest.mark.parametrize("change, place", [
    ({"outline": {}}, "/outline"),
    ({"outline": {"rectangle": [1, 1], "coupon": {"width": 1, "length": 1}}}, "/outline"),
    ({"outline": {"rectangle": [0, 1]}}, "/outline/rectangle/0"),
    ({"outline": {"regions": True}}, "/outline/regions"),
    ({"outline": {"regions": False}, "regions": [{"outline": [[0, 0], [9, 0], [0, 9]], "structure": IH21}]}, "/outline/regions"),
    ({"axis": 1}, "/axis"),
    ({"outline": {"polygons": [[[0, 0], [1, 1]]]}}, "/outline/polygons/0"),
    ({"outline": {"block": {"width": 3}}}, "/outline/block/height"),
    ({"beam_width": 0}, "/beam_width"),
    ({"thickness": -1}, "/thickness"),
    ({"rim": "ragged"}, "/rim"),
    ({"material": {"density": 0}}, "/material/density"),
    ({"regions": [{"structure": IH21}]}, "/regions/0/outline"),
    ({"grips": 3}, "/grips"),
])
def test_requests_that_the_schema_forbids_are_refused(api: Api, change: Dict[str, Any], place: str) -> None:
    answer = api.post(PARTS, {**COUPON, **change}, faulty=True)
    assert problem_code(answer) == "request.invalid" and pointers(answer) == [place], answer.text


def test_the_sole_of_the_examples_is_watertight(api: Api) -> None:
    request = json.loads((ROOT / "api" / "examples" / "parts" / "sole.json").read_text())
    answer = api.ok(PARTS, request)
    assert answer["checks"]["pieces"] == 1 and answer["size"][2] == 12
    corners = stl_triangles(api.post(PARTS, request, headers={"Accept": "model/stl"}).content)
    assert assert_watertight(corners) == pytest.approx(answer["volume"], rel=1e-4)
    assert size_of(corners) == pytest.approx(tuple(answer["size"]), abs=1e-4)
