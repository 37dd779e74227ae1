#!/usr/bin/python3
"""The stiffness of a structure in every direction by a neural model: at rest, and under compression.

    PYTHONPATH=clients/python clients/python/examples/directional_stiffness.py [MODEL [P1,P2,...]]

The default model is the server's first one; the default parameters are the middle of its bounds.
"""

import sys
from typing import Optional

import numpy as np
from numpy.typing import NDArray

import supple

STRAIN = -0.05
"""Green strain along the direction for the second column."""
DIRECTIONS = 12


def youngs_modulus(tangent: NDArray[np.float64], direction: float) -> float:
    """Stress over strain along a direction with lateral strain and shear free, MPa: 1 / (m^T C^-1 m)."""
    c, s = np.cos(direction), np.sin(direction)
    m = np.array([c * c, s * s, c * s])
    return float(1 / (m @ np.linalg.solve(tangent, m)))


def main(model_id: Optional[str] = None, parameters: Optional[str] = None) -> int:
    with supple.Client() as client:
        models = client.models()
        if not models:
            print("the server has no models: start it with --models FOLDER", file=sys.stderr)
            return 1
        model = client.model(model_id) if model_id else models[0]
        middle = 0.5 * (model.info.lower + model.info.upper)
        design = [float(p) for p in parameters.split(",")] if parameters else middle.tolist()
        rest = model.evaluate(design, [0, 0, 0], derivatives=2)
        assert rest.tangent is not None
        print(f"{model.id} at {np.round(design, 4).tolist()}:\n  direction/rad  at rest/MPa  secant at E = {STRAIN:g}/MPa")
        for direction in np.linspace(0, np.pi, DIRECTIONS, endpoint=False):
            curve = model.uniaxial(design, direction, green_strains=[STRAIN])
            secant = curve.directional_stress[0] / STRAIN
            note = "" if curve.converged and curve.in_range[0] else "  (beyond what the model was trained on)"
            print(f"  {direction:13.4f}  {youngs_modulus(rest.tangent[0], direction):11.4f}  {secant:22.4f}{note}")
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
