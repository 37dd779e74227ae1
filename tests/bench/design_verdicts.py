#!/usr/bin/python3
"""Verdicts on designs beside their simulation, over tasks and families: is what is called reached near, and what is called missed far?

    tests/bench/design_verdicts.py [--targets plateau,auxetic] [--families IH01,any] [--ways-out 2] [--polish] [--output docs/bench]

For each target and each family, and for all families at once (`any`), designs are asked for without and with verification. The first ways out of
a miss are designed and simulated, too. Starts a server of its own (SUPPLE_BUILD, default build/release) and writes verdicts.csv and a section of
verdicts.md. A run goes on from the rows of the CSV file; remove it where the search, a model, the simulation or the verdict has changed. The
exit status is 1 if a verdict contradicts its simulation.
"""

from __future__ import annotations

import argparse
import math
import os
import platform
import sys
import time
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Tuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

from harness import ROOT, Api  # noqa: E402
from saved_rows import SavedRows  # noqa: E402
from sections import write_section  # noqa: E402
from shipped_models import parser_of, server_with_shipped_models  # noqa: E402

REACHED, MISSED = 0.05, 0.01
"""No design whose simulation is farther from the target is called reached, and none that is nearer is called missed."""
ROUNDING = 1e-9
ANY = "any"
COLUMNS = ["target", "family", "chosen", "by_model", "model", "trusted", "grade", "source", "deviation", "simulated", "seconds", "ways_out", "sentence"]
WAIT = 1800.0
POINTS = 9


@dataclass(frozen=True)
class Asked:
    """A target as a function of the strain or of the angle in radians, and where it is asked for."""
    task: str
    y: "Callable[[float], float]"
    lower: float = 0.0
    upper: float = 0.2
    more: Dict[str, Any] = field(default_factory=dict)

    def request(self, lower: Optional[float] = None, upper: Optional[float] = None) -> Dict[str, Any]:
        """The request without a family; of a part of the strains where their ends are given."""
        if self.task == "stress_strain":
            x = np.linspace(self.lower if lower is None else lower, self.upper if upper is None else upper, POINTS)
        else:
            x = np.pi * np.arange(POINTS) / POINTS
        return {"task": self.task, **self.more, "target": {"control_points": [[float(at), float(self.y(float(at)))] for at in x]}}


ALONG: Dict[str, Any] = {"direction": 0.0}
AT_2: Dict[str, Any] = {"strain": 0.02}
TARGETS: Dict[str, Asked] = {
    "soft-then-stiff": Asked("stress_strain", lambda e: 0.02 * e + 4 * e ** 2 + 10 * e ** 3, more=ALONG),
    "plateau": Asked("stress_strain", lambda e: 0.09 * (1 - math.exp(-e / 0.06)), more=ALONG),
    "stiffening": Asked("stress_strain", lambda e: 1.2 * e + 9 * e ** 2, more=ALONG),
    "compression": Asked("stress_strain", lambda e: -0.05 * (1 - math.exp(e / 0.04)), -0.2, 0.0, more=ALONG),
    "auxetic": Asked("poisson", lambda angle: -0.3, more=AT_2),
    "isotropic": Asked("stiffness", lambda angle: 2.0, more=AT_2),
    "elliptic": Asked("stiffness", lambda angle: 1 / math.hypot(math.cos(angle) / 3, math.sin(angle)), more=AT_2),
    "unreachable": Asked("stress_strain", lambda e: 60 * e, more=ALONG),
}
"""Stresses and stiffnesses in MPa, of structures of the material of the models (26 MPa)."""


def off(shown: Dict[str, Any]) -> float:
    """The simulated deviation of one profile, from its samples; infinite where the simulation did not get to each of them. All weights are equal, and bands zero."""
    verified = shown["verified"]
    if verified is None or any(y is None for y in verified["y"]):
        return math.inf
    target = np.array(verified["target"])
    scale = math.sqrt(float(np.mean(target ** 2)))
    if shown["task"] == "poisson":
        scale = max(scale, 0.1)
    return math.sqrt(float(np.mean((np.array(verified["y"]) - target) ** 2))) / scale


def contradiction(grade: str, deviation: float) -> str:
    """In which way a verdict contradicts its simulation; empty where it does not."""
    if grade == "reached" and deviation > REACHED + ROUNDING:
        return f"reached, and {100 * deviation:.3g} % off in the simulation"
    if grade == "missed" and deviation <= MISSED:
        return f"missed, and {100 * deviation:.3g} % off in the simulation"
    return ""


def simulated_way(api: Api, asked: Asked, way: Dict[str, Any], deadline: float) -> float:
    """The deviation of the design of a way out from the target that it leaves, simulated."""
    lower, upper = way["range"] or (None, None)
    request = {**asked.request(lower, upper), "family": way["family"], "fixed": way["parameters"], "orientation": way["orientation"],
               "material": {"youngs_modulus": way["youngs_modulus"]}, "verify": True, "deadline": deadline,
               "effects": {"polish": "off", "ways_out": "off"}}
    return off(api.ok("/v1/designs", request, timeout=WAIT)["profile"])


def examine(api: Api, target: str, family: str, ways_out: int = 1, polish: bool = False, deadline: float = 900.0, **more: Any) -> Dict[str, Any]:
    """A row: the verdict without and with verification, and the simulated deviations of the first ways out."""
    asked = TARGETS[target]
    request = {**asked.request(), **({} if family == ANY else {"family": family}), "deadline": deadline, **more}
    begun = time.monotonic()
    by_model = api.ok("/v1/designs", {**request, "effects": {"ways_out": "off"}}, timeout=WAIT)
    effects = {"ways_out": "automatic" if ways_out else "off", **({} if polish else {"polish": "off"})}
    answer = api.ok("/v1/designs", {**request, "verify": True, "effects": effects}, timeout=WAIT)
    verdict = answer["verdict"]
    ways = [(way["change"], way["deviation"], simulated_way(api, asked, way, deadline)) for way in answer["ways_out"][:ways_out]]
    return {"target": target, "family": family, "chosen": answer["family"], "by_model": by_model["verdict"]["grade"], "model": by_model["error"]["relative_rms"],
            "trusted": f"{sum(by_model['profile']['in_range'])}/{len(by_model['profile']['in_range'])}", "grade": verdict["grade"], "source": verdict["source"],
            "deviation": "" if verdict["deviation"] is None else float(verdict["deviation"]), "simulated": off(answer["profile"]),
            "seconds": time.monotonic() - begun, "ways_out": "; ".join(f"{change} {by:.4g} {of:.4g}" for change, by, of in ways), "sentence": verdict["sentence"]}


def fault(row: Dict[str, Any]) -> str:
    """What is wrong with a row; empty where nothing is."""
    simulated, source = float(row["simulated"]), str(row["source"])
    if source != "simulation":
        return "was verified, and the model decides"
    if math.isfinite(simulated) and (row["deviation"] == "" or abs(float(row["deviation"]) - simulated) > 1e-3 * max(simulated, 1e-2)):
        return f"the verdict says {row['deviation']}, and the samples say {simulated:.4g}"
    return contradiction(str(row["grade"]), simulated)


def percent(text: str) -> str:
    return f"{100 * float(text):.2g}" if text and math.isfinite(float(text)) else ""


def ways_shown(text: str) -> str:
    """`turn 0.03 0.04` as words of a table."""
    ways = [way.split() for way in text.split("; ")] if text else []
    return "; ".join(f"{change.replace('_', ' ')}: {percent(by)} % by the model, " + (f"{percent(of)} % simulated" if percent(of) else "not simulated")
                     for change, by, of in ways)


def section(rows: List[Dict[str, str]], polished: bool) -> str:
    """The section of all rows."""
    faults = [f"{row['target']}, {row['family']}: {fault(row)}" for row in rows if fault(row)]
    misled = [row for row in rows if contradiction(row["by_model"], float(row["simulated"]))]
    named = Path(__file__).resolve().relative_to(ROOT)
    lines = [
        "## Verdicts and simulations", "",
        f"Written by `{named}{' --polish' if polished else ''}` on {os.cpu_count()} cores ({platform.machine()}), {date.today()}.", "",
        f"{len(TARGETS)} targets are asked for from each family and from all at once (`any`), without verification and with it{'' if polished else ', but without polish'}. The deviation of the simulation is computed here",
        f"from the samples of the answer. A design may be called reached only within {100 * REACHED:g} %, and missed only beyond {100 * MISSED:g} %. Ways out are those of the answer, first ones",
        "first; their designs are simulated by a request of their own. Deviations are in per cent of the target. All rows, with their sentences, are in [verdicts.csv](verdicts.csv), and a run",
        "goes on from there.", "",
        f"**{len(rows)} designs: {'no verdict contradicts its simulation.' if not faults else f'{len(faults)} verdicts contradict their simulation.'} Without verification the model's verdict"
        f" would have done so {len(misled)} {'time' if len(misled) == 1 else 'times'}.**", "",
        *[f"- {one}" for one in faults], *([""] if faults else []),
        "| Target | Family | Verdict by the model | Off by the model, % | Trusted samples | Verdict | Decided by | Off, simulated, % | Ways out |",
        "|---|---|---|--:|--:|---|---|--:|---|",
    ]
    for row in rows:
        family = row["family"] if row["family"] == row["chosen"] else f"{row['family']} ({row['chosen']})"
        lines.append("| " + " | ".join([row["target"], family, row["by_model"], percent(row["model"]), row["trusted"].replace("/", " of "), row["grade"], row["source"],
                                        percent(row["simulated"]), ways_shown(row["ways_out"])]) + " |")
    return "\n".join(lines) + "\n"


def order(families: List[str]) -> "Callable[[Dict[str, str]], Tuple[int, int]]":
    names = list(TARGETS)
    return lambda row: (names.index(row["target"]) if row["target"] in names else len(names),
                        families.index(row["family"]) if row["family"] in families else len(families))


def chosen(named: str, known: List[str], parser: argparse.ArgumentParser) -> List[str]:
    """Those of a list that the option names, in its order; all without it."""
    asked = [name for name in named.split(",") if name]
    if unknown := [name for name in asked if name not in known]:
        parser.error(f"{', '.join(unknown)} is none of {', '.join(known)}")
    return [name for name in known if not asked or name in asked]


def main() -> int:
    parser = parser_of(__doc__)
    parser.add_argument("--targets", default="", help=f"of {', '.join(TARGETS)}; separated by commas, all without it")
    parser.add_argument("--families", default="", help=f"separated by commas, with {ANY} for all at once; all without it")
    parser.add_argument("--ways-out", type=int, default=2, metavar="N", help="ways out of each miss that are simulated")
    parser.add_argument("--polish", action="store_true", help="correct designs by simulation, for up to two minutes each")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    families = sorted(path.stem.upper() for path in (ROOT / "models").glob("ih*.h5")) + [ANY]
    targets = chosen(arguments.targets, list(TARGETS), parser)
    saved = SavedRows(arguments.output / "verdicts.csv", COLUMNS, order(families))
    wanted = [(target, family) for target in targets for family in chosen(arguments.families, families, parser)]
    with server_with_shipped_models() as api:
        for number, (target, family) in enumerate(wanted, 1):
            if any(row["target"] == target and row["family"] == family for row in saved.rows):
                continue
            row = saved.add(examine(api, target, family, arguments.ways_out, arguments.polish))
            print(f"{number} of {len(wanted)}: {target}, {family}: {row['sentence']} {fault(row)}", flush=True)
    write_section(arguments.output, "verdicts", "verdicts", section(saved.rows, arguments.polish))
    faults = [row for row in saved.rows if fault(row)]
    for row in faults:
        print(f"{row['target']}, {row['family']}: {fault(row)}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
