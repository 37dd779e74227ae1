"""Measured curves over HTTP: files of instruments become targets that a design accepts unchanged."""

from __future__ import annotations

import base64
import math
from typing import Any, Dict

import numpy as np
import pytest

from harness import Api, pointers, problem_code

CURVES = "/v1/measured-curves"
UNITS = {"x": "1", "y": "MPa"}


def soft_then_stiff(strain: Any) -> Any:
    return 0.02 * strain + 0.002 * (np.exp(18 * strain) - 1)


def effect(answer: Dict[str, Any], name: str) -> Dict[str, Any]:
    (found,) = [entry for entry in answer["effects"] if entry["name"] == name]
    return dict(found)


def test_an_instruments_file_becomes_a_target_that_a_design_takes(designs: Api) -> None:
    """500 rows with semicolons, decimal commas, percent and kPa, as in files of testing machines."""
    strain = np.linspace(0, 0.15, 500)
    rows = "\r\n".join(f"{100 * e:.4f};{t:.2f};{1000 * s:.5f}".replace(".", ",")
                       for e, t, s in zip(strain, np.arange(500), soft_then_stiff(strain)))
    text = "Zugversuch 17\r\nPrüfer: A. B.\r\n\r\nDehnung [%];Zeit [s];Spannung [kPa]\r\n" + rows
    answer = designs.ok(CURVES, {"text": text})
    assert answer["table"]["rows"] == 500 and answer["table"]["skipped_lines"] == 2
    assert (answer["table"]["delimiter"], answer["table"]["decimal_separator"]) == ("semicolon", "comma")
    assert answer["columns"] == {"x": 0, "y": 2} and answer["units"] == {"x": "%", "y": "kPa"}
    assert answer["error"]["relative_rms"] <= 0.005 and len(answer["target"]["control_points"]) <= 8
    assert answer["target"]["control_points"][0] == [0, 0]
    points = np.asarray(answer["points"])
    assert len(points) == 500 and np.allclose(points[:, 1], soft_then_stiff(points[:, 0]), atol=1e-6)
    design = designs.ok("/v1/designs", {"task": "stress_strain", "family": "IH67", "target": answer["target"],
                                        "strain_measure": "engineering", "accuracy": {"candidates": 24, "starts": 2}})
    assert design["profile"]["x"][-1] == pytest.approx(0.15)
    assert design["profile"]["target"][-1] == pytest.approx(soft_then_stiff(0.15), rel=0.01)


def test_points_and_text_say_the_same(api: Api) -> None:
    strain = np.linspace(0, 0.3, 60)
    points = [[float(e), float(s)] for e, s in zip(strain, soft_then_stiff(strain))]
    by_points = api.ok(CURVES, {"points": points})
    by_text = api.ok(CURVES, {"text": "".join(f"{e!r},{s!r}\n" for e, s in points), "units": {"x": "1", "y": "MPa"}})
    assert by_points["target"] == by_text["target"] and by_points["error"] == by_text["error"]
    assert "table" not in by_points and "columns" not in by_points
    assert by_points["point_count"] == 60 and by_points["set_aside"] == 0


def test_forces_and_displacements_need_the_specimen(api: Api) -> None:
    extension = np.linspace(0, 15, 40)
    text = "Extension (mm),Load (N)\n" + "".join(f"{e},{20 * soft_then_stiff(e / 50)}\n" for e in extension)
    answer = api.post(CURVES, {"text": text})
    assert problem_code(answer) == "design.invalid_measurement" and pointers(answer) == ["/specimen/gauge_length", "/specimen/area"]
    answer = api.post(CURVES, {"text": text, "specimen": {"gauge_length": 50}})
    assert pointers(answer) == ["/specimen/area"]
    curve = api.ok(CURVES, {"text": text, "specimen": {"gauge_length": 50, "area": 20}})
    assert curve["points"][-1] == pytest.approx([0.3, soft_then_stiff(0.3)])
    assert curve["units"] == {"x": "mm", "y": "N"}


def test_a_cycle_gives_its_first_loading_and_says_so(api: Api) -> None:
    strain = np.linspace(0, 0.3, 80)
    up = [[float(e), float(s)] for e, s in zip(strain, soft_then_stiff(strain))]
    down = [[float(e), float(0.5 * s)] for e, s in zip(strain[::-1], soft_then_stiff(strain[::-1]))]
    answer = api.ok(CURVES, {"points": up + down})
    assert answer["set_aside"] == 80 and "first loading" in answer["message"]
    assert answer["set_aside_reasons"] == [{"reason": "not_first_loading", "count": 80}]
    assert [note["level"] for note in answer["notes"]] == ["warning"], "half of the points"
    assert effect(answer, "loading")["ran"] and effect(answer, "origin")["ran"]
    every = api.ok(CURVES, {"points": up + down, "effects": {"loading": "off", "origin": "off"}})
    assert every["set_aside"] == 0 and not effect(every, "loading")["ran"] and not effect(every, "origin")["ran"]


def test_more_control_points_bring_the_curve_closer(api: Api) -> None:
    strain = np.linspace(-0.1, 0.3, 300)
    points = [[float(e), float(math.tanh(40 * e) + 3 * e**2)] for e in strain]
    errors = []
    for count in (4, 8, 16):
        answer = api.ok(CURVES, {"points": points, "accuracy": {"tolerance": 1e-6, "max_control_points": count}})
        assert len(answer["target"]["control_points"]) <= count
        assert answer["accuracy"] == {"tolerance": 1e-6, "max_control_points": count}
        errors.append(answer["error"]["relative_rms"])
    assert errors[0] > 2 * errors[1] > 4 * errors[2]
    assert "more control points" in answer["message"]


def test_directions_in_degrees_become_a_target_over_directions(designs: Api) -> None:
    angles = np.arange(0, 360, 5)
    text = "angle (deg)\tPoisson's ratio\n" + "".join(f"{a}\t{0.2 + 0.1 * math.cos(math.radians(2 * a))}\n" for a in angles)
    answer = designs.ok(CURVES, {"task": "poisson", "text": text})
    assert answer["units"] == {"x": "deg", "y": "1"} and answer["error"]["relative_rms"] <= 0.005
    x = [point[0] for point in answer["target"]["control_points"]]
    assert x[-1] - x[0] < math.pi
    designs.ok("/v1/designs", {"task": "poisson", "family": "IH29", "target": answer["target"], "samples": 12,
                               "accuracy": {"candidates": 8, "starts": 1}})


# Files in the formats of machines and spreadsheets: text, further fields of the request, and the expected last point (strain, MPa).
FILES: Dict[str, Any] = {
    "units in a row of their own": ('"Time","Force","Stroke"\n"sec","N","mm"\n0,0,0\n1,2,1\n2,5,2\n', {"specimen": {"gauge_length": 50, "area": 20}}, [0.04, 0.25]),
    "units without brackets": ("Strain %,Stress kPa\n0,0\n5,21\n10,50\n", {}, [0.1, 0.05]),
    "capital letters": ("Extension (MM),Load (KN)\n0,0\n1,0.002\n2,0.005\n", {"specimen": {"gauge_length": 50, "area": 20}}, [0.04, 0.25]),
    "underscores": ("Strain_%,Force_N\n0,0\n5,2\n10,5\n", {"specimen": {"area": 20}}, [0.1, 0.25]),
    "thousands": ('Strain (%),Stress (kPa)\n0,0\n5,"300.00"\n10,"1,800.00"\n', {}, [0.1, 1.8]),
    "few numbers": ("Strain (mm/mm),Stress (kPa)\n0,0\n0.05,21\n0.1,50\n", {}, [0.1, 0.05]),
    "numbers in the preamble": ("Width (mm),20,Thickness (mm),4\nTime (s),Extension (mm),Load (N),Strain (%)\n0,0,0,0\n1,1,2,2\n2,2,5,4\n", {"specimen": {"area": 80}}, [0.04, 0.0625]),
    "commas at the ends": ("Strain (%),Stress (kPa)\n0,0,\n5,21,\n10,50,\n", {}, [0.1, 0.05]),
    "compression": ("Compressive strain (%);Compressive stress (kPa)\n0;0\n5;21\n10;50\n", {}, [-0.1, -0.05]),
    "stress and load": ("Time (s),Load (N),Displacement (mm),Stress (MPa),Strain (%)\n0,0,0,0,0\n1,2,1,0.025,2\n2,5,2,0.0625,4\n", {}, [0.04, 0.0625]),
    "position": ("Time (s),Position (mm),Load (N)\n0,0,0\n1,1,2\n2,2,5\n", {"specimen": {"gauge_length": 50, "area": 20}}, [0.04, 0.25]),
    "quoted decimal commas": ('"Time","Force","Displacement"\n"(s)","(N)","(mm)"\n"0,0","0,0","0,0"\n"1,0","2,5","1,0"\n"2,0","5,5","2,0"\n', {"specimen": {"gauge_length": 50, "area": 20}}, [0.04, 0.275]),
    "blocks": ('SID,"A"\n1,Time,Tensile stress,Tensile strain\n,(s),(kPa),(%)\n,"0","0","0"\n,"1","21","5"\n,"2","50","10"\n'
               '2,Time,Tensile stress,Tensile strain\n,(s),(kPa),(%)\n,"0","0","0"\n,"1","18","5"\n,"2","44","10"\n', {}, [0.1, 0.05]),
    "the second block": ("Strain (%),Stress (kPa)\n0,0\n5,21\n10,50\n\nStrain (%),Stress (kPa)\n0,0\n5,18\n10,44\n", {"block": 1}, [0.1, 0.044]),
    "typographic minus signs": ("Strain (%);Stress (kPa)\n0;0\n\u22125;\u221221\n\u221210;\u221250\n", {}, [-0.1, -0.05]),
    "a stretch": ("Stretch ratio;Stress (kPa)\n1;0\n1,05;21\n1,1;50\n", {}, [0.1, 0.05]),
    "Chinese": ("时间(s);力(N);变形(mm)\n0;0;0\n1;2;1\n2;5;2\n", {"specimen": {"gauge_length": 50, "area": 20}}, [0.04, 0.25]),
    "an unknown language": ("Aika (s);Venymä (%);Jännitys (kPa)\n0;0;0\n1;5;21\n2;10;50\n", {}, [0.1, 0.05]),
}


@pytest.mark.parametrize("name", FILES)
def test_files_of_machines_are_read_right(api: Api, name: str) -> None:
    text, more, last = FILES[name]
    loaded = {"effects": {"origin": "off"}, **more}
    answer = api.ok(CURVES, {"text": text, **loaded})
    points = answer["points"] if last[0] > 0 else answer["points"][::-1]
    assert points[-1] == pytest.approx(last, rel=1e-9)
    for encoding in ("utf-16", "utf-8-sig", "gbk", "cp1252"):
        try:
            content = text.encode(encoding)
        except UnicodeEncodeError:
            continue
        same = api.ok(CURVES, {"content": base64.b64encode(content).decode(), **loaded})
        assert same["points"] == answer["points"] and same["notes"] == answer["notes"], encoding


def test_the_answer_says_what_was_assumed_and_what_was_not_used(api: Api) -> None:
    def notes(text: str, **more: Any) -> Dict[str, str]:
        return {note["pointer"]: note["text"] for note in api.ok(CURVES, {"text": text, **more})["notes"]}

    plain = "Strain (%);Stress (kPa)\n0;0\n5;21\n10;50\n"
    assert "tension was assumed" in notes(plain)["/sense"]
    assert "/sense" not in notes(plain, sense="tension")
    compressed = api.ok(CURVES, {"text": plain, "sense": "compression"})
    assert compressed["sense"] == {"used": "compression", "told_by": "request"} and min(compressed["points"])[0] == pytest.approx(-0.1)
    assert "not used" in notes(plain, specimen={"gauge_length": 50})["/specimen/gauge_length"]
    assert "column 0" in notes("Strain 1 (%),Stress 1 (kPa),Strain 2 (%),Stress 2 (kPa)\n0,0,0,0\n1,2,1,3\n2,3,2,5\n")["/columns"]
    blocks = api.ok(CURVES, {"text": plain + "\n" + plain})
    assert (blocks["table"]["block"], blocks["table"]["blocks"]) == (0, 2) and "/block" in [note["pointer"] for note in blocks["notes"]]


def test_growing_cycles_give_the_virgin_curve_and_a_break_is_cut(api: Api) -> None:
    rows = [(e, 10 * e) for e in np.arange(0, 5.1, 0.5)] + [(e, 2 * e) for e in np.arange(4.5, -0.1, -0.5)]
    rows += [(e, 4 * e if e < 5 else 10 * e) for e in np.arange(0, 10.1, 1)] + [(e, 2 * e) for e in np.arange(9, -0.1, -1)]
    head = "Strain (%),Stress (kPa)\n"
    answer = api.ok(CURVES, {"text": head + "".join(f"{e:.1f},{s:.1f}\n" for e, s in rows)})
    points = np.asarray(answer["points"])
    assert np.allclose(points[:, 1], points[:, 0]) and points[-1, 0] == pytest.approx(0.1)
    assert sum(reason["count"] for reason in answer["set_aside_reasons"]) == answer["set_aside"] == len(rows) - len(points)
    broken = [(e, 10 * e) for e in range(60)] + [(60 + 0.1 * k, 3) for k in range(8)]
    cut = api.ok(CURVES, {"text": head + "".join(f"{e},{s}\n" for e, s in broken)})
    assert cut["set_aside_reasons"] == [{"reason": "after_rupture", "count": 8}] and "after the break at the strain 0.59" in cut["message"]
    assert effect(cut, "rupture")["ran"]
    assert api.ok(CURVES, {"text": head + "".join(f"{e},{s}\n" for e, s in broken), "effects": {"rupture": "off"}})["set_aside"] == 0


def test_an_instruments_bytes_say_their_encoding(api: Api) -> None:
    text = "Zeit [s];Dehnung [%];Spannung [kPa];Temp [°C]\n0;0;0;23\n1;5;21;23\n2;10;50;23\n"
    for encoding, told in (("latin-1", "windows-1252"), ("utf-16-le", "utf-16"), ("utf-8", "utf-8")):
        answer = api.ok(CURVES, {"content": base64.encodebytes(text.encode(encoding)).decode()})
        assert answer["table"]["encoding"] == told and answer["table"]["columns"][3] == {"name": "Temp", "unit": "°C", "least": 23, "greatest": 23, "missing": 0}


def test_missing_units_are_all_asked_for_at_once(api: Api) -> None:
    answer = api.post(CURVES, {"text": "Strain;Stress\n0;0\n1;2\n"})
    assert pointers(answer) == ["/units/x", "/units/y"]
    details = [error["detail"] for error in answer.json()["errors"]]
    assert "microstrain" in details[0] and "kPa" in details[1] and '"Strain"' in details[0]


@pytest.mark.parametrize("document, place", [
    ({"text": "hello"}, "/text"),
    ({"text": "1,2\n1,3\n", "units": UNITS}, "/text"),
    ({"content": base64.b64encode(b"hello").decode()}, "/content"),
    ({"points": [[1, 2], [1, 3]]}, "/points"),
    ({"text": "1,2\n2,3\n", "columns": {"x": 2}}, "/columns/x"),
    ({"text": "1,2\n2,3\n", "columns": {"y": "stress"}}, "/columns/y"),
    ({"text": "1,2\n2,3\n", "units": {"x": "%", "y": "parsec"}}, "/units/y"),
    ({"text": "1,2\n2,3\n", "units": {"x": "deg", "y": "MPa"}}, "/units/x"),
    ({"text": "Strain (%),Stress\n1,2\n2,3\n"}, "/units/y"),
    ({"text": "Time (s),Stress (MPa)\n1,2\n2,3\n"}, "/columns/x"),
    ({"text": "Strain (%);Stress (MPa)\n1,234;2,345\n2,345;3,456\n"}, "/decimal_separator"),
    ({"text": "Strain (%),Stress (MPa)\n0,0\n-5,21\n"}, "/sense"),
    ({"text": "Position (mm),Load (N)\n120,0\n125,21\n", "specimen": {"gauge_length": 50, "area": 20}}, "/zero"),
    ({"text": "Strain (%),Stress (MPa)\n0,0\n5,21\n", "block": 1}, "/block"),
    ({"text": "Strain,Stress\n0,00,0,00\n0,05,1,20\n"}, "/text"),
    ({"points": [[0, 1], [1, 2]], "units": {"y": "N"}}, "/specimen/area"),
    ({"points": [[0, 1], [1, 2]], "range": [5, 6]}, "/points"),
])
def test_what_cannot_be_used_is_named(api: Api, document: Dict[str, Any], place: str) -> None:
    answer = api.post(CURVES, document)
    assert answer.status_code == 422 and pointers(answer) == [place], answer.text


@pytest.mark.parametrize("document, place", [
    ({}, ""),
    ({"text": "1,2\n2,3\n", "points": [[0, 1], [1, 2]]}, ""),
    ({"points": [[0, 1]]}, "/points"),
    ({"points": [[0, 1], [1]]}, "/points/1"),
    ({"points": [[0, 1], [1, 2]], "columns": {"x": 0}}, "/columns"),
    ({"points": [[0, 1], [1, 2]], "block": 0}, "/block"),
    ({"points": [[0, 1], [1, 2]], "decimal_separator": "point"}, "/decimal_separator"),
    ({"text": "1,2\n", "content": "MSwy"}, ""),
    ({"content": "M"}, "/content"),
    ({"content": "MSwy!"}, "/content"),
    ({"content": 5}, "/content"),
    ({"text": "1,2\n2,3\n", "sense": "torsion"}, "/sense"),
    ({"task": "poisson", "points": [[0, 1], [1, 2]], "sense": "tension"}, "/sense"),
    ({"text": "1,2\n2,3\n", "zero": "last"}, "/zero"),
    ({"text": "1,2\n2,3\n", "block": -1}, "/block"),
    ({"text": "1,2\n2,3\n", "effects": {"rupture": "maybe"}}, "/effects/rupture"),
    ({"text": "1,2\n2,3\n", "columns": {"x": -1}}, "/columns/x"),
    ({"text": "1,2\n2,3\n", "range": [1, 0]}, "/range"),
    ({"text": "1,2\n2,3\n", "specimen": {"area": 0}}, "/specimen/area"),
    ({"text": "1,2\n2,3\n", "accuracy": {"max_control_points": 65}}, "/accuracy/max_control_points"),
    ({"text": "1,2\n2,3\n", "effects": {"origin": "maybe"}}, "/effects/origin"),
    ({"text": "1,2\n2,3\n", "colour": 1}, "/colour"),
])
def test_requests_that_the_schema_forbids_are_refused(api: Api, document: Dict[str, Any], place: str) -> None:
    answer = api.post(CURVES, document, faulty=True)
    assert problem_code(answer) == "request.invalid" and pointers(answer) == [place], answer.text
