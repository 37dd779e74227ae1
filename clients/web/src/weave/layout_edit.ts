// Changes of a layout of strands. Layouts are immutable: each change makes a new one.
import { latticeCoordinates, latticePoint } from "./geometry";
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
