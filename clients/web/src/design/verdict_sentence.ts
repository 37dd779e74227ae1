// A verdict in the words of the table, as the server writes it.
import type { Task } from "../contract/types";
import { badness, type FitRange, joinedAcrossPeriod, joinedDeviation } from "./verdict_ranges";
import { filled, type Grade, type Heading, limits, type Source, words } from "./verdict_words";

/** Why a grade is unknown. */
export type Doubt = "none" | "untrusted" | "incomplete" | "nothing";

export interface TargetVerdict {
  readonly task: Task;
  readonly samples: number;
  /** Number of samples that are reached. */
  readonly reached: number;
  readonly deviation: number | null;
  readonly ranges: readonly FitRange[];
  /** Whether it is reached as a whole: by its deviation, or because each sample is reached. */
  readonly isReached: boolean;
}

export interface VerdictFacts {
  readonly grade: Grade;
  readonly source: Source;
  readonly doubt: Doubt;
  readonly deviation: number | null;
  readonly modelDeviation: number | null;
  /** Numbers of samples of all targets at which the model is not trusted, and of all of them. */
  readonly untrusted: number;
  readonly samples: number;
  readonly targets: readonly TargetVerdict[];
  /** Index of the target that decides. */
  readonly worst: number;
}

const SIGNIFICANT_DIGITS = 2;
/** With two, 145 degrees would be 150. */
const DIRECTION_DIGITS = 3;
/** Digits that tell the ends of a range apart are enough if they are as many. */
const MAX_SIGNIFICANT_DIGITS = 6;
/** Percentages and degrees of a smaller magnitude are 0, which samples near rest miss by rounding. */
const MIN_MAGNITUDE = 1e-4;
/** A smaller deviation has no number in words, %. */
const MIN_DEVIATION_IN_WORDS = 0.05;

/** Rounds to significant digits; half is rounded away from zero. */
function rounded(value: number, digits: number): number {
  if (Math.abs(value) < MIN_MAGNITUDE) return 0;
  const exponent = digits - 1 - Math.floor(Math.log10(Math.abs(value)));
  const power = 10 ** Math.abs(exponent);
  const size = Math.abs(value);
  return Math.sign(value) * (exponent >= 0 ? Math.round(size * power) / power : Math.round(size / power) * power);
}

const numberText = (value: number): string => String(Number(value.toPrecision(MAX_SIGNIFICANT_DIGITS)));

/** A deviation in percent. */
export function deviationWords(deviation: number | null): string {
  if (deviation === null) return "";
  const value = 100 * deviation;
  return value < MIN_DEVIATION_IN_WORDS ? words.percent.tiny : filled(words.percent.value, { value: numberText(rounded(value, SIGNIFICANT_DIGITS)) });
}

/** Whether a range is so narrow that its middle says where it is. */
function isAroundDirection({ part, from, to }: FitRange): boolean {
  return part === "directions" && ((to - from) * 180) / Math.PI <= limits.around;
}

/**
 * The ends of a range in percent or degrees, without the unit, with the digits that tell them apart. `followsAround`: whether the range before
 * it in the same clause is around a direction.
 */
function barePlaceOf(range: FitRange, followsAround: boolean): string {
  const isDirection = range.part === "directions";
  const [begin, end] = [range.from, range.to].map((value) => value * (isDirection ? 180 / Math.PI : 100));
  if (isAroundDirection(range)) {
    const middle = rounded(((begin + end) / 2 + 180) % 180, DIRECTION_DIGITS);
    return filled(followsAround ? words.place.next_around : words.place.around, { middle: numberText(middle >= 180 ? 0 : middle) });
  }
  let digits = isDirection ? DIRECTION_DIGITS : SIGNIFICANT_DIGITS;
  while (digits < MAX_SIGNIFICANT_DIGITS && rounded(begin, digits) === rounded(end, digits)) ++digits;
  return filled(words.place.range, { from: numberText(rounded(begin, digits)), to: numberText(rounded(end, digits)) });
}

/** Where ranges of one part are. */
function placeOf(ranges: readonly FitRange[]): string {
  let places = "";
  ranges.forEach((range, k) => {
    const next = barePlaceOf(range, k > 0 && isAroundDirection(ranges[k - 1]));
    places = k === 0 ? next : filled(words.place.several, { before: places, next });
  });
  return filled(ranges[0].part === "directions" ? words.place.in_degrees : words.place.in_percent, { places });
}

/** One sentence with a clause for the ranges of each part that are met equally well, the best first. */
function rangesSentence(ranges: readonly FitRange[]): string {
  const groups: FitRange[][] = [];
  for (const range of ranges) {
    const same = groups.find(([first]) => first.fit === range.fit && first.part === range.part);
    if (same) same.push(range);
    else groups.push([range]);
  }
  const clauses = groups.sort(([a], [b]) => badness(a.fit) - badness(b.fit)).map((group) =>
    filled(words.range[group[0].fit], { part: words.part[group[0].part], place: placeOf(group), deviation: deviationWords(joinedDeviation(group)) })
  );
  const sentence = clauses.join(", ");
  return `${sentence[0].toUpperCase()}${sentence.slice(1)}.`;
}

/** A sentence about the ranges of a target; empty if its deviation says everything. */
function targetSentence({ task, ranges: all, reached, samples }: TargetVerdict): string {
  const ranges = joinedAcrossPeriod(all, task);
  if (!ranges.some(({ fit }) => fit === "missed" || fit === "missing")) return "";
  if (ranges.length === 1) return ranges[0].fit === "missed" ? words.further.nothing_reached : "";
  if (ranges.length <= limits.ranges) return rangesSentence(ranges);
  const worst = ranges.reduce((most, range) => ((range.deviation ?? 0) > (most.deviation ?? 0) ? range : most));
  return filled(words.further.many_ranges, { reached, samples, place: placeOf([worst]), deviation: deviationWords(worst.deviation) });
}

function headingOf({ grade, doubt, deviation }: VerdictFacts): Heading {
  if (doubt !== "none") return doubt;
  // Poisson's ratios near 0 are reached although they are far off relative to the target.
  if (grade === "reached" && (deviation ?? 0) > limits.reached) return "reached_within";
  return grade === "reached" || grade === "close" ? grade : "missed";
}

function trustSentence({ source, doubt, untrusted, samples }: VerdictFacts): string {
  if (source === "simulation" || untrusted === 0) return "";
  return filled(doubt === "untrusted" ? words.further.most_untrusted : words.further.some_untrusted, { untrusted, samples });
}

/** For example "Simulated: 45 % off. The plateau is reached from 8 to 20 %, the rise is missed from 0 to 8 % (62 % off)." */
export function verdictSentence(verdict: VerdictFacts): string {
  const { source, doubt, deviation, modelDeviation, targets, worst } = verdict;
  const sentences = [filled(words.heading[headingOf(verdict)], { source: words.source[source], deviation: deviationWords(deviation), tolerance: limits.poisson_sample })];
  if (doubt === "nothing") {
    if (modelDeviation !== null) sentences.push(filled(words.further.by_model, { deviation: deviationWords(modelDeviation) }));
  } else if (doubt !== "untrusted") {
    const about = targetSentence(targets[worst]);
    if (about !== "" && targets.length > 1) sentences.push(filled(words.further.worst_target, { count: targets.length, number: worst + 1 }));
    sentences.push(about);
  }
  sentences.push(trustSentence(verdict));
  return sentences.filter((sentence) => sentence !== "").join(" ");
}
