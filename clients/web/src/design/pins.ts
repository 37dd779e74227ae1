// Pinned designs: their curves are drawn for comparison, and their states can be restored.
import { Observable } from "../base/observable";
import { percent } from "../base/format";
import { judgedResponse } from "./judged";
import { readLink, writeLink } from "./link";
import type { PinnedCurve } from "./plot";
import { regionOf, withRegions } from "./region_list";
import type { DesignSession } from "./session";
import { type DesignState, type TilingDesign, type ProfileKind, sameProfile, TASK_WORDS } from "./state";
import type { Verification } from "./verification";

const KEY = "supple-pins";
const MAX_PINS = 12;

export interface Pin {
  readonly id: number;
  readonly name: string;
  readonly state: DesignState & { found: TilingDesign };
  /** Its profile of the kind that is shown now; null until the server has answered. */
  readonly curve: PinnedCurve | null;
}

export class Pins {
  readonly list = new Observable<readonly Pin[]>([]);
  private nextId = 0;
  private kind: (ProfileKind & Pick<DesignState, "points">) | null = null;

  constructor(private readonly session: DesignSession, private readonly verification: Verification) {
    session.state.watch((state) => this.follow(state));
  }

  /** Loads the pins from the browser's storage. Called when the models are known. */
  restore(): void {
    try {
      const stored = JSON.parse(localStorage.getItem(KEY) ?? "[]") as { name: string; link: string }[];
      for (const { name, link } of stored) {
        const state = readLink(link);
        if (state?.found && this.session.catalogue.model(state.found.family)) this.insert(String(name).slice(0, 80), state as Pin["state"]);
      }
    } catch {
      // the stored text is of another version, or storage is blocked: the list stays empty
    }
  }

  add(): void {
    const state = this.session.state.get();
    const shown = this.session.results.shown.get();
    if (!state.found || !shown || !this.session.results.isCurrent || this.list.get().length >= MAX_PINS) return;
    const { source, deviation } = judgedResponse(this.session, this.verification, shown);
    const off = source === "simulation" && deviation !== null ? `${percent(deviation)} off, simulated` : `${percent(shown.deviation)} off`;
    const name = `${state.found.family}, ${TASK_WORDS[state.task].short.toLowerCase()}, ${off}`;
    // Only the selected region is pinned.
    this.insert(name, { ...withRegions([regionOf(state)], 0), accuracy: state.accuracy, found: state.found });
    this.store();
  }

  remove(id: number): void {
    this.list.set(this.list.get().filter((pin) => pin.id !== id));
    this.store();
  }

  show(pin: Pin): void {
    const { otherRegions: _, regionAt: __, region: ___, ...region } = pin.state;
    this.session.apply(region);
  }

  private insert(name: string, state: Pin["state"]): void {
    const pin: Pin = { id: this.nextId++, name, state, curve: null };
    this.list.set([...this.list.get(), pin]);
    void this.fetchCurve(pin);
  }

  private follow(state: DesignState): void {
    const changed = !this.kind || !sameProfile(this.kind, state) || strainRange(this.kind) !== strainRange(state);
    this.kind = state;
    if (changed) { for (const pin of this.list.get()) void this.fetchCurve(pin); }
  }

  private async fetchCurve(pin: Pin): Promise<void> {
    const { kind } = this;
    if (!kind) return;
    const curve = await this.session.profile(pin.state.found, kind, pin.state.made);
    if (!curve || kind !== this.kind && !sameProfile(kind, this.kind as ProfileKind)) return;
    this.list.set(this.list.get().map((other) => (other.id === pin.id ? { ...other, curve: { ...curve, id: pin.id, name: pin.name } } : other)));
  }

  private store(): void {
    try {
      localStorage.setItem(KEY, JSON.stringify(this.list.get().map(({ name, state }) => ({ name, link: writeLink(state) }))));
    } catch {
      // storage is blocked: the pins last as long as the page
    }
  }
}

function strainRange({ points }: Pick<DesignState, "points">): string {
  return points.length === 0 ? "" : `${points[0][0]} ${points[points.length - 1][0]}`;
}
