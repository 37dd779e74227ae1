// Measured data that became the target: what was read, with which settings, and what is drawn behind the curve.
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, explainFile, isAbort, Problem } from "../contract/client";
import type { MeasuredCurve, MeasuredCurveRequest } from "../contract/types";
import type { DesignSession } from "./session";
import type { ControlPoint, DesignState, ProfileKind } from "./state";

/** A table as a request holds it: its text, or the bytes of a file in base64, whose encoding the server recognizes. */
export type MeasuredTable = { readonly text: string } | { readonly content: string };

export interface MeasuredSettings {
  readonly columns: { readonly x?: number | string; readonly y?: number | string };
  readonly units: { readonly x?: string; readonly y?: string };
  readonly specimen: { readonly gauge_length?: number; readonly area?: number };
  readonly sense?: MeasuredCurveRequest["sense"];
  readonly decimalSeparator?: MeasuredCurveRequest["decimal_separator"];
  readonly zero?: MeasuredCurveRequest["zero"];
  readonly block?: number;
  /** At most so many control points. */
  readonly controlPoints: number;
}

export const FIRST_SETTINGS: MeasuredSettings = { columns: {}, units: {}, specimen: {}, controlPoints: 12 };

export interface MeasuredData {
  readonly name: string;
  readonly table: MeasuredTable;
  readonly settings: MeasuredSettings;
  /** Null while the settings do not do; then `problem` says why and `places` which fields. */
  readonly curve: MeasuredCurve | null;
  readonly problem: string;
  readonly places: readonly string[];
  /** Of the curve, and of which target it became. */
  readonly kind: MeasuredKind;
}

/** Without the places of a target and a region: of whichever is in sight. */
export type MeasuredKind = Pick<ProfileKind, "task" | "measure"> & Partial<Pick<DesignState, "at" | "regionAt">>;

/** The table of a file. Text that is UTF-8 goes as it is. */
export function tableOf(bytes: ArrayBuffer): MeasuredTable {
  try {
    const text = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
    if (!text.includes("\0")) return { text };
  } catch {
    // Some other encoding.
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

/** The points that may be drawn behind a profile: those of its task and measure, behind the target that they became. */
export function drawnBehind(data: MeasuredData | null, kind: MeasuredKind): readonly ControlPoint[] {
  if (!data?.curve || data.kind.task !== kind.task || data.kind.measure !== kind.measure) return [];
  if ((data.kind.at ?? kind.at) !== kind.at || (data.kind.regionAt ?? kind.regionAt) !== kind.regionAt) return [];
  return data.curve.points.map(([x, y]): ControlPoint => [x, y]);
}

/** The fields that somebody is asked for: without them the file cannot be read, or something about it was assumed. */
export function askedFor(data: MeasuredData): ReadonlySet<string> {
  const assumed = (data.curve?.notes ?? []).map((note) => note.pointer).filter((pointer) => pointer !== "");
  return new Set(data.problem ? data.places : assumed);
}

/** What the reduction did and what is to be known about it; warnings stand by themselves. */
export function reductionSentence(curve: MeasuredCurve, number: (value: number) => string, percent: (share: number) => string): string {
  const { error, target, point_count: count } = curve;
  const points = target.control_points.length;
  const unit = curve.task === "poisson" ? "" : " MPa";
  const follows = `${points} control points follow ${count.toLocaleString("en")} measured ones within ${percent(error.relative_rms)}, at most ${number(error.max)}${unit} apart.`;
  return [follows, ...curve.notes.filter((note) => note.level === "note").map((note) => note.text)].join(" ");
}

export class Measured {
  readonly data = new Observable<MeasuredData | null>(null);
  private readonly requests = new Latest();
  /** What was asked for last, whether the answer has come or not. */
  private asked: { readonly table: MeasuredTable; readonly settings: MeasuredSettings } | null = null;

  constructor(
    private readonly session: DesignSession,
    private readonly client: Client,
  ) {}

  /** Data from a file, the clipboard or a drop: what the server reads becomes the target. Ends with why it was refused, or with "". */
  read(table: MeasuredTable, name: string): Promise<string> {
    return new Promise((done) => this.ask(table, name, FIRST_SETTINGS, done));
  }

  /** Asks again with these settings; columns, units and sizes that are not named stay. Changes that come before the answer to earlier ones add up. */
  change(change: Partial<MeasuredSettings>): void {
    const data = this.data.get();
    if (!data) return;
    const settings = this.asked?.table === data.table ? this.asked.settings : data.settings;
    // The target that the data became comes into sight, so that they replace no other.
    const { at, regionAt } = data.kind;
    if (regionAt !== undefined) this.session.selectRegion(regionAt);
    if (at !== undefined) this.session.select(at);
    this.ask(data.table, data.name, {
      ...settings,
      ...change,
      columns: { ...settings.columns, ...change.columns },
      units: { ...settings.units, ...change.units },
      specimen: { ...settings.specimen, ...change.specimen },
    });
  }

  remove(): void {
    this.requests.cancel();
    this.data.set(null);
  }

  private ask(table: MeasuredTable, name: string, settings: MeasuredSettings, done: (problem: string) => void = () => {}): void {
    this.asked = { table, settings };
    const { task } = this.session.state.get();
    // Instruments measure stretch and force over rest width; directions have no such choice.
    const kind = { task, measure: task === "stress_strain" ? ("engineering" as const) : this.session.state.get().measure };
    this.requests.submit(async (signal) => {
      try {
        const curve = await this.client.post<MeasuredCurve>("/v1/measured-curves", measuredRequest(table, task, settings), { signal });
        if (signal.aborted) return;
        const { at, regionAt } = this.session.state.get();
        this.data.set({ name, table, settings, curve, problem: "", places: [], kind: { ...kind, at, regionAt } });
        const { control_points: points, interpolation } = curve.target;
        this.session.apply({ points: points.map(([x, y]): ControlPoint => [x, y]), interpolation, measure: kind.measure, byHand: false });
        done("");
      } catch (error) {
        if (signal.aborted || isAbort(error)) return;
        const places = error instanceof Problem ? (error.document.errors ?? []).map((entry) => entry.pointer ?? "") : [];
        const known = this.data.get();
        const same = known?.table === table ? known : null;
        this.data.set({ name, table, settings, curve: same?.curve ?? null, problem: explainFile(error), places, kind: { ...same?.kind, ...kind } });
        done(explainFile(error));
      }
    }, true);
  }
}
