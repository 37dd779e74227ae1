// Small linear systems without unique solutions: moves that keep constraints, and the smallest of several moves.
import type { Vector } from "./expressions";

/** What is left of a row after its projection, over its size, below which it depends on the other rows. */
const DEPENDENT = 1e-9;

/** Linear constraints "row times move is 0", as an orthonormal basis of their rows. */
export class Constraints {
  private constructor(readonly size: number, private readonly rows: readonly Float64Array[]) {}

  static none(size: number): Constraints {
    return new Constraints(size, []);
  }

  /** These constraints and further ones. */
  with(rows: readonly Float64Array[]): Constraints {
    const basis = [...this.rows];
    for (const row of rows) {
      const size = Math.hypot(...row);
      if (size === 0) continue;
      // Twice, because one projection leaves rounding errors of the size of what it takes away.
      const rest = without(without(row, basis), basis);
      const length = Math.hypot(...rest);
      if (length > DEPENDENT * size) basis.push(rest.map((value) => value / length));
    }
    return new Constraints(this.size, basis);
  }

  /** The move that keeps the constraints and is nearest to a vector. */
  projected(vector: Float64Array): Float64Array {
    return without(without(vector, this.rows), this.rows);
  }
}

function without(vector: Float64Array, basis: readonly Float64Array[]): Float64Array {
  const rest = vector.slice();
  for (const row of basis) {
    let along = 0;
    for (let k = 0; k < rest.length; ++k) along += row[k] * rest[k];
    for (let k = 0; k < rest.length; ++k) rest[k] -= along * row[k];
  }
  return rest;
}

export function unitVector(size: number, index: number): Float64Array {
  const vector = new Float64Array(size);
  vector[index] = 1;
  return vector;
}

/** A symmetric matrix of two rows: [xx, xy, yy]. */
export type Symmetric = readonly [xx: number, xy: number, yy: number];

/** Eigenvalues and the direction of the greater one. */
function eigen([a, b, c]: Symmetric): { readonly greater: number; readonly lesser: number; readonly direction: Vector } {
  const [mean, half] = [(a + c) / 2, (a - c) / 2];
  const radius = Math.hypot(half, b);
  const angle = Math.atan2(b, half) / 2;
  return { greater: mean + radius, lesser: mean - radius, direction: [Math.cos(angle), Math.sin(angle)] };
}

/** In how many directions a symmetric matrix moves a vector by more than `min`. */
export function rankOf(matrix: Symmetric, min: number): number {
  const { greater, lesser } = eigen(matrix);
  return [greater, lesser].filter((value) => value > min).length;
}

/** The smallest vector that the matrix takes as near to `to` as any. Directions that it moves by no more than `min` are left out. */
export function solved(matrix: Symmetric, [x, y]: Vector, min: number): Vector {
  const { greater, lesser, direction: [c, s] } = eigen(matrix);
  const inverse = (value: number) => (value > min ? 1 / value : 0);
  const [along, across] = [inverse(greater) * (c * x + s * y), inverse(lesser) * (c * y - s * x)];
  return [c * along - s * across, s * along + c * across];
}
