// The structures that fill the regions of a part: the design of each region.
import { modulusOf, modulusWords, orientationOf } from "./specification";
import { INITIAL_PART, type Filling } from "./part";
import { loadDirection } from "./part_load";
import { regionWords } from "./region_list";
import type { TargetResponse } from "./shown";
import type { Region } from "./state";
import { targetsOf } from "./target_list";

/** Width of the walls of a region in mm: the one that its design was searched with. */
export function wallWidthOf({ made }: Pick<Region, "made">, shown: readonly TargetResponse[] | null): number {
  const { size } = made;
  if (size.kind === "beam_width") return size.value;
  const width = shown?.[0].measures.beamWidth;
  return width === null || width === undefined ? INITIAL_PART.beamWidth : Number(width.toPrecision(4));
}

/** The structure of each region; null for a region without a design. `walls`: widths of the walls in mm that the user chose. */
export function fillingsOf(regions: readonly Region[], shown: readonly (readonly TargetResponse[] | null)[], walls: readonly (number | undefined)[]): (Filling | null)[] {
  return regions.map((region, k) =>
    region.found && {
      name: regionWords(region, k),
      found: region.found,
      orientation: orientationOf(region.made, region.found),
      direction: loadDirection(targetsOf(region)),
      beamWidth: walls[k] ?? wallWidthOf(region, shown[k]),
    }
  );
}

/** A warning if the regions were designed for several materials, since a part is made of one; otherwise "". */
export function materialsNote(regions: readonly Region[]): string {
  const moduli = [...new Set(regions.filter(({ found }) => found !== null).map(({ made, found }) => modulusWords(modulusOf(made, found))))];
  return moduli.length > 1 ? `The designs of the regions are of different materials (${moduli.join(", ")} MPa); made of one they respond otherwise.` : "";
}
