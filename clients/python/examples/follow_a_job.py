#!/usr/bin/python3
"""A distance field as a job, with its progress; Ctrl-C cancels it.

    PYTHONPATH=clients/python clients/python/examples/follow_a_job.py MESH_FILE
"""

import sys

import numpy as np

import supple


def show(fraction: float, stage: str) -> None:
    print(f"\r{100 * fraction:3.0f} %  {stage:<30}", end="", file=sys.stderr, flush=True)


def main() -> int:
    with supple.Client() as client:
        mesh = client.upload(sys.argv[1])
        job = mesh.start_field([0])
        try:
            field = job.result(progress=show)
        except KeyboardInterrupt:
            job.cancel()
            print("\ncancelled", file=sys.stderr)
            return 130
        reached = np.isfinite(field.distances)
        print(f"\n{reached.sum()} of {mesh.info.vertices} vertices, the farthest at {field.distances[reached].max():.6g}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
