// Operations on the control points of a target, which keep their x increasing.
import type { Curve } from "../base/curve";
import type { StrainMeasure, Task } from "../contract/types";
import { type ControlPoint, type Interpolation, isPolar, type Target } from "./state";
import { relativeDeviation, targetCurve } from "./spline";

export type Points = readonly ControlPoint[];

/** Minimum distance of neighbours in x, as a fraction of the allowed extent. */
const MIN_GAP = 1 / 200;
const MAX_POINTS = 64;

/** The allowed x of control points. */
export interface Extent {
  readonly lower: number;
  readonly upper: number;
}

/** Numbers of control points of a target that is made from a profile. */
const POINTS_OVER_STRAIN = 7;
const POINTS_OVER_DIRECTIONS = 6;
/** Relative deviation from a profile up to which control points are added to a target on it. */
const PROFILE_DEVIATION = 0.01;
const MAX_PROFILE_POINTS = 24;
/** Deviations of Poisson's ratio are relative to at least this value, since a target of zeros has no scale. */
const MIN_POISSON = 0.1;
/** Stresses at rest below this fraction of the largest value are rounding errors. */
const ROUNDING = 1e-9;

export const HALF_TURN: Extent = { lower: 0, upper: Math.PI };

export function minPoints(task: Task): number {
  return isPolar(task) ? 3 : 2;
}

/** Strains below this value count as 0: they are rounding errors of numbers with few digits. */
const REST_STRAIN = 1e-6;

/** Whether a control point is at rest. It is fixed, since there is no stress without strain. */
export function isAtRest(task: Task, [x]: ControlPoint): boolean {
  return !isPolar(task) && Math.abs(x) < REST_STRAIN;
}

/** The angle in [0, pi) of the same undirected direction. */
export function wrapped(angle: number): number {
  const rest = angle % Math.PI;
  return rest < 0 ? rest + Math.PI : rest;
}

function zeroedAtRest(task: Task, point: ControlPoint): ControlPoint {
  return isAtRest(task, point) ? [0, 0] : point;
}

/** The points after one was moved, and its new index: over direction a point may pass others. */
export function movePoint(task: Task, points: Points, index: number, to: ControlPoint, extent: Extent): [Points, number] {
  return isPolar(task) ? moveAround(points, index, to) : [moveBetween(points, index, to, extent), index];
}

function moveBetween(points: Points, index: number, [x, y]: ControlPoint, extent: Extent): Points {
  if (isAtRest("stress_strain", points[index])) return points;
  const gap = MIN_GAP * (extent.upper - extent.lower);
  const lower = index > 0 ? points[index - 1][0] + gap : extent.lower;
  const upper = index + 1 < points.length ? points[index + 1][0] - gap : extent.upper;
  const moved = zeroedAtRest("stress_strain", [Math.max(lower, Math.min(upper, x)), y]);
  return points.map((point, k) => (k === index ? moved : point));
}

function moveAround(points: Points, index: number, [x, y]: ControlPoint): [Points, number] {
  const gap = MIN_GAP * Math.PI;
  const others = points.filter((_, k) => k !== index);
  let angle = wrapped(x);
  for (const [other] of others) {
    const distance = Math.abs(angle - other);
    if (Math.min(distance, Math.PI - distance) < gap) angle = points[index][0]; // too close to another point: the angle is kept
  }
  const moved: ControlPoint = [angle, y];
  const sorted = [...others, moved].sort((a, b) => a[0] - b[0]);
  return [sorted, sorted.indexOf(moved)];
}

/** The points with a new one, and its index; null if it is too close to others or outside the extent. */
export function addPoint(task: Task, points: Points, [x, y]: ControlPoint, extent: Extent): [Points, number] | null {
  if (points.length >= MAX_POINTS) return null;
  const at = isPolar(task) ? wrapped(x) : x;
  const gap = MIN_GAP * (extent.upper - extent.lower);
  if (at < extent.lower || at > extent.upper) return null;
  for (const [other] of points) {
    const distance = Math.abs(at - other);
    if (distance < gap || (isPolar(task) && Math.PI - distance < gap)) return null;
  }
  const added = zeroedAtRest(task, [at, y]);
  const sorted = [...points, added].sort((a, b) => a[0] - b[0]);
  return [sorted, sorted.indexOf(added)];
}

/** The x midway between a point and the next one, where a further point fits; after the last point of a curve over strain, midway to the previous one. */
export function middleOfGapAfter(task: Task, points: Points, index: number): number {
  const next = index + 1 < points.length ? points[index + 1][0] : isPolar(task) ? points[0][0] + Math.PI : undefined;
  if (next !== undefined) return (points[index][0] + next) / 2;
  return (points[index - 1][0] + points[index][0]) / 2;
}

/** The points without one of them; unchanged if too few would remain. */
export function removePoint(task: Task, points: Points, index: number): Points {
  return points.length > minPoints(task) ? points.filter((_, k) => k !== index) : points;
}

/**
 * Control points on a sampled profile: `count` of them, evenly spaced over the samples. More are added until the curve through them
 * follows the profile within `tolerance`.
 */
export function pointsOnProfile(
  task: Task,
  x: readonly number[],
  y: readonly (number | null)[],
  count: number,
  interpolation: Interpolation = "cubic",
  tolerance = PROFILE_DEVIATION,
): Points {
  const known = x.map((value, k) => [value, y[k]] as const).filter((pair): pair is [number, number] => pair[1] !== null);
  if (known.length < minPoints(task)) return [];
  const rest = ROUNDING * Math.max(...known.map(([, value]) => Math.abs(value)));
  const pointAt = (k: number): ControlPoint => zeroedAtRest(task, Math.abs(known[k][1]) <= rest ? [known[k][0], 0] : known[k]);
  const values = known.map(([, value]) => value);
  // A point is added at the sample with the largest deviation, one at a time.
  let chosen = evenIndices(task, known, count);
  while (chosen.length < Math.min(MAX_PROFILE_POINTS, known.length)) {
    const curve = known.map(([at]) => at).map(targetCurve(isPolar(task), chosen.map(pointAt), interpolation));
    if (relativeDeviation(values, curve, task === "poisson" ? MIN_POISSON : 0) <= tolerance) break;
    const free = known.map((_, k) => k).filter((k) => !chosen.includes(k) && !(isPolar(task) && known[k][0] >= known[0][0] + Math.PI - 1e-9));
    if (free.length === 0) break;
    const worst = free.reduce((most, k) => (Math.abs(curve[k] - values[k]) > Math.abs(curve[most] - values[most]) ? k : most));
    chosen = [...chosen, worst].sort((x, y) => x - y);
  }
  return chosen.map(pointAt);
}

/** Control points and their interpolation. */
export interface TargetCurve {
  readonly points: Points;
  readonly interpolation: Interpolation;
}

/**
 * The target that follows a sampled profile. It has the given interpolation if that follows the profile within `tolerance`, otherwise
 * the one that follows it best: a smooth curve oscillates beside a jump, so that no design would meet it. Null if the profile has too
 * few values.
 */
export function targetOnProfile(
  task: Task,
  x: readonly number[],
  y: readonly (number | null)[],
  count: number,
  interpolation: Interpolation,
  tolerance = PROFILE_DEVIATION,
): TargetCurve | null {
  const known = x.flatMap((at, k): ControlPoint[] => (y[k] === null ? [] : [[at, y[k] as number]]));
  const deviation = ({ points, interpolation: curve }: TargetCurve): number =>
    relativeDeviation(known.map(([, value]) => value), known.map(([at]) => at).map(targetCurve(isPolar(task), points, curve)), task === "poisson" ? MIN_POISSON : 0);
  let best: TargetCurve | null = null;
  for (const curve of new Set<Interpolation>([interpolation, "monotone", "linear"])) {
    const tried: TargetCurve = { points: pointsOnProfile(task, x, y, count, curve, tolerance), interpolation: curve };
    if (tried.points.length === 0) return null;
    if (!best || deviation(tried) < deviation(best)) best = tried;
    if (deviation(best) <= tolerance) break;
  }
  return best;
}

/** The target that follows a curve; null without a curve, or if it has too few values. */
export function targetOnCurve(curve: Curve | null, { task, interpolation }: Pick<Target, "task" | "interpolation">): TargetCurve | null {
  return curve && targetOnProfile(task, curve.x, curve.y, isPolar(task) ? POINTS_OVER_DIRECTIONS : POINTS_OVER_STRAIN, interpolation);
}

/** Indices of `count` evenly spaced samples. Over direction, a last sample that repeats the first is left out; over strain, the sample at rest is added. */
function evenIndices(task: Task, known: readonly ControlPoint[], count: number): number[] {
  const places = Array.from({ length: count }, (_, k) => Math.round(isPolar(task) ? (k * known.length) / count : (k * (known.length - 1)) / (count - 1)));
  const rest = known.findIndex((point) => isAtRest(task, point));
  return [...new Set(rest < 0 ? places : [...places, rest])].sort((a, b) => a - b).filter((k) =>
    k < known.length && (!isPolar(task) || known[k][0] < known[0][0] + Math.PI - 1e-9)
  );
}

/** A strain converted to a measure from the other one. */
export function convertedStrain(strain: number, to: StrainMeasure): number {
  return to === "engineering" ? Math.sqrt(1 + 2 * strain) - 1 : ((1 + strain) ** 2 - 1) / 2;
}

/** Control points of stress over strain, converted to a measure: forces per rest width are second Piola-Kirchhoff stresses times the stretch. */
export function convertedPoints(points: Points, to: StrainMeasure): Points {
  return points.map(([x, y]) => to === "engineering" ? [convertedStrain(x, to), y * Math.sqrt(1 + 2 * x)] : [convertedStrain(x, to), y / (1 + x)]);
}
