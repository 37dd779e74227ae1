"""Measured curves over the wire: files as instruments write them become targets that a design takes as they are."""

from __future__ import annotations

import math
from typing import Any, Dict

import numpy as np
import pytest

from harness import Api, pointers, problem_code

CURVES = "/v1/measured-curves"


def soft_then_stiff(strain: Any) -> Any:
    return 0.02 * strain + 0.002 * (np.exp(18 * strain) - 1)


def effect(answer: Dict[str, Any], name: str) -> Dict[str, Any]:
    (found,) = [entry for entry in answer["effects"] if entry["name"] == name]
    return dict(found)


def test_an_instruments_file_becomes_a_target_that_a_design_takes(designs: Api) -> None:
    """500 rows with semicolons, decimal commas, percent and kPa: the way that a person's own data come."""
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
    by_text = api.ok(CURVES, {"text": "".join(f"{e!r},{s!r}\n" for e, s in points)})
    assert by_points["target"] == by_text["target"] and by_points["error"] == by_text["error"]
    assert "table" not in by_points and "columns" not in by_points
    assert by_points["point_count"] == 60 and by_points["set_aside"] == 0


def test_forces_and_displacements_need_the_specimen(api: Api) -> None:
    extension = np.linspace(0, 15, 40)
    text = "Extension (mm),Load (N)\n" + "".join(f"{e},{20 * soft_then_stiff(e / 50)}\n" for e in extension)
    answer = api.post(CURVES, {"text": text})
    assert problem_code(answer) == "design.invalid_measurement" and pointers(answer) == ["/specimen/gauge_length"]
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


@pytest.mark.parametrize("document, place", [
    ({"text": "hello"}, "/text"),
    ({"text": "1,2\n1,3\n"}, "/text"),
    ({"points": [[1, 2], [1, 3]]}, "/points"),
    ({"text": "1,2\n2,3\n", "columns": {"x": 2}}, "/columns/x"),
    ({"text": "1,2\n2,3\n", "columns": {"y": "stress"}}, "/columns/y"),
    ({"text": "1,2\n2,3\n", "units": {"y": "parsec"}}, "/units/y"),
    ({"text": "1,2\n2,3\n", "units": {"x": "deg"}}, "/units/x"),
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
