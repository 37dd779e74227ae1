// What fills the regions of a part: the design of each region of the product.
import { DEFAULT_MADE, modulusOf, modulusWords, orientationOf } from "./made";
import { FIRST_PART, type Filling } from "./part";
import { regionWords } from "./region_list";
import type { Shown } from "./shown";
import type { Region } from "./state";

/** In mm: the width that the region's design was asked for, or that of a common nozzle's walls. */
export function wallsOf({ made }: Pick<Region, "made">, shown: readonly Shown[] | null): number {
  const { size } = made;
  if (size.kind === "beam_width") return size.value === DEFAULT_MADE.size.value ? FIRST_PART.beamWidth : size.value;
  const width = shown?.[0].measures.beamWidth;
  return width === null || width === undefined ? FIRST_PART.beamWidth : Number(width.toPrecision(4));
}

/** `walls`: widths of the beams of some regions that somebody chose. Null for a region without a design. */
export function fillingsOf(regions: readonly Region[], shown: readonly (readonly Shown[] | null)[], walls: readonly (number | undefined)[]): (Filling | null)[] {
  return regions.map((region, k) => region.found && {
    name: regionWords(region, k), found: region.found, orientation: orientationOf(region.made, region.found), beamWidth: walls[k] ?? wallsOf(region, shown[k]),
  });
}

/** A part is of one material: a sentence where its regions were designed for several, otherwise "". */
export function materialsNote(regions: readonly Region[]): string {
  const moduli = [...new Set(regions.filter(({ found }) => found !== null).map(({ made, found }) => modulusWords(modulusOf(made, found))))];
  return moduli.length > 1 ? `The designs of the regions are of different materials (${moduli.join(", ")} MPa); made of one they respond otherwise.` : "";
}
