#!/usr/bin/python3
"""What the levels of accuracy draft, normal and sure cost and err by: measures the table api/accuracy_levels.json anew.

    tests/bench/accuracy_levels.py [--capabilities weaves,simulations] [--repetitions 5] [--table api/accuracy_levels.json] [--output docs/bench]

Starts a server of its own (SUPPLE_BUILD, default build/release), writes seconds, errors, what they are of, tasks and sources into the table, and the page
accuracy-levels.md. Capabilities that are not named keep what they have.
"""

from __future__ import annotations

import json
import math
import os
import platform
import sys
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "api"))

from harness import ROOT, Api  # noqa: E402
from sections import write_section  # noqa: E402
from shapes import bumpy_sphere, sphere  # noqa: E402
from shipped_models import parser_of, server_with_shipped_models  # noqa: E402

TABLE = ROOT / "api" / "accuracy_levels.json"
LEVELS = ("draft", "normal", "sure")
WAIT = 1800.0
SOURCE = "docs/bench/accuracy-levels.md#seconds-and-errors"


@dataclass
class Task:
    """
    A reference task: its request, the settings of an answer that counts as exact, the error of an answer against that, also in words, and whether answers with
    those settings are exact but for rounding by their method. Where they are not, the error of a level with those settings is unknown.
    """

    words: str
    request: Dict[str, Any]
    exact: Dict[str, Any]
    error: Callable[[Any, Any], float]
    error_of: str
    is_exact: bool = False


def relative(values: Any, exact: Any) -> float:
    """The root mean square of the difference over that of the exact values."""
    one, other = np.asarray(values, dtype=float), np.asarray(exact, dtype=float)
    return float(np.linalg.norm(one - other) / np.linalg.norm(other))


def largest_relative(values: Any, exact: Any) -> float:
    """The largest relative error of a positive value. The distance of the source from itself is 0 and has none."""
    one, other = np.asarray(values, dtype=float), np.asarray(exact, dtype=float)
    return float(np.max(np.abs(one[other > 0] / other[other > 0] - 1)))


def farthest(answer: Any, exact: Any, diagonal: float = 2 * math.sqrt(3)) -> float:
    """How far a point of a network is from its place at most, over the diagonal of the unit sphere's box."""
    return float(np.max(np.linalg.norm(np.array(answer["positions"]) - np.array(exact["positions"]), axis=1)) / diagonal)


def stresses(answer: Any) -> List[Any]:
    return [state["stress"] for state in answer["states"]]


def network(mesh: str, host: Optional[Dict[str, Any]]) -> Dict[str, Any]:
    more = {"host": host} if host else {}
    return {"mesh": mesh, "points": {"kind": "poisson_disk", "radius": 0.4}, "springs": {"kind": "voronoi_dual"}, "fixed_points": [0, 1, 2], **more}


def tasks(api: Api) -> Dict[str, Callable[[], Task]]:
    """The reference tasks by their capabilities. Meshes are uploaded where a task is measured."""
    return {
        "weaves": lambda: Task(
            "200 directions of interlacing squares of type 1 at a strain of 0.1.",
            {"weave": {"pattern": "interlacing_squares", "type": 1}},
            {"accuracy": {"segments": 32}, "effects": {"error_estimate": "off"}},
            lambda answer, exact: relative(answer["youngs_modulus"], exact["youngs_modulus"]),
            "error of Young's modulus because of the rods' resolution, relative root mean square over the directions"),
        "simulations": lambda: Task(
            "Three states of the structure of the family IH01 with its default parameters under tension to 1.1.",
            {"family": "IH01", "load": {"uniaxial": {"direction": 0.3, "stretches": [1.03, 1.06, 1.1]}}},
            {"accuracy": {"discretization_error": 0.0002}},
            lambda answer, exact: relative(stresses(answer), stresses(exact)),
            "error of the stress because of the mesh, relative root mean square"),
        "geodesics": lambda: Task(
            "The distances from one point to all vertices of a sphere with waves of 81,920 faces.",
            {"mesh": api.upload(*bumpy_sphere(6)), "sources": [{"vertex": 0}]}, {},
            lambda answer, exact: largest_relative(answer["distances"], exact["distances"]),
            "largest relative error of a distance", is_exact=True),
        "networks": lambda: Task(
            "A network of springs on a sphere of 1,280 faces, of which three points are held.",
            network(api.upload(*sphere(3)), None), {"accuracy": {"tolerance": 1e-14}}, farthest,
            "how far a point is from its exact equilibrium at most, over the diagonal of the mesh"),
        "hosts": lambda: Task(
            "A network of springs on a spherical shell of 1,280 faces, of which three points are held.",
            network(api.upload(*sphere(3)), {"kind": "shell", "thickness": 0.01, "youngs_modulus": 1e4, "poisson_ratio": 0.3}),
            {"accuracy": {"tolerance": 1e-13}}, farthest,
            "how far a point of the network is from its exact equilibrium at most, over the diagonal of the mesh; the error of the host's own mesh is not counted"),
        "voronoi": lambda: Task(
            "60 cells on a sphere with waves of 20,480 faces.",
            {"mesh": api.upload(*bumpy_sphere(5)), "sites": [{"vertex": 160 * k} for k in range(60)]}, {},
            lambda answer, exact: 0.5 * float(np.sum(np.abs(areas(answer) - areas(exact))) / np.sum(areas(exact))),
            "half the sum of the errors of the cells' areas, as a fraction of the surface", is_exact=True),
        "voronoi_optimizations": lambda: Task(
            "60 sites on a sphere of 5,120 faces, moved to the centres of their cells.",
            {"mesh": api.upload(*sphere(4)), "sites": [{"vertex": 40 * k} for k in range(60)], "objectives": {"centroidal": 1}},
            {"accuracy": {"tolerance": 1e-10}, "max_iterations": 1000},
            lambda answer, exact: max(0.0, answer["energy"] / exact["energy"] - 1),
            "energy above that of a tolerance of 1e-10, relative"),
    }


def areas(answer: Any) -> np.ndarray:
    return np.array([cell["area"] for cell in answer["cells"]])


def error_of(task: Task, settings: Dict[str, Any], answer: Any, exact: Any) -> Optional[float]:
    """The error of an answer; None where its settings are those of the exact answer, because a comparison of a thing with itself tells nothing."""
    return None if settings == task.exact and not task.is_exact else task.error(answer, exact)


def measure(api: Api, rows: List[Dict[str, Any]], task: Task, repetitions: int) -> None:
    """Writes what the levels of a capability cost and err by into their rows."""
    path = rows[0]["path"]
    exact = api.ok(path, {**task.request, **task.exact}, timeout=WAIT)
    for row in rows:
        answers = [api.ok(path, {**task.request, **row["request"]}, timeout=WAIT) for _ in range(repetitions)]
        row["task"], row["error_of"] = task.words, task.error_of
        row["seconds"] = float(f"{min(answer['cost']['seconds'] for answer in answers):.2g}")
        error = error_of(task, row["request"], answers[-1], exact)
        row["error"] = error if error is None else 0 if error < 1e-14 else float(f"{error:.2g}")
        row["source"] = SOURCE
        print(row["capability"], row["level"], row["seconds"], row["error"], flush=True)


def table_text(table: Dict[str, Any]) -> str:
    """The file, one member of a level on a line."""
    levels = ["    {\n" + ",\n".join(f"      {json.dumps(name)}: {json.dumps(value)}" for name, value in level.items()) + "\n    }" for level in table["levels"]]
    head = "".join(f"  {json.dumps(name)}: {json.dumps(table[name])},\n" for name in ("about", "machine"))
    return "{\n" + head + '  "levels": [\n' + ",\n".join(levels) + "\n  ]\n}\n"


def number(value: Optional[float]) -> str:
    return "" if value is None else f"{value:g}"


def section(table: Dict[str, Any]) -> str:
    lines = [
        "## Seconds and errors", "",
        f"Written by `tests/bench/accuracy_levels.py` on {os.cpu_count()} cores ({platform.machine()}), {date.today()}; rows with another source are older.", "",
        "Three settings for each capability, as `supple --accuracy`, `Client(accuracy=...)` and the web editor offer them. The table that the server has is `api/accuracy_levels.json`",
        "(`GET /v1/accuracy-levels`). Errors are dimensionless, 0.01 is one per cent; 0 is below rounding. An empty field was not measured, or is the error of settings against which the others are measured.", "",
        "| Capability | Level | Settings | Task | Seconds | Error | of |", "|---|---|---|---|--:|--:|---|",
    ]
    for level in table["levels"]:
        settings = f"`{json.dumps(level['request'])}`" if level["request"] else "the defaults"
        lines.append(f"| {level['capability']} | {level['level']} | {settings} | {level['task']} | {number(level['seconds'])} | {number(level['error'])} | {level['error_of']} |")
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--capabilities", default="", help="separated by commas; all that have a task here without it")
    parser.add_argument("--repetitions", type=int, default=5, help="of each level, of which the fastest counts")
    parser.add_argument("--table", type=Path, default=TABLE, help="where the table is written, which is read from the contract's folder")
    arguments = parser.parse_args()
    table = json.loads(TABLE.read_text(encoding="utf-8"))
    with server_with_shipped_models() as api:
        known = tasks(api)
        for capability in arguments.capabilities.split(",") if arguments.capabilities else known:
            if capability not in known:
                parser.error(f"{capability} is none of {', '.join(known)}")
            rows = [level for level in table["levels"] if level["capability"] == capability]
            measure(api, rows, known[capability](), arguments.repetitions)
    arguments.table.write_text(table_text(table), encoding="utf-8")
    write_section(arguments.output, "accuracy-levels", "levels", section(table))


if __name__ == "__main__":
    main()
