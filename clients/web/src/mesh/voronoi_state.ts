// The settings of a Voronoi diagram: random sites, accuracy, and the objectives of the optimization.
import { type AccuracyChoice, NORMAL, readChoice, writeChoice } from "../base/accuracy_choice";
import { atLevel } from "../base/accuracy_levels";
import { choiceOf, type Fields, numberOf, readValues, wholeOf, writeValues } from "../base/link_fields";
import type { SurfacePoint, VoronoiDiagramRequest, VoronoiObjectives, VoronoiOptimizationRequest } from "../contract/types";

export type Objective = keyof VoronoiObjectives;
export type Minimizer = NonNullable<VoronoiOptimizationRequest["method"]>;
/** Accuracy of distances: exact, within a relative error, or along edges. */
export type Exactness = "exact" | "bounded" | "edges";

export interface VoronoiState {
  /** Number of random sites. */
  readonly count: number;
  readonly seed: number;
  /** Whether the sites are the unchanged random ones. */
  readonly scattered: boolean;
  readonly accuracy: AccuracyChoice;
  /** This, the deviation of borders and the tolerance count only if accuracy is a value of one's own. */
  readonly exactness: Exactness;
  /** Largest distance of borders from the polylines that draw them, in diagonals of the mesh. */
  readonly deviation: number;
  readonly weights: Readonly<Record<Objective, number>>;
  /** Target length of edges in mesh units; 0 for their mean length at the start. */
  readonly targetLength: number;
  /** Indices of fixed sites, ascending. */
  readonly fixed: readonly number[];
  readonly minimizer: Minimizer;
  readonly tolerance: number;
  readonly maxIterations: number;
}

export const OBJECTIVES: readonly Objective[] = ["centroidal", "regularity", "equal_area", "edge_length", "planarity"];
export const EXACTNESSES: readonly Exactness[] = ["exact", "bounded", "edges"];
export const MINIMIZERS: readonly Minimizer[] = ["automatic", "gauss_newton", "lbfgs"];
export const VORONOI_TOLERANCES: readonly number[] = [1e-2, 1e-4, 1e-6];
export const BORDER_DEVIATIONS: readonly number[] = [1e-3, 1e-4, 1e-5, 1e-6];
export const MAX_SITES = 2000;
export const MAX_SITE_SEED = 999;
export const MAX_OBJECTIVE_WEIGHT = 100;
export const MAX_VORONOI_ITERATIONS = 1000;
/** Relative error of bounded distances. */
export const RELATIVE_ERROR = 0.01;

export const DEFAULT_VORONOI: VoronoiState = {
  count: 60,
  seed: 1,
  scattered: false,
  accuracy: NORMAL,
  exactness: "exact",
  deviation: 1e-5,
  weights: { centroidal: 1, regularity: 0, equal_area: 0, edge_length: 0, planarity: 0 },
  targetLength: 0,
  fixed: [],
  minimizer: "automatic",
  tolerance: 1e-4,
  maxIterations: 100,
};

export function hasObjective({ weights }: VoronoiState): boolean {
  return OBJECTIVES.some((name) => weights[name] > 0);
}

/** Fixes a site, or releases it if it is fixed. */
export function withToggledFixed(state: VoronoiState, site: number): VoronoiState {
  const fixed = state.fixed.includes(site) ? state.fixed.filter((one) => one !== site) : [...state.fixed, site].sort((a, b) => a - b);
  return { ...state, fixed };
}

/** Removes a site. The indices of the sites after it decrease. */
export function withoutSite(state: VoronoiState, site: number): VoronoiState {
  return { ...state, scattered: false, fixed: state.fixed.filter((one) => one !== site).map((one) => (one > site ? one - 1 : one)) };
}

export function diagramRequest(mesh: string, state: VoronoiState, sites: VoronoiDiagramRequest["sites"], statistics: boolean): VoronoiDiagramRequest {
  const { exactness, deviation } = ownValues(state);
  const accuracy = { method: exactness, ...(exactness === "bounded" && { relative_error: RELATIVE_ERROR }), border_deviation: deviation };
  return atLevel({ mesh, sites, accuracy, pieces: true, statistics }, "voronoi", state.accuracy);
}

/** The values of one's own, or the usual ones at a level. */
function ownValues(state: VoronoiState): OwnValues {
  return state.accuracy.level === "own" ? state : DEFAULT_VORONOI;
}

type OwnValues = Pick<VoronoiState, "exactness" | "deviation" | "tolerance">;

/** The level of a link that names none, as those of earlier versions: values of one's own count. */
function usualLevel({ exactness, deviation, tolerance }: OwnValues): AccuracyChoice["level"] {
  const usual = exactness === DEFAULT_VORONOI.exactness && deviation === DEFAULT_VORONOI.deviation && tolerance === DEFAULT_VORONOI.tolerance;
  return usual ? "normal" : "own";
}

export function optimizationRequest(mesh: string, state: VoronoiState, sites: readonly SurfacePoint[]): VoronoiOptimizationRequest {
  const objectives = Object.fromEntries(OBJECTIVES.filter((name) => state.weights[name] > 0).map((name) => [name, state.weights[name]]));
  const { tolerance, deviation } = ownValues(state);
  const request: VoronoiOptimizationRequest = {
    mesh,
    sites: [...sites],
    objectives,
    pieces: true,
    ...(state.weights.edge_length > 0 && state.targetLength > 0 && { target_length: state.targetLength }),
    fixed_sites: state.fixed.filter((site) => site < sites.length),
    method: state.minimizer,
    accuracy: { tolerance, border_deviation: deviation },
    max_iterations: state.maxIterations,
  };
  return atLevel(request, "voronoi_optimizations", state.accuracy);
}

/** Values of a diagram in a link, in the order in which the links of version 0.1 have them. */
const VORONOI_VALUES = ["count", "seed", "scattered", "exactness", ...OBJECTIVES, "target-length", "minimizer", "tolerance", "max-iterations", "deviation"];

/** The fields of a diagram in a link. Its sites are the points of the link. */
export function writeVoronoi(state: VoronoiState): [string, string][] {
  const { count, seed, scattered, exactness, weights, targetLength, minimizer, tolerance, maxIterations, deviation, fixed } = state;
  const values = writeValues({
    count,
    seed,
    scattered: scattered ? 1 : 0,
    exactness,
    ...weights,
    "target-length": targetLength,
    minimizer,
    tolerance,
    "max-iterations": maxIterations,
    deviation,
  });
  return [["voronoi", values], ...writeChoice(state.accuracy, usualLevel(state)), ...(fixed.length > 0 ? [["fixed-sites", fixed.join(",")] as [string, string]] : [])];
}

/** The settings from the fields of a link, with defaults for missing and invalid values; null if the link has no diagram. */
export function readVoronoi(fields: Fields): VoronoiState | null {
  const text = fields.get("voronoi");
  if (text === undefined) return null;
  const values = readValues(text, VORONOI_VALUES);
  const weights = Object.fromEntries(OBJECTIVES.map((name) => [name, numberOf(values.get(name), 0, MAX_OBJECTIVE_WEIGHT, 0)])) as Record<Objective, number>;
  // The links of version 0.1 say "held".
  const fixedSites = (fields.get("fixed-sites") ?? fields.get("held") ?? "").split(",").filter((site) => /^\d{1,6}$/.test(site)).map(Number);
  const { count, seed, tolerance, maxIterations, deviation } = DEFAULT_VORONOI;
  const own: OwnValues = {
    exactness: choiceOf(values.get("exactness"), EXACTNESSES, "exact"),
    tolerance: numberOf(values.get("tolerance"), 1e-12, 1, tolerance),
    deviation: numberOf(values.get("deviation"), 1e-7, 1, deviation),
  };
  return {
    count: wholeOf(values.get("count"), 1, MAX_SITES, count),
    seed: wholeOf(values.get("seed"), 0, MAX_SITE_SEED, seed),
    scattered: values.get("scattered") === "1",
    ...own,
    accuracy: readChoice(fields, usualLevel(own)),
    weights,
    targetLength: numberOf(values.get("target-length"), 0, Number.MAX_VALUE, 0),
    fixed: [...new Set(fixedSites)].sort((a, b) => a - b),
    minimizer: choiceOf(values.get("minimizer"), MINIMIZERS, "automatic"),
    maxIterations: wholeOf(values.get("max-iterations"), 1, MAX_VORONOI_ITERATIONS, maxIterations),
  };
}
