"""Designs and profiles with the command line client and with the Python package."""

from __future__ import annotations

import csv
import json
import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Iterator, List, Tuple

import numpy as np
import pytest

import supple
from cli_program import Program, number_after
from contract import ROOT
from design_requests import FEW, KNOWN, known_problem, long_request, profile
from harness import Api

QUICK = ["--candidates", "8", "--starts", "2"]
FAMILY = ["design", "--task", "stress_strain", "--family", "IH29", *QUICK]
IH29 = [*FAMILY, "--missed-ok"]
TARGET = ["--target", "0.01,0.01;0.03,0.03"]
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture
def program(designs: Api, tmp_path: Path) -> Program:
    return Program(designs.server.url, tmp_path)


@pytest.fixture
def client(designs: Api) -> Iterator[supple.Client]:
    with supple.Client(designs.server.url) as opened:
        yield opened


def known_target(api: Api, task: str = "stress_strain", family: str = "IH29") -> supple.Target:
    problem = known_problem(api, task, family)
    return supple.Target(task, problem["target"]["control_points"], direction=problem.get("direction"),
                         strain=problem.get("strain"), interpolation="linear", samples=problem["samples"])


def options() -> supple.DesignOptions:
    return supple.DesignOptions(**FEW)  # type: ignore[arg-type]


# --- the command line ----------------------------------------------------------------------------------------------------


def test_a_design_is_shown_and_written_as_csv_and_plot(program: Program, designs: Api) -> None:
    text = program.ok(*IH29, *TARGET, "--samples", "4", "--csv", "design.csv", "--plot", "design.svg")
    assert "IH29" in text and "ih29" in text and number_after("deviation", text) >= 0
    answer = json.loads(program.ok("--json", *IH29, *TARGET, "--samples", "4"))
    designs.contract.validate({"$ref": "#/components/schemas/DesignResponse"}, answer, "the CLI's output")
    assert number_after("deviation", text) == pytest.approx(100 * answer["error"]["relative_rms"], rel=1e-2)
    with (program.folder / "design.csv").open() as file:
        rows = list(csv.DictReader(file))
    for name in ("x", "target", "achieved"):
        assert [float(row[name]) for row in rows] == answer["profile"][name]
    assert [float(row["upper"]) for row in rows] == answer["profile"]["envelope"]["upper"]
    assert {row["verified"] for row in rows} == {""}
    assert program.ok(*IH29, *TARGET, "--samples", "4", "--csv", "-") == (program.folder / "design.csv").read_text()
    plot = ElementTree.parse(program.folder / "design.svg").getroot()
    texts = {element.text for element in plot.iter(SVG + "text")}
    assert {"target", "achieved", "initial", "within reach", "Green strain"} <= texts
    assert any("MPa" in (entry or "") for entry in texts)


def test_the_structure_found_is_written(program: Program) -> None:
    program.ok(*IH29, *TARGET, "--svg", "structure.svg")
    ElementTree.parse(program.folder / "structure.svg")


def test_targets_come_from_files_with_weights_and_bands(program: Program) -> None:
    (program.folder / "target.csv").write_text("strain, stress, weight, band\n0.01, 0.01, 1, 0.001\n0.03, 0.03, 2, 0.002\n")
    answers = [json.loads(program.ok("--json", *IH29, *target)) for target in (
        ["--target-points", "target.csv"], ["--target", "0.01,0.01,1,0.001;0.03,0.03,2,0.002"])]
    assert answers[0]["profile"] == answers[1]["profile"]
    plain = json.loads(program.ok("--json", *IH29, *TARGET))
    assert plain["error"] != answers[0]["error"] or plain["parameters"] != answers[0]["parameters"]


def test_every_option_reaches_the_server(program: Program) -> None:
    answer = json.loads(program.ok(
        "--json", "design", "--task", "poisson", "--model", "ih67", "--target", "0,0.1;1,0.3", "--strain", "0.03",
        "--strain-measure", "engineering", "--interpolation", "monotone", "--samples", "6", "--initial", "0.2,0.9",
        "--fixed", "0.2,free", "--tolerance", "1e-5", "--equilibrium-tolerance", "1e-9", "--max-iterations", "7",
        "--multi-start", "off", "--envelope", "on", "--trust", "off", "--candidates", "4", "--session", "s", "--deadline", "100", "--missed-ok",
        "--beam-width-sensitivity", "on"))
    main = answer["profile"]
    assert (main["task"], main["strain"], main["strain_measure"], len(main["x"])) == ("poisson", 0.03, "engineering", 6)
    assert answer["parameters"][0] == 0.2 and answer["model"] == "ih67" and answer["starts"] == 1
    assert answer["accuracy"]["tolerance"] == 1e-5 and answer["accuracy"]["equilibrium_tolerance"] == 1e-9
    assert main["envelope"] is not None and answer["iterations"] <= 7 and main["beam_width_sensitivity"] is not None
    (trust,) = [effect for effect in answer["effects"] if effect["name"] == "trust"]
    assert not trust["ran"] and "turns it off" in trust["why"]


def test_regions_come_from_a_file_and_are_drawn_side_by_side(program: Program) -> None:
    problem = {"task": "stress_strain", "family": "IH29", "target": {"control_points": [[0.01, 0.01], [0.03, 0.03]]}}
    also = [{"task": "poisson", "target": {"control_points": [[0, 0.1], [1, 0.3]]}}]
    regions = [{**problem, "name": "heel <1>"}, {**problem, "name": "toe", "also": also}]
    (program.folder / "sole.json").write_text(json.dumps({"regions": regions}))
    text = program.ok("design", "--regions", "sole.json", *QUICK, "--missed-ok", "--plot", "sole.svg", "--csv", "sole.csv")
    assert "heel <1>" in text and "toe" in text
    with (program.folder / "sole.csv").open() as file:
        places = {(row["region"], row["profile"], row["task"]) for row in csv.DictReader(file)}
    assert places == {("0", "0", "stress_strain"), ("1", "0", "stress_strain"), ("1", "1", "poisson")}
    titles = [element.text or "" for element in ElementTree.parse(program.folder / "sole.svg").iter(SVG + "text")]
    assert any("heel <1>" in title for title in titles) and "\u03c0/2" in titles


def test_materials_sizes_and_limits_go_with_a_design(program: Program) -> None:
    small = ["design", "--task", "stiffness", "--family", "IH29", *QUICK, "--missed-ok", "--samples", "6", "--target", "0,4;1,5;2,4"]
    text = program.ok(*small, "--youngs-modulus", "200,4000", "--density", "1.25", "--beam-width", "0.6")
    answer = json.loads(program.ok("--json", *small, "--youngs-modulus", "200,4000", "--density", "1.25", "--beam-width", "0.6"))
    assert 200 <= answer["material"]["youngs_modulus"] <= 4000 and answer["material"]["density"] == 1.25
    assert number_after("material", text) == pytest.approx(answer["material"]["youngs_modulus"], rel=1e-4)
    assert number_after("beams of", text) == 0.6
    assert number_after("cells of", text) == pytest.approx(answer["structure"]["cell_size"], rel=1e-3)
    limited = json.loads(program.ok("--json", *small, "--youngs-modulus", "500", "--cell-size", "4", "--relative-density",
                                    "0.1,0.15", "--beam-width-limits", "0.1,0.3"))
    assert limited["material"]["youngs_modulus"] == 500
    assert 0.1 <= limited["structure"]["relative_density"] <= 0.15
    assert limited["structure"]["cell_size"] == pytest.approx(4) and limited["structure"]["beam_width"] <= 0.3
    turned = json.loads(program.ok("--json", *small, "--orientation", "10deg,100deg"))
    assert np.radians(10) <= turned["orientation"] <= np.radians(100)
    assert json.loads(program.ok("--json", *small, "--orientation", "45deg"))["orientation"] == pytest.approx(np.pi / 4)
    refused = program.run(*small, "--relative-density", "0.3,0.1")
    assert refused.returncode == 1 and "--relative-density 0.3,0.1" in refused.stderr
    nothing = program.run(*small, "--relative-density", "0,0.01")
    assert nothing.returncode != 0 and "relative density" in nothing.stderr


def test_a_profile_and_a_structure_have_the_material_and_the_size_that_are_given(program: Program) -> None:
    command = ["--json", "profile", "--task", "stiffness", "--family", "IH29", "--parameters", "0.15", "-x", "0,1"]
    soft, stiff = (json.loads(program.ok(*command, *more)) for more in ([], ["--youngs-modulus", "52"]))
    np.testing.assert_allclose(stiff["y"], 2 * np.array(soft["y"]), rtol=1e-12)
    turned = json.loads(program.ok(*command, "--orientation", "1"))
    assert turned["orientation"] == 1 and turned["y"][1] == pytest.approx(soft["y"][0], rel=1e-9)
    structure = json.loads(program.ok("--json", "structure", "IH29", "--beam-width", "0.6"))
    assert structure["beam_width"] == 0.6


def test_a_design_begins_with_the_verdict_in_words(program: Program) -> None:
    answer = json.loads(program.ok("--json", *IH29, *TARGET))
    assert program.ok(*IH29, *TARGET).splitlines()[0] == answer["verdict"]["sentence"]


def test_the_exit_status_tells_a_missed_target_from_a_reached_one(program: Program, designs: Api) -> None:
    missed = ["--target", "0.01,100;0.03,300"]
    finished = program.run(*FAMILY, *missed)
    assert finished.returncode == 7, finished.stderr
    verdict = json.loads(program.run("--json", *FAMILY, *missed).stdout)["verdict"]
    assert verdict["grade"] in ("missed", "unknown")
    assert verdict["sentence"] in finished.stdout and verdict["sentence"] in finished.stderr and "--missed-ok" in finished.stderr
    allowed = program.run(*FAMILY, *missed, "--missed-ok")
    assert allowed.returncode == 0 and verdict["sentence"] in allowed.stdout and "--missed-ok" not in allowed.stderr
    (program.folder / "known.json").write_text(json.dumps(known_problem(designs)))
    reached = program.run("--json", "design", "--request", "known.json")
    assert reached.returncode == 0, reached.stderr
    assert json.loads(reached.stdout)["verdict"]["grade"] in ("reached", "close")


def test_the_exit_status_counts_every_region(program: Program, designs: Api) -> None:
    known = {name: value for name, value in known_problem(designs).items() if name != "accuracy"}
    far = {"task": "stress_strain", "family": "IH29", "name": "heel", "target": {"control_points": [[0.01, 100], [0.03, 300]]}}
    (program.folder / "sole.json").write_text(json.dumps({"regions": [{**known, "name": "toe"}, far]}))
    finished = program.run("design", "--regions", "sole.json", "--candidates", "24", "--starts", "3")
    assert finished.returncode == 7 and "heel: " in finished.stderr and "toe: " not in finished.stderr


def test_what_is_printed_about_several_regions_follows_the_worst_one(program: Program, designs: Api) -> None:
    known = {name: value for name, value in known_problem(designs).items() if name != "accuracy"}
    far = {"task": "stress_strain", "family": "IH29", "target": {"control_points": [[0.01, 100], [0.03, 300]]}}
    regions = {"sole": [{**known, "name": "toe"}, {**far, "name": "heel"}], "unnamed": [far, known, known]}
    for name, shown, count in (("sole", "heel", 2), ("unnamed", "region 1", 3)):
        (program.folder / f"{name}.json").write_text(json.dumps({"regions": regions[name]}))
        finished = program.run("design", "--regions", f"{name}.json", "--candidates", "24", "--starts", "3")
        sentence = f"worst of {count} regions is {shown}: "
        assert finished.stdout.startswith("The " + sentence), finished.stdout
        assert sentence in finished.stderr and finished.returncode == 7, finished.stderr


def test_what_the_model_says_is_marked_and_the_simulation_outranks_it(program: Program) -> None:
    few = ["design", "--task", "stress_strain", "--family", "IH67", *QUICK, "--missed-ok", "--samples", "3", "--ways-out", "off",
           "--target", "0,0;0.02,0.01;0.04,0.02"]
    text = program.ok(*few)
    assert "by the model: nothing was simulated" in text and "model reaches" in text and "simulation reaches" not in text
    answer = json.loads(program.ok("--json", *few, "--verify", "--polish-rounds", "2"))
    text = program.ok(*few, "--verify", "--polish-rounds", "2", "--plot", "plot.svg")
    assert "ranking     by the simulation" in text and "simulation reaches" in text and "model reaches" in text
    simulated = f"{100 * answer['ranking'][0]['simulated_error']:.3g} %"
    (ranked,) = [line for line in text.splitlines() if line.lstrip().startswith("1  IH67")]
    by_model = f"{100 * answer['ranking'][0]['error']['relative_rms']:.3g} %"
    assert ranked.index(simulated) <= ranked.rindex(by_model)
    titles = [element.text or "" for element in ElementTree.parse(program.folder / "plot.svg").iter(SVG + "text")]
    assert any(", simulated off by " in title for title in titles)


def test_each_round_of_polishing_is_printed_with_its_deviation_and_time(program: Program) -> None:
    polished = ["design", "--task", "stress_strain", "--family", "IH67", *QUICK, "--missed-ok", "--samples", "3", "--ways-out", "off",
                "--target", "0,0;0.02,0.01;0.04,0.02", "--verify", "--polish-rounds", "2", "--polish-tolerance", "1e-4"]
    rounds = json.loads(program.ok("--json", *polished))["polish"]["rounds"]
    lines = program.ok(*polished).splitlines()
    heading = next(i for i, line in enumerate(lines) if line.split()[:3] == ["round", "simulation", "seconds"])
    assert len(rounds) > 1
    for number, entry in enumerate(rounds):
        shown = lines[heading + 1 + number].split()
        assert shown[0] == str(number) and shown[1] == f"{100 * entry['target_error']:.3g}" and float(shown[3]) >= 0
        assert ("yes" in shown) == entry["accepted"]


PART = ["design", "--task", "stress_strain", "--family", "IH67", "--direction", "30deg", "--starts", "1", "--candidates", "24", "--missed-ok",
        "--target", "0,0;5%,100kPa;0.1,0.2MPa"]


def test_the_part_of_a_design_is_made_in_one_command(program: Program) -> None:
    (program.folder / "design.json").write_text(program.ok("--json", *PART, "--part", "coupon:24mmx3cm", "--stl", "a.stl", "--svg", "a.svg"))
    program.ok("part", "--from", "design.json", "--coupon", "24x30", "--stl", "b.stl", "--svg", "b.svg")
    assert (program.folder / "a.stl").read_bytes() == (program.folder / "b.stl").read_bytes()
    assert (program.folder / "a.svg").read_text() == (program.folder / "b.svg").read_text()
    design = json.loads((program.folder / "design.json").read_text())
    part = json.loads(program.ok("--json", "part", "--from", "design.json", "--coupon", "24x30"))
    assert part["tested_direction"] == pytest.approx(np.pi / 6) == design["profile"]["direction"]
    assert part["orientation"] == pytest.approx(design["orientation"] + np.pi / 2 - np.pi / 6)
    text = program.ok(*PART, "--part", "block:24x20", "--thickness", "2mm", "--3mf", "block.3mf", "--step", "block.step", "--dxf", "block.dxf")
    assert "30 degrees" in text and re.search(r"size +24 x [\d.]+ x 2 mm", text)
    assert (program.folder / "block.3mf").read_bytes()[:2] == b"PK" and "ISO-10303-21" in (program.folder / "block.step").read_text()
    sheet = json.loads(program.ok("--json", "part", "--from", "design.json", "--rectangle", "24x30"))
    assert sheet["tested_direction"] is None
    loaded = json.loads(program.ok("--json", "part", "--from", "design.json", "--rectangle", "24x30", "--axis", "60deg"))
    assert loaded["tested_direction"] == pytest.approx(np.pi / 6) and loaded["orientation"] == pytest.approx(design["orientation"] + np.pi / 6)
    # A direction in a request belongs to the structure that the design replaces.
    (program.folder / "coupon.json").write_text(json.dumps({"outline": {"coupon": {"width": 24, "length": 30}}, "direction": 1.1}))
    replaced = json.loads(program.ok("--json", "part", "--request", "coupon.json", "--from", "design.json"))
    assert replaced["tested_direction"] == pytest.approx(np.pi / 6)
    refused = program.run("part", "--from", "design.json", "--rectangle", "24x30", "--direction", "30deg")
    assert refused.returncode == 2 and "axis of load" in refused.stderr


@pytest.mark.parametrize("arguments, message", [
    (["--part", "triangle:3x4"], "--part: 'triangle:3x4' is no part"),
    (["--part", "coupon"], "coupon:20x60"),
    (["--part", "coupon:24"], "--part: '24' is no size"),
    (["--part", "coupon:24MPax30"], "--part: '24MPa' is no length but a stress"),
    (["--stl", "a.stl"], "--part"),
    (["--thickness", "2"], "--part"),
])
def test_a_part_that_means_nothing_is_refused_before_anything_is_computed(program: Program, arguments: List[str], message: str) -> None:
    refused = program.run("--server", "http://127.0.0.1:1", *PART, *arguments)
    assert refused.returncode == 1 and message in refused.stderr, refused.stderr


def test_the_direction_of_a_part_is_never_guessed_in_silence(program: Program) -> None:
    over = program.run("design", "--task", "poisson", "--family", "IH67", "--starts", "1", "--candidates", "24", "--missed-ok",
                       "--target", "0,0.1;1,0.3", "--part", "coupon:24x30")
    assert over.returncode == 0 and "no single direction of load: the part is loaded along its direction 90deg" in over.stderr, over.stderr
    design = json.loads(program.ok("--json", *PART))
    (program.folder / "design.json").write_text(json.dumps(design))
    assert "no single direction" not in program.run("part", "--from", "design.json", "--coupon", "24x30").stderr
    del design["profile"]["direction"]
    (program.folder / "design.json").write_text(json.dumps(design))
    refused = program.run("part", "--from", "design.json", "--coupon", "24x30")
    assert refused.returncode == 5 and "design.json lacks the direction of its load" in refused.stderr and "--direction" in refused.stderr
    refused = program.run("part", "--from", "design.json", "--rectangle", "24x30", "--axis", "60deg")
    assert refused.returncode == 5 and "lacks the direction of its load" in refused.stderr
    chosen = json.loads(program.ok("--json", "part", "--from", "design.json", "--coupon", "24x30", "--direction", "30deg"))
    assert chosen["tested_direction"] == pytest.approx(np.pi / 6)
    (program.folder / "sole.json").write_text(json.dumps({"regions": [design, design]}))
    assert "several regions" in program.run("part", "--from", "sole.json", "--coupon", "24x30").stderr


def test_a_profile_is_shown_drawn_and_written_as_csv(program: Program, designs: Api) -> None:
    common = ["profile", "--family", "IH67", "--parameters", "0.22,0.85"]
    text = program.ok(*common, "--task", "stress_strain", "-d", "0.3", "-x", "-0.05:0.05:5", "--csv", "p.csv", "--plot", "p.svg")
    expected = profile(designs, "stress_strain", np.linspace(-0.05, 0.05, 5).tolist(), direction=0.3)
    assert text.count(" yes") == 5 and "ih67" in text
    with (program.folder / "p.csv").open() as file:
        np.testing.assert_allclose([float(row["y"]) for row in csv.DictReader(file)], expected["y"], rtol=1e-9, atol=1e-15)
    answer = json.loads(program.ok("--json", *common, "--task", "stiffness", "--strain", "0.02", "--samples", "12"))
    designs.contract.validate({"$ref": "#/components/schemas/ProfileResponse"}, answer, "the CLI's output")
    assert len(answer["y"]) == 12 and answer["strain"] == 0.02
    drawing = ElementTree.fromstring(program.ok(*common, "--task", "poisson", "--plot", "-"))
    assert drawing.tag == SVG + "svg" and "nan" not in ElementTree.tostring(drawing, "unicode").lower()


def test_a_uniaxial_load_may_be_along_a_direction_of_the_material(program: Program, designs: Api) -> None:
    load = ["simulate", "IH21", "--uniaxial", "0.5", "--stretches", "1.02", "--mesh-size", "1", "--no-tangents"]
    states = {frame: json.loads(program.ok("--json", *load, *more))["states"][0] for frame, more in {
        "default": [], "space": ["--frame", "space"], "material": ["--frame", "material"]}.items()}
    assert states["default"] == states["space"]
    d = np.array([np.cos(0.5), np.sin(0.5)])
    stretched = np.array(states["material"]["deformation_gradient"]) @ d
    np.testing.assert_allclose(stretched, 1.02 * d, atol=1e-9)


@pytest.mark.parametrize("arguments, code, message", [
    (["design"], 1, "no problem"),
    (["design", "--task", "stress_strain"], 1, "no problem"),
    ([*IH29, "--target", "0,0;1"], 1, "no control point"),
    ([*IH29, "--target", "0,0;1,1,1"], 1, "as many numbers"),
    ([*IH29, "--target", "0,0;0,1"], 2, "--target at index 1"),
    ([*IH29, *TARGET, "--task", "shear"], 1, "task"),
    ([*IH29, *TARGET, "--model", "ih29"], 1, "excludes"),
    ([*IH29, *TARGET, "--fixed", "a,free"], 1, "free"),
    ([*IH29, *TARGET, "--initial", "9"], 2, "--initial at index 0"),
    ([*IH29, *TARGET, "--initial-orientation", "1"], 1, "--initial"),
    ([*IH29, *TARGET, "--initial", "0.1", "--orientation", "0,1", "--initial-orientation", "2"], 2, "--initial-orientation"),
    ([*IH29, *TARGET, "--strain", "x"], 1, "strain"),
    (["design", "--task", "poisson", "--family", "IH99", *TARGET], 2, "design.no_model"),
    (["design", "--request", "no-such.json"], 5, "no-such.json"),
    ([*IH29, *TARGET, "--plot", "no/such/folder.svg"], 5, "no/such/folder.svg"),
    (["profile", "--task", "poisson", "--parameters", "0.1"], 1, "--family"),
    (["profile", "--family", "IH29", "--parameters", "0.1"], 1, "--task"),
    (["profile", "--task", "poisson", "--family", "IH29", "--parameters", "0.1,0.2"], 2, "--parameters"),
    (["profile", "--task", "poisson", "--family", "IH29", "--parameters", "0.1", "-x", "1:2"], 1, "first:last:n"),
    (["simulate", "IH21", "--green-strain", "0,0,0", "--frame", "material"], 1, "--uniaxial"),
])
def test_a_failure_has_its_exit_code_and_one_clear_message(
        program: Program, arguments: List[str], code: int, message: str) -> None:
    finished = program.run(*arguments)
    assert finished.returncode == code, finished.stderr
    assert message in finished.stderr


def test_a_file_that_is_no_request_is_said(program: Program) -> None:
    for content in ("[1]", "{", '{"accuracy": 1}'):
        (program.folder / "request.json").write_text(content)
        finished = program.run("design", "--request", "request.json")
        assert finished.returncode == 5 and "request.json" in finished.stderr, finished.stderr


# --- Python --------------------------------------------------------------------------------------------------------------


def test_python_finds_a_known_design(client: supple.Client, designs: Api) -> None:
    seen: List[Tuple[float, str]] = []
    result = client.design(known_target(designs), family="IH29", options=options(),
                           progress=lambda fraction, stage: seen.append((fraction, stage)))
    np.testing.assert_allclose(result.parameters, KNOWN["IH29"], atol=1e-3)
    assert result.reached and result.model == "ih29" and result.error.relative_rms < 1e-4 and seen[-1][0] == 1
    assert result.profile.x.shape == result.profile.achieved.shape == (9,) and result.profile.reached.all()
    assert result.profile.lower is not None and (result.profile.lower <= result.profile.achieved).all()
    assert result.profile.verified is None and result.profile.strain is None and result.profile.direction == 0.3
    assert {effect.name for effect in result.effects} == {
        "trust", "multi_start", "envelope", "modulus", "orientation", "limits", "verification", "polish", "beam_width_sensitivity",
        "ways_out"}
    assert result.polish is None and result.residual <= result.equilibrium_tolerance and result.cost.quantities["evaluations"] > 0


def test_python_gives_materials_sizes_and_limits(client: supple.Client) -> None:
    target = supple.Target("stiffness", [(0, 4), (1, 5), (2, 4)], samples=6)
    found = client.design(target, family="IH29", options=options(), cell_size=4.0, limits=supple.Limits((0.1, 0.15)),
                          material=[supple.Material(26, name="soft"), supple.Material((200, 4000), 1.25, "hard")])
    assert found.material.name == "hard" and 200 <= found.material.youngs_modulus <= 4000
    assert found.size.cell_size == pytest.approx(4) and 0.1 <= (found.size.relative_density or 0) <= 0.15
    assert found.size.density == pytest.approx(1.25 * (found.size.relative_density or 0))
    again = client.profile("stiffness", found.parameters.tolist(), family="IH29", x=found.profile.x,
                           material=supple.Material(found.material.youngs_modulus))
    np.testing.assert_allclose(again.y, found.profile.achieved, rtol=1e-6)
    turned = client.design(target, family="IH29", options=options(), orientation=(0.0, 1.0))
    assert 0 <= turned.orientation <= 1 and turned.ranking[0].orientation == turned.orientation
    picture = client.structure_file("IH29", found.parameters.tolist(), beam_width=found.size.beam_width)
    assert picture != client.structure_file("IH29", found.parameters.tolist())
    assert client.structure("IH29", found.parameters.tolist(), beam_width=0.6).beam_width == 0.6
    with pytest.raises(supple.InvalidDesign, match="Poisson"):
        client.design(target, family="IH29", material=supple.Material(poisson_ratio=0.1))


def test_python_ranks_families_and_holds_parameters(client: supple.Client, designs: Api) -> None:
    ranked = client.design(known_target(designs, "poisson"), options=options())
    assert [candidate.family for candidate in ranked.ranking] == ["IH29", "IH67"]
    held = client.design(known_target(designs, family="IH67"), family="IH67", fixed=[0.25, None], options=options(),
                         also=[known_target(designs, "poisson", "IH67")])
    assert held.parameters[0] == 0.25 and not held.reached and held.message and len(held.also) == 1


def test_python_designs_regions(client: supple.Client, designs: Api) -> None:
    target = known_target(designs)
    found = client.design_regions([supple.Region(target, name="heel", family="IH29"),
                                   supple.Region(target, name="toe", model="ih29", initial=[0.1])], options=options())
    assert [region.name for region in found.regions] == ["heel", "toe"]
    alone = client.design(target, family="IH29", options=options())
    np.testing.assert_array_equal(found.regions[0].parameters, alone.parameters)
    assert len(client.start_design_regions([supple.Region(target, family="IH29")], options=options())
               .result(timeout=60).regions) == 1


def test_python_shows_the_best_design_so_far(client: supple.Client) -> None:
    request = long_request()
    job = client.start_design(supple.Target("stiffness", request["target"]["control_points"], samples=500), family="IH67",
                              options=supple.DesignOptions(starts=64, max_iterations=1000, tolerance=1e-12, multi_start="on"))
    end = time.monotonic() + 60
    while job.status().partial is None:
        assert time.monotonic() < end and not job.status().finished
        time.sleep(0.05)
    best = job.status().partial
    assert best is not None and best.family == "IH67" and best.x.shape == best.achieved.shape and 2 <= len(best.x) <= 500
    assert best.parameters.shape == (2,) and best.error.relative_rms >= 0
    job.cancel()
    with pytest.raises(supple.JobCancelled):
        job.result(timeout=60)


def test_python_says_that_a_newer_request_took_the_place(client: supple.Client, designs: Api) -> None:
    request = long_request()
    older = client.start_design(supple.Target("stiffness", request["target"]["control_points"], samples=500), family="IH67",
                                options=supple.DesignOptions(starts=64, tolerance=1e-12, multi_start="on"), session="py")
    client.design(known_target(designs), family="IH29", options=options(), session="py")
    with pytest.raises(supple.Superseded):
        older.result(timeout=60)


def test_python_evaluates_profiles(client: supple.Client) -> None:
    curve = client.profile("stress_strain", [0.15], family="IH29", direction=0.2, x=[0.05, -0.02])
    assert curve.y.shape == (2,) and curve.y[1] < 0 < curve.y[0] and curve.in_range.all() and curve.strain is None
    ratio = client.start_profile("poisson", [0.15], model="ih29", samples=8).result(timeout=60)
    assert ratio.x.shape == (8,) and ratio.strain == 0.05 and ratio.direction is None
    assert client.profile("stress_strain", [0.15], family="IH29", limits=(0, 0.1), samples=3).x.tolist() == [0, 0.05, 0.1]


def test_python_raises_what_a_faulty_problem_deserves(client: supple.Client) -> None:
    with pytest.raises(supple.InvalidDesign) as error:
        client.design(supple.Target("poisson", [(0, 0), (4, 1)]))
    assert error.value.faults[0].where == "/target/control_points/1/0"
    with pytest.raises(supple.InvalidDesign, match="IH99"):
        client.profile("poisson", [0.1], family="IH99")


def test_the_example_prints_a_design(designs: Api, tmp_path: Path) -> None:
    finished = subprocess.run(
        [sys.executable, str(ROOT / "clients" / "python" / "examples" / "inverse_design.py"), "IH29", str(tmp_path / "s.svg")],
        env={**os.environ, "SUPPLE_SERVER": designs.server.url, "PYTHONPATH": str(ROOT / "clients" / "python")},
        capture_output=True, text=True, timeout=120, check=False)
    assert finished.returncode == 0, finished.stderr
    assert "IH29" in finished.stdout and "deviation" in finished.stdout
    ElementTree.parse(tmp_path / "s.svg")
