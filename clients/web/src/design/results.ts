// The results of searches: responses of designs to targets, envelopes and rankings, for the selected region and for the others.
import type { Curve } from "../base/curve";
import { Observable } from "../base/observable";
import type { Design, DesignAnswer, DesignCandidate } from "../contract/types";
import { regionsOf } from "./region_list";
import { type CostedDesign, designResponses, type Envelope, freshness, kindOf, type Requirements, requirementsOf, sameRequirements, sameTilingDesign, type TargetResponse,
  withBoundOf } from "./shown";
import { type DesignState, type ProfileKind, type Region, sameProfile } from "./state";
import { askedOrder, targetsOf } from "./target_list";

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

/** The envelope of a design's family for each target, in the order of the tabs. */
function envelopesOf(answer: Design, asked: Region): (Envelope | null)[] {
  const order = askedOrder(asked);
  const profiles = [answer.profile, ...answer.also];
  return targetsOf(asked).map((target, place) => {
    const { x, envelope } = profiles[order.indexOf(place)];
    return envelope && { ...kindOf(target), family: answer.family, x, ...envelope };
  });
}

/** `TargetResponse` of each target, in the order of the tabs, and what belongs to them. The selected target and region are those of the state. */
export class Results {
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
  /** The envelope of the family for each target. */
  private envelopes: readonly (Envelope | null)[] = [];

  constructor(private readonly state: Observable<DesignState>) {}

  /** Whether the shown response belongs to the present state. */
  get isCurrent(): boolean {
    return freshness(this.shown.get(), this.state.get()) === "current";
  }

  /** The responses of each region's design to its targets; null for a region without a design, or if it has changed since the search. */
  get ofRegions(): readonly (readonly TargetResponse[] | null)[] {
    const { regionAt } = this.state.get();
    return regionsOf(this.state.get()).map((region, k) => {
      const all = k === regionAt ? this.all.get() : (this.regionCache.get()[k]?.all ?? []);
      const belongs = (shown: TargetResponse): boolean =>
        !shown.provisional && sameRequirements(shown, requirementsOf(region)) && region.found !== null && sameTilingDesign(shown.found, region.found);
      const known = all.filter((shown): shown is TargetResponse => shown !== null && belongs(shown));
      return known.length === region.others.length + 1 ? known : null;
    });
  }

  show(all: readonly (TargetResponse | null)[]): void {
    this.all.set(all);
    this.shown.set(all[this.state.get().at] ?? null);
  }

  /** Shows the results for the target that was selected. */
  showSelected(): void {
    const { at } = this.state.get();
    this.previous.set(null);
    this.envelope.set(this.envelopes[at] ?? null);
    this.shown.set(this.all.get()[at] ?? null);
  }

  /** Makes the shown profile the one before the next change. */
  storePrevious(): void {
    const shown = this.shown.get();
    this.previous.set(shown && { ...kindOf(shown), x: shown.x, y: shown.achieved });
  }

  /** Drops the results for a target that is removed. */
  dropTarget(at: number): void {
    this.show(this.all.get().filter((_, k) => k !== at));
    this.envelopes = this.envelopes.filter((_, k) => k !== at);
  }

  /** Shows the answer of a search. */
  accept(answer: DesignAnswer, asked: DesignState): void {
    const { ranking } = answer;
    if (ranking.length > 1) this.ranking.set({ ...requirementsOf(asked), candidates: ranking });
    else this.dropOtherRanking(asked);
    const targets = targetsOf(asked);
    this.envelopes = envelopesOf(answer, asked).map((envelope, place) => envelope ?? this.envelopes[place] ?? null);
    const { at } = this.state.get();
    this.envelope.set(this.envelopes[at] ?? null);
    const previous = this.previous.get();
    const inSight = [answer.profile, ...answer.also][askedOrder(asked).indexOf(at)];
    if (inSight && (!previous || !sameProfile(previous, targets[at]))) this.previous.set({ ...kindOf(targets[at]), x: inSight.x, y: inSight.initial });
    this.show(designResponses(answer, asked));
  }

  /** Shows the responses of a design whose parameters were set by hand. */
  acceptByHand(all: readonly TargetResponse[], asked: DesignState): void {
    this.dropOtherRanking(asked);
    const before = this.all.get();
    this.show(all.map((response, place) => withBoundOf(response, before[place] ?? null)));
  }

  /** Shows the response of the best design so far of a running search. */
  acceptPartial(response: TargetResponse, asked: DesignState): void {
    const before = this.all.get();
    this.show(targetsOf(asked).map((_, place) => (place === asked.at ? response : (before[place] ?? null))));
  }

  /** Makes the best design so far of a search that was stopped its result. A partial result does not say where the model is trusted. */
  finalizePartial(): void {
    const message = "The search was stopped: this is its best so far. At which samples the model can be trusted is not known.";
    const finalized = (shown: TargetResponse): TargetResponse => ({ ...shown, provisional: false, message, inRange: shown.x.map(() => false) });
    this.show(this.all.get().map((shown) => (shown?.provisional ? finalized(shown) : shown)));
  }

  /** Stores the results of the selected region, before another one is selected. */
  cacheRegion(): void {
    const { regionAt } = this.state.get();
    const results: RegionResults = { all: this.all.get(), envelopes: this.envelopes, ranking: this.ranking.get() };
    this.regionCache.set(this.cached().map((other, k) => (k === regionAt ? results : other)));
  }

  /** Stores a copy of the selected region's results for a region that is added at the end. */
  copyRegion(): void {
    const cached = this.cached();
    this.regionCache.set([...cached, cached[this.state.get().regionAt]]);
  }

  /** Stores, for each region of a new list, the results of the present region with this index. */
  copyRegions(sources: readonly number[]): void {
    const cached = this.cached();
    this.regionCache.set(sources.map((from) => cached[from]));
  }

  dropRegion(at: number): void {
    this.regionCache.set(this.cached().filter((_, k) => k !== at));
  }

  /** Stores the designs of all regions. */
  cacheDesigns(designs: readonly CostedDesign[], asked: readonly Region[]): void {
    this.regionCache.set(asked.map((region, k) => {
      const all = designResponses(designs[k], region).map((shown) => ({ ...shown, byHand: region.byHand }));
      const { ranking } = designs[k];
      return { all, envelopes: envelopesOf(designs[k], region), ranking: ranking.length > 1 ? { ...requirementsOf(region), candidates: ranking } : null };
    }));
  }

  /** Shows the stored results of the selected region. */
  showCached(): void {
    const { at, regionAt } = this.state.get();
    const known = this.regionCache.get()[regionAt];
    this.envelopes = known?.envelopes ?? [];
    this.previous.set(null);
    this.envelope.set(this.envelopes[at] ?? null);
    this.ranking.set(known?.ranking ?? null);
    this.show(known?.all ?? []);
  }

  /** The stored results of each region of the state. */
  private cached(): (RegionResults | null)[] {
    return regionsOf(this.state.get()).map((_, k) => this.regionCache.get()[k] ?? null);
  }

  /** Drops a ranking for other requirements. */
  private dropOtherRanking(asked: DesignState): void {
    const ranking = this.ranking.get();
    if (ranking && !sameRequirements(ranking, requirementsOf(asked))) this.ranking.set(null);
  }
}
