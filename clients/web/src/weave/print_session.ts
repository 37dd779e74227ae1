// The print session: settings, the server's plan, and the G-code file. It does not depend on elements of the page.
import { debounce } from "../base/debounce";
import { Observable } from "../base/observable";
import { type Client, Problem } from "../contract/client";
import { type Activity, JobRunner, type Run, type WorkInWords } from "../contract/runner";
import { rewritten } from "../contract/places";
import { entriesAtFault, faultsIn } from "../contract/refusals";
import type { ProblemDocument, WeaveLayout, WeaveToolpath, WeaveToolpathRequest } from "../contract/types";
import type { Marked } from "./fault_view";
import { fused, ownCrossings, spreadFactor, spreadWeave } from "./print_repairs";
import { DEFAULT_SETTINGS, type KnownPrinter, storedSettings, type PrintSettings, toolpathRequest, type Value, withPrinter, withProfile } from "./printer";
import type { WeaveSession } from "./session";
import { type SheetLayout, layOutSheet, unknownWords } from "./sheet_layout";
import type { WeaveState } from "./state";
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
  /** What is wrong, for the field itself. */
  readonly words: string;
  /** What is wrong, and where. */
  readonly sentence: string;
}

/** The server's answer to a request that it has refused; null if it has not. */
function refusalOf(activity: Activity<WorkInWords>): ProblemDocument | null {
  return activity.kind === "failed" && activity.error instanceof Problem ? activity.error.document : null;
}

/** The faults of single fields for which the server has refused a request. */
export function faultsOf(activity: Activity<WorkInWords>): Fault[] {
  const refusal = refusalOf(activity);
  const placed = refusal ? faultsIn(refusal) : [];
  return (refusal?.errors ?? []).map(({ pointer, detail }, k) => ({ pointer: pointer ?? "", words: rewritten(detail), sentence: placed[k].sentence }));
}

/** A change of the weave after which the sheet can be printed, or fails for fewer reasons. */
export interface PrintRepair {
  readonly words: string;
  readonly title: string;
  readonly change: Partial<WeaveState>;
}

export class PrintSession {
  readonly settings: Observable<PrintSettings>;
  /** The newest plan. It is of earlier settings until the server has answered. */
  readonly plan = new Observable<Plan | null>(null);
  readonly activity: Observable<Activity<WorkInWords>>;
  private readonly runner: JobRunner;
  private readonly later = debounce(() => this.ask(), PAUSE_MS);
  private sheet: SheetLayout | null = null;
  private isOpen = false;

  constructor(
    private readonly session: WeaveSession,
    client: Client,
  ) {
    this.runner = new JobRunner(client);
    this.activity = this.runner.activity;
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
    this.runner.cancel();
  }

  change(pointer: string, value: Value): void {
    if (this.settings.get()[pointer] !== value) this.applySettings({ ...this.settings.get(), [pointer]: value });
  }

  choosePrinter(printer: KnownPrinter): void {
    this.applySettings(withPrinter(this.settings.get(), printer));
  }

  reset(): void {
    this.applySettings(DEFAULT_SETTINGS);
  }

  /** Loads the printer settings of a file. */
  openProfile(text: string): void {
    try {
      this.applySettings(withProfile(this.settings.get(), text));
    } catch (error) {
      this.runner.tellFailure(error);
    }
  }

  retry(): void {
    if (this.isOpen && this.activity.get().kind === "failed") this.ask();
  }

  /** The sheet that was laid out last; null before. */
  get sheetLayout(): WeaveLayout | null {
    return this.sheet?.layout ?? null;
  }

  /** The crossings and strands of the sheet for which it cannot be printed. */
  get marked(): Marked {
    const refusal = refusalOf(this.activity.get());
    if (!refusal) return { crossings: [], strands: [] };
    return { crossings: entriesAtFault(refusal, "crossings"), strands: entriesAtFault(refusal, "strands") };
  }

  /** Changes of the weave that repair what the server has refused. */
  get repairs(): readonly PrintRepair[] {
    const refusal = refusalOf(this.activity.get());
    const { crossings } = this.marked;
    if (!refusal || !this.sheet || crossings.length === 0) return [];
    const state = this.session.state.get();
    const repairs: PrintRepair[] = [];
    const factor = spreadFactor(refusal);
    const spread = factor === null ? null : spreadWeave(state, factor);
    if (spread) {
      repairs.push({ words: `Spread by ${factor}`, title: "Makes the weave larger and leaves its strands as thick as they are, so that crossings have room", change: spread });
    }
    const own = ownCrossings(state, this.session.laidOut.get()?.layout ?? null, this.sheet.layout, crossings);
    if (own) {
      repairs.push({
        words: crossings.length === 1 ? "Fuse this crossing" : `Fuse these ${crossings.length}`,
        title: "Fuses the crossings in red, and their copies in other cells: fused strands need no room",
        change: { overrides: fused(state.overrides, own) },
      });
    }
    return repairs;
  }

  /** Changes the weave, and plans the print again. */
  repair({ change }: PrintRepair): void {
    this.session.apply(change);
    this.begin();
  }

  /** Saves the G-code of the plan. It is computed again; equal requests have equal answers, so that it is the print of the plan. */
  save(take: (gcode: string) => void): void {
    if (!this.isCurrent) return;
    const settings = this.settings.get();
    void this.runner.begin({ words: "Writing the file" }, async (run) => {
      const { gcode } = await this.compute(settings, ["gcode"], "Writing the file", run);
      if (gcode !== undefined) take(gcode);
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
    void this.runner.begin({ words: "Laying out the sheet" }, async (run) => {
      this.sheet ??= await layOutSheet(run, this.session.state.get());
      const { layout } = this.sheet;
      const toolpath = await this.compute(settings, ["moves"], "Planning the print", run);
      const warnings = [unknownWords(this.sheet), ...layout.warnings].filter((words) => words !== "");
      this.plan.set({ settings, toolpath, layers: layersOf(toolpath.moves ?? []), warnings });
    });
  }

  private compute(settings: PrintSettings, include: WeaveToolpathRequest["include"], words: string, run: Run<WorkInWords>): Promise<WeaveToolpath> {
    if (!this.sheet) throw new Error("There is no sheet yet.");
    return run.job<WeaveToolpath>("/v1/weave-toolpaths", toolpathRequest(this.sheet.weave, settings, include), {
      wait: IMMEDIATE_SECONDS,
      onJob: ({ stage, progress }) => run.tell({ words: stage ? `${words}: ${stage}` : words }, progress),
    });
  }
}

function stored(): string | null {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null;
  }
}
