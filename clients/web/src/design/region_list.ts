// Regions of a product, each with its own design. A state has the fields of the selected region itself and the others in a list;
// these functions convert between a state and the list of all regions.
import type { Product, Region } from "./state";
import { targetOf } from "./target_list";

/** Limit of the page; a request may have 20. */
export const MAX_REGIONS = 8;
export const MAX_REGION_NAME_LENGTH = 40;

/** The fields of the selected region, without the others of a state. */
export function regionOf(state: Region): Region {
  const { region, others, at, made, family, found, fixed, byHand } = state;
  return { ...targetOf(state), region, others, at, made, family, found, fixed, byHand };
}

/** All regions in the order of their tabs. */
export function regionsOf(state: Product): readonly Region[] {
  const { otherRegions, regionAt } = state;
  return [...otherRegions.slice(0, regionAt), regionOf(state), ...otherRegions.slice(regionAt)];
}

/** The product that has these regions, with region `at` selected. */
export function withRegions(regions: readonly Region[], at: number): Product {
  const place = Math.max(0, Math.min(Math.round(at), regions.length - 1));
  return { ...regions[place], otherRegions: regions.filter((_, k) => k !== place), regionAt: place };
}

/** Label of a region: its name, or its number. */
export function regionWords({ region }: Pick<Region, "region">, place: number): string {
  return region !== "" ? region : `Region ${place + 1}`;
}
