#!/usr/bin/python3
"""Targets that their family misses: what ways out reach against the time and the starting points that they get, and what a verification says
against the samples that it simulates.

    tests/bench/ways_out.py [--curves 10] [--families IH01,IH22] [--output docs/bench]

Starts a server of its own (SUPPLE_BUILD, default build/release) and writes two sections of designs.md, designs-ways-out.csv and
designs-verified-samples.csv. A run goes on from the rows of the CSV files; remove them where the search, a model or the simulation has changed.
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
from shipped_models import options_of_curves, server_with_shipped_models  # noqa: E402
from trusted_designs import curve  # noqa: E402

WAYS = ["family", "number", "starts", "deadline", "missed", "seconds", "ways", "change", "deviation"]
VERIFIED = ["family", "number", "samples", "seconds", "simulated", "model"]
STARTS = (1, 4, 24)
DEADLINES = (2.0, 5.0, 12.0, 30.0)
"""Seconds for the whole request; the search for ways out takes at most 10 of them for each target."""
SAMPLES = (2, 3, 5, 9)
MISSED = 0.05
"""Ways out are looked for beyond this deviation."""
WAIT = 600.0


def effect(answer: Dict[str, Any], name: str) -> Dict[str, Any]:
    (found,) = [entry for entry in answer["effects"] if entry["name"] == name]
    return dict(found)


def ways_out(api: Api, family: str, number: int, starts: int, deadline: float) -> Optional[Dict[str, Any]]:
    """A row; its deviation is that of the best way out, or of the design where there is none. None where the deadline ends the search for the design."""
    request = {**curve(family, number), "accuracy": {"starts": starts}, "effects": {"ways_out": "on"}, "deadline": deadline}
    response = api.post("/v1/designs", request, timeout=WAIT)
    if response.status_code != 200:
        return None
    answer = response.json()
    missed = float(answer["error"]["relative_rms"])
    ways = answer["ways_out"]
    best = min((float(way["deviation"]) for way in ways), default=missed)
    return {"family": family, "number": number, "starts": starts, "deadline": deadline, "missed": missed,
            "seconds": float(effect(answer, "ways_out").get("seconds", 0.0)), "ways": len(ways), "change": ways[0]["change"] if ways else "", "deviation": best}


def verified(api: Api, family: str, number: int, samples: int) -> Dict[str, Any]:
    """A row: what a verification at some of the samples says, and the seconds that it takes."""
    request = {**curve(family, number), "verify": True, "accuracy": {"verified_samples": samples}, "effects": {"polish": "off", "ways_out": "off"}}
    answer = api.ok("/v1/designs", request, timeout=WAIT)
    seen = answer["profile"]["verified"]
    simulated = np.array([math.nan if y is None else y for y in seen["y"]])
    target = np.array(seen["target"])
    return {"family": family, "number": number, "samples": samples, "seconds": float(effect(answer, "verification").get("seconds", 0.0)),
            "simulated": float(np.linalg.norm(simulated - target) / np.linalg.norm(target)), "model": float(answer["error"]["relative_rms"])}


def written_by() -> str:
    return f"Written by `tests/bench/ways_out.py` on {os.cpu_count()} cores ({platform.machine()}), {date.today()}."


def ways_section(rows: List[Dict[str, str]]) -> str:
    lines = [
        "## Ways out against time", "", written_by(), "",
        "Freely drawn curves, of which a design of one family deviates by more than 5 % by the model. The answer names what would help (`ways_out`). *Starts* is `accuracy.starts`, and *deadline* the",
        "request's, of which the search for ways out gets what is left, and at most 10 s. *Helped* are targets with at least one way out, *reached* those whose best one is within 5 %. Each row is one of [designs-ways-out.csv](designs-ways-out.csv).", "",
        "| Starts | Deadline, s | Missed targets | Deviation before, median, % | Helped | Reached | Best way out, median, % | Search for ways out, median, s | 90 % below, s |",
        "|--:|--:|--:|--:|--:|--:|--:|--:|--:|",
    ]
    missed = [row for row in rows if float(row["missed"]) > MISSED]
    for starts, deadline in sorted({(int(row["starts"]), float(row["deadline"])) for row in missed}):
        some = [row for row in missed if (int(row["starts"]), float(row["deadline"])) == (starts, deadline)]
        before, after, seconds = (np.array([float(row[name]) for row in some]) for name in ("missed", "deviation", "seconds"))
        lines.append(f"| {starts} | {deadline:g} | {len(some)} | {100 * np.median(before):.1f} | {sum(int(row['ways']) > 0 for row in some)} | {np.sum(after <= MISSED)} "
                     f"| {100 * np.median(after):.1f} | {np.median(seconds):.2f} | {np.percentile(seconds, 90):.2f} |")
    return "\n".join(lines) + "\n"


def verified_section(rows: List[Dict[str, str]]) -> str:
    most = str(max(SAMPLES))
    whole = {(row["family"], row["number"]): float(row["simulated"]) for row in rows if row["samples"] == most and row["simulated"] != "nan"}
    lines = [
        "## What a verification says against its samples", "", written_by(), "",
        f"The same curves, of which a design is simulated at some of their {most} samples (`accuracy.verified_samples`), as the editor does in the background. *Off* is by how much the deviation that it finds differs",
        f"from the one at all {most} samples. Each row is one of [designs-verified-samples.csv](designs-verified-samples.csv).", "",
        "| Samples | Designs | Simulation, median, s | 90 % below, s | Off, median, percentage points | 90 % below |", "|--:|--:|--:|--:|--:|--:|",
    ]
    for samples in SAMPLES:
        some = [row for row in rows if row["samples"] == str(samples) and (row["family"], row["number"]) in whole and row["simulated"] != "nan"]
        if not some:
            continue
        seconds = np.array([float(row["seconds"]) for row in some])
        off = np.array([abs(float(row["simulated"]) - whole[(row["family"], row["number"])]) for row in some])
        lines.append(f"| {samples} | {len(some)} | {np.median(seconds):.2f} | {np.percentile(seconds, 90):.2f} | {100 * np.median(off):.2f} | {100 * np.percentile(off, 90):.2f} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    arguments = options_of_curves(__doc__, curves=10)
    ways = SavedRows(arguments.output / "designs-ways-out.csv", WAYS,
                     lambda row: (row["family"], int(row["number"]), int(row["starts"]), float(row["deadline"])))
    samples = SavedRows(arguments.output / "designs-verified-samples.csv", VERIFIED, lambda row: (row["family"], int(row["number"]), int(row["samples"])))
    with server_with_shipped_models() as api:
        for number in range(arguments.curves):
            for family in arguments.families.split(","):
                for starts, deadline in [(starts, 30.0) for starts in STARTS] + [(24, deadline) for deadline in DEADLINES[:-1]]:
                    if (family, number, starts, deadline) not in ways:
                        row = ways_out(api, family, number, starts, deadline)
                        print(ways.add(row) if row else f"{family} {number}: no design within {deadline:g} s", flush=True)
                for count in SAMPLES:
                    if (family, number, count) not in samples:
                        print(samples.add(verified(api, family, number, count)), flush=True)
    write_section(arguments.output, "designs", "ways-out", ways_section(ways.rows))
    write_section(arguments.output, "designs", "verified-samples", verified_section(samples.rows))


if __name__ == "__main__":
    main()
