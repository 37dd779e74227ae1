"""Drawings over HTTP: SVG and DXF files become outlines, and every client makes parts of them."""

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path
from typing import Any, Dict, List

import numpy as np
import pytest

import supple
from harness import CLI, ROOT, Api, pointers, problem_code

OUTLINES = "/v1/outlines"
PARTS = "/v1/parts"
SOLE_SVG = ROOT / "api" / "examples" / "parts" / "sole.svg"
SOLE_JSON = ROOT / "api" / "examples" / "parts" / "sole.json"
RING = '<svg width="60mm" height="60mm" viewBox="0 0 60 60"><circle id="rim" cx="30" cy="30" r="25"/><circle id="bore" cx="30" cy="30" r="8"/></svg>'


def area(points: Any) -> float:
    x, y = np.asarray(points, dtype=float).T
    return float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2


def dxf(entities: List[str], unit: int = 4) -> str:
    head = ["0", "SECTION", "2", "HEADER", "9", "$INSUNITS", "70", str(unit), "0", "ENDSEC", "0", "SECTION", "2", "ENTITIES"]
    return "\n".join(head + entities + ["0", "ENDSEC", "0", "EOF"]) + "\n"


def cli(api: Api, *arguments: str, text: str = "") -> "subprocess.CompletedProcess[str]":
    return subprocess.run([str(CLI), "--server", api.server.url, *arguments], input=text, capture_output=True, text=True, timeout=60)


@pytest.mark.parametrize("tolerance", [1.0, 0.05, 0.001])
def test_a_drawing_becomes_polygons_within_its_tolerance(api: Api, tolerance: float) -> None:
    answer = api.ok(OUTLINES, {"text": RING, "accuracy": {"tolerance": tolerance}})
    assert answer["format"] == "svg" and [polygon["names"] for polygon in answer["polygons"]] == [["rim"], ["bore"]]
    for polygon, radius in zip(answer["polygons"], (25, 8)):
        points = np.asarray(polygon["points"])
        assert np.hypot(*(points - 30).T) == pytest.approx(radius)
        assert np.hypot(*((points + np.roll(points, 1, axis=0)) / 2 - 30).T).min() >= radius - tolerance
    assert 0 < answer["chord_error"] <= tolerance == answer["accuracy"]["tolerance"]
    assert answer["corners"] == sum(len(polygon["points"]) for polygon in answer["polygons"])
    assert answer["warnings"] == [] and answer["unit_is_known"] and answer["unit"] == pytest.approx(1)
    ran = {effect["name"]: effect["ran"] for effect in answer["effects"]}
    assert ran == {"rounding": True, "joining": False, "uniting": False, "clipping": False, "simplifying": False, "scaling": False}


def test_polygons_go_into_a_part_as_they_are(api: Api) -> None:
    answer = api.ok(OUTLINES, {"text": RING, "width": 30})
    assert answer["size"] == pytest.approx([30, 30], rel=1e-9)
    part = api.ok(PARTS, {"outline": {"polygons": [polygon["points"] for polygon in answer["polygons"]]}, "structure": {"family": "IH21"}, "frame": 1})
    assert part["outline_area"] == pytest.approx(math.pi * (15**2 - 4.8**2), rel=0.01) and part["message"] == ""


def test_lines_and_arcs_of_a_dxf_file_are_joined_in_inches(api: Api) -> None:
    line = lambda *c: ["0", "LINE", "8", "cut", "10", str(c[0]), "20", str(c[1]), "11", str(c[2]), "21", str(c[3])]  # noqa: E731
    arc = ["0", "ARC", "8", "cut", "10", "0", "20", "0", "40", "1", "50", "0", "51", "180"]
    answer = api.ok(OUTLINES, {"text": dxf(line(-1, 0, 1, 0) + arc, unit=1), "accuracy": {"tolerance": 0.001}})
    assert answer["format"] == "dxf" and answer["joined_curves"] == 2 and answer["unit"] == pytest.approx(25.4)
    (polygon,) = answer["polygons"]
    assert polygon["names"] == ["cut"] and abs(area(polygon["points"])) == pytest.approx(math.pi / 2 * 25.4**2, rel=1e-3)
    told = api.ok(OUTLINES, {"text": dxf(["0", "CIRCLE", "10", "0", "20", "0", "40", "1"] + line(5, 5, 9, 9), unit=0), "unit": "automatic"})
    assert told["open_curves"] == 1 and not told["unit_is_known"] and len(told["warnings"]) == 2
    assert api.ok(OUTLINES, {"text": dxf(["0", "CIRCLE", "10", "0", "20", "0", "40", "1"], unit=0), "unit": "cm"})["size"] == pytest.approx([20, 20], rel=1e-2)


def test_what_a_drawing_repeats_has_the_names_of_both(api: Api) -> None:
    text = ('<svg width="60mm" height="60mm" viewBox="0 0 60 60"><defs><circle id="bore" r="8"/></defs>'
            '<use id="first" href="#bore" x="20" y="10"/><g transform="scale(0.5)"><use href="#bore" x="80" y="80"/></g></svg>')
    answer = api.ok(OUTLINES, {"text": text})
    assert [polygon["names"] for polygon in answer["polygons"]] == [["bore", "first"], ["bore"]] and answer["warnings"] == []
    for polygon, centre, radius in zip(answer["polygons"], ((20, 50), (40, 20)), (8, 4)):
        assert np.hypot(*(np.asarray(polygon["points"]) - centre).T) == pytest.approx(radius)
    block = ["0", "SECTION", "2", "BLOCKS", "0", "BLOCK", "2", "bolt", "0", "CIRCLE", "10", "0", "20", "0", "40", "2", "0", "ENDBLK", "0", "ENDSEC"]
    row = ["0", "INSERT", "8", "cut", "2", "bolt", "10", "5", "20", "5", "70", "3", "44", "10"]
    bolts = api.ok(OUTLINES, {"text": "\n".join(block) + "\n" + dxf(row)})
    assert [polygon["names"] for polygon in bolts["polygons"]] == [["cut", "bolt"]] * 3 and bolts["size"] == pytest.approx([24, 4], rel=1e-2)


@pytest.mark.parametrize("kind", ["image/svg+xml", "image/vnd.dxf"])
def test_what_the_server_draws_it_reads(api: Api, kind: str) -> None:
    request = {"outline": {"rectangle": [20, 15]}, "structure": {"family": "IH50"}, "frame": 0.5}
    part = api.ok(PARTS, request)
    answer = api.ok(OUTLINES, {"text": api.post(PARTS, request, headers={"Accept": kind}).text})
    outer, holes = answer["polygons"][0], answer["polygons"][1:]
    assert len(holes) == part["holes"] and answer["warnings"] == [] and answer["unit"] == pytest.approx(1)
    assert answer["size"] == pytest.approx([20, 15], abs=1e-5)
    solid = abs(area(outer["points"])) - sum(abs(area(hole["points"])) for hole in holes)
    assert solid == pytest.approx(part["solid_area"], rel=1e-4)


SQUARE = '<rect x="10" y="10" width="40" height="40"/>'


def page(content: str) -> str:
    return f'<svg width="60mm" height="60mm" viewBox="0 0 60 60">{content}</svg>'


@pytest.mark.parametrize("content, expected, reasons", [
    (f'<style>.st0{{display:none;}}</style><g class="st0"><rect x="20" y="20" width="20" height="20"/></g>{SQUARE}', 1600, ["display: none"]),
    (f'<rect width="60" height="60" style="fill:none;"/>{SQUARE}', 1600, ["neither fill nor stroke"]),
    (f'<rect width="100%" height="100%" fill="#fff"/>{SQUARE}', 1600, ["white background"]),
    ('<rect x="25" y="10" width="10" height="40"/><rect x="10" y="25" width="40" height="10"/>', 700, []),
    ('<path d="M10 10H50V50H10Z"/><path d="M10 10H30H50V50H10Z"/>', 1600, ["lies over another outline"]),
    ('<path d="M10 10L50 10L50 50L10 50"/>', 1600, []),
    ('<g><path d="M10 10L50 10L50 50"/></g><g><path d="M50 50L10 50L10 10"/></g>', 1600, []),
    (f'<clipPath id="c"><rect x="10" y="10" width="20" height="40"/></clipPath><g clip-path="url(#c)">{SQUARE}</g>', 800, []),
], ids=["class", "unpainted", "percent", "plus", "twice", "open", "two-groups", "clip"])
def test_what_a_browser_shows_is_the_outline_and_the_rest_is_told(api: Api, content: str, expected: float, reasons: List[str]) -> None:
    answer = api.ok(OUTLINES, {"text": page(content)})
    assert sum(abs(area(polygon["points"])) for polygon in answer["polygons"]) == pytest.approx(expected, rel=1e-6)
    assert len(answer["left_out"]) == answer["left_out_count"] == len(reasons)
    for one, reason in zip(answer["left_out"], reasons):
        assert reason in one["reason"] and "of line 1" in one["element"]


def test_doubled_stray_and_layered_lines_close(api: Api) -> None:
    line = lambda layer, *c: ["0", "LINE", "8", layer, "10", str(c[0]), "20", str(c[1]), "11", str(c[2]), "21", str(c[3])]  # noqa: E731
    sides = [(0, 0, 40, 0), (40, 0, 40, 40), (40, 40, 0, 40), (0, 40, 0, 0)]
    doubled = [word for side in sides for word in 2 * line("cut", *side)]
    stray = line("cut", 40, 0, 40, 30) + [word for side in sides for word in line("cut", *side)]
    layers = [word for k, side in enumerate(sides) for word in line(("cut", "edge")[k % 2], *side)]
    for entities, left_out in ((doubled, 4), (stray, 1), (layers, 0)):
        answer = api.ok(OUTLINES, {"text": dxf(entities)})
        assert [abs(area(polygon["points"])) for polygon in answer["polygons"]] == pytest.approx([1600])
        assert answer["left_out_count"] == left_out
    sheet = api.post(OUTLINES, {"text": dxf([word for side in sides for word in line("cut", *side)[:4] + ["67", "1"] + line("cut", *side)[4:]])})
    assert problem_code(sheet) == "outline.nothing_closed" and "paper space" in sheet.json()["detail"]


def test_the_resolution_is_asked_for_where_pixels_were_no_96_for_an_inch(api: Api, tmp_path: Path) -> None:
    text = '<!-- Generator: Adobe Illustrator 15.0 --><svg width="72px" height="72px" viewBox="0 0 72 72"><rect width="72" height="36"/></svg>'
    refused = api.post(OUTLINES, {"text": text})
    assert refused.status_code == 422 and problem_code(refused) == "outline.resolution_missing" and pointers(refused) == ["/resolution"]
    assert api.ok(OUTLINES, {"text": text, "resolution": 72})["size"] == pytest.approx([25.4, 12.7])
    drawing = tmp_path / "old.svg"
    drawing.write_text(text)
    assert "--resolution" in cli(api, "outlines", str(drawing)).stderr
    shown = cli(api, "outlines", str(drawing), "--resolution", "72")
    assert shown.returncode == 0 and "25.4 x 12.7 mm" in shown.stdout
    with supple.Client(api.server.url) as client:
        assert client.drawing(drawing, resolution=72).size == pytest.approx((25.4, 12.7))


def test_clients_read_code_pages_and_name_other_formats(api: Api, tmp_path: Path) -> None:
    circle = ["0", "CIRCLE", "8", "Au\u00dfen", "10", "0", "20", "0", "40", "1"]
    head = "0\nSECTION\n2\nHEADER\n9\n$DWGCODEPAGE\n3\nANSI_{}\n0\nENDSEC\n"
    for page_name, layer in (("1252", "Au\u00dfen"), ("1251", "\u041a\u043e\u043d\u0442\u0443\u0440"), ("936", "\u8f6e\u5ed3")):
        file = tmp_path / f"{page_name}.dxf"
        file.write_bytes((head.format(page_name) + dxf([layer if word == circle[3] else word for word in circle])).encode(f"cp{page_name}"))
        shown = cli(api, "outlines", str(file))
        assert shown.returncode == 0 and layer in shown.stdout, shown.stderr
        with supple.Client(api.server.url) as client:
            assert client.drawing(file).polygons[0].names == (layer,)
    for content, words in ((b"AC1018\0\0\xff\xfe", "DWG"), (b"\x1f\x8b\x08\0\xff", "svgz"), (b"%PDF-1.7\n\xe2\xe3", "PDF"), (b"\x89PNG\r\n\x1a\n\0", "PNG")):
        file = tmp_path / "other.bin"
        file.write_bytes(content)
        assert words in cli(api, "outlines", str(file)).stderr
        with supple.Client(api.server.url) as client, pytest.raises(supple.InvalidRequest, match=words):
            client.drawing(file)


@pytest.mark.parametrize("text, code, place, words", [
    ('<svg><path id="heel" d="M0 0 L5 x"/></svg>', "outline.unreadable", "/text", '<path> "heel" of line 1'),
    ("words", "outline.unreadable", "/text", "line 1"),
    ('<svg><line x2="5"/></svg>', "outline.nothing_closed", "/text", "<line> of line 1 ends"),
    ("<svg>" + 20_001 * '<rect width="9" height="9"/>' + "</svg>", "outline.too_large", "/text", "20000 curves"),
    ('<svg><g id="a"><use href="#a"/></g><rect width="9" height="9"/></svg>', "outline.too_large", "/text", "100 groups"),
    ('<svg width="1e6mm" viewBox="0 0 1e6 1e6"><circle r="9e5"/></svg>', "outline.too_large", "/accuracy/tolerance", "corners"),
])
def test_what_no_drawing_has_is_named(api: Api, text: str, code: str, place: str, words: str) -> None:
    answer = api.post(OUTLINES, {"text": text, "accuracy": {"tolerance": 0.0001}})
    assert answer.status_code == 422 and problem_code(answer) == code and pointers(answer) == [place], answer.text
    assert words in answer.json()["detail"]


@pytest.mark.parametrize("change, place", [
    ({"text": 5}, "/text"),
    ({"format": "dwg"}, "/format"),
    ({"unit": "yd"}, "/unit"),
    ({"width": 0}, "/width"),
    ({"resolution": 0}, "/resolution"),
    ({"accuracy": {"tolerance": 0}}, "/accuracy/tolerance"),
    ({"layer": "cut"}, "/layer"),
])
def test_requests_that_the_schema_forbids_are_refused(api: Api, change: Dict[str, Any], place: str) -> None:
    answer = api.post(OUTLINES, {"text": RING, **change}, faulty=True)
    assert problem_code(answer) == "request.invalid" and pointers(answer) == [place], answer.text


def test_a_file_of_the_machine_is_not_read(api: Api) -> None:
    entity = '<?xml version="1.0"?><!DOCTYPE svg [<!ENTITY f SYSTEM "file:///etc/passwd">]>'
    answer = api.ok(OUTLINES, {"text": entity + RING.replace('id="rim"', 'id="&f;"')})
    assert answer["polygons"][0]["names"] == ["&f;"]


def sole_by_the_command_line(api: Api, *more: str) -> Dict[str, Any]:
    made = cli(api, "--json", "part", "IH22", "--outline", f"{SOLE_SVG}#sole", "--region", "heel=IH29,0.5", "--region", "forefoot=IH21,0.5,0.5rad",
               "--beam-width", "0.6", "--frame", "1.6", "--thickness", "12", "--density", "1.1", *more)
    assert made.returncode == 0, made.stderr
    return dict(json.loads(made.stdout))


def test_the_command_line_makes_the_sole_of_its_drawing(api: Api) -> None:
    asked, drawn = api.ok(PARTS, json.loads(SOLE_JSON.read_text())), sole_by_the_command_line(api)
    for name in ("size", "lower", "upper", "outline_area", "solid_area", "mass", "holes"):
        assert drawn[name] == pytest.approx(asked[name], rel=1e-9, abs=1e-9), name
    assert drawn["checks"]["crumbs"] == asked["checks"]["crumbs"]


def test_the_command_line_makes_a_part_of_regions_alone(api: Api, tmp_path: Path) -> None:
    fields = tmp_path / "fields.svg"
    fields.write_text('<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="15mm" viewBox="0 0 40 15"><rect id="heel" width="20" height="15"/>'
                      '<rect id="toes" x="20" width="20" height="15"/></svg>')
    made = cli(api, "part", "--outline", str(fields), "--region", "heel=IH29,0.4", "--region", "toes=IH21,0.4", "--frame", "1", "--json")
    assert made.returncode == 0, made.stderr
    part = json.loads(made.stdout)
    assert part["outline_area"] == pytest.approx(600, rel=1e-6) and part["size"] == pytest.approx([40, 15, 1], abs=1e-5)
    lacking = cli(api, "part", "--outline", str(fields), "--region", "heel=IH29,0.4")
    assert lacking.returncode == 1 and "belong to no region" in lacking.stderr
    with supple.Client(api.server.url) as client:
        drawing = client.drawing(fields)
        regions = [supple.PartRegion(drawing.named(name)[0].points, family, beam_width=0.4, name=name) for name, family in (("heel", "IH29"), ("toes", "IH21"))]
        same = client.part(supple.parts.regions_only(), "IH29", options=supple.PartOptions(regions=regions, frame=1))
        assert same.solid_area == pytest.approx(part["solid_area"], rel=1e-9)


def test_the_command_line_lists_a_drawing_and_names_what_it_lacks(api: Api, tmp_path: Path) -> None:
    shown = cli(api, "outlines", str(SOLE_SVG))
    assert shown.returncode == 0 and "3 closed curves" in shown.stdout and "heel, regions" in shown.stdout
    assert cli(api, "outlines", "-", text=RING).returncode == 0
    wrong = cli(api, "part", "IH22", "--outline", str(SOLE_SVG), "--region", "toe=IH29")
    assert wrong.returncode == 1 and "no closed curve 'toe'" in wrong.stderr and "forefoot, heel" in wrong.stderr
    assert "--region" in cli(api, "part", "IH22", "--outline", str(SOLE_SVG), "--region", "heel").stderr
    assert "drawing" in cli(api, "part", "IH22", "--coupon", "12x30", "--region", "heel=IH29").stderr
    broken = tmp_path / "broken.svg"
    broken.write_text('<svg><path id="toe" d="M0 0 L5 x"/></svg>')
    assert "--outline" in cli(api, "part", "IH22", "--outline", str(broken)).stderr
    assert 'file: ' in cli(api, "outlines", str(broken)).stderr
    open_file = tmp_path / "open.svg"
    open_file.write_text(RING.replace("</svg>", '<line x2="5"/></svg>'))
    made = cli(api, "part", "IH21", "--outline", str(open_file), "--width", "30", "--frame", "1")
    assert made.returncode == 0 and "Open curves were left out" in made.stderr and "30 x 30 x 1 mm" in made.stdout


def test_python_makes_the_same_sole(api: Api, tmp_path: Path) -> None:
    request = json.loads(SOLE_JSON.read_text())
    with supple.Client(api.server.url) as client:
        drawing = client.drawing(SOLE_SVG)
        assert drawing.format == "svg" and drawing.unit_is_known and drawing.open_curves == 0
        assert drawing.outline("sole") == drawing.outline(without=("regions",))
        regions = [supple.PartRegion(drawing.named("heel")[0].points, "IH29", beam_width=0.5),
                   supple.PartRegion(drawing.named("forefoot")[0].points, "IH21", beam_width=0.5, orientation=0.5)]
        options = supple.PartOptions(beam_width=0.6, frame=1.6, thickness=12, density=1.1, regions=regions)
        part = client.part(drawing.outline("sole"), "IH22", options=options)
        assert part.mass == pytest.approx(api.ok(PARTS, request)["mass"], rel=1e-9)
        assert client.part_file(drawing.outline("sole"), "IH22", kind="step", options=options).startswith(b"ISO-10303-21;")
        with pytest.raises(KeyError, match="forefoot, heel"):
            drawing.named("toe")
        with pytest.raises(ValueError, match="unit"):
            client.drawing(SOLE_SVG, unit="yd")
        with pytest.warns(UserWarning, match="says no size"):
            assert client.drawing("<svg>\n<rect width='96' height='96'/></svg>").size == pytest.approx((25.4, 25.4))
        with pytest.warns(UserWarning, match="grip is missing"):
            client.part_file(supple.parts.coupon(10, 60, 8), "IH21", options=supple.PartOptions(beam_width=0.8))
