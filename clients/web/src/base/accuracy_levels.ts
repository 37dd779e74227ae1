// The levels of accuracy: what each one asks of the server, how long it takes and how far off it may be. The table is api/accuracy_levels.json,
// which tests/bench/accuracy_levels.py measures; what this machine has computed scales its numbers.
import { levels } from "../../../../api/accuracy_levels.json";
import { type AccuracyChoice, type Level, switchesOf } from "./accuracy_choice";
import { Observable } from "./observable";

export type Capability = "designs" | "simulations" | "networks" | "hosts" | "voronoi" | "voronoi_optimizations" | "weaves" | "geodesics";

/** A row of the table. */
export interface LevelRow {
  readonly capability: string;
  readonly level: string;
  /** The members `accuracy` and `effects` of a request, of which each takes the place of the request's own. */
  readonly request: object;
  /** The reference task, in words. */
  readonly task: string;
  /** Duration of the reference task; null if nobody has measured it. */
  readonly seconds: number | null;
  /** Dimensionless; 0 is below rounding. Null if it is unknown: nobody has measured it, or the errors of the other levels are measured against this one. */
  readonly error: number | null;
  readonly error_of: string;
  readonly why: string;
}

export const LEVEL_ROWS: readonly LevelRow[] = levels;

export function levelRow(capability: Capability, level: AccuracyChoice["level"], rows = LEVEL_ROWS): LevelRow | null {
  return rows.find((row) => row.capability === capability && row.level === level) ?? null;
}

type Parts = { readonly accuracy?: object; readonly effects?: object };

/** A request at the chosen level, with the effects that were switched on or off. Values of one's own stay as they are in the request. */
export function atLevel<Request extends Parts>(request: Request, capability: Capability, choice: AccuracyChoice): Request {
  const { accuracy, effects }: Parts = levelRow(capability, choice.level)?.request ?? {};
  const switches = switchesOf(choice, capability);
  const merged = <Part extends object>(own: Part | undefined, ...others: (object | undefined)[]): Part => Object.assign({}, own, ...others) as Part;
  return {
    ...request,
    ...(accuracy && { accuracy: merged(request.accuracy, accuracy) }),
    ...((effects ?? Object.keys(switches).length > 0) && { effects: merged(request.effects, effects, switches) }),
  };
}

/** What a computation of this machine took, and its error where the answer states one. */
export interface Measured {
  readonly level: AccuracyChoice["level"];
  readonly seconds: number;
  readonly error: number | null;
}

/** The last computations of a capability: at one of the levels, and with values of one's own. */
interface LastMeasured {
  readonly ofLevel: Measured | null;
  readonly own: Measured | null;
}

/** What the last computations of a page took. */
export class LevelMeasures {
  readonly last = new Observable<Readonly<Partial<Record<Capability, LastMeasured>>>>({});

  record(capability: Capability, measured: Measured): void {
    const { ofLevel, own } = this.of(capability);
    const known: LastMeasured = measured.level === "own" ? { ofLevel, own: measured } : { ofLevel: measured, own };
    this.last.set({ ...this.last.get(), [capability]: known });
  }

  of(capability: Capability): LastMeasured {
    return this.last.get()[capability] ?? { ofLevel: null, own: null };
  }
}

export interface Estimate {
  readonly seconds: number | null;
  readonly error: number | null;
  /** `measured`: this machine has just taken that long; `scaled`: it has computed at another level; `table`: it has computed nothing yet. */
  readonly source: "measured" | "scaled" | "table";
  /** Where the error is from. */
  readonly errorSource: "measured" | "scaled" | "table";
}

/** What a level takes on this machine and how far off it is, by what was computed last where something was, otherwise by the table. */
export function estimate(capability: Capability, level: AccuracyChoice["level"], { ofLevel, own }: LastMeasured, rows = LEVEL_ROWS): Estimate {
  if (level === "own") return { seconds: own?.seconds ?? null, error: own?.error ?? null, source: "measured", errorSource: "measured" };
  const row = levelRow(capability, level, rows);
  if (ofLevel?.level === level) {
    return { seconds: ofLevel.seconds, error: ofLevel.error ?? row?.error ?? null, source: "measured", errorSource: ofLevel.error === null ? "table" : "measured" };
  }
  const known = ofLevel && levelRow(capability, ofLevel.level, rows);
  const seconds = scaled(row?.seconds, known?.seconds, ofLevel?.seconds);
  const error = scaled(row?.error, known?.error, ofLevel?.error);
  return {
    seconds: seconds ?? row?.seconds ?? null,
    error: error ?? row?.error ?? null,
    source: seconds === null ? "table" : "scaled",
    errorSource: error === null ? "table" : "scaled",
  };
}

/** A value of the table times what was measured over the table's value of it; null where one of them is unknown or 0. */
function scaled(value: number | null | undefined, known: number | null | undefined, measured: number | null | undefined): number | null {
  return value != null && known && measured ? (value * measured) / known : null;
}

export const LEVELS: readonly Level[] = ["draft", "normal", "sure"];
