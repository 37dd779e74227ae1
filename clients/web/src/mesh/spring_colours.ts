// Springs by colour: low to high, readable on the surface by light and by dark.

export type Rgb = readonly [number, number, number];

/** Linear light, low to high. */
export const SPRING_RAMP: readonly Rgb[] = [
  [0.012, 0.03, 0.2], [0.12, 0.02, 0.3], [0.5, 0.02, 0.2], [0.87, 0.13, 0.04], [1, 0.52, 0.03],
];

/** The colour at a share of the ramp, from 0 to 1. */
export function rampColour(share: number, ramp: readonly Rgb[] = SPRING_RAMP): Rgb {
  const place = Math.max(0, Math.min(1, share)) * (ramp.length - 1);
  const k = Math.min(Math.floor(place), ramp.length - 2);
  const part = place - k;
  return [0, 1, 2].map((channel) => (1 - part) * ramp[k][channel] + part * ramp[k + 1][channel]) as unknown as Rgb;
}

/** The same as a picture's colours are written. */
export function cssGradient(ramp: readonly Rgb[]): string {
  const stops = ramp.map(([r, g, b]) => `rgb(${[r, g, b].map((value) => Math.round(255 * value ** (1 / 2.2))).join(" ")})`);
  return `linear-gradient(to right, ${stops.join(", ")})`;
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
