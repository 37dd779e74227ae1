// The statistics of a Voronoi diagram as rows of a table.
import { digits } from "../base/format";
import type { VoronoiStatistics } from "../contract/types";

const SPREADS: readonly (readonly [keyof VoronoiStatistics, string])[] = [["edge_length", "Length of edges"], ["planarity", "Vertices off their plane"], ["area", "Area of cells"],
  ["vertex_distance", "Vertex to site"]];

/** Rows with mean, standard deviation, smallest and largest value; after an optimization two rows for each quantity, before and after. */
export function statisticsRows(before: VoronoiStatistics | null, now: VoronoiStatistics): string[][] {
  const row = (words: string, spread: VoronoiStatistics["area"]) => [words, ...[spread.mean, spread.deviation, spread.least, spread.greatest].map((value) => digits(value, 4))];
  return SPREADS.flatMap(([name, words]) => (before ? [row(`${words}, before`, before[name]), row(`${words}, after`, now[name])] : [row(words, now[name])]));
}
