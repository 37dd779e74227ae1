// Samples of a function, for plots and files.

export type Sample = readonly [x: number, y: number];

export interface Curve {
  readonly x: readonly number[];
  /** Null at samples without an equilibrium. */
  readonly y: readonly (number | null)[];
}

/** The pieces of a curve between its gaps, the samples without a value. */
export function pieces(curve: Curve): Sample[][] {
  const result: Sample[][] = [[]];
  curve.x.forEach((x, k) => {
    const y = curve.y[k];
    if (y === null || y === undefined) result.push([]);
    else result[result.length - 1].push([x, y]);
  });
  return result.filter((piece) => piece.length > 0);
}
