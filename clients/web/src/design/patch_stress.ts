// Stress within a simulated patch, from where its triangles went.
import type { PatchMesh } from "../contract/types";

/** Of the solid that was simulated: E in MPa, Poisson's ratio. */
export interface Solid {
  readonly youngsModulus: number;
  readonly poissonRatio: number;
}

type Points = readonly (readonly number[])[];

/** d N / d lambda_1, d N / d lambda_2 of the six quadratic shape functions in a triangle's centre, lambda_0 = 1 - lambda_1 - lambda_2. */
const THIRD = 1 / 3;
const FOUR_THIRDS = 4 / 3;
const SHAPES: readonly (readonly [number, number])[] = [
  [-THIRD, -THIRD], [THIRD, 0], [0, THIRD], [0, -FOUR_THIRDS], [FOUR_THIRDS, FOUR_THIRDS], [-FOUR_THIRDS, 0],
];

function derivative(points: Points, triangle: readonly number[]): readonly [number, number, number, number] {
  const sum: [number, number, number, number] = [0, 0, 0, 0];
  triangle.forEach((corner, k) => {
    const [x, y] = points[corner];
    sum[0] += x * SHAPES[k][0];
    sum[1] += x * SHAPES[k][1];
    sum[2] += y * SHAPES[k][0];
    sum[3] += y * SHAPES[k][1];
  });
  return sum;
}

/**
 * Von Mises stress (Cauchy, MPa) in the centre of each triangle, of the law psi = mu/2 (tr C - 2 - 2 ln J) +
 * lambda/2 (ln J)^2 in plane strain: sigma = (mu (b - I) + lambda ln J I) / J within the plane, lambda ln J / J across.
 */
export function vonMisesStresses(mesh: Pick<PatchMesh, "points" | "triangles">, deformed: Points, { youngsModulus, poissonRatio }: Solid): number[] {
  const mu = youngsModulus / (2 * (1 + poissonRatio));
  const lambda = (youngsModulus * poissonRatio) / ((1 + poissonRatio) * (1 - 2 * poissonRatio));
  return mesh.triangles.map((triangle) => {
    const [a, b, c, d] = derivative(mesh.points, triangle);
    const [p, q, r, s] = derivative(deformed, triangle);
    const area = a * d - b * c;
    // F = (d x / d lambda) (d X / d lambda)^-1
    const f = [(p * d - q * c) / area, (q * a - p * b) / area, (r * d - s * c) / area, (s * a - r * b) / area];
    const j = f[0] * f[3] - f[1] * f[2];
    if (!(j > 0)) return 0;
    const volume = lambda * Math.log(j);
    const xx = (mu * (f[0] ** 2 + f[1] ** 2 - 1) + volume) / j;
    const yy = (mu * (f[2] ** 2 + f[3] ** 2 - 1) + volume) / j;
    const xy = (mu * (f[0] * f[2] + f[1] * f[3])) / j;
    const zz = volume / j;
    return Math.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3 * xy ** 2);
  });
}

/** The value that so large a share of all values is at most: peaks in single triangles do not darken all others. */
export function quantile(values: readonly number[], share: number): number {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
}
