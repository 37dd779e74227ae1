// The shape of a part as a sketch, from its settings alone: outline, grips or plates, regions and the axis of the load.
import { digits } from "../base/format";
import type { Drawing, PartLayout } from "./drawing";
import type { PartSettings } from "./part";
import { LENGTH_AXIS } from "./part_load";
import { radians } from "./specification";

type Polygon = readonly (readonly number[])[];

/** Lengths in mm, y upwards. */
export interface Sketch {
  readonly outline: readonly Polygon[];
  /** Solid ends: grips or plates. */
  readonly ends: readonly Polygon[];
  readonly regions: readonly { readonly name: string; readonly points: Polygon }[];
  /** Direction of the load in radians; null if the part has none. */
  readonly axis: number | null;
  readonly lower: readonly [number, number];
  readonly upper: readonly [number, number];
}

/** The axis of a part in radians; null if it has none. */
export function axisOf({ kind, axis }: Pick<PartSettings, "kind" | "axis">): number | null {
  if (kind === "coupon" || kind === "block") return LENGTH_AXIS;
  return axis === null ? null : radians(axis);
}

/** Length of a grip or thickness of a plate in mm; 0 for shapes without ends. */
export function endOf({ kind, grip, plate }: Pick<PartSettings, "kind" | "grip" | "plate">): number {
  return kind === "coupon" ? grip : kind === "block" ? plate : 0;
}

function rectangle(width: number, from: number, to: number): Polygon {
  return [[0, from], [width, from], [width, to], [0, to]];
}

/** The sketch of a part; null for a drawing that has not been read yet. `names`: those of the regions in `layout`. */
export function sketchOf(settings: PartSettings, drawing: Drawing | null, layout: PartLayout | null, names: readonly string[]): Sketch | null {
  const axis = axisOf(settings);
  if (settings.kind === "drawing") {
    if (!drawing || !layout) return null;
    const { polygons } = drawing.curves;
    const regions = layout.regions.flatMap((where, k) => (typeof where === "number" ? [{ name: names[k] ?? "", points: polygons[where].points }] : []));
    const outline = layout.outline.map((place) => polygons[place].points);
    return withBounds({ outline, ends: [], regions, axis });
  }
  const end = endOf(settings);
  const height = settings.length + 2 * end;
  const ends = end > 0 ? [rectangle(settings.width, 0, end), rectangle(settings.width, height - end, height)] : [];
  return withBounds({ outline: [rectangle(settings.width, 0, height)], ends, regions: [], axis });
}

/** The regions alone bound a part without an outline. */
function withBounds(sketch: Omit<Sketch, "lower" | "upper">): Sketch | null {
  const points = [...sketch.outline, ...sketch.regions.map((region) => region.points)].flat();
  if (points.length === 0) return null;
  const [xs, ys] = [points.map(([x]) => x), points.map(([, y]) => y)];
  const least = (values: readonly number[]): number => values.reduce((a, b) => Math.min(a, b));
  const greatest = (values: readonly number[]): number => values.reduce((a, b) => Math.max(a, b));
  return { ...sketch, lower: [least(xs), least(ys)], upper: [greatest(xs), greatest(ys)] };
}

/** The outer size beside the size of the structure. */
export function sizeWords({ kind, thickness }: PartSettings, { lower, upper }: Pick<Sketch, "lower" | "upper">): string {
  const size = [upper[0] - lower[0], upper[1] - lower[1], thickness].map((length) => digits(length, 4)).join(" × ");
  const ends = kind === "coupon" ? " with both grips" : kind === "block" ? " with both plates" : "";
  return `Outer size${ends}: ${size} mm`;
}

/** The data of an SVG path of closed polygons around a centre, y downwards. */
export function pathOf(polygons: readonly Polygon[], [centreX, centreY]: readonly [number, number]): string {
  const corner = ([x, y]: readonly number[]): string => `${Number((x - centreX).toFixed(4))} ${Number((centreY - y).toFixed(4))}`;
  return polygons.map((polygon) => `M${polygon.map(corner).join("L")}Z`).join("");
}
