// Polar plots of what has the period pi over direction: each half is the other's picture.
import { curveLinearClosed, lineRadial } from "d3-shape";
import { type Curve, pieces, type Sample } from "./curve";
import { svg } from "./dom";
import { digits } from "./format";

const SPOKES = 12;

/** d3 counts angles clockwise from above, we counterclockwise from the right. */
function radial(away: (y: number) => number) {
  return lineRadial<Sample>().angle((p) => Math.PI / 2 - p[0]).radius((p) => away(p[1]));
}

/**
 * Half a turn of samples and its picture as the data of a path; `away` gives pixels from the centre. A last sample that
 * repeats the first is left out; a gap of the curve is one of the path.
 */
export function polarPath(curve: Curve, away: (y: number) => number): string {
  const count = curve.x.length;
  if (count === 0) return "";
  const repeated = count > 1 && curve.x[count - 1] - curve.x[0] > Math.PI - 1e-6;
  const half = curve.x.slice(0, repeated ? -1 : undefined).map((x, k) => [x, curve.y[k]] as const);
  const turn = [...half, ...half.map(([x, y]) => [x + Math.PI, y] as const)];
  const gap = turn.findIndex(([, y]) => y === null);
  if (gap < 0) return radial(away).curve(curveLinearClosed)(turn as Sample[]) ?? "";
  // From one gap around to it again, so that no piece is cut where the samples begin.
  const cyclic = [...turn.slice(gap), ...turn.slice(0, gap).map(([x, y]) => [x + 2 * Math.PI, y] as const)];
  const parts = pieces({ x: cyclic.map(([x]) => x), y: cyclic.map(([, y]) => y) });
  return parts.map((piece) => radial(away)(piece) ?? "").join("");
}

/** What a radius scale of d3 must be able to do. */
export interface RadiusScale {
  (value: number): number;
  range(): number[];
  ticks(count?: number): number[];
}

/** Rings with their values, spokes with their angles. */
export function polarGrid(radius: RadiusScale, ticks: readonly number[] = radius.ticks(5)): SVGElement[] {
  const rim = radius.range()[1];
  const rings = ticks.filter((value) => radius(value) > 1);
  const spokes = Array.from({ length: SPOKES }, (_, k) => (k * Math.PI) / (SPOKES / 2));
  return [
    ...rings.map((value) => svg("circle", { class: value === 0 ? "ring zero" : "ring", r: radius(value) })),
    ...spokes.map((angle) => svg("path", { class: "spoke", d: `M0,0L${rim * Math.cos(angle)},${-rim * Math.sin(angle)}` })),
    ...rings.map((value) => svg("text", { class: "ring-label", x: 4, y: -radius(value) - 3 }, digits(value))),
    ...spokes.map((angle) =>
      svg("text", { class: "spoke-label", "text-anchor": "middle", "dominant-baseline": "central", x: (rim + 20) * Math.cos(angle), y: -(rim + 16) * Math.sin(angle) }, `${Math.round((angle * 180) / Math.PI)}°`),
    ),
  ];
}
