// Designs put aside to compare with: their curves in the plot, their way back.
import { Observable } from "../base/observable";
import { percent } from "../base/format";
import { readLink, writeLink } from "./link";
import type { PinnedCurve } from "./plot";
import { regionOf, withRegions } from "./region_list";
import type { DesignSession } from "./session";
import { type DesignState, type Found, type ProfileKind, sameProfile, TASK_WORDS } from "./state";

const KEY = "supple-pins";
const MOST_PINS = 12;

export interface Pin {
  readonly id: number;
  readonly name: string;
  readonly state: DesignState & { found: Found };
  /** Its profile of the kind shown now; null until the server has told it. */
  readonly curve: PinnedCurve | null;
}

export class Pins {
  readonly list = new Observable<readonly Pin[]>([]);
  private nextId = 0;
  private kind: (ProfileKind & Pick<DesignState, "points">) | null = null;

  constructor(private readonly session: DesignSession) {
    session.state.watch((state) => this.follow(state));
  }

  /** The pins that this browser has kept. To be called once the models are known. */
  restore(): void {
    try {
      const kept = JSON.parse(localStorage.getItem(KEY) ?? "[]") as { name: string; link: string }[];
      for (const { name, link } of kept) {
        const state = readLink(link);
        if (state?.found && this.session.model(state.found.family)) this.insert(String(name).slice(0, 80), state as Pin["state"]);
      }
    } catch {
      // kept by another version, or storage is refused: begin without
    }
  }

  add(): void {
    const state = this.session.state.get();
    const shown = this.session.shown.get();
    if (!state.found || !shown || !this.session.isCurrent || this.list.get().length >= MOST_PINS) return;
    const name = `${state.found.family}, ${TASK_WORDS[state.task].short.toLowerCase()}, ${percent(shown.deviation)} off`;
    // Of a product with several regions the one in sight.
    this.insert(name, { ...withRegions([regionOf(state)], 0), found: state.found });
    this.keep();
  }

  remove(id: number): void {
    this.list.set(this.list.get().filter((pin) => pin.id !== id));
    this.keep();
  }

  show(pin: Pin): void {
    const { otherRegions: _, regionAt: __, region: ___, ...region } = pin.state;
    this.session.apply(region);
  }

  private insert(name: string, state: Pin["state"]): void {
    const pin: Pin = { id: this.nextId++, name, state, curve: null };
    this.list.set([...this.list.get(), pin]);
    void this.trace(pin);
  }

  private follow(state: DesignState): void {
    const changed = !this.kind || !sameProfile(this.kind, state) || ends(this.kind) !== ends(state);
    this.kind = state;
    if (changed) for (const pin of this.list.get()) void this.trace(pin);
  }

  private async trace(pin: Pin): Promise<void> {
    const { kind } = this;
    if (!kind) return;
    const curve = await this.session.profile(pin.state.found, kind, pin.state.made);
    if (!curve || kind !== this.kind && !sameProfile(kind, this.kind as ProfileKind)) return;
    this.list.set(this.list.get().map((other) => (other.id === pin.id ? { ...other, curve: { ...curve, id: pin.id, name: pin.name } } : other)));
  }

  private keep(): void {
    try {
      localStorage.setItem(KEY, JSON.stringify(this.list.get().map(({ name, state }) => ({ name, link: writeLink(state) }))));
    } catch {
      // the pins last as long as the page
    }
  }
}

function ends({ points }: Pick<DesignState, "points">): string {
  return points.length === 0 ? "" : `${points[0][0]} ${points[points.length - 1][0]}`;
}
