// The state of the weave page: everything that the user has chosen. States are immutable, so that changes can be undone.
import { type AccuracyChoice, NORMAL } from "../base/accuracy_choice";
import type { CrossingOverride, EffectSwitch, WeaveStrands } from "../contract/types";
import { DEFAULT_LENGTHS, type Lengths, type PatternId, PATTERNS } from "./patterns";

export type Point = readonly [x: number, y: number];
/** The two translations that repeat a cell, in mm. */
export type Lattice = readonly [Point, Point];
export type Strand = WeaveStrands["strands"][number];

/** User-drawn strands, and the settings of crossings in a pasted layout. */
export interface FreeLayout {
  readonly strands: readonly Strand[];
  /** Null for a sheet, which is not periodic. */
  readonly lattice: Lattice | null;
  readonly crossings?: WeaveStrands["crossings"];
  readonly sliding_share?: number;
}

export type LoadKind = "stretch_x" | "stretch_y" | "shear" | "push";

/** The finite sheet under load. */
export interface SheetState {
  readonly columns: number;
  readonly rows: number;
  readonly load: LoadKind;
  /** Displacement over the width or height of the sheet; for the rings, over 30 mm. */
  readonly amount: number;
}

export interface WeaveState {
  readonly pattern: PatternId;
  /** Number of the pattern's type, from 1. */
  readonly type: number;
  readonly lengths: Lengths;
  /** Young's modulus of the material of the strands, in MPa. */
  readonly youngsModulus: number;
  readonly layout: FreeLayout;
  /** Crossings whose connection differs from the pattern's, in ascending order. */
  readonly overrides: readonly CrossingOverride[];
  /** Engineering strain along each direction; never 0. */
  readonly strain: number;
  readonly shear: "free" | "suppressed";
  /** Whether the weave may leave its plane. */
  readonly space: EffectSwitch;
  readonly accuracy: AccuracyChoice;
  /** Number of rod segments between neighbouring crossings, if accuracy is a value of one's own. */
  readonly segments: number;
  readonly sheet: SheetState;
}

export const STRAIN_LIMITS: readonly [number, number] = [-0.3, 0.6];
export const MIN_STRAIN = 0.001;
export const MAX_SEGMENTS = 12;
/** Limit of the cells of a sheet along one side. */
export const MAX_CELLS = 30;
export const MAX_AMOUNT = 0.6;

/** The initial layout of user-drawn strands: two waves that cross. */
export const FIRST_LAYOUT: FreeLayout = {
  strands: [
    { points: [[0, 5], [2.5, 6.5], [7.5, 3.5]], ends: "periodic", translation: [10, 0] },
    { points: [[5, 0], [3.5, 2.5], [6.5, 7.5]], ends: "periodic", translation: [0, 10] },
  ],
  lattice: [[10, 0], [0, 10]],
};

export const DEFAULT_STATE: WeaveState = {
  // The page opens with a pattern whose profile takes a fraction of a second.
  pattern: "interlacing_circles",
  type: 1,
  lengths: DEFAULT_LENGTHS,
  youngsModulus: 3500,
  layout: FIRST_LAYOUT,
  overrides: [],
  strain: 0.1,
  shear: "free",
  space: "automatic",
  accuracy: NORMAL,
  segments: 4,
  sheet: { columns: 3, rows: 3, load: "stretch_x", amount: 0.2 },
};

/** Whether the weave has a periodic cell, so that its stiffness is defined in every direction. */
export function isPeriodic(state: WeaveState): boolean {
  return state.pattern === "layout" ? state.layout.lattice !== null : PATTERNS[state.pattern].periodic;
}

/** A strain moved away from 0, at which the secant modulus is undefined. */
export function usableStrain(strain: number): number {
  return Math.abs(strain) >= MIN_STRAIN ? strain : strain < 0 ? -MIN_STRAIN : MIN_STRAIN;
}

/** Label of a weave in lists. */
export function weaveWords(state: WeaveState): string {
  const { words, types } = PATTERNS[state.pattern];
  const type = types.length > 0 ? `, ${types[state.type - 1].toLowerCase()}` : "";
  return `${words}${type}${state.overrides.length > 0 ? ", changed by hand" : ""}`;
}
