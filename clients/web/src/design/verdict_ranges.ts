// The ranges of a target that are met equally well, divided as the server divides them.
import type { Task } from "../contract/types";
import { partOf } from "./curve_parts";
import { isPolar } from "./state";
import { type CurvePart, type Fit, limits } from "./verdict_words";

/** A target at its samples, and a response there; null where it has no value. */
export interface JudgedCurve {
  readonly task: Task;
  readonly x: readonly number[];
  readonly target: readonly number[];
  readonly y: readonly (number | null)[];
}

export interface FitRange {
  /** Strain, or angle in radians. */
  readonly from: number;
  readonly to: number;
  readonly fit: Fit;
  readonly part: CurvePart;
  /** Root mean square of the deviations over the target's scale; null if a value is missing. */
  readonly deviation: number | null;
  readonly samples: number;
}

/** Deviations of Poisson's ratio are relative to at least this value, since a target of zeros has no scale; of stresses and stiffnesses in MPa. */
const MIN_SCALE: Record<Task, number> = { stress_strain: 1e-6, stiffness: 1e-6, poisson: 0.1 };

/** Strains up to this fraction of the largest one are near rest. */
const MAX_REST_FRACTION = 0.05;

const FROM_BEST: readonly Fit[] = ["reached", "near", "missed", "missing"];

export function badness(fit: Fit): number {
  return FROM_BEST.indexOf(fit);
}

/** What deviations are relative to: the root mean square of the target. */
export function scaleOf({ task, target }: Pick<JudgedCurve, "task" | "target">): number {
  return Math.max(MIN_SCALE[task], rootMeanSquare(target));
}

/** The deviation from the target, relative to its scale; null if a value is missing. */
export function deviationOf(curve: JudgedCurve): number | null {
  return rangeDeviation(curve, 0, curve.x.length);
}

/** The largest deviation of a sample that is reached. Relative deviations mean nothing where Poisson's ratio is near 0. */
export function toleranceOf({ task, target }: Pick<JudgedCurve, "task" | "target">): number {
  const relative = limits.sample * scaleOf({ task, target });
  return task === "poisson" ? Math.max(relative, limits.poisson_sample) : relative;
}

export function reachedSamples({ task, target, y }: JudgedCurve): number {
  const tolerance = toleranceOf({ task, target });
  return y.filter((value, k) => value !== null && Math.abs(value - target[k]) <= tolerance).length;
}

/**
 * The ranges are contiguous and cover the target. Two of them meet halfway between their samples, or at a sample near rest, which each design
 * with little stress reaches: it belongs to the worse of the ranges beside it.
 */
export function fitRanges(curve: JudgedCurve): FitRange[] {
  const { task, x, target } = curve;
  const own = fitsOf(curve);
  const trivial = trivialSamples(curve, own);
  const fits = withoutTrivial(trivial, own);
  const border = (k: number): number => (trivial[k] ? x[k] : trivial[k - 1] ? x[k - 1] : (x[k - 1] + x[k]) / 2);
  const ranges: FitRange[] = [];
  for (let first = 0, end = 1; first < x.length; first = end++) {
    while (end < x.length && fits[end] === fits[first]) ++end;
    ranges.push({
      from: first === 0 ? x[0] : border(first),
      to: end < x.length ? border(end) : isPolar(task) ? x[0] + Math.PI : x[end - 1],
      fit: fits[first],
      part: partOf(task, x, target, first, end - 1),
      deviation: rangeDeviation(curve, first, end),
      samples: end - first,
    });
  }
  return ranges;
}

/** The ranges as a person sees them: over directions the last and the first are one if they have the same fit, since directions repeat. */
export function joinedAcrossPeriod(ranges: readonly FitRange[], task: Task): readonly FitRange[] {
  const [first, last] = [ranges[0], ranges[ranges.length - 1]];
  if (!isPolar(task) || ranges.length < 2 || first.fit !== last.fit) return ranges;
  return [{ ...first, from: last.from - Math.PI, deviation: joinedDeviation([first, last]), samples: first.samples + last.samples }, ...ranges.slice(1, -1)];
}

/** The root mean square of the deviations of ranges; null if a value is missing. */
export function joinedDeviation(ranges: readonly FitRange[]): number | null {
  if (ranges.length === 1) return ranges[0].deviation;
  let [squares, samples] = [0, 0];
  for (const { deviation, samples: count } of ranges) {
    if (deviation === null) return null;
    squares += count * deviation ** 2;
    samples += count;
  }
  return Math.sqrt(squares / samples);
}

function fitsOf({ task, target, y }: JudgedCurve): Fit[] {
  const scale = scaleOf({ task, target });
  const tolerance = toleranceOf({ task, target });
  return y.map((value, k): Fit => {
    if (value === null || !Number.isFinite(value)) return "missing";
    const deviation = Math.abs(value - target[k]);
    return deviation <= tolerance ? "reached" : deviation <= limits.reached * scale ? "near" : "missed";
  });
}

/** Whether each sample says nothing about the design: it is near rest, and the target is within the tolerance of 0 and reached. */
function trivialSamples({ task, x, target }: JudgedCurve, own: readonly Fit[]): readonly boolean[] {
  const tolerance = toleranceOf({ task, target });
  const rest = MAX_REST_FRACTION * Math.max(Math.abs(x[0]), Math.abs(x[x.length - 1]));
  return own.map((fit, k) => fit === "reached" && !isPolar(task) && Math.abs(x[k]) <= rest && Math.abs(target[k]) <= tolerance);
}

/** Gives trivial samples the worse of the fits beside them. */
function withoutTrivial(trivial: readonly boolean[], own: readonly Fit[]): readonly Fit[] {
  return own.map((fit, k) => {
    if (!trivial[k]) return fit;
    let [before, after] = [k, k];
    while (before > 0 && trivial[before]) --before;
    while (after + 1 < own.length && trivial[after]) ++after;
    return [before, after].map((beside) => own[beside]).filter((one) => one !== "missing").reduce((worst, one) => (badness(one) > badness(worst) ? one : worst), fit);
  });
}

function rangeDeviation({ task, target, y }: JudgedCurve, first: number, end: number): number | null {
  const values = y.slice(first, end);
  if (values.length === 0 || values.some((value) => value === null || !Number.isFinite(value))) return null;
  return rootMeanSquare(values.map((value, k) => (value as number) - target[first + k])) / scaleOf({ task, target });
}

function rootMeanSquare(values: readonly number[]): number {
  return values.length === 0 ? 0 : Math.sqrt(values.reduce((sum, value) => sum + value * value, 0) / values.length);
}
