// Accuracy in words: seconds and errors of the dial, and errors beside the numbers that they belong to.
import type { AccuracyChoice } from "./accuracy_choice";
import type { Capability, Estimate } from "./accuracy_levels";
import { percent, seconds } from "./format";

/** Errors below this are those of rounding. */
const EXACT = 1e-9;

/** A space at which no line breaks. */
const UNBROKEN = "\u00a0";

/** "± 0.4 %" with spaces at which no line breaks, or "exact" where nothing but rounding is left; empty where the error is not known. */
export function errorWords(error: number | null | undefined): string {
  if (error === null || error === undefined || !Number.isFinite(error)) return "";
  return Math.abs(error) < EXACT ? "exact" : `± ${percent(Math.abs(error) < 1e-4 ? Number(error.toPrecision(1)) : error)}`.replaceAll(" ", UNBROKEN);
}

/** A number in words with its error beside it, if that is known and more than rounding. */
export function withError(words: string, error: number | null | undefined): string {
  const told = errorWords(error);
  return told === "" || told === "exact" ? words : `${words} ${told}`;
}

export function secondsWords({ seconds: time, source }: Pick<Estimate, "seconds" | "source">): string {
  if (time === null) return "";
  return source === "measured" ? seconds(time) : `≈ ${seconds(Number(time.toPrecision(2)))}`;
}

const SOURCE_WORDS: Record<Estimate["source"], string> = {
  measured: "as measured here",
  scaled: "by what was computed here",
  table: "by the benchmarks",
};

/** What is computed, in the sentence of the dial. */
export const CAPABILITY_WORDS: Record<Capability, string> = {
  designs: "Search",
  simulations: "Deformed patch",
  networks: "Relaxation",
  hosts: "Relaxation with its host",
  voronoi: "Diagram",
  voronoi_optimizations: "Optimization",
  weaves: "Stiffness",
  geodesics: "Distances",
};

/** The error of a level. Where that of the surest one is unknown, there is nothing more exact to compare it with. */
export function levelErrorWords(level: AccuracyChoice["level"], error: number | null): string {
  return error === null && level === "sure" ? "most exact" : errorWords(error);
}

/** A sentence of the dial, such as "Stiffness: 0.4 s as measured here, ± 9 % (error of Young's modulus)." */
export function estimateSentence(capability: Capability, level: AccuracyChoice["level"], known: Estimate, errorOf: string): string {
  const time = secondsWords(known);
  if (known.error === null && level === "sure") return `${CAPABILITY_WORDS[capability]}: ${time ? `${time} ${SOURCE_WORDS[known.source]}, ` : ""}the most exact setting.`;
  const error = errorWords(known.error);
  const where = known.errorSource === "table" && (known.source !== "table" || time === "") ? " in the benchmarks" : "";
  const parts = [time && `${time} ${SOURCE_WORDS[known.source]}`, error && `${error}${where}${errorOf && ` (${errorOf})`}`].filter((part) => part);
  return `${CAPABILITY_WORDS[capability]}: ${parts.length > 0 ? parts.join(", ") : "not measured yet"}.`;
}
