// Pinned weaves: their curves, at the strain at which they were pinned, are drawn for comparison, and their states can be restored.
import { Observable } from "../base/observable";
import { percent } from "../base/format";
import { readLink, writeLink } from "./link";
import type { Profile } from "./profile";
import { profileKey, type WeaveSession } from "./session";
import { weaveWords, type WeaveState } from "./state";

const KEY = "supple-weave-pins";
const MAX_PINS = 12;
const MAX_DIRECTIONS = 2000;

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

  /** Loads the pins from the browser's storage. */
  restore(): void {
    try {
      const stored = JSON.parse(localStorage.getItem(KEY) ?? "[]") as { name: string; link: string; profile: unknown }[];
      for (const { name, link, profile } of stored.slice(0, MAX_PINS)) {
        const state = readLink(link);
        if (state && isProfile(profile)) this.insert(String(name).slice(0, 120), state, profile);
      }
    } catch {
      // the stored text is of another version, or storage is blocked: the list stays empty
    }
  }

  /** Pins the present weave. Returns false if its profile is not known yet, or if there are too many pins. */
  add(): boolean {
    const state = this.session.state.get();
    const profile = this.session.profile.get();
    if (!profile || profile.key !== profileKey(state) || this.list.get().length >= MAX_PINS) return false;
    const { directions, youngs, poisson } = profile;
    this.insert(`${weaveWords(state)}, ${percent(state.strain)}`, state, { directions, youngs, poisson });
    this.store();
    return true;
  }

  remove(id: number): void {
    this.list.set(this.list.get().filter((pin) => pin.id !== id));
    this.store();
  }

  show(pin: Pin): void {
    this.session.apply(pin.state);
  }

  private insert(name: string, state: WeaveState, profile: PinnedProfile): void {
    this.list.set([...this.list.get(), { id: this.nextId++, name, state, profile }]);
  }

  private store(): void {
    const rounded = (values: readonly (number | null)[]) => values.map((value) => value && Number(value.toPrecision(5)));
    try {
      const stored = this.list.get().map(({ name, state, profile: { directions, youngs, poisson } }) => ({
        name,
        link: writeLink(state),
        profile: { directions, youngs: rounded(youngs), poisson: rounded(poisson) },
      }));
      localStorage.setItem(KEY, JSON.stringify(stored));
    } catch {
      // storage is blocked: the pins last as long as the page
    }
  }
}

function isProfile(value: unknown): value is PinnedProfile {
  const { directions, youngs, poisson } = value as Record<keyof PinnedProfile, unknown>;
  const isList = (list: unknown, holes: boolean): list is unknown[] =>
    Array.isArray(list) && list.length <= MAX_DIRECTIONS && list.every((entry) => typeof entry === "number" || (holes && entry === null));
  return isList(directions, false) && isList(youngs, true) && isList(poisson, true) && youngs.length === directions.length && poisson.length === directions.length;
}
