// What a target would have to give up so that the design at hand follows it.
import { type ControlPoint, isPolar } from "./state";
import type { Shown } from "./shown";
import { relativeDeviation, targetCurve } from "./spline";
import { fewestPoints, isAtRest, type Points, type TargetCurve, targetOnProfile } from "./targets";

const LEAST_POISSON = 0.1;
/** A moved target may be missed by so much: it follows what a design does. */
const SNAPPED = 0.005;

/** Moving one control point alone. */
export interface Relaxation {
  readonly index: number;
  readonly from: ControlPoint;
  readonly to: ControlPoint;
  /** Relative root mean square deviation that this design would have left. */
  readonly deviation: number;
}

type Answer = Pick<Shown, "task" | "points" | "interpolation" | "x" | "achieved" | "target">;

function deviationFrom({ task, achieved }: Answer, target: readonly number[]): number {
  return relativeDeviation(achieved, target, task === "poisson" ? LEAST_POISSON : 0);
}

/** The target's samples with other control points. */
function sampled({ task, interpolation, x }: Answer, points: Points): number[] {
  return x.map(targetCurve(isPolar(task), points, interpolation));
}

/**
 * The control point that keeps the target away most, and where it should go: the one whose best move, alone, leaves
 * the least deviation. The curve is linear in the heights of its points (nearly so without overshoot), so that each
 * best move is a projection. Null where none helps.
 */
export function relaxation(shown: Answer): Relaxation | null {
  const { task, points, achieved, target } = shown;
  const size = Math.max(...points.map(([, y]) => Math.abs(y)), 1e-12);
  let best: Relaxation | null = null;
  points.forEach((point, index) => {
    if (isAtRest(task, point)) return;
    const moved = (by: number): Points => points.map((other, k) => (k === index ? [other[0], other[1] + by] : other));
    const step = 0.01 * size;
    const shape = sampled(shown, moved(step)).map((value, k) => (value - target[k]) / step);
    let [along, square] = [0, 0];
    achieved.forEach((value, k) => {
      if (value === null) return;
      along += (value - target[k]) * shape[k];
      square += shape[k] ** 2;
    });
    if (square === 0) return;
    const to: ControlPoint = [point[0], heightOf(task, point[1] + along / square)];
    const deviation = deviationFrom(shown, sampled(shown, moved(to[1] - point[1])));
    if (!best || deviation < best.deviation) best = { index, from: point, to, deviation };
  });
  const found = best as Relaxation | null;
  return found && found.deviation < 0.98 * deviationFrom(shown, target) ? found : null;
}

function heightOf(task: Shown["task"], y: number): number {
  return task === "stiffness" ? Math.max(0, y) : y;
}

/** The target moved onto what the design does; with as many more points, and with another curve between them, as that takes. */
export function snappedTarget(shown: Answer): TargetCurve {
  const { task, points, interpolation, x, achieved } = shown;
  const known = x.flatMap((at, k): ControlPoint[] => (achieved[k] === null ? [] : [[at, achieved[k] as number]]));
  if (known.length < fewestPoints(task)) return { points, interpolation };
  const polar = isPolar(task);
  const last = known[known.length - 1];
  const once = polar && last[0] - known[0][0] > Math.PI - 1e-6 ? known.slice(0, -1) : known;
  const response = targetCurve(polar, once, "cubic");
  const moved = points.map((point): ControlPoint => (isAtRest(task, point) ? point : [point[0], response(point[0])]));
  if (deviationFrom(shown, sampled(shown, moved)) <= SNAPPED) return { points: moved, interpolation };
  return targetOnProfile(task, x, achieved, points.length, interpolation, SNAPPED) ?? { points, interpolation };
}
