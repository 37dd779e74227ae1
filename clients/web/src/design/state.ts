// What a person has decided on the design page. Values: a change makes a new state, so that each can be undone.
import type { StrainMeasure, Task } from "../contract/types";
import { DEFAULT_MADE, type FoundMade, type Made } from "./made";

/** x: strain (dimensionless) or angle (radians); y: MPa, or dimensionless for Poisson's ratio. */
export type ControlPoint = readonly [x: number, y: number];

export type Interpolation = "cubic" | "monotone" | "linear";

export interface Found extends FoundMade {
  readonly family: string;
  readonly parameters: readonly number[];
}

/** One profile that is wanted of the design. */
export interface Target {
  /** Given by the person; empty where the target is called by what it shows. */
  readonly name: string;
  readonly task: Task;
  readonly points: readonly ControlPoint[];
  readonly interpolation: Interpolation;
  /** Angle of the load from the x axis, radians; of stress over strain. */
  readonly direction: number;
  /** Strain along the load at which the profile is taken; of the polar tasks. */
  readonly strain: number;
  readonly measure: StrainMeasure;
  /** How much it counts beside others. */
  readonly weight: number;
}

/** What one design is to do, and what was found: of a product all of it, or one part. Its own target is the one that is in sight and is edited. */
export interface Region extends Target {
  /** Name of the part; empty where it is called by its number. */
  readonly region: string;
  /** Further targets of the same design, in the order of their tabs. */
  readonly others: readonly Target[];
  /** Place of the target in sight among all, from 0. */
  readonly at: number;
  readonly made: Made;
  /** A family's id, or "any". */
  readonly family: string;
  /** The design that is shown, and where the next search starts. */
  readonly found: Found | null;
  /** Which parameters keep their value. */
  readonly fixed: readonly boolean[];
  /** Whether the parameters were set by the sliders instead of a search. */
  readonly byHand: boolean;
}

/** Its own region is the one that is in sight; the others stand in `otherRegions`. */
export interface DesignState extends Region {
  /** Further parts of the product, in the order of their tabs. */
  readonly otherRegions: readonly Region[];
  /** Place of the region in sight among all, from 0. */
  readonly regionAt: number;
}

export const ANY = "any";
export const WEIGHT_LIMITS = [0.1, 10] as const;

export const DEFAULT_STATE: DesignState = {
  name: "",
  task: "stress_strain",
  points: [],
  interpolation: "cubic",
  direction: 0,
  strain: 0.05,
  measure: "green",
  weight: 1,
  others: [],
  at: 0,
  made: DEFAULT_MADE,
  family: ANY,
  found: null,
  fixed: [],
  byHand: false,
  region: "",
  otherRegions: [],
  regionAt: 0,
};

export const TASKS: readonly Task[] = ["stress_strain", "stiffness", "poisson"];

export interface TaskWords {
  title: string;
  y: string;
  unit: string;
  short: string;
}

export const TASK_WORDS: Record<Task, TaskWords> = {
  stress_strain: { title: "Stress over strain", short: "Stress", y: "Stress", unit: "MPa" },
  stiffness: { title: "Stiffness over direction", short: "Stiffness", y: "Stiffness", unit: "MPa" },
  poisson: { title: "Poisson’s ratio over direction", short: "Poisson’s ratio", y: "Poisson’s ratio", unit: "" },
};

export type StrainWord = "Green strain" | "Engineering strain";
export const STRAIN_WORDS: Record<StrainMeasure, StrainWord> = { green: "Green strain", engineering: "Engineering strain" };

/** Whether the task's profile is over directions, with period pi. */
export function isPolar(task: Task): boolean {
  return task !== "stress_strain";
}

/** Whether two states ask for profiles of the same kind: their curves may be drawn into one plot. */
export function sameProfile(a: ProfileKind, b: ProfileKind): boolean {
  if (a.task !== b.task || a.measure !== b.measure) return false;
  return isPolar(a.task) ? a.strain === b.strain : a.direction === b.direction;
}

export type ProfileKind = Pick<Target, "task" | "direction" | "strain" | "measure">;
