// The sheet session: lays out a sheet and simulates it under load. It does not depend on elements of the page.
import { Observable } from "../base/observable";
import { type Client, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { WeaveLayout, WeaveSimulation, WeaveSimulationRequest } from "../contract/types";
import { layoutRequest } from "./requests";
import type { WeaveSession } from "./session";
import { simulationRequest } from "./sheet";
import { layOutSheet } from "./sheet_layout";
import { isPeriodic, type WeaveState } from "./state";

export interface SheetResult {
  readonly state: WeaveState;
  readonly request: WeaveSimulationRequest;
  /** The sheet at rest. */
  readonly layout: WeaveLayout;
  readonly answer: WeaveSimulation;
  /** Number of crossings of the sheet without a counterpart in the cell. */
  readonly unknown: number;
}

export type SheetActivity = { kind: "idle" } | { kind: "busy"; words: string; progress: number | null } | { kind: "failed"; sentence: string };

/** A key of all that the result depends on. */
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
      const { weave, layout, unknown } = await layOutSheet(this.client, state, signal);
      const request = simulationRequest(state, weave, layout);
      const answer = await this.simulate(request, "Simulating", signal);
      if (!signal.aborted) this.result.set({ state, request, layout, answer, unknown });
    });
  }

  /** Saves a file of one state of the result. The simulation is run again for it. */
  async file(kind: "obj" | "vtu", index: number, save: (text: string) => void): Promise<void> {
    const result = this.result.get();
    if (!result) return;
    await this.attempt("Making the file", async (signal) => {
      const answer = await this.simulate({ ...result.request, deformed: kind }, "Making the file", signal);
      const text = answer.states[index]?.[kind];
      if (text !== undefined && !signal.aborted) save(text);
    });
  }

  cancel(): void {
    this.running?.abort();
    this.running = null;
    this.activity.set({ kind: "idle" });
  }

  private simulate(request: WeaveSimulationRequest, words: string, signal: AbortSignal): Promise<WeaveSimulation> {
    return runJob<WeaveSimulation>(this.client, "/v1/weave-simulations", request, {
      signal,
      onProgress: (job) => {
        if (!signal.aborted) this.activity.set({ kind: "busy", words: job.stage ? `${words}: ${job.stage}` : words, progress: job.progress });
      },
    });
  }

  private async attempt(words: string, act: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.cancel();
    this.running = new AbortController();
    const { signal } = this.running;
    this.activity.set({ kind: "busy", words, progress: null });
    try {
      await act(signal);
      if (!signal.aborted) this.activity.set({ kind: "idle" });
    } catch (error) {
      if (!isAbort(error) && !signal.aborted) this.activity.set({ kind: "failed", sentence: explain(error) });
    }
  }
}
