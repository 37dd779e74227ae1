// The rounds of a running polish: each has a curve on the plot, its deviation and its time, and the best is kept.
import type { Curve } from "../base/curve";
import { Observable } from "../base/observable";
import type { Polish } from "../contract/types";
import type { DesignSession } from "./session";
import { isRange, searchesModulus } from "./specification";
import { targetsText } from "./started_jobs";
import { type DesignState, sameProfile, type TilingDesign } from "./state";
import { targetsOf } from "./target_list";

/** A round as events of the job tell it, with its family. */
export type AnsweredRound = Polish["rounds"][number] & { readonly family: string };

export interface PolishRound {
  /** From 1. */
  readonly number: number;
  /** Deviation of the simulation from the targets; null if it failed. */
  readonly deviation: number | null;
  readonly seconds: number;
  /** Whether it is the best so far. */
  readonly isBest: boolean;
  /** The model's curve for its parameters; null until the server has answered. */
  readonly curve: Curve | null;
}

export class PolishRounds {
  readonly list = new Observable<readonly PolishRound[]>([]);
  private asked: DesignState | null = null;
  private found: (TilingDesign & { readonly round: number }) | null = null;
  private lastKey = "";
  private all: readonly AnsweredRound[] = [];

  constructor(private readonly session: DesignSession) {
    // The rounds of other targets say nothing about the present ones.
    session.state.watch((state) => this.asked && targetsText(targetsOf(state)) !== targetsText(targetsOf(this.asked)) && this.clear());
  }

  /** The rounds so far, as they were told. */
  get answered(): readonly AnsweredRound[] {
    return this.all;
  }

  /** `before`: the rounds that were seen before the page was left. */
  begin(asked: DesignState, before: readonly AnsweredRound[] = []): void {
    this.clear();
    this.asked = asked;
    for (const round of before) this.add(round, round.family);
  }

  clear(): void {
    this.asked = null;
    this.found = null;
    this.lastKey = "";
    this.all = [];
    this.list.set([]);
  }

  /** The best design so far; null if it is the one from which the polish began, or if its material is not known. */
  get best(): TilingDesign | null {
    if (!this.found || this.found.round === 1 || !this.asked || searchesModulus(this.asked.made)) return null;
    const { round: _, ...found } = this.found;
    return found;
  }

  /** Adds a round that was reported by an event of the job. Several events may report the same one. */
  add(round: Polish["rounds"][number], family: string): void {
    const { asked } = this;
    const key = round.parameters.join();
    if (!asked || key === this.lastKey) return;
    this.lastKey = key;
    this.all = [...this.all, { ...round, family }];
    const number = this.list.get().length + 1;
    const found = { ...asked.found, family, parameters: round.parameters, ...(isRange(asked.made.orientation) && { orientation: round.orientation }) };
    if (round.accepted) this.found = { ...found, round: number };
    const before = round.accepted ? this.list.get().map((one) => ({ ...one, isBest: false })) : this.list.get();
    this.list.set([...before, { number, deviation: round.target_error, seconds: round.seconds, isBest: round.accepted, curve: null }]);
    void this.fetchCurve(number, found, asked);
  }

  private async fetchCurve(number: number, found: TilingDesign, asked: DesignState): Promise<void> {
    const curve = await this.session.profile(found, asked, asked.made);
    if (!curve || this.asked !== asked || !sameProfile(asked, this.session.state.get())) return;
    this.list.set(this.list.get().map((one) => (one.number === number ? { ...one, curve } : one)));
  }
}
