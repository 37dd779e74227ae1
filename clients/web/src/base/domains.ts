// The domains of plot axes: all values, with a margin into which control points can be dragged.
import type { Task } from "../contract/types";

export type Domain = readonly [lower: number, upper: number];

const MARGIN = 0.25;
const MIN_HEIGHT = 1e-6;

function extremes(values: Iterable<number | null | undefined>): Domain | null {
  let lower = Infinity;
  let upper = -Infinity;
  for (const value of values) {
    if (value === null || value === undefined || !Number.isFinite(value)) continue;
    lower = Math.min(lower, value);
    upper = Math.max(upper, value);
  }
  return lower <= upper ? [lower, upper] : null;
}

/** Domain of a stress axis: the values, zero, and a margin above and below. */
export function heightDomain(values: Iterable<number | null | undefined>): Domain {
  const found = extremes(values) ?? [0, 1];
  const lower = Math.min(0, found[0]);
  const upper = Math.max(0, found[1]);
  const margin = MARGIN * Math.max(upper - lower, MIN_HEIGHT);
  // The side that hardly leaves zero gets half the margin, because targets are seldom dragged there.
  return [lower - (-lower > upper / 4 ? margin : margin / 2), upper + (upper > -lower / 4 ? margin : margin / 2)];
}

/** Domain of a strain axis: the extent of targets and curves, with a small margin on either side. */
export function widthDomain(values: Iterable<number | null | undefined>): Domain {
  const [lower, upper] = extremes(values) ?? [0, 0.1];
  const margin = 0.06 * Math.max(upper - lower, 1e-3);
  return [lower - margin, upper + margin];
}

/** The values at the centre and at the rim of a polar plot. */
export function radialDomain(task: Task, values: Iterable<number | null | undefined>): Domain {
  const [lower, upper] = extremes(values) ?? [0, 1];
  if (task === "stiffness") return [0, Math.max(upper, MIN_HEIGHT) * (1 + MARGIN)];
  const min = Math.min(lower, -0.1);
  const max = Math.max(upper, 0.1);
  const margin = MARGIN * (max - min);
  return [min - margin, max + margin];
}
