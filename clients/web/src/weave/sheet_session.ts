// The sheet session: lays out a sheet and simulates it under load. It does not depend on elements of the page.
import { Observable } from "../base/observable";
import type { Client } from "../contract/client";
import { type Activity, JobRunner, type Run, type WorkInWords } from "../contract/runner";
import type { WeaveLayout, WeaveSimulation, WeaveSimulationRequest } from "../contract/types";
import { layoutRequest, weaveSettings } from "./requests";
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

/** A key of all that the result depends on. */
export function sheetKey(state: WeaveState): string {
  const { columns, rows, load, amount } = state.sheet;
  return JSON.stringify([layoutRequest(state), weaveSettings(state), isPeriodic(state) && [columns, rows], load, amount]);
}

export class SheetSession {
  readonly result = new Observable<SheetResult | null>(null);
  readonly activity: Observable<Activity<WorkInWords>>;
  private readonly runner: JobRunner;

  constructor(
    private readonly session: WeaveSession,
    client: Client,
  ) {
    this.runner = new JobRunner(client);
    this.activity = this.runner.activity;
  }

  run(): Promise<void> {
    return this.runner.begin({ words: "Laying out the sheet" }, async (run) => {
      const state = this.session.state.get();
      const { weave, layout, unknown } = await layOutSheet(run, state);
      const request = simulationRequest(state, weave, layout);
      const answer = await this.simulate(request, "Simulating", run);
      this.result.set({ state, request, layout, answer, unknown });
    });
  }

  /** Saves a file of one state of the result. The simulation is run again for it. */
  async file(kind: "obj" | "vtu", index: number, save: (text: string) => void): Promise<void> {
    const result = this.result.get();
    if (!result) return;
    await this.runner.begin({ words: "Making the file" }, async (run) => {
      const answer = await this.simulate({ ...result.request, deformed: kind }, "Making the file", run);
      const text = answer.states[index]?.[kind];
      if (text !== undefined) save(text);
    });
  }

  cancel(): void {
    this.runner.cancel();
  }

  private simulate(request: WeaveSimulationRequest, words: string, run: Run<WorkInWords>): Promise<WeaveSimulation> {
    return run.job<WeaveSimulation>("/v1/weave-simulations", request, {
      onJob: ({ stage, progress }) => run.tell({ words: stage ? `${words}: ${stage}` : words }, progress),
    });
  }
}
