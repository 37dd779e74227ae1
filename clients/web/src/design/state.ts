// The state of the design page: everything that the user has chosen. States are immutable, so that changes can be undone.
import { type AccuracyChoice, NORMAL } from "../base/accuracy_choice";
import type { StrainMeasure, Task } from "../contract/types";
import { DEFAULT_SPECIFICATION, type FoundSpecification, type Specification } from "./specification";

/** x: strain, or angle in radians; y: in MPa, or dimensionless for Poisson's ratio. */
export type ControlPoint = readonly [x: number, y: number];

export type Interpolation = "cubic" | "monotone" | "linear";

export interface TilingDesign extends FoundSpecification {
  readonly family: string;
  readonly parameters: readonly number[];
}

/** One profile that the design is to have. */
export interface Target {
  /** Name that the user has given; empty for a label made of task and direction. */
  readonly name: string;
  readonly task: Task;
  readonly points: readonly ControlPoint[];
  readonly interpolation: Interpolation;
  /** Angle of the load from the x axis, in radians, for stress over strain. */
  readonly direction: number;
  /** Strain along the load, for profiles over direction. */
  readonly strain: number;
  readonly measure: StrainMeasure;
  /** Weight of the target among several. */
  readonly weight: number;
}

/** One design problem and its solution. The fields of Target are those of the selected target, which is the one that is edited. */
export interface Region extends Target {
  /** Name of the region; empty for a label with its number. */
  readonly region: string;
  /** Further targets of the same design, in the order of their tabs. */
  readonly others: readonly Target[];
  /** Index of the selected target among all. */
  readonly at: number;
  /** Material, orientation, size and limits of the structure. */
  readonly made: Specification;
  /** A family's id, or "any". */
  readonly family: string;
  /** The present design, from which the next search starts. */
  readonly found: TilingDesign | null;
  /** Whether each parameter is fixed in searches. */
  readonly fixed: readonly boolean[];
  /** Whether the parameters were set with the sliders, and not by a search. */
  readonly byHand: boolean;
}

/** All regions of a product. The fields of Region are those of the selected region. */
export interface Product extends Region {
  /** The other regions of the product, in the order of their tabs. */
  readonly otherRegions: readonly Region[];
  /** Index of the selected region among all. */
  readonly regionAt: number;
}

/** The state of the page. */
export interface DesignState extends Product {
  /** How accurate searches are. */
  readonly accuracy: AccuracyChoice;
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
  made: DEFAULT_SPECIFICATION,
  family: ANY,
  found: null,
  fixed: [],
  byHand: false,
  region: "",
  otherRegions: [],
  regionAt: 0,
  accuracy: NORMAL,
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

/** Whether the profile of a task is over direction, with period pi. */
export function isPolar(task: Task): boolean {
  return task !== "stress_strain";
}

/** Whether two profiles are of the same kind, so that their curves can be drawn into one plot. */
export function sameProfile(a: ProfileKind, b: ProfileKind): boolean {
  if (a.task !== b.task || a.measure !== b.measure) return false;
  return isPolar(a.task) ? a.strain === b.strain : a.direction === b.direction;
}

export type ProfileKind = Pick<Target, "task" | "direction" | "strain" | "measure">;
