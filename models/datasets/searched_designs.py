#!/usr/bin/python3
"""Designs that searches find for drawn targets, as options of `supple-lab dataset make`: what error bars are judged by.

    models/datasets/searched_designs.py --server http://127.0.0.1:8080 --family IH01 --designs 200 > searched.txt
    supple-lab dataset make --family IH01 $(cat searched.txt) --out IH01-searched.h5 ...

Half of the targets are what a random design does along a random direction, bent by a smooth random factor: most can nearly be reached. The
others are drawn freely, from soft and then stiff to the opposite. Equal seeds give equal targets.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import Any, Dict, List, Tuple

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "clients" / "python"))

import supple  # noqa: E402

SAMPLES = 9


def bent(client: supple.Client, model: Any, stream: np.random.Generator, direction: float) -> List[Tuple[float, float]]:
    """The curve of a random design, times a factor that goes smoothly through random values at both ends."""
    parameters = stream.uniform(model.info.lower, model.info.upper).tolist()
    low, high = -stream.choice([0.0, 0.05, 0.1]), stream.uniform(0.05, 0.2)
    curve = client.profile("stress_strain", parameters, model=model.id, direction=direction, limits=(low, high), samples=SAMPLES)
    share = np.asarray(curve.x) / high
    factor = np.exp(stream.normal(0, 0.3) + stream.normal(0, 0.3) * share)
    return [(float(x), float(y)) for x, y in zip(curve.x, np.asarray(curve.y) * factor)]


def free(client: supple.Client, model: Any, stream: np.random.Generator, direction: float) -> List[Tuple[float, float]]:
    """A curve in tension that begins as stiff as some random design and bends upwards or downwards."""
    parameters = stream.uniform(model.info.lower, model.info.upper).tolist()
    curve = client.profile("stress_strain", parameters, model=model.id, direction=direction, limits=(0.0, 0.02), samples=2)
    stiffness = float(curve.y[-1]) / 0.02
    end, power = stream.uniform(0.05, 0.2), stream.uniform(0.4, 3)
    x = np.linspace(0, end, SAMPLES)
    return [(float(e), float(stiffness * end * (e / end) ** power)) for e in x]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--server", default="http://127.0.0.1:8080")
    parser.add_argument("--family", required=True)
    parser.add_argument("--designs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    found: List[str] = []
    directions: List[str] = []
    with supple.Client(arguments.server) as client:
        model = next(entry for entry in client.models() if entry.info.family == arguments.family)
        number = 0
        while len(directions) < arguments.designs:
            stream = np.random.default_rng([arguments.seed, number])
            number += 1
            direction = float(stream.uniform(0, math.pi))
            try:
                points = (bent if number % 2 else free)(client, model, stream, direction)
                target = supple.Target("stress_strain", points, direction=direction)
                design = client.design(target, model=model.id)
            except supple.SuppleError as error:
                print(f"target {number}: {error}", file=sys.stderr)
                continue
            found.extend(repr(float(value)) for value in design.parameters)
            directions.append(repr(direction))
    print(f"--list {','.join(found)} --directions {','.join(directions)}")


if __name__ == "__main__":
    main()
