// The design shown, simulated at its native scale: its curve, and its deformed patch. Ends where the design changes.
import type { Curve } from "../base/curve";
import { Observable } from "../base/observable";
import { type Client, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { DesignAnswer, Job, Simulation } from "../contract/types";
import { patchRequest, verificationRequest } from "./requests";
import type { DesignSession } from "./session";
import type { Shown } from "./shown";
import { isPolar, sameProfile } from "./state";

export type VerificationState =
  | { kind: "none" }
  | { kind: "running"; progress: number; stage: string }
  | { kind: "failed"; sentence: string }
  | { kind: "done"; curve: Curve; deviation: number | null; seconds: number };

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

  constructor(
    private readonly session: DesignSession,
    private readonly client: Client,
  ) {
    session.shown.watch((shown) => {
      if (this.subject && (!shown || !sameDesign(shown, this.subject))) this.clear();
    });
  }

  async verify(): Promise<void> {
    const shown = this.session.shown.get();
    if (!shown) return;
    this.clear();
    this.subject = shown;
    const { signal } = (this.running = new AbortController());
    this.state.set({ kind: "running", progress: 0, stage: "" });
    await this.simulateProfile(shown, signal);
    if (!signal.aborted) await this.simulatePatch(shown, signal);
  }

  /** Stops what runs and forgets what was simulated. */
  clear(): void {
    this.running?.abort();
    this.running = null;
    this.subject = null;
    this.state.set({ kind: "none" });
    this.patch.set({ kind: "none" });
  }

  private async simulateProfile(shown: Shown, signal: AbortSignal): Promise<void> {
    const onProgress = (job: Job) => {
      if (!signal.aborted) this.state.set({ kind: "running", progress: job.progress, stage: job.stage });
    };
    try {
      const request = verificationRequest(this.session.state.get(), shown.found);
      const answer = await runJob<DesignAnswer>(this.client, "/v1/designs", request, { signal, onProgress });
      const { verified } = answer.profile;
      if (signal.aborted) return;
      if (!verified) this.state.set({ kind: "failed", sentence: answer.message || "Nothing was simulated." });
      else this.state.set({ kind: "done", curve: verified, deviation: verified.relative_rms ?? null, seconds: answer.cost.seconds });
    } catch (error) {
      if (!isAbort(error) && !signal.aborted) this.state.set({ kind: "failed", sentence: explain(error) });
    }
  }

  private async simulatePatch(shown: Shown, signal: AbortSignal): Promise<void> {
    this.patch.set({ kind: "running", progress: 0 });
    const onProgress = (job: Job) => {
      if (!signal.aborted) this.patch.set({ kind: "running", progress: job.progress });
    };
    try {
      const request = patchRequest(this.session.state.get(), shown.found);
      const direction = isPolar(shown.task) ? 0 : shown.direction;
      const simulation = await runJob<Simulation>(this.client, "/v1/simulations", request, { signal, onProgress });
      if (!signal.aborted) this.patch.set({ kind: "done", simulation, direction });
    } catch (error) {
      if (!isAbort(error) && !signal.aborted) this.patch.set({ kind: "failed", sentence: explain(error) });
    }
  }
}

function sameDesign(a: Shown, b: Shown): boolean {
  return sameProfile(a, b) && a.found.family === b.found.family && a.found.parameters.join() === b.found.parameters.join();
}
