// The design session: the state, the server's results, and the running search. It does not depend on elements of the page.
import type { Curve } from "../base/curve";
import { History } from "../base/history";
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, isAbort, Problem } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { Design, DesignAnswer, DesignCandidate, Family, Job, Model, Profile, StructureAnswer } from "../contract/types";
import { type Relaxation, projectedTarget } from "./reach";
import { MAX_REGION_NAME_LENGTH, MAX_REGIONS, regionsOf, withRegions } from "./region_list";
import type { Specification } from "./specification";
import { designRequest, type Effort, profileRequest, regionsRequest, structureRequest } from "./requests";
import { type Envelope, type CostedDesign, designOf, freshness, kindOf, sameTilingDesign, sameRequirements, type TargetResponse, designResponses, partialResponse, profileResponses,
  type Requirements, requirementsOf } from "./shown";
import { ANY, DEFAULT_STATE, type DesignState, type TilingDesign, isPolar, type ProfileKind, type Region, sameProfile, type Target } from "./state";
import { askedOrder, furtherTarget, MAX_NAME_LENGTH, MAX_TARGETS, targetOf, targetsOf, withTargets } from "./target_list";
import { convertedPoints, convertedStrain, type Extent, HALF_TURN, type TargetCurve, targetOnProfile } from "./targets";
import { firstModels, indexOfMostReliable } from "./verdict";

/** Time in seconds after which a search becomes a job with progress. */
const IMMEDIATE_SECONDS = 0.4;
/** Numbers of control points of a target that is made from a profile. */
const POINTS_OVER_STRAIN = 7;
const POINTS_OVER_DIRECTIONS = 6;

export type Activity =
  | { kind: "idle" }
  | { kind: "busy"; effort: Effort | "profile"; progress: number | null; stage: string }
  /** The user has cancelled the search. */
  | { kind: "stopped" }
  | { kind: "failed"; sentence: string };

/** The best design of each family for some requirements. */
export interface Ranking extends Requirements {
  readonly candidates: readonly DesignCandidate[];
}

/** The results of a region that is not selected. */
export interface RegionResults {
  readonly all: readonly (TargetResponse | null)[];
  readonly envelopes: readonly (Envelope | null)[];
  readonly ranking: Ranking | null;
}

export interface Steps {
  undo: boolean;
  redo: boolean;
}

type RegionsAnswer = { readonly regions: readonly Design[] } & Pick<DesignAnswer, "cost">;

/** The envelope of a design's family for each target, in the order of the tabs. */
function envelopesOf(answer: Design, asked: Region): (Envelope | null)[] {
  const order = askedOrder(asked);
  const profiles = [answer.profile, ...answer.also];
  return targetsOf(asked).map((target, place) => {
    const { x, envelope } = profiles[order.indexOf(place)];
    return envelope && { ...kindOf(target), family: answer.family, x, ...envelope };
  });
}

export class DesignSession {
  readonly state = new Observable<DesignState>(DEFAULT_STATE);
  /** The response to each target, in the order of the tabs; null if it is not known yet. */
  readonly all = new Observable<readonly (TargetResponse | null)[]>([]);
  /** The response to the selected target. */
  readonly shown = new Observable<TargetResponse | null>(null);
  /** The profile before the last change. */
  readonly previous = new Observable<(Curve & ProfileKind) | null>(null);
  readonly envelope = new Observable<Envelope | null>(null);
  /** The ranking for the present requirements. It stays while the designs of its families are shown one after another. */
  readonly ranking = new Observable<Ranking | null>(null);
  /** The results of each region in the order of the tabs, stored when another region was selected. */
  readonly regionCache = new Observable<readonly (RegionResults | null)[]>([]);
  readonly activity = new Observable<Activity>({ kind: "idle" });
  readonly steps = new Observable<Steps>({ undo: false, redo: false });
  families: readonly Family[] = [];
  models: readonly Model[] = [];

  /** Name of the editing session: on the server, a search replaces the earlier ones of the same session. */
  private readonly name = `web-${crypto.getRandomValues(new Uint32Array(3)).join("-")}`;
  private readonly requests = new Latest();
  private history = new History<DesignState>(DEFAULT_STATE);
  private inGesture = false;
  private runningEffort: Effort | "profile" | null = null;
  /** Counts the changes that make answers to earlier requests obsolete. */
  private epoch = 0;
  private unanswered = false;
  /** Targets of other tasks, which are restored when the user returns to the task. */
  private readonly storedTargets = new Map<string, TargetCurve>();
  /** The envelope of the family for each target. */
  private envelopes: readonly (Envelope | null)[] = [];

  constructor(private readonly client: Client) {}

  /** Loads families and models, and shows the state of a link or an initial one. */
  async start(linked: DesignState | null): Promise<void> {
    [this.families, this.models] = await Promise.all([
      this.client.get<{ families: Family[] }>("/v1/families").then((answer) => answer.families),
      this.client.get<{ models: Model[] }>("/v1/models").then((answer) => answer.models),
    ]);
    if (this.models.length === 0) return;
    this.begin(linked && this.isServed(linked) ? linked : await this.firstState());
  }

  /** One model for each family that has any, in the order of the families. */
  get familyModels(): readonly Model[] {
    const found = this.families.map((family) => this.models.find((model) => model.family === family.id));
    return found.filter((model): model is Model => model !== undefined);
  }

  model(family: string): Model | undefined {
    return this.models.find((model) => model.family === family);
  }

  family(id: string): Family | undefined {
    return this.families.find((family) => family.id === id);
  }

  /** The allowed x of control points: half a turn, or Green strains from -0.2 to 0.3 in the present measure. */
  get extent(): Extent {
    const { task, measure } = this.state.get();
    if (isPolar(task)) return HALF_TURN;
    const range = { lower: -0.2, upper: 0.3 };
    return measure === "green"
      ? range
      : { lower: convertedStrain(range.lower, "engineering"), upper: convertedStrain(range.upper, "engineering") };
  }

  /** Begins a change with intermediate states, such as a drag. It ends with `finish`. */
  gesture(): void {
    if (this.inGesture) return;
    this.inGesture = true;
    this.storePrevious();
  }

  /** Shows an intermediate state of a change. */
  preview(change: Partial<DesignState>): void {
    this.gesture();
    this.state.set({ ...this.state.get(), ...change });
    this.refresh("follow");
  }

  /** Ends a change, which becomes one step of the history. */
  finish(): void {
    if (!this.inGesture) return;
    this.inGesture = false;
    this.push();
    this.refresh("search");
  }

  /** Makes a change without intermediate states. */
  apply(change: Partial<DesignState>): void {
    this.finish();
    this.storePrevious();
    this.decide({ ...this.state.get(), ...change });
    this.push();
    this.refresh("search");
  }

  undo(): void {
    this.finish();
    if (this.history.undo()) this.restore();
  }

  redo(): void {
    this.finish();
    if (this.history.redo()) this.restore();
  }

  /** Cancels the running search. Its best design so far stays. */
  cancel(): void {
    this.requests.cancel();
    this.showAll(this.all.get().map((shown) => (shown?.provisional ? { ...shown, provisional: false, message: "The search was stopped: this is its best so far." } : shown)));
    this.activity.set({ kind: "stopped" });
  }

  /** Repeats a request that a lost connection, a fault or the user has ended. */
  retry(): void {
    if (this.unanswered || ["failed", "stopped"].includes(this.activity.get().kind)) this.refresh("search");
  }

  /** All targets, in the order of their tabs. */
  get targets(): readonly Target[] {
    return targetsOf(this.state.get());
  }

  /** All regions, in the order of their tabs. */
  get regions(): readonly Region[] {
    return regionsOf(this.state.get());
  }

  /** The responses of each region's design to its targets; null for a region without a design, or if it has changed since the search. */
  get regionShown(): readonly (readonly TargetResponse[] | null)[] {
    const { regionAt } = this.state.get();
    return this.regions.map((region, k) => {
      const all = k === regionAt ? this.all.get() : (this.regionCache.get()[k]?.all ?? []);
      const known = all.filter((shown): shown is TargetResponse =>
        shown !== null && !shown.provisional && sameRequirements(shown, requirementsOf(region)) && region.found !== null && sameTilingDesign(shown.found, region.found)
      );
      return known.length === region.others.length + 1 ? known : null;
    });
  }

  /** Whether the shown response belongs to the present state. */
  get isCurrent(): boolean {
    return freshness(this.shown.get(), this.state.get()) === "current";
  }

  /** Selects another target. The requirements stay the same. */
  select(at: number): void {
    this.finish();
    const state = this.state.get();
    const targets = targetsOf(state);
    if (at === state.at || at < 0 || at >= targets.length) return;
    this.state.set({ ...state, ...withTargets(targets, at) });
    this.history.amend(this.state.get());
    this.showSelected();
  }

  /** Adds a target of the same kind as the selected one. Its curve is the response of the design. */
  async add(): Promise<void> {
    this.finish();
    const state = this.state.get();
    const targets = targetsOf(state);
    if (targets.length >= MAX_TARGETS) return;
    const further = furtherTarget(targets, targetOf(state));
    const begun = await this.curveOf({ ...state, ...further }, state.found);
    if (this.state.get() !== state) return; // the state has changed meanwhile
    this.showAll([...this.all.get(), null]);
    this.apply(withTargets([...targets, { ...further, ...begun }], targets.length));
  }

  remove(at: number): void {
    const state = this.state.get();
    const targets = targetsOf(state);
    if (targets.length === 1) return;
    this.showAll(this.all.get().filter((_, k) => k !== at));
    this.envelopes = this.envelopes.filter((_, k) => k !== at);
    this.storedTargets.clear();
    this.apply(withTargets(targets.filter((_, k) => k !== at), at < state.at ? state.at - 1 : state.at));
    this.showSelected();
  }

  /** Renames the selected target. This starts no search. */
  rename(name: string): void {
    this.finish();
    this.state.set({ ...this.state.get(), name: name.trim().slice(0, MAX_NAME_LENGTH) });
    this.history.push(this.state.get());
    this.publishSteps();
  }

  /** Selects another region and shows its cached results. If there are none, a search starts. */
  selectRegion(at: number): void {
    this.finish();
    const regions = this.regions;
    if (at === this.state.get().regionAt || at < 0 || at >= regions.length) return;
    this.leaveRegion();
    this.state.set(withRegions(regions, at));
    this.history.amend(this.state.get());
    this.enterRegion();
  }

  /** Adds a region, a copy of the selected one. */
  addRegion(): void {
    this.finish();
    const { regions } = this;
    if (regions.length >= MAX_REGIONS) return;
    this.leaveRegion();
    const { regionAt } = this.state.get();
    this.regionCache.set([...regions.map((_, k) => this.regionCache.get()[k] ?? null), this.regionCache.get()[regionAt] ?? null]);
    this.state.set(withRegions([...regions, { ...regions[regionAt], region: "" }], regions.length));
    this.push();
    this.enterRegion();
  }

  removeRegion(at: number): void {
    this.finish();
    const { regions } = this;
    if (regions.length === 1) return;
    this.leaveRegion();
    const { regionAt } = this.state.get();
    this.regionCache.set(regions.map((_, k) => this.regionCache.get()[k] ?? null).filter((_, k) => k !== at));
    this.state.set(withRegions(regions.filter((_, k) => k !== at), at < regionAt ? regionAt - 1 : regionAt));
    this.push();
    this.enterRegion();
  }

  renameRegion(name: string): void {
    this.finish();
    this.state.set({ ...this.state.get(), region: name.trim().slice(0, MAX_REGION_NAME_LENGTH) });
    this.history.push(this.state.get());
    this.publishSteps();
  }

  /** Searches for the designs of all regions in one request. */
  searchRegions(): void {
    this.finish();
    const { epoch, regions } = this;
    this.requests.submit(async (signal) => {
      this.runningEffort = "search";
      this.activity.set({ kind: "busy", effort: "search", progress: null, stage: "" });
      try {
        const answer = await runJob<RegionsAnswer>(this.client, "/v1/designs", regionsRequest(regions, this.name), {
          signal,
          wait: IMMEDIATE_SECONDS,
          onProgress: ({ progress, stage }) => {
            if (!signal.aborted) this.activity.set({ kind: "busy", effort: "search", progress, stage });
          },
        });
        if (signal.aborted || epoch !== this.epoch) return;
        this.acceptRegions(answer, regions);
        this.activity.set({ kind: "idle" });
      } catch (error) {
        this.fail(error, "search", signal);
      } finally {
        this.runningEffort = null;
      }
    }, true);
  }

  /** Shows the best design of one family of the ranking. */
  lookAt(candidate: DesignCandidate): void {
    this.apply({ family: candidate.family, found: designOf(candidate, this.state.get()), byHand: false });
  }

  /** Changes the task. The target is the last one of that task, or else the response of the present design. */
  async setTask(task: DesignState["task"]): Promise<void> {
    const state = this.state.get();
    if (task === state.task) return;
    this.finish();
    this.storedTargets.set(this.targetKey(state), { points: state.points, interpolation: state.interpolation });
    const next = { ...state, task };
    const curve = this.storedTargets.get(this.targetKey(next)) ?? (await this.curveOf(next, state.found));
    const now = this.state.get();
    if (now.task === state.task && now.at === state.at && now.regionAt === state.regionAt && curve) this.apply({ task, ...curve });
  }

  setMeasure(measure: DesignState["measure"]): void {
    const { task, points, strain, measure: old } = this.state.get();
    if (measure === old) return;
    this.apply(isPolar(task) ? { measure, strain: convertedStrain(strain, measure) } : { measure, points: convertedPoints(points, measure) });
  }

  /** Sets parameters by hand; `done` ends the change. */
  setParameters(parameters: readonly number[], done: boolean): void {
    const { found } = this.state.get();
    if (found) this.preview({ found: { ...found, parameters }, byHand: true });
    if (done) this.finish();
  }

  /** Replaces the shown design, for example by one that was polished. */
  setFound(found: TilingDesign): void {
    this.preview({ found, byHand: true });
    this.finish();
  }

  /** Makes the response of the shown design the target. */
  adoptAsTarget(): void {
    const shown = this.shown.get();
    if (!shown || !sameProfile(shown, this.state.get())) return;
    const curve = targetOnProfile(shown.task, shown.x, shown.achieved, this.pointCount(shown.task), this.state.get().interpolation);
    if (curve) this.apply(curve);
  }

  /** Moves the target onto the response of the closest design that was found. */
  projectTarget(): void {
    const shown = this.shown.get();
    if (shown && this.isCurrent) this.apply({ ...projectedTarget(shown), byHand: false });
  }

  /** Moves one control point, as `relaxation` has proposed. */
  relax({ index, to }: Relaxation): void {
    const { points } = this.state.get();
    this.apply({ points: points.map((point, k) => (k === index ? to : point)), byHand: false });
  }

  /** A design's profile of some kind; null if the server does not answer with it. */
  async profile(found: TilingDesign, kind: ProfileKind & Pick<DesignState, "points">, made: Specification): Promise<Curve | null> {
    const answer = await this.requestProfile(found, kind, made);
    return answer && { x: answer.x, y: answer.y };
  }

  private async requestProfile(found: TilingDesign, kind: ProfileKind & Pick<DesignState, "points">, made: Specification): Promise<Profile | null> {
    try {
      return await this.client.post<Profile>("/v1/profiles", profileRequest(kind, found, made));
    } catch {
      return null; // the main request meets the same fault and reports it
    }
  }

  /** Cancels the search for the selected region and caches its results. */
  private leaveRegion(): void {
    ++this.epoch;
    this.requests.cancel();
    this.activity.set({ kind: "idle" });
    this.storedTargets.clear();
    const { regionAt } = this.state.get();
    const results: RegionResults = { all: this.all.get(), envelopes: this.envelopes, ranking: this.ranking.get() };
    this.regionCache.set(this.regions.map((_, k) => (k === regionAt ? results : (this.regionCache.get()[k] ?? null))));
  }

  private enterRegion(): void {
    this.showCached();
    const shown = this.shown.get();
    if (!this.isCurrent || shown?.provisional) this.refresh("search");
  }

  private showCached(): void {
    const { at, regionAt } = this.state.get();
    const known = this.regionCache.get()[regionAt];
    this.envelopes = known?.envelopes ?? [];
    this.previous.set(null);
    this.envelope.set(this.envelopes[at] ?? null);
    this.ranking.set(known?.ranking ?? null);
    this.showAll(known?.all ?? []);
  }

  private acceptRegions(answer: RegionsAnswer, asked: readonly Region[]): void {
    const { regionAt } = this.state.get();
    const found = asked.map((_, k): CostedDesign => ({ ...answer.regions[k], cost: answer.cost }));
    this.regionCache.set(asked.map((region, k) => {
      const all = designResponses(found[k], region).map((shown) => ({ ...shown, byHand: region.byHand }));
      const { ranking } = answer.regions[k];
      return { all, envelopes: envelopesOf(found[k], region), ranking: ranking.length > 1 ? { ...requirementsOf(region), candidates: ranking } : null };
    }));
    const regions = this.regions.map((region, k): Region => {
      const { family, parameters } = found[k];
      const same = region.found?.family === family && region.fixed.length === parameters.length;
      return { ...region, found: designOf(found[k], asked[k]), fixed: same ? region.fixed : parameters.map(() => false) };
    });
    this.state.set(withRegions(regions, regionAt));
    this.history.amend(this.state.get());
    this.showCached();
  }

  private decide(next: DesignState): void {
    const { at, regionAt, otherRegions } = this.state.get();
    if (otherRegions.length !== next.otherRegions.length || regionAt !== next.regionAt) {
      const isSameCount = otherRegions.length === next.otherRegions.length;
      if (isSameCount) this.leaveRegion();
      else this.regionCache.set([]);
      this.state.set(next);
      return this.showCached();
    }
    this.state.set(next);
    // Responses are stored by the index of their target, so that they are void if the number of targets has changed.
    if (this.all.get().length !== next.others.length + 1) this.showAll([]);
    else if (at !== next.at) this.showSelected();
  }

  private showAll(all: readonly (TargetResponse | null)[]): void {
    this.all.set(all);
    this.shown.set(all[this.state.get().at] ?? null);
  }

  /** Shows the results for the target that was selected. */
  private showSelected(): void {
    const { at } = this.state.get();
    this.previous.set(null);
    this.envelope.set(this.envelopes[at] ?? null);
    this.shown.set(this.all.get()[at] ?? null);
  }

  private begin(state: DesignState): void {
    this.history = new History(state);
    this.state.set(state);
    this.publishSteps();
    this.refresh("search");
    void this.showStart(state);
  }

  /** Shows the initial design while the first search runs. */
  private async showStart(state: DesignState): Promise<void> {
    if (!state.found || state.byHand) return;
    const { epoch } = this;
    try {
      const all = profileResponses(await this.profilesOf(state, state.found), state);
      if (!this.shown.get() && epoch === this.epoch) this.showAll(all.map((shown) => ({ ...shown, byHand: false, provisional: true })));
    } catch {
      // the search reports the fault
    }
  }

  private isServed(state: DesignState): boolean {
    const model = state.found && this.model(state.found.family);
    if (state.found && model?.parameters.lower.length !== state.found.parameters.length) return false;
    return state.family === ANY || this.model(state.family) !== undefined;
  }

  /**
   * The initial state without a link. The target is the profile of a design, and the search starts from another design of the same
   * family. Two families are asked for a profile, and the one with the more reliable model is chosen, so that the first verdict does not
   * say that the model is not trusted.
   */
  private async firstState(): Promise<DesignState> {
    const models = firstModels(this.familyModels);
    const at = ({ family, parameters }: Model, fraction: number): TilingDesign => ({
      family,
      parameters: parameters.lower.map((lower, k) => lower + fraction * (parameters.upper[k] - lower)),
    });
    const profiles = await Promise.all(models.map((model) => this.requestProfile(at(model, 0.7), DEFAULT_STATE, DEFAULT_STATE.made)));
    const index = indexOfMostReliable(profiles);
    const found = at(models[index], 0.3);
    return { ...DEFAULT_STATE, ...this.targetOn(profiles[index], DEFAULT_STATE), found, fixed: found.parameters.map(() => false) };
  }

  /** A target that follows a design's response; null if the server does not answer with its profile. */
  private async curveOf(state: DesignState, found: TilingDesign | null): Promise<TargetCurve | null> {
    return this.targetOn(found && (await this.profile(found, { ...state, points: [] }, state.made)), state);
  }

  private targetOn(curve: Curve | null, { task, interpolation }: DesignState): TargetCurve | null {
    return curve && targetOnProfile(task, curve.x, curve.y, this.pointCount(task), interpolation);
  }

  private pointCount(task: DesignState["task"]): number {
    return isPolar(task) ? POINTS_OVER_DIRECTIONS : POINTS_OVER_STRAIN;
  }

  private targetKey(state: DesignState): string {
    return `${state.at} ${state.task} ${state.measure}`;
  }

  private storePrevious(): void {
    const shown = this.shown.get();
    this.previous.set(shown && { ...kindOf(shown), x: shown.x, y: shown.achieved });
  }

  private push(): void {
    ++this.epoch;
    this.history.push(this.state.get());
    this.publishSteps();
  }

  private restore(): void {
    ++this.epoch;
    this.storePrevious();
    this.decide(this.history.current);
    this.publishSteps();
    this.refresh("search");
  }

  private publishSteps(): void {
    this.steps.set({ undo: this.history.canUndo, redo: this.history.canRedo });
  }

  private refresh(effort: Effort): void {
    const state = this.state.get();
    if (state.points.length === 0) return;
    const { epoch } = this;
    const byHand = state.byHand && state.found !== null;
    // A thorough search is aborted at once, so that it does not delay a pointer. Quick requests may end first.
    const urgent = this.runningEffort === "search" || effort === "search";
    this.requests.submit(async (signal) => {
      this.runningEffort = byHand ? "profile" : effort;
      try {
        await (byHand ? this.showByHand(state, epoch, signal) : this.search(state, effort, epoch, signal));
        this.unanswered = false;
        if (!signal.aborted) this.activity.set({ kind: "idle" });
      } catch (error) {
        this.fail(error, effort, signal);
      } finally {
        this.runningEffort = null;
      }
    }, urgent);
  }

  private async search(state: DesignState, effort: Effort, epoch: number, signal: AbortSignal): Promise<void> {
    this.activity.set({ kind: "busy", effort, progress: null, stage: "" });
    const request = designRequest(state, effort, this.name);
    const answer = effort === "follow"
      ? await this.client.post<DesignAnswer>("/v1/designs", request, { signal })
      : await runJob<DesignAnswer>(this.client, "/v1/designs", request, {
        signal,
        wait: IMMEDIATE_SECONDS,
        onProgress: (job) => this.showProgress(job, state, signal),
      });
    if (!signal.aborted && epoch === this.epoch) this.accept(answer, state);
  }

  private async showByHand(state: DesignState, epoch: number, signal: AbortSignal): Promise<void> {
    const found = state.found as TilingDesign;
    this.activity.set({ kind: "busy", effort: "profile", progress: null, stage: "" });
    const [profiles, structure] = await Promise.all([this.profilesOf(state, found, signal), this.structureOf(found, state.made, signal)]);
    if (signal.aborted || epoch !== this.epoch) return;
    const ranking = this.ranking.get();
    if (ranking && !sameRequirements(ranking, requirementsOf(state))) this.ranking.set(null);
    this.showAll(profileResponses(profiles, state, structure));
  }

  /** The measures of a structure; null if the parameters give no valid structure. */
  private async structureOf(found: TilingDesign, made: Specification, signal: AbortSignal): Promise<StructureAnswer | null> {
    try {
      return await this.client.post<StructureAnswer>("/v1/structures", structureRequest(found, made), { signal });
    } catch (error) {
      if (error instanceof Problem) return null;
      throw error;
    }
  }

  /** The profiles of a design for all targets, in the order of the tabs. */
  private profilesOf(state: DesignState, found: TilingDesign, signal?: AbortSignal): Promise<Profile[]> {
    return Promise.all(targetsOf(state).map((target) => this.client.post<Profile>("/v1/profiles", profileRequest(target, found, state.made), { signal })));
  }

  private showProgress(job: Job, state: DesignState, signal: AbortSignal): void {
    if (signal.aborted) return;
    this.activity.set({ kind: "busy", effort: "search", progress: job.progress, stage: job.stage });
    const { partial } = job;
    if (!partial || !("achieved" in partial)) return;
    const shown = partialResponse(partial, state);
    this.setDesign(shown.found);
    const previous = this.all.get();
    this.showAll(targetsOf(state).map((_, place) => (place === state.at ? shown : (previous[place] ?? null))));
  }

  /** Makes a design the one of the sliders, from which the next search starts. */
  private setDesign(found: TilingDesign): void {
    const state = this.state.get();
    const isSameSize = state.found?.family === found.family && state.fixed.length === found.parameters.length;
    this.state.set({ ...state, found, fixed: isSameSize ? state.fixed : found.parameters.map(() => false) });
    if (!this.inGesture) this.history.amend(this.state.get());
  }

  private accept(answer: DesignAnswer, asked: DesignState): void {
    this.setDesign(designOf(answer, asked));
    this.rank(answer, asked);
    const targets = targetsOf(asked);
    const order = askedOrder(asked);
    const profiles = [answer.profile, ...answer.also];
    this.envelopes = envelopesOf(answer, asked).map((envelope, place) => envelope ?? this.envelopes[place] ?? null);
    const { at } = this.state.get();
    this.envelope.set(this.envelopes[at] ?? null);
    const previous = this.previous.get();
    const inSight = profiles[order.indexOf(at)];
    if (inSight && (!previous || !sameProfile(previous, targets[at]))) this.previous.set({ ...kindOf(targets[at]), x: inSight.x, y: inSight.initial });
    this.showAll(designResponses(answer, asked));
  }

  private rank({ ranking }: DesignAnswer, asked: DesignState): void {
    const previous = this.ranking.get();
    if (ranking.length > 1) this.ranking.set({ ...requirementsOf(asked), candidates: ranking });
    else if (previous && !sameRequirements(previous, requirementsOf(asked))) this.ranking.set(null);
  }

  private fail(error: unknown, effort: Effort, signal: AbortSignal): void {
    if (signal.aborted || isAbort(error)) return;
    if (error instanceof Problem && error.code === "design.superseded") {
      // Only one search of this session runs at a time, so that no newer one replaced it. An aborted one has reached the server late.
      this.refresh(effort);
      return;
    }
    this.unanswered = true;
    this.activity.set(error instanceof ConnectionLost ? { kind: "idle" } : { kind: "failed", sentence: explain(error) });
  }
}
