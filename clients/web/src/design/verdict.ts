// How close a design comes, in words that keep in mind how far its model can be trusted.
import { percent } from "../base/format";
import type { Model, Profile } from "../contract/types";
import type { ModelError, Shown } from "./shown";

/**
 * `within`: nearer to the target than the model to a simulation, or within 1 % at every sample. `doubtful`: the same, or close, by a model that is
 * not trusted at some sample.
 */
export type Verdict = "within" | "close" | "doubtful" | "out";

export interface Judgement {
  readonly verdict: Verdict;
  /** Some words for a label. */
  readonly words: string;
  /** The numbers, as a sentence. */
  readonly sentence: string;
}

/** A deviation is close up to this share of the target, or up to so many times the model's error. */
const CLOSE = 0.05;
const CLOSE_ERRORS = 3;

const WORDS: Record<Verdict, string> = { within: "Within the model’s error", close: "Close", doubtful: "Not certain", out: "Out of reach" };

type Judged = Pick<Shown, "deviation" | "reached" | "found" | "byHand" | "achieved" | "target" | "errorBar" | "inRange">;

/**
 * The two models among which the first target is chosen: the first one, and among the others the one with the shortest error bars of the
 * stress. There are only two, because the page shows nothing until both have answered.
 */
export function firstModels(models: readonly Model[]): readonly Model[] {
  const bar = ({ error_bars }: Model): number => error_bars?.stress.median ?? Infinity;
  const [first, ...others] = models;
  return others.length === 0 ? models : [first, others.reduce((best, model) => (bar(model) < bar(best) ? model : best))];
}

/** The profile of a design, which may become a target; null where the server did not answer. */
export type Offered = Pick<Profile, "y" | "error_bar" | "in_range"> | null;

/**
 * Index of the profile that has every sample in range and the shortest error bars relative to its values. A profile without error bars
 * comes after all that have them. The answer is 0 where no profile is in range.
 */
export function surestOf(profiles: readonly Offered[]): number {
  const bars = profiles.map((profile) => {
    if (!profile || profile.y.length === 0 || profile.y.includes(null) || !profile.in_range.every(Boolean)) return null;
    return barsOf({ errorBar: profile.error_bar, target: profile.y as number[] }) ?? Infinity;
  });
  return bars.reduce<number>((best, share, k) => (share !== null && (bars[best] === null || share < bars[best]) ? k : best), 0);
}

/** Root mean square of the error bars over that of the target; null where a sample has none. */
export function barsOf({ errorBar, target }: Pick<Shown, "errorBar" | "target">): number | null {
  if (!errorBar || errorBar.some((bar) => bar === null)) return null;
  const size = (values: readonly (number | null)[]) => Math.sqrt(values.reduce<number>((sum, value) => sum + (value ?? 0) ** 2, 0));
  const whole = size(target);
  return whole > 0 ? size(errorBar) / whole : null;
}

export function judge(shown: Judged, error: ModelError | null): Judgement {
  const { deviation, found, byHand } = shown;
  const bars = barsOf(shown);
  // A mean over all samples that the model was tested on says nothing about those at which it is not trusted.
  const doubtful = shown.inRange.filter((inside) => !inside).length;
  const trusted = doubtful > 0 ? null : error?.mean ?? bars;
  const complete = shown.achieved.every((value) => value !== null);
  const allReached = shown.reached.length > 0 && shown.reached.every(Boolean);
  const isWithin = allReached || (trusted !== null && deviation <= trusted);
  const isClose = isWithin || deviation <= Math.max(CLOSE, CLOSE_ERRORS * (trusted ?? 0));
  const verdict = !complete || !isClose ? "out" : doubtful > 0 ? "doubtful" : isWithin ? "within" : "close";
  const who = byHand || verdict !== "out" ? found.family : `The closest design of ${found.family} that was found`;
  const model = doubtful > 0 ? `the model is not trusted at ${doubtful} of ${shown.inRange.length} samples: verify it by simulation` : error ? `the model itself errs by ${percent(error.mean)} in the mean` : bars !== null ? `in 90 of 100 cases a simulation is within ${percent(bars)} of the model` : "how far the model errs is not known";
  return { verdict, words: WORDS[verdict], sentence: `${who} is ${percent(deviation)} from the target (root mean square); ${model}.` };
}
