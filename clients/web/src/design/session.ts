// The design session: what was decided, what the server found, and what is going on. Knows no element of the page.
import type { Curve } from "../base/curve";
import { History } from "../base/history";
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, isAbort, Problem } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { Design, DesignAnswer, DesignCandidate, Family, Job, Model, Profile, StructureAnswer } from "../contract/types";
import { type Relaxation, snappedTarget } from "./reach";
import { MOST_REGION_NAME, MOST_REGIONS, regionsOf, withRegions } from "./region_list";
import { type Made } from "./made";
import { designRequest, type Effort, profileRequest, regionsRequest, structureRequest } from "./requests";
import { type Envelope, type FoundDesign, foundOf, freshness, kindOf, sameFound, sameWanted, type Shown, shownDesigns, shownPartial, shownProfiles, type Wanted, wantedOf } from "./shown";
import { ANY, DEFAULT_STATE, type DesignState, type Found, isPolar, type ProfileKind, type Region, sameProfile, type Target } from "./state";
import { askedOrder, furtherTarget, MOST_NAME, MOST_TARGETS, targetOf, targetsOf, withTargets } from "./target_list";
import { convertedPoints, convertedStrain, type Extent, HALF_TURN, type TargetCurve, targetOnProfile } from "./targets";
import { firstModels, surestOf } from "./verdict";

/** Seconds that a search may take before it becomes a job whose progress is shown. */
const IMMEDIATE_SECONDS = 0.4;
const POINTS_OVER_STRAIN = 7;
const POINTS_OVER_DIRECTIONS = 6;

export type Activity =
  | { kind: "idle" }
  | { kind: "busy"; effort: Effort | "profile"; progress: number | null; stage: string }
  /** The person stopped it. */
  | { kind: "stopped" }
  | { kind: "failed"; sentence: string };

/** The best design of each family, for what was wanted. */
export interface Ranking extends Wanted {
  readonly candidates: readonly DesignCandidate[];
}

/** What is known of a region that is not in sight. */
export interface RegionResults {
  readonly all: readonly (Shown | null)[];
  readonly envelopes: readonly (Envelope | null)[];
  readonly ranking: Ranking | null;
}

export interface Steps {
  undo: boolean;
  redo: boolean;
}

type RegionsAnswer = { readonly regions: readonly Design[] } & Pick<DesignAnswer, "cost">;

/** What the family of a design reaches of each target, in the order of the tabs. */
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
  /** What the design does about each target, in the order of the tabs; null where nobody knows yet. */
  readonly all = new Observable<readonly (Shown | null)[]>([]);
  /** About the target in sight. */
  readonly shown = new Observable<Shown | null>(null);
  /** The profile before the last change began. */
  readonly before = new Observable<(Curve & ProfileKind) | null>(null);
  readonly envelope = new Observable<Envelope | null>(null);
  /** Stays while one of its families is looked at, until there is another target. */
  readonly ranking = new Observable<Ranking | null>(null);
  /** Of each region in the order of the tabs, as it was when it went out of sight. */
  readonly kept = new Observable<readonly (RegionResults | null)[]>([]);
  readonly activity = new Observable<Activity>({ kind: "idle" });
  readonly steps = new Observable<Steps>({ undo: false, redo: false });
  families: readonly Family[] = [];
  models: readonly Model[] = [];

  /** Searches of one name replace each other on the server. */
  private readonly name = `web-${crypto.getRandomValues(new Uint32Array(3)).join("-")}`;
  private readonly requests = new Latest();
  private history = new History<DesignState>(DEFAULT_STATE);
  private inGesture = false;
  private runningEffort: Effort | "profile" | null = null;
  /** Counts the decisions after which an older answer no longer belongs to the state. */
  private epoch = 0;
  private unanswered = false;
  /** Curves of the tasks that were left, for the way back. */
  private readonly left = new Map<string, TargetCurve>();
  /** What the family reaches of each target. */
  private envelopes: readonly (Envelope | null)[] = [];

  constructor(private readonly client: Client) {}

  /** Loads families and models, and shows `linked` or a first target. */
  async start(linked: DesignState | null): Promise<void> {
    [this.families, this.models] = await Promise.all([
      this.client.get<{ families: Family[] }>("/v1/families").then((answer) => answer.families),
      this.client.get<{ models: Model[] }>("/v1/models").then((answer) => answer.models),
    ]);
    if (this.models.length === 0) return;
    this.begin(linked && this.isServed(linked) ? linked : await this.firstState());
  }

  /** The models, one for each family that has any, in the order of the families. */
  get modelled(): readonly Model[] {
    const found = this.families.map((family) => this.models.find((model) => model.family === family.id));
    return found.filter((model): model is Model => model !== undefined);
  }

  model(family: string): Model | undefined {
    return this.models.find((model) => model.family === family);
  }

  family(id: string): Family | undefined {
    return this.families.find((family) => family.id === id);
  }

  /** Where control points may lie. Over strain: within half of what the models have seen, at least -0.2 to 0.3. */
  get extent(): Extent {
    const { task, measure } = this.state.get();
    if (isPolar(task)) return HALF_TURN;
    const range = { lower: -0.2, upper: 0.3 };
    return measure === "green"
      ? range
      : { lower: convertedStrain(range.lower, "engineering"), upper: convertedStrain(range.upper, "engineering") };
  }

  /** A change begins that may go through many states until `finish`. */
  gesture(): void {
    if (this.inGesture) return;
    this.inGesture = true;
    this.keepBefore();
  }

  /** A state on the way. */
  preview(change: Partial<DesignState>): void {
    this.gesture();
    this.state.set({ ...this.state.get(), ...change });
    this.refresh("follow");
  }

  /** The change is done: one step to undo. */
  finish(): void {
    if (!this.inGesture) return;
    this.inGesture = false;
    this.push();
    this.refresh("search");
  }

  /** A change in one go. */
  apply(change: Partial<DesignState>): void {
    this.finish();
    this.keepBefore();
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

  /** Stops what runs; the best so far stays. */
  cancel(): void {
    this.requests.cancel();
    this.showAll(this.all.get().map((shown) => (shown?.provisional ? { ...shown, provisional: false, message: "The search was stopped: this is its best so far." } : shown)));
    this.activity.set({ kind: "stopped" });
  }

  /** Asks again for what a lost connection, a fault or the person left open. */
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

  /** What the designs of the regions do about their targets; of one that has changed since, or that nobody has looked for, null. */
  get regionShown(): readonly (readonly Shown[] | null)[] {
    const { regionAt } = this.state.get();
    return this.regions.map((region, k) => {
      const all = k === regionAt ? this.all.get() : (this.kept.get()[k]?.all ?? []);
      const known = all.filter((shown): shown is Shown => shown !== null && !shown.provisional && sameWanted(shown, wantedOf(region)) && region.found !== null && sameFound(shown.found, region.found));
      return known.length === region.others.length + 1 ? known : null;
    });
  }

  /** Whether what is shown belongs to what was decided. */
  get isCurrent(): boolean {
    return freshness(this.shown.get(), this.state.get()) === "current";
  }

  /** Another target comes into sight; what is wanted stays. */
  select(at: number): void {
    this.finish();
    const state = this.state.get();
    const targets = targetsOf(state);
    if (at === state.at || at < 0 || at >= targets.length) return;
    this.state.set({ ...state, ...withTargets(targets, at) });
    this.history.amend(this.state.get());
    this.lookAtSelected();
  }

  /** A further target of the same kind as the one in sight, which begins with what the design does there. */
  async add(): Promise<void> {
    this.finish();
    const state = this.state.get();
    const targets = targetsOf(state);
    if (targets.length >= MOST_TARGETS) return;
    const further = furtherTarget(targets, targetOf(state));
    const begun = await this.curveOf({ ...state, ...further }, state.found);
    if (this.state.get() !== state) return; // something else was decided meanwhile
    this.showAll([...this.all.get(), null]);
    this.apply(withTargets([...targets, { ...further, ...begun }], targets.length));
  }

  remove(at: number): void {
    const state = this.state.get();
    const targets = targetsOf(state);
    if (targets.length === 1) return;
    this.showAll(this.all.get().filter((_, k) => k !== at));
    this.envelopes = this.envelopes.filter((_, k) => k !== at);
    this.left.clear();
    this.apply(withTargets(targets.filter((_, k) => k !== at), at < state.at ? state.at - 1 : state.at));
    this.lookAtSelected();
  }

  /** A name says nothing of what is wanted: nothing is searched for. */
  rename(name: string): void {
    this.finish();
    this.state.set({ ...this.state.get(), name: name.trim().slice(0, MOST_NAME) });
    this.history.push(this.state.get());
    this.tellSteps();
  }

  /** Another region comes into sight, with what is known of it; what nobody knows yet is searched for. */
  selectRegion(at: number): void {
    this.finish();
    const regions = this.regions;
    if (at === this.state.get().regionAt || at < 0 || at >= regions.length) return;
    this.leaveRegion();
    this.state.set(withRegions(regions, at));
    this.history.amend(this.state.get());
    this.enterRegion();
  }

  /** A further region, which begins as a copy of the one in sight. */
  addRegion(): void {
    this.finish();
    const { regions } = this;
    if (regions.length >= MOST_REGIONS) return;
    this.leaveRegion();
    const { regionAt } = this.state.get();
    this.kept.set([...regions.map((_, k) => this.kept.get()[k] ?? null), this.kept.get()[regionAt] ?? null]);
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
    this.kept.set(regions.map((_, k) => this.kept.get()[k] ?? null).filter((_, k) => k !== at));
    this.state.set(withRegions(regions.filter((_, k) => k !== at), at < regionAt ? regionAt - 1 : regionAt));
    this.push();
    this.enterRegion();
  }

  renameRegion(name: string): void {
    this.finish();
    this.state.set({ ...this.state.get(), region: name.trim().slice(0, MOST_REGION_NAME) });
    this.history.push(this.state.get());
    this.tellSteps();
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

  /** Looks at the best design of one family of the ranking. */
  lookAt(candidate: DesignCandidate): void {
    this.apply({ family: candidate.family, found: foundOf(candidate, this.state.get()), byHand: false });
  }

  /** Another task; its target is the one it had, or what the design at hand does there. */
  async setTask(task: DesignState["task"]): Promise<void> {
    const state = this.state.get();
    if (task === state.task) return;
    this.finish();
    this.left.set(this.targetKey(state), { points: state.points, interpolation: state.interpolation });
    const next = { ...state, task };
    const curve = this.left.get(this.targetKey(next)) ?? (await this.curveOf(next, state.found));
    const now = this.state.get();
    if (now.task === state.task && now.at === state.at && now.regionAt === state.regionAt && curve) this.apply({ task, ...curve });
  }

  setMeasure(measure: DesignState["measure"]): void {
    const { task, points, strain, measure: old } = this.state.get();
    if (measure === old) return;
    this.apply(isPolar(task) ? { measure, strain: convertedStrain(strain, measure) } : { measure, points: convertedPoints(points, measure) });
  }

  /** Parameters by hand; `done` ends the gesture. */
  setParameters(parameters: readonly number[], done: boolean): void {
    const { found } = this.state.get();
    if (found) this.preview({ found: { ...found, parameters }, byHand: true });
    if (done) this.finish();
  }

  /** A design that was corrected elsewhere takes the place of the one shown. */
  setFound(found: Found): void {
    this.preview({ found, byHand: true });
    this.finish();
  }

  /** What the design shown does becomes the target. */
  adoptAsTarget(): void {
    const shown = this.shown.get();
    if (!shown || !sameProfile(shown, this.state.get())) return;
    const curve = targetOnProfile(shown.task, shown.x, shown.achieved, this.pointCount(shown.task), this.state.get().interpolation);
    if (curve) this.apply(curve);
  }

  /** The target moves onto the response of the closest design that was found. */
  snapTarget(): void {
    const shown = this.shown.get();
    if (shown && this.isCurrent) this.apply({ ...snappedTarget(shown), byHand: false });
  }

  /** One control point gives way. */
  relax({ index, to }: Relaxation): void {
    const { points } = this.state.get();
    this.apply({ points: points.map((point, k) => (k === index ? to : point)), byHand: false });
  }

  /** The profile of any design, of some kind. Null where it cannot be had. */
  async profile(found: Found, kind: ProfileKind & Pick<DesignState, "points">, made: Made): Promise<Curve | null> {
    const answer = await this.answeredProfile(found, kind, made);
    return answer && { x: answer.x, y: answer.y };
  }

  private async answeredProfile(found: Found, kind: ProfileKind & Pick<DesignState, "points">, made: Made): Promise<Profile | null> {
    try {
      return await this.client.post<Profile>("/v1/profiles", profileRequest(kind, found, made));
    } catch {
      return null; // the main request meets the same fault and tells of it
    }
  }

  /** Stops what is searched for the region in sight and keeps what is known of it. */
  private leaveRegion(): void {
    ++this.epoch;
    this.requests.cancel();
    this.activity.set({ kind: "idle" });
    this.left.clear();
    const { regionAt } = this.state.get();
    const results: RegionResults = { all: this.all.get(), envelopes: this.envelopes, ranking: this.ranking.get() };
    this.kept.set(this.regions.map((_, k) => (k === regionAt ? results : (this.kept.get()[k] ?? null))));
  }

  private enterRegion(): void {
    this.showKept();
    const shown = this.shown.get();
    if (!this.isCurrent || shown?.provisional) this.refresh("search");
  }

  private showKept(): void {
    const { at, regionAt } = this.state.get();
    const known = this.kept.get()[regionAt];
    this.envelopes = known?.envelopes ?? [];
    this.before.set(null);
    this.envelope.set(this.envelopes[at] ?? null);
    this.ranking.set(known?.ranking ?? null);
    this.showAll(known?.all ?? []);
  }

  private acceptRegions(answer: RegionsAnswer, asked: readonly Region[]): void {
    const { regionAt } = this.state.get();
    const found = asked.map((_, k): FoundDesign => ({ ...answer.regions[k], cost: answer.cost }));
    this.kept.set(asked.map((region, k) => {
      const all = shownDesigns(found[k], region).map((shown) => ({ ...shown, byHand: region.byHand }));
      const { ranking } = answer.regions[k];
      return { all, envelopes: envelopesOf(found[k], region), ranking: ranking.length > 1 ? { ...wantedOf(region), candidates: ranking } : null };
    }));
    const regions = this.regions.map((region, k): Region => {
      const { family, parameters } = found[k];
      const same = region.found?.family === family && region.fixed.length === parameters.length;
      return { ...region, found: foundOf(found[k], asked[k]), fixed: same ? region.fixed : parameters.map(() => false) };
    });
    this.state.set(withRegions(regions, regionAt));
    this.history.amend(this.state.get());
    this.showKept();
  }

  private decide(next: DesignState): void {
    const { at, regionAt, otherRegions } = this.state.get();
    if (otherRegions.length !== next.otherRegions.length || regionAt !== next.regionAt) {
      const kept = otherRegions.length === next.otherRegions.length;
      if (kept) this.leaveRegion();
      else this.kept.set([]);
      this.state.set(next);
      return this.showKept();
    }
    this.state.set(next);
    // With more or fewer targets what was found is of none of their places.
    if (this.all.get().length !== next.others.length + 1) this.showAll([]);
    else if (at !== next.at) this.lookAtSelected();
  }

  private showAll(all: readonly (Shown | null)[]): void {
    this.all.set(all);
    this.shown.set(all[this.state.get().at] ?? null);
  }

  /** What is known of the target that has come into sight. */
  private lookAtSelected(): void {
    const { at } = this.state.get();
    this.before.set(null);
    this.envelope.set(this.envelopes[at] ?? null);
    this.shown.set(this.all.get()[at] ?? null);
  }

  private begin(state: DesignState): void {
    this.history = new History(state);
    this.state.set(state);
    this.tellSteps();
    this.refresh("search");
    void this.showStart(state);
  }

  /** The design that the first search starts from, while that runs. */
  private async showStart(state: DesignState): Promise<void> {
    if (!state.found || state.byHand) return;
    const { epoch } = this;
    try {
      const all = shownProfiles(await this.profilesOf(state, state.found), state);
      if (!this.shown.get() && epoch === this.epoch) this.showAll(all.map((shown) => ({ ...shown, byHand: false, provisional: true })));
    } catch {
      // the search tells what is wrong
    }
  }

  private isServed(state: DesignState): boolean {
    const model = state.found && this.model(state.found.family);
    if (state.found && model?.parameters.lower.length !== state.found.parameters.length) return false;
    return state.family === ANY || this.model(state.family) !== undefined;
  }

  /**
   * What the page shows before anyone has drawn anything: the target is the profile of some design, and the search starts from another
   * one. Two families are asked, and the one whose model is surest is taken, so that the first verdict does not say that the model is not
   * trusted.
   */
  private async firstState(): Promise<DesignState> {
    const models = firstModels(this.modelled);
    const at = ({ family, parameters }: Model, share: number): Found => ({
      family,
      parameters: parameters.lower.map((lower, k) => lower + share * (parameters.upper[k] - lower)),
    });
    const profiles = await Promise.all(models.map((model) => this.answeredProfile(at(model, 0.7), DEFAULT_STATE, DEFAULT_STATE.made)));
    const surest = surestOf(profiles);
    const found = at(models[surest], 0.3);
    return { ...DEFAULT_STATE, ...this.targetOn(profiles[surest], DEFAULT_STATE), found, fixed: found.parameters.map(() => false) };
  }

  /** The target that a design would meet; null where the server does not answer with its profile. */
  private async curveOf(state: DesignState, found: Found | null): Promise<TargetCurve | null> {
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

  private keepBefore(): void {
    const shown = this.shown.get();
    this.before.set(shown && { ...kindOf(shown), x: shown.x, y: shown.achieved });
  }

  private push(): void {
    ++this.epoch;
    this.history.push(this.state.get());
    this.tellSteps();
  }

  private restore(): void {
    ++this.epoch;
    this.keepBefore();
    this.decide(this.history.current);
    this.tellSteps();
    this.refresh("search");
  }

  private tellSteps(): void {
    this.steps.set({ undo: this.history.canUndo, redo: this.history.canRedo });
  }

  private refresh(effort: Effort): void {
    const state = this.state.get();
    if (state.points.length === 0) return;
    const { epoch } = this;
    const byHand = state.byHand && state.found !== null;
    // A long search must not keep a pointer waiting; short answers may come in first.
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
    const answer =
      effort === "follow"
        ? await this.client.post<DesignAnswer>("/v1/designs", request, { signal })
        : await runJob<DesignAnswer>(this.client, "/v1/designs", request, {
            signal,
            wait: IMMEDIATE_SECONDS,
            onProgress: (job) => this.showProgress(job, state, signal),
          });
    if (!signal.aborted && epoch === this.epoch) this.accept(answer, state);
  }

  private async showByHand(state: DesignState, epoch: number, signal: AbortSignal): Promise<void> {
    const found = state.found as Found;
    this.activity.set({ kind: "busy", effort: "profile", progress: null, stage: "" });
    const [profiles, structure] = await Promise.all([this.profilesOf(state, found, signal), this.structureOf(found, state.made, signal)]);
    if (signal.aborted || epoch !== this.epoch) return;
    const ranking = this.ranking.get();
    if (ranking && !sameWanted(ranking, wantedOf(state))) this.ranking.set(null);
    this.showAll(shownProfiles(profiles, state, structure));
  }

  /** Null where parameters give no structure, of which the profile says nothing. */
  private async structureOf(found: Found, made: Made, signal: AbortSignal): Promise<StructureAnswer | null> {
    try {
      return await this.client.post<StructureAnswer>("/v1/structures", structureRequest(found, made), { signal });
    } catch (error) {
      if (error instanceof Problem) return null;
      throw error;
    }
  }

  /** One for each target, in the order of the tabs. */
  private profilesOf(state: DesignState, found: Found, signal?: AbortSignal): Promise<Profile[]> {
    return Promise.all(targetsOf(state).map((target) => this.client.post<Profile>("/v1/profiles", profileRequest(target, found, state.made), { signal })));
  }

  private showProgress(job: Job, state: DesignState, signal: AbortSignal): void {
    if (signal.aborted) return;
    this.activity.set({ kind: "busy", effort: "search", progress: job.progress, stage: job.stage });
    const { partial } = job;
    if (!partial || !("achieved" in partial)) return;
    const shown = shownPartial(partial, state);
    this.takeOver(shown.found);
    const before = this.all.get();
    this.showAll(targetsOf(state).map((_, place) => (place === state.at ? shown : (before[place] ?? null))));
  }

  /** The design that is shown is the one of the sliders and of the next search. */
  private takeOver(found: Found): void {
    const state = this.state.get();
    const kept = state.found?.family === found.family && state.fixed.length === found.parameters.length;
    this.state.set({ ...state, found, fixed: kept ? state.fixed : found.parameters.map(() => false) });
    if (!this.inGesture) this.history.amend(this.state.get());
  }

  private accept(answer: DesignAnswer, asked: DesignState): void {
    this.takeOver(foundOf(answer, asked));
    this.rank(answer, asked);
    const targets = targetsOf(asked);
    const order = askedOrder(asked);
    const profiles = [answer.profile, ...answer.also];
    this.envelopes = envelopesOf(answer, asked).map((envelope, place) => envelope ?? this.envelopes[place] ?? null);
    const { at } = this.state.get();
    this.envelope.set(this.envelopes[at] ?? null);
    const before = this.before.get();
    const inSight = profiles[order.indexOf(at)];
    if (inSight && (!before || !sameProfile(before, targets[at]))) this.before.set({ ...kindOf(targets[at]), x: inSight.x, y: inSight.initial });
    this.showAll(shownDesigns(answer, asked));
  }

  private rank({ ranking }: DesignAnswer, asked: DesignState): void {
    const before = this.ranking.get();
    if (ranking.length > 1) this.ranking.set({ ...wantedOf(asked), candidates: ranking });
    else if (before && !sameWanted(before, wantedOf(asked))) this.ranking.set(null);
  }

  private fail(error: unknown, effort: Effort, signal: AbortSignal): void {
    if (signal.aborted || isAbort(error)) return;
    if (error instanceof Problem && error.code === "design.superseded") {
      // One runs at a time, so that no newer one of ours did it: one that was stopped came to the server late.
      this.refresh(effort);
      return;
    }
    this.unanswered = true;
    this.activity.set(error instanceof ConnectionLost ? { kind: "idle" } : { kind: "failed", sentence: explain(error) });
  }
}
