// The curve through control points, computed as the server does, for display before the server answers.
import type { ControlPoint, Interpolation } from "./state";

type Curve = (x: number) => number;

/** The curve over strain, extrapolated linearly beyond its ends. */
export function openCurve(points: readonly ControlPoint[], interpolation: Interpolation): Curve {
  const x = points.map((p) => p[0]);
  const y = points.map((p) => p[1]);
  if (points.length < 2) return () => y[0] ?? 0;
  return hermite(x, y, slopes(x, y, interpolation));
}

/** The curve over directions, with period pi. */
export function periodicCurve(points: readonly ControlPoint[], interpolation: Interpolation): Curve {
  const count = points.length;
  if (count < 2) return () => points[0]?.[1] ?? 0;
  // The influence of the ends decays from period to period: after two periods, or four of few points, it is below rounding.
  const periods = count < 6 ? 9 : 5;
  const middle = (periods - 1) / 2;
  const copies = Array.from({ length: periods * count }, (_, k): ControlPoint => {
    const [x, y] = points[k % count];
    return [x + Math.PI * (Math.floor(k / count) - middle), y];
  });
  const curve = openCurve(copies, interpolation);
  const first = points[0][0];
  return (x) => curve(x - Math.PI * Math.floor((x - first) / Math.PI));
}

function slopes(x: number[], y: number[], interpolation: Interpolation): number[] | null {
  if (interpolation === "linear") return null;
  return interpolation === "cubic" ? naturalSlopes(x, y) : monotoneSlopes(x, y);
}

/** First derivatives of the natural cubic spline, from the tridiagonal system for continuous second derivatives. */
function naturalSlopes(x: number[], y: number[]): number[] {
  const n = x.length;
  const diagonal = new Array<number>(n);
  const superdiagonal = new Array<number>(n);
  const rhs = new Array<number>(n);
  for (let k = 0; k < n; ++k) {
    const before = k > 0 ? 1 / (x[k] - x[k - 1]) : 0;
    const after = k + 1 < n ? 1 / (x[k + 1] - x[k]) : 0;
    let pivot = 2 * (before + after);
    let value = 0;
    if (k > 0) value += 3 * (y[k] - y[k - 1]) * before * before;
    if (k + 1 < n) value += 3 * (y[k + 1] - y[k]) * after * after;
    if (k > 0) {
      const factor = before / diagonal[k - 1];
      pivot -= factor * superdiagonal[k - 1];
      value -= factor * rhs[k - 1];
    }
    diagonal[k] = pivot;
    superdiagonal[k] = after;
    rhs[k] = value;
  }
  const slope = new Array<number>(n);
  for (let k = n - 1; k >= 0; --k) {
    slope[k] = (rhs[k] - (k + 1 < n ? superdiagonal[k] * slope[k + 1] : 0)) / diagonal[k];
  }
  return slope;
}

/** Weighted harmonic means of the secants [Fritsch1984]: zero at extrema, the secant at the ends. */
function monotoneSlopes(x: number[], y: number[]): number[] {
  const n = x.length;
  const width = Array.from({ length: n - 1 }, (_, k) => x[k + 1] - x[k]);
  const secant = width.map((w, k) => (y[k + 1] - y[k]) / w);
  return y.map((_, k) => {
    if (k === 0 || k === n - 1) return secant[Math.min(k, n - 2)];
    if (secant[k - 1] * secant[k] <= 0) return 0;
    const a = 2 * width[k] + width[k - 1];
    const b = width[k] + 2 * width[k - 1];
    return (a + b) / (a / secant[k - 1] + b / secant[k]);
  });
}

/** The cubic Hermite interpolant with given slopes; piecewise linear if there are none. */
function hermite(x: number[], y: number[], slope: number[] | null): Curve {
  const last = x.length - 1;
  return (at) => {
    let k = 0;
    while (k + 2 < x.length && at > x[k + 1]) ++k;
    const width = x[k + 1] - x[k];
    const t = (at - x[k]) / width;
    if (!slope) return y[k] + t * (y[k + 1] - y[k]);
    if (at < x[0]) return y[0] + slope[0] * (at - x[0]);
    if (at > x[last]) return y[last] + slope[last] * (at - x[last]);
    const u = 1 - t;
    return (
      u * u * ((1 + 2 * t) * y[k] + t * width * slope[k]) + t * t * ((3 - 2 * t) * y[k + 1] - u * width * slope[k + 1])
    );
  };
}

/** The target as a curve. */
export function targetCurve(polar: boolean, points: readonly ControlPoint[], interpolation: Interpolation): Curve {
  return polar ? periodicCurve(points, interpolation) : openCurve(points, interpolation);
}

/** Evenly spaced values, both ends included. */
export function spaced(from: number, to: number, count: number): number[] {
  return Array.from({ length: count }, (_, k) => from + ((to - from) * k) / (count - 1));
}

/** Root mean square of y - target over that of the target, at samples with a value. `floor`: lower limit of the denominator. */
export function relativeDeviation(y: readonly (number | null)[], target: readonly number[], floor = 0): number {
  let deviation = 0;
  let size = 0;
  let count = 0;
  y.forEach((value, k) => {
    if (value === null) return;
    deviation += (value - target[k]) ** 2;
    size += target[k] ** 2;
    ++count;
  });
  return count === 0 ? Infinity : Math.sqrt(deviation / count) / Math.max(Math.sqrt(size / count), floor, 1e-300);
}
