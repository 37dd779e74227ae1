// The choice of accuracy: a level or values of one's own, and the effects that were switched on or off. It is part of a page's state.
import type { EffectSwitch } from "../contract/types";
import type { Capability } from "./accuracy_levels";
import { choiceOf, type Fields, readValues, writeValues } from "./link_fields";

export type Level = "draft" | "normal" | "sure";

export interface AccuracyChoice {
  /** `own`: the values that the page's own controls set. */
  readonly level: Level | "own";
  /** Effects that do not decide by themselves whether they run. */
  readonly switches: Readonly<Record<string, "on" | "off">>;
}

export const NORMAL: AccuracyChoice = { level: "normal", switches: {} };

/** The effects that a page switches, by what is computed. */
export const SWITCHED_EFFECTS: Readonly<Partial<Record<Capability, readonly string[]>>> = {
  designs: ["multi_start", "trust", "envelope"],
  weaves: ["buckling", "error_estimate"],
};

/** The switches of a choice that belong to what is computed. */
export function switchesOf({ switches }: AccuracyChoice, capability: Capability): AccuracyChoice["switches"] {
  const names = SWITCHED_EFFECTS[capability] ?? [];
  return Object.fromEntries(Object.entries(switches).filter(([name]) => names.includes(name)));
}

export function withSwitch(choice: AccuracyChoice, name: string, value: EffectSwitch): AccuracyChoice {
  const { [name]: _, ...others } = choice.switches;
  return { ...choice, switches: value === "automatic" ? others : { ...others, [name]: value } };
}

/** The fields of a link. `usual`: the level of a link that names none. */
export function writeChoice({ level, switches }: AccuracyChoice, usual: AccuracyChoice["level"] = "normal"): [string, string][] {
  return [
    ...(level === usual ? [] : [["accuracy", level] as [string, string]]),
    ...(Object.keys(switches).length > 0 ? [["effects", writeValues(switches)] as [string, string]] : []),
  ];
}

export function readChoice(fields: Fields, usual: AccuracyChoice["level"] = "normal"): AccuracyChoice {
  const level = choiceOf(fields.get("accuracy"), ["draft", "normal", "sure", "own"] as const, usual);
  const names = Object.values(SWITCHED_EFFECTS).flat();
  const values = [...readValues(fields.get("effects") ?? "", [])].filter(([name, value]) => names.includes(name) && ["on", "off"].includes(value));
  return { level, switches: Object.fromEntries(values) as AccuracyChoice["switches"] };
}

const KEY = "supple-accuracy";

/** The level with which a part of the editor opens without a link: the one that was chosen there last. */
export function rememberedLevel(place: string): Level {
  try {
    return choiceOf(localStorage.getItem(`${KEY}-${place}`) ?? undefined, ["draft", "normal", "sure"] as const, "normal");
  } catch {
    return "normal"; // storage is blocked
  }
}

/** Remembers a level. Values of one's own belong to one state, so that the level before them is kept. */
export function rememberLevel(place: string, level: AccuracyChoice["level"]): void {
  if (level === "own") return;
  try {
    if (level === "normal") localStorage.removeItem(`${KEY}-${place}`);
    else localStorage.setItem(`${KEY}-${place}`, level);
  } catch {
    // storage is blocked: the choice lasts as long as the page
  }
}
