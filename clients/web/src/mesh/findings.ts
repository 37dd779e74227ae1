// The server's answers about points of a surface, converted to what is drawn and listed.
import { withError } from "../base/accuracy_words";
import { digits, percent, seconds } from "../base/format";
import type { Geodesics, KarcherMean, PathPoint } from "../contract/types";
import type { Vector } from "./mesh_data";
import { type FindingReaders, type Finding, NO_FINDING } from "./session";

const TERMINATION_WORDS: Record<KarcherMean["stopped"], string> = {
  converged: "converged",
  kink: "at a kink: no direction descends",
  step_too_small: "rounding allows no further descent",
  iteration_limit: "limit of iterations",
};

function placesOf(path: readonly PathPoint[] | undefined): Vector[] {
  return (path ?? []).map((point) => point.position as unknown as Vector);
}

function pathsOf({ results }: Geodesics): Pick<Finding, "paths" | "notes"> {
  const notes: string[] = [];
  if (results.some((result) => result.unreachable)) notes.push("Some points lie on different components: no path joins them.");
  if (results.some((result) => result.near_cut_locus)) notes.push("Another path is as short within 10⁻⁶: the points are near each other’s cut locus.");
  return { paths: results.map((result) => placesOf(result.path)), notes };
}

export const findings: FindingReaders = {
  path(geodesics) {
    const lengths = geodesics.results.flatMap((result) => result.distance ?? []);
    const facts: (readonly [string, string])[] = lengths.length > 1 ? lengths.map((length, k) => [`Path ${k + 1}`, digits(length, 6)] as const) : [];
    const total = lengths.reduce((sum, length) => sum + length, 0);
    facts.push([lengths.length > 1 ? "Together" : "Length", digits(total, 6)], ["Time", seconds(geodesics.cost.seconds)]);
    return { ...NO_FINDING, ...pathsOf(geodesics), facts, effects: geodesics.effects };
  },

  distance(distances, time, bound, effects = []) {
    const known = distances.filter((value): value is number => value !== null);
    const largest = known.reduce((max, value) => Math.max(max, value), 0);
    const notes = known.length < distances.length ? [`${distances.length - known.length} vertices cannot be reached.`] : [];
    const error = bound === 0 ? "exact up to rounding" : bound === null ? "no bound" : percent(bound);
    return {
      ...NO_FINDING,
      distances: distances.map((value) => value ?? -1),
      facts: [["Farthest vertex", withError(digits(largest, 6), bound)], ["Error", error], ["Time", seconds(time)]],
      notes,
      effects,
    };
  },

  mean(mean, geodesics) {
    const { notes, paths } = pathsOf(geodesics);
    const further = mean.effects.find((effect) => effect.name === "multi_start")?.count ?? 0;
    return {
      ...NO_FINDING,
      paths,
      mean: mean.position as unknown as Vector,
      facts: [
        ["Objective", digits(mean.objective, 6)],
        ["Gradient", digits(mean.gradient_norm, 2)],
        ["Iterations", `${mean.iterations}, ${TERMINATION_WORDS[mean.stopped]}`],
        ...(further > 0 ? [["Start", `${mean.start + 1} of ${further + 1}`] as const] : []),
        ["Position", mean.position.map((value) => digits(value, 4)).join(", ")],
        ["Time", seconds(mean.cost.seconds)],
      ],
      notes,
      effects: mean.effects,
    };
  },
};
