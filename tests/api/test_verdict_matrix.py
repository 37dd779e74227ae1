"""Verdicts beside the simulated deviation for a few targets and families; tests/bench/design_verdicts.py has all of them."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import pytest

from harness import Api

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "bench"))

from design_verdicts import ANY, contradiction, examine, fault, section  # noqa: E402

SHORT = {"samples": 8, "accuracy": {"candidates": 24, "starts": 2, "verified_samples": 5}}


@pytest.mark.parametrize("target, family", [("plateau", "IH67"), ("stiffening", "IH29"), ("compression", "IH67"), ("auxetic", "IH29"),
                                            ("elliptic", "IH67"), ("isotropic", ANY), ("unreachable", ANY)])
def test_no_verdict_contradicts_its_simulation(designs: Api, target: str, family: str) -> None:
    row = examine(designs, target, family, ways_out=0, **SHORT)
    assert not fault(row), row


def test_what_no_structure_does_is_missed(designs: Api) -> None:
    row = examine(designs, "unreachable", "IH67", ways_out=0, **SHORT)
    assert row["grade"] in ("missed", "unknown") and (row["grade"] == "unknown") == math.isinf(row["simulated"]), row


def test_contradictions_are_found() -> None:
    assert contradiction("reached", 0.06) and contradiction("missed", 0.005) and contradiction("reached", math.inf)
    assert not contradiction("reached", 0.04) and not contradiction("missed", 0.2) and not contradiction("close", 0.2) and not contradiction("unknown", 1)
    row = {"target": "plateau", "family": ANY, "chosen": "IH67", "by_model": "reached", "model": "0.01", "trusted": "8/8", "grade": "missed", "source": "simulation",
           "deviation": "0.45", "simulated": "0.45", "seconds": "1", "ways_out": "turn 0.035 0.04; turn_and_modulus 0.05 inf", "sentence": "Simulated: 45 % off."}
    assert not fault(row) and "the samples say 0.04" in fault({**row, "simulated": "0.04"}) and "the model decides" in fault({**row, "source": "model"})
    page = section([row], polished=False)
    assert "no verdict contradicts" in page and "would have done so 1 time." in page
    assert "turn: 3.5 % by the model, 4 % simulated; turn and modulus: 5 % by the model, not simulated" in page
    assert "| any (IH67) |" in page
