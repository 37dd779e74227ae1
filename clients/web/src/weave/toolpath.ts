// The moves of a printer, grouped into layers: strands on the bed, strands that rise over others, and channels that bridge them.
import type { PrintMove } from "../contract/types";

export type Stage = "bed" | "sliding" | "channels";

export const STAGE_WORDS: Readonly<Record<Stage, string>> = {
  bed: "on the bed",
  sliding: "strands that rise over others",
  channels: "channels over sliding strands",
};

/** A sequence of moves of one stage of the print. */
export interface Layer {
  readonly stage: Stage;
  readonly moves: readonly PrintMove[];
  /** Smallest and largest height of the nozzle while it prints, in mm. */
  readonly lowest: number;
  readonly highest: number;
  /** Printed length, in mm. */
  readonly length: number;
  readonly travels: number;
  /** Lengths over speeds, in minutes. */
  readonly minutes: number;
}

/** The layers of a sequence of moves. A travel belongs to the layer of the next printed move; the last travels belong to the last layer. */
export function layersOf(moves: readonly PrintMove[]): Layer[] {
  const rising = new Set(moves.filter((move) => move.kind === "lifted").map((move) => move.strand));
  const runs: { stage: Stage; moves: PrintMove[] }[] = [];
  let travels: PrintMove[] = [];
  for (const move of moves) {
    if (move.kind === "travel") {
      travels.push(move);
      continue;
    }
    const stage: Stage = move.kind === "channel" ? "channels" : move.strand !== null && rising.has(move.strand) ? "sliding" : "bed";
    if (runs.length === 0 || runs[runs.length - 1].stage !== stage) runs.push({ stage, moves: [] });
    runs[runs.length - 1].moves.push(...travels, move);
    travels = [];
  }
  if (runs.length > 0) runs[runs.length - 1].moves.push(...travels);
  return runs.map(layerOf);
}

function layerOf({ stage, moves }: { stage: Stage; moves: readonly PrintMove[] }): Layer {
  let [lowest, highest, length, minutes] = [Infinity, -Infinity, 0, 0];
  for (const move of moves) {
    const moveLength = lengthOf(move);
    minutes += moveLength / move.speed;
    if (move.kind === "travel") continue;
    length += moveLength;
    for (const [, , z] of move.points) [lowest, highest] = [Math.min(lowest, z), Math.max(highest, z)];
  }
  return { stage, moves, lowest, highest, length, travels: moves.filter((move) => move.kind === "travel").length, minutes };
}

export function lengthOf({ points }: PrintMove): number {
  return points.reduce((sum, point, k) => (k === 0 ? 0 : sum + Math.hypot(point[0] - points[k - 1][0], point[1] - points[k - 1][1], point[2] - points[k - 1][2])), 0);
}

/** Width in mm of a round bead with the cross-section of a move. */
export function widthOf({ area }: PrintMove): number {
  return 2 * Math.sqrt(area / Math.PI);
}
