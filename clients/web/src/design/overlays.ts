// Curves of ranked families that are laid over that of the design shown.
import { Observable } from "../base/observable";
import type { DesignCandidate } from "../contract/types";
import type { PinnedCurve } from "./plot";
import type { DesignSession } from "./session";

/** Colours are those of pins; overlays begin where pins have seldom come to. */
const FIRST_COLOUR = 3;

export class Overlays {
  readonly list = new Observable<readonly PinnedCurve[]>([]);
  private count = 0;

  constructor(private readonly session: DesignSession) {
    session.ranking.watch(() => this.list.set([]));
  }

  has(family: string): boolean {
    return this.list.get().some((curve) => curve.name === family);
  }

  async toggle({ family, parameters }: DesignCandidate): Promise<void> {
    if (this.has(family)) return this.list.set(this.list.get().filter((curve) => curve.name !== family));
    const ranking = this.session.ranking.get();
    if (!ranking) return;
    const curve = await this.session.profile({ family, parameters }, ranking);
    if (curve && ranking === this.session.ranking.get() && !this.has(family)) this.list.set([...this.list.get(), { ...curve, id: FIRST_COLOUR + this.count++, name: family }]);
  }
}
