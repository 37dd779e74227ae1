// Weaves put aside to compare with: their curves as they were, at their strain, and their way back.
import { Observable } from "../base/observable";
import { percent } from "../base/format";
import { readLink, writeLink } from "./link";
import type { Profile } from "./profile";
import { profileKey, type WeaveSession } from "./session";
import { weaveWords, type WeaveState } from "./state";

const KEY = "supple-weave-pins";
const MOST_PINS = 12;
const MOST_DIRECTIONS = 2000;

export type PinnedProfile = Pick<Profile, "directions" | "youngs" | "poisson">;

export interface Pin {
  readonly id: number;
  readonly name: string;
  readonly state: WeaveState;
  readonly profile: PinnedProfile;
}

export class Pins {
  readonly list = new Observable<readonly Pin[]>([]);
  private nextId = 0;

  constructor(private readonly session: WeaveSession) {}

  /** The pins that this browser has kept. */
  restore(): void {
    try {
      const kept = JSON.parse(localStorage.getItem(KEY) ?? "[]") as { name: string; link: string; profile: unknown }[];
      for (const { name, link, profile } of kept.slice(0, MOST_PINS)) {
        const state = readLink(link);
        if (state && isProfile(profile)) this.insert(String(name).slice(0, 120), state, profile);
      }
    } catch {
      // kept by another version, or storage is refused: begin without
    }
  }

  /** False where there is nothing to pin yet, or too much already. */
  add(): boolean {
    const state = this.session.state.get();
    const profile = this.session.profile.get();
    if (!profile || profile.key !== profileKey(state) || this.list.get().length >= MOST_PINS) return false;
    const { directions, youngs, poisson } = profile;
    this.insert(`${weaveWords(state)}, ${percent(state.strain)}`, state, { directions, youngs, poisson });
    this.keep();
    return true;
  }

  remove(id: number): void {
    this.list.set(this.list.get().filter((pin) => pin.id !== id));
    this.keep();
  }

  show(pin: Pin): void {
    this.session.apply(pin.state);
  }

  private insert(name: string, state: WeaveState, profile: PinnedProfile): void {
    this.list.set([...this.list.get(), { id: this.nextId++, name, state, profile }]);
  }

  private keep(): void {
    const short = (values: readonly (number | null)[]) => values.map((value) => value && Number(value.toPrecision(5)));
    try {
      const kept = this.list.get().map(({ name, state, profile: { directions, youngs, poisson } }) => ({
        name, link: writeLink(state), profile: { directions, youngs: short(youngs), poisson: short(poisson) },
      }));
      localStorage.setItem(KEY, JSON.stringify(kept));
    } catch {
      // the pins last as long as the page
    }
  }
}

function isProfile(value: unknown): value is PinnedProfile {
  const { directions, youngs, poisson } = value as Record<keyof PinnedProfile, unknown>;
  const isList = (list: unknown, holes: boolean): list is unknown[] =>
    Array.isArray(list) && list.length <= MOST_DIRECTIONS && list.every((entry) => typeof entry === "number" || (holes && entry === null));
  return isList(directions, false) && isList(youngs, true) && isList(poisson, true) && youngs.length === directions.length && poisson.length === directions.length;
}
