"""Problems of inverse design whose answers the tests know, and parts of their answers."""

from __future__ import annotations

from typing import Any, Dict, List

import numpy as np

from harness import Api

DESIGNS = "/v1/designs"
PROFILES = "/v1/profiles"
KNOWN = {"IH67": [0.22, 0.85], "IH29": [0.15]}
FEW = {"candidates": 24, "starts": 3}
"""Options of a quick search that suffices for one or two parameters."""


def profile(api: Api, task: str, x: List[float], family: str = "IH67", parameters: Any = None, **more: Any) -> Any:
    document = {"task": task, "family": family, "parameters": parameters or KNOWN[family], "x": x, **more}
    return api.ok(PROFILES, document)


def spline(x: Any, y: Any, **more: Any) -> Dict[str, Any]:
    return {"control_points": [[float(a), float(b)] for a, b in zip(x, y)], "interpolation": "linear", **more}


def known_problem(api: Api, task: str = "stress_strain", family: str = "IH67", **more: Any) -> Dict[str, Any]:
    """A target that the known design of the family reaches at every sample."""
    x = np.linspace(-0.08, 0.12, 9) if task == "stress_strain" else np.pi * np.arange(12) / 12
    where = {"direction": more.pop("direction", 0.3)} if task == "stress_strain" else {"strain": more.pop("strain", 0.04)}
    y = profile(api, task, x.tolist(), family, **where)["y"]
    return {"task": task, "family": family, **where, "target": spline(x, y), "samples": len(x), "accuracy": FEW, **more}


def answers(document: Dict[str, Any]) -> Dict[str, Any]:
    """The parts of an answer that are equal for equal computations."""
    return {name: value for name, value in document.items() if name not in ("cost", "effects")}


def effect(answer: Dict[str, Any], name: str) -> Dict[str, Any]:
    (found,) = [entry for entry in answer["effects"] if entry["name"] == name]
    return dict(found)


def long_request(**more: Any) -> Dict[str, Any]:
    """A search that takes far longer than any test waits for it."""
    return {"task": "stiffness", "family": "IH67", "target": spline([0, 1, 2], [0.1, 0.4, 0.2]), "samples": 500,
            "accuracy": {"starts": 64, "max_iterations": 1000, "tolerance": 1e-12, "candidates": 4096},
            "effects": {"multi_start": "on"}, **more}


def quick_request(**more: Any) -> Dict[str, Any]:
    return {"task": "stress_strain", "family": "IH29", "target": spline([0.01, 0.03], [0.01, 0.03]), "samples": 2,
            "accuracy": {"candidates": 4, "starts": 1}, **more}
