// Ways out of a target that is missed: changes of the problem with which a design comes close. They are looked for in the background.
import { Observable } from "../base/observable";
import { plain } from "../base/format";
import type { DesignStop } from "../contract/types";
import { type Client, isBusy, statusOf } from "../contract/client";
import { JobRunner } from "../contract/runner";
import { Pauses } from "./pauses";
import { waysOutRequest } from "./requests";
import type { DesignSession } from "./session";
import { DEFAULT_SPECIFICATION, isRange, radians, type Specification, writeSpecification } from "./specification";
import { targetCurve } from "./spline";
import { targetsText } from "./started_jobs";
import { ANY, type ControlPoint, type DesignState, isPolar, type Target } from "./state";
import { targetsOf } from "./target_list";

/** A change that the server has found. */
export interface WayOut {
  readonly change: "turn" | "modulus" | "turn_and_modulus" | "shorten" | "family";
  /** The change in words, with the deviation that it leaves. */
  readonly sentence: string;
  readonly family: string;
  readonly parameters: readonly number[];
  /** In radians. */
  readonly orientation: number;
  /** In MPa. */
  readonly youngs_modulus: number;
  /** Strains of the shortened target; null where the target stays. */
  readonly range: readonly [number, number] | null;
  /** Relative root mean square deviation by the model. */
  readonly deviation: number;
}

export type WaysOutState =
  | { readonly kind: "none" }
  | { readonly kind: "looking" }
  | { readonly kind: "found"; readonly ways: readonly WayOut[] };

const MAX_KNOWN = 20;
/** Orientations that differ by less count as equal, in radians. */
const MIN_ANGLE = 1e-9;
/** Statuses of jobs that were ended before they had a result. */
const DISMISSED = 410;
const DEADLINE_EXCEEDED = 504;

export class WaysOut {
  readonly state = new Observable<WaysOutState>({ kind: "none" });
  /** Pauses after a lost connection or while the server is busy. */
  readonly pauses = new Pauses();
  private readonly runner: JobRunner;
  /** What was found, by the problem that it belongs to. */
  private readonly known = new Map<string, readonly WayOut[]>();
  /** The problem that is shown or looked at. */
  private problem = "";

  constructor(private readonly session: DesignSession, client: Client) {
    this.runner = new JobRunner(client);
    session.state.watch((state) => this.follow(problemText(state)));
  }

  /** Looks for ways out of the present target, unless they are known. */
  look(): void {
    const state = this.session.state.get();
    const problem = problemText(state);
    if ((this.problem === problem && this.state.get().kind !== "none") || this.pauses.remaining > 0) return;
    this.problem = problem;
    this.state.set({ kind: "looking" });
    void this.runner.start(async (run) => {
      const { ways_out: ways, stopped } = await run.job<{ ways_out?: readonly WayOut[]; stopped?: DesignStop }>("/v1/designs", waysOutRequest(state));
      if (stopped === "deadline" || stopped === "memory") return this.postpone(problem);
      this.pauses.clear();
      this.remember(problem, ways ?? []);
    }, (error) => this.fail(error, problem));
  }

  /** Ends the search for ways out. */
  clear(): void {
    this.runner.stop();
    this.problem = "";
    this.state.set({ kind: "none" });
  }

  /** Makes the change of a way out, as one step. The next search starts from its design. */
  apply(way: WayOut): void {
    this.session.apply(changeOf(way, this.session.state.get()));
  }

  /** What was not asked for has no complaints. A search that did not come to its end says nothing, after any other failure other advice is shown. */
  private fail(error: unknown, problem: string): void {
    if (!isBusy(error) && ![DISMISSED, DEADLINE_EXCEEDED].includes(statusOf(error) ?? 0)) return this.remember(problem, []);
    this.postpone(problem);
  }

  private postpone(problem: string): void {
    this.pauses.begin();
    if (this.problem === problem) this.clear();
  }

  /** Drops what belongs to another problem, and shows what is known of the present one. */
  private follow(problem: string): void {
    if (problem === this.problem) return;
    this.clear();
    const ways = this.known.get(problem);
    if (!ways) return;
    this.problem = problem;
    this.state.set({ kind: "found", ways });
  }

  private remember(problem: string, ways: readonly WayOut[]): void {
    this.known.delete(problem);
    this.known.set(problem, ways);
    for (const oldest of [...this.known.keys()].slice(0, -MAX_KNOWN)) this.known.delete(oldest);
    if (problem === this.problem) this.state.set({ kind: "found", ways });
  }
}

/** What the ways out of a state depend on. The size of the structure counts only if there are limits, and of its design only what is fixed. */
export function problemText(state: DesignState): string {
  const { relativeDensity, leastBeamWidth, cellSizes } = state.made;
  const hasLimits = relativeDensity !== null || leastBeamWidth !== null || cellSizes !== null;
  const made: Specification = hasLimits ? state.made : { ...state.made, size: DEFAULT_SPECIFICATION.size };
  return `${targetsText(targetsOf(state))} ${String(writeSpecification(made))} ${state.family} ${fixedText(state)}`;
}

/** The fixed parameters of a design with its family, to which they restrict the search; empty if all are free. */
function fixedText({ found, fixed }: DesignState): string {
  if (!found || !fixed.some(Boolean)) return "";
  return `${found.family} ${found.parameters.map((value, k) => (fixed[k] ? plain(value) : "")).join()}`;
}

/** The change of the state that a way out proposes. */
export function changeOf(way: WayOut, state: DesignState): Partial<DesignState> {
  const { family, parameters } = way;
  const made = madeOf(way, state);
  const isSameFamily = state.found?.family === family && state.fixed.length === parameters.length;
  return {
    made,
    // The search goes on in the family of the way out and starts from its design, so that it comes as close.
    family: state.family === ANY && way.change === "shorten" ? ANY : family,
    found: { family, parameters, ...foundValues(way, state, made) },
    fixed: isSameFamily ? state.fixed : parameters.map(() => false),
    byHand: false,
    ...(way.range && !isPolar(state.task) && { points: shortenedPoints(state, way.range) }),
  };
}

function madeOf({ change, orientation, youngs_modulus: modulus }: WayOut, { made, found }: DesignState): Specification {
  const turned = change === "turn" || change === "turn_and_modulus" ? { ...made, orientation: rounded((withinRange(orientation, made) * 180) / Math.PI, 2) } : made;
  if (change !== "modulus" && change !== "turn_and_modulus") return turned;
  const youngsModulus = Number(modulus.toPrecision(4));
  if (turned.materials.length === 0) return { ...turned, youngsModulus };
  // Of a list of materials, the one of the present design gets the modulus. It is another material then, which has another name.
  const at = Math.max(0, turned.materials.findIndex(({ name }) => name === found?.material));
  return { ...turned, materials: [{ ...turned.materials[at], name: `Material of ${plain(youngsModulus)} MPa`, youngsModulus }] };
}

/** What the search would have chosen, where the changed specification still leaves it a choice. */
function foundValues({ orientation, youngs_modulus: modulus }: WayOut, { found }: DesignState, made: Specification): Partial<NonNullable<DesignState["found"]>> {
  const { youngsModulus, materials } = made;
  return {
    ...(materials.length > 0 && { material: materials.find(({ name }) => name === found?.material)?.name ?? materials[0].name }),
    ...((materials.length > 1 || isRange(materials[0]?.youngsModulus ?? youngsModulus)) && { youngsModulus: modulus }),
    ...(isRange(made.orientation) && { orientation: withinRange(orientation, made) }),
  };
}

/** An orientation in [0, pi), or the one of the same tiling in the range that the state allows. */
function withinRange(orientation: number, { orientation: range }: Specification): number {
  return isRange(range) && orientation > radians(range[1]) + MIN_ANGLE ? orientation - Math.PI : orientation;
}

/** The control points of a target over a part of its range, whose ends get points on its curve. */
export function shortenedPoints({ points, interpolation }: Pick<Target, "points" | "interpolation">, [from, to]: readonly [number, number]): readonly ControlPoint[] {
  const curve = targetCurve(false, points, interpolation);
  const tolerance = 1e-3 * (to - from);
  const inside = points.filter(([x]) => x > from + tolerance && x < to - tolerance);
  return [endPoint(points, from, curve), ...inside, endPoint(points, to, curve)];
}

function endPoint(points: readonly ControlPoint[], x: number, curve: (x: number) => number): ControlPoint {
  return points.find((point) => Math.abs(point[0] - x) < 1e-9) ?? [x, x === 0 ? 0 : curve(x)];
}

function rounded(value: number, decimals: number): number {
  return Number(value.toFixed(decimals));
}
