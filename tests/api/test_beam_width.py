"""How sensitive a design is to an error of its beam width, over HTTP and in the command line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cli_program import Program
from design_requests import DESIGNS, KNOWN, effect, known_problem
from harness import Api

NAME = "beam_width_sensitivity"


@pytest.mark.parametrize("task", ["stress_strain", "stiffness", "poisson"])
def test_a_design_says_how_much_other_beams_change_it(designs: Api, task: str) -> None:
    known = {**known_problem(designs, task, "IH29"), "fixed": list(KNOWN["IH29"])}
    answer = designs.ok(DESIGNS, {**known, "effects": {NAME: "on"}})
    found, bill = answer["profile"][NAME], effect(answer, NAME)
    assert bill["ran"] and bill["seconds"] > 0 and "asks for it" in bill["why"]
    assert found["wider"] > 0 and found["narrower"] > 0
    if task != "poisson":
        # Between beams that stretch, whose stiffness is proportional to their width, and beams that bend, by its third power.
        assert 0.04 < found["wider"] < 0.25 and 0.04 < found["narrower"] < 0.25
    turned = designs.ok(DESIGNS, {**known, "orientation": np.pi, "effects": {NAME: "on"}})["profile"][NAME]
    assert turned["wider"] == pytest.approx(found["wider"], rel=1e-6), "half a turn changes nothing"


def test_only_designs_that_are_simulated_say_so_by_themselves(designs: Api) -> None:
    known = {**known_problem(designs, "stiffness", "IH29"), "fixed": list(KNOWN["IH29"])}
    plain = designs.ok(DESIGNS, known)
    assert plain["profile"][NAME] is None and effect(plain, NAME)["why"] == "the design was not simulated"
    verified = {**known, "verify": True, "accuracy": {"verified_samples": 2, "candidates": 8, "starts": 1}}
    simulated = designs.ok(DESIGNS, {**verified, "effects": {"polish": "off"}})
    assert simulated["profile"][NAME]["wider"] > 0 and effect(simulated, NAME)["ran"]
    off = designs.ok(DESIGNS, {**verified, "effects": {"polish": "off", NAME: "off"}})
    assert off["profile"][NAME] is None and "turns it off" in effect(off, NAME)["why"]


def test_the_command_line_says_how_much_other_beams_change_a_design(designs: Api, tmp_path: Path) -> None:
    program = Program(designs.server.url, tmp_path)
    text = program.ok("design", "--task", "stiffness", "--family", "IH29", "--candidates", "8", "--starts", "2", "--target", "0,1;1,1", "--samples", "6",
                      "--ways-out", "off", "--missed-ok", "--beam-width-sensitivity", "on")
    (line,) = [line for line in text.splitlines() if line.startswith("beam width")]
    assert "with beams 5 % wider: " in line and "5 % narrower: " in line
