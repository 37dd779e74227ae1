// Changes of a layout of strands. Layouts are immutable: each change makes a new one.
import { latticeCoordinates, latticePoint } from "../base/plane";
import type { FreeLayout, Lattice, Point, Strand } from "./state";

/** The ends of a drawn strand: open, closed to a loop, or periodic along the first (`along_a`) or the second translation (`along_b`). */
export type Ends = "open" | "closed" | "along_a" | "along_b";

/** Minimum number of points of a strand. */
const MIN_POINTS: Record<Ends, number> = { open: 2, closed: 3, along_a: 1, along_b: 1 };

/** A strand through points; null if there are too few, or if it is periodic and there is no lattice. */
export function strandOf(points: readonly Point[], ends: Ends, lattice: Lattice | null): Strand | null {
  const places = points.map(([x, y]) => [x, y]);
  if (ends === "closed" && places.length > 1 && String(places[0]) === String(places[places.length - 1])) places.pop();
  if (places.length < MIN_POINTS[ends]) return null;
  if (ends === "open" || ends === "closed") return ends === "open" ? { points: places } : { points: places, ends };
  if (!lattice) return null;
  const translation = [...lattice[ends === "along_a" ? 0 : 1]];
  const [first, last] = [places[0], places[places.length - 1]];
  // A last point on the translated copy of the first one is dropped.
  if (places.length > 1 && Math.hypot(first[0] + translation[0] - last[0], first[1] + translation[1] - last[1]) < 1e-9) places.pop();
  return { points: places, ends: "periodic", translation };
}

export function withStrand(layout: FreeLayout, strand: Strand): FreeLayout {
  return { ...layout, strands: [...layout.strands, strand] };
}

export function withoutStrand(layout: FreeLayout, index: number): FreeLayout {
  return { ...layout, strands: layout.strands.filter((_, k) => k !== index) };
}

/** Changes the lattice. Periodic strands keep their lattice indices; without a lattice they become open. */
export function withLattice(layout: FreeLayout, lattice: Lattice | null): FreeLayout {
  const { lattice: old } = layout;
  const strands = layout.strands.map((strand): Strand => {
    if (strand.ends !== "periodic" || !strand.translation) return strand;
    const { points, translation, ends, ...others } = strand;
    if (lattice && old) {
      const [i, k] = latticeCoordinates(old, translation).map(Math.round);
      return { ...others, ends, points, translation: [...latticePoint(lattice, i, k)] };
    }
    return { ...others, points: [...points, [points[0][0] + translation[0], points[0][1] + translation[1]]] };
  });
  return { ...layout, strands, lattice };
}

/** Whether two translations span an area, with the second one to the left of the first. */
export function isLattice([a, b]: Lattice): boolean {
  const area = a[0] * b[1] - a[1] * b[0];
  return area > 1e-9 * Math.hypot(...a) * Math.hypot(...b) && Number.isFinite(area);
}

export function strandWords(strand: Strand): string {
  const count = `${strand.points.length} point${strand.points.length === 1 ? "" : "s"}`;
  if (strand.ends !== "periodic") return `${strand.ends ?? "open"}, ${count}`;
  return `goes on by (${(strand.translation ?? []).map((value) => Number(value.toPrecision(4))).join(", ")}), ${count}`;
}

/** The nearest point of a grid with a spacing of 0.5 mm. */
export function roundedToGrid([x, y]: Point): Point {
  return [Math.round(2 * x) / 2, Math.round(2 * y) / 2];
}

function mapped(strand: Strand, change: (point: readonly number[]) => Point, translation = strand.translation): Strand {
  return { ...strand, points: strand.points.map((point) => [...change(point)]), ...(translation && { translation: [...translation] }) };
}

function rounded(value: number): number {
  return Number(value.toFixed(4));
}

/** The layout with all lengths multiplied, about the origin. A strand without its radius is as thick as before. */
export function scaledLayout(layout: FreeLayout, factor: number): FreeLayout {
  const scaled = ([x, y]: readonly number[]): Point => [rounded(factor * x), rounded(factor * y)];
  return {
    strands: layout.strands.map((strand) => mapped(strand, scaled, strand.translation && [...scaled(strand.translation)])),
    lattice: layout.lattice && [scaled(layout.lattice[0]), scaled(layout.lattice[1])],
  };
}

/** The layout with a copy of a strand, moved by a vector. */
export function withDuplicate(layout: FreeLayout, index: number, [right, up]: Point): FreeLayout {
  const strand = layout.strands[index];
  if (!strand) return layout;
  return withStrand(layout, mapped(strand, ([x, y]) => [rounded(x + right), rounded(y + up)]));
}

/** Limit of the strands of a layout that is repeated. */
export const MAX_ARRAY_STRANDS = 500;

/**
 * The layout with copies of all strands in columns and rows. In a cell, the steps are those of the lattice, which grows with the copies, so that
 * the weave stays the same; a strand that goes on for ever is then one for each row or column. In a sheet, `step` is the distance of copies. Null
 * if there would be too many strands.
 */
export function arrayed(layout: FreeLayout, columns: number, rows: number, step: Point): FreeLayout | null {
  const { lattice, strands } = layout;
  if (strands.length * columns * rows > MAX_ARRAY_STRANDS) return null;
  const [a, b]: Lattice = lattice ?? [[step[0], 0], [0, step[1]]];
  const shift = (i: number, k: number) => ([x, y]: readonly number[]): Point => [rounded(x + i * a[0] + k * b[0]), rounded(y + i * a[1] + k * b[1])];
  const places = (width: number, height: number) => Array.from({ length: width * height }, (_, n): Point => [n % width, Math.floor(n / width)]);
  const copies = strands.flatMap((strand) => {
    const { translation } = strand;
    if (strand.ends !== "periodic" || !translation || !lattice) return places(columns, rows).map(([i, k]) => mapped(strand, shift(i, k)));
    // A period of the strand in the larger cell consists of as many periods as it takes to come back to it.
    const [m, n] = latticeCoordinates(lattice, translation).map(Math.round);
    const periods = periodsWithin(m, n, columns, rows);
    const starts = distinctStarts(m, n, columns, rows, periods);
    return starts.map(([i, k]): Strand => ({
      ...strand,
      points: Array.from({ length: periods }, (_, turn) => strand.points.map((point) => [...shift(i + turn * m, k + turn * n)(point)])).flat(),
      translation: [rounded(periods * translation[0]), rounded(periods * translation[1])],
    }));
  });
  return { strands: copies, lattice: lattice && [shift(columns - 1, 0)(a), shift(0, rows - 1)(b)] };
}

/** After how many periods a strand that goes on by (m, n) cells is back at the same place of a cell of columns and rows. */
function periodsWithin(m: number, n: number, columns: number, rows: number): number {
  let count = 1;
  while ((count * m) % columns !== 0 || (count * n) % rows !== 0) ++count;
  return count;
}

/** One starting cell for each different copy of a strand that goes on by (m, n) cells. */
function distinctStarts(m: number, n: number, columns: number, rows: number, periods: number): Point[] {
  const seen = new Set<string>();
  const starts: Point[] = [];
  for (let k = 0; k < rows; ++k) {
    for (let i = 0; i < columns; ++i) {
      if (seen.has(`${i} ${k}`)) continue;
      starts.push([i, k]);
      for (let turn = 0; turn < periods; ++turn) seen.add(`${modulo(i + turn * m, columns)} ${modulo(k + turn * n, rows)}`);
    }
  }
  return starts;
}

function modulo(value: number, size: number): number {
  return ((value % size) + size) % size;
}
