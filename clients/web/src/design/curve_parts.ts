// What a range of a target's curve looks like, as the server names it. Over strain it is seen from rest outwards, in tension as in compression.
import type { Task } from "../contract/types";
import { isPolar } from "./state";
import type { CurvePart } from "./verdict_words";

/** Strains of a smaller magnitude are those of rest. */
const MAX_REST_STRAIN = 1e-9;
/** Slope of a plateau, as a fraction of the steepest slope before it. */
const MAX_PLATEAU_SLOPE = 0.4;
/** Mean slope of a rise, as a fraction of the steepest slope of the curve. */
const MIN_RISE_SLOPE = 0.6;
/** Slope of a drop, as a fraction of the steepest slope before it. */
const MAX_DROP_SLOPE = -0.1;
/** Slope of a part that stiffens, as a multiple of the mean slope before it. */
const MIN_STIFFENING_SLOPE = 1.5;

/** The samples on one side of rest, counted away from it. */
class Branch {
  /** Magnitudes. */
  readonly strain: readonly number[];
  /** Negative where its sign is not that of the strain. */
  readonly stress: readonly number[];

  constructor(x: readonly number[], target: readonly number[], isTension: boolean) {
    const sign = isTension ? 1 : -1;
    const order = x.map((_, k) => (isTension ? k : x.length - 1 - k)).filter((k) => sign * x[k] >= -MAX_REST_STRAIN);
    this.strain = order.map((k) => Math.abs(x[k]));
    this.stress = order.map((k) => sign * target[k]);
  }

  slope(a: number, b: number): number {
    return (this.stress[b] - this.stress[a]) / (this.strain[b] - this.strain[a]);
  }

  slopeAround(a: number, b: number): number {
    return a < b ? this.slope(a, b) : this.slope(Math.max(0, a - 1), Math.min(a + 1, this.strain.length - 1));
  }

  steepestBefore(end: number): number {
    let steepest = this.slope(0, 1);
    for (let k = 1; k < end; ++k) steepest = Math.max(steepest, this.slope(k, k + 1));
    return steepest;
  }

  /** The name of a part that ends before the branch does or begins after it. */
  partOf(first: number, last: number): CurvePart {
    const end = this.strain.length - 1;
    const slope = this.slopeAround(first, last);
    if (first === 0) return slope > 0 && slope >= MIN_RISE_SLOPE * this.steepestBefore(end) ? "rise" : "beginning";
    const steepest = Math.max(0, this.steepestBefore(first));
    if (slope < 0 && slope < MAX_DROP_SLOPE * steepest) return "drop";
    if (slope <= MAX_PLATEAU_SLOPE * steepest) return "plateau";
    if (slope >= MIN_STIFFENING_SLOPE * this.slope(0, first)) return "stiffening";
    return last === end ? "end" : "middle";
  }
}

/** What the samples from `first` to `last` look like in the target. */
export function partOf(task: Task, x: readonly number[], target: readonly number[], first: number, last: number): CurvePart {
  if (isPolar(task)) return "directions";
  if (first === 0 && last + 1 === x.length) return "whole";
  const isTension = x[first] >= -MAX_REST_STRAIN;
  const isAtRest = isTension && x[last] <= MAX_REST_STRAIN;
  if (isAtRest || (!isTension && x[last] > MAX_REST_STRAIN)) return "around_rest";
  const branch = new Branch(x, target, isTension);
  const count = branch.strain.length;
  const before = x.length - count;
  const [begin, to] = isTension ? [first - before, last - before] : [count - 1 - last, count - 1 - first];
  // Rest itself may belong to the range on its other side.
  const from = begin === 1 && branch.strain[0] <= MAX_REST_STRAIN ? 0 : begin;
  if (from === 0 && to + 1 === count) {
    const hasOtherSide = isTension ? x[0] < -MAX_REST_STRAIN : x[x.length - 1] > MAX_REST_STRAIN;
    return !hasOtherSide ? "whole" : isTension ? "tension" : "compression";
  }
  return branch.partOf(from, to);
}
