// The print session: settings, the server's plan, and the G-code file. It does not depend on elements of the page.
import { debounce } from "../base/debounce";
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, explain, isAbort, Problem } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { WeaveToolpath, WeaveToolpathRequest } from "../contract/types";
import { DEFAULT_SETTINGS, storedSettings, type PrintSettings, toolpathRequest, type Value, withProfile } from "./printer";
import type { WeaveSession } from "./session";
import { type SheetLayout, layOutSheet, unknownWords } from "./sheet_layout";
import { type Layer, layersOf } from "./toolpath";

const KEY = "supple-print";
/** Time in seconds after which a computation becomes a job with progress. */
const IMMEDIATE_SECONDS = 0.4;
const PAUSE_MS = 150;

export interface Plan {
  readonly settings: PrintSettings;
  readonly toolpath: WeaveToolpath;
  readonly layers: readonly Layer[];
  /** Warnings about the sheet. */
  readonly warnings: readonly string[];
}

/** A fault of one field of the request. */
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
  /** The newest plan. It is of earlier settings until the server has answered. */
  readonly plan = new Observable<Plan | null>(null);
  readonly activity = new Observable<PrintActivity>({ kind: "idle" });
  private readonly requests = new Latest();
  private readonly later = debounce(() => this.ask(), PAUSE_MS);
  private sheet: SheetLayout | null = null;
  private isOpen = false;

  constructor(
    private readonly session: WeaveSession,
    private readonly client: Client,
  ) {
    this.settings = new Observable(storedSettings(stored()));
  }

  /** Whether the plan belongs to the present settings. */
  get isCurrent(): boolean {
    return this.plan.get()?.settings === this.settings.get();
  }

  /** Opens the session and plans the print of the present weave. */
  begin(): void {
    this.isOpen = true;
    this.sheet = null;
    this.plan.set(null);
    this.ask();
  }

  /** Closes the session and cancels its requests. */
  end(): void {
    this.isOpen = false;
    this.later.cancel();
    this.requests.cancel();
    this.activity.set({ kind: "idle" });
  }

  change(pointer: string, value: Value): void {
    if (this.settings.get()[pointer] !== value) this.applySettings({ ...this.settings.get(), [pointer]: value });
  }

  reset(): void {
    this.applySettings(DEFAULT_SETTINGS);
  }

  /** Loads the printer settings of a file. */
  openProfile(text: string): void {
    try {
      this.applySettings(withProfile(this.settings.get(), text));
    } catch (error) {
      this.activity.set({ kind: "failed", sentence: explain(error), faults: [] });
    }
  }

  retry(): void {
    if (this.isOpen && this.activity.get().kind === "failed") this.ask();
  }

  /** Saves the G-code of the plan. It is computed again; equal requests have equal answers, so that it is the print of the plan. */
  save(take: (gcode: string) => void): void {
    if (!this.isCurrent) return;
    const settings = this.settings.get();
    this.attempt("Writing the file", async (signal) => {
      const { gcode } = await this.compute(settings, ["gcode"], "Writing the file", signal);
      if (!signal.aborted && gcode !== undefined) take(gcode);
    });
  }

  private applySettings(settings: PrintSettings): void {
    this.settings.set(settings);
    try {
      localStorage.setItem(KEY, JSON.stringify(settings));
    } catch {
      // storage is blocked: the settings last as long as the page
    }
    if (this.isOpen) this.later.schedule();
  }

  private ask(): void {
    this.later.cancel();
    const settings = this.settings.get();
    this.attempt("Laying out the sheet", async (signal) => {
      this.sheet ??= await layOutSheet(this.client, this.session.state.get(), signal);
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
