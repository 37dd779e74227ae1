// The words and numbers of an atlas: places, reference profiles, what the family adds, and quantities of its samples.
import { percent } from "../base/format";
import type { AtlasPlace, AtlasProfile, AtlasSample, FamilyAtlas } from "../contract/types";

export const PLACES: readonly AtlasPlace[] = ["good", "sliver", "crossing", "closed", "unsolved"];

export const PLACE_WORDS: Record<AtlasPlace, string> = {
  good: "good",
  sliver: "narrow corner, side or strait",
  crossing: "tile crosses itself",
  closed: "beams close a hole",
  unsolved: "no stiffness",
};

/** Names of the reference profiles of stiffness, in whole and in short. */
const STIFFNESS_WORDS: Readonly<Record<string, readonly [whole: string, short: string]>> = {
  isotropic: ["Stiffness equal in all directions", "Isotropic"],
  elliptic_2: ["Stiffness 2 times as high along one axis", "Elliptic, 2"],
  elliptic_5: ["Stiffness 5 times as high along one axis", "Elliptic, 5"],
  elliptic_10: ["Stiffness 10 times as high along one axis", "Elliptic, 10"],
  soft_diagonals: ["Stiffness lower along the diagonals", "Soft diagonals"],
  stiff_diagonals: ["Stiffness higher along the diagonals", "Stiff diagonals"],
  one_way: ["Stiffness high along one axis alone", "One way"],
};

/** The name of a reference profile for a designer. */
export function profileWords(name: AtlasProfile["name"]): string {
  return wordsOf(name, 0, (value) => `Poisson’s ratio ${value} in all directions`);
}

/** The same for little room. */
export function shortProfileWords(name: AtlasProfile["name"]): string {
  return wordsOf(name, 1, (value) => `Poisson ${value}`);
}

function wordsOf(name: string, form: 0 | 1, poisson: (value: string) => string): string {
  const [kind, ...rest] = name.split("_");
  return kind === "poisson" ? poisson(rest.join("_").replace("-", "−")) : (STIFFNESS_WORDS[rest.join("_")]?.[form] ?? name.replace(/_/g, " "));
}

/** What a profile says of the family beside the others, if there are any to compare it with. */
export type Gain = "new" | "nearer" | "met" | "no";

export function gainOf({ deviation, met, others }: Pick<AtlasProfile, "deviation" | "met" | "others">): Gain {
  if (met) return others?.met === false ? "new" : "met";
  return others && deviation < others.deviation && !others.met ? "nearer" : "no";
}

export const GAIN_WORDS: Record<Gain, string> = {
  new: "Only this family meets it",
  nearer: "The nearest of all, not met",
  met: "Met",
  no: "Not met",
};

/** What the family adds, in a few sentences. */
export function gainSentences({ profiles, comparison, samples }: Pick<FamilyAtlas, "profiles" | "comparison" | "samples">): string[] {
  if (samples.every(({ stiffness }) => stiffness === null)) return ["No tiling within the bounds could be solved: narrow the bounds, or the beams."];
  const count = (gain: Gain) => profiles.filter((profile) => gainOf(profile) === gain).length;
  const [fresh, nearer, met] = [count("new"), count("nearer"), profiles.filter((profile) => profile.met).length];
  const alone = met > 0 && comparison ? `, ${fresh === 0 ? "each of which others meet, too" : `${fresh} of which no other family meets`}` : "";
  const sentences = [`The family meets ${met === 0 ? "none" : met} of ${profiles.length} reference profiles at rest${alone}.`];
  if (nearer > 0) sentences.push(`It comes nearer than all others to ${nearer} ${met > 0 ? "further " : ""}one${nearer === 1 ? "" : "s"}.`);
  if (comparison?.same_as) sentences.push(`It is the same as ${comparison.same_as} under another name.`);
  else if (comparison) sentences.push(`${percent(comparison.new_fraction)} of its tilings are far from those of ${comparison.families.length} other families.`);
  return sentences;
}

/** A number of a sample that can be drawn along an axis. */
export interface Quantity {
  readonly id: string;
  readonly words: string;
  readonly isLogarithmic: boolean;
  /** Null for a sample that has none. */
  readonly of: (sample: AtlasSample) => number | null;
}

export const QUANTITIES: readonly Quantity[] = [
  { id: "poisson-low", words: "Lowest Poisson’s ratio", isLogarithmic: false, of: ({ poisson_ratio }) => poisson_ratio?.[0] ?? null },
  { id: "poisson-high", words: "Highest Poisson’s ratio", isLogarithmic: false, of: ({ poisson_ratio }) => poisson_ratio?.[1] ?? null },
  { id: "anisotropy", words: "Highest over lowest stiffness", isLogarithmic: true, of: ({ stiffness }) => (stiffness && stiffness[0] > 0 ? stiffness[1] / stiffness[0] : null) },
  { id: "stiffness-low", words: "Lowest stiffness (MPa)", isLogarithmic: true, of: ({ stiffness }) => (stiffness && stiffness[0] > 0 ? stiffness[0] : null) },
  { id: "stiffness-high", words: "Highest stiffness (MPa)", isLogarithmic: true, of: ({ stiffness }) => stiffness?.[1] ?? null },
  { id: "density", words: "Relative density", isLogarithmic: false, of: ({ relative_density }) => (relative_density > 0 ? relative_density : null) },
];

/** The parameters of a family as quantities, which other families do not have. */
export function parameterQuantities(names: readonly string[]): Quantity[] {
  return names.map((words, k) => ({ id: `parameter-${k}`, words, isLogarithmic: false, of: ({ parameters }) => parameters[k] ?? null }));
}
