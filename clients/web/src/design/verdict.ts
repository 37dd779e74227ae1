// The judgement of a design: by its simulation wherever there is one, otherwise by the model, whose trust and error count.
import type { Curve } from "../base/curve";
import type { Model, Profile } from "../contract/types";
import type { ModelError, TargetResponse } from "./shown";
import { targetCurve } from "./spline";
import { isPolar } from "./state";
import { deviationOf, fitRanges, type JudgedCurve, reachedSamples } from "./verdict_ranges";
import { deviationWords, type Doubt, type TargetVerdict, type VerdictFacts, verdictSentence } from "./verdict_sentence";
import { type Grade, gradeWords, limits, type Source, words } from "./verdict_words";

/** The judgement of a design against one target, or against several. */
export interface Judgement {
  readonly grade: Grade;
  readonly source: Source;
  /** Relative root mean square deviation from the worst target, of the simulation where there is one; null if a value is missing. */
  readonly deviation: number | null;
  /** Whether a model's deviation is below its error, and this error small against the target. */
  readonly isWithinError: boolean;
  /** A label. */
  readonly words: string;
  /** The verdict in words. */
  readonly sentence: string;
  /** What no material can have at rest of the targets that are missed, in words; empty if it is not known or there is nothing. */
  readonly bound: string;
}

/** Errors of a model up to this fraction of the target are small. */
const SMALL_ERROR = 0.05;

type JudgedResponse = Pick<TargetResponse, "x" | "achieved" | "target" | "errorBar" | "inRange" | "task" | "points" | "interpolation" | "bound" | "answered">;

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

/** A response with what judges it: the model's error and the simulated curve, null if there is none. */
export interface JudgedEvidence {
  readonly shown: JudgedResponse;
  readonly error: ModelError | null;
  readonly simulated: Curve | null;
}

/** The judgement of one response. */
export function judge(shown: JudgedResponse, error: ModelError | null, simulated: Curve | null = null): Judgement {
  return judgeAll([{ shown, error, simulated }]);
}

/** What is known of a design and one of its targets. */
export interface CurveEvidence {
  readonly model: JudgedCurve;
  /** Null if it was not simulated. */
  readonly simulated: JudgedCurve | null;
  /** Whether the model is trusted at each of its samples. */
  readonly inRange: readonly boolean[];
}

/**
 * The facts of a verdict on a design: the worst of its targets decides. It is by simulation if all of them are simulated. If only some are,
 * one of them that is not reached outranks what the model says, unless the model is certain to miss another one by more.
 */
export function verdictFacts(all: readonly CurveEvidence[]): VerdictFacts {
  const byModel = factsBy("model", all);
  if (all.every(({ simulated }) => simulated === null)) return byModel;
  const simulated = factsBy("simulation", all);
  if (all.every(isSimulated)) return simulated;
  const isOutranked = byModel.grade !== "unknown" && !isSimulated(all[indexOfWorst(simulated.targets)]);
  return simulated.grade === "reached" || isOutranked ? byModel : simulated;
}

function isSimulated({ simulated }: CurveEvidence): boolean {
  return simulated !== null;
}

/** The facts by one source. A target that was not simulated has its verdict by the model, which does not decide if the source is a simulation. */
function factsBy(source: Source, all: readonly CurveEvidence[]): VerdictFacts {
  const targets = all.map(({ model, simulated }) => targetVerdict(source === "simulation" && simulated ? simulated : model));
  const deciding = targets.filter((_, k) => source === "model" || isSimulated(all[k]));
  const worst = targets.indexOf(deciding[indexOfWorst(deciding)]);
  const { deviation } = targets[worst];
  const doubt = doubtAbout(all, deciding, source);
  const byModel = all.map(({ model }) => deviationOf(model));
  return {
    grade: doubt === "none" && deviation !== null ? gradeOf(deviation, targets[worst]) : "unknown",
    source,
    doubt,
    deviation,
    modelDeviation: byModel.includes(null) ? null : Math.max(...(byModel as number[])),
    untrusted: all.reduce((sum, { inRange }) => sum + untrusted(inRange), 0),
    samples: all.reduce((sum, { inRange }) => sum + inRange.length, 0),
    targets,
    worst,
  };
}

/** The judgement of the responses to all targets. */
export function judgeAll(all: readonly JudgedEvidence[]): Judgement {
  const facts = verdictFacts(
    all.map(({ shown, simulated }) => ({ model: modelCurve(shown), simulated: simulated && simulatedCurve(shown, simulated), inRange: shown.inRange })),
  );
  const { grade, source, deviation } = facts;
  const isWithinError = grade === "reached" && source === "model" && all.every(isWithinItsError);
  const { answered } = all[0].shown;
  // The server knows more of a target than the page. It has no say where both disagree, since the page may have a simulation of its own.
  const isAnswered = answered && answered.grade === grade && answered.source === source && deviationWords(answered.deviation) === deviationWords(deviation);
  return {
    grade,
    source,
    deviation,
    isWithinError,
    words: isWithinError ? "Within the model’s error" : source === "simulation" ? `${words.source.simulation}: ${gradeWords(grade).toLowerCase()}` : gradeWords(grade),
    sentence: isAnswered ? answered.sentence : verdictSentence(facts),
    bound: grade === "reached" ? "" : (all.map(({ shown }) => shown.bound?.sentence).find((words) => words) ?? ""),
  };
}

function gradeOf(deviation: number, { isReached }: TargetVerdict): Grade {
  return isReached ? "reached" : deviation <= limits.close ? "close" : "missed";
}

/** The simulated deviation from a target; null if the simulation does not get to every sample. */
export function simulatedDeviation(shown: Pick<TargetResponse, "task" | "points" | "interpolation">, simulated: Curve): number | null {
  return deviationOf(simulatedCurve(shown, simulated));
}

function simulatedCurve({ task, points, interpolation }: Pick<TargetResponse, "task" | "points" | "interpolation">, { x, y }: Curve): JudgedCurve {
  return { task, x, target: x.map(targetCurve(isPolar(task), points, interpolation)), y };
}

function modelCurve({ task, x, target, achieved }: JudgedResponse): JudgedCurve {
  return { task, x, target, y: achieved };
}

function targetVerdict(curve: JudgedCurve): TargetVerdict {
  const [samples, reached, deviation] = [curve.x.length, reachedSamples(curve), deviationOf(curve)];
  const isReached = deviation !== null && (deviation <= limits.reached || reached === samples);
  return { task: curve.task, samples, reached, deviation, ranges: fitRanges(curve), isReached };
}

/** A target that is reached is never the worst beside one that is not. */
function indexOfWorst(targets: readonly TargetVerdict[]): number {
  const size = ({ deviation }: TargetVerdict) => deviation ?? Infinity;
  const isWorse = (a: TargetVerdict, b: TargetVerdict) => (a.isReached === b.isReached ? size(a) > size(b) : b.isReached);
  return targets.reduce((worst, target, k) => (isWorse(target, targets[worst]) ? k : worst), 0);
}

function untrusted(inRange: readonly boolean[]): number {
  return inRange.filter((inside) => !inside).length;
}

function doubtAbout(all: readonly CurveEvidence[], targets: readonly TargetVerdict[], source: Source): Doubt {
  if (targets.some(({ deviation }) => deviation === null)) {
    return targets.every(({ ranges }) => ranges.every(({ fit }) => fit === "missing")) ? "nothing" : "incomplete";
  }
  const isMostlyUntrusted = all.some(({ inRange }) => inRange.length > 0 && untrusted(inRange) >= limits.untrusted * inRange.length);
  return source === "model" && isMostlyUntrusted ? "untrusted" : "none";
}

/**
 * Whether a deviation is below the error of the model, and this error small against the target. Error bars are those of this design; the
 * mean is that of all designs on which the model was tried, and holds where the model is trusted.
 */
function isWithinItsError({ shown, error }: JudgedEvidence): boolean {
  const bar = relativeErrorBars(shown) ?? (untrusted(shown.inRange) > 0 ? null : (error?.mean ?? null));
  const deviation = deviationOf(modelCurve(shown));
  return bar !== null && bar <= SMALL_ERROR && deviation !== null && deviation <= bar;
}
