// Searches for designs that have the targets of the state. Only the answer to the newest state counts.
import { LevelMeasures } from "../base/accuracy_levels";
import { Observable } from "../base/observable";
import type { EditedState } from "../base/edited_state";
import { type Client, Problem } from "../contract/client";
import { type Activity, JobRunner, type Run } from "../contract/runner";
import type { Design, DesignAnswer, Job } from "../contract/types";
import { profilesOf, structureOf } from "./properties";
import { regionsOf, withRegions } from "./region_list";
import { designRequest, type Effort, regionsRequest } from "./requests";
import type { Results } from "./results";
import { type CostedDesign, designOf, partialResponse, profileResponses } from "./shown";
import type { DesignState, Region, TilingDesign } from "./state";

const PATH = "/v1/designs";
/** Time in seconds after which a search becomes a job with progress. */
const IMMEDIATE_SECONDS = 0.4;

/** A search, or the computation of the profiles of a design whose parameters were set by hand. */
export interface SearchWork {
  readonly effort: Effort | "profile";
  readonly stage: string;
}

export type SearchActivity = Activity<SearchWork>;
type SearchRun = Run<SearchWork>;

type RegionsAnswer = { readonly regions: readonly Design[] } & Pick<DesignAnswer, "cost" | "effects">;

/** An answer whose design was simulated, and the state for which it was searched. */
export interface SimulatedAnswer {
  readonly answer: DesignAnswer;
  readonly asked: DesignState;
}

export class Search {
  readonly activity: Observable<SearchActivity>;
  /** What the last searches took. */
  readonly measures = new LevelMeasures();
  /** The last answer of a search that simulates, as the surest does. */
  readonly simulated = new Observable<SimulatedAnswer | null>(null);
  private readonly runner: JobRunner<SearchWork>;
  /** Name of the editing session: on the server, a search replaces the earlier ones of the same session. */
  private readonly name = `web-${crypto.getRandomValues(new Uint32Array(3)).join("-")}`;
  /** The effort of the last task. */
  private effort: SearchWork["effort"] = "follow";
  /** Counts the changes that make answers to earlier requests obsolete. */
  private epoch = 0;

  constructor(
    private readonly client: Client,
    private readonly edited: EditedState<DesignState>,
    private readonly results: Results,
  ) {
    this.runner = new JobRunner(client);
    this.activity = this.runner.activity;
  }

  /** Makes the answers to earlier requests obsolete. */
  outdate(): void {
    ++this.epoch;
  }

  /** Ends the search for a region that is no longer selected. */
  leave(): void {
    this.outdate();
    this.runner.cancel();
  }

  /** Cancels the running search for the user. Its best design so far stays. */
  cancel(): void {
    this.runner.stop();
    this.results.finalizePartial();
    this.activity.set({ kind: "stopped" });
  }

  /** Repeats a request that a lost connection, a fault or the user has ended. */
  retry(): void {
    if (this.runner.hasFailed || this.activity.get().kind === "stopped") this.refresh("search");
  }

  /** Searches for a design of the present state, or computes the profiles of one whose parameters were set by hand. */
  refresh(effort: Effort): void {
    const state = this.edited.state.get();
    if (state.points.length === 0) return;
    const { epoch } = this;
    const byHand = state.byHand ? state.found : null;
    // A thorough search is stopped at once, so that it does not delay a pointer. Quick requests may end first.
    const urgent = this.effort === "search" || effort === "search";
    this.runner.follow((run) => {
      this.effort = byHand ? "profile" : effort;
      return byHand ? this.computeByHand(state, byHand, epoch, run) : this.search(state, effort, epoch, run);
    }, (error) => this.fail(error, effort), urgent);
  }

  /** Searches for the designs of all regions in one request. */
  searchRegions(): void {
    const { epoch } = this;
    const { accuracy, ...product } = this.edited.state.get();
    const regions = regionsOf(product);
    this.runner.follow(async (run) => {
      this.effort = "search";
      run.tell({ effort: "search", stage: "" });
      const onJob = ({ progress, stage }: Job): void => run.tell({ effort: "search", stage }, progress);
      const answer = await run.job<RegionsAnswer>(PATH, regionsRequest(regions, this.name, accuracy), { wait: IMMEDIATE_SECONDS, onJob });
      if (epoch === this.epoch) this.acceptRegions(answer, regions);
    }, (error) => this.fail(error, "search"), true);
  }

  /** Shows the initial design while the first search runs. */
  async showStart(state: DesignState): Promise<void> {
    if (!state.found || state.byHand) return;
    const { epoch } = this;
    try {
      const all = profileResponses(await profilesOf(this.client, state, state.found), state);
      if (!this.results.shown.get() && epoch === this.epoch) this.results.show(all.map((shown) => ({ ...shown, byHand: false, provisional: true })));
    } catch {
      // the search reports the fault
    }
  }

  private async search(state: DesignState, effort: Effort, epoch: number, run: SearchRun): Promise<void> {
    run.tell({ effort, stage: "" });
    const request = designRequest(state, effort, this.name, state.accuracy);
    const answer = await (effort === "follow" ? run.post<DesignAnswer>(PATH, request)
      : run.job<DesignAnswer>(PATH, request, { wait: IMMEDIATE_SECONDS, onJob: (job) => this.showProgress(job, state, run) }));
    if (epoch !== this.epoch) return;
    this.setDesign(designOf(answer, state));
    this.results.accept(answer, state);
    if (effort === "follow") return;
    this.measures.record("designs", { level: state.accuracy.level, seconds: answer.cost.seconds, error: null });
    if (answer.profile.verified) this.simulated.set({ answer, asked: state });
  }

  private async computeByHand(state: DesignState, found: TilingDesign, epoch: number, run: SearchRun): Promise<void> {
    run.tell({ effort: "profile", stage: "" });
    const [profiles, structure] = await Promise.all([profilesOf(run, state, found), structureOf(run, found, state.made)]);
    if (epoch === this.epoch) this.results.acceptByHand(profileResponses(profiles, state, structure), state);
  }

  private showProgress({ progress, stage, partial }: Job, state: DesignState, run: SearchRun): void {
    run.tell({ effort: "search", stage }, progress);
    if (!partial || !("achieved" in partial)) return;
    const response = partialResponse(partial, state);
    this.setDesign(response.found);
    this.results.acceptPartial(response, state);
  }

  /** Makes a design the one of the sliders, from which the next search starts. */
  private setDesign(found: TilingDesign): void {
    const state = this.edited.state.get();
    this.edited.amend({ ...state, found, fixed: fixedOf(state, found) });
  }

  private acceptRegions(answer: RegionsAnswer, asked: readonly Region[]): void {
    const state = this.edited.state.get();
    const designs = asked.map((_, k): CostedDesign => ({ ...answer.regions[k], cost: answer.cost, effects: answer.effects }));
    this.results.cacheDesigns(designs, asked);
    const regions = regionsOf(state).map((region, k): Region => ({ ...region, found: designOf(designs[k], asked[k]), fixed: fixedOf(region, designs[k]) }));
    this.edited.amend({ ...state, ...withRegions(regions, state.regionAt) });
    this.results.showCached();
  }

  private fail(error: unknown, effort: Effort): void {
    // Only one search of this session runs at a time, so that no newer one replaced it. An aborted one has reached the server late.
    if (error instanceof Problem && error.code === "design.superseded") this.refresh(effort);
    else this.runner.tellFault(error);
  }
}

/** Whether each parameter of a design is fixed. Parameters of another family, or of another number, are free. */
function fixedOf({ found, fixed }: Region, { family, parameters }: Pick<TilingDesign, "family" | "parameters">): readonly boolean[] {
  return found?.family === family && fixed.length === parameters.length ? fixed : parameters.map(() => false);
}
