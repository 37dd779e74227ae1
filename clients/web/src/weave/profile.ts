// Young's modulus and Poisson's ratio over direction, for plots, tables and files.
import type { Curve } from "../base/curve";
import { degrees } from "../base/format";
import type { Effect, WeaveHomogenization, WeaveStop } from "../contract/types";

export interface Profile {
  /** Key of the request without its directions. */
  readonly key: string;
  readonly strain: number;
  /** In radians, in [0, pi). */
  readonly directions: readonly number[];
  /** In N/m; null for directions without a value. */
  readonly youngs: readonly (number | null)[];
  readonly poisson: readonly (number | null)[];
  /** Why a direction has no value; null if it has one. */
  readonly reasons: readonly (string | null)[];
  /** Number of directions in which the cell leaves its plane. */
  readonly outOfPlane: number;
  /** Number of directions with a value whose equilibrium is unstable. */
  readonly unstable: number;
  /** Number of directions in which sliding strands have not reached their limits within the tolerance. */
  readonly shortOfLimits: number;
  /** Upper bound of the relative error of energies that this causes; null if it is not known. */
  readonly limitError: number | null;
  /** Estimated errors in the units of the values; null where they are not known. */
  readonly youngsError: readonly (number | null)[];
  readonly poissonError: readonly (number | null)[];
  readonly effects: readonly Effect[];
  /** Requested and reached accuracy, by name. */
  readonly accuracy: Readonly<Record<string, unknown>>;
  readonly seconds: number;
  /** Whether the profile is a preview with few directions. */
  readonly provisional: boolean;
}

export const TERMINATION_WORDS: Record<WeaveStop, string> = {
  converged: "converged",
  iteration_limit: "the smallest load step did not converge",
  step_too_small: "no descent was found, at a limit or a fold",
  folded_flat: "the cell folds flat: no width is left that bears the stress",
  deadline: "the time ran out",
  memory: "a limit of memory was reached",
};

/** The fields of an answer that estimates its errors. */
interface EstimatedErrors {
  readonly youngs_modulus_error?: readonly (number | null)[];
  readonly poisson_ratio_error?: readonly (number | null)[];
}

export function profileOf(answer: WeaveHomogenization & EstimatedErrors, key: string, provisional: boolean): Profile {
  const reasons = answer.stopped.map((termination) => (termination === "converged" ? null : TERMINATION_WORDS[termination]));
  return {
    key,
    strain: answer.strain,
    directions: answer.directions,
    youngs: answer.youngs_modulus,
    poisson: answer.poisson_ratio,
    reasons,
    outOfPlane: answer.out_of_plane.filter(Boolean).length,
    unstable: answer.stable.filter((stable, k) => !stable && reasons[k] === null).length,
    shortOfLimits: answer.limit_error.filter((error, k) => reasons[k] === null && !(error !== null && error <= answer.accuracy.limit_tolerance)).length,
    limitError: answer.accuracy.limit_error,
    youngsError: answer.youngs_modulus_error ?? [],
    poissonError: answer.poisson_ratio_error ?? [],
    effects: answer.effects,
    accuracy: answer.accuracy,
    seconds: answer.cost.seconds,
    provisional,
  };
}

export function youngsCurve(profile: Profile): Curve {
  return { x: profile.directions, y: profile.youngs };
}

export function poissonCurve(profile: Profile): Curve {
  return { x: profile.directions, y: profile.poisson };
}

/** Index of the direction nearest to an angle. */
export function nearestDirection(profile: Profile, angle: number): number {
  let best = 0;
  let least = Infinity;
  profile.directions.forEach((direction, k) => {
    const difference = Math.abs(direction - angle) % Math.PI;
    const distance = Math.min(difference, Math.PI - difference);
    if (distance < least) [least, best] = [distance, k];
  });
  return best;
}

/** The estimated error of Young's modulus in a direction over the modulus; null where it is not known. */
export function youngsErrorAt({ youngs, youngsError }: Pick<Profile, "youngs" | "youngsError">, index: number): number | null {
  const [value, error] = [youngs[index], youngsError[index] ?? null];
  return value && error !== null ? error / Math.abs(value) : null;
}

/** The error of Young's modulus over the directions that the answer states; null without one. */
export function statedError({ accuracy }: Profile): number | null {
  const found = accuracy.discretization_error as { youngs_modulus?: number | null } | null | undefined;
  return found?.youngs_modulus ?? null;
}

/** The smallest and the largest value; null if there are none. */
export function extremes(values: readonly (number | null)[]): readonly [number, number] | null {
  const known = values.filter((value): value is number => value !== null);
  return known.length > 0 ? [Math.min(...known), Math.max(...known)] : null;
}

/** A sentence for each reason why directions have no value. */
export function gapWords(profile: Profile): string[] {
  const byReason = new Map<string, number[]>();
  profile.reasons.forEach((reason, k) => {
    if (reason !== null) byReason.set(reason, [...(byReason.get(reason) ?? []), profile.directions[k]]);
  });
  return [...byReason].map(([reason, angles]) => {
    const named = angles.slice(0, 4).map(degrees).join(", ");
    const more = angles.length > 4 ? ` and ${angles.length - 4} more` : "";
    return `No value at ${named}${more}: ${reason}.`;
  });
}

export function csvOf(profile: Profile): string {
  const rows = profile.directions.map((direction, k) =>
    [direction, profile.youngs[k] ?? "", profile.poisson[k] ?? "", profile.reasons[k] === null ? "" : `"${profile.reasons[k]}"`].join(",")
  );
  return `${["direction_rad,youngs_modulus_N_per_m,poisson_ratio,no_value_because", ...rows].join("\n")}\n`;
}
