"""Printing weaves over HTTP: toolpaths as G-code, pictures and moves, reports about G-code files, and refusals."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from typing import Any, Dict, List, Set

import numpy as np
import pytest

from contract import ROOT
from harness import Api, pointers, problem_code
from test_jobs import events, start_job

TOOLPATHS = "/v1/weave-toolpaths"
REPORTS = "/v1/gcode-reports"
FUSED = {"pattern": "regular", "pitch": 10, "sheet": {"columns": 3, "rows": 2}}
"""A sheet with strands 0 and 1 along x, 30 mm long, and strands 2 to 4 along y, 20 mm long."""
SLIDING = {**FUSED, "overrides": [{"crossing": 4, "slides": [1]}]}
STRANDS = [{"points": [[0, 0], [40, 0]]}, {"points": [[20, -20], [20, 20]]}]


def printed(api: Api, weave: Dict[str, Any], **more: Any) -> Dict[str, Any]:
    return api.ok(TOOLPATHS, {"weave": weave, **more})  # type: ignore[no-any-return]


def report(api: Api, gcode: str, **limits: Any) -> Dict[str, Any]:
    return api.ok(REPORTS, {"gcode": gcode, **({"limits": limits} if limits else {})})["report"]  # type: ignore[no-any-return]


def kinds(answer: Dict[str, Any]) -> List[str]:
    return [violation["kind"] for violation in answer["violations"]]


def patterns_of_the_page() -> Dict[str, int]:
    """The patterns that the page offers, with the number of their types, 0 for one without types."""
    source = (ROOT / "clients" / "web" / "src" / "weave" / "patterns.ts").read_text(encoding="utf-8")
    table = source[source.index("export const PATTERNS"):source.index("export const PATTERN_IDS")]
    entries = re.findall(r"^  (\w+): \{.*?types: \[(.*?)\]", table, re.MULTILINE | re.DOTALL)
    return {name: len(re.findall(r'"[^"]*"', types)) for name, types in entries if name != "layout"}


def patterns_of_the_command_line() -> Set[str]:
    source = (ROOT / "clients" / "cli" / "src" / "weave_arguments.cpp").read_text(encoding="utf-8")
    return set(re.findall(r'return "(\w+)";', source)) | {"regular"}


REGULAR = ["fused", "slides_x", "slides_y", [["fused", "slides_x"], ["slides_y", "fused"]], [["slides_x", "slides_y"], ["slides_y", "slides_x"]]]
BUILT_IN: List[Dict[str, Any]] = [
    *({"pattern": "regular", "connections": connections, "sheet": {"columns": 4, "rows": 4}} for connections in REGULAR),
    *({"pattern": "interlacing_squares", "type": kind, "sheet": {"columns": 3, "rows": 3}, **more} for kind in (1, 2, 3, 4) for more in ({}, {"overlap": 3})),
    *({"pattern": "interlacing_circles", "type": kind, "sheet": {"columns": 3, "rows": 3}, **more}
      for kind in (1, 2) for more in ({}, {"circle_radius": 5.5, "distance": 10})),
    {"pattern": "actuated_rings"}]
"""Every pattern and type, as a sheet of default lengths and of those with which the page begins; the printed samples have a test of their own."""


def test_every_pattern_of_page_and_command_line_is_tried() -> None:
    tried = {(weave["pattern"], weave.get("type", 0)) for weave in BUILT_IN}
    for name, types in patterns_of_the_page().items():
        expected = {(name, 0)} if name in ("regular", "actuated_rings") else {(name, kind + 1) for kind in range(types)}
        assert expected <= tried, name
    assert {"regular", "interlacing_squares"} <= patterns_of_the_command_line()
    assert patterns_of_the_command_line() - {"printed_sample"} <= {name for name, _ in tried}


@pytest.mark.parametrize("weave", BUILT_IN, ids=lambda weave: "-".join(str(value) for value in weave.values()))
def test_every_built_in_pattern_prints_or_says_where_it_does_not(api: Api, weave: Dict[str, Any]) -> None:
    answer = api.post(TOOLPATHS, {"weave": weave, "include": []})
    if answer.status_code == 200:
        assert answer.json()["check"]["violations"] == []
        return
    assert problem_code(answer) == "weave.not_printable"
    crossings = [entry for entry in answer.json()["errors"] if "crossings/" in entry["pointer"] + entry["detail"] or "strands/" in entry["detail"]]
    assert crossings, answer.json()
    if weave["pattern"] == "actuated_rings":
        return
    fused = {**weave, "connections": "fused"} if weave["pattern"] == "regular" else {**weave, "type": 1}
    assert api.post(TOOLPATHS, {"weave": fused, "include": []}).status_code == 200, "fused strands need no room"


# --- toolpaths -------------------------------------------------------------------------------------------------------

def test_strands_are_as_long_as_they_are_and_their_overruns(api: Api) -> None:
    answer = printed(api, FUSED, overrun={"start": 4, "end": 1}, overruns=[{"strand": 3, "start": 10}],
                     frame={"margin": 2, "lead_in": 7}, grips=[{"from": [0, -8], "to": [30, -8], "width": 1}])
    statistics = answer["statistics"]
    assert statistics["strand_length"] == pytest.approx(2 * 30 + 3 * 20 + 4 * 5 + 10)
    assert statistics["support_length"] == pytest.approx(2 * (34 + 24) + 7 + 2 * 30 + 0.5)
    assert (statistics["channels"], statistics["lifted_length"], statistics["heights"]) == (0, 0, [0.5])
    assert answer["gcode"].count("\n") == answer["check"]["lines"] and "svg" not in answer and "moves" not in answer


def test_the_check_of_what_was_written_finds_the_statistics(api: Api) -> None:
    answer = printed(api, SLIDING, overrun={"start": 5, "end": 5}, printer={"channel": {"shape": "arc"}, "park": False})
    statistics, check = answer["statistics"], answer["check"]
    assert check["violations"] == [] and check["violation_count"] == 0
    assert statistics["channels"] == len(check["channels"]) == 1 and statistics["travels"] == check["travels"]
    assert check["extruded_length"] == pytest.approx(statistics["extruded_length"], rel=1e-3)
    assert check["filament"] == pytest.approx(statistics["filament"], rel=1e-3)
    assert check["minutes"] == pytest.approx(statistics["minutes"], rel=0.1), "with the way up and retractions"
    np.testing.assert_allclose(check["lowest"], np.minimum(statistics["lowest"], [5, 5, 0.5]), atol=0.01, err_msg="with the priming line")
    np.testing.assert_allclose(check["highest"], statistics["highest"], atol=0.01)
    assert report(api, answer["gcode"]) == check, "the default limits are those of the default printer"


def test_the_nozzle_is_filled_before_the_print_and_parked_after_it(api: Api) -> None:
    answer = printed(api, FUSED, include=["gcode", "moves"])
    line = answer["moves"][1]
    assert line["kind"] == "priming" and line["points"] == [[5, 5, 0.5], [65, 5, 0.5]]
    assert answer["statistics"]["priming_length"] == pytest.approx(60) and "G0 X0 Y210" in answer["gcode"]
    bare = printed(api, FUSED, include=["gcode", "moves"], printer={"priming_length": 0, "park": False})
    assert bare["statistics"]["priming_length"] == 0 and "park" not in bare["gcode"]
    assert answer["statistics"]["extruded_length"] == pytest.approx(bare["statistics"]["extruded_length"] + 60)
    assert answer["statistics"]["lowest"] == bare["statistics"]["lowest"]


@pytest.mark.parametrize("sample, length, channels", [("fused_grid", 5456, 0), ("squares_2", 5931, 128), ("actuation", 645, 6)])
def test_sheets_that_were_printed_are_printed_as_they_were(api: Api, sample: str, length: float, channels: int) -> None:
    weave = {"pattern": "printed_sample", "sample": sample}
    answer = printed(api, weave)
    statistics = answer["statistics"]
    assert statistics["extruded_length"] == pytest.approx(length, rel=0.02) and statistics["channels"] == channels
    assert answer["check"]["violation_count"] == 0 and statistics["priming_length"] == 0
    # Fields of the request take precedence.
    bare = printed(api, weave, grips=[], overrun={}, overruns=[{"strand": 0, "start": 1}], printer={"priming_length": 10})
    assert bare["statistics"]["priming_length"] == pytest.approx(10)
    if sample != "actuation":
        assert bare["statistics"]["support_length"] == (statistics["support_length"] if sample == "fused_grid" else 0)
    assert api.ok("/v1/weave-layouts", {"weave": weave})["lattice"] is None


def test_a_sliding_strand_is_lifted_and_bridged(api: Api) -> None:
    answer = printed(api, SLIDING, overrun={"start": 5, "end": 5}, include=["moves"], origin=[100, 90])
    moves = answer["moves"]
    assert "gcode" not in answer and {move["kind"] for move in moves} == {"priming", "strand", "lifted", "channel", "travel"}
    (channel,) = (move for move in moves if move["kind"] == "channel")
    assert (channel["strand"], channel["crossing"]) == (1, 4)
    assert channel["points"][0] == pytest.approx([113.8, 105, 0.5]) and channel["points"][1][2] == pytest.approx(2.5)
    assert {move["strand"] for move in moves if move["kind"] == "lifted"} == {3}
    for before, move in zip(moves, moves[1:]):
        assert move["points"][0] == before["points"][-1]
    assert all(move["area"] == 0 and move["strand"] is None for move in moves if move["kind"] == "travel")
    assert all(move["crossing"] is None for move in moves if move["kind"] != "channel")
    order = [move["strand"] for move in moves if move["kind"] == "strand"]
    assert order[-1] == 3, "what slides comes last"


def test_the_printer_is_obeyed(api: Api) -> None:
    printer = {"name": "Own", "bed": [60, 60, 60], "nozzle_temperature": 215, "strand_speed": 750, "bead_area": 0.1,
               "filament_diameter": 2.85, "priming_length": 0, "startup_gcode": "G92 E0", "footer_gcode": "M107"}
    answer = printed(api, FUSED, printer=printer, include=["gcode", "moves"])
    assert "Own" in answer["gcode"] and "M109 S215" in answer["gcode"] and answer["check"]["violations"] == []
    statistics = answer["statistics"]
    assert statistics["filament"] == pytest.approx(120 * 0.1 / (np.pi * 2.85**2 / 4))
    np.testing.assert_allclose(np.add(statistics["lowest"], statistics["highest"])[:2], 60, atol=1e-9)
    assert {move["speed"] for move in answer["moves"] if move["kind"] == "strand"} == {750}


def test_loops_overlap_and_orders_are_kept(api: Api) -> None:
    circles = {"pattern": "interlacing_circles", "type": 1, "sheet": {"columns": 2, "rows": 2}}
    plain, overlapping = (printed(api, circles, loop_overlap=overlap)["statistics"] for overlap in (0, 1.5))
    assert overlapping["strand_length"] - plain["strand_length"] == pytest.approx(4 * 1.5, abs=0.02)
    moves = printed(api, FUSED, order=[4, 2, 0, 1, 3], include=["moves"])["moves"]
    assert [move["strand"] for move in moves if move["kind"] == "strand"] == [4, 2, 0, 1, 3]


def test_a_toolpath_is_sent_as_a_file_or_a_picture(api: Api) -> None:
    inside = printed(api, SLIDING, include=["gcode", "svg"])
    for accept, name in (("text/x-gcode", "gcode"), ("image/svg+xml", "svg")):
        response = api.post(TOOLPATHS, {"weave": SLIDING}, headers={"Accept": accept})
        assert response.status_code == 200 and response.headers["Content-Type"] == accept
        assert float(response.headers["Supple-Seconds"]) >= 0 and response.text == inside[name]
    assert ElementTree.fromstring(inside["svg"]).tag.endswith("svg")
    refused = api.post(TOOLPATHS, {"weave": SLIDING}, headers={"Accept": "model/stl"})
    assert (refused.status_code, problem_code(refused)) == (406, "http.not_acceptable")


# --- reports ---------------------------------------------------------------------------------------------------------

GOOD = "M140 S60\nM104 S200\nM190 S60\nM109 S200\nG28\nG21\nG90\nM82\nG92 E0\nG0 X10 Y10 Z0.5 F3000\n"


def test_a_report_says_what_is_printed(api: Api) -> None:
    found = report(api, GOOD + "G1 X60 E4.0817 F600\n")
    assert found["violations"] == [] and found["lines"] == 11 and found["heights"] == [0.5]
    assert (found["extruded_length"], found["filament"]) == (50, pytest.approx(4.0817))
    assert (found["lowest"], found["highest"]) == ([10, 10, 0.5], [60, 10, 0.5])


def test_each_violation_has_its_line(api: Api) -> None:
    found = report(api, GOOD + "G1 X60 E4.0817 F600\nG1 X300 F9000\nG1 Y-5\nG5 X1\nG1 X1.2.3\n")
    assert [(v["line"], v["kind"]) for v in found["violations"] if v["kind"] != "travel_without_retraction"] == [
        (12, "outside_bed"), (13, "y_below_zero"), (13, "outside_bed"), (14, "unknown_command"), (15, "malformed_word")]
    assert found["violation_count"] == len(found["violations"])
    assert "cold_extrusion" in kinds(report(api, "G28\nG90\nM82\nG1 X10 Y10 Z0.5 F600\nG1 X20 E0.8163\n"))


def test_limits_are_the_requests(api: Api) -> None:
    line = GOOD + "G1 X60 E4.0817 F600\n"
    assert kinds(report(api, line, print_speed=500)) == ["too_fast"]
    assert kinds(report(api, line, bead_area=0.1, least_bead_area=0.1)) == ["over_extrusion"]
    assert kinds(report(api, line, cold=210)) == ["cold_extrusion"]
    assert kinds(report(api, line, bed=[50, 50, 50])) == ["outside_bed"]


def test_any_text_has_a_report(api: Api) -> None:
    assert report(api, "")["lines"] == 0
    assert report(api, "\u00e9\u0000;\u00e9\nhello" + "G1" * 500)["violation_count"] > 0
    many = report(api, "G5\n" * 1500)
    assert (len(many["violations"]), many["violation_count"]) == (1000, 1500)


# --- jobs ------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("path, document", [(TOOLPATHS, {"weave": SLIDING}), (REPORTS, {"gcode": GOOD})], ids=["toolpaths", "reports"])
def test_a_job_has_the_result_of_the_immediate_answer(api: Api, path: str, document: Dict[str, Any]) -> None:
    job = start_job(api, path, document)
    seen = list(events(api, job))
    assert seen[-1][1]["state"] == "successful" and seen[-1][1]["kind"] == path[4:] and seen[-1][1]["progress"] == 1
    result, immediate = api.get(f"/v1/jobs/{job}/result").json(), api.ok(path, document)
    del result["cost"], immediate["cost"]
    assert result == immediate


# --- refusals --------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("weave, more, expected", [
    ({"pattern": "regular"}, {}, ["/weave"]),
    ({**FUSED, "pitch": 1, "connections": "slides_y"}, {}, ["/weave"]),
    ({"strands": STRANDS, "overrides": [{"crossing": 0, "slides": [0, 1]}]}, {}, ["/weave"]),
    ({"strands": STRANDS, "crossings": [{"members": [{"strand": 0, "coordinate": 20, "slides": True},
                                                     {"strand": 1, "coordinate": 20, "slides": True}]}]}, {}, ["/weave/crossings/0"]),
    ({"strands": [STRANDS[0], {"points": [[0, 9]], "ends": "periodic", "translation": [50, 0]}], "lattice": [[50, 0], [0, 99]]}, {},
     ["/weave", "/weave/strands/1"]),
    (FUSED, {"origin": [-50, 0]}, ["/printer/bed"]),
    (FUSED, {"printer": {"bed": [25, 210, 210]}}, ["/printer/bed"]),
], ids=["cell", "too-close", "both-slide", "given-crossing", "periodic", "origin", "bed"])
def test_what_cannot_be_printed_is_pointed_to(api: Api, weave: Any, more: Dict[str, Any], expected: List[str]) -> None:
    response = api.post(TOOLPATHS, {"weave": weave, **more})
    assert (response.status_code, problem_code(response)) == (422, "weave.not_printable")
    found = pointers(response)
    assert found[:len(expected)] == expected and set(found) == set(expected)


def test_what_has_too_little_room_says_how_much_it_needs(api: Api) -> None:
    faults = api.post(TOOLPATHS, {"weave": {**FUSED, "pitch": 1, "connections": "slides_y"}}).json()["errors"]
    rooms = [fault for fault in faults if "needed" in fault]
    assert rooms and all(fault["needed"] > fault["available"] >= 0 for fault in rooms)
    assert all(f"{fault[number]:.4f} mm" in fault["detail"] for fault in rooms for number in ("needed", "available"))
    sliding_twice = {"strands": STRANDS, "overrides": [{"crossing": 0, "slides": [0, 1]}]}
    others = api.post(TOOLPATHS, {"weave": sliding_twice}).json()["errors"]
    assert all("needed" not in fault and "available" not in fault for fault in others)


@pytest.mark.parametrize("fields, expected", [
    ({"printer": {"lift": {"top": 3}}}, ["/printer/lift/run"]),
    ({"printer": {"startup_gcode": "\u00e9", "name": "a\nb"}}, ["/printer/name", "/printer/startup_gcode"]),
    ({"order": [0, 1]}, ["/order"]),
    ({"overruns": [{"strand": 1}, {"strand": 9, "end": 1}]}, ["/overruns/1/strand"]),
    ({"grips": [{"from": [0, 0], "to": [9, 0]}, {"from": [0, 0], "to": [0, 0]}]}, ["/grips/1"]),
    ({"grips": [{"from": [0, 0], "to": [9, 0], "width": 1000}] * 100, "printer": {"strand_width": 0.01}}, ["/grips"]),
], ids=["lift", "texts", "order", "overruns", "grip", "passes"])
def test_an_option_that_does_not_fit_is_pointed_to(api: Api, fields: Dict[str, Any], expected: List[str]) -> None:
    response = api.post(TOOLPATHS, {"weave": FUSED, **fields})
    assert (response.status_code, problem_code(response)) == (422, "weave.invalid_option")
    assert pointers(response) == expected


@pytest.mark.parametrize("lines", ["M83", 'M862.3 P "MK3S"\nM115 U3.13.2\nM900 K0.05\nM221 S95', "M83\r\nG92 E0\r\n", "START_PRINT BED=60\nG91\nG20"])
def test_start_lines_of_any_printer_do_not_spoil_the_print(api: Api, lines: str) -> None:
    answer = printed(api, SLIDING, printer={"startup_gcode": lines})
    assert answer["check"]["violations"] == [] and "\r" not in answer["gcode"]
    assert all(line.strip() in answer["gcode"] for line in lines.splitlines())
    own = answer["gcode"].split("; end of the own start lines\n")[1]
    assert own.startswith("G21 ") and own.index("G90") < own.index("M82") < own.index("G92 E0")
    passed = {entry["command"] for entry in answer["check"]["unchecked"]}
    assert passed == ({"M862.3", "M115", "M900"} if "M900" in lines else {"START_PRINT"} if "START" in lines else set())


def test_a_placeholder_that_was_not_replaced_is_named(api: Api) -> None:
    response = api.post(TOOLPATHS, {"weave": FUSED, "printer": {"startup_gcode": "G28\nM104 S[first_layer_temperature]"}})
    assert problem_code(response) == "weave.invalid_option" and pointers(response) == ["/printer/startup_gcode"]
    assert "line 2: the placeholder [first_layer_temperature]" in response.json()["detail"]


@pytest.mark.parametrize("path, fields, pointer", [
    (TOOLPATHS, {"include": ["stl"]}, "/include/0"), (TOOLPATHS, {"printer": {"bed": [1, 2]}}, "/printer/bed"),
    (TOOLPATHS, {"printer": {"speed": 1}}, "/printer/speed"), (TOOLPATHS, {"chord_error": 0}, "/chord_error"),
    (TOOLPATHS, {"overruns": [{"strand": 1}, {"strand": 1}]}, "/overruns/1/strand"),
    (REPORTS, {"gcode": 3}, "/gcode"), (REPORTS, {"limits": {"tolerance": 2}}, "/limits/tolerance"),
], ids=lambda value: str(value))
def test_a_field_outside_its_range_is_pointed_to(api: Api, path: str, fields: Dict[str, Any], pointer: str) -> None:
    minimal = {"weave": FUSED} if path == TOOLPATHS else {"gcode": "G28"}
    response = api.post(path, {**minimal, **fields}, faulty=True)
    assert (response.status_code, problem_code(response)) == (400, "request.invalid")
    assert pointers(response) == [pointer]


def test_no_more_points_and_lines_than_the_limits(api: Api) -> None:
    response = api.post(TOOLPATHS, {"weave": FUSED, "grips": [{"from": [0, 0], "to": [9, 0], "width": 1000}] * 100,
                                    "printer": {"strand_width": 0.12, "bed": [10000, 10000, 100]}})
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert response.json()["limit"] == 1_000_000
    response = api.post(REPORTS, {"gcode": "\n" * 200_001})
    assert (response.status_code, problem_code(response)) == (400, "request.limit_exceeded")
    assert pointers(response) == ["/gcode"]


def test_the_contract_names_the_defaults_that_the_server_has(api: Api) -> None:
    schemas = api.contract.spec["components"]["schemas"]

    def defaults(schema: Dict[str, Any]) -> Dict[str, Any]:
        named: Dict[str, Any] = {}
        for name, entry in schema["properties"].items():
            if "properties" in entry:
                named[name] = defaults(entry)
            elif "default" in entry:
                named[name] = entry["default"]
            elif "$ref" in entry:
                named[name] = api.contract.resolve(entry)["default"]
        return named

    given = printed(api, SLIDING, printer=defaults(schemas["PrinterProfile"]))
    assert given["gcode"] == printed(api, SLIDING)["gcode"]
    line = GOOD + "G1 X60 E4.0817 F600\n"
    assert report(api, line, **defaults(schemas["GcodeLimits"])) == report(api, line)
