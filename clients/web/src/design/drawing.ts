// A drawing as the shape of a part: which of its closed curves bound the part, and which bound its regions.
import type { Outlines } from "../contract/types";

export interface Drawing {
  /** Name of the file. */
  readonly name: string;
  readonly text: string;
  /** Width in mm to which all curves together are scaled; null for the size in the file. */
  readonly width: number | null;
  /** Pixels per inch that the user chose for a drawing without a physical size. */
  readonly resolution: number | null;
  readonly curves: Outlines;
}

/** Index of a curve in the drawing. */
export type CurveIndex = number;

/** Location of a region: within a curve, in the rest of the part, or nowhere. */
export type RegionLocation = CurveIndex | "rest" | "nowhere";

/** The user's choices. Undefined ones are made automatically, by the names of the curves. */
export interface LayoutChoices {
  /**
   * The outline of the part: one curve, all curves that bound no region ("others"), or none, so that the regions alone make the part
   * ("regions"). Undefined for the largest of the curves that bound no region, with the holes in it, or for the regions alone if they fill
   * the part and lie in no such curve.
   */
  readonly outline?: CurveIndex | "others" | "regions";
  /** Locations of the regions, in the order of the regions. */
  readonly regions: readonly (RegionLocation | undefined)[];
}

/** The corners of a curve, each of two coordinates. */
type Points = readonly (readonly number[])[];

export interface PartLayout {
  readonly outline: readonly CurveIndex[];
  readonly regions: readonly RegionLocation[];
}

/** Names that drawing programs give to every curve, and the name of the group whose shapes may cross each other. */
const GIVEN_BY_PROGRAMS = /^(((path|rect|circle|ellipse|polygon|polyline|line|g|layer|svg|curve|shape)[-_ ]?)?\d*|regions)$/i;
export const REST_NAME = "Rest";
/** Fraction of the outline outside its regions below which they cover it. */
const MAX_UNCOVERED = 1e-3;
/** Number of lines along which it is measured. */
const COVERAGE_LINES = 256;

/**
 * The names of the regions that a drawing has: those of its named curves, and one for the rest of the outline around them unless they cover
 * it. Empty if there are fewer than two.
 */
export function regionsIn({ curves: { polygons } }: Drawing): readonly string[] {
  if (polygons.length < 2) return [];
  const largest = largestOf(polygons, polygons.map((_, place) => place));
  const around = polygons[largest].points;
  const inside = polygons.map((_, place) => place).filter((place) => place !== largest && isInside(middleOf(polygons[place].points), around));
  const candidates = inside.length > 0 ? inside : polygons.map((_, place) => place);
  const names: string[] = [];
  const regions: Points[] = [];
  for (const place of candidates) {
    const name = polygons[place].names.find((one) => one.trim() !== "" && !GIVEN_BY_PROGRAMS.test(one.trim()));
    if (name === undefined || names.some((known) => sameName(known, name))) continue;
    names.push(name.trim());
    regions.push(polygons[place].points);
  }
  if (names.length === 0) return [];
  if (inside.length > 0 && uncoveredFraction(around, regions) > MAX_UNCOVERED) names.push(REST_NAME);
  return names.length > 1 ? names : [];
}

/** The intervals of a horizontal line within a curve, from left to right, as their ends one after the other. */
function within(points: Points, y: number): number[] {
  const ends: number[] = [];
  points.forEach(([x0, y0], k) => {
    const [x1, y1] = points[(k + 1) % points.length];
    if (y0 <= y !== y1 <= y) ends.push(x0 + ((y - y0) / (y1 - y0)) * (x1 - x0));
  });
  return ends.sort((a, b) => a - b);
}

/** Fraction of the area within a curve that lies in none of the regions, which may overlap each other and extend beyond it. Measured along horizontal lines. */
function uncoveredFraction(around: Points, regions: readonly Points[]): number {
  const lowest = Math.min(...around.map(([, y]) => y));
  const height = Math.max(...around.map(([, y]) => y)) - lowest;
  let all = 0;
  let uncovered = 0;
  for (let line = 0; line < COVERAGE_LINES; ++line) {
    const y = lowest + ((line + 0.5) / COVERAGE_LINES) * height;
    const outline = within(around, y);
    const covered = regions.map((points) => within(points, y));
    const ends = [outline, ...covered].flat().sort((a, b) => a - b);
    for (let k = 1; k < ends.length; ++k) {
      const middle = (ends[k - 1] + ends[k]) / 2;
      const holds = (intervals: readonly number[]) => intervals.filter((end) => end < middle).length % 2 === 1;
      if (!holds(outline)) continue;
      all += ends[k] - ends[k - 1];
      if (!covered.some(holds)) uncovered += ends[k] - ends[k - 1];
    }
  }
  return all > 0 ? uncovered / all : 0;
}

/** Whether a file is a drawing, and not a table of measured data. */
export function isDrawing(name: string, text: string): boolean {
  return /\.(svg|dxf)$/i.test(name) || /^\s*</.test(text);
}

/** Label of a curve: its first name, or its number. */
export function curveWords({ names }: Outlines["polygons"][number], place: CurveIndex): string {
  return names[0] ?? `Curve ${place + 1}`;
}

/**
 * Chooses the outline of the part and the location of each region. A region lies within the curve that has its name. The first
 * region without such a curve fills the rest of the part. The next ones lie within the remaining curves, except the largest. The largest
 * remaining curve is the outline, and the curves inside it are holes. A curve that crosses the outline is ignored: it may belong to a
 * region that has no name yet.
 */
export function layoutOf(drawing: Drawing, names: readonly string[], choices: LayoutChoices): PartLayout {
  const { polygons } = drawing.curves;
  const chosen = names.map((_, k) => validated(choices.regions[k], polygons.length));
  const occupied = new Set<RegionLocation>(chosen.filter((where) => where !== undefined));
  const largest = largestOf(polygons, polygons.map((_, place) => place));
  if (names.length === 1) return layoutWithOutline(polygons, ["rest"], choices.outline === "regions" ? undefined : choices.outline);
  const matched = chosen.map((where, k) => {
    if (where !== undefined) return where;
    const place = polygons.findIndex((polygon, at) => !occupied.has(at) && polygon.names.some((name) => sameName(name, names[k])));
    if (place >= 0) occupied.add(place);
    return place >= 0 ? place : undefined;
  });
  const regions = matched.map((where): RegionLocation => {
    if (where !== undefined) return where;
    const free = occupied.has("rest") ? polygons.findIndex((_, at) => at !== largest && !occupied.has(at)) : "rest";
    const location: RegionLocation = free === -1 ? "nowhere" : free;
    occupied.add(location);
    return location;
  });
  return layoutWithOutline(polygons, regions, choices.outline);
}

/** The choices after a region has moved. A region that was at the new location takes the old one. One region always fills the rest. */
export function withRegionMoved(layout: PartLayout, choices: LayoutChoices, region: number, to: RegionLocation): LayoutChoices {
  const before = layout.regions[region];
  const regions = layout.regions.map((where, k): RegionLocation => {
    if (k === region) return to;
    return to !== "nowhere" && where === to ? before : where;
  });
  if (!regions.includes("rest")) regions[regions.findIndex((_, k) => k !== region)] = "rest";
  return { ...choices, regions };
}

type Polygons = Outlines["polygons"];

function layoutWithOutline(polygons: Polygons, regions: readonly RegionLocation[], outline: LayoutChoices["outline"]): PartLayout {
  if (typeof outline === "number" && outline < polygons.length) return { outline: [outline], regions };
  if (outline === "regions") return { outline: [], regions };
  const others = polygons.map((_, place) => place).filter((place) => !regions.includes(place));
  if (outline === "others" || others.length === 0) return { outline: others, regions };
  const largest = largestOf(polygons, others);
  const around = polygons[largest].points;
  const isAround = (where: RegionLocation): boolean => typeof where !== "number" || isInside(middleOf(polygons[where].points), around);
  if (!regions.includes("rest") && !regions.every(isAround)) return { outline: [], regions };
  return { outline: others.filter((place) => place === largest || polygons[place].points.every((point) => isInside(point, around))), regions };
}

/** The index of the curve with the largest area; `places` has at least one index. */
function largestOf(polygons: Polygons, places: readonly CurveIndex[]): CurveIndex {
  return places.reduce((largest, place) => (area(polygons[place].points) > area(polygons[largest].points) ? place : largest));
}

/** The mean of the corners. */
function middleOf(points: readonly (readonly number[])[]): [number, number] {
  const sum = points.reduce(([x, y], [dx, dy]) => [x + dx, y + dy], [0, 0]);
  return [sum[0] / points.length, sum[1] / points.length];
}

/** Whether a point lies inside a polygon, by the parity of the edges that a ray to the right crosses. */
function isInside([x, y]: readonly number[], polygon: readonly (readonly number[])[]): boolean {
  let inside = false;
  polygon.forEach(([fromX, fromY], k) => {
    const [toX, toY] = polygon[(k + 1) % polygon.length];
    if (fromY > y !== toY > y && x < fromX + ((y - fromY) / (toY - fromY)) * (toX - fromX)) inside = !inside;
  });
  return inside;
}

function validated(where: RegionLocation | undefined, count: number): RegionLocation | undefined {
  return typeof where === "number" && where >= count ? undefined : where;
}

function sameName(a: string, b: string): boolean {
  return a.trim().toLowerCase() === b.trim().toLowerCase();
}

/** Area in mm^2, by the shoelace formula. */
function area(points: readonly (readonly number[])[]): number {
  const twiceArea = points.reduce((sum, [x, y], k) => {
    const [nextX, nextY] = points[(k + 1) % points.length];
    return sum + x * nextY - nextX * y;
  }, 0);
  return Math.abs(twiceArea) / 2;
}
