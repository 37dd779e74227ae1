#!/usr/bin/python3
"""Curves that are drawn freely, so that most families do not follow them: what the design does that searches find, with trust weighed and without.

    tests/bench/trusted_designs.py [--curves 20] [--families IH01,IH22] [--output docs/bench]

Starts a server of its own (SUPPLE_BUILD, default build/release) and writes a section of designs.md and designs-trust.csv. A run goes on from
the rows of the CSV file; remove it where the search, a model or the simulation has changed.
"""

from __future__ import annotations

import math
import os
import platform
import sys
from datetime import date
from pathlib import Path
from typing import Any, Dict, List

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

from harness import Api  # noqa: E402
from saved_rows import SavedRows  # noqa: E402
from sections import write_section  # noqa: E402
from shipped_models import options_of_curves, server_with_shipped_models  # noqa: E402

COLUMNS = ["family", "number", "trust", "model", "simulated", "error", "in_range", "within", "samples", "seconds"]
WRONG = 0.1
"""A model that is off by more is wrong there."""
WAIT = 900.0


def curve(family: str, number: int) -> Dict[str, Any]:
    """From soft and then stiff to the opposite, in tension or compression, of any height that sheets of 26 MPa have."""
    stream = np.random.default_rng([number, int(family[2:])])
    end = float(stream.uniform(0.1, 0.2)) * float(stream.choice([-1, 1]))
    height, power = math.exp(stream.uniform(math.log(0.02), math.log(0.7))), stream.uniform(0.5, 2.5)
    points = sorted([end * t, math.copysign(height * t**power, end)] for t in np.linspace(0, 1, 6).tolist())
    return {"task": "stress_strain", "family": family, "direction": float(stream.uniform(0, math.pi)), "samples": 9, "target": {"control_points": points}}


def one(api: Api, family: str, number: int, trust: str) -> Dict[str, Any]:
    """A row. Deviations are relative root mean squares: of the model and of the simulation from the target, and between both."""
    effects = {"trust": trust, "polish": "off", "ways_out": "off"}
    request = {**curve(family, number), "verify": True, "effects": effects}
    answer = api.ok("/v1/designs", request, timeout=WAIT)
    main = answer["profile"]
    simulated = np.array([math.nan if y is None else y for y in main["verified"]["y"]])
    achieved, target = np.array(main["achieved"]), np.array(main["target"])
    bars = np.array([math.inf if bar is None else bar for bar in main["error_bar"]])
    norm = np.linalg.norm(target)
    found = api.ok("/v1/designs", {**request, "verify": False}, timeout=WAIT)
    return {"family": family, "number": number, "trust": trust, "model": float(answer["error"]["relative_rms"]),
            "simulated": float(np.linalg.norm(simulated - target) / norm), "error": float(np.linalg.norm(simulated - achieved) / np.linalg.norm(simulated)),
            "in_range": sum(main["in_range"]), "within": int(np.sum(np.abs(simulated - achieved) <= bars)), "samples": len(target),
            "seconds": float(found["cost"]["seconds"])}


def section(rows: List[Dict[str, str]]) -> str:
    lines = [
        "## A search that weighs trust", "",
        f"Written by `tests/bench/trusted_designs.py` on {os.cpu_count()} cores ({platform.machine()}), {date.today()}.", "",
        "Curves are drawn freely: of any height, bent upwards or downwards, in tension or compression, along a random direction. No design of a family follows most of them. A search",
        "that asks only how near the model says a design is ends where the model errs in favour of the target. With [`effects.trust`](../designs.md#how-accurate-it-is) it prefers designs whose error bars",
        "are short. Each design was simulated (`verify`, no polish). *Wrong* are designs whose model is off by more than 10 %. Each search is a row of [designs-trust.csv](designs-trust.csv).", "",
        "These curves are harder than those by which the bars of searched designs were made, half of which are bent curves of random designs: fewer samples than 90 % are within their bar.", "",
        "| Family | Curves | Trust | Model from the target, median, % | Simulation from the target, median, % | worst, % | Wrong | of them with all samples `in_range` | Samples within their bar | Search, median, s |",
        "|---|--:|---|--:|--:|--:|--:|--:|--:|--:|",
    ]
    for family in sorted({row["family"] for row in rows}):
        for trust in ("off", "automatic"):
            some = [row for row in rows if row["family"] == family and row["trust"] == trust and row["simulated"] != "nan"]
            values = {name: np.array([float(row[name]) for row in some]) for name in COLUMNS[3:]}
            wrong = values["error"] > WRONG
            trusted = values["in_range"] == values["samples"]
            share = values["within"].sum() / values["samples"].sum()
            lines.append(f"| {family} | {len(some)} | `{trust}` | {100 * np.median(values['model']):.1f} | {100 * np.median(values['simulated']):.1f} | {100 * values['simulated'].max():.0f} "
                         f"| {wrong.sum()} | {(wrong & trusted).sum()} | {100 * share:.0f} % | {np.median(values['seconds']):.2f} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    arguments = options_of_curves(__doc__, curves=20)
    saved = SavedRows(arguments.output / "designs-trust.csv", COLUMNS, lambda row: (row["family"], int(row["number"]), row["trust"]))
    with server_with_shipped_models() as api:
        for number in range(arguments.curves):
            for family in arguments.families.split(","):
                for trust in ("off", "automatic"):
                    if (family, number, trust) not in saved:
                        print(saved.add(one(api, family, number, trust)), flush=True)
    write_section(arguments.output, "designs", "trust", section(saved.rows))


if __name__ == "__main__":
    main()
