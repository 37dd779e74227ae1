// Targets of one design. A state has the fields of the selected target itself and the others in a list; these functions convert
// between a state and the list of all targets.
import { degrees, digits } from "../base/format";
import { isPolar, type Region, sameProfile, type Target, TASK_WORDS } from "./state";

/** Limit of the number of targets of a request: the main one and the further ones. */
export const MAX_TARGETS = 9;
export const MAX_NAME_LENGTH = 40;

/** The fields of the selected target, without the others of a state. */
export function targetOf({ name, task, points, interpolation, direction, strain, measure, weight }: Target): Target {
  return { name, task, points, interpolation, direction, strain, measure, weight };
}

/** All targets in the order of their tabs. */
export function targetsOf(state: Pick<Region, keyof Target | "others" | "at">): readonly Target[] {
  const { others, at } = state;
  return [...others.slice(0, at), targetOf(state), ...others.slice(at)];
}

/** The change that gives a state these targets, with target `at` selected. */
export function withTargets(targets: readonly Target[], at: number): Target & Pick<Region, "others" | "at"> {
  const place = Math.max(0, Math.min(Math.round(at), targets.length - 1));
  return { ...targets[place], others: targets.filter((_, k) => k !== place), at: place };
}

/** Whether two lists have equal targets in the same order. Names do not count. */
export function sameTargets(a: readonly Target[], b: readonly Target[]): boolean {
  return a.length === b.length && a.every((target, k) => sameTarget(target, b[k]));
}

function sameTarget(a: Target, b: Target): boolean {
  return sameProfile(a, b) && a.points === b.points && a.interpolation === b.interpolation && a.weight === b.weight;
}

/** Indices of the targets in the order of a request. The selected target comes first, because partial results are for the first one. */
export function askedOrder({ others, at }: Pick<Region, "others" | "at">): readonly number[] {
  return [at, ...others.map((_, k) => (k < at ? k : k + 1))];
}

/** Label of a target: its name, or its task with direction or strain. */
export function targetWords(target: Target): string {
  if (target.name !== "") return target.name;
  const where = isPolar(target.task) ? `at ${digits(target.strain)}` : degrees(target.direction);
  return `${TASK_WORDS[target.task].short}, ${where}`;
}

/** A new target beside existing ones: like `like`, in a direction or at a strain that none of them has. */
export function furtherTarget(targets: readonly Target[], like: Target): Target {
  const next = (steps: number): Target => {
    if (isPolar(like.task)) return { ...like, strain: like.strain + 0.01 * steps };
    return { ...like, direction: (like.direction + steps * (Math.PI / 4)) % Math.PI };
  };
  // The first step tried is 2, a quarter of a turn; then the directions between, in steps of 45 degrees.
  const free = [2, 1, 3, 4, 5, 6, 7, 8, 9].map(next).find((one) => targets.every((other) => !sameProfile(one, other)));
  return { ...(free ?? next(2)), name: "", weight: 1 };
}
