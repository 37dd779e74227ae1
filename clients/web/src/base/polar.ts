// Polar plots of quantities with period pi over direction: samples of half a turn are drawn twice, opposite to each other.
import { curveLinearClosed, lineRadial } from "d3-shape";
import { type Curve, pieces, type Sample } from "./curve";
import { svg } from "./dom";
import { digits } from "./format";

const SPOKES = 12;

/** d3 measures angles clockwise from the top; here they are counterclockwise from the right. */
function radial(pixelRadius: (y: number) => number) {
  return lineRadial<Sample>().angle((p) => Math.PI / 2 - p[0]).radius((p) => pixelRadius(p[1]));
}

/**
 * The samples of half a turn and their copies in the other half, as the data of an SVG path. `pixelRadius` is the distance from the
 * centre in pixels. A last sample that repeats the first is left out. Gaps of the curve are gaps of the path.
 */
export function polarPath(curve: Curve, pixelRadius: (y: number) => number): string {
  const count = curve.x.length;
  if (count === 0) return "";
  const repeated = count > 1 && curve.x[count - 1] - curve.x[0] > Math.PI - 1e-6;
  const half = curve.x.slice(0, repeated ? -1 : undefined).map((x, k) => [x, curve.y[k]] as const);
  const fullTurn = [...half, ...half.map(([x, y]) => [x + Math.PI, y] as const)];
  const gap = fullTurn.findIndex(([, y]) => y === null);
  if (gap < 0) return radial(pixelRadius).curve(curveLinearClosed)(fullTurn as Sample[]) ?? "";
  // The turn begins and ends at a gap, so that no piece is cut where the samples begin.
  const cyclic = [...fullTurn.slice(gap), ...fullTurn.slice(0, gap).map(([x, y]) => [x + 2 * Math.PI, y] as const)];
  const parts = pieces({ x: cyclic.map(([x]) => x), y: cyclic.map(([, y]) => y) });
  return parts.map((piece) => radial(pixelRadius)(piece) ?? "").join("");
}

/** The part of a d3 scale that polar plots need. */
export interface RadiusScale {
  (value: number): number;
  range(): number[];
  ticks(count?: number): number[];
}

/** Rings labelled with values, and spokes labelled with angles. */
export function polarGrid(radius: RadiusScale, ticks: readonly number[] = radius.ticks(5), label: (value: number) => string = digits): SVGElement[] {
  const rim = radius.range()[1];
  const rings = ticks.filter((value) => radius(value) > 1);
  const spokes = Array.from({ length: SPOKES }, (_, k) => (k * Math.PI) / (SPOKES / 2));
  return [
    ...rings.map((value) => svg("circle", { class: value === 0 ? "ring zero" : "ring", r: radius(value) })),
    ...spokes.map((angle) => svg("path", { class: "spoke", d: `M0,0L${rim * Math.cos(angle)},${-rim * Math.sin(angle)}` })),
    ...rings.map((value) => svg("text", { class: "ring-label", x: 4, y: -radius(value) - 3 }, label(value))),
    ...spokes.map((angle) =>
      svg("text", { class: "spoke-label", "text-anchor": "middle", "dominant-baseline": "central", x: (rim + 20) * Math.cos(angle), y: -(rim + 16) * Math.sin(angle) },
        `${Math.round((angle * 180) / Math.PI)}°`)
    ),
  ];
}
