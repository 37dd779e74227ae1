// Points, polylines and lattices in the plane.

export type Point = readonly [x: number, y: number];
/** The two translations that repeat a cell. */
export type Lattice = readonly [Point, Point];

export interface Box {
  readonly x: number;
  readonly y: number;
  readonly width: number;
  readonly height: number;
}

export type Polyline = readonly (readonly number[])[];

export function latticePoint([a, b]: Lattice, i: number, k: number): Point {
  return [i * a[0] + k * b[0], i * a[1] + k * b[1]];
}

/** Coordinates of a vector in the basis of the two translations. */
export function latticeCoordinates([a, b]: Lattice, [x, y]: readonly number[]): Point {
  const area = a[0] * b[1] - a[1] * b[0];
  return [(x * b[1] - y * b[0]) / area, (a[0] * y - a[1] * x) / area];
}

/** A polyline as the data of an SVG path. */
export function pathOf(polyline: Polyline): string {
  return polyline.map(([x, y], k) => `${k === 0 ? "M" : "L"}${round(x)} ${round(y)}`).join("");
}

export function boxAround(points: Iterable<readonly number[]>, margin = 0): Box {
  let [left, bottom, right, top] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of points) {
    left = Math.min(left, x);
    right = Math.max(right, x);
    bottom = Math.min(bottom, y);
    top = Math.max(top, y);
  }
  if (left > right) return { x: -1, y: -1, width: 2, height: 2 };
  return { x: left - margin, y: bottom - margin, width: right - left + 2 * margin, height: top - bottom + 2 * margin };
}

function round(value: number): number {
  return Math.round(1e4 * value) / 1e4;
}
