// Strands at rest in the form of the server's deformed strands, so that both can be drawn over each other: periodic strands and loops
// begin at the position of their first crossing.
import type { Polyline } from "../base/plane";
import type { WeaveLayout } from "../contract/types";

/** Largest distance in mm of a crossing from the end of an open strand at which it counts as that end. */
const END_TOLERANCE = 1e-6;

export function restLines(layout: WeaveLayout): Polyline[] {
  return layout.strands.map(({ ends, polyline, translation }, index) => {
    const first = firstCrossing(layout, index);
    if (!first || (ends === "open" && first.coordinate > END_TOLERANCE)) return polyline;
    const line = ends === "open" ? polyline : startingAt(polyline, first.coordinate, translation);
    const offset = [first.position[0] - line[0][0], first.position[1] - line[0][1]];
    return line.map(([x, y]) => [x + offset[0], y + offset[1]]);
  });
}

function firstCrossing(layout: WeaveLayout, strand: number): { coordinate: number; position: readonly number[] } | null {
  let first: { coordinate: number; position: readonly number[] } | null = null;
  for (const { members, position } of layout.crossings) {
    for (const member of members) {
      if (member.strand === strand && (!first || member.coordinate < first.coordinate)) first = { coordinate: member.coordinate, position };
    }
  }
  return first;
}

/** One period of a periodic line, beginning at an arc length. `translation` is the vector between periods, 0 for a loop. */
export function startingAt(polyline: Polyline, coordinate: number, translation: readonly number[]): number[][] {
  let remaining = coordinate;
  for (let k = 1; k < polyline.length; ++k) {
    const [p, q] = [polyline[k - 1], polyline[k]];
    const length = Math.hypot(q[0] - p[0], q[1] - p[1]);
    if (remaining > length && k + 1 < polyline.length) {
      remaining -= length;
      continue;
    }
    const fraction = length > 0 ? Math.min(1, remaining / length) : 0;
    const start = [p[0] + fraction * (q[0] - p[0]), p[1] + fraction * (q[1] - p[1])];
    const moved = ([x, y]: readonly number[]) => [x + translation[0], y + translation[1]];
    return [start, ...polyline.slice(k).map(([x, y]) => [x, y]), ...polyline.slice(1, k).map(moved), moved(start)];
  }
  return polyline.map(([x, y]) => [x, y]);
}

/** Centre of mass of lines with uniform density. */
export function centroid(lines: readonly Polyline[]): [number, number] {
  let [x, y, total] = [0, 0, 0];
  for (const line of lines) {
    for (let k = 1; k < line.length; ++k) {
      const [p, q] = [line[k - 1], line[k]];
      const length = Math.hypot(q[0] - p[0], q[1] - p[1]);
      x += (length * (p[0] + q[0])) / 2;
      y += (length * (p[1] + q[1])) / 2;
      total += length;
    }
  }
  return total > 0 ? [x / total, y / total] : [0, 0];
}
