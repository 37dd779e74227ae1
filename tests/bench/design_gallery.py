#!/usr/bin/python3
"""Designs for targets of every kind, found and verified by a running server: the page docs/gallery.md with its pictures.

    tests/bench/design_gallery.py [--server URL] [--out DIR] [NAME ...]
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Tuple

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from gallery import read_order  # noqa: E402

from supple.transport import Transport  # noqa: E402

Points = List[Tuple[float, float]]
MPA = "stress, MPa"


@dataclass
class Entry:
    """A start, and what is wanted instead: what another design, `hidden`, does when it is simulated, or a drawn curve."""

    name: str
    title: str
    task: str
    family: str
    initial: List[float]
    hidden: Optional[List[float]] = None
    drawn: Optional[Callable[[np.ndarray, np.ndarray], np.ndarray]] = None  # of x and the start's profile
    common: Dict[str, Any] = field(default_factory=dict)
    ends: Tuple[float, float] = (0.0, 0.2)


def stress(name: str, title: str, family: str, initial: List[float], hidden: List[float], direction: float,
           ends: Tuple[float, float] = (0.0, 0.2)) -> Entry:
    return Entry(name, title, "stress_strain", family, initial, hidden, None, {"direction": direction}, ends)


def over_directions(task: str, name: str, title: str, family: str, initial: List[float], hidden: List[float],
                    strain: float) -> Entry:
    return Entry(name, title, task, family, initial, hidden, None, {"strain": strain})


CURVES = [
    stress("to-linear", "From nonlinear to quasi-linear", "IH22", [0.272, 0.583, 0.245], [0.157, 0.532, 0.05], 0.3),
    stress("to-nonlinear", "From quasi-linear to soft, then stiff", "IH01", [0.146, 0.468, 0.12, 0.719],
           [0.266, 0.568, 0.106, 0.476], 0.6),
    stress("softer", "Three times softer in tension", "IH67", [0.121, 1.07], [0.281, 0.691], 0.0),
    stress("much-softer", "Ten times softer in tension", "IH28", [0.107, 0.629], [0.433, 0.77], 0.3),
    stress("both", "Softer in tension and compression together", "IH50", [0.145, 0.499], [0.19, 0.56], 0.2, (-0.1, 0.2)),
]
STIFFNESSES = [
    over_directions("stiffness", "stiffness-1", "An orthotropic sheet, softer along y", "IH22", [0.124, 0.67, 0.148],
                    [0.233, 0.668, 0.092], 0.1),
    over_directions("stiffness", "stiffness-2", "An orthotropic sheet, softer along x", "IH67", [0.119, 0.655],
                    [0.285, 0.875], 0.02),
    over_directions("stiffness", "stiffness-3", "From anisotropic to nearly isotropic", "IH21", [0.189, 0.715],
                    [0.124, 0.651], 0.03),
    over_directions("stiffness", "stiffness-4", "From anisotropic to orthotropic", "IH01", [0.117, 0.681, 0.134, 0.469],
                    [0.26, 0.5, 0.14, 0.473], 0.05),
    over_directions("stiffness", "stiffness-5", "Four lobes turned", "IH28", [0.138, 0.421], [0.13, 0.576], 0.05),
    over_directions("stiffness", "stiffness-6", "Two lobes turned", "IH01", [0.171, 0.39, 0.135, 0.758],
                    [0.272, 0.655, 0.129, 0.569], 0.05),
    over_directions("stiffness", "stiffness-7", "Six lobes turned", "IH21", [0.111, 0.604], [0.189, 0.648], 0.03),
    over_directions("stiffness", "stiffness-8", "A narrower lobe at large strain", "IH50", [0.161, 0.355], [0.115, 0.314],
                    0.2),
]
POISSONS = [
    over_directions("poisson", "poisson-1", "From many lobes to isotropic", "IH28", [0.063, 0.866], [0.411, 0.493], 0.03),
    over_directions("poisson", "poisson-2", "From positive to negative along x", "IH01", [0.171, 0.451, 0.139, 0.556],
                    [0.26, 0.5, 0.14, 0.473], 0.05),
    over_directions("poisson", "poisson-3", "From negative to positive along x", "IH22", [0.261, 0.476, 0.069],
                    [0.229, 0.506, 0.237], 0.03),
    over_directions("poisson", "poisson-4", "From larger than one to nearly zero along the axes", "IH29", [0.323], [0.065],
                    0.05),
    over_directions("poisson", "poisson-5", "Lobes turned", "IH28", [0.144, 0.343], [0.201, 0.671], 0.03),
    over_directions("poisson", "poisson-6", "Another anisotropy", "IH67", [0.175, 0.675], [0.271, 0.893], 0.02),
    over_directions("poisson", "poisson-7", "Isotropic, a third as large", "IH21", [0.186, 0.585], [0.133, 0.777], 0.01),
    over_directions("poisson", "poisson-8", "Auxetic in every direction", "IH22", [0.12, 0.361, 0.02], [0.124, 0.67, 0.148],
                    0.03),
]
DRAWN = [
    Entry("drawn-curve", "A cubic, soft, then stiff", "stress_strain", "IH29", [0.05],
          drawn=lambda x, y: y[-1] * (0.25 * x / x[-1] + 0.75 * (x / x[-1]) ** 3), common={"direction": 0.4}),
    Entry("drawn-circle", "Exactly the same stiffness in all directions", "stiffness", "IH21", [0.19, 0.78],
          drawn=lambda a, y: np.full_like(a, 0.24), common={"strain": 0.03}),
    Entry("drawn-auxetic", "Poisson's ratio changes its sign four times", "poisson", "IH28", [0.3, 0.5],
          drawn=lambda a, y: 0.4 - 0.6 * np.cos(4 * a + 1), common={"strain": 0.03}),
    Entry("any-family", "Which family does it best? Stiffness with two lobes", "stiffness", "any", [],
          drawn=lambda a, y: 3.4 + 1.1 * np.cos(2 * a), common={"strain": 0.03}),
]
HEXAGONS = [0.1224, 0.5, 0.1434, 0.625]
SHOE = [
    stress("forefoot", "Forefoot: soft", "IH01", HEXAGONS, [0.25, 0.36, 0.13, 0.7], math.pi / 2, (-0.08, 0.15)),
    stress("midfoot", "Midfoot: stiff from the beginning", "IH01", HEXAGONS, [0.165, 0.583, 0.082, 0.7], math.pi / 2,
           (-0.08, 0.15)),
    stress("heel", "Heel: soft, then stiff", "IH01", HEXAGONS, [0.266, 0.568, 0.106, 0.476], math.pi / 2, (-0.08, 0.15)),
]
GROUPS = [
    ("Stress over strain", "Five curves as in figure 4.7 of the thesis.", CURVES),
    ("Stiffness over direction", "Eight profiles at strains of 2 to 20 %, as in figure 4.8.", STIFFNESSES),
    ("Poisson's ratio over direction", "Eight profiles at strains of 1 to 10 %, as in figure 4.9.", POISSONS),
    ("The sole of a shoe", "Three regions with a curve each, as in figure 4.1: one request, from the same hexagons.", SHOE),
    ("Drawn freely", "Targets that nobody has checked for reach: the closest design is answered, and why it is no closer.",
     DRAWN),
]


def points_of(x: np.ndarray, y: np.ndarray, count: int) -> Points:
    places = np.linspace(0, len(x) - 1, count).round().astype(int)
    return [(float(x[i]), float(y[i])) for i in places]


def post(transport: Transport, path: str, document: Dict[str, Any]) -> Dict[str, Any]:
    answer: Dict[str, Any] = transport.request("POST", path, document=document).json()
    return answer


def places_of(entry: Entry) -> np.ndarray:
    if entry.task == "stress_strain":
        return np.linspace(*entry.ends, 11)[1 if entry.ends[0] == 0 else 0:]
    return np.pi * np.arange(18) / 18


def simulated(transport: Transport, entry: Entry, x: np.ndarray) -> np.ndarray:
    """What the hidden design does: nothing is free, so that it is only simulated."""
    zeros = [(float(place), 1.0) for place in x]
    answer = post(transport, "/v1/designs", {
        "task": entry.task, "family": entry.family, **entry.common, "target": {"control_points": zeros}, "samples": len(x),
        "fixed": entry.hidden, "verify": True, "effects": {"polish": "off", "ways_out": "off"}, "accuracy": {"verified_samples": len(x)},
        "deadline": 3600})
    assert np.allclose(answer["profile"]["verified"]["x"], x), "all samples are simulated"
    return np.array(answer["profile"]["verified"]["y"], dtype=float)


def problem_of(transport: Transport, entry: Entry) -> Dict[str, Any]:
    if entry.hidden is not None:
        x = places_of(entry)
        target = simulated(transport, entry, x)
        points = [(float(a), float(b)) for a, b in zip(x, target)]
    else:
        over_strain = entry.task == "stress_strain"
        x = np.linspace(*entry.ends, 31) if over_strain else np.pi * np.arange(48) / 48
        start = np.zeros_like(x)
        if entry.initial:
            profile = post(transport, "/v1/profiles", {"task": entry.task, "family": entry.family,
                                                       "parameters": entry.initial, "x": x.tolist(), **entry.common})
            start = np.array(profile["y"], dtype=float)
        assert entry.drawn is not None
        points = points_of(x, entry.drawn(x, start), 9 if over_strain else 16)
    problem: Dict[str, Any] = {"task": entry.task, "family": entry.family, **entry.common,
                               "target": {"control_points": points}}
    if entry.hidden is not None:
        problem["samples"] = len(points)  # what lies between them is interpolated, and nobody's response
    if entry.initial:
        problem["initial"] = entry.initial
    return problem


OPTIONS: Dict[str, Any] = {"verify": True, "effects": {"multi_start": "on", "ways_out": "off"}, "deadline": 3600,
                           "accuracy": {"verified_samples": 18, "polish_seconds": 1800}}


def solve(transport: Transport, entries: List[Entry], together: bool) -> List[Dict[str, Any]]:
    """An answer for each entry; `together` as the regions of one request."""
    problems = [problem_of(transport, entry) for entry in entries]
    if together:
        regions = [{**problem, "name": entry.name} for problem, entry in zip(problems, entries)]
        answer = post(transport, "/v1/designs", {"regions": regions, **OPTIONS})
        return [{**region, "cost": answer["cost"]} for region in answer["regions"]]
    return [post(transport, "/v1/designs", {**problem, **OPTIONS}) for problem in problems]


def draw(entry: Entry, answer: Dict[str, Any], path: Path) -> None:
    profile = answer["profile"]
    verified = profile["verified"]
    polar = entry.task != "stress_strain"
    figure = plt.figure(figsize=(4.2, 3.4))
    axes = figure.add_subplot(projection="polar" if polar else None)
    x = np.array(profile["x"])

    def curve(x: Any, y: Any, style: str, **more: Any) -> None:
        x, y = np.asarray(x, dtype=float), np.array([np.nan if v is None else v for v in y])
        if polar:
            x, y = np.concatenate([x, x + np.pi, x[:1] + 2 * np.pi]), np.concatenate([y, y, y[:1]])
        axes.plot(x, y, style, **more)

    if entry.initial:
        curve(x, profile["initial"], "-", color="#9bd0d8", linewidth=2, label="start")
    curve(x, profile["target"], "--", color="#d9822b", linewidth=1.6, label="target")
    curve(x, profile["achieved"], "-", color="#1f6fb2", linewidth=2, label="design")
    curve(verified["x"], verified["y"], "o", color="#123c60", markersize=3.5, label="simulated")
    if not polar:
        axes.set_xlabel("Green strain")
        axes.set_ylabel(MPA)
        axes.grid(alpha=0.25)
    axes.legend(frameon=False, fontsize=8, loc="best" if not polar else (0.92, 0.85))
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def percent(value: Optional[float]) -> str:
    return "" if value is None else f"{100 * value:.2g} %"


def row_of(entry: Entry, answer: Dict[str, Any]) -> str:
    rounds = answer["polish"]["rounds"]
    search = sum(s["seconds"] for s in answer["cost"]["stages"] if s["name"] == "optimization")
    cells = [f"[{entry.title}](#{entry.name})", answer["family"], percent(answer["error"]["relative_rms"]),
             percent(rounds[0]["target_error"]), percent(answer["polish"]["target_error"]), str(len(rounds) - 1),
             f"{sum(r['seconds'] for r in rounds):.1f} s", percent(answer["profile"]["verified"]["discretization_error"]),
             answer["polish"]["stopped"].replace("_", " ")]
    print(" | ".join(cells), f"search {search:.2f} s", flush=True)
    return "| " + " | ".join(cells) + " |"


def section_of(entry: Entry, answer: Dict[str, Any]) -> str:
    parameters = ", ".join(f"{value:.4g}" for value in answer["parameters"])
    hidden = "" if entry.hidden is None else f" The target is what ({', '.join(map(str, entry.hidden))}) does."
    return (f"### {entry.name}\n\n**{entry.title}.** {answer['family']} ({parameters}).{hidden} {answer['message']}\n\n"
            f"![Profiles](images/gallery/{entry.name}.svg) ![Structure](images/gallery/{entry.name}-structure.svg)\n")


HEAD = """# Gallery of designs

This page is generated by `tests/bench/design_gallery.py` with a running server, on the examples of chapter 4 of the thesis.
Where a target says so, it is what another design of the family does when it is simulated, so that it can be reached; the search
starts from the design that is drawn as "start" and does not know the other. Deviations are relative root mean squares from the
target: of the network's answer for the design that the search found, of its simulation, and of the simulation after polish
(tolerance 0.2 %). Rounds are the further structures that were simulated, seconds what all simulations took; "mesh" is
`discretization_error`, more than what the simulation's mesh errs by.
"""
COLUMNS = ("| | Family | Network | Simulated | Polished | Rounds | Simulations | Mesh | Ended |\n"
           "|---|---|--:|--:|--:|--:|--:|--:|---|\n")


def main() -> int:
    order = read_order(__doc__ or "", "gallery")
    transport = Transport(order.server, 3600)
    page = [HEAD]
    for title, text, entries in GROUPS:
        wanted = [entry for entry in entries if order.wants(entry.name)]
        together = entries is SHOE
        rows, sections = [], []
        batches = [wanted] if together and wanted else [[entry] for entry in wanted]
        for batch in batches:
            for entry, answer in zip(batch, solve(transport, batch, together)):
                draw(entry, answer, order.pictures / f"{entry.name}.svg")
                tiling = transport.request("GET", answer["structure"]["svg"] + "&cells=3,3", headers={"Accept": "*/*"}).content
                (order.pictures / f"{entry.name}-structure.svg").write_bytes(tiling)
                rows.append(row_of(entry, answer))
                sections.append(section_of(entry, answer))
        page.append(f"## {title}\n\n{text}\n\n{COLUMNS}" + "\n".join(rows) + "\n\n" + "\n".join(sections))
    (order.docs / "gallery.md").write_text("\n".join(page), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
