// A drawing as the outline of a part: its closed curves, and which of them bound the part and which its regions.
import type { Outlines } from "../contract/types";

export interface Drawing {
  /** Of the file. */
  readonly name: string;
  readonly text: string;
  /** All curves together are scaled to this width in mm; null: as the file says. */
  readonly width: number | null;
  /** Pixels per inch that were chosen for a drawing without a physical size. */
  readonly resolution: number | null;
  readonly curves: Outlines;
}

/** A curve by its place in the drawing. */
export type Place = number;

/** Where a region lies: within a curve, in the rest of the part, or nowhere. */
export type Where = Place | "rest" | "nowhere";

/** What a person has chosen; what is undefined is chosen by names. */
export interface Choices {
  /** What bounds the part: a curve, all that bound no region, or without a choice the largest of these with the holes in it. */
  readonly outline?: Place | "others";
  /** Of the regions of the product in their order. */
  readonly regions: readonly (Where | undefined)[];
}

export interface Layout {
  readonly outline: readonly Place[];
  readonly regions: readonly Where[];
}

/** Whether a file is a drawing rather than a table of measured data. */
export function isDrawing(name: string, text: string): boolean {
  return /\.(svg|dxf)$/i.test(name) || /^\s*</.test(text);
}

/** What a curve is called: the name of its own, or its number. */
export function curveWords({ names }: Outlines["polygons"][number], place: Place): string {
  return names[0] ?? `Curve ${place + 1}`;
}

/**
 * Chooses the curves that bound the part and the curve of each region. A region lies within the curve that has its name. The first
 * region without such a curve fills the rest, and the next ones lie within the other curves beside the largest. The largest curve that
 * is left bounds the part, and the curves inside of it are holes. A curve that crosses it is a region that has no name yet.
 */
export function layoutOf(drawing: Drawing, names: readonly string[], choices: Choices): Layout {
  const { polygons } = drawing.curves;
  const chosen = names.map((_, k) => sound(choices.regions[k], polygons.length));
  const taken = new Set<Where>(chosen.filter((where) => where !== undefined));
  const largest = largestOf(polygons, polygons.map((_, place) => place));
  if (names.length === 1) return bounded(polygons, ["rest"], choices.outline);
  const named = chosen.map((where, k) => {
    if (where !== undefined) return where;
    const place = polygons.findIndex((polygon, at) => !taken.has(at) && polygon.names.some((name) => sameName(name, names[k])));
    if (place >= 0) taken.add(place);
    return place >= 0 ? place : undefined;
  });
  const regions = named.map((where): Where => {
    if (where !== undefined) return where;
    const free = taken.has("rest") ? polygons.findIndex((_, at) => at !== largest && !taken.has(at)) : "rest";
    const next: Where = free === -1 ? "nowhere" : free;
    taken.add(next);
    return next;
  });
  return bounded(polygons, regions, choices.outline);
}

/** The choices with one region elsewhere: two regions do not lie at one place, and one of them fills the rest. */
export function moved(layout: Layout, choices: Choices, region: number, to: Where): Choices {
  const before = layout.regions[region];
  const regions = layout.regions.map((where, k): Where => {
    if (k === region) return to;
    return to !== "nowhere" && where === to ? before : where;
  });
  if (!regions.includes("rest")) regions[regions.findIndex((_, k) => k !== region)] = "rest";
  return { ...choices, regions };
}

type Polygons = Outlines["polygons"];

function bounded(polygons: Polygons, regions: readonly Where[], outline: Choices["outline"]): Layout {
  if (typeof outline === "number" && outline < polygons.length) return { outline: [outline], regions };
  const others = polygons.map((_, place) => place).filter((place) => !regions.includes(place));
  if (outline === "others" || others.length === 0) return { outline: others, regions };
  const largest = largestOf(polygons, others);
  const around = polygons[largest].points;
  return { outline: others.filter((place) => place === largest || polygons[place].points.every((point) => isInside(point, around))), regions };
}

/** `places`: at least one. */
function largestOf(polygons: Polygons, places: readonly Place[]): Place {
  return places.reduce((most, place) => (area(polygons[place].points) > area(polygons[most].points) ? place : most));
}

/** Whether a ray to the right leaves the polygon more often than it enters it. */
function isInside([x, y]: readonly number[], polygon: readonly (readonly number[])[]): boolean {
  let inside = false;
  polygon.forEach(([fromX, fromY], k) => {
    const [toX, toY] = polygon[(k + 1) % polygon.length];
    if (fromY > y !== toY > y && x < fromX + ((y - fromY) / (toY - fromY)) * (toX - fromX)) inside = !inside;
  });
  return inside;
}

function sound(where: Where | undefined, count: number): Where | undefined {
  return typeof where === "number" && where >= count ? undefined : where;
}

function sameName(a: string, b: string): boolean {
  return a.trim().toLowerCase() === b.trim().toLowerCase();
}

/** By the shoelace formula, in mm^2. */
function area(points: readonly (readonly number[])[]): number {
  const twice = points.reduce((sum, [x, y], k) => {
    const [nextX, nextY] = points[(k + 1) % points.length];
    return sum + x * nextY - nextX * y;
  }, 0);
  return Math.abs(twice) / 2;
}
