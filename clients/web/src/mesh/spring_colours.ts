// Springs by colour: low to high, readable on the surface by light and by dark.
import { cssGradient, rampColour as colourAt, type Rgb } from "../base/ramps";

export { cssGradient, type Rgb };

/** Linear light, low to high. */
export const SPRING_RAMP: readonly Rgb[] = [
  [0.012, 0.03, 0.2], [0.12, 0.02, 0.3], [0.5, 0.02, 0.2], [0.87, 0.13, 0.04], [1, 0.52, 0.03],
];

/** The colour at a share of the ramp, from 0 to 1. */
export function rampColour(share: number, ramp: readonly Rgb[] = SPRING_RAMP): Rgb {
  return colourAt(share, ramp);
}

export interface Range {
  readonly least: number;
  readonly most: number;
}

/** Least and largest value; springs that differ by rounding alone are of one colour. */
export function rangeOf(values: readonly number[]): Range {
  const least = values.reduce((low, value) => Math.min(low, value), Infinity);
  const most = values.reduce((high, value) => Math.max(high, value), -Infinity);
  return least <= most ? { least, most } : { least: 0, most: 0 };
}

export function shareOf(value: number, { least, most }: Range): number {
  return most - least > 1e-9 * Math.abs(most) ? (value - least) / (most - least) : 0;
}
