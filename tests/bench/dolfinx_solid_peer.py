#!/usr/bin/python3
"""A solid of tetrahedra by DOLFINx (Debian: python3-dolfinx), a general finite element library.

Usage: dolfinx_solid_peer.py CASE RESULT

CASE is written by solid_bench: one mesh, the displacements of its nodes, which of them are held, the material and the load.
The problem is the engine's own: neo-Hookean with the logarithm of the volume, a force per volume.

With linear elements RESULT gets, for each solver of PETSc, a line "solver NAME ASSEMBLY SOLUTION" (CPU seconds of the forces
and the stiffness, and of the factorization and the solution, its symbolic analysis kept; the least of several rounds; forms
compiled before), then "step X Y Z" for each node: Newton's step. With quadratic ones, whose corners are the mesh's nodes, it
gets "energy E UNKNOWNS" of the equilibrium from there. Ends with status 3 where DOLFINx is missing.
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
    from dolfinx import fem, mesh as dolfinx_mesh
    from dolfinx.fem import petsc as fem_petsc
    from mpi4py import MPI
    from petsc4py import PETSc
except ImportError as error:
    print(f"dolfinx_solid_peer.py: {error}; install python3-dolfinx", file=sys.stderr)
    sys.exit(3)

SOLVERS = {"CHOLMOD": "cholmod", "MUMPS": "mumps"}
COMPILER = {"cffi_extra_compile_args": ["-O3", "-march=native"]}
MAX_ITERATIONS = 20


@dataclass
class Case:
    degree: int
    rounds: int
    mu: float
    lame: float
    force: np.ndarray  # (3,)
    nodes: np.ndarray  # (n, 3): at rest
    displacements: np.ndarray  # (n, 3)
    held: np.ndarray  # (n,) of 0 and 1
    tetrahedra: np.ndarray  # (m, 4)


def read(path: Path) -> Case:
    numbers = np.array(path.read_text().split(), dtype=np.float64)
    n, m, degree, rounds = (int(number) for number in numbers[:4])
    mu, lame = (float(number) for number in numbers[4:6])
    table, tetrahedra = np.split(numbers[9:], [7 * n])
    table = table.reshape(n, 7)
    return Case(degree, rounds, mu, lame, numbers[6:9], table[:, :3].copy(), table[:, 3:6].copy(), table[:, 6],
                tetrahedra.astype(np.int64).reshape(m, 4))


class Problem:
    def __init__(self, case: Case) -> None:
        self.case = case
        domain = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.tetrahedron, 1))
        mesh = dolfinx_mesh.create_mesh(MPI.COMM_SELF, case.tetrahedra, case.nodes, domain)
        self.space = fem.VectorFunctionSpace(mesh, ("Lagrange", case.degree))
        self.u = fem.Function(self.space)
        # DOLFINx renumbers nodes; corners are the first degrees of freedom of a cell, in the order of its nodes.
        cells = mesh.geometry.dofmap.array.reshape(-1, 4)
        corners = np.array([self.space.dofmap.cell_dofs(cell)[:4] for cell in range(len(cells))])
        self.dof_of = np.empty(len(case.nodes), dtype=np.int64)
        self.dof_of[np.asarray(mesh.geometry.input_global_indices)[cells]] = corners
        rows = 3 * self.dof_of[:, None] + np.arange(3)
        self.rows = rows
        self.u.x.array[rows] = case.displacements
        if case.degree == 1:
            held = self.dof_of[case.held > 0].astype(np.int32)
        else:
            least = case.nodes[case.held > 0]
            assert np.ptp(least[:, 2]) == 0, "quadratic elements are held at one height"
            held = fem.locate_dofs_geometrical(self.space, lambda x: np.isclose(x[2], least[0, 2]))
        self.held_rows = (3 * held[:, None] + np.arange(3)).ravel()
        f = ufl.variable(ufl.Identity(3) + ufl.grad(self.u))
        log_j = ufl.ln(ufl.det(f))
        psi = case.mu / 2 * (ufl.inner(f, f) - 3 - 2 * log_j) + case.lame / 2 * log_j**2
        weight = fem.Constant(mesh, case.force)
        dx = ufl.dx(metadata={"quadrature_degree": 1 if case.degree == 1 else 4})
        energy = psi * dx - ufl.inner(weight, self.u) * dx
        test = ufl.TestFunction(self.space)
        force = ufl.inner(ufl.diff(psi, f), ufl.grad(test)) * dx - ufl.inner(weight, test) * dx
        self.energy = fem.form(energy, jit_params=COMPILER)
        self.force = fem.form(force, jit_params=COMPILER)
        self.stiffness = fem.form(ufl.derivative(force, self.u), jit_params=COMPILER)
        self.held = [fem.dirichletbc(np.zeros(3), held, self.space)]
        self.matrix = fem_petsc.create_matrix(self.stiffness)
        self.matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        self.rhs = fem_petsc.create_vector(self.force)
        self.step = self.rhs.duplicate()

    def assemble(self) -> None:
        with self.rhs.localForm() as local:
            local.set(0)
        fem_petsc.assemble_vector(self.rhs, self.force)
        self.rhs.array[self.held_rows] = 0
        self.matrix.zeroEntries()
        fem_petsc.assemble_matrix(self.matrix, self.stiffness, bcs=self.held)
        self.matrix.assemble()

    def direct_solver(self, package: str) -> PETSc.KSP:
        ksp = PETSc.KSP().create(MPI.COMM_SELF)
        ksp.setType("preonly")
        ksp.getPC().setType("cholesky")
        ksp.getPC().setFactorSolverType(package)
        return ksp

    def one_step(self, package: str) -> tuple[float, float]:
        ksp = self.direct_solver(package)
        assembly, solution = [], []
        # The first round analyses the pattern.
        for _ in range(self.case.rounds + 1):
            start = time.process_time()
            self.assemble()
            assembled = time.process_time()
            ksp.setOperators(self.matrix)
            ksp.solve(self.rhs, self.step)
            assembly.append(assembled - start)
            solution.append(time.process_time() - assembled)
        ksp.destroy()
        return min(assembly[1:]), min(solution[1:])

    def equilibrium(self) -> float:
        """Newton's steps end where ln(det F) near 1 leaves forces no more digits, which for nu = 0.4999 is soon."""
        ksp = self.direct_solver("mumps")
        first = None
        for _ in range(MAX_ITERATIONS):
            self.assemble()
            norm = float(self.rhs.norm())
            first = first or norm
            if norm <= 1e-5 * first:
                break
            ksp.setOperators(self.matrix)
            ksp.solve(self.rhs, self.step)
            self.u.x.array[:] -= self.step.array
        else:
            raise RuntimeError("no convergence")
        return float(fem.assemble_scalar(self.energy))


def main() -> None:
    logging.disable(logging.INFO)  # the form compiler's
    case = read(Path(sys.argv[1]))
    problem = Problem(case)
    lines = []
    if case.degree == 1:
        for solver, package in SOLVERS.items():
            assembly, solution = problem.one_step(package)
            lines.append(f"solver {solver} {assembly!r} {solution!r}")
        lines += ["step " + " ".join(repr(-float(x)) for x in row) for row in problem.step.array[problem.rows]]
    else:
        lines.append(f"energy {problem.equilibrium()!r} {len(problem.u.x.array) - len(problem.held_rows)}")
    Path(sys.argv[2]).write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
