#!/usr/bin/python3
"""A structure that becomes stiffer as it is stretched: tiling parameters for a wanted stress over strain.

    PYTHONPATH=clients/python clients/python/examples/inverse_design.py [FAMILY [SVG_FILE]]

By default all families are searched for which the server has a model. The structure is written as SVG.
"""

import sys
import time
from typing import Optional

import supple

WANTED = [(0.0, 0.0), (0.05, 0.015), (0.1, 0.05), (0.15, 0.12)]
"""Green strain along x, and second Piola-Kirchhoff stress in MPa."""


def follow(job: "supple.Job[supple.DesignResult]") -> supple.DesignResult:
    """Waits for the job and shows the best design so far on a terminal."""
    while not (status := job.status()).finished:
        best = status.partial
        if isinstance(best, supple.PartialDesign) and sys.stderr.isatty():
            print(f"\r{best.family} off by {100 * best.error.relative_rms:6.2f} %", end="", file=sys.stderr)
        time.sleep(0.1)
    return job.result()


def main(family: Optional[str] = None, svg_file: Optional[str] = None) -> int:
    with supple.Client() as client:
        target = supple.Target("stress_strain", WANTED, direction=0.0, interpolation="monotone")
        result = follow(client.start_design(target, family=family))
        print(f"{result.family} {result.parameters.round(5).tolist()}, deviation {100 * result.error.relative_rms:.3g} %")
        print("   E_xx  wanted/MPa  achieved/MPa")
        for strain, wanted, achieved in zip(result.profile.x, result.profile.target, result.profile.achieved):
            print(f"{strain:7.4f}  {wanted:10.5f}  {achieved:12.5f}")
        for rank, candidate in enumerate(result.ranking, start=1):
            print(f"{rank}. {candidate.family}: {100 * candidate.error.relative_rms:.3g} %")
        if result.message:
            print(result.message)
        if svg_file is not None:
            with open(svg_file, "wb") as file:
                file.write(client.structure_file(result.family, result.parameters.tolist(), cells=(4, 4)))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
