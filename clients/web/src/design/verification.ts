// The design shown, simulated at its native scale: its curve, and its deformed patch; and corrected by simulations, if
// the person wants it. Ends where the design changes.
import type { Curve } from "../base/curve";
import { Observable } from "../base/observable";
import { type Client, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { DesignAnswer, DesignRequest, Job, Polish, Simulation } from "../contract/types";
import { patchDirection, patchRequest, polishRequest, verificationRequest } from "./requests";
import type { DesignSession } from "./session";
import { foundOf, sameFound, sameWanted, type Shown } from "./shown";
import { type DesignState, type Found } from "./state";
import { askedOrder } from "./target_list";

export type VerificationState =
  | { kind: "none" }
  | { kind: "running"; progress: number; stage: string; round: RoundSoFar | null }
  | { kind: "failed"; sentence: string }
  | { kind: "done"; simulated: readonly SimulatedTarget[]; polish: Polish; seconds: number };

/** What the simulation says of one target. */
export interface SimulatedTarget {
  readonly curve: Curve;
  readonly deviation: number | null;
  readonly mesh: number | null;
}

/** The structure of a polish that was simulated last. */
export interface RoundSoFar {
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
  private running: AbortController | null = null;
  private subject: Shown | null = null;

  /** The simulation of the target in sight. */
  get simulated(): SimulatedTarget | null {
    const state = this.state.get();
    return state.kind === "done" ? (state.simulated[this.session.state.get().at] ?? null) : null;
  }

  constructor(
    private readonly session: DesignSession,
    private readonly client: Client,
  ) {
    session.shown.watch((shown) => {
      if (this.subject && (!shown || !sameDesign(shown, this.subject))) this.clear();
    });
  }

  async verify(): Promise<void> {
    await this.simulate(verificationRequest);
  }

  /** Corrects the design by simulations, and shows the corrected one. */
  async polish(): Promise<void> {
    await this.simulate(polishRequest);
  }

  private async simulate(requestOf: (state: DesignState, found: Found) => DesignRequest): Promise<void> {
    const shown = this.session.shown.get();
    if (!shown) return;
    this.clear();
    this.subject = shown;
    const { signal } = (this.running = new AbortController());
    this.state.set({ kind: "running", progress: 0, stage: "", round: null });
    const asked = this.session.state.get();
    const simulated = await this.simulateProfile(shown, asked, requestOf(asked, shown.found), signal);
    if (!signal.aborted) await this.simulatePatch(simulated, signal);
  }

  /** Stops what runs and forgets what was simulated. */
  clear(): void {
    this.running?.abort();
    this.running = null;
    this.subject = null;
    this.state.set({ kind: "none" });
    this.patch.set({ kind: "none" });
  }

  /** The design that was simulated in the end. */
  private async simulateProfile(shown: Shown, asked: DesignState, request: DesignRequest, signal: AbortSignal): Promise<Shown> {
    let count = 0;
    let told = "";
    const onProgress = ({ progress, stage, partial }: Job) => {
      if (signal.aborted) return;
      let round: RoundSoFar | null = null;
      if (partial && "round" in partial) {
        // The same event may come again, with another progress.
        const key = partial.round.parameters.join();
        if (key !== told) ++count;
        told = key;
        round = { count, error: partial.round.target_error };
      }
      this.state.set({ kind: "running", progress, stage, round });
    };
    try {
      const answer = await runJob<DesignAnswer>(this.client, "/v1/designs", request, { signal, onProgress });
      if (signal.aborted) return shown;
      const simulated = simulatedTargets(answer, asked);
      if (!simulated || !answer.polish) {
        this.state.set({ kind: "failed", sentence: answer.message || "Nothing was simulated." });
        return shown;
      }
      const found = foundOf(answer, asked);
      const polished = { ...shown, found };
      const changed = !sameDesign(polished, shown);
      this.subject = polished;
      this.state.set({ kind: "done", simulated, polish: answer.polish, seconds: answer.cost.seconds });
      if (changed) this.session.setFound(found);
      return polished;
    } catch (error) {
      if (!isAbort(error) && !signal.aborted) this.state.set({ kind: "failed", sentence: explain(error) });
      return shown;
    }
  }

  private async simulatePatch(shown: Shown, signal: AbortSignal): Promise<void> {
    this.patch.set({ kind: "running", progress: 0 });
    const onProgress = (job: Job) => {
      if (!signal.aborted) this.patch.set({ kind: "running", progress: job.progress });
    };
    try {
      const state = this.session.state.get();
      const request = patchRequest(state, shown.found);
      const direction = patchDirection(state, shown.found);
      const simulation = await runJob<Simulation>(this.client, "/v1/simulations", request, { signal, onProgress });
      if (!signal.aborted) this.patch.set({ kind: "done", simulation, direction });
    } catch (error) {
      if (!isAbort(error) && !signal.aborted) this.patch.set({ kind: "failed", sentence: explain(error) });
    }
  }
}

/** In the order of the tabs; null where nothing was simulated. */
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

/** Of the same targets too: how far a simulation is from it is part of what was found. */
function sameDesign(a: Shown, b: Shown): boolean {
  return sameWanted(a, b) && sameFound(a.found, b.found);
}
