"""Weaves with the command line client and with the Python package."""

from __future__ import annotations

import csv
import json
import xml.etree.ElementTree as ElementTree
from typing import List

import numpy as np
import pytest

import supple
from cli_program import Program, number_after
from harness import Api

SVG = "{http://www.w3.org/2000/svg}"
SHEET = ["regular", "--sheet", "5x4"]


def test_a_layout_is_described_and_drawn(program: Program, api: Api) -> None:
    text = program.ok("weave", "layout", "squares", "--type", "2", "--crossings", "--svg", "squares.svg")
    assert number_after("strands", text) == 8 and "16, 8 of which slide" in text and text.count(" slides") == 8
    ElementTree.parse(program.folder / "squares.svg")
    assert program.ok("weave", "layout", "squares", "--type", "2", "--svg", "-") == (program.folder / "squares.svg").read_text()
    answer = json.loads(program.ok("--json", "weave", "layout", "circles", "--type", "1", "--distance", "9.5"))
    api.contract.validate({"$ref": "#/components/schemas/WeaveLayoutResponse"}, answer, "the CLI's output")
    assert answer["lattice"] == [[9.5, 0], [0, 9.5]]


def test_crossings_are_fused_and_slide_by_their_numbers(program: Program) -> None:
    def sliding(*arguments: str) -> List[List[bool]]:
        answer = json.loads(program.ok("--json", "weave", "layout", "regular", *arguments))
        return [[member["slides"] for member in crossing["members"]] for crossing in answer["crossings"]]

    assert sliding("--connections", "fused,slides_x;slides_y,fused") == [
        [False, False], [True, False], [False, True], [False, False]]
    assert sliding("--slide", "1:0,2:1") == sliding("--connections", "fused,slides_x;slides_y,fused")
    assert sliding("--connections", "slides_x", "--fuse", "0,3", "--slide", "1:0,1:1") == [
        [False, False], [True, True], [True, False], [False, False]]


def test_a_weave_comes_from_a_file(program: Program) -> None:
    strands = [{"points": [[0, 0], [4, 0]]}, {"points": [[2, -2], [2, 2]]}, {"points": [[9, 9], [10, 9]]}]
    (program.folder / "own.json").write_text(json.dumps({"strands": strands}))
    (program.folder / "request.json").write_text(json.dumps({"weave": {"strands": strands}}))
    finished = program.run("weave", "layout", "own.json")
    assert "crossings   1," in finished.stdout and "nothing connects" in finished.stderr
    assert program.ok("weave", "layout", "request.json") == finished.stdout


def test_a_homogenization_is_shown_plotted_and_written_as_csv_and_obj(program: Program) -> None:
    text = program.ok("weave", "homogenize", "regular", "--directions", "12", "--thickness", "0.5", "--csv", "e.csv",
                      "--plot", "e.svg", "--deformed", "0,3", "--obj", "cell.obj")
    assert text.count("converged") == 12 and " MPa" in text
    with (program.folder / "e.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 12 and float(rows[0]["F_xx"]) == pytest.approx(1.1)
    assert float(rows[0]["youngs_modulus"]) == pytest.approx(500 * float(rows[0]["youngs_modulus_mpa"]))
    plot = ElementTree.parse(program.folder / "e.svg").getroot()
    texts = {element.text for element in plot.iter(SVG + "text")}
    assert {"Young\u2019s modulus", "Poisson\u2019s ratio", "E (MPa)", "\u03c0/2"} <= texts
    assert all((program.folder / name).read_text().count("\nl ") == 4 for name in ("cell-1.obj", "cell-2.obj"))
    assert program.ok("weave", "homogenize", "regular", "--directions", "0,0.5", "--strain", "0.05", "--csv", "-").count("\n") == 3


def test_a_sheet_is_simulated_and_written_as_csv_obj_and_vtu(program: Program, api: Api) -> None:
    load = ["--hold", "-1,-1,0.5,17", "--move", "19.5,-1,21,17=0.4,0", "--states", "2"]
    text = program.ok("weave", "simulate", *SHEET, *load, "--csv", "s.csv", "--vtu", "s.vtu")
    assert text.count("converged") == 2 and "support 1" in text
    with (program.folder / "s.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert float(rows[1]["R1_x"]) == pytest.approx(-float(rows[1]["R0_x"])) and float(rows[1]["R1_x"]) > 10
    for number in range(2):
        ElementTree.parse(program.folder / f"s-{number:04}.vtu")
    program.ok("weave", "simulate", *SHEET, *load, "--obj", "s.obj")
    assert (program.folder / "s-0001.obj").read_text().count("\nl ") == 9
    answer = json.loads(program.ok("--json", "weave", "simulate", *SHEET, "--hold", "c0", "--hold", "3:start", "--hold",
                                   "8:end", "--pull", "4@0=0,-0.01", "--free-z", "--out-of-plane", "off"))
    api.contract.validate({"$ref": "#/components/schemas/WeaveSimulationResponse"}, answer, "the CLI's output")
    assert [place["support"] for place in answer["supports"]] == [0, 1, 2]


def test_loads_come_from_a_file_too(program: Program) -> None:
    load = {"supports": [{"at": {"box": [[-1, -1], [0.5, 17]]}, "clamped": True}],
            "forces": [{"at": {"strand": 0, "share": 1}, "force": [0, -0.01, 0]}]}
    (program.folder / "load.json").write_text(json.dumps(load))
    answers = [json.loads(program.ok("--json", "weave", "simulate", *SHEET, *arguments))
               for arguments in (["--load", "load.json"], ["--hold", "-1,-1,0.5,17", "--clamp", "--pull", "0:end=0,-0.01"])]
    assert answers[0]["states"] == answers[1]["states"]


@pytest.mark.parametrize("arguments, code, message", [
    (["layout", "hexagons"], 1, "hexagons"),
    (["layout", "regular", "--sheet", "5"], 1, "5x4"),
    (["layout", "regular", "--slide", "3"], 1, "3:0"),
    (["layout", "regular", "--fuse", "x"], 1, "'x' is no crossing"),
    (["layout", "regular", "--fuse", "9"], 2, "--fuse or --slide names no crossing"),
    (["layout", "squares"], 2, "--type: is required"),
    (["homogenize", "regular", "--obj", "a.obj"], 1, "--deformed"),
    (["homogenize", "regular", "--directions", "all"], 1, "directions"),
    (["homogenize", "regular", "--sheet", "2x2"], 2, "weave.not_periodic"),
    (["deform", "regular"], 1, "--gradient"),
    (["deform", "regular", "-F", "1,0,0"], 1, "rows one after the other"),
    (["deform", "regular", "-F", "1,0,0,-1"], 2, "positive determinant"),
    (["layout", "sample", "--sample", "triangles"], 1, "--sample"),
    (["layout", "sample"], 2, "is required"),
    (["simulate", *SHEET], 1, "nothing holds the sheet"),
    (["simulate", *SHEET, "--hold", "here"], 1, "is no place"),
    (["simulate", *SHEET, "--move", "c1"], 1, "PLACE=x,y"),
    (["simulate", *SHEET, "--hold", "c0", "--obj", "a", "--vtu", "b"], 1, "excludes"),
    (["simulate", *SHEET, "--hold", "c99"], 2, "--hold or --move names no crossing"),
    ([], 1, "needs a command"),
], ids=lambda value: " ".join(value) if isinstance(value, list) else str(value))
def test_what_cannot_be_done_is_said(program: Program, arguments: List[str], code: int, message: str) -> None:
    finished = program.run("weave", *arguments)
    assert (finished.returncode, message in finished.stderr) == (code, True), finished.stderr


def test_python_lays_out_and_overrides(client: supple.Client) -> None:
    fused, sliding = supple.Weave.squares(1), supple.Weave.squares(2)
    laid = client.weave_layout(sliding)
    assert len(laid.strands) == 8 and laid.warnings == () and laid.lattice is not None
    changed = fused
    for index, crossing in enumerate(laid.crossings):
        if crossing.slides:
            changed = changed.slide(index, *[m for m, member in enumerate(crossing.members) if member.slides])
    again = client.weave_layout(changed)
    assert [c.members for c in again.crossings] == [c.members for c in laid.crossings]
    assert not any(c.slides for c in client.weave_layout(changed.fuse(*range(16))).crossings)
    assert client.weave_picture(sliding).startswith(b"<svg")


def test_python_homogenizes(client: supple.Client) -> None:
    seen: List[float] = []
    result = client.weave_homogenization(supple.Weave.regular(pitch=4), directions=[0, np.pi / 4], thickness=0.5, deformed=[1],
                                         progress=lambda fraction, stage: seen.append(fraction))
    assert result.converged and seen[-1] == 1 and result.youngs_modulus_mpa is not None
    assert result.youngs_modulus[0] == pytest.approx(1000 * 3500 * np.pi * 0.0625 / 4, rel=1e-6)
    assert result.youngs_modulus[1] < 0.1 * result.youngs_modulus[0] and result.poisson_ratio[1] > 0.5
    assert result.deformation_gradient.shape == (2, 2, 2) and len(result.cells[0].strands) == 4
    options = supple.WeaveOptions(max_iterations=1)
    lost = client.start_weave_homogenization(supple.Weave.squares(2), strain=0.3, directions=3, options=options).result()
    assert not lost.converged and np.isnan(lost.youngs_modulus[1:]).all()
    with pytest.raises(supple.InvalidWeave) as raised:
        client.weave_homogenization(supple.Weave.rings())
    assert raised.value.code == "weave.not_periodic"


def test_python_and_the_command_line_deform_cells(client: supple.Client, program: Program) -> None:
    weave = supple.Weave.circles(2)
    gradients = np.array([[[1.05, 0.0], [0.02, 1.0]], np.eye(2)])
    result = client.weave_deformation(weave, gradients, deformed=[0])
    assert result.stopped == ("converged", "converged") and result.message == ""
    np.testing.assert_allclose(result.deformation_gradient, gradients, atol=1e-12)
    assert result.energy_density[0] > 0 and np.abs(result.nominal_stress[1]).max() < 1e-6
    assert list(result.cells) == [0] and result.cells[0].lattice.shape == (2, 2)
    alone = client.start_weave_deformation(weave, gradients[0]).result()
    np.testing.assert_array_equal(alone.nominal_stress[0], result.nominal_stress[0])
    with pytest.raises(ValueError, match=r"\(n, 2, 2\)"):
        client.weave_deformation(weave, [1.0, 0.0, 0.0, 1.0])
    shown = program.ok("weave", "deform", "circles", "--type", "2", "-F", "1.05,0,0.02,1", "-F", "1,0,0,1", "--csv", "-",
                       "--obj", "cell.obj").splitlines()
    assert len(shown) == 3 and float(shown[1].split(",")[4]) == pytest.approx(result.nominal_stress[0, 0, 0], rel=1e-6)
    assert (program.folder / "cell-1.obj").read_text().startswith("v ") and (program.folder / "cell-2.obj").exists()
    assert "converged" in program.ok("weave", "deform", "circles", "--type", "2", "-F", "1.05,0,0.02,1")


def test_python_simulates(client: supple.Client) -> None:
    sheet = supple.Weave.regular("fused", sheet=(5, 4))
    supports = [supple.Support(supple.Place.box((-1, -1), (0.5, 17))),
                supple.Support(supple.Place.box((19.5, -1), (21, 17)), displacement=(0.4, 0, 0))]
    result = client.weave_simulation(sheet, supports, states=2, options=supple.WeaveOptions(out_of_plane="off"))
    assert result.converged and len(result.states) == 2 and result.unknowns > 100
    np.testing.assert_allclose(result.resultant(1), -result.resultant(0), atol=1e-6)
    assert result.resultant(1).shape == (2, 3) and result.states[0].strands is not None
    pulled = client.start_weave_simulation(sheet, supports[:1], [supple.Force(supple.Place.strand(0, share=1), (0.1, 0, 0))],
                                           deformed="obj").result()
    assert pulled.states[0].obj is not None and pulled.states[0].strands is None
    own = supple.Weave.layout([supple.Strand([(0, 0), (10, 0)]), supple.Strand([(5, -5), (5, 5)], radius=0.5)])
    assert len(client.weave_layout(own).crossings) == 1


PRINT = ["regular", "--pitch", "10", "--sheet", "3x2", "--slide", "4:1"]


def test_a_sheet_is_printed_to_a_file_that_passes_the_check(program: Program, api: Api) -> None:
    (program.folder / "printer.json").write_text(json.dumps({"strand_speed": 700}))
    text = program.ok("weave", "print", *PRINT, "-o", "sheet.gcode", "--svg", "sheet.svg", "--profile", "printer.json",
                      "--overrun", "6,5", "--overrun-of", "0:8", "--frame", "2,9", "--grip=-4,-6,34,-6,1", "--origin", "80,80")
    assert number_after("channels", text) == 1 and number_after("violations", text) == 0
    ElementTree.parse(program.folder / "sheet.svg")
    gcode = (program.folder / "sheet.gcode").read_text()
    assert "F700" in gcode and program.ok("weave", "print", *PRINT, "-o", "-").startswith(";")
    checked = program.ok("weave", "check", "sheet.gcode")
    assert number_after("lines", checked) == gcode.count("\n") and number_after("violations", checked) == 0
    answer = json.loads(program.ok("--json", "weave", "print", *PRINT))
    api.contract.validate({"$ref": "#/components/schemas/WeaveToolpathResponse"}, answer, "the CLI's output")
    assert "gcode" not in answer


def test_violations_are_listed_with_their_lines_and_fail(program: Program) -> None:
    (program.folder / "bad.gcode").write_bytes(b"; \xe9\nG28\nG1 X10 Y10 Z0.5 F600\nG5 X3\n")
    finished = program.run("weave", "check", "bad.gcode")
    assert finished.returncode == 6 and "violations  1" in finished.stdout
    assert "line 4: unknown_command" in finished.stderr and "1 violation\n" in finished.stderr
    (program.folder / "limits.json").write_text(json.dumps({"travel_speed": 500}))
    assert "line 3: too_fast" in program.run("weave", "check", "bad.gcode", "--limits", "limits.json").stderr
    (program.folder / "own.json").write_text(json.dumps({"startup_gcode": "G5 X3"}))
    finished = program.run("weave", "print", *PRINT, "-o", "own.gcode", "--profile", "own.json")
    assert finished.returncode == 6 and "unknown_command" in finished.stderr and (program.folder / "own.gcode").exists()


@pytest.mark.parametrize("arguments, code, message", [
    (["print", "regular"], 2, "weave.not_printable"),
    (["print", *PRINT, "--overrun", "1,2,3"], 1, "24,0"),
    (["print", *PRINT, "--overrun-of", "4"], 1, "3:24,0"),
    (["print", *PRINT, "--grip", "1,2"], 1, "x,y,x,y"),
    (["print", *PRINT, "--order", "1,2"], 2, "--order: must name each"),
    (["print", *PRINT, "--profile", "none.json"], 5, "none.json"),
    (["check", "none.gcode"], 5, "none.gcode"),
], ids=lambda value: " ".join(value) if isinstance(value, list) else str(value))
def test_what_cannot_be_printed_is_said(program: Program, arguments: List[str], code: int, message: str) -> None:
    finished = program.run("weave", *arguments)
    assert (finished.returncode, message in finished.stderr) == (code, True), finished.stderr


def test_python_prints_and_checks(client: supple.Client) -> None:
    sheet = supple.Weave.regular("fused", pitch=10, sheet=(3, 2)).slide(4, 1)
    options = supple.PrintOptions(origin=(80, 80), overrun=(6, 6), overruns={0: (8, 8)}, frame=(2, 9),
                                  grips=[supple.Grip((-4, -6), (34, -6), 1)])
    path = client.weave_toolpath(sheet, options, printer={"strand_speed": 700}, include=("gcode", "svg", "moves"))
    assert path.check.clean and path.statistics.channels == 1 and path.moves is not None and path.svg is not None
    assert {move.kind for move in path.moves} == {"priming", "strand", "lifted", "channel", "support", "travel"}
    assert all(move.points.shape[1] == 3 for move in path.moves) and path.gcode is not None
    report = client.gcode_report(path.gcode)
    assert report.filament == path.check.filament and report.channels[0].apex[2] == path.check.channels[0].apex[2]
    assert client.start_weave_toolpath(sheet, options, include=()).result().gcode is None
    faulty = client.gcode_report(b"; \xe9\nG28\nG5 X3\n", limits={"cold": 150})
    assert not faulty.clean and faulty.violations == (supple.Violation("unknown_command", 3, faulty.violations[0].message),)
    with pytest.raises(supple.InvalidWeave) as raised:
        client.weave_toolpath(supple.Weave.rings(), supple.PrintOptions(order=[0]))
    assert raised.value.code == "weave.invalid_option"
