// Carries connections of crossings over to a changed layout. Crossings of user-drawn strands are numbered in the order in which they are
// found, so that adding or removing a strand changes their numbers. They are identified by position and strands instead.
import type { CrossingOverride, WeaveLayout } from "../contract/types";
import { slidingMembers } from "./connections";
import { periodicDistance } from "./geometry";
import type { WeaveState } from "./state";

export interface LayoutResult {
  /** The state of the layout. */
  readonly state: WeaveState;
  readonly layout: WeaveLayout;
}

/** Largest distance in mm of crossings that count as the same one. */
const MAX_SAME_DISTANCE = 1e-6;

/** The overrides that connect the crossings of a layout as in an earlier layout. */
export function carriedOverrides(from: LayoutResult, to: LayoutResult): CrossingOverride[] {
  const before = from.layout.crossings.filter((crossing) => slidingMembers(crossing).length > 0);
  const { lattice } = to.state.layout;
  const strandsBefore = from.state.layout.strands.map((strand) => JSON.stringify(strand));
  const strandsNow = to.state.layout.strands.map((strand) => JSON.stringify(strand));
  const result: CrossingOverride[] = [];
  to.layout.crossings.forEach((crossing, index) => {
    const known = before.find((other) => periodicDistance(lattice, other.position, crossing.position) < MAX_SAME_DISTANCE);
    if (!known) return;
    const sliding = new Set(slidingMembers(known).map((k) => strandsBefore[known.members[k].strand]));
    const slides = crossing.members.flatMap((member, k) => (sliding.has(strandsNow[member.strand]) ? [k] : []));
    if (slides.length > 0) result.push({ crossing: index, slides });
  });
  return result;
}
