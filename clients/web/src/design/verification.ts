// Simulations of the shown design at its native scale: its curves, its deformed patch, and on request its correction by simulations
// (polish). A change of the design ends them.
import type { Curve } from "../base/curve";
import { Observable } from "../base/observable";
import { type Client, explain } from "../contract/client";
import { JobRunner, type Run } from "../contract/runner";
import type { DesignAnswer, DesignRequest, Job, Polish, Simulation } from "../contract/types";
import { patchDirection, patchRequest, polishRequest, verificationRequest } from "./requests";
import type { DesignSession } from "./session";
import { designOf, sameTilingDesign, sameRequirements, type TargetResponse } from "./shown";
import type { DesignState, TilingDesign } from "./state";
import { askedOrder } from "./target_list";

export type VerificationState =
  | { kind: "none" }
  | { kind: "running"; progress: number; stage: string; round: PolishRound | null }
  | { kind: "failed"; sentence: string }
  | { kind: "done"; simulated: readonly SimulatedTarget[]; polish: Polish; seconds: number };

/** The simulated response to one target. */
export interface SimulatedTarget {
  readonly curve: Curve;
  /** Relative root mean square difference from the model; null if it is not known. */
  readonly deviation: number | null;
  /** Estimated relative error of the mesh; null if it is not known. */
  readonly mesh: number | null;
}

/** The last round of a running polish: its number, and the deviation of the simulation from the target. */
export interface PolishRound {
  readonly count: number;
  readonly error: number | null;
}

export type PatchState =
  | { kind: "none" }
  | { kind: "running"; progress: number }
  | { kind: "failed"; sentence: string }
  | { kind: "done"; simulation: Simulation; direction: number };

export class Verification {
  readonly state = new Observable<VerificationState>({ kind: "none" });
  readonly patch = new Observable<PatchState>({ kind: "none" });
  private readonly runner: JobRunner;
  private subject: TargetResponse | null = null;

  /** The simulated response to the selected target. */
  get simulated(): SimulatedTarget | null {
    const state = this.state.get();
    return state.kind === "done" ? (state.simulated[this.session.state.get().at] ?? null) : null;
  }

  constructor(
    private readonly session: DesignSession,
    client: Client,
  ) {
    this.runner = new JobRunner(client);
    session.results.shown.watch((shown) => {
      if (this.subject && (!shown || !isSameResult(shown, this.subject))) this.clear();
    });
  }

  async verify(): Promise<void> {
    await this.simulate(verificationRequest);
  }

  /** Corrects the design by simulations and shows the result. */
  async polish(): Promise<void> {
    await this.simulate(polishRequest);
  }

  private async simulate(requestOf: (state: DesignState, found: TilingDesign) => DesignRequest): Promise<void> {
    const shown = this.session.results.shown.get();
    if (!shown) return;
    this.clear();
    this.subject = shown;
    this.state.set({ kind: "running", progress: 0, stage: "", round: null });
    const asked = this.session.state.get();
    await this.runner.start(async (run) => {
      await this.simulatePatch(await this.simulateProfile(shown, asked, requestOf(asked, shown.found), run), run);
    });
  }

  /** Cancels running simulations and removes the results. */
  clear(): void {
    this.runner.stop();
    this.subject = null;
    this.state.set({ kind: "none" });
    this.patch.set({ kind: "none" });
  }

  /** Simulates the profile. Returns the response of the design that was simulated last. */
  private async simulateProfile(shown: TargetResponse, asked: DesignState, request: DesignRequest, run: Run<object>): Promise<TargetResponse> {
    let count = 0;
    let lastKey = "";
    const onJob = ({ progress, stage, partial }: Job) => {
      let round: PolishRound | null = null;
      if (partial && "round" in partial) {
        // Several events may report the same round.
        const key = partial.round.parameters.join();
        if (key !== lastKey) ++count;
        lastKey = key;
        round = { count, error: partial.round.target_error };
      }
      this.state.set({ kind: "running", progress, stage, round });
    };
    try {
      const answer = await run.job<DesignAnswer>("/v1/designs", request, { onJob });
      const simulated = simulatedTargets(answer, asked);
      if (!simulated || !answer.polish) {
        this.state.set({ kind: "failed", sentence: answer.message || "Nothing was simulated." });
        return shown;
      }
      const found = designOf(answer, asked);
      const polished = { ...shown, found };
      const changed = !isSameResult(polished, shown);
      this.subject = polished;
      this.state.set({ kind: "done", simulated, polish: answer.polish, seconds: answer.cost.seconds });
      if (changed) this.session.setFound(found);
      return polished;
    } catch (error) {
      if (run.isCancelled) throw error;
      this.state.set({ kind: "failed", sentence: explain(error) });
      return shown;
    }
  }

  private async simulatePatch(shown: TargetResponse, run: Run<object>): Promise<void> {
    this.patch.set({ kind: "running", progress: 0 });
    try {
      const state = this.session.state.get();
      const request = patchRequest(state, shown.found);
      const direction = patchDirection(state, shown.found);
      const onJob = ({ progress }: Job) => this.patch.set({ kind: "running", progress });
      const simulation = await run.job<Simulation>("/v1/simulations", request, { onJob });
      this.patch.set({ kind: "done", simulation, direction });
    } catch (error) {
      if (run.isCancelled) throw error;
      this.patch.set({ kind: "failed", sentence: explain(error) });
    }
  }
}

/** The simulated responses in the order of the tabs; null if a target was not simulated. */
function simulatedTargets(answer: DesignAnswer, asked: DesignState): SimulatedTarget[] | null {
  const profiles = [answer.profile, ...answer.also];
  const order = askedOrder(asked);
  const found: SimulatedTarget[] = [];
  for (let place = 0; place < profiles.length; ++place) {
    const { verified } = profiles[order.indexOf(place)];
    if (!verified) return null;
    found.push({ curve: verified, deviation: verified.relative_rms ?? null, mesh: verified.discretization_error });
  }
  return found;
}

/** Whether two responses are of the same design and the same requirements. The latter count, since a result states its deviation from the targets. */
function isSameResult(a: TargetResponse, b: TargetResponse): boolean {
  return sameRequirements(a, b) && sameTilingDesign(a.found, b.found);
}
