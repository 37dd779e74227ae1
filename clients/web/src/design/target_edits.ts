// Changes of the targets of the selected region, and of the one that is selected.
import type { DesignSession } from "./session";
import { projectedTarget, type Relaxation } from "./reach";
import { type DesignState, isPolar, sameProfile, type TilingDesign } from "./state";
import { furtherTarget, MAX_NAME_LENGTH, MAX_TARGETS, targetOf, targetsOf, withTargets } from "./target_list";
import { convertedPoints, convertedStrain, type Extent, HALF_TURN, type TargetCurve, targetOnCurve } from "./targets";

/** Green strains that control points may have. */
const STRAINS: Extent = { lower: -0.2, upper: 0.3 };

export class TargetEdits {
  /** Targets of other tasks, which are restored when the user returns to the task. */
  private readonly stored = new Map<string, TargetCurve>();

  constructor(private readonly session: DesignSession) {}

  /** The allowed x of control points: half a turn, or strains in the present measure. */
  get extent(): Extent {
    const { task, measure } = this.session.state.get();
    if (isPolar(task)) return HALF_TURN;
    if (measure === "green") return STRAINS;
    return { lower: convertedStrain(STRAINS.lower, "engineering"), upper: convertedStrain(STRAINS.upper, "engineering") };
  }

  /** Selects another target. The requirements stay the same. */
  select(at: number): void {
    const { session } = this;
    session.finish();
    const state = session.state.get();
    const targets = targetsOf(state);
    if (at === state.at || at < 0 || at >= targets.length) return;
    session.edited.amend({ ...state, ...withTargets(targets, at) });
    session.results.showSelected();
  }

  /** Adds a target of the same kind as the selected one. Its curve is the response of the design. */
  async add(): Promise<void> {
    const { session } = this;
    session.finish();
    const state = session.state.get();
    const targets = targetsOf(state);
    if (targets.length >= MAX_TARGETS) return;
    const further = furtherTarget(targets, targetOf(state));
    const begun = await this.curveOf({ ...state, ...further }, state.found);
    if (session.state.get() !== state) return; // the state has changed meanwhile
    session.results.show([...session.results.all.get(), null]);
    session.apply(withTargets([...targets, { ...further, ...begun }], targets.length));
  }

  remove(at: number): void {
    const { session } = this;
    const state = session.state.get();
    const targets = targetsOf(state);
    if (targets.length === 1) return;
    session.results.dropTarget(at);
    this.forgetStored();
    session.apply(withTargets(targets.filter((_, k) => k !== at), at < state.at ? state.at - 1 : state.at));
    session.results.showSelected();
  }

  /** Renames the selected target. This starts no search. */
  rename(name: string): void {
    this.session.rename({ name: name.trim().slice(0, MAX_NAME_LENGTH) });
  }

  /** Changes the task. The target is the last one of that task, or else the response of the present design. */
  async setTask(task: DesignState["task"]): Promise<void> {
    const { session } = this;
    const state = session.state.get();
    if (task === state.task) return;
    session.finish();
    this.stored.set(keyOf(state), { points: state.points, interpolation: state.interpolation });
    const next = { ...state, task };
    const curve = this.stored.get(keyOf(next)) ?? (await this.curveOf(next, state.found));
    const now = session.state.get();
    if (now.task === state.task && now.at === state.at && now.regionAt === state.regionAt && curve) session.apply({ task, ...curve });
  }

  setMeasure(measure: DesignState["measure"]): void {
    const { task, points, strain, measure: before } = this.session.state.get();
    if (measure === before) return;
    this.session.apply(isPolar(task) ? { measure, strain: convertedStrain(strain, measure) } : { measure, points: convertedPoints(points, measure) });
  }

  /** Makes the response of the shown design the target. */
  adopt(): void {
    const shown = this.session.results.shown.get();
    const state = this.session.state.get();
    if (!shown || !sameProfile(shown, state)) return;
    const curve = targetOnCurve({ x: shown.x, y: shown.achieved }, state);
    if (curve) this.session.apply(curve);
  }

  /** Moves the target onto the response of the closest design that was found. */
  project(): void {
    const { results } = this.session;
    const shown = results.shown.get();
    if (shown && results.isCurrent) this.session.apply({ ...projectedTarget(shown), byHand: false });
  }

  /** Moves one control point, as `relaxation` has proposed. */
  relax({ index, to }: Relaxation): void {
    const { points } = this.session.state.get();
    this.session.apply({ points: points.map((point, k) => (k === index ? to : point)), byHand: false });
  }

  forgetStored(): void {
    this.stored.clear();
  }

  /** A target that follows a design's response; null if the server does not answer with its profile. */
  private async curveOf(state: DesignState, found: TilingDesign | null): Promise<TargetCurve | null> {
    return targetOnCurve(found && (await this.session.profile(found, { ...state, points: [] }, state.made)), state);
  }
}

function keyOf({ at, task, measure }: DesignState): string {
  return `${at} ${task} ${measure}`;
}
