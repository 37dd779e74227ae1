// Control points of a target: moved, added and removed so that their x stays increasing.
import type { StrainMeasure, Task } from "../contract/types";
import { type ControlPoint, type Interpolation, isPolar } from "./state";
import { relativeDeviation, targetCurve } from "./spline";

export type Points = readonly ControlPoint[];

/** Least distance of neighbours in x, as a share of the width that they may cover. */
const LEAST_GAP = 1 / 200;
const MOST_POINTS = 64;

/** Where the control points of a task may lie. */
export interface Extent {
  readonly lower: number;
  readonly upper: number;
}

/** Points on a profile follow it within this share, if need be with more of them than were asked for. */
const PROFILE_DEVIATION = 0.01;
const MOST_ON_PROFILE = 24;
/** Poisson's ratio is compared with at least this. */
const LEAST_POISSON = 0.1;
/** Below this share of the largest value a stress at rest is rounding. */
const ROUNDING = 1e-9;

export const HALF_TURN: Extent = { lower: 0, upper: Math.PI };

export function fewestPoints(task: Task): number {
  return isPolar(task) ? 3 : 2;
}

/** Strains below are rounding of numbers that were written with few digits. */
const REST = 1e-6;

/** Whether a point of a target is at rest: without strain there is no stress, so that it stays where it is. */
export function isAtRest(task: Task, [x]: ControlPoint): boolean {
  return !isPolar(task) && Math.abs(x) < REST;
}

/** The angle within [0, pi) of the same direction. */
export function wrapped(angle: number): number {
  const rest = angle % Math.PI;
  return rest < 0 ? rest + Math.PI : rest;
}

function atRest(task: Task, point: ControlPoint): ControlPoint {
  return isAtRest(task, point) ? [0, 0] : point;
}

/** The points with one moved, and its index among them: over directions it may pass the others. */
export function movePoint(task: Task, points: Points, index: number, to: ControlPoint, extent: Extent): [Points, number] {
  return isPolar(task) ? moveAround(points, index, to) : [moveBetween(points, index, to, extent), index];
}

function moveBetween(points: Points, index: number, [x, y]: ControlPoint, extent: Extent): Points {
  if (isAtRest("stress_strain", points[index])) return points;
  const gap = LEAST_GAP * (extent.upper - extent.lower);
  const lower = index > 0 ? points[index - 1][0] + gap : extent.lower;
  const upper = index + 1 < points.length ? points[index + 1][0] - gap : extent.upper;
  const moved = atRest("stress_strain", [Math.max(lower, Math.min(upper, x)), y]);
  return points.map((point, k) => (k === index ? moved : point));
}

function moveAround(points: Points, index: number, [x, y]: ControlPoint): [Points, number] {
  const gap = LEAST_GAP * Math.PI;
  const others = points.filter((_, k) => k !== index);
  let angle = wrapped(x);
  for (const [other] of others) {
    const apart = Math.abs(angle - other);
    if (Math.min(apart, Math.PI - apart) < gap) angle = points[index][0]; // stays beside what it would fall onto
  }
  const moved: ControlPoint = [angle, y];
  const sorted = [...others, moved].sort((a, b) => a[0] - b[0]);
  return [sorted, sorted.indexOf(moved)];
}

/** The points with one more, and its index; null where there is no room for it. */
export function addPoint(task: Task, points: Points, [x, y]: ControlPoint, extent: Extent): [Points, number] | null {
  if (points.length >= MOST_POINTS) return null;
  const at = isPolar(task) ? wrapped(x) : x;
  const gap = LEAST_GAP * (extent.upper - extent.lower);
  if (at < extent.lower || at > extent.upper) return null;
  for (const [other] of points) {
    const apart = Math.abs(at - other);
    if (apart < gap || (isPolar(task) && Math.PI - apart < gap)) return null;
  }
  const added = atRest(task, [at, y]);
  const sorted = [...points, added].sort((a, b) => a[0] - b[0]);
  return [sorted, sorted.indexOf(added)];
}

/** The x in the middle of the widest gap after the point, where a further one fits best. */
export function roomAfter(task: Task, points: Points, index: number): number {
  const next = index + 1 < points.length ? points[index + 1][0] : isPolar(task) ? points[0][0] + Math.PI : undefined;
  if (next !== undefined) return (points[index][0] + next) / 2;
  return (points[index - 1][0] + points[index][0]) / 2;
}

/** The points without one; the same points where too few would remain. */
export function removePoint(task: Task, points: Points, index: number): Points {
  return points.length > fewestPoints(task) ? points.filter((_, k) => k !== index) : points;
}

/**
 * Control points on a sampled profile, evenly spaced over its samples: `count`, or as many more as the curve through
 * them needs to follow the profile.
 */
export function pointsOnProfile(task: Task, x: readonly number[], y: readonly (number | null)[], count: number, interpolation: Interpolation = "cubic", tolerance = PROFILE_DEVIATION): Points {
  const known = x.map((value, k) => [value, y[k]] as const).filter((pair): pair is [number, number] => pair[1] !== null);
  if (known.length < fewestPoints(task)) return [];
  const rest = ROUNDING * Math.max(...known.map(([, value]) => Math.abs(value)));
  const pointAt = (k: number): ControlPoint => atRest(task, Math.abs(known[k][1]) <= rest ? [known[k][0], 0] : known[k]);
  const values = known.map(([, value]) => value);
  // Evenly at first; then one more where the curve is farthest from the profile.
  let chosen = evenly(task, known, count);
  while (chosen.length < Math.min(MOST_ON_PROFILE, known.length)) {
    const curve = known.map(([at]) => at).map(targetCurve(isPolar(task), chosen.map(pointAt), interpolation));
    if (relativeDeviation(values, curve, task === "poisson" ? LEAST_POISSON : 0) <= tolerance) break;
    const free = known.map((_, k) => k).filter((k) => !chosen.includes(k) && !(isPolar(task) && known[k][0] >= known[0][0] + Math.PI - 1e-9));
    if (free.length === 0) break;
    const worst = free.reduce((most, k) => (Math.abs(curve[k] - values[k]) > Math.abs(curve[most] - values[most]) ? k : most));
    chosen = [...chosen, worst].sort((x, y) => x - y);
  }
  return chosen.map(pointAt);
}

/** A curve through control points. */
export interface TargetCurve {
  readonly points: Points;
  readonly interpolation: Interpolation;
}

/**
 * The target that a sampled profile becomes: of this interpolation where it follows the profile, otherwise of the one that follows
 * it best. A smooth curve swings beside a jump, so that no design would meet it. Null where too little is known of the profile.
 */
export function targetOnProfile(task: Task, x: readonly number[], y: readonly (number | null)[], count: number, interpolation: Interpolation, tolerance = PROFILE_DEVIATION): TargetCurve | null {
  const known = x.flatMap((at, k): ControlPoint[] => (y[k] === null ? [] : [[at, y[k] as number]]));
  const deviation = ({ points, interpolation: curve }: TargetCurve): number =>
    relativeDeviation(known.map(([, value]) => value), known.map(([at]) => at).map(targetCurve(isPolar(task), points, curve)), task === "poisson" ? LEAST_POISSON : 0);
  let best: TargetCurve | null = null;
  for (const curve of new Set<Interpolation>([interpolation, "monotone", "linear"])) {
    const tried: TargetCurve = { points: pointsOnProfile(task, x, y, count, curve, tolerance), interpolation: curve };
    if (tried.points.length === 0) return null;
    if (!best || deviation(tried) < deviation(best)) best = tried;
    if (deviation(best) <= tolerance) break;
  }
  return best;
}

/** Indices of so many samples, evenly spaced; over directions without one that repeats the first, over strain with the state at rest. */
function evenly(task: Task, known: readonly ControlPoint[], count: number): number[] {
  const places = Array.from({ length: count }, (_, k) => Math.round(isPolar(task) ? (k * known.length) / count : (k * (known.length - 1)) / (count - 1)));
  const rest = known.findIndex((point) => isAtRest(task, point));
  return [...new Set(rest < 0 ? places : [...places, rest])].sort((a, b) => a - b).filter((k) => k < known.length && (!isPolar(task) || known[k][0] < known[0][0] + Math.PI - 1e-9));
}

/** The same strain in another measure. */
export function convertedStrain(strain: number, to: StrainMeasure): number {
  return to === "engineering" ? Math.sqrt(1 + 2 * strain) - 1 : ((1 + strain) ** 2 - 1) / 2;
}

/** A target of stress over strain in another measure: forces per rest width are stresses times the stretch. */
export function convertedPoints(points: Points, to: StrainMeasure): Points {
  return points.map(([x, y]) =>
    to === "engineering" ? [convertedStrain(x, to), y * Math.sqrt(1 + 2 * x)] : [convertedStrain(x, to), y / (1 + x)],
  );
}
