// The simulated responses of designs, which are kept: in the page for undo, other sizes and other tabs, in the browser's storage for reloads.
import type { Curve } from "../base/curve";
import { Observable } from "../base/observable";
import type { DesignProfile, Effect, Polish } from "../contract/types";
import type { TargetResponse } from "./shown";
import { modulusOf, orientationOf, type Specification } from "./specification";
import { isPolar, type ProfileKind, type Target, type TilingDesign } from "./state";

const KEY = "supple-simulations";
const MAX_RECORDS = 40;
/** Parameters that differ by less are those of one design: links and searches that are repeated round them. */
const SAME_PARAMETER = 2e-4;
/** Largest relative difference of other numbers that count as equal. */
const SAME_NUMBER = 1e-5;

/** What the response of a design depends on. Its size does not count: the response is the same for every size. */
export interface SimulatedDesign {
  readonly family: string;
  readonly parameters: readonly number[];
  /** In MPa. */
  readonly youngsModulus: number;
  /** In radians. */
  readonly orientation: number;
}

/** The simulated response to one target. */
export interface SimulatedTarget {
  readonly curve: Curve;
  /** Relative root mean square difference from the model; null if it is not known. */
  readonly deviation: number | null;
  /** Estimated relative error of the mesh; null if it is not known. */
  readonly mesh: number | null;
  /** Relative changes of the profile at rest with beams 5 % wider and narrower; absent if they are not known. */
  readonly beamWidth?: NonNullable<DesignProfile["beam_width_sensitivity"]>;
}

/** One simulation of a design, along the profiles of its targets. */
export interface SimulationRecord {
  readonly design: SimulatedDesign;
  readonly profiles: readonly (SimulatedTarget & { readonly kind: ProfileKind })[];
  readonly polish: Polish | null;
  /** The text of the targets that the polish has followed. */
  readonly targets: string;
  /** Effects of the simulation; those of earlier versions have none. */
  readonly effects?: readonly Effect[];
  readonly seconds: number;
}

export function simulatedDesign(found: TilingDesign, made: Specification): SimulatedDesign {
  return { family: found.family, parameters: found.parameters, youngsModulus: modulusOf(made, found), orientation: orientationOf(made, found) };
}

export function sameSimulatedDesign(a: SimulatedDesign, b: SimulatedDesign): boolean {
  return a.family === b.family && a.parameters.length === b.parameters.length
    && a.parameters.every((value, k) => Math.abs(value - b.parameters[k]) <= SAME_PARAMETER * Math.max(1, Math.abs(value)))
    && isSame(a.youngsModulus, b.youngsModulus) && Math.abs(a.orientation - b.orientation) <= SAME_PARAMETER;
}

function isSame(a: number, b: number): boolean {
  return Math.abs(a - b) <= SAME_NUMBER * Math.max(Math.abs(a), Math.abs(b));
}

/** Whether a simulated curve is the response of its design to a target: it is of the same kind and covers the same range. */
function fits({ kind, curve: { x } }: SimulationRecord["profiles"][number], target: ProfileKind & Pick<Target, "points">): boolean {
  if (kind.task !== target.task || kind.measure !== target.measure) return false;
  if (isPolar(target.task)) return isSame(kind.strain, target.strain);
  const { points } = target;
  const width = points.length < 2 ? 0 : points[points.length - 1][0] - points[0][0];
  const isNear = (a: number, b: number) => Math.abs(a - b) <= SAME_NUMBER * width;
  return Math.abs(kind.direction - target.direction) <= SAME_NUMBER && width > 0 && isNear(x[0], points[0][0]) && isNear(x[x.length - 1], points[points.length - 1][0]);
}

export class Simulations {
  /** The newest first. */
  readonly list = new Observable<readonly SimulationRecord[]>(stored());

  /** Adds a simulation, in the place of an earlier one of the same design and the same targets. */
  add(record: SimulationRecord): void {
    const isOf = (other: SimulationRecord): boolean =>
      sameSimulatedDesign(other.design, record.design) && other.profiles.length === record.profiles.length
      && JSON.stringify(other.profiles.map(({ kind }) => kind)) === JSON.stringify(record.profiles.map(({ kind }) => kind));
    this.list.set([record, ...this.list.get().filter((other) => !isOf(other))].slice(0, MAX_RECORDS));
    try {
      localStorage.setItem(KEY, JSON.stringify(this.list.get()));
    } catch {
      // storage is blocked or full: the simulations last as long as the page
    }
  }

  /** The newest simulation of a design along the profiles of all targets; null if there is none. */
  find(found: TilingDesign | null, made: Specification, targets: readonly Target[]): SimulationRecord | null {
    if (!found) return null;
    const design = simulatedDesign(found, made);
    const isOf = (record: SimulationRecord): boolean =>
      sameSimulatedDesign(record.design, design) && targets.every((target) => record.profiles.some((profile) => fits(profile, target)));
    return this.list.get().find(isOf) ?? null;
  }

  /** The simulated curve of a response; null if there is none. */
  curveOf({ found, made, task, direction, strain, measure, points }: Pick<TargetResponse, "found" | "made" | "points" | keyof ProfileKind>): Curve | null {
    const design = simulatedDesign(found, made);
    for (const record of this.list.get()) {
      if (!sameSimulatedDesign(record.design, design)) continue;
      const profile = record.profiles.find((one) => fits(one, { task, direction, strain, measure, points }));
      if (profile) return profile.curve;
    }
    return null;
  }
}

/** The simulated response of a record to a target; null if the record has none. */
export function simulatedTarget(record: SimulationRecord, target: Target): SimulatedTarget | null {
  return record.profiles.find((profile) => fits(profile, target)) ?? null;
}

/** The simulations in the browser's storage. What is there may be of another version, so that records of another shape are left out. */
function stored(): readonly SimulationRecord[] {
  try {
    const records = JSON.parse(localStorage.getItem(KEY) ?? "[]") as readonly SimulationRecord[];
    return records.filter(isRecord).slice(0, MAX_RECORDS);
  } catch {
    return [];
  }
}

function isRecord(record: SimulationRecord): boolean {
  const { design, profiles, polish } = record;
  return [design.parameters, profiles].every(Array.isArray) && Number.isFinite(design.youngsModulus) && Number.isFinite(design.orientation)
    && (polish === null || Array.isArray(polish.rounds))
    && profiles.every(({ kind, curve }) => typeof kind.task === "string" && Array.isArray(curve.x) && Array.isArray(curve.y) && curve.x.length === curve.y.length);
}
