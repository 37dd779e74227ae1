// The weave session: the state, the server's layout and profile, and the running computation. It does not depend on elements of the page.
import { withSwitch } from "../base/accuracy_choice";
import { LevelMeasures } from "../base/accuracy_levels";
import { EditedState } from "../base/edited_state";
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain } from "../contract/client";
import { type Activity, JobRunner, type Run } from "../contract/runner";
import type { EffectSwitch, WeaveHomogenization, WeaveLayout } from "../contract/types";
import { carriedOverrides, type LayoutResult } from "./carried";
import { nextConnection, withConnection } from "./connections";
import { type Profile, profileOf, statedError } from "./profile";
import { COARSE_DIRECTIONS, FINE_DIRECTIONS, hasStrands, homogenizationRequest, layoutRequest, previewRequest } from "./requests";
import { DEFAULT_STATE, type FreeLayout, isPeriodic, type WeaveState } from "./state";

/** Time in seconds after which a computation becomes a job with progress. */
const IMMEDIATE_SECONDS = 0.4;

/** Computing a profile in some number of directions. */
export interface ProfileWork {
  readonly directions: number;
}

export type ProfileActivity = Activity<ProfileWork>;

/** A key of all that the profile depends on, except the directions. States with the same key have the same profile. */
export function profileKey(state: WeaveState): string {
  return JSON.stringify(homogenizationRequest(state, []));
}

export class WeaveSession {
  private readonly edited = new EditedState<WeaveState>(DEFAULT_STATE);
  readonly state = this.edited.state;
  readonly steps = this.edited.steps;
  readonly laidOut = new Observable<LayoutResult | null>(null);
  /** Why the state has no layout; empty if it has one. */
  readonly fault = new Observable("");
  /** The newest profile. It is of an earlier state until the server has answered. */
  readonly profile = new Observable<Profile | null>(null);
  readonly activity: Observable<ProfileActivity>;
  /** What the last profiles took. */
  readonly measures = new LevelMeasures();

  private readonly layouts: JobRunner;
  private readonly profiles: JobRunner<ProfileWork>;
  /** Whether the last request had many directions. A newer one stops it at once. */
  private isFine = false;
  /** The layout whose connections are carried over to the next layout; null if none are. */
  private carrySource: LayoutResult | null = null;

  constructor(client: Client) {
    this.layouts = new JobRunner(client);
    this.profiles = new JobRunner(client);
    this.activity = this.profiles.activity;
  }

  /** Whether a change with intermediate states, such as a drag, has begun and not ended. */
  get isBeingChanged(): boolean {
    return this.edited.isBeingChanged;
  }

  start(state: WeaveState): void {
    this.edited.begin(state);
    this.refresh();
  }

  /** Shows an intermediate state of a change, for example of a slider. */
  preview(change: Partial<WeaveState>): void {
    this.edited.beginChange();
    this.edited.change(change);
    this.refresh();
  }

  /** Ends a change, which becomes one step of the history. */
  finish(): void {
    if (this.edited.endChange()) this.push();
  }

  /** Makes a change without intermediate states. */
  apply(change: Partial<WeaveState>): void {
    this.finish();
    this.edited.change(change);
    this.push();
  }

  /** Changes when an effect runs. */
  setEffect(effect: string, value: EffectSwitch): void {
    this.apply(effect === "out_of_plane" ? { space: value } : { accuracy: withSwitch(this.state.get().accuracy, effect, value) });
  }

  undo(): void {
    this.finish();
    this.edited.undo((state) => this.restore(state));
  }

  redo(): void {
    this.finish();
    this.edited.redo((state) => this.restore(state));
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
  }

  /** Repeats the requests that a lost connection or a fault has ended. */
  retry(): void {
    if (this.layouts.hasFailed || this.profiles.hasFailed) this.refresh();
  }

  private push(): void {
    this.edited.push();
    this.refresh();
  }

  private restore(state: WeaveState): void {
    this.carrySource = null;
    this.state.set(state);
    this.refresh();
  }

  private refresh(): void {
    this.askLayout();
    this.askProfile();
  }

  private askLayout(): void {
    const state = this.state.get();
    if (!hasStrands(state)) {
      this.layouts.stop();
      this.carrySource = null;
      this.laidOut.set(null);
      return this.fault.set("");
    }
    const request = layoutRequest(state);
    const known = this.laidOut.get();
    if (known && !this.layouts.isRunning && JSON.stringify(layoutRequest(known.state)) === JSON.stringify(request)) {
      return this.fault.set("");
    }
    this.layouts.follow(async (run) => {
      const layout = await run.post<WeaveLayout>("/v1/weave-layouts", request);
      this.fault.set("");
      if (!this.carryConnections(state, layout)) this.laidOut.set({ state, layout });
    }, (error) => {
      this.carrySource = null;
      if (!(error instanceof ConnectionLost)) this.fault.set(explain(error));
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
    this.edited.amend({ ...state, overrides });
    this.refresh();
    return true;
  }

  private askProfile(): void {
    const state = this.state.get();
    if (!isPeriodic(state) || !hasStrands(state)) {
      this.profiles.cancel();
      return this.profile.set(null);
    }
    const key = profileKey(state);
    const shown = this.profile.get();
    if (shown?.key === key && !shown.provisional && !this.profiles.isRunning) return;
    this.profiles.follow(async (run) => {
      this.isFine = false;
      if (this.profile.get()?.key !== key) this.profile.set(profileOf(await this.homogenize(previewRequest, state, COARSE_DIRECTIONS, run), key, true));
      const isSuperseded = profileKey(this.state.get()) !== key;
      if (isSuperseded || !this.profile.get()?.provisional) return;
      this.isFine = true;
      const profile = profileOf(await this.homogenize(homogenizationRequest, state, FINE_DIRECTIONS, run), key, false);
      this.measures.record("weaves", { level: state.accuracy.level, seconds: profile.seconds, error: statedError(profile) });
      this.profile.set(profile);
    }, this.profiles.tellFault, this.isFine);
  }

  private homogenize(requestOf: typeof homogenizationRequest, state: WeaveState, directions: number, run: Run<ProfileWork>): Promise<WeaveHomogenization> {
    run.tell({ directions });
    return run.job<WeaveHomogenization>("/v1/weave-homogenizations", requestOf(state, directions), {
      wait: IMMEDIATE_SECONDS,
      onJob: ({ progress }) => run.tell({ directions }, progress),
    });
  }
}
