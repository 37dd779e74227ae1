// The moves of a printer by layers: what lies on the bed, what is printed over it, what is bridged over that.
import type { PrintMove } from "../contract/types";

export type Stage = "bed" | "sliding" | "channels";

export const STAGE_WORDS: Readonly<Record<Stage, string>> = {
  bed: "on the bed",
  sliding: "strands that rise over others",
  channels: "channels over sliding strands",
};

/** Moves that are printed one after the other, at one stage of the sheet. */
export interface Layer {
  readonly stage: Stage;
  readonly moves: readonly PrintMove[];
  /** Heights of the nozzle while it prints, mm. */
  readonly lowest: number;
  readonly highest: number;
  /** Printed, mm. */
  readonly length: number;
  readonly travels: number;
  /** Lengths over speeds, minutes. */
  readonly minutes: number;
}

/** A travel belongs to what it leads to; one at the end to what it comes from. */
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
    const own = lengthOf(move);
    minutes += own / move.speed;
    if (move.kind === "travel") continue;
    length += own;
    for (const [, , z] of move.points) [lowest, highest] = [Math.min(lowest, z), Math.max(highest, z)];
  }
  return { stage, moves, lowest, highest, length, travels: moves.filter((move) => move.kind === "travel").length, minutes };
}

export function lengthOf({ points }: PrintMove): number {
  return points.reduce((sum, point, k) => (k === 0 ? 0 : sum + Math.hypot(point[0] - points[k - 1][0], point[1] - points[k - 1][1], point[2] - points[k - 1][2])), 0);
}

/** Width of the round bead that has a move's area, mm. */
export function widthOf({ area }: PrintMove): number {
  return 2 * Math.sqrt(area / Math.PI);
}
