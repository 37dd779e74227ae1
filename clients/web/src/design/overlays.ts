// Curves of ranked families that are laid over that of the design shown.
import { Observable } from "../base/observable";
import type { DesignCandidate } from "../contract/types";
import { leavesModulus, modulusWords } from "./made";
import type { PinnedCurve } from "./plot";
import type { DesignSession } from "./session";
import { foundOf } from "./shown";

/** Colours are those of pins; overlays begin where pins have seldom come to. */
const FIRST_COLOUR = 3;

interface Overlaid extends PinnedCurve {
  readonly candidate: DesignCandidate;
}

export class Overlays {
  readonly list = new Observable<readonly PinnedCurve[]>([]);
  private overlaid: readonly Overlaid[] = [];
  private count = 0;
  private at = 0;

  constructor(private readonly session: DesignSession) {
    session.ranking.watch(() => this.show([]));
    // Of another target that comes into sight the families do something else.
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
    const ranking = this.session.ranking.get();
    const { at } = this;
    const target = ranking?.targets[at];
    if (!target) return;
    const curve = await this.session.profile(foundOf(candidate, ranking), target, ranking.made);
    if (!curve || ranking !== this.session.ranking.get() || at !== this.at || this.has(family)) return;
    // Another family may serve the targets best with another modulus.
    const name = leavesModulus(ranking.made) ? `${family} of ${modulusWords(material.youngs_modulus)} MPa` : family;
    this.show([...this.overlaid, { ...curve, id: FIRST_COLOUR + this.count++, name, candidate }]);
  }

  private show(overlaid: readonly Overlaid[]): void {
    this.overlaid = overlaid;
    this.list.set(overlaid);
  }
}
