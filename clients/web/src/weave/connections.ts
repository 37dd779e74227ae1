// The connection of a crossing: which of its strands slide. Clicks on a crossing cycle through its connections.
import type { CrossingOverride, WeaveLayout } from "../contract/types";

export type Crossing = WeaveLayout["crossings"][number];

/** Indices of the members that slide. */
export function slidingMembers(crossing: Crossing): number[] {
  return crossing.members.flatMap((member, k) => (member.slides ? [k] : []));
}

/** The members that slide in the next connection: none (fused), the first, the second, up to the last, then none again. */
export function nextConnection(crossing: Crossing): number[] {
  const sliding = slidingMembers(crossing);
  if (sliding.length === 0) return [0];
  const next = sliding[0] + 1;
  return sliding.length === 1 && next < crossing.members.length ? [next] : [];
}

/** The overrides after the connection of a crossing has changed, in ascending order of crossings. */
export function withConnection(overrides: readonly CrossingOverride[], crossing: number, slides: readonly number[]): CrossingOverride[] {
  const others = overrides.filter((override) => override.crossing !== crossing);
  return [...others, { crossing, slides: [...slides] }].sort((a, b) => a.crossing - b.crossing);
}

/** The connection as text, such as "fused" or "strand 2 slides". Strands are numbered from 1. */
export function connectionWords(crossing: Crossing): string {
  const sliding = slidingMembers(crossing).map((k) => crossing.members[k].strand + 1);
  if (sliding.length === 0) return "fused";
  return sliding.length === 1 ? `strand ${sliding[0]} slides` : `strands ${sliding.join(" and ")} slide`;
}

export function crossingWords(crossing: Crossing, index: number): string {
  const strands = crossing.members.map((member) => member.strand + 1);
  const [first, ...others] = strands;
  const which = others.every((strand) => strand === first) ? `strand ${first} with itself` : `strands ${strands.join(" and ")}`;
  return `Crossing ${index + 1} of ${which}: ${connectionWords(crossing)}`;
}

/** What a click on a crossing does, also to a sheet if the weave is a cell that repeats. */
export function clickWords(layout: Pick<WeaveLayout, "lattice">): string {
  return layout.lattice
    ? "Click a crossing to change it, here and in every cell of a sheet. Crossings that a sheet has only between its cells or at its edge stay as they are."
    : "Click a crossing to change it.";
}

/** How many crossings are fused and how many slide, as a sentence. */
export function crossingsSummary(layout: WeaveLayout): string {
  const sliding = layout.crossings.filter((crossing) => crossing.members.some((member) => member.slides)).length;
  const fused = layout.crossings.length - sliding;
  const strands = `${layout.strands.length} strand${layout.strands.length === 1 ? "" : "s"}`;
  return `${strands}, ${layout.crossings.length} crossing${layout.crossings.length === 1 ? "" : "s"}: ${fused} fused, ${sliding} sliding`;
}
