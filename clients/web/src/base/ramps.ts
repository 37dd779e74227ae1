// Colour maps: colours at equal steps of a fraction, 0 for the smallest value and 1 for the largest.

/** Red, green and blue in linear light, each from 0 to 1. */
export type Rgb = readonly [number, number, number];

export type RampName = "sea" | "viridis" | "inferno" | "grey";

export const RAMP_WORDS: Readonly<Record<RampName, string>> = { sea: "Sea", viridis: "Viridis", inferno: "Inferno", grey: "Grey" };
export const RAMP_NAMES = Object.keys(RAMP_WORDS) as RampName[];

export const RAMPS: Readonly<Record<RampName, readonly Rgb[]>> = {
  sea: [[0.05, 0.2, 0.27], [0.04, 0.43, 0.41], [0.33, 0.65, 0.54], [0.76, 0.83, 0.6], [0.99, 0.92, 0.74]],
  viridis: [[0.0547, 0, 0.0867], [0.0391, 0.0827, 0.2641], [0.0109, 0.287, 0.2695], [0.1115, 0.5937, 0.1211], [0.9847, 0.8048, 0.0141]],
  inferno: [[0.0014, 0.0004, 0.0177], [0.0938, 0.0022, 0.1554], [0.5095, 0.0343, 0.0872], [0.9522, 0.276, 0.0006], [0.9738, 0.9956, 0.3811]],
  grey: [[0.0094, 0.0094, 0.0112], [0.0932, 0.0932, 0.0993], [0.2684, 0.2684, 0.2793], [0.5468, 0.5468, 0.5468], [0.9141, 0.9141, 0.8933]],
};

/** The colour at a fraction of the ramp, interpolated linearly; fractions are clamped to [0, 1]. */
export function rampColour(fraction: number, ramp: readonly Rgb[]): Rgb {
  const position = Math.max(0, Math.min(1, fraction)) * (ramp.length - 1);
  const k = Math.min(Math.floor(position), ramp.length - 2);
  const weight = position - k;
  return [0, 1, 2].map((channel) => (1 - weight) * ramp[k][channel] + weight * ramp[k + 1][channel]) as unknown as Rgb;
}

/** A colour as a CSS value, with gamma 2.2. */
export function cssColour([r, g, b]: Rgb): string {
  return `rgb(${[r, g, b].map((value) => Math.round(255 * value ** (1 / 2.2))).join(" ")})`;
}

export function cssGradient(ramp: readonly Rgb[]): string {
  return `linear-gradient(to right, ${ramp.map(cssColour).join(", ")})`;
}
