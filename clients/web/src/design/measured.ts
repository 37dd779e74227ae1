// Measured data that became the target: what was read, with which settings, and what is drawn behind the curve.
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, explainFile, isAbort, Problem } from "../contract/client";
import type { MeasuredCurve, MeasuredCurveRequest } from "../contract/types";
import type { DesignSession } from "./session";
import type { ControlPoint, DesignState, ProfileKind } from "./state";

export interface MeasuredSettings {
  readonly columns: { readonly x?: number; readonly y?: number };
  readonly units: { readonly x?: string; readonly y?: string };
  readonly specimen: { readonly gauge_length?: number; readonly area?: number };
  /** At most so many control points. */
  readonly controlPoints: number;
}

export const FIRST_SETTINGS: MeasuredSettings = { columns: {}, units: {}, specimen: {}, controlPoints: 12 };

export interface MeasuredData {
  readonly name: string;
  readonly text: string;
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

export function measuredRequest(text: string, task: ProfileKind["task"], settings: MeasuredSettings): MeasuredCurveRequest {
  return {
    task,
    text,
    columns: { ...settings.columns },
    units: { ...settings.units },
    specimen: { ...settings.specimen },
    accuracy: { max_control_points: settings.controlPoints },
  };
}

/** The points that may be drawn behind a profile: those of its task and measure, behind the target that they became. */
export function drawnBehind(data: MeasuredData | null, kind: MeasuredKind): readonly ControlPoint[] {
  if (!data?.curve || data.kind.task !== kind.task || data.kind.measure !== kind.measure) return [];
  if ((data.kind.at ?? kind.at) !== kind.at || (data.kind.regionAt ?? kind.regionAt) !== kind.regionAt) return [];
  return data.curve.points.map(([x, y]): ControlPoint => [x, y]);
}

/** What the reduction did, in a sentence or two. */
export function reductionSentence(curve: MeasuredCurve, number: (value: number) => string, percent: (share: number) => string): string {
  const { error, target, point_count: count, message } = curve;
  const points = target.control_points.length;
  const unit = curve.task === "poisson" ? "" : " MPa";
  const follows = `${points} control points follow ${count.toLocaleString("en")} measured ones within ${percent(error.relative_rms)}, at most ${number(error.max)}${unit} apart.`;
  return message ? `${follows} ${message}` : follows;
}

export class Measured {
  readonly data = new Observable<MeasuredData | null>(null);
  private readonly requests = new Latest();

  constructor(
    private readonly session: DesignSession,
    private readonly client: Client,
  ) {}

  /** Data from a file, the clipboard or a drop: what the server reads becomes the target. Ends with why it was refused, or with "". */
  read(text: string, name: string): Promise<string> {
    return new Promise((done) => this.ask(text, name, FIRST_SETTINGS, done));
  }

  change(settings: Partial<MeasuredSettings>): void {
    const data = this.data.get();
    if (!data) return;
    // The target that the data became comes into sight, so that they replace no other.
    const { at, regionAt } = data.kind;
    if (regionAt !== undefined) this.session.selectRegion(regionAt);
    if (at !== undefined) this.session.select(at);
    this.ask(data.text, data.name, { ...data.settings, ...settings });
  }

  remove(): void {
    this.requests.cancel();
    this.data.set(null);
  }

  private ask(text: string, name: string, settings: MeasuredSettings, done: (problem: string) => void = () => {}): void {
    const { task } = this.session.state.get();
    // Instruments measure stretch and force over rest width; directions have no such choice.
    const kind = { task, measure: task === "stress_strain" ? ("engineering" as const) : this.session.state.get().measure };
    this.requests.submit(async (signal) => {
      try {
        const curve = await this.client.post<MeasuredCurve>("/v1/measured-curves", measuredRequest(text, task, settings), { signal });
        if (signal.aborted) return;
        const { at, regionAt } = this.session.state.get();
        this.data.set({ name, text, settings, curve, problem: "", places: [], kind: { ...kind, at, regionAt } });
        const { control_points: points, interpolation } = curve.target;
        this.session.apply({ points: points.map(([x, y]): ControlPoint => [x, y]), interpolation, measure: kind.measure, byHand: false });
        done("");
      } catch (error) {
        if (signal.aborted || isAbort(error)) return;
        const places = error instanceof Problem ? (error.document.errors ?? []).map((entry) => entry.pointer ?? "") : [];
        const known = this.data.get();
        const same = known?.text === text ? known : null;
        this.data.set({ name, text, settings, curve: same?.curve ?? null, problem: explainFile(error), places, kind: { ...same?.kind, ...kind } });
        done(explainFile(error));
      }
    }, true);
  }
}
