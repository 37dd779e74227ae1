// What a person has decided on the weave page. Values: a change makes a new state, so that each can be undone.
import type { CrossingOverride, WeaveStrands } from "../contract/types";
import { DEFAULT_LENGTHS, type Lengths, type PatternId, PATTERNS } from "./patterns";

export type Point = readonly [x: number, y: number];
/** The two translations that repeat a cell, in mm. */
export type Lattice = readonly [Point, Point];
export type Strand = WeaveStrands["strands"][number];

/** Strands of one's own, with whatever else a pasted layout says of its crossings. */
export interface FreeLayout {
  readonly strands: readonly Strand[];
  /** null for a sheet. */
  readonly lattice: Lattice | null;
  readonly crossings?: WeaveStrands["crossings"];
  readonly sliding_share?: number;
}

export type LoadKind = "stretch_x" | "stretch_y" | "shear" | "push";

/** The finite piece that is put under load. */
export interface SheetState {
  readonly columns: number;
  readonly rows: number;
  readonly load: LoadKind;
  /** Of the sheet's width or height, dimensionless. */
  readonly amount: number;
}

export interface WeaveState {
  readonly pattern: PatternId;
  /** Which of the pattern's types, from 1. */
  readonly type: number;
  readonly lengths: Lengths;
  /** Of the strands' material, MPa. */
  readonly youngsModulus: number;
  readonly layout: FreeLayout;
  /** Crossings that are connected otherwise than the pattern has it, by rising number. */
  readonly overrides: readonly CrossingOverride[];
  /** Stretch minus one along each direction; never 0. */
  readonly strain: number;
  readonly shear: "free" | "suppressed";
  /** Whether the weave may leave its plane. */
  readonly space: "automatic" | "off";
  /** Pieces of rod between neighbouring crossings. */
  readonly segments: number;
  readonly sheet: SheetState;
}

export const STRAIN_LIMITS: readonly [number, number] = [-0.3, 0.6];
export const LEAST_STRAIN = 0.001;
export const MOST_SEGMENTS = 12;
/** Cells of a sheet along one side. */
export const MOST_CELLS = 30;
export const MOST_AMOUNT = 0.6;

/** A first layout to draw on: two waves that cross. */
export const FIRST_LAYOUT: FreeLayout = {
  strands: [
    { points: [[0, 5], [2.5, 6.5], [7.5, 3.5]], ends: "periodic", translation: [10, 0] },
    { points: [[5, 0], [3.5, 2.5], [6.5, 7.5]], ends: "periodic", translation: [0, 10] },
  ],
  lattice: [[10, 0], [0, 10]],
};

export const DEFAULT_STATE: WeaveState = {
  // The page opens on what is computed while one looks: a fraction of a second for all directions.
  pattern: "interlacing_circles",
  type: 1,
  lengths: DEFAULT_LENGTHS,
  youngsModulus: 3500,
  layout: FIRST_LAYOUT,
  overrides: [],
  strain: 0.1,
  shear: "free",
  space: "automatic",
  segments: 4,
  sheet: { columns: 3, rows: 3, load: "stretch_x", amount: 0.2 },
};

/** Whether there is a cell whose stiffness has a meaning in every direction. */
export function isPeriodic(state: WeaveState): boolean {
  return state.pattern === "layout" ? state.layout.lattice !== null : PATTERNS[state.pattern].periodic;
}

/** Strain moved away from 0, where a secant modulus has no meaning. */
export function usableStrain(strain: number): number {
  return Math.abs(strain) >= LEAST_STRAIN ? strain : strain < 0 ? -LEAST_STRAIN : LEAST_STRAIN;
}

/** The weave as a name for lists. */
export function weaveWords(state: WeaveState): string {
  const { words, types } = PATTERNS[state.pattern];
  const type = types.length > 0 ? `, ${types[state.type - 1].toLowerCase()}` : "";
  return `${words}${type}${state.overrides.length > 0 ? ", changed by hand" : ""}`;
}
