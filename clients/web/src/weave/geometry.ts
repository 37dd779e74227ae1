// Distances, directions and curves in the plane of a weave, with lengths in mm.
import { latticeCoordinates, latticePoint, type Polyline } from "../base/plane";
import type { Lattice, Point } from "./state";

/** Distance of two points of a periodic plane. Without a lattice it is the Euclidean distance. */
export function periodicDistance(lattice: Lattice | null, p: readonly number[], q: readonly number[]): number {
  const difference: Point = [p[0] - q[0], p[1] - q[1]];
  if (!lattice) return Math.hypot(...difference);
  const [u, v] = latticeCoordinates(lattice, difference);
  return Math.hypot(...latticePoint(lattice, u - Math.round(u), v - Math.round(v)));
}

/** Undirected angle of a polyline at an arc length, in [0, pi). */
export function directionAt(polyline: Polyline, coordinate: number): number {
  let rest = coordinate;
  let angle = 0;
  for (let k = 1; k < polyline.length; ++k) {
    const [x, y] = [polyline[k][0] - polyline[k - 1][0], polyline[k][1] - polyline[k - 1][1]];
    const length = Math.hypot(x, y);
    if (length === 0) continue;
    angle = Math.atan2(y, x);
    if (rest <= length) break;
    rest -= length;
  }
  return undirected(angle);
}

/** The equivalent angle in [0, pi) of an undirected direction. */
export function undirected(angle: number): number {
  const turned = angle % Math.PI;
  return turned < 0 ? turned + Math.PI : turned;
}

/** The angle between two undirected directions, at most pi / 2. */
export function angleBetween(a: number, b: number): number {
  const difference = Math.abs(undirected(a) - undirected(b));
  return Math.min(difference, Math.PI - difference);
}

/** Points of a smooth curve on each segment of a polyline. */
const SMOOTH_PIECES = 5;

/**
 * A smooth curve through the points of a polyline: cubic Hermite pieces over the chord lengths, whose tangents are those of the parabolas
 * through three neighbouring points. `wraps`: whether the curve goes on at its ends as it began, for loops and for strands of a periodic cell.
 */
export function smoothed<P extends readonly number[]>(line: readonly P[], wraps = false, pieces = SMOOTH_PIECES): P[] {
  const points = line.filter((point, k) => k === 0 || distanceOf(point, line[k - 1]) > 0);
  if (points.length < 3 && !(wraps && points.length > 1)) return [...points];
  const slopes = points.slice(1).map((point, k) => {
    const length = distanceOf(point, points[k]);
    return { length, slope: point.map((value, axis) => (value - points[k][axis]) / length) };
  });
  type Slope = (typeof slopes)[number];
  const between = (before: Slope, after: Slope) => before.slope.map((value, axis) => (value * after.length + after.slope[axis] * before.length) / (before.length + after.length));
  const inner = slopes.slice(1).map((after, k) => between(slopes[k], after));
  const [first, last] = [slopes[0], slopes[slopes.length - 1]];
  const ends = wraps ? [between(last, first), between(last, first)]
    : [[first, inner[0]] as const, [last, inner[inner.length - 1]] as const].map(([{ slope }, tangent]) => slope.map((value, axis) => 2 * value - tangent[axis]));
  const tangents = [ends[0], ...inner, ends[1]];
  const curve = slopes.flatMap(({ length }, k) =>
    Array.from({ length: pieces }, (_, piece) => hermite(points[k], points[k + 1], tangents[k], tangents[k + 1], length, piece / pieces))
  );
  return [...curve, points[points.length - 1]] as unknown as P[];
}

function distanceOf(p: readonly number[], q: readonly number[]): number {
  return Math.hypot(...p.map((value, axis) => value - q[axis]));
}

/** The point at fraction t of a cubic curve from p to q, whose tangents at the ends are per length. */
function hermite(p: readonly number[], q: readonly number[], atP: readonly number[], atQ: readonly number[], length: number, t: number): number[] {
  const s = 1 - t;
  return p.map((value, axis) => (1 + 2 * t) * s * s * value + t * s * s * length * atP[axis] + t * t * (3 - 2 * t) * q[axis] - t * t * s * length * atQ[axis]);
}

/** Lattice indices of the cells in a block of `count` by `count` cells around cell (0, 0). */
export function blockOf(count: number): Point[] {
  const first = -Math.floor((count - 1) / 2);
  const shifts = Array.from({ length: count }, (_, k) => first + k);
  return shifts.flatMap((k) => shifts.map((i): Point => [i, k]));
}
