// Networks that shrink to one point: springs without a rest length pull all points together where none is held.
import type { Vector } from "./mesh_data";
import { hasMembrane, type NetworkState } from "./network_state";

/** Number of points that are offered to be held. Six lie on all sides of a closed surface. */
export const HELD_POINTS = 6;

/** Whether nothing keeps a network of springs from shrinking. */
export function willShrink(state: NetworkState): boolean {
  if (hasMembrane(state) || state.fixed.length > 0 || state.restLength > 0) return false;
  return state.springs !== "drawn" || (state.drawn.length > 0 && state.drawn.every(({ restLength = 0 }) => restLength === 0));
}

/** Fraction of its first energy below which a network has shrunk to one point. */
const MAX_SHRUNK_ENERGY = 1e-12;

/** Whether a network of springs has come to rest with all of its points in one place. `energies`: those of the iterations. */
export function hasShrunk(energies: readonly number[]): boolean {
  const [first, last] = [energies[0] ?? 0, energies.at(-1) ?? 0];
  return first > 0 && last <= MAX_SHRUNK_ENERGY * first;
}

/** Indices of points far from each other, ascending: each is the one farthest from those before it, from the one farthest from the centre on. */
export function farthestPoints(positions: readonly Vector[], count: number): number[] {
  if (positions.length === 0) return [];
  const centre = [0, 1, 2].map((axis) => positions.reduce((sum, position) => sum + position[axis], 0) / positions.length);
  const distance = (p: readonly number[], q: readonly number[]) => Math.hypot(p[0] - q[0], p[1] - q[1], p[2] - q[2]);
  const chosen: number[] = [];
  let nearest = positions.map((position) => distance(position, centre));
  while (chosen.length < Math.min(count, positions.length)) {
    const next = nearest.reduce((best, value, k) => (value > nearest[best] ? k : best), 0);
    nearest = positions.map((position, k) => (k === next ? -1 : Math.min(chosen.length === 0 ? Infinity : nearest[k], distance(position, positions[next]))));
    chosen.push(next);
  }
  return chosen.sort((a, b) => a - b);
}
