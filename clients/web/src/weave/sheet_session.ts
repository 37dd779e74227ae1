// The sheet under load: laid out, connected as the cell is, simulated. Knows no element of the page.
import { Observable } from "../base/observable";
import { type Client, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { WeaveLayout, WeaveSimulation, WeaveSimulationRequest, WeaveToolpath } from "../contract/types";
import { layoutRequest } from "./requests";
import type { WeaveSession } from "./session";
import { sheetOverrides, sheetWeave, simulationRequest } from "./sheet";
import { isPeriodic, type WeaveState } from "./state";

export interface SheetResult {
  readonly state: WeaveState;
  readonly request: WeaveSimulationRequest;
  /** The sheet at rest. */
  readonly layout: WeaveLayout;
  readonly answer: WeaveSimulation;
  /** Crossings of the sheet that the cell does not have. */
  readonly unknown: number;
}

export type SheetActivity = { kind: "idle" } | { kind: "busy"; words: string; progress: number | null } | { kind: "failed"; sentence: string };

/** All that the sheet's response depends on. */
export function sheetKey(state: WeaveState): string {
  const { columns, rows, load, amount } = state.sheet;
  return JSON.stringify([layoutRequest(state), state.segments, state.space, isPeriodic(state) && [columns, rows], load, amount]);
}

export class SheetSession {
  readonly result = new Observable<SheetResult | null>(null);
  readonly activity = new Observable<SheetActivity>({ kind: "idle" });
  private running: AbortController | null = null;

  constructor(
    private readonly session: WeaveSession,
    private readonly client: Client,
  ) {}

  run(): Promise<void> {
    return this.attempt("Laying out the sheet", async (signal) => {
      const state = this.session.state.get();
      const { request, layout, unknown } = await this.prepare(state, signal);
      const answer = await this.simulate(request, "Simulating", signal);
      if (!signal.aborted) this.result.set({ state, request, layout, answer, unknown });
    });
  }

  /** The file of one of the result's states; it is computed again for that. */
  async file(kind: "obj" | "vtu", index: number, save: (text: string) => void): Promise<void> {
    const result = this.result.get();
    if (!result) return;
    await this.attempt("Making the file", async (signal) => {
      const answer = await this.simulate({ ...result.request, deformed: kind }, "Making the file", signal);
      const text = answer.states[index]?.[kind];
      if (text !== undefined && !signal.aborted) save(text);
    });
  }

  /** How the sheet is printed, as G-code that its checker has read. */
  print(take: (toolpath: WeaveToolpath) => void): Promise<void> {
    return this.attempt("Laying out the sheet", async (signal) => {
      const { request } = await this.prepare(this.session.state.get(), signal);
      const toolpath = await this.compute<WeaveToolpath>("/v1/weave-toolpaths", { weave: request.weave }, "Planning the print", signal);
      if (!signal.aborted) take(toolpath);
    });
  }

  cancel(): void {
    this.running?.abort();
    this.running = null;
    this.activity.set({ kind: "idle" });
  }

  private async prepare(state: WeaveState, signal: AbortSignal): Promise<Pick<SheetResult, "request" | "layout" | "unknown">> {
    const lay = (weave: unknown) => this.client.post<WeaveLayout>("/v1/weave-layouts", { weave }, { signal });
    const weave = sheetWeave(state);
    const layout = await lay(weave);
    if (!isPeriodic(state)) return { request: simulationRequest(state, weave, layout), layout, unknown: 0 };
    const { overrides, unknown } = sheetOverrides(await lay(layoutRequest(state).weave), layout);
    const connected = overrides.length > 0 ? { ...weave, overrides } : weave;
    return { request: simulationRequest(state, connected, layout), layout, unknown };
  }

  private simulate(request: WeaveSimulationRequest, words: string, signal: AbortSignal): Promise<WeaveSimulation> {
    return this.compute<WeaveSimulation>("/v1/weave-simulations", request, words, signal);
  }

  private compute<Answer>(path: string, request: unknown, words: string, signal: AbortSignal): Promise<Answer> {
    return runJob<Answer>(this.client, path, request, {
      signal,
      onProgress: (job) => {
        if (!signal.aborted) this.activity.set({ kind: "busy", words: job.stage ? `${words}: ${job.stage}` : words, progress: job.progress });
      },
    });
  }

  private async attempt(words: string, act: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.cancel();
    const { signal } = (this.running = new AbortController());
    this.activity.set({ kind: "busy", words, progress: null });
    try {
      await act(signal);
      if (!signal.aborted) this.activity.set({ kind: "idle" });
    } catch (error) {
      if (!isAbort(error) && !signal.aborted) this.activity.set({ kind: "failed", sentence: explain(error) });
    }
  }
}
