// Changes of a layout of strands. Layouts are values: each change makes a new one.
import { latticeCoordinates, latticePoint } from "./geometry";
import type { FreeLayout, Lattice, Point, Strand } from "./state";

/** How a drawn strand goes on; `along_a` and `along_b`: periodic along the first or second translation. */
export type Ends = "open" | "closed" | "along_a" | "along_b";

const FEWEST_POINTS: Record<Ends, number> = { open: 2, closed: 3, along_a: 1, along_b: 1 };

/** A strand through the points; null where they are too few, or where there is no lattice to go on in. */
export function strandOf(points: readonly Point[], ends: Ends, lattice: Lattice | null): Strand | null {
  const places = points.map(([x, y]) => [x, y]);
  if (ends === "closed" && places.length > 1 && String(places[0]) === String(places[places.length - 1])) places.pop();
  if (places.length < FEWEST_POINTS[ends]) return null;
  if (ends === "open" || ends === "closed") return ends === "open" ? { points: places } : { points: places, ends };
  if (!lattice) return null;
  const translation = [...lattice[ends === "along_a" ? 0 : 1]];
  const [first, last] = [places[0], places[places.length - 1]];
  // A last point drawn on the first one's copy is that copy.
  if (places.length > 1 && Math.hypot(first[0] + translation[0] - last[0], first[1] + translation[1] - last[1]) < 1e-9) places.pop();
  return { points: places, ends: "periodic", translation };
}

export function withStrand(layout: FreeLayout, strand: Strand): FreeLayout {
  return { ...layout, strands: [...layout.strands, strand] };
}

export function withoutStrand(layout: FreeLayout, index: number): FreeLayout {
  return { ...layout, strands: layout.strands.filter((_, k) => k !== index) };
}

/** Another lattice: periodic strands go on along the same translations of it, and end where there is none. */
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

/** The second translation must lie to the left of the first, and both span an area. */
export function isLattice([a, b]: Lattice): boolean {
  const area = a[0] * b[1] - a[1] * b[0];
  return area > 1e-9 * Math.hypot(...a) * Math.hypot(...b) && Number.isFinite(area);
}

export function strandWords(strand: Strand): string {
  const count = `${strand.points.length} point${strand.points.length === 1 ? "" : "s"}`;
  if (strand.ends !== "periodic") return `${strand.ends ?? "open"}, ${count}`;
  return `goes on by (${(strand.translation ?? []).map((value) => Number(value.toPrecision(4))).join(", ")}), ${count}`;
}

/** The nearest point of a grid of half millimetres. */
export function snapped([x, y]: Point): Point {
  return [Math.round(2 * x) / 2, Math.round(2 * y) / 2];
}
