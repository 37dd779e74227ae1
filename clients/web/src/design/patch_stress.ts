// Stress within a simulated patch, from the displacements of its triangles.
import type { PatchMesh } from "../contract/types";

/** The simulated material: Young's modulus in MPa, and Poisson's ratio. */
export interface SolidMaterial {
  readonly youngsModulus: number;
  readonly poissonRatio: number;
}

type Points = readonly (readonly number[])[];

const THIRD = 1 / 3;
const FOUR_THIRDS = 4 / 3;
/** Derivatives of the six quadratic shape functions by the barycentric coordinates lambda_1 and lambda_2 at the centre of a triangle; lambda_0 = 1 - lambda_1 - lambda_2. */
const SHAPE_DERIVATIVES: readonly (readonly [number, number])[] = [
  [-THIRD, -THIRD],
  [THIRD, 0],
  [0, THIRD],
  [0, -FOUR_THIRDS],
  [FOUR_THIRDS, FOUR_THIRDS],
  [-FOUR_THIRDS, 0],
];

function parametricDerivative(points: Points, triangle: readonly number[]): readonly [number, number, number, number] {
  const sum: [number, number, number, number] = [0, 0, 0, 0];
  triangle.forEach((corner, k) => {
    const [x, y] = points[corner];
    sum[0] += x * SHAPE_DERIVATIVES[k][0];
    sum[1] += x * SHAPE_DERIVATIVES[k][1];
    sum[2] += y * SHAPE_DERIVATIVES[k][0];
    sum[3] += y * SHAPE_DERIVATIVES[k][1];
  });
  return sum;
}

/**
 * Von Mises stress in MPa at the centre of each triangle, from the Cauchy stress in plane strain. The law is
 * psi = mu/2 (tr C - 2 - 2 ln J) + lambda/2 (ln J)^2 with tr C in the plane. The stress is sigma = (mu (b - I) + lambda ln J I) / J
 * within the plane, and lambda ln J / J normal to it. It is 0 for inverted triangles (J <= 0).
 */
export function vonMisesStresses(mesh: Pick<PatchMesh, "points" | "triangles">, deformed: Points, { youngsModulus, poissonRatio }: SolidMaterial): number[] {
  const mu = youngsModulus / (2 * (1 + poissonRatio));
  const lambda = (youngsModulus * poissonRatio) / ((1 + poissonRatio) * (1 - 2 * poissonRatio));
  return mesh.triangles.map((triangle) => {
    const [a, b, c, d] = parametricDerivative(mesh.points, triangle);
    const [p, q, r, s] = parametricDerivative(deformed, triangle);
    const area = a * d - b * c;
    // Deformation gradient F = (dx / dlambda) (dX / dlambda)^-1, with positions x now and X at rest.
    const f = [(p * d - q * c) / area, (q * a - p * b) / area, (r * d - s * c) / area, (s * a - r * b) / area];
    const j = f[0] * f[3] - f[1] * f[2];
    if (!(j > 0)) return 0;
    const volumetric = lambda * Math.log(j);
    const xx = (mu * (f[0] ** 2 + f[1] ** 2 - 1) + volumetric) / j;
    const yy = (mu * (f[2] ** 2 + f[3] ** 2 - 1) + volumetric) / j;
    const xy = (mu * (f[0] * f[2] + f[1] * f[3])) / j;
    const zz = volumetric / j;
    return Math.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * xy ** 2);
  });
}

/** The quantile of values at a fraction. Colours end there, so that peaks in single triangles do not darken all others. */
export function quantile(values: readonly number[], fraction: number): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(fraction * sorted.length))] ?? 0;
}

/** The index of the state that is farthest from rest, which is shown first; of two that are equally far, the one in tension. */
export function largestState(strains: readonly number[]): number {
  return strains.reduce((best, strain, k) => (Math.abs(strain) >= Math.abs(strains[best]) ? k : best), 0);
}
