// The colours of springs, which are visible on the surface in the light and the dark theme.
import { cssGradient, rampColour as colourAt, type Rgb } from "../base/ramps";

export { cssGradient, type Rgb };

/** Colours from small to large values, in linear light. */
export const SPRING_RAMP: readonly Rgb[] = [
  [0.012, 0.03, 0.2],
  [0.12, 0.02, 0.3],
  [0.5, 0.02, 0.2],
  [0.87, 0.13, 0.04],
  [1, 0.52, 0.03],
];

/** The colour at a fraction of the ramp, from 0 to 1. */
export function rampColour(fraction: number, ramp: readonly Rgb[] = SPRING_RAMP): Rgb {
  return colourAt(fraction, ramp);
}

export interface Range {
  readonly min: number;
  readonly max: number;
}

/** The smallest and the largest value; [0, 0] if there are none. */
export function rangeOf(values: readonly number[]): Range {
  const min = values.reduce((smallest, value) => Math.min(smallest, value), Infinity);
  const max = values.reduce((largest, value) => Math.max(largest, value), -Infinity);
  return min <= max ? { min, max } : { min: 0, max: 0 };
}

/** The position of a value in a range, from 0 to 1; 0 if the range is only rounding errors, so that equal springs have one colour. */
export function fractionOf(value: number, { min, max }: Range): number {
  return max - min > 1e-9 * Math.abs(max) ? (value - min) / (max - min) : 0;
}
