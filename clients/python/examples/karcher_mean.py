#!/usr/bin/python3
"""The Karcher mean of five random points on a mesh, with the convergence of Newton's method.

    PYTHONPATH=clients/python clients/python/examples/karcher_mean.py MESH_FILE
"""

import sys

import numpy as np

import supple


def main() -> int:
    stream = np.random.default_rng(7)
    with supple.Client() as client:
        mesh = client.upload(sys.argv[1])
        points = [int(v) for v in stream.choice(mesh.info.vertices, size=5, replace=False)]
        mean = mesh.karcher_mean(points)
        print(f"{mesh}: the mean of the vertices {points}")
        print(f"lies in face {mean.mean.face} at {mean.position}, {mean.stopped} after {mean.iterations} iterations")
        for number, step in enumerate(mean.history):
            print(f"{number:3d}  E = {step.objective:.12g}  |grad E| = {step.gradient_norm:.3e}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
