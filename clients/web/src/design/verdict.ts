// The judgement of a deviation, which takes the error of the model into account.
import { percent } from "../base/format";
import type { Model, Profile } from "../contract/types";
import type { ModelError, TargetResponse } from "./shown";

/**
 * `within`: the deviation is below the error of the model, or every sample is reached. `doubtful`: within or close, but the model is not
 * trusted at some sample.
 */
export type Verdict = "within" | "close" | "doubtful" | "out";

export interface Judgement {
  readonly verdict: Verdict;
  /** A label. */
  readonly words: string;
  /** A sentence with the numbers. */
  readonly sentence: string;
}

/** A design is close up to this relative deviation, or up to this multiple of the model's error. */
const CLOSE_DEVIATION = 0.05;
const CLOSE_ERROR_FACTOR = 3;

const WORDS: Record<Verdict, string> = { within: "Within the model’s error", close: "Close", doubtful: "Not certain", out: "Out of reach" };

type JudgedResponse = Pick<TargetResponse, "deviation" | "reached" | "found" | "byHand" | "achieved" | "target" | "errorBar" | "inRange">;

/**
 * The two models from which the initial target is made: the first one, and the one of the others with the shortest error bars of the
 * stress. There are only two, because the page shows nothing until both profiles have arrived.
 */
export function firstModels(models: readonly Model[]): readonly Model[] {
  const bar = ({ error_bars }: Model): number => error_bars?.stress.median ?? Infinity;
  const [first, ...others] = models;
  return others.length === 0 ? models : [first, others.reduce((best, model) => (bar(model) < bar(best) ? model : best))];
}

/** The profile of a design that may become the initial target; null if the server did not answer. */
export type OfferedProfile = Pick<Profile, "y" | "error_bar" | "in_range"> | null;

/**
 * Index of the profile with the shortest error bars relative to its values, among those that have every sample in range. Profiles without
 * error bars come last. Returns 0 if no profile is in range.
 */
export function indexOfMostReliable(profiles: readonly OfferedProfile[]): number {
  const bars = profiles.map((profile) => {
    if (!profile || profile.y.length === 0 || profile.y.includes(null) || !profile.in_range.every(Boolean)) return null;
    return relativeErrorBars({ errorBar: profile.error_bar, target: profile.y as number[] }) ?? Infinity;
  });
  return bars.reduce<number>((best, ratio, k) => (ratio !== null && (bars[best] === null || ratio < bars[best]) ? k : best), 0);
}

/** Root mean square of the error bars over that of the target; null if a sample has no error bar. */
export function relativeErrorBars({ errorBar, target }: Pick<TargetResponse, "errorBar" | "target">): number | null {
  if (!errorBar || errorBar.some((bar) => bar === null)) return null;
  const size = (values: readonly (number | null)[]) => Math.sqrt(values.reduce<number>((sum, value) => sum + (value ?? 0) ** 2, 0));
  const norm = size(target);
  return norm > 0 ? size(errorBar) / norm : null;
}

export function judge(shown: JudgedResponse, error: ModelError | null): Judgement {
  const { deviation, found, byHand } = shown;
  const bars = relativeErrorBars(shown);
  // The mean error of a model does not apply to samples at which the model is not trusted.
  const doubtful = shown.inRange.filter((inside) => !inside).length;
  const trusted = doubtful > 0 ? null : error?.mean ?? bars;
  const complete = shown.achieved.every((value) => value !== null);
  const allReached = shown.reached.length > 0 && shown.reached.every(Boolean);
  const isWithin = allReached || (trusted !== null && deviation <= trusted);
  const isClose = isWithin || deviation <= Math.max(CLOSE_DEVIATION, CLOSE_ERROR_FACTOR * (trusted ?? 0));
  const verdict = !complete || !isClose ? "out" : doubtful > 0 ? "doubtful" : isWithin ? "within" : "close";
  const who = byHand || verdict !== "out" ? found.family : `The closest design of ${found.family} that was found`;
  const model = doubtful > 0 ? `the model is not trusted at ${doubtful} of ${shown.inRange.length} samples: verify it by simulation`
    : error ? `the model itself errs by ${percent(error.mean)} in the mean`
    : bars !== null ? `in 90 of 100 cases a simulation is within ${percent(bars)} of the model` : "how far the model errs is not known";
  return { verdict, words: WORDS[verdict], sentence: `${who} is ${percent(deviation)} from the target (root mean square); ${model}.` };
}
