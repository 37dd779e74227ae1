// How much of the plane a plot shows: all that matters, with room to drag into.
import type { Task } from "../contract/types";

export type Domain = readonly [lower: number, upper: number];

const ROOM = 0.25;
const LEAST_HEIGHT = 1e-6;

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

/** Stress: the values, zero, and room above and below for what is dragged there. */
export function heightDomain(values: Iterable<number | null | undefined>): Domain {
  const found = extremes(values) ?? [0, 1];
  const lower = Math.min(0, found[0]);
  const upper = Math.max(0, found[1]);
  const room = ROOM * Math.max(upper - lower, LEAST_HEIGHT);
  // Below a target that hardly falls under zero there is little to drag for.
  return [lower - (-lower > upper / 4 ? room : room / 2), upper + (upper > -lower / 4 ? room : room / 2)];
}

/** Strain: the extent of the targets and curves, a little more on either side. */
export function widthDomain(values: Iterable<number | null | undefined>): Domain {
  const [lower, upper] = extremes(values) ?? [0, 0.1];
  const room = 0.06 * Math.max(upper - lower, 1e-3);
  return [lower - room, upper + room];
}

/** Values at the centre and at the rim of a polar plot. */
export function radialDomain(task: Task, values: Iterable<number | null | undefined>): Domain {
  const [lower, upper] = extremes(values) ?? [0, 1];
  if (task === "stiffness") return [0, Math.max(upper, LEAST_HEIGHT) * (1 + ROOM)];
  const least = Math.min(lower, -0.1);
  const most = Math.max(upper, 0.1);
  const room = ROOM * (most - least);
  return [least - room, most + room];
}
