// The design session: the state, its changes, and what belongs to it. It does not depend on elements of the page.
import type { Curve } from "../base/curve";
import { rememberedLevel, withSwitch } from "../base/accuracy_choice";
import { EditedState } from "../base/edited_state";
import { Redraws } from "../base/redraws";
import type { Client } from "../contract/client";
import type { DesignCandidate, EffectSwitch } from "../contract/types";
import { Catalogue } from "./catalogue";
import { firstState } from "./opening";
import { profileOf } from "./properties";
import { RegionEdits } from "./region_edits";
import { Results } from "./results";
import { Search } from "./search";
import { designOf } from "./shown";
import type { Specification } from "./specification";
import { DEFAULT_STATE, type DesignState, type ProfileKind, type Target, type TilingDesign } from "./state";
import { TargetEdits } from "./target_edits";
import { targetsOf } from "./target_list";

export class DesignSession {
  readonly catalogue = new Catalogue();
  readonly edited = new EditedState<DesignState>(DEFAULT_STATE);
  readonly state = this.edited.state;
  readonly steps = this.edited.steps;
  readonly results = new Results(this.state);
  /** Redraws of what shows this session and is not under the pointer. */
  readonly redraws = new Redraws(() => this.edited.isBeingChanged);
  readonly search: Search;
  readonly targetEdits = new TargetEdits(this);
  readonly regionEdits = new RegionEdits(this);

  constructor(private readonly client: Client) {
    this.search = new Search(client, this.edited, this.results);
  }

  /** Loads families and models, and shows the state of a link or an initial one. */
  async start(linked: DesignState | null): Promise<void> {
    await this.catalogue.load(this.client);
    if (this.catalogue.models.length === 0) return;
    const state = linked && this.catalogue.serves(linked) ? linked : await this.firstState();
    this.edited.begin(state);
    this.search.refresh("search");
    void this.search.showStart(state);
  }

  /** Shows the state of a link that is followed. Its family may have got its model since the families were asked for. */
  async follow(linked: DesignState): Promise<void> {
    if (!this.catalogue.serves(linked)) await this.catalogue.load(this.client).catch(() => {}); // the request for the state meets the same fault and reports it
    this.apply(linked);
  }

  private async firstState(): Promise<DesignState> {
    const state = await firstState(this.client, this.catalogue);
    return { ...state, accuracy: { ...state.accuracy, level: rememberedLevel("design") } };
  }

  /** Changes when an effect of searches runs. */
  setEffect(effect: string, value: EffectSwitch): void {
    this.apply({ accuracy: withSwitch(this.state.get().accuracy, effect, value) });
  }

  /** All targets, in the order of their tabs. */
  get targets(): readonly Target[] {
    return targetsOf(this.state.get());
  }

  /** Begins a change with intermediate states, such as a drag. It ends with `finish`. */
  gesture(): void {
    if (this.edited.beginChange()) this.results.storePrevious();
  }

  /** Shows an intermediate state of a change. */
  preview(change: Partial<DesignState>): void {
    this.gesture();
    this.edited.change(change);
    this.search.refresh("follow");
  }

  /** Ends a change, which becomes one step of the history. */
  finish(): void {
    if (!this.edited.endChange()) return;
    this.push();
    this.search.refresh("search");
  }

  /** Makes a change without intermediate states. */
  apply(change: Partial<DesignState>): void {
    this.finish();
    this.results.storePrevious();
    this.show({ ...this.state.get(), ...change });
    this.push();
    this.search.refresh("search");
  }

  undo(): void {
    this.finish();
    this.edited.undo((state) => this.restore(state));
  }

  redo(): void {
    this.finish();
    this.edited.redo((state) => this.restore(state));
  }

  /** Makes the present state a step, whose answer is awaited. */
  push(): void {
    this.search.outdate();
    this.edited.push();
  }

  /** Changes a name, as a step without a search. */
  rename(change: Pick<DesignState, "name"> | Pick<DesignState, "region">): void {
    this.finish();
    this.edited.change(change);
    this.edited.push();
  }

  /** Shows the best design of one family of the ranking. */
  lookAt(candidate: DesignCandidate): void {
    this.apply({ family: candidate.family, found: designOf(candidate, this.state.get()), byHand: false });
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

  /** A design's profile of some kind; null if the server does not answer with it. */
  async profile(found: TilingDesign, kind: ProfileKind & Pick<DesignState, "points">, made: Specification): Promise<Curve | null> {
    const answer = await profileOf(this.client, found, kind, made);
    return answer && { x: answer.x, y: answer.y };
  }

  /** Ends the search for the selected region and stores its results. */
  leaveRegion(): void {
    this.search.leave();
    this.targetEdits.forgetStored();
    this.results.cacheRegion();
  }

  private restore(state: DesignState): void {
    this.search.outdate();
    this.results.storePrevious();
    this.show(state);
    this.search.refresh("search");
  }

  /** Sets a state and shows the results that are stored for what it selects. */
  private show(next: DesignState): void {
    const { at, regionAt, otherRegions } = this.state.get();
    const isSameCount = otherRegions.length === next.otherRegions.length;
    if (!isSameCount || regionAt !== next.regionAt) {
      if (isSameCount) this.leaveRegion();
      else this.results.regionCache.set([]);
      this.state.set(next);
      return this.results.showCached();
    }
    this.state.set(next);
    // Responses are stored by the index of their target, so that they are void if the number of targets has changed.
    if (this.results.all.get().length !== next.others.length + 1) this.results.show([]);
    else if (at !== next.at) this.results.showSelected();
  }
}
