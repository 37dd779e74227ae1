// Samples of a function, as plots draw and files keep them.

export type Sample = readonly [x: number, y: number];

export interface Curve {
  readonly x: readonly number[];
  /** null where there is no equilibrium. */
  readonly y: readonly (number | null)[];
}

/** Pieces of a curve between its gaps. */
export function pieces(curve: Curve): Sample[][] {
  const result: Sample[][] = [[]];
  curve.x.forEach((x, k) => {
    const y = curve.y[k];
    if (y === null || y === undefined) result.push([]);
    else result[result.length - 1].push([x, y]);
  });
  return result.filter((piece) => piece.length > 0);
}
