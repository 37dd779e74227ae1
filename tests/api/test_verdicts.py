"""The verdict on a design over HTTP: what decides, which grade it is, and which ranges of the target are reached."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any, Callable, Dict

import numpy as np
import pytest

from contract import ROOT, Contract
from design_requests import DESIGNS, FEW, known_problem, profile, spline
from harness import Api, ServerProcess

WORDS = json.loads((ROOT / "api" / "verdicts.json").read_text(encoding="utf-8"))["words"]


def grade(deviation: float) -> str:
    return "reached" if deviation <= 0.05 else "close" if deviation <= 0.15 else "missed"


def scale(target: Any) -> float:
    """The root mean square of a target whose samples have equal weights."""
    return float(np.sqrt(np.square(target).mean()))


def check_ranges(shown: Dict[str, Any]) -> None:
    """The ranges are contiguous, cover the target and agree with the samples from which they are made."""
    ranges, verified = shown["ranges"], shown["verified"]
    x, target, values = ((verified["x"], verified["target"], verified["y"]) if verified else
                         (shown["x"], shown["target"], shown["achieved"]))
    assert ranges[0]["from"] == x[0]
    assert ranges[-1]["to"] == pytest.approx(x[-1] if shown["task"] == "stress_strain" else x[0] + np.pi)
    assert [one["to"] for one in ranges[:-1]] == [one["from"] for one in ranges[1:]]
    off = np.abs(np.subtract(values, target))
    tolerance = max(0.01 * scale(target), 0.02 if shown["task"] == "poisson" else 0)
    for one in ranges:
        inside = [abs(d) for place, d in zip(x, off) if one["from"] <= place <= one["to"]]
        if one["reached"]:
            assert max(inside) <= tolerance * (1 + 1e-9)
        else:
            assert max(inside) > tolerance
            assert one["deviation"] > 0


@pytest.mark.parametrize("task, family", [("stress_strain", "IH67"), ("stiffness", "IH29"), ("poisson", "IH29")])
def test_a_known_design_is_reached_by_the_model(designs: Api, task: str, family: str) -> None:
    answer = designs.ok(DESIGNS, known_problem(designs, task, family))
    verdict = answer["verdict"]
    assert (verdict["grade"], verdict["source"]) == ("reached", "model")
    assert verdict["deviation"] == pytest.approx(answer["error"]["relative_rms"], abs=1e-12)
    assert verdict["sentence"].startswith(WORDS["source"]["model"] + ": reached, ")
    check_ranges(answer["profile"])
    assert [one["reached"] for one in answer["profile"]["ranges"]] == [True]


def test_a_target_that_no_design_reaches_is_missed_with_its_ranges(designs: Api) -> None:
    problem = known_problem(designs)
    (low, _), *_, (high, _) = problem["target"]["control_points"]
    known = np.array(problem["target"]["control_points"])
    known[known[:, 0] > 0, 1] *= 4
    answer = designs.ok(DESIGNS, {**problem, "target": spline(known[:, 0], known[:, 1]), "fixed": [0.22, 0.85]})
    verdict, ranges = answer["verdict"], answer["profile"]["ranges"]
    assert (verdict["grade"], verdict["source"]) == ("missed", "model")
    assert verdict["deviation"] == pytest.approx(answer["error"]["relative_rms"]) and verdict["deviation"] > 0.15
    check_ranges(answer["profile"])
    assert (ranges[0]["from"], ranges[0]["reached"]) == (low, True), "compression is what the design does"
    assert ranges[-1]["to"] == pytest.approx(high) and not ranges[-1]["reached"]
    assert "is reached" in verdict["sentence"] and "is missed" in verdict["sentence"] and "from -8 to " in verdict["sentence"]


def test_the_simulation_decides_where_there_is_one(designs: Api) -> None:
    x = np.linspace(0.01, 0.03, 3)
    y = profile(designs, "stress_strain", x.tolist(), "IH29", direction=0.0)["y"]
    request = {"task": "stress_strain", "family": "IH29", "target": spline(x, y), "samples": 3, "accuracy": FEW}
    by_model = designs.ok(DESIGNS, request)["verdict"]
    answer = designs.ok(DESIGNS, {**request, "verify": True, "effects": {"polish": "off"}})
    verdict, verified = answer["verdict"], answer["profile"]["verified"]
    assert (by_model["source"], verdict["source"]) == ("model", "simulation")
    assert by_model["deviation"] < 1e-4 < verdict["deviation"]
    assert verdict["deviation"] == pytest.approx(verified["target_error"])
    assert verdict["grade"] == grade(verified["target_error"])
    assert verdict["sentence"].startswith(WORDS["source"]["simulation"] + ": ")
    check_ranges(answer["profile"])


def test_a_simulation_that_is_far_off_is_never_called_reached_or_close(
        new_server: Callable[..., ServerProcess], contract: Contract, tmp_path: Path) -> None:
    """A foam's compression that the model of IH01 meets within 1 %, and that its simulation misses by more than half, where nobody asks whether the model is trusted."""
    (tmp_path / "models").mkdir()
    shutil.copy(ROOT / "models" / "ih01.h5", tmp_path / "models")
    designs = Api(new_server("--models", str(tmp_path / "models")), contract)
    points = [[-0.2, -0.68], [-0.16, -0.4672], [-0.12, -0.2928], [-0.09, -0.1872], [-0.06, -0.1032], [-0.03, -0.0408], [0, 0]]
    answer = designs.ok(DESIGNS, {"task": "stress_strain", "family": "IH01", "direction": 0,
                                  "target": {"control_points": points}, "verify": True, "effects": {"polish": "off", "trust": "off"}})
    assert answer["error"]["relative_rms"] < 0.05, "the model alone would call it reached"
    verdict = answer["verdict"]
    target_error = answer["profile"]["verified"]["target_error"]
    assert verdict["source"] == "simulation" and verdict["deviation"] == target_error
    assert verdict["grade"] == ("unknown" if target_error is None else "missed")
    assert verdict["sentence"].startswith("Simulated: ") and "reached, " not in verdict["sentence"]
    assert answer["message"].startswith("The simulat"), "the message is about the simulation too"


def test_a_model_that_is_not_trusted_does_not_decide(designs: Api) -> None:
    request = {"task": "stress_strain", "family": "IH67", "target": spline([1.5, 2], [1, 2]), "samples": 4,
               "fixed": [0.22, 0.85]}
    answer = designs.ok(DESIGNS, request)
    assert not any(answer["profile"]["in_range"]), "these strains are beyond the training"
    assert (answer["verdict"]["grade"], answer["verdict"]["source"]) == ("unknown", "model")
    assert "not trusted at 4 of 4 samples" in answer["verdict"]["sentence"]


def test_what_has_no_structure_has_no_grade(
        new_server: Callable[..., ServerProcess], contract: Contract, tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    shutil.copy(ROOT / "models" / "ih28.h5", tmp_path / "models")
    designs = Api(new_server("--models", str(tmp_path / "models")), contract)
    request = {"task": "stress_strain", "family": "IH28", "target": spline([0.01, 0.02], [0.1, 0.2]), "samples": 2,
               "fixed": [0.005, 0.5]}
    for verify in (False, True):
        verdict = designs.ok(DESIGNS, {**request, "verify": verify})["verdict"]
        assert verdict["grade"] == "unknown" and verdict["sentence"].startswith(WORDS["heading"]["no_structure"])


def test_a_design_within_5_percent_is_not_said_to_miss_its_target(designs: Api) -> None:
    """A design that is a few per cent off reaches few samples within 1 %, and its message does not deny the verdict."""
    problem = known_problem(designs)
    points = [[x, 1.03 * y] for x, y in problem["target"]["control_points"]]
    answer = designs.ok(DESIGNS, {**problem, "target": {**problem["target"], "control_points": points}, "fixed": [0.22, 0.85]})
    assert answer["verdict"]["grade"] == "reached" and 0.02 < answer["verdict"]["deviation"] < 0.05
    assert not answer["reached"], "not each sample is within 1 %"
    assert "reaches the target;" not in answer["message"]


def test_each_region_and_each_target_has_its_own(designs: Api) -> None:
    good = {name: value for name, value in known_problem(designs, family="IH29").items() if name != "accuracy"}
    bad = {**good, "target": spline([0.01, 0.1], [10, 300])}
    further = {"task": "poisson", "strain": 0.04, "target": spline([0, 1], [5, 5]), "samples": 8}
    answer = designs.ok(DESIGNS, {"regions": [good, bad, {**good, "fixed": [0.15], "also": [further]}], "accuracy": FEW})
    grades = [region["verdict"]["grade"] for region in answer["regions"]]
    assert grades[0] == "reached" and grades[1] in ("missed", "unknown") and grades[2] in ("missed", "unknown")
    several = answer["regions"][2]
    check_ranges(several["profile"])
    check_ranges(several["also"][0])
    assert all(one["reached"] for one in several["profile"]["ranges"])
    assert not any(one["reached"] for one in several["also"][0]["ranges"])
    deviations = np.subtract(several["also"][0]["achieved"], several["also"][0]["target"])
    assert several["verdict"]["deviation"] == pytest.approx(float(np.sqrt((deviations**2).mean())) / 5), "that of the worst"
