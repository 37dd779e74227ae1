// Effects in a designer's words: what each one is, and what it found. The bill has the same effects in the words of the contract.
import type { Effect, EffectSwitch } from "../contract/types";
import { percent } from "./format";
import { errorWords } from "./accuracy_words";

/**
 * What a chip tells. `clear`: it was looked for and is not there, or its error is small. `found`: it is there, or its error is not small.
 * `done`: it was computed. `idle`: it was not computed, so that nothing is known of it.
 */
export type ChipTone = "clear" | "found" | "done" | "idle";

export interface Chip {
  /** Name of the effect in the contract. */
  readonly effect: string;
  readonly name: string;
  readonly words: string;
  readonly tone: ChipTone;
  /** Why, in a sentence. */
  readonly why: string;
  /** Its switch; null where a request has none. */
  readonly setting: EffectSwitch | null;
}

interface EffectWords {
  readonly name: string;
  /** Where it ran; `count`: how often. */
  readonly ran: string | ((count: number) => string);
  /** Where it did not, though nobody has switched it off. */
  readonly not: string;
  /** Whether it is something that was looked for and not found where it did not run; otherwise it was not computed. */
  readonly isSought?: boolean;
  /** Whether it has no chip where it did not run. */
  readonly isRare?: boolean;
  /** Whether the request decides, so that "the request" is no reason for an effect that was not computed. */
  readonly isAsked?: boolean;
}

const times = (count: number, one: string, several: string): string => (count === 1 ? `1 ${one}` : `${count.toLocaleString("en")} ${several}`);

/** Effects without an entry have no chip. */
const EFFECT_WORDS: Readonly<Record<string, EffectWords>> = {
  // structures
  buckling: { name: "buckling", ran: "found and followed", not: "checked, none", isSought: true },
  contact: { name: "contact", ran: "beams touch", not: "not needed" },
  patch: { name: "neighbouring cells", ran: "buckle together", not: "checked, all alike", isSought: true },
  refinement: { name: "finer mesh", ran: "compared", not: "not compared" },
  // designs
  verification: { name: "simulation", ran: "done", not: "not asked for" },
  polish: { name: "correction by simulation", ran: (count) => times(count, "round", "rounds"), not: "not needed", isRare: true },
  multi_start: { name: "further starts", ran: (count) => (count > 0 ? `${count.toLocaleString("en")} tried` : "tried"), not: "not needed" },
  trust: { name: "surer designs", ran: "one was chosen", not: "checked, none better", isSought: true },
  envelope: { name: "reachable range", ran: "shown", not: "not computed" },
  ways_out: { name: "ways out", ran: (count) => times(count, "tried", "tried"), not: "not needed", isRare: true },
  limits: { name: "limits", ran: "kept", not: "none", isRare: true },
  error_bars: { name: "model’s error bars", ran: "known", not: "not known" },
  // weaves
  out_of_plane: { name: "out of the plane", ran: "leaves it", not: "checked, stays flat", isSought: true },
  at_sliding_limits: { name: "ends of sliding", ran: "reached", not: "checked, not reached", isSought: true },
  crossings_in_contact: { name: "crossings that touch", ran: "some do", not: "checked, none", isSought: true },
  error_estimate: { name: "estimate of the error", ran: "done", not: "not done" },
  // surfaces
  approximation: { name: "distances", ran: "approximate", not: "exact", isSought: true, isAsked: true },
  distance_limit: { name: "limit of distance", ran: "kept", not: "none", isRare: true },
  kept_fields: { name: "stored distance fields", ran: "used", not: "not needed" },
  mollifier: { name: "smoothing next to vertices", ran: "used", not: "not needed" },
  kept_strips: { name: "paths kept from step to step", ran: "used", not: "not used" },
  membrane: { name: "membrane", ran: "computed", not: "none", isRare: true },
  shell_bending: { name: "bending of the shell", ran: "computed", not: "none", isRare: true },
  shell_volume: { name: "enclosed volume", ran: "kept", not: "none", isRare: true },
  gravity: { name: "weight of the solid", ran: "computed", not: "none", isRare: true },
  self_contact: { name: "contact of the host with itself", ran: "checked", not: "not checked" },
  moved_vertices: { name: "moved supports", ran: "followed", not: "none", isRare: true },
};

/** Reasons of effects that nobody has computed, because a request switched them off or did not ask for them. */
const SWITCHED_OFF = /switched off|turns? it off|asked not to|leaves it out/;
const NOT_ASKED = /^the request |are corrected where they are verified/;

export const SETTING_WORDS: Record<EffectSwitch, string> = { automatic: "where needed", on: "always", off: "never" };

/** The setting after a press: where needed, always, never, and again where needed. */
export function nextSetting(setting: EffectSwitch): EffectSwitch {
  return setting === "automatic" ? "on" : setting === "on" ? "off" : "automatic";
}

/** The name of an effect for a designer; its name in the contract if it has no chip. */
export function effectName(effect: string): string {
  return EFFECT_WORDS[effect]?.name ?? effect.replace(/_/g, " ");
}

/** The chip of an effect of an answer; null if it has none. `setting`: its switch, null where a request has none. */
export function effectChip({ name: effect, ran, why, count }: Effect, setting: EffectSwitch | null = null): Chip | null {
  const known = EFFECT_WORDS[effect];
  if (!known || (known.isRare && !ran && setting === null)) return null;
  const { name, isSought, isAsked } = known;
  const chip = { effect, name, why: sentenceOf(why), setting };
  if (ran) return { ...chip, words: typeof known.ran === "string" ? known.ran : known.ran(count), tone: isSought ? "found" : "done" };
  if (SWITCHED_OFF.test(why)) return { ...chip, words: "switched off", tone: "idle" };
  if (NOT_ASKED.test(why) && !isAsked) return { ...chip, words: isSought ? "not checked" : known.not, tone: "idle" };
  return { ...chip, words: known.not, tone: isSought ? "clear" : "idle" };
}

/** The chip of an effect that can be switched but of which no answer has told yet. */
function unknownChip(effect: string, setting: EffectSwitch): Chip {
  return { effect, name: effectName(effect), words: setting === "off" ? "switched off" : "not computed yet", tone: "idle", why: "", setting };
}

/** Settings of effects by their names, in the order of their chips. */
export type Settings = Readonly<Record<string, EffectSwitch>>;

/** The chips of an answer: those of its errors, of the effects that can be switched, and of the others. Without an answer those that can be switched. */
export function chipsOf(effects: readonly Effect[], settings: Settings, accuracy: Readonly<Record<string, unknown>> = {}): Chip[] {
  const switched = Object.entries(settings).map(([name, setting]) => {
    const effect = effects.find((one) => one.name === name);
    return (effect && effectChip(effect, setting)) ?? unknownChip(name, setting);
  });
  const others = effects.filter(({ name }) => !(name in settings)).map((effect) => effectChip(effect)).filter((chip): chip is Chip => chip !== null);
  return [...errorChips(accuracy), ...switched, ...others];
}

/** Chips of an answer to an earlier state: what they tell is not known of the present one. */
export function outdated(chips: readonly Chip[]): Chip[] {
  return chips.map((chip) => ({ ...chip, tone: "idle" }));
}

/** Errors up to this are small. */
const SMALL_ERROR = 0.05;

/** The chip of an error; `undefined`: the answer does not tell of it, null: it is not known. */
export function errorChip(effect: string, name: string, error: number | null | undefined): Chip[] {
  if (error === undefined) return [];
  const chip = { effect, name, setting: null };
  if (error === null) return [{ ...chip, words: "not estimated", tone: "idle", why: "The answer does not say by how much it errs." }];
  const words = errorWords(error).replace(/±\s/, "±");
  return [{
    ...chip,
    words,
    tone: error <= SMALL_ERROR ? "clear" : "found",
    why: error <= SMALL_ERROR ? "The error is small." : `The error is more than ${percent(SMALL_ERROR)}.`,
  }];
}

/** The errors that an answer states. Weaves have several, of which that of the modulus counts, or that of the forces on a sheet. */
function errorChips(accuracy: Readonly<Record<string, unknown>>): Chip[] {
  const { discretization_error: found } = accuracy;
  const { youngs_modulus, reactions } = (typeof found === "object" && found !== null ? found : {}) as Readonly<Record<string, unknown>>;
  const error = typeof found === "object" && found !== null ? (youngs_modulus ?? reactions) : found;
  return errorChip("discretization", "discretization", error === null || typeof error === "number" ? error : undefined);
}

function sentenceOf(why: string): string {
  return why === "" ? "" : `${why[0].toUpperCase()}${why.slice(1)}.`;
}
