// How the sheet is printed: what is set, what the server plans, and the file. Knows no element of the page.
import { late } from "../base/late";
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, explain, isAbort, Problem } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { WeaveToolpath, WeaveToolpathRequest } from "../contract/types";
import { DEFAULT_SETTINGS, keptSettings, type PrintSettings, toolpathRequest, type Value, withProfile } from "./printer";
import type { WeaveSession } from "./session";
import { type LaidSheet, laySheet, unknownWords } from "./sheet_layout";
import { type Layer, layersOf } from "./toolpath";

const KEY = "supple-print";
/** Seconds that an answer may take before it becomes a job whose progress is shown. */
const IMMEDIATE_SECONDS = 0.4;
const PAUSE_MS = 150;

export interface Plan {
  readonly settings: PrintSettings;
  readonly toolpath: WeaveToolpath;
  readonly layers: readonly Layer[];
  /** What to know of the sheet before it is printed. */
  readonly warnings: readonly string[];
}

/** What a problem says of one place of the request. */
export interface Fault {
  readonly pointer: string;
  readonly words: string;
}

export type PrintActivity =
  | { kind: "idle" }
  | { kind: "busy"; words: string; progress: number | null }
  | { kind: "failed"; sentence: string; faults: readonly Fault[] };

export class PrintSession {
  readonly settings: Observable<PrintSettings>;
  /** The newest plan; of earlier settings until that of the settings has come. */
  readonly plan = new Observable<Plan | null>(null);
  readonly activity = new Observable<PrintActivity>({ kind: "idle" });
  private readonly requests = new Latest();
  private readonly later = late(() => this.ask(), PAUSE_MS);
  private sheet: LaidSheet | null = null;
  private open = false;

  constructor(
    private readonly session: WeaveSession,
    private readonly client: Client,
  ) {
    this.settings = new Observable(keptSettings(stored()));
  }

  /** Whether the plan is that of the settings. */
  get isCurrent(): boolean {
    return this.plan.get()?.settings === this.settings.get();
  }

  /** Plans the print of the weave as it is now. */
  begin(): void {
    this.open = true;
    this.sheet = null;
    this.plan.set(null);
    this.ask();
  }

  /** Nobody looks any more. */
  end(): void {
    this.open = false;
    this.later.cancel();
    this.requests.cancel();
    this.activity.set({ kind: "idle" });
  }

  change(pointer: string, value: Value): void {
    if (this.settings.get()[pointer] !== value) this.use({ ...this.settings.get(), [pointer]: value });
  }

  reset(): void {
    this.use(DEFAULT_SETTINGS);
  }

  /** Takes the printer of a file. */
  openProfile(text: string): void {
    try {
      this.use(withProfile(this.settings.get(), text));
    } catch (error) {
      this.activity.set({ kind: "failed", sentence: explain(error), faults: [] });
    }
  }

  retry(): void {
    if (this.open && this.activity.get().kind === "failed") this.ask();
  }

  /** The file of the plan. An equal request has an equal answer, so that it is the print that was seen. */
  save(take: (gcode: string) => void): void {
    if (!this.isCurrent) return;
    const settings = this.settings.get();
    this.attempt("Writing the file", async (signal) => {
      const { gcode } = await this.compute(settings, ["gcode"], "Writing the file", signal);
      if (!signal.aborted && gcode !== undefined) take(gcode);
    });
  }

  private use(settings: PrintSettings): void {
    this.settings.set(settings);
    try {
      localStorage.setItem(KEY, JSON.stringify(settings));
    } catch {
      // they last as long as the page
    }
    if (this.open) this.later.ask();
  }

  private ask(): void {
    this.later.cancel();
    const settings = this.settings.get();
    this.attempt("Laying out the sheet", async (signal) => {
      this.sheet ??= await laySheet(this.client, this.session.state.get(), signal);
      const { layout } = this.sheet;
      const toolpath = await this.compute(settings, ["moves"], "Planning the print", signal);
      if (signal.aborted) return;
      const warnings = [unknownWords(this.sheet), ...layout.warnings].filter((words) => words !== "");
      this.plan.set({ settings, toolpath, layers: layersOf(toolpath.moves ?? []), warnings });
    });
  }

  private compute(settings: PrintSettings, include: WeaveToolpathRequest["include"], words: string, signal: AbortSignal): Promise<WeaveToolpath> {
    if (!this.sheet) throw new Error("There is no sheet yet.");
    return runJob<WeaveToolpath>(this.client, "/v1/weave-toolpaths", toolpathRequest(this.sheet.weave, settings, include), {
      signal,
      wait: IMMEDIATE_SECONDS,
      onProgress: (job) => {
        if (!signal.aborted) this.activity.set({ kind: "busy", words: job.stage ? `${words}: ${job.stage}` : words, progress: job.progress });
      },
    });
  }

  private attempt(words: string, act: (signal: AbortSignal) => Promise<void>): void {
    this.requests.submit(async (signal) => {
      this.activity.set({ kind: "busy", words, progress: null });
      try {
        await act(signal);
        if (!signal.aborted) this.activity.set({ kind: "idle" });
      } catch (error) {
        if (!isAbort(error) && !signal.aborted) this.activity.set({ kind: "failed", sentence: explain(error), faults: faultsOf(error) });
      }
    }, true);
  }
}

function faultsOf(error: unknown): Fault[] {
  if (!(error instanceof Problem)) return [];
  return (error.document.errors ?? []).map(({ pointer, detail }) => ({ pointer: pointer ?? "", words: detail }));
}

function stored(): string | null {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}
