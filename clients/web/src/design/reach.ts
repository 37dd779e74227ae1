// Changes of a target that a design does not reach: one moved control point, or the target moved onto the design's response.
import { type ControlPoint, isPolar } from "./state";
import type { TargetResponse } from "./shown";
import { relativeDeviation, targetCurve } from "./spline";
import { minPoints, isAtRest, type Points, type TargetCurve, targetOnProfile } from "./targets";

/** Deviations of Poisson's ratio are relative to at least this value, since a target of zeros has no scale. */
const MIN_POISSON = 0.1;
/** Largest relative deviation of a design from a target that was moved onto its response. */
const PROJECTED_DEVIATION = 0.005;

/** A move of one control point. */
export interface Relaxation {
  readonly index: number;
  readonly from: ControlPoint;
  readonly to: ControlPoint;
  /** Relative root mean square deviation of the design after the move. */
  readonly deviation: number;
}

type ReachedProfile = Pick<TargetResponse, "task" | "points" | "interpolation" | "x" | "achieved" | "target">;

function deviationFrom({ task, achieved }: ReachedProfile, target: readonly number[]): number {
  return relativeDeviation(achieved, target, task === "poisson" ? MIN_POISSON : 0);
}

/** The samples of the target with other control points. */
function sampled({ task, interpolation, x }: ReachedProfile, points: Points): number[] {
  return x.map(targetCurve(isPolar(task), points, interpolation));
}

/**
 * The move of one control point in y that leaves the smallest deviation. The curve is linear in the y of its points (monotone curves
 * nearly so), so that the best move of each point is a projection. Null if no move reduces the deviation by more than 2 %.
 */
export function relaxation(shown: ReachedProfile): Relaxation | null {
  const { task, points, achieved, target } = shown;
  const size = Math.max(...points.map(([, y]) => Math.abs(y)), 1e-12);
  let best: Relaxation | null = null;
  points.forEach((point, index) => {
    if (isAtRest(task, point)) return;
    const moved = (by: number): Points => points.map((other, k) => (k === index ? [other[0], other[1] + by] : other));
    const step = 0.01 * size;
    const shape = sampled(shown, moved(step)).map((value, k) => (value - target[k]) / step);
    let [projection, squaredNorm] = [0, 0];
    achieved.forEach((value, k) => {
      if (value === null) return;
      projection += (value - target[k]) * shape[k];
      squaredNorm += shape[k] ** 2;
    });
    if (squaredNorm === 0) return;
    const to: ControlPoint = [point[0], validHeight(task, point[1] + projection / squaredNorm)];
    const deviation = deviationFrom(shown, sampled(shown, moved(to[1] - point[1])));
    if (!best || deviation < best.deviation) best = { index, from: point, to, deviation };
  });
  const found = best as Relaxation | null;
  return found && found.deviation < 0.98 * deviationFrom(shown, target) ? found : null;
}

function validHeight(task: TargetResponse["task"], y: number): number {
  return task === "stiffness" ? Math.max(0, y) : y;
}

/** The target moved onto the design's response. Points are added, or the interpolation is changed, if the deviation requires it. */
export function projectedTarget(shown: ReachedProfile): TargetCurve {
  const { task, points, interpolation, x, achieved } = shown;
  const known = x.flatMap((at, k): ControlPoint[] => (achieved[k] === null ? [] : [[at, achieved[k] as number]]));
  if (known.length < minPoints(task)) return { points, interpolation };
  const polar = isPolar(task);
  const last = known[known.length - 1];
  const singlePeriod = polar && last[0] - known[0][0] > Math.PI - 1e-6 ? known.slice(0, -1) : known;
  const response = targetCurve(polar, singlePeriod, "cubic");
  const moved = points.map((point): ControlPoint => (isAtRest(task, point) ? point : [point[0], response(point[0])]));
  if (deviationFrom(shown, sampled(shown, moved)) <= PROJECTED_DEVIATION) return { points: moved, interpolation };
  return targetOnProfile(task, x, achieved, points.length, interpolation, PROJECTED_DEVIATION) ?? { points, interpolation };
}
