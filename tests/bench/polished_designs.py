#!/usr/bin/python3
"""Polished designs as their owner simulates them afterwards: by a default simulation, and by one on a fine mesh.

    tests/bench/polished_designs.py [--designs 4] [--families IH01,IH67] [--output docs/bench]

Starts a server of its own (SUPPLE_BUILD, default build/release) and writes a section of designs.md and designs-polished.csv.
A run goes on from the rows of the CSV file; remove it where the search, polish, a model or the simulation has changed.
"""

from __future__ import annotations

import math
import os
import platform
import sys
from datetime import date
from pathlib import Path
from typing import Any, Dict, List, Optional

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

from harness import Api  # noqa: E402
from saved_rows import SavedRows  # noqa: E402
from sections import write_section  # noqa: E402
from shipped_models import parser_of, server_with_shipped_models  # noqa: E402

STRAINS = [-0.06, -0.03, 0.0, 0.03, 0.06, 0.09, 0.12]
"""Evenly spaced, as a request for this number of samples takes them."""
TOLERANCE = 2e-3
LIMIT = 5e-3
FINE = 5e-4
"""The error of the stress that the simulation for comparison may make."""
COLUMNS = ["family", "number", "direction", "hidden", "parameters", "rounds", "search", "polished", "default", "default_bar", "fine", "fine_bar"]
WAIT = 1800.0


def simulate(api: Api, family: str, parameters: List[float], direction: float, **accuracy: float) -> Dict[str, Any]:
    """The stress along the direction at STRAINS in MPa, `y`, and the error that the simulation says it makes, `bar`."""
    stretches = np.sqrt(1 + 2 * np.array(STRAINS)).tolist()
    load = {"uniaxial": {"direction": direction, "stretches": stretches, "frame": "material"}}
    answer = api.ok("/v1/simulations", {"family": family, "parameters": parameters, "load": load, "tangents": False, "accuracy": accuracy}, timeout=WAIT)
    if any(state["stopped"] != "converged" for state in answer["states"]):
        raise ValueError("a state was not reached")
    c, s = math.cos(direction), math.sin(direction)
    y = np.array([state["stress"] for state in answer["states"]]) @ [c * c, s * s, 2 * c * s]
    error = answer["accuracy"]["discretization_error"]
    return {"y": y, "bar": error["stress"] if error else math.nan}


def deviation(y: np.ndarray, target: np.ndarray) -> float:
    return float(np.linalg.norm(y - target) / np.linalg.norm(target))


def one(api: Api, model: Dict[str, Any], number: int) -> Optional[Dict[str, Any]]:
    """A row: the target is what a random design does on the fine mesh. None if that has no such curve."""
    family = model["family"]
    stream = np.random.default_rng([number, int(family[2:])])
    hidden = stream.uniform(model["parameters"]["lower"], model["parameters"]["upper"]).tolist()
    direction = float(stream.uniform(0, math.pi))
    try:
        target = simulate(api, family, hidden, direction, discretization_error=FINE)["y"]
    except (AssertionError, ValueError) as why:
        print(f"{family} {number}: no target, {str(why)[:120]}", flush=True)
        return None
    answer = api.ok("/v1/designs", {
        "task": "stress_strain", "family": family, "direction": direction, "samples": len(STRAINS), "verify": True,
        "target": {"control_points": [[e, float(y)] for e, y in zip(STRAINS, target)], "interpolation": "linear"},
        "accuracy": {"polish_tolerance": TOLERANCE, "polish_seconds": 600}}, timeout=WAIT)
    row = {"family": family, "number": number, "direction": direction, "hidden": hidden, "parameters": answer["parameters"],
           "rounds": len(answer["polish"]["rounds"]) - 1, "search": answer["polish"]["rounds"][0]["target_error"], "polished": answer["polish"]["target_error"]}
    met = np.array(answer["profile"]["verified"]["target"])
    assert np.allclose(answer["profile"]["verified"]["x"], STRAINS), "the samples are elsewhere"
    for name, accuracy in [("default", {}), ("fine", {"discretization_error": FINE})]:
        seen = simulate(api, family, answer["parameters"], direction, **accuracy)
        row[name], row[f"{name}_bar"] = deviation(seen["y"], met), seen["bar"]
    return row


def section(rows: List[Dict[str, str]]) -> str:
    """The section of all rows."""
    made = [row for row in rows if row["default"]]
    met = [row for row in made if float(row["polished"]) <= TOLERANCE]

    def percent(values: List[float]) -> str:
        return f"{100 * max(values):.2f}" if values else ""

    lines = [
        "## What a polished design does when its owner simulates it", "",
        f"Written by `tests/bench/polished_designs.py` on {os.cpu_count()} cores ({platform.machine()}), {date.today()}.", "",
        f"The target is the stress of a random design within the bounds at strains of {', '.join(map(str, STRAINS))} along a random direction, simulated on a mesh that errs by at",
        f"most {100 * FINE:g} %. `POST /v1/designs` with `verify` finds a design and polishes it to {100 * TOLERANCE:g} %. Then `POST /v1/simulations` simulates the design once by default,",
        f"without a word about its mesh, and once with an accepted error of {100 * FINE:g} %. Deviations are root mean squares, relative to the target. Each design has a row in",
        "[designs-polished.csv](designs-polished.csv), and a run goes on from there.", "",
        f"**{len(met)} of {len(made)} designs were polished to {100 * TOLERANCE:g} %. Simulated by default they deviate by at most {percent([float(row['default']) for row in met])} %"
        f" (wanted: at most {100 * LIMIT:g} %), and on the fine mesh by at most {percent([float(row['fine']) for row in met])} %.**", "",
        "| Family | Designs | Polished to the tolerance | Found by the network, worst, % | Polished, worst, % | Default simulation, worst, % | Fine simulation, worst, % | Estimate of the default mesh's error, worst, % |",
        "|---|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for family in sorted({row["family"] for row in made}):
        of_family = [row for row in made if row["family"] == family]
        reached = [row for row in of_family if row in met]
        worst = [percent([float(row[name] or "nan") for row in reached]) for name in ("search", "polished", "default", "fine", "default_bar")]
        lines.append("| " + " | ".join([family, str(len(of_family)), str(len(reached)), *worst]) + " |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--designs", type=int, default=4, help="of each family")
    parser.add_argument("--families", default="", help="separated by commas; all without it")
    arguments = parser.parse_args()
    saved = SavedRows(arguments.output / "designs-polished.csv", COLUMNS, lambda row: (row["family"], int(row["number"])))
    with server_with_shipped_models() as api:
        models = [api.get(f"/v1/models/{model['id']}").json() for model in api.get("/v1/models").json()["models"]]
        for model in sorted(models, key=lambda entry: str(entry["family"])):
            family, done, number = model["family"], 0, 0
            if arguments.families and family not in arguments.families.split(","):
                continue
            while done < arguments.designs:
                known = next((row for row in saved.rows if row["family"] == family and int(row["number"]) == number), None)
                if known is None:
                    known = saved.add(one(api, model, number) or {"family": family, "number": number})
                    print(known, flush=True)
                done += 1 if known["default"] else 0
                number += 1
    write_section(arguments.output, "designs", "polished", section(saved.rows))


if __name__ == "__main__":
    main()
