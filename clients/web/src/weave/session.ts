// The weave session: what was decided, what the server says of it, and what is going on. Knows no element of the page.
import { History } from "../base/history";
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { WeaveHomogenization, WeaveLayout } from "../contract/types";
import { carriedOverrides, type LaidOut } from "./carried";
import { nextConnection, withConnection } from "./connections";
import { type Profile, profileOf } from "./profile";
import { COARSE_DIRECTIONS, FINE_DIRECTIONS, hasStrands, homogenizationRequest, layoutRequest } from "./requests";
import { DEFAULT_STATE, type FreeLayout, isPeriodic, type WeaveState } from "./state";

/** Seconds that an answer may take before it becomes a job whose progress is shown. */
const IMMEDIATE_SECONDS = 0.4;

export type Activity =
  | { kind: "idle" }
  | { kind: "busy"; directions: number; progress: number | null }
  | { kind: "failed"; sentence: string };

export interface Steps {
  undo: boolean;
  redo: boolean;
}

/** All that the stiffness depends on but the directions: two states with the same key have the same profile. */
export function profileKey(state: WeaveState): string {
  return JSON.stringify(homogenizationRequest(state, []));
}

export class WeaveSession {
  readonly state = new Observable<WeaveState>(DEFAULT_STATE);
  readonly laidOut = new Observable<LaidOut | null>(null);
  /** Why the state has no layout; empty where it has one. */
  readonly fault = new Observable("");
  /** The newest profile; of an earlier state until that of the state has come. */
  readonly profile = new Observable<Profile | null>(null);
  readonly activity = new Observable<Activity>({ kind: "idle" });
  readonly steps = new Observable<Steps>({ undo: false, redo: false });

  private readonly layouts = new Latest();
  private readonly profiles = new Latest();
  private history = new History<WeaveState>(DEFAULT_STATE);
  private inGesture = false;
  /** A thorough request runs: it gives way at once. */
  private thorough = false;
  private unanswered = false;
  /** Layout whose crossings' connections a new one is to take over. */
  private carryFrom: LaidOut | null = null;

  constructor(private readonly client: Client) {}

  start(state: WeaveState): void {
    this.history = new History(state);
    this.state.set(state);
    this.tellSteps();
    this.refresh();
  }

  /** A state on the way to another, as a slider gives it. */
  preview(change: Partial<WeaveState>): void {
    this.inGesture = true;
    this.state.set({ ...this.state.get(), ...change });
    this.refresh();
  }

  /** The change is done: one step to undo. */
  finish(): void {
    if (!this.inGesture) return;
    this.inGesture = false;
    this.push();
  }

  /** A change in one go. */
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

  /** Other strands of one's own; crossings that stay where they are keep their connection. */
  setLayout(layout: FreeLayout): void {
    const laidOut = this.laidOut.get();
    if (laidOut?.state.pattern === "layout" && !this.carryFrom) this.carryFrom = laidOut;
    // Crossings that were listed refer to strands by number: with other strands they are found anew.
    this.apply({ layout: { strands: layout.strands, lattice: layout.lattice }, overrides: [] });
  }

  /** A crossing goes on to its next connection. */
  cycle(index: number): void {
    const laidOut = this.laidOut.get();
    const crossing = laidOut?.layout.crossings[index];
    if (crossing) this.apply({ overrides: withConnection(this.state.get().overrides, index, nextConnection(crossing)) });
  }

  cancel(): void {
    this.profiles.cancel();
    this.activity.set({ kind: "idle" });
  }

  /** Asks again for what a lost connection or a fault left open. */
  retry(): void {
    if (this.unanswered || this.activity.get().kind === "failed") this.refresh();
  }

  private push(): void {
    this.history.push(this.state.get());
    this.tellSteps();
    this.refresh();
  }

  private restore(): void {
    this.carryFrom = null;
    this.state.set(this.history.current);
    this.tellSteps();
    this.refresh();
  }

  private tellSteps(): void {
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
      this.carryFrom = null;
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
        if (!this.carry(state, layout)) this.laidOut.set({ state, layout });
      } catch (error) {
        if (isAbort(error)) return;
        this.unanswered = true;
        this.carryFrom = null;
        if (!(error instanceof ConnectionLost)) this.fault.set(explain(error));
      }
    });
  }

  /** Gives the crossings of a layout just drawn the connections that they had; true where that changes the state. */
  private carry(asked: WeaveState, layout: WeaveLayout): boolean {
    const from = this.carryFrom;
    const state = this.state.get();
    if (!from || state.layout !== asked.layout) return false; // further strands came meanwhile: theirs is the layout to look at
    this.carryFrom = null;
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
        if (this.profile.get()?.key !== key) await this.coarse(state, key, signal);
        const superseded = signal.aborted || profileKey(this.state.get()) !== key;
        if (!superseded && this.profile.get()?.provisional) await this.fine(state, key, signal);
        if (!signal.aborted) this.unanswered = false;
        if (!signal.aborted) this.activity.set({ kind: "idle" });
      } catch (error) {
        this.fail(error);
      } finally {
        this.thorough = false;
      }
    }, this.thorough);
  }

  private async coarse(state: WeaveState, key: string, signal: AbortSignal): Promise<void> {
    this.activity.set({ kind: "busy", directions: COARSE_DIRECTIONS, progress: null });
    const answer = await this.homogenize(state, COARSE_DIRECTIONS, signal);
    if (!signal.aborted) this.profile.set(profileOf(answer, key, true));
  }

  private async fine(state: WeaveState, key: string, signal: AbortSignal): Promise<void> {
    this.thorough = true;
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
