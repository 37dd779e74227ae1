// What a person has decided on the design page. Values: a change makes a new state, so that each can be undone.
import type { StrainMeasure, Task } from "../contract/types";

/** x: strain (dimensionless) or angle (radians); y: MPa, or dimensionless for Poisson's ratio. */
export type ControlPoint = readonly [x: number, y: number];

export type Interpolation = "cubic" | "monotone" | "linear";

export interface Found {
  readonly family: string;
  readonly parameters: readonly number[];
}

export interface DesignState {
  readonly task: Task;
  readonly points: readonly ControlPoint[];
  readonly interpolation: Interpolation;
  /** Angle of the load from the x axis, radians; of stress over strain. */
  readonly direction: number;
  /** Strain along the load at which the profile is taken; of the polar tasks. */
  readonly strain: number;
  readonly measure: StrainMeasure;
  /** A family's id, or "any". */
  readonly family: string;
  /** The design that is shown, and where the next search starts. */
  readonly found: Found | null;
  /** Which parameters keep their value. */
  readonly fixed: readonly boolean[];
  /** Whether the parameters were set by the sliders instead of a search. */
  readonly byHand: boolean;
}

export const ANY = "any";

export const DEFAULT_STATE: DesignState = {
  task: "stress_strain",
  points: [],
  interpolation: "cubic",
  direction: 0,
  strain: 0.05,
  measure: "green",
  family: ANY,
  found: null,
  fixed: [],
  byHand: false,
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

export type ProfileKind = Pick<DesignState, "task" | "direction" | "strain" | "measure">;
