#!/usr/bin/python3
"""A network of random points on a mesh, stretched between fixed points, with its state after each iteration.

    PYTHONPATH=clients/python clients/python/examples/relax_network.py MESH_FILE [NETWORK.obj]
"""

import sys
import time
from pathlib import Path

import supple


def main() -> int:
    with supple.Client() as client:
        mesh = client.upload(sys.argv[1])
        points = supple.PoissonDisk(radius=0.05 * mesh.info.diagonal)
        springs = supple.VoronoiDual()
        fixed = list(range(0, 40, 4))
        job = mesh.start_relax_network(points, springs, fixed)
        while not (status := job.status()).finished:
            if isinstance(status.partial, supple.PartialRelaxation):
                print(f"iteration {status.partial.iteration}: E = {status.partial.energy:.9g}", file=sys.stderr)
            time.sleep(0.1)
        network = job.result()
        print(f"{mesh}: {len(network.points)} points and {len(network.springs)} springs, {network.stopped}")
        for number, step in enumerate(network.history):
            print(f"{number:3d}  E = {step.energy:.12g}  |grad E| = {step.gradient_norm:.3e}")
        for warning in network.warnings:
            print(warning)
        if len(sys.argv) > 2:
            Path(sys.argv[2]).write_bytes(mesh.relaxed_network_file(points, springs, fixed))
    return 0


if __name__ == "__main__":
    sys.exit(main())
