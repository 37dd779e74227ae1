// Crossings of strands of one's own are numbered as they are found. After a strand was added or taken away the same
// crossing has another number; it is known by its place and its strands.
import type { CrossingOverride, WeaveLayout } from "../contract/types";
import { slidingMembers } from "./connections";
import { periodicDistance } from "./geometry";
import type { WeaveState } from "./state";

export interface LaidOut {
  /** The state that it is the layout of. */
  readonly state: WeaveState;
  readonly layout: WeaveLayout;
}

/** Farther apart two crossings are different ones, mm. */
const SAME_PLACE = 1e-6;

/** What makes crossings of a layout connected as they were in an earlier one. */
export function carriedOverrides(from: LaidOut, to: LaidOut): CrossingOverride[] {
  const before = from.layout.crossings.filter((crossing) => slidingMembers(crossing).length > 0);
  const { lattice } = to.state.layout;
  const strandsBefore = from.state.layout.strands.map((strand) => JSON.stringify(strand));
  const strandsNow = to.state.layout.strands.map((strand) => JSON.stringify(strand));
  const result: CrossingOverride[] = [];
  to.layout.crossings.forEach((crossing, index) => {
    const known = before.find((other) => periodicDistance(lattice, other.position, crossing.position) < SAME_PLACE);
    if (!known) return;
    const sliding = new Set(slidingMembers(known).map((k) => strandsBefore[known.members[k].strand]));
    const slides = crossing.members.flatMap((member, k) => (sliding.has(strandsNow[member.strand]) ? [k] : []));
    if (slides.length > 0) result.push({ crossing: index, slides });
  });
  return result;
}
