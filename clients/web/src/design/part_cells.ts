// How many cells of the structure a part has across and along it, and the size with which its edges count less.
import { digits } from "../base/format";
import type { PartSettings } from "./part";
import type { Measures } from "./shown";

/** Cells from which on the edges of a part have little influence. */
const MIN_ACROSS = 6;
/** The same between the grips of a coupon. */
const MIN_ALONG = 12;
/** Rounding of a number of cells. */
const ROUNDING = 1e-9;

export interface PartCells {
  readonly across: number;
  readonly along: number;
  /** Cells along from which on the edges count little. */
  readonly minAlong: number;
  /** A size in mm with enough cells; null where the part has enough of them. */
  readonly better: { readonly width: number; readonly length: number } | null;
}

type CellSettings = Pick<PartSettings, "kind" | "width" | "length" | "beamWidth">;

/** The cells of a part; null for a drawing, and for a structure without a size. Cells grow with the walls. */
export function cellsOf({ kind, width, length, beamWidth }: CellSettings, measures: Pick<Measures, "beamWidth" | "cellSize"> | null): PartCells | null {
  if (kind === "drawing" || !measures?.beamWidth || !measures.cellSize || !(beamWidth > 0)) return null;
  const cell = (measures.cellSize * beamWidth) / measures.beamWidth;
  const [across, along] = [width / cell, length / cell];
  const minAlong = kind === "coupon" ? MIN_ALONG : MIN_ACROSS;
  if (across >= MIN_ACROSS - ROUNDING && along >= minAlong - ROUNDING) return { across, along, minAlong, better: null };
  const enough = (size: number, cells: number): number => Math.max(size, Math.ceil(cells * cell));
  return { across, along, minAlong, better: { width: enough(width, MIN_ACROSS), length: enough(length, minAlong) } };
}

/** A sentence about a part with few cells; empty if it has enough. */
export function cellWords({ across, along, minAlong, better }: PartCells): string {
  if (!better) return "";
  const isNarrow = across < MIN_ACROSS - ROUNDING;
  const few = isNarrow ? `${count(across)} across` : `${count(along)} along`;
  return `About ${few}: the edges count. ${isNarrow ? MIN_ACROSS : minAlong} or more are better.`;
}

function count(cells: number): string {
  const rounded = digits(cells < 3 ? Math.round(2 * cells) / 2 : Math.floor(cells));
  return `${rounded} ${rounded === "1" ? "cell" : "cells"}`;
}
