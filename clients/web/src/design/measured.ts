// Measured data that become the target: the table, the settings with which it is read, and the points that are drawn behind the target.
import { Observable } from "../base/observable";
import { type Client, explain, Problem } from "../contract/client";
import { JobRunner } from "../contract/runner";
import type { MeasuredCurve, MeasuredCurveRequest } from "../contract/types";
import type { DesignSession } from "./session";
import type { ControlPoint, DesignState, ProfileKind } from "./state";

/** A table in a request: its text, or the bytes of a file in base64, whose text encoding the server detects. */
export type MeasuredTable = { readonly text: string } | { readonly content: string };

export interface MeasuredSettings {
  readonly columns: { readonly x?: number | string; readonly y?: number | string };
  readonly units: { readonly x?: string; readonly y?: string };
  readonly specimen: { readonly gauge_length?: number; readonly area?: number };
  readonly sense?: MeasuredCurveRequest["sense"];
  readonly decimalSeparator?: MeasuredCurveRequest["decimal_separator"];
  readonly zero?: MeasuredCurveRequest["zero"];
  readonly block?: number;
  /** Upper limit of the number of control points. */
  readonly controlPoints: number;
}

export const INITIAL_SETTINGS: MeasuredSettings = { columns: {}, units: {}, specimen: {}, controlPoints: 12 };

export interface MeasuredData {
  readonly name: string;
  readonly table: MeasuredTable;
  readonly settings: MeasuredSettings;
  /** Null if the server cannot read the table with these settings. Then `problem` says why, and `pointers` are the JSON pointers of the fields. */
  readonly curve: MeasuredCurve | null;
  readonly problem: string;
  readonly pointers: readonly string[];
  /** Task and strain measure of the curve, and the target that it became. */
  readonly kind: MeasuredKind;
}

/** A kind of profile, and the indices of a target and its region; without indices it fits any target. */
export type MeasuredKind = Pick<ProfileKind, "task" | "measure"> & Partial<Pick<DesignState, "at" | "regionAt">>;

/** The table of a file: as text if it is UTF-8, otherwise as bytes. */
export function tableOf(bytes: ArrayBuffer): MeasuredTable {
  try {
    const text = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
    if (!text.includes("\0")) return { text };
  } catch {
    // Another encoding is sent as bytes.
  }
  let binary = "";
  for (const byte of new Uint8Array(bytes)) binary += String.fromCharCode(byte);
  return { content: btoa(binary) };
}

export function measuredRequest(table: MeasuredTable, task: ProfileKind["task"], settings: MeasuredSettings): MeasuredCurveRequest {
  return {
    task,
    ...table,
    columns: { ...settings.columns },
    units: { ...settings.units },
    specimen: { ...settings.specimen },
    ...(settings.sense && task === "stress_strain" ? { sense: settings.sense } : {}),
    ...(settings.decimalSeparator ? { decimal_separator: settings.decimalSeparator } : {}),
    ...(settings.zero ? { zero: settings.zero } : {}),
    ...(settings.block === undefined ? {} : { block: settings.block }),
    accuracy: { max_control_points: settings.controlPoints },
  } as MeasuredCurveRequest;
}

/** The measured points to be drawn behind a profile. There are none unless task, strain measure and target are those of the data. */
export function drawnBehind(data: MeasuredData | null, kind: MeasuredKind): readonly ControlPoint[] {
  if (!data?.curve || data.kind.task !== kind.task || data.kind.measure !== kind.measure) return [];
  if ((data.kind.at ?? kind.at) !== kind.at || (data.kind.regionAt ?? kind.regionAt) !== kind.regionAt) return [];
  return data.curve.points.map(([x, y]): ControlPoint => [x, y]);
}

/** JSON pointers of the fields that the user is asked for: the server could not read the file without them, or assumed their values. */
export function askedPointers(data: MeasuredData): ReadonlySet<string> {
  const assumed = (data.curve?.notes ?? []).map((note) => note.pointer).filter((pointer) => pointer !== "");
  return new Set(data.problem ? data.pointers : assumed);
}

/** Whether the user has to tell tension from compression: it is not set, and the server has read it nowhere or refuses the table without it. */
export function asksForSense({ curve, settings, problem, pointers }: Pick<MeasuredData, "curve" | "settings" | "problem" | "pointers">): boolean {
  return settings.sense === undefined && (problem === "" ? curve?.sense?.told_by === "nothing" : pointers.includes("/sense"));
}

/** The server's notes of a level. While the card asks for the sense, none of them says which one was assumed. */
export function notesOf(data: Pick<MeasuredData, "curve" | "settings" | "problem" | "pointers">, level: "note" | "warning"): string[] {
  const asks = asksForSense(data);
  return (data.curve?.notes ?? []).filter((note) => note.level === level && !(asks && note.pointer === "/sense")).map(({ text }) => text);
}

/** How closely the control points follow the data, with the server's notes. Warnings are shown elsewhere. */
export function reductionSentence(curve: MeasuredCurve, notes: readonly string[], number: (value: number) => string, percent: (fraction: number) => string): string {
  const { error, target, point_count: count } = curve;
  const points = target.control_points.length;
  const unit = curve.task === "poisson" ? "" : " MPa";
  const follows = `${points} control points follow ${count.toLocaleString("en")} measured ones within ${percent(error.relative_rms)}, at most ${number(error.max)}${unit} apart.`;
  return [follows, ...notes].join(" ");
}

export class Measured {
  readonly data = new Observable<MeasuredData | null>(null);
  private readonly requests: JobRunner;
  /** The last request, whether or not its answer has arrived. */
  private lastRequest: { readonly table: MeasuredTable; readonly settings: MeasuredSettings } | null = null;

  constructor(
    private readonly session: DesignSession,
    client: Client,
  ) {
    this.requests = new JobRunner(client);
  }

  /** Reads a table and makes it the target. Resolves with the reason for a refusal, or with "". */
  read(table: MeasuredTable, name: string): Promise<string> {
    return new Promise((done) => this.ask(table, name, INITIAL_SETTINGS, done));
  }

  /** Reads the table again with changed settings; the others stay. Changes are based on the last request, so that quick ones add up. */
  change(change: Partial<MeasuredSettings>): void {
    const data = this.data.get();
    if (!data) return;
    const settings = this.lastRequest?.table === data.table ? this.lastRequest.settings : data.settings;
    // The target of these data is selected, so that they replace no other one.
    const { at, regionAt } = data.kind;
    if (regionAt !== undefined) this.session.regionEdits.select(regionAt);
    if (at !== undefined) this.session.targetEdits.select(at);
    this.ask(data.table, data.name, {
      ...settings,
      ...change,
      columns: { ...settings.columns, ...change.columns },
      units: { ...settings.units, ...change.units },
      specimen: { ...settings.specimen, ...change.specimen },
    });
  }

  remove(): void {
    this.requests.stop();
    this.data.set(null);
  }

  private ask(table: MeasuredTable, name: string, settings: MeasuredSettings, done: (problem: string) => void = () => {}): void {
    this.lastRequest = { table, settings };
    const { task } = this.session.state.get();
    // Instruments measure elongation and force at the rest width, which is engineering strain. Profiles over direction have no such choice.
    const kind = { task, measure: task === "stress_strain" ? ("engineering" as const) : this.session.state.get().measure };
    this.requests.follow(async (run) => {
      const curve = await run.post<MeasuredCurve>("/v1/measured-curves", measuredRequest(table, task, settings));
      const { at, regionAt } = this.session.state.get();
      this.data.set({ name, table, settings, curve, problem: "", pointers: [], kind: { ...kind, at, regionAt } });
      const { control_points: points, interpolation } = curve.target;
      this.session.apply({ points: points.map(([x, y]): ControlPoint => [x, y]), interpolation, measure: kind.measure, byHand: false });
      done("");
    }, (error) => {
      const pointers = error instanceof Problem ? (error.document.errors ?? []).map((entry) => entry.pointer ?? "") : [];
      const known = this.data.get();
      const sameTable = known?.table === table ? known : null;
      this.data.set({ name, table, settings, curve: sameTable?.curve ?? null, problem: explain(error), pointers, kind: { ...sameTable?.kind, ...kind } });
      done(explain(error));
    }, true);
  }
}
