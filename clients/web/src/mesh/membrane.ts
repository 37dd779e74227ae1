// The mechanics of a membrane's triangles, as the engine computes them: principal stretches from the lengths of the sides, and the energy density.
import type { Vector } from "./mesh_data";

/** Indices of three points of the network. */
export type Triple = readonly [number, number, number];
/** Lengths of the sides (0, 1), (1, 2) and (2, 0). */
export type Sides = readonly [number, number, number];
/** Principal stretches, the greater first. */
export type Stretches = readonly [number, number];

export interface MembraneMaterial {
  readonly youngs_modulus: number;
  readonly poisson_ratio: number;
  readonly thickness: number;
}

export const SIDES: readonly (readonly [number, number])[] = [[0, 1], [1, 2], [2, 0]];

/** Lengths of the sides of a triangle with straight sides in space. */
export function straightSides(positions: readonly Vector[], corners: Triple): Sides {
  return SIDES.map(([from, to]) => {
    const [a, b] = [positions[corners[from]], positions[corners[to]]];
    return Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
  }) as unknown as Sides;
}

/** The coordinates of a plane triangle with given sides: the first corner at the origin, the second on the x axis. */
function flattened([ab, bc, ca]: Sides): { bx: number; cx: number; cy: number } {
  const cx = (ab * ab + ca * ca - bc * bc) / (2 * ab);
  return { bx: ab, cx, cy: Math.sqrt(Math.max(0, ca * ca - cx * cx)) };
}

/** Principal stretches of the linear map from the plane triangle at rest to the present one. The lesser is 0 if the present one has no area. */
export function stretchesOf(rest: Sides, now: Sides): Stretches {
  const [before, after] = [flattened(rest), flattened(now)];
  const xx = after.bx / before.bx;
  const yy = after.cy / before.cy;
  const xy = (after.cx - xx * before.cx) / before.cy;
  const sum = Math.hypot(xx + yy, xy);
  const difference = Math.hypot(xx - yy, xy);
  return [(sum + difference) / 2, Math.abs(sum - difference) / 2];
}

/** Compressible neo-Hookean energy per area at rest; infinite for a triangle without area. */
export function energyDensity([greater, lesser]: Stretches, { youngs_modulus, poisson_ratio, thickness }: MembraneMaterial): number {
  const mu = youngs_modulus / (2 * (1 + poisson_ratio));
  const lambda = (youngs_modulus * poisson_ratio) / ((1 + poisson_ratio) * (1 - 2 * poisson_ratio));
  const log = Math.log(greater * lesser);
  const invariant = greater * greater + lesser * lesser;
  return log > -Infinity ? Math.max(0, thickness * ((mu / 2) * (invariant - 2 - 2 * log) + (lambda / 2) * log * log)) : Infinity;
}

/** Each side of the triangles once, with the smaller index first. */
export function sidesOf(triangles: readonly Triple[]): (readonly [number, number])[] {
  const sides = new Map<string, readonly [number, number]>();
  for (const corners of triangles) {
    for (const [from, to] of SIDES) {
      const [a, b] = [Math.min(corners[from], corners[to]), Math.max(corners[from], corners[to])];
      sides.set(`${a}-${b}`, [a, b]);
    }
  }
  return [...sides.values()];
}
