// The weave session: the state, the server's layout and profile, and the running computation. It does not depend on elements of the page.
import { History } from "../base/history";
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { WeaveHomogenization, WeaveLayout } from "../contract/types";
import { carriedOverrides, type LayoutResult } from "./carried";
import { nextConnection, withConnection } from "./connections";
import { type Profile, profileOf } from "./profile";
import { COARSE_DIRECTIONS, FINE_DIRECTIONS, hasStrands, homogenizationRequest, layoutRequest } from "./requests";
import { DEFAULT_STATE, type FreeLayout, isPeriodic, type WeaveState } from "./state";

/** Time in seconds after which a computation becomes a job with progress. */
const IMMEDIATE_SECONDS = 0.4;

export type Activity =
  | { kind: "idle" }
  | { kind: "busy"; directions: number; progress: number | null }
  | { kind: "failed"; sentence: string };

export interface Steps {
  undo: boolean;
  redo: boolean;
}

/** A key of all that the profile depends on, except the directions. States with the same key have the same profile. */
export function profileKey(state: WeaveState): string {
  return JSON.stringify(homogenizationRequest(state, []));
}

export class WeaveSession {
  readonly state = new Observable<WeaveState>(DEFAULT_STATE);
  readonly laidOut = new Observable<LayoutResult | null>(null);
  /** Why the state has no layout; empty if it has one. */
  readonly fault = new Observable("");
  /** The newest profile. It is of an earlier state until the server has answered. */
  readonly profile = new Observable<Profile | null>(null);
  readonly activity = new Observable<Activity>({ kind: "idle" });
  readonly steps = new Observable<Steps>({ undo: false, redo: false });

  private readonly layouts = new Latest();
  private readonly profiles = new Latest();
  private history = new History<WeaveState>(DEFAULT_STATE);
  private inGesture = false;
  /** Whether a request with many directions is running. A newer request aborts it at once. */
  private isFineRunning = false;
  private unanswered = false;
  /** The layout whose connections are carried over to the next layout; null if none are. */
  private carrySource: LayoutResult | null = null;

  constructor(private readonly client: Client) {}

  start(state: WeaveState): void {
    this.history = new History(state);
    this.state.set(state);
    this.publishSteps();
    this.refresh();
  }

  /** Shows an intermediate state of a change, for example of a slider. */
  preview(change: Partial<WeaveState>): void {
    this.inGesture = true;
    this.state.set({ ...this.state.get(), ...change });
    this.refresh();
  }

  /** Ends a change, which becomes one step of the history. */
  finish(): void {
    if (!this.inGesture) return;
    this.inGesture = false;
    this.push();
  }

  /** Makes a change without intermediate states. */
  apply(change: Partial<WeaveState>): void {
    this.finish();
    this.state.set({ ...this.state.get(), ...change });
    this.push();
  }

  undo(): void {
    this.finish();
    if (this.history.undo()) this.restore();
  }

  redo(): void {
    this.finish();
    if (this.history.redo()) this.restore();
  }

  /** Replaces the user-drawn strands. Crossings that stay in place keep their connection. */
  setLayout(layout: FreeLayout): void {
    const laidOut = this.laidOut.get();
    if (laidOut?.state.pattern === "layout" && !this.carrySource) this.carrySource = laidOut;
    // A list of crossings refers to strands by index, so that it is dropped: the server finds the crossings again.
    this.apply({ layout: { strands: layout.strands, lattice: layout.lattice }, overrides: [] });
  }

  /** Changes a crossing to its next connection. */
  cycle(index: number): void {
    const laidOut = this.laidOut.get();
    const crossing = laidOut?.layout.crossings[index];
    if (crossing) this.apply({ overrides: withConnection(this.state.get().overrides, index, nextConnection(crossing)) });
  }

  cancel(): void {
    this.profiles.cancel();
    this.activity.set({ kind: "idle" });
  }

  /** Repeats the requests that a lost connection or a fault has ended. */
  retry(): void {
    if (this.unanswered || this.activity.get().kind === "failed") this.refresh();
  }

  private push(): void {
    this.history.push(this.state.get());
    this.publishSteps();
    this.refresh();
  }

  private restore(): void {
    this.carrySource = null;
    this.state.set(this.history.current);
    this.publishSteps();
    this.refresh();
  }

  private publishSteps(): void {
    this.steps.set({ undo: this.history.canUndo, redo: this.history.canRedo });
  }

  private refresh(): void {
    this.askLayout();
    this.askProfile();
  }

  private askLayout(): void {
    const state = this.state.get();
    if (!hasStrands(state)) {
      this.layouts.cancel();
      this.carrySource = null;
      this.laidOut.set(null);
      return this.fault.set("");
    }
    const request = layoutRequest(state);
    const known = this.laidOut.get();
    if (known && !this.layouts.busy && JSON.stringify(layoutRequest(known.state)) === JSON.stringify(request)) {
      return this.fault.set("");
    }
    this.layouts.submit(async (signal) => {
      try {
        const layout = await this.client.post<WeaveLayout>("/v1/weave-layouts", request, { signal });
        if (signal.aborted) return;
        this.fault.set("");
        if (!this.carryConnections(state, layout)) this.laidOut.set({ state, layout });
      } catch (error) {
        if (isAbort(error)) return;
        this.unanswered = true;
        this.carrySource = null;
        if (!(error instanceof ConnectionLost)) this.fault.set(explain(error));
      }
    });
  }

  /** Carries connections over to the crossings of a new layout. Returns true if this has changed the state. */
  private carryConnections(asked: WeaveState, layout: WeaveLayout): boolean {
    const from = this.carrySource;
    const state = this.state.get();
    if (!from || state.layout !== asked.layout) return false; // the strands have changed meanwhile: the next layout is used
    this.carrySource = null;
    if (state.overrides.length > 0) return false;
    const overrides = carriedOverrides(from, { state: asked, layout });
    if (overrides.length === 0) return false;
    this.state.set({ ...state, overrides });
    if (!this.inGesture) this.history.amend(this.state.get());
    this.refresh();
    return true;
  }

  private askProfile(): void {
    const state = this.state.get();
    if (!isPeriodic(state) || !hasStrands(state)) {
      this.profiles.cancel();
      this.profile.set(null);
      return this.activity.set({ kind: "idle" });
    }
    const key = profileKey(state);
    const shown = this.profile.get();
    if (shown?.key === key && !shown.provisional && !this.profiles.busy) return;
    this.profiles.submit(async (signal) => {
      try {
        if (this.profile.get()?.key !== key) await this.requestCoarse(state, key, signal);
        const superseded = signal.aborted || profileKey(this.state.get()) !== key;
        if (!superseded && this.profile.get()?.provisional) await this.requestFine(state, key, signal);
        if (!signal.aborted) this.unanswered = false;
        if (!signal.aborted) this.activity.set({ kind: "idle" });
      } catch (error) {
        this.fail(error);
      } finally {
        this.isFineRunning = false;
      }
    }, this.isFineRunning);
  }

  private async requestCoarse(state: WeaveState, key: string, signal: AbortSignal): Promise<void> {
    this.activity.set({ kind: "busy", directions: COARSE_DIRECTIONS, progress: null });
    const answer = await this.homogenize(state, COARSE_DIRECTIONS, signal);
    if (!signal.aborted) this.profile.set(profileOf(answer, key, true));
  }

  private async requestFine(state: WeaveState, key: string, signal: AbortSignal): Promise<void> {
    this.isFineRunning = true;
    this.activity.set({ kind: "busy", directions: FINE_DIRECTIONS, progress: null });
    const answer = await this.homogenize(state, FINE_DIRECTIONS, signal);
    if (!signal.aborted) this.profile.set(profileOf(answer, key, false));
  }

  private homogenize(state: WeaveState, directions: number, signal: AbortSignal): Promise<WeaveHomogenization> {
    return runJob<WeaveHomogenization>(this.client, "/v1/weave-homogenizations", homogenizationRequest(state, directions), {
      signal,
      wait: IMMEDIATE_SECONDS,
      onProgress: (job) => {
        if (!signal.aborted) this.activity.set({ kind: "busy", directions, progress: job.progress });
      },
    });
  }

  private fail(error: unknown): void {
    if (isAbort(error)) return;
    this.unanswered = true;
    this.activity.set(error instanceof ConnectionLost ? { kind: "idle" } : { kind: "failed", sentence: explain(error) });
  }
}
