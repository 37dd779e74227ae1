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
    """A start, and what is wanted instead."""

    name: str
    title: str
    task: str
    family: str
    initial: List[float]
    wanted: Callable[[np.ndarray, np.ndarray], np.ndarray]  # of x and the start's profile
    common: Dict[str, Any] = field(default_factory=dict)
    ends: Tuple[float, float] = (-0.1, 0.2)


def straight(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The line through rest with the same work in tension."""
    ahead = x > 0
    return x * (2 * np.trapz(y[ahead], x[ahead]) / (x[-1] ** 2))


ENTRIES = [
    Entry("quasi-linear", "From nonlinear to quasi-linear", "stress_strain", "IH67", [0.12, 0.68], straight,
          {"direction": 0.0}, (0.0, 0.2)),
    Entry("nonlinear", "From quasi-linear to soft, then stiff", "stress_strain", "IH29", [0.05],
          lambda x, y: y[-1] * (0.25 * x / x[-1] + 0.75 * (x / x[-1]) ** 3), {"direction": 0.4}, (0.0, 0.2)),
    Entry("softer", "Much softer in tension", "stress_strain", "IH67", [0.28, 0.95], lambda x, y: 0.25 * y,
          {"direction": math.pi / 2}, (0.0, 0.2)),
    Entry("both", "Softer in tension and compression together", "stress_strain", "IH67", [0.26, 1.0],
          lambda x, y: 0.5 * y, {"direction": 0.3}, (-0.08, 0.2)),
    Entry("orthotropic", "From stiff along x to stiff along y", "stiffness", "IH67", [0.12, 1.05],
          lambda a, y: 2.1 + 2 * np.exp(-(((a - math.pi / 2) / 0.35) ** 2)), {"strain": 0.03}),
    Entry("isotropic", "The same stiffness in all directions", "stiffness", "IH21", [0.19, 0.78],
          lambda a, y: np.full_like(a, 0.24), {"strain": 0.03}),
    Entry("auxetic", "Poisson's ratio changes its sign four times", "poisson", "IH28", [0.3, 0.5],
          lambda a, y: 0.4 - 0.6 * np.cos(4 * a + 1), {"strain": 0.03}),
    Entry("any-family", "Which family does it best? Stiffness with two lobes", "stiffness", "any", [],
          lambda a, y: 3.4 + 1.1 * np.cos(2 * a), {"strain": 0.03}),
]


def points_of(x: np.ndarray, y: np.ndarray, count: int) -> Points:
    places = np.linspace(0, len(x) - 1, count).round().astype(int)
    return [(float(x[i]), float(y[i])) for i in places]


def post(transport: Transport, path: str, document: Dict[str, Any]) -> Dict[str, Any]:
    answer: Dict[str, Any] = transport.request("POST", path, document=document).json()
    return answer


def solve(transport: Transport, entry: Entry) -> Dict[str, Any]:
    over_strain = entry.task == "stress_strain"
    x = np.linspace(*entry.ends, 31) if over_strain else np.pi * np.arange(48) / 48
    start = np.zeros_like(x)
    if entry.initial:
        profile = post(transport, "/v1/profiles", {"task": entry.task, "family": entry.family, "parameters": entry.initial,
                                                   "x": x.tolist(), **entry.common})
        start = np.array(profile["y"], dtype=float)
    wanted = entry.wanted(x, start)
    request: Dict[str, Any] = {"task": entry.task, "family": entry.family, "verify": True, **entry.common,
                               "target": {"control_points": points_of(x, wanted, 9 if over_strain else 16)},
                               "effects": {"multi_start": "on"}, "deadline": 3600}
    if entry.initial:
        request["initial"] = entry.initial
    return post(transport, "/v1/designs", request)


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


def main() -> int:
    order = read_order(__doc__ or "", "gallery")
    transport = Transport(order.server, 3600)
    rows, sections = [], []
    for entry in ENTRIES:
        if not order.wants(entry.name):
            continue
        answer = solve(transport, entry)
        draw(entry, answer, order.pictures / f"{entry.name}.svg")
        tiling = transport.request("GET", answer["structure"]["svg"] + "&cells=3,3", headers={"Accept": "*/*"}).content
        (order.pictures / f"{entry.name}-structure.svg").write_bytes(tiling)
        verification: Optional[float] = answer["profile"]["verified"].get("relative_rms")
        search = sum(s["seconds"] for s in answer["cost"]["stages"] if s["name"] == "optimization")
        parameters = ", ".join(f"{value:.4g}" for value in answer["parameters"])
        rows.append(f"| [{entry.title}](#{entry.name}) | {answer['family']} | {100 * answer['error']['relative_rms']:.2f} % | "
                    + ("" if verification is None else f"{100 * verification:.2f} %") + f" | {1e3 * search:.0f} ms |")
        sections.append(
            f"## {entry.name}\n\n**{entry.title}.** {answer['family']} ({parameters}). {answer['message']}\n\n"
            f"![Profiles](images/gallery/{entry.name}.svg) ![Structure](images/gallery/{entry.name}-structure.svg)\n")
        print(rows[-1], flush=True)
    head = ("# Gallery of designs\n\nThis page is generated by `tests/bench/design_gallery.py` with a running server. Each start "
            "is a design of the family named; the target is drawn from its profile. \"Off target\" is the root mean square "
            "deviation of the model's profile from the target over that of the target; \"model off simulation\" compares the "
            "model with a simulation of the structure at its native scale, over the simulation's root mean square; targets "
            "need not be within reach, and the closest design is shown then.\n\n"
            "| | Family | Off target | Model off simulation | Search |\n|---|---|--:|--:|--:|\n")
    (order.docs / "gallery.md").write_text(head + "\n".join(rows) + "\n\n" + "\n".join(sections), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
