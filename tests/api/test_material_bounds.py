"""The nearest profile that any material can have at rest, and Poisson's ratios within 0.02, over HTTP and in the clients."""

from __future__ import annotations

import csv
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any, Dict

import numpy as np
import pytest

import supple
from cli_program import Program
from design_requests import DESIGNS, FEW, known_problem, spline
from harness import Api

SVG = "{http://www.w3.org/2000/svg}"
ANGLES = np.linspace(0, np.pi, 24, endpoint=False)
MIXED_SIGN = 0.5 * np.cos(2 * ANGLES)
"""A Poisson's ratio over direction that is 79 % off for every material at rest."""


def problem_of(task: str, y: Any, **more: Any) -> Dict[str, Any]:
    return {"task": task, "family": "IH29", "strain": 0.02, "target": spline(ANGLES, y), "samples": 24, "accuracy": FEW,
            "effects": {"ways_out": "off"}, **more}


def deviation(y: Any, target: Any) -> float:
    return float(np.sqrt(np.square(np.subtract(y, target)).mean() / np.square(target).mean()))


def rest_profiles(compliance: Any) -> Any:
    """Stiffness and Poisson's ratio of a material, from its compliance."""
    c, s = np.cos(ANGLES), np.sin(ANGLES)
    stress, lateral = np.stack([c * c, s * s, c * s], axis=1), np.stack([s * s, c * c, -c * s], axis=1)
    strain = stress @ compliance
    along = (strain * stress).sum(axis=1)
    return 1 / along, -(strain * lateral).sum(axis=1) / along


def test_a_target_that_no_material_has_says_so_with_the_nearest_profile(designs: Api) -> None:
    answer = designs.ok(DESIGNS, problem_of("poisson", MIXED_SIGN))
    bound = answer["profile"]["bound"]
    assert bound["deviation"] == pytest.approx(0.79, abs=0.002) and bound["together"] is None
    assert bound["deviation"] == pytest.approx(deviation(bound["y"], answer["profile"]["target"]), rel=1e-6)
    assert answer["verdict"]["grade"] in ("missed", "unknown")
    assert answer["verdict"]["bound"] in ("No material at rest comes nearer than 79 % to it.", ""), "a design with strain may be nearer"
    assert (answer["verdict"]["bound"] == "") == (answer["verdict"]["deviation"] < bound["deviation"])


def test_no_random_material_comes_nearer(designs: Api) -> None:
    target = 1 + 0.4 * np.cos(4 * ANGLES)
    bound = designs.ok(DESIGNS, problem_of("stiffness", target))["profile"]["bound"]
    assert bound["deviation"] == pytest.approx(0.0515, abs=0.001)
    rng = np.random.default_rng(1)
    for _ in range(2000):
        factor = rng.normal(size=(3, 3))
        stiffness, _ = rest_profiles(factor @ factor.T)
        scaled = stiffness * (stiffness @ target) / (stiffness @ stiffness)
        assert deviation(scaled, target) >= bound["deviation"] * (1 - 1e-6)


def test_a_possible_target_has_a_bound_of_zero_and_a_stiff_one_that_of_its_solid(designs: Api) -> None:
    isotropic = np.full(24, 0.5)
    possible = designs.ok(DESIGNS, problem_of("poisson", isotropic))
    assert possible["profile"]["bound"]["deviation"] < 1e-6 and possible["verdict"]["bound"] == ""
    stiff = designs.ok(DESIGNS, problem_of("stiffness", np.full(24, 200.0)))
    solid = 26 / (1 - 0.48**2)
    assert stiff["profile"]["bound"]["deviation"] == pytest.approx(1 - solid / 200, rel=1e-4)
    assert stiff["verdict"]["bound"] == "No material at rest comes nearer than 83 % to it."
    free = designs.ok(DESIGNS, problem_of("stiffness", np.full(24, 200.0), material={"youngs_modulus": [20, 5000]}))
    assert free["profile"]["bound"]["deviation"] < 1e-6


def test_several_targets_have_the_bound_of_one_material_too(designs: Api) -> None:
    also = [{name: value for name, value in problem_of("stiffness", np.full(24, 1.0)).items() if name in ("task", "strain", "target", "samples")},
            {"task": "stress_strain", "target": {"control_points": [[0, 0], [0.05, 0.05]]}}]
    answer = designs.ok(DESIGNS, problem_of("poisson", 0.3 + 0.2 * np.cos(4 * ANGLES), also=also))
    poisson, stiffness = answer["profile"]["bound"], answer["also"][0]["bound"]
    assert answer["also"][1]["bound"] is None, "stress over strain has none"
    assert stiffness["deviation"] < 1e-6 < stiffness["together"]["deviation"]
    assert poisson["deviation"] <= poisson["together"]["deviation"] * (1 + 1e-9)
    # One material has both curves: by symmetry of the compliance, nu / E is the same after a quarter turn.
    ratio = np.divide(poisson["together"]["y"], stiffness["together"]["y"])
    assert ratio == pytest.approx(np.roll(ratio, 12), rel=1e-6, abs=1e-9)


def test_the_bound_is_that_of_profiles_near_rest(designs: Api) -> None:
    for strain, has_bound in ((0.05, True), (-0.05, True), (0.06, False)):
        answer = designs.ok(DESIGNS, problem_of("stiffness", np.full(24, 1.0), strain=strain))
        assert (answer["profile"]["bound"] is not None) == has_bound, strain


def test_poissons_ratios_near_0_are_reached_within_2_hundredths(designs: Api) -> None:
    known = known_problem(designs, "poisson", "IH29")
    points = np.array(known["target"]["control_points"])
    shifted = {**known, "target": spline(points[:, 0], points[:, 1] + 0.018), "fixed": designs.ok(DESIGNS, known)["parameters"]}
    answer = designs.ok(DESIGNS, shifted)
    assert answer["reached"] and all(answer["profile"]["reached"]) and answer["verdict"]["grade"] == "reached"
    further = designs.ok(DESIGNS, {**shifted, "target": spline(points[:, 0], points[:, 1] + 0.03)})
    assert not further["reached"] and not any(further["profile"]["reached"])


def test_the_command_line_says_and_draws_the_bound(designs: Api, tmp_path: Path) -> None:
    program = Program(designs.server.url, tmp_path)
    target = ";".join(f"{x:.9g},{y:.9g}" for x, y in zip(ANGLES, np.full(24, 200.0)))
    arguments = ["design", "--task", "stiffness", "--family", "IH29", "--strain", "0.02", "--samples", "24", "--candidates", "8", "--starts", "2",
                 "--ways-out", "off", "--missed-ok", "--target", target, "--csv", "design.csv", "--plot", "design.svg"]
    text = program.ok(*arguments)
    assert text.splitlines()[1] == "No material at rest comes nearer than 83 % to it."
    texts = {element.text for element in ElementTree.parse(tmp_path / "design.svg").getroot().iter(SVG + "text")}
    assert "nearest that any material can have at rest" in texts
    with (tmp_path / "design.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["bound"]) for row in rows] == pytest.approx([26 / (1 - 0.48**2)] * 24, rel=1e-3)


def test_python_has_the_bound(designs: Api) -> None:
    with supple.Client(designs.server.url) as client:
        target = supple.Target("stiffness", np.column_stack([ANGLES, np.full(24, 200.0)]), strain=0.02, samples=24)
        found = client.design(target, family="IH29", options=supple.DesignOptions(**FEW, ways_out="off"))  # type: ignore[arg-type]
    assert isinstance(found, supple.DesignResult)
    assert found.profile.bound is not None and found.profile.bound.y.shape == (24,)
    assert found.verdict.bound == "No material at rest comes nearer than 83 % to it."
