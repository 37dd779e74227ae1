#!/usr/bin/python3
"""Equilibria of a periodic cell by DOLFINx (Debian: python3-dolfinx), a general finite element library.

Usage: dolfinx_peer.py CASE RESULT

CASE is written by simulation_bench: one mesh, the macroscopic deformation gradients to impose and the tolerance. The
problem is the engine's own: quadratic triangles with straight sides, three integration points each, displacement
(F - I) X + w with w periodic, neo-Hookean. Periodicity costs DOLFINx nothing: the space of w has the torus's own
numbering of nodes, so that periodic ones are one. Newton starts from the w of the state before, with Cholesky (CHOLMOD)
or LU (UMFPACK, MUMPS) of PETSc, whose symbolic analysis is kept.

RESULT gets a line "solver NAME SECONDS ITERATIONS" for each solver (CPU time of all states, forms compiled before) and
"stress XX YY XY" for each state. Ends with status 3 where DOLFINx is missing.
"""

from __future__ import annotations

import logging
import sys
import time
from dataclasses import dataclass
from pathlib import Path

try:
    import numpy as np
    import ufl
    from dolfinx import cpp, fem, mesh as dolfinx_mesh
    from dolfinx.fem import petsc as fem_petsc
    from mpi4py import MPI
    from petsc4py import PETSc
except ImportError as error:
    print(f"dolfinx_peer.py: {error}; install python3-dolfinx", file=sys.stderr)
    sys.exit(3)

SOLVERS = {"CHOLMOD": ("cholesky", "cholmod"), "UMFPACK": ("lu", "umfpack"), "MUMPS": ("lu", "mumps")}
COMPILER = {"cffi_extra_compile_args": ["-O3", "-march=native"]}
INTEGRATION = {"quadrature_degree": 2}
MAX_ITERATIONS = 40


@dataclass
class Case:
    nodes: int
    area: float
    youngs_modulus: float
    poisson_ratio: float
    tolerance: float
    points: np.ndarray  # (n, 2): where the points of the mesh, cut open, lie at rest
    node_of: np.ndarray  # (n,): their nodes on the torus
    triangles: np.ndarray  # (m, 6) points: corners, then the midpoints of the sides 01, 12, 20
    gradients: np.ndarray  # (k, 2, 2): F of each state


def read(path: Path) -> Case:
    words = path.read_text().split()
    nodes, n, m, k = (int(word) for word in words[:4])
    area, youngs_modulus, poisson_ratio, tolerance = (float(word) for word in words[4:8])
    numbers = np.array([float(word) for word in words[8:]])
    points, triangles, gradients = np.split(numbers, [3 * n, 3 * n + 6 * m])
    points = points.reshape(n, 3)
    return Case(nodes, area, youngs_modulus, poisson_ratio, tolerance, points[:, :2].copy(),
                points[:, 2].astype(np.int32), triangles.astype(np.int64).reshape(m, 6), gradients.reshape(k, 2, 2))


def torus_space(case: Case) -> fem.FunctionSpace:
    """Quadratic vector functions on the mesh cut open whose degrees of freedom are the torus's nodes."""
    corners = np.unique(case.triangles[:, :3])
    renumbered = np.full(len(case.points), -1, dtype=np.int64)
    renumbered[corners] = np.arange(len(corners))
    domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.triangle, 1))
    mesh = dolfinx_mesh.create_mesh(MPI.COMM_SELF, renumbered[case.triangles[:, :3]], case.points[corners], domain)
    space = fem.VectorFunctionSpace(mesh, ("Lagrange", 2))
    # DOLFINx reorders triangles and their corners; its degrees of freedom are the corners, then the midpoints of the
    # sides opposite to them.
    middle = {}
    for triangle in case.triangles:
        for side in range(3):
            a, b = triangle[side], triangle[(side + 1) % 3]
            middle[min(a, b), max(a, b)] = triangle[3 + side]
    original = np.asarray(mesh.geometry.input_global_indices)
    cells = mesh.geometry.dofmap.array.reshape(-1, 3)
    dofs = np.empty((len(cells), 6), dtype=np.int32)
    for cell, local in enumerate(cells):
        corner = corners[original[local]]
        dofs[cell, :3] = case.node_of[corner]
        for k in range(3):
            a, b = corner[(k + 1) % 3], corner[(k + 2) % 3]
            dofs[cell, 3 + k] = case.node_of[middle[min(a, b), max(a, b)]]
    offsets = np.arange(0, dofs.size + 1, 6, dtype=np.int32)
    dofmap = cpp.fem.DofMap(space.dofmap.dof_layout, cpp.common.IndexMap(MPI.COMM_SELF, case.nodes), 2,
                            cpp.graph.AdjacencyList_int32(dofs.ravel(), offsets), 2)
    torus = cpp.fem.FunctionSpace(space._cpp_object.mesh, space.element, dofmap)
    return fem.FunctionSpace(mesh, space.ufl_element(), cppV=torus)


class Problem:
    def __init__(self, case: Case) -> None:
        self.case = case
        space = torus_space(case)
        mesh = space.mesh
        self.w = fem.Function(space)
        self.gradient = fem.Constant(mesh, np.eye(2))
        f = ufl.variable(self.gradient + ufl.grad(self.w))
        mu = case.youngs_modulus / (2 * (1 + case.poisson_ratio))
        lame = 2 * mu * case.poisson_ratio / (1 - 2 * case.poisson_ratio)
        log_j = ufl.ln(ufl.det(f))
        psi = mu / 2 * (ufl.inner(f, f) - 2 - 2 * log_j) + lame / 2 * log_j**2
        dx = ufl.dx(metadata=INTEGRATION)
        piola = ufl.diff(psi, f)
        force = ufl.inner(piola, ufl.grad(ufl.TestFunction(space))) * dx
        apart = fem.VectorFunctionSpace(mesh, ("DG", 2))
        self.force = fem.form(force, jit_params=COMPILER)
        self.stiffness = fem.form(ufl.derivative(force, self.w), jit_params=COMPILER)
        self.single_forces = fem.form(ufl.inner(piola, ufl.grad(ufl.TestFunction(apart))) * dx, jit_params=COMPILER)
        self.mean_piola = [fem.form(piola[i, j] / case.area * dx, jit_params=COMPILER)
                           for i in range(2) for j in range(2)]
        # One node stays: the energy does not change with translations.
        self.fixed = [fem.dirichletbc(np.zeros(2), np.array([0], dtype=np.int32), space)]
        self.matrix = fem_petsc.create_matrix(self.stiffness)
        self.rhs = fem_petsc.create_vector(self.force)
        self.step = self.rhs.duplicate()

    def force_scale(self) -> float:
        """Root of the sum of squares of what the single triangles add to the gradient."""
        with fem_petsc.assemble_vector(self.single_forces).localForm() as local:
            return float(np.linalg.norm(local.array))

    def assemble_force(self) -> float:
        with self.rhs.localForm() as local:
            local.set(0)
        fem_petsc.assemble_vector(self.rhs, self.force)
        self.rhs.array[:2] = 0
        return float(self.rhs.norm())

    def stress(self, gradient: np.ndarray) -> np.ndarray:
        piola = np.array([fem.assemble_scalar(form) for form in self.mean_piola]).reshape(2, 2)
        return np.linalg.solve(gradient, piola)

    def follow(self, solver: str) -> tuple[float, int, list[np.ndarray]]:
        """CPU seconds, Newton iterations and the stress of each state. The scale of forces is not timed."""
        kind, package = SOLVERS[solver]
        ksp = PETSc.KSP().create(MPI.COMM_SELF)
        ksp.setType("preonly")
        ksp.getPC().setType(kind)
        ksp.getPC().setFactorSolverType(package)
        self.w.x.array[:] = 0
        seconds, iterations, stresses = 0.0, 0, []
        for gradient in self.case.gradients:
            self.gradient.value[:] = gradient
            for _ in range(MAX_ITERATIONS):
                start = time.process_time()
                residual = self.assemble_force()
                seconds += time.process_time() - start
                if residual <= self.case.tolerance * self.force_scale():
                    break
                start = time.process_time()
                self.matrix.zeroEntries()
                fem_petsc.assemble_matrix(self.matrix, self.stiffness, bcs=self.fixed)
                self.matrix.assemble()
                ksp.setOperators(self.matrix)
                ksp.solve(self.rhs, self.step)
                self.w.x.array[:] -= self.step.array
                seconds += time.process_time() - start
                iterations += 1
            else:
                raise RuntimeError(f"{solver}: no convergence")
            start = time.process_time()
            stresses.append(self.stress(gradient))
            seconds += time.process_time() - start
        return seconds, iterations, stresses


def main() -> None:
    logging.disable(logging.INFO)  # the form compiler's
    problem = Problem(read(Path(sys.argv[1])))
    lines = []
    stresses: list[np.ndarray] = []
    for solver in SOLVERS:
        runs = [problem.follow(solver) for _ in range(3)]
        seconds, iterations, stresses = min(runs, key=lambda run: run[0])
        lines.append(f"solver {solver} {seconds!r} {iterations}")
    lines += [f"stress {float(s[0, 0])!r} {float(s[1, 1])!r} {float(s[0, 1])!r}" for s in stresses]
    Path(sys.argv[2]).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
