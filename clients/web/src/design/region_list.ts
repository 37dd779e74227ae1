// Several regions of a product, each with a design of its own. The state holds the one in sight as its own; these functions know all.
import type { DesignState, Region } from "./state";
import { targetOf } from "./target_list";

/** As many as there is room for on the page; a request may have 20. */
export const MOST_REGIONS = 8;
export const MOST_REGION_NAME = 40;

/** The region alone, of what has more. */
export function regionOf(state: Region): Region {
  const { region, others, at, made, family, found, fixed, byHand } = state;
  return { ...targetOf(state), region, others, at, made, family, found, fixed, byHand };
}

/** All regions in the order of their tabs. */
export function regionsOf(state: DesignState): readonly Region[] {
  const { otherRegions, regionAt } = state;
  return [...otherRegions.slice(0, regionAt), regionOf(state), ...otherRegions.slice(regionAt)];
}

/** The state that has these regions, with one of them in sight. */
export function withRegions(regions: readonly Region[], at: number): DesignState {
  const place = Math.max(0, Math.min(Math.round(at), regions.length - 1));
  return { ...regions[place], otherRegions: regions.filter((_, k) => k !== place), regionAt: place };
}

/** What a region is called: its name, or its number. */
export function regionWords({ region }: Pick<Region, "region">, place: number): string {
  return region !== "" ? region : `Region ${place + 1}`;
}
