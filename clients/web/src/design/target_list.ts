// Several targets of one design. The state holds the one in sight as its own; these functions know all of them in order.
import { degrees, digits } from "../base/format";
import { isPolar, type Region, sameProfile, type Target, TASK_WORDS } from "./state";

/** The main target and as many further ones as a request may have. */
export const MOST_TARGETS = 9;
export const MOST_NAME = 40;

/** The target alone, of what has more. */
export function targetOf({ name, task, points, interpolation, direction, strain, measure, weight }: Target): Target {
  return { name, task, points, interpolation, direction, strain, measure, weight };
}

/** All targets in the order of their tabs. */
export function targetsOf(state: Pick<Region, keyof Target | "others" | "at">): readonly Target[] {
  const { others, at } = state;
  return [...others.slice(0, at), targetOf(state), ...others.slice(at)];
}

/** The change of a state that has these targets, with one of them in sight. */
export function withTargets(targets: readonly Target[], at: number): Target & Pick<Region, "others" | "at"> {
  const place = Math.max(0, Math.min(Math.round(at), targets.length - 1));
  return { ...targets[place], others: targets.filter((_, k) => k !== place), at: place };
}

/** Whether the same is wanted: equal targets in equal order, whichever is in sight and whatever they are called. */
export function sameTargets(a: readonly Target[], b: readonly Target[]): boolean {
  return a.length === b.length && a.every((target, k) => sameTarget(target, b[k]));
}

function sameTarget(a: Target, b: Target): boolean {
  return sameProfile(a, b) && a.points === b.points && a.interpolation === b.interpolation && a.weight === b.weight;
}

/** The order in which the targets are asked for, by their places: what is told of the main one alone is of the one in sight. */
export function askedOrder({ others, at }: Pick<Region, "others" | "at">): readonly number[] {
  return [at, ...others.map((_, k) => (k < at ? k : k + 1))];
}

/** What a target is called: its name, or what it shows. */
export function targetWords(target: Target): string {
  if (target.name !== "") return target.name;
  const where = isPolar(target.task) ? `at ${digits(target.strain)}` : degrees(target.direction);
  return `${TASK_WORDS[target.task].short}, ${where}`;
}

/** Another target to begin with beside those that are there: the same in a further direction, or at a further strain. */
export function furtherTarget(targets: readonly Target[], like: Target): Target {
  const next = (share: number): Target => {
    if (isPolar(like.task)) return { ...like, strain: like.strain + 0.01 * share };
    return { ...like, direction: (like.direction + share * (Math.PI / 4)) % Math.PI };
  };
  // A quarter of a turn first, then what is between.
  const free = [2, 1, 3, 4, 5, 6, 7, 8, 9].map(next).find((one) => targets.every((other) => !sameProfile(one, other)));
  return { ...(free ?? next(2)), name: "", weight: 1 };
}
