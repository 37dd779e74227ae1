// The jobs of verifications that run on the server. They are stored, so that a page that was left and opened again finds them.
import { plain } from "../base/format";
import type { AnsweredRound } from "./polish_rounds";
import { sameSimulatedDesign, type SimulatedDesign } from "./simulations";
import { isPolar, type Target } from "./state";

const KEY = "supple-verifying";
const MAX_JOBS = 8;

/** `verify` simulates a design as it is, `polish` also corrects it. */
export type SimulationWork = "verify" | "polish";

export interface StartedJob {
  readonly id: string;
  readonly work: SimulationWork;
  /** Whether it began without being asked for. */
  readonly isBackground: boolean;
  readonly design: SimulatedDesign;
  /** The text of its targets, in the order of the tabs. */
  readonly targets: string;
  /** Indices of the targets in the order of the request, which is that of the answer. */
  readonly order: readonly number[];
  /** The rounds of a polish that a page has seen; absent if it has seen none. */
  readonly rounds?: readonly AnsweredRound[];
}

/** A text that is the same for equal targets, also after links have rounded them. */
export function targetsText(targets: readonly Target[]): string {
  return targets.map((target) => {
    const { task, measure, interpolation, points, weight } = target;
    const place = isPolar(task) ? target.strain : target.direction;
    return [task, plain(place), measure, interpolation, plain(weight), ...points.flat().map(plain)].join();
  }).join(";");
}

export function rememberJob(job: StartedJob): void {
  store([job, ...stored().filter(({ id }) => id !== job.id)]);
}

/** Stores the rounds of a polish, so that they are counted on after a reload. */
export function rememberRounds(id: string, rounds: readonly AnsweredRound[]): void {
  const jobs = stored();
  const known = jobs.find((job) => job.id === id);
  if (known && (known.rounds?.length ?? 0) < rounds.length) store(jobs.map((job) => (job.id === id ? { ...job, rounds } : job)));
}

export function forgetJob(id: string): void {
  store(stored().filter((job) => job.id !== id));
}

/** The job that simulates a design for certain targets; null if none was started. */
export function startedJob(design: SimulatedDesign, targets: string): StartedJob | null {
  return stored().find((job) => job.targets === targets && sameSimulatedDesign(job.design, design)) ?? null;
}

function stored(): readonly StartedJob[] {
  try {
    const jobs = JSON.parse(localStorage.getItem(KEY) ?? "[]") as readonly StartedJob[];
    return jobs.filter(({ id, design, order, rounds = [] }) => /^[\w-]+$/.test(id) && [design.parameters, order, rounds].every(Array.isArray));
  } catch {
    return []; // storage is blocked, or the text is of another version
  }
}

function store(jobs: readonly StartedJob[]): void {
  try {
    localStorage.setItem(KEY, JSON.stringify(jobs.slice(0, MAX_JOBS)));
  } catch {
    // storage is blocked: a page that is left loses sight of its jobs
  }
}
