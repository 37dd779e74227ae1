#!/usr/bin/python3
"""Stress over strain of a structure in uniaxial compression and tension, printed and drawn.

    PYTHONPATH=clients/python clients/python/examples/stress_strain_curve.py [FAMILY [PLOT_FILE]]

The plot (a PNG or SVG file) needs matplotlib.
"""

import sys
from typing import Optional

import numpy as np
from numpy.typing import NDArray

import supple


def draw(file: str, curve: NDArray[np.float64]) -> None:
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots()
    axes.plot(curve[:, 0], curve[:, 1], marker=".")
    axes.set_xlabel("Green strain $E_{xx}$")
    axes.set_ylabel("second Piola-Kirchhoff stress $S_{xx}$ / MPa")
    figure.savefig(file)


def main(family: str = "IH01", plot_file: Optional[str] = None) -> int:
    with supple.Client() as client:
        curves = []
        for stretches in (np.linspace(0.98, 0.92, 4), np.linspace(1.02, 1.08, 4)):
            load = supple.Uniaxial(0.0, stretches.tolist())
            simulation = client.simulate(family, None, load, mesh_size=0.5, tangents=False)
            if not simulation.converged:
                print(f"the path ended early: {simulation.message}", file=sys.stderr)
            curves.append(np.column_stack([simulation.green_strain[:, 0], simulation.stress[:, 0]]))
    curve = np.vstack([curves[0][::-1], np.zeros((1, 2)), curves[1]])
    print(f"{family}, uniaxial along x:\n     E_xx  S_xx / MPa")
    for strain, stress in curve:
        print(f"{strain:9.5f}  {stress:10.5f}")
    if plot_file is not None:
        draw(plot_file, curve)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
