// Curves of ranked families that are drawn over the shown design.
import { Observable } from "../base/observable";
import type { DesignCandidate } from "../contract/types";
import { searchesModulus, modulusWords } from "./specification";
import type { PinnedCurve } from "./plot";
import type { DesignSession } from "./session";
import { designOf } from "./shown";

/** Index of the first overlay's colour. Pins use the same colours from index 0, so that both seldom coincide. */
const FIRST_COLOUR = 3;

interface OverlaidCurve extends PinnedCurve {
  readonly candidate: DesignCandidate;
}

export class Overlays {
  readonly list = new Observable<readonly PinnedCurve[]>([]);
  private overlaid: readonly OverlaidCurve[] = [];
  private count = 0;
  private at = 0;

  constructor(private readonly session: DesignSession) {
    session.results.ranking.watch(() => this.show([]));
    // Responses of the families to another target are other curves.
    session.state.watch(({ at }) => {
      if (at === this.at) return;
      this.at = at;
      const before = this.overlaid;
      this.show([]);
      for (const { candidate } of before) void this.add(candidate);
    });
  }

  has(family: string): boolean {
    return this.overlaid.some((curve) => curve.candidate.family === family);
  }

  async toggle(candidate: DesignCandidate): Promise<void> {
    const { family } = candidate;
    if (this.has(family)) return this.show(this.overlaid.filter((curve) => curve.candidate.family !== family));
    await this.add(candidate);
  }

  private async add(candidate: DesignCandidate): Promise<void> {
    const { family, material } = candidate;
    const ranking = this.session.results.ranking.get();
    const { at } = this;
    const target = ranking?.targets[at];
    if (!target) return;
    const curve = await this.session.profile(designOf(candidate, ranking), target, ranking.made);
    if (!curve || ranking !== this.session.results.ranking.get() || at !== this.at || this.has(family)) return;
    // Each family may have its own best modulus.
    const name = searchesModulus(ranking.made) ? `${family} of ${modulusWords(material.youngs_modulus)} MPa` : family;
    this.show([...this.overlaid, { ...curve, id: FIRST_COLOUR + this.count++, name, candidate }]);
  }

  private show(overlaid: readonly OverlaidCurve[]): void {
    this.overlaid = overlaid;
    this.list.set(overlaid);
  }
}
