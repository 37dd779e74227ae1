// The settings of a Voronoi diagram: random sites, accuracy, and the objectives of the optimization.
import { plain } from "../base/format";
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
  count: 60, seed: 1, scattered: false, exactness: "exact", deviation: 1e-5,
  weights: { centroidal: 1, regularity: 0, equal_area: 0, edge_length: 0, planarity: 0 },
  targetLength: 0, fixed: [], minimizer: "automatic", tolerance: 1e-4, maxIterations: 100,
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
  const accuracy = { method: state.exactness, ...(state.exactness === "bounded" && { relative_error: RELATIVE_ERROR }), border_deviation: state.deviation };
  return { mesh, sites, accuracy, pieces: true, statistics };
}

export function optimizationRequest(mesh: string, state: VoronoiState, sites: readonly SurfacePoint[]): VoronoiOptimizationRequest {
  const objectives = Object.fromEntries(OBJECTIVES.filter((name) => state.weights[name] > 0).map((name) => [name, state.weights[name]]));
  return {
    mesh, sites: [...sites], objectives, pieces: true,
    ...(state.weights.edge_length > 0 && state.targetLength > 0 && { target_length: state.targetLength }),
    fixed_sites: state.fixed.filter((site) => site < sites.length),
    method: state.minimizer, accuracy: { tolerance: state.tolerance, border_deviation: state.deviation }, max_iterations: state.maxIterations,
  };
}

/** The fields of a diagram in a link. Its sites are the points of the link. */
export function writeVoronoi(state: VoronoiState): string {
  const fields = [state.count, state.seed, state.scattered ? 1 : 0, state.exactness, ...OBJECTIVES.map((name) => plain(state.weights[name])), plain(state.targetLength), state.minimizer, plain(state.tolerance), state.maxIterations, plain(state.deviation)];
  return `voronoi=${fields.join(",")}${state.fixed.length > 0 ? `&held=${state.fixed.join(",")}` : ""}`;
}

/** The settings from the fields of a link, with defaults for missing and invalid values; null if the link has no diagram. */
export function readVoronoi(fields: ReadonlyMap<string, string>): VoronoiState | null {
  const values = fields.get("voronoi")?.split(",");
  if (!values) return null;
  const number = (k: number, min: number, max: number, otherwise: number) => {
    const value = Number(values[k] || NaN);
    return value >= min && value <= max ? value : otherwise;
  };
  const whole = (k: number, min: number, max: number, otherwise: number) => Math.round(number(k, min, max, otherwise));
  const first = 4;
  const after = first + OBJECTIVES.length;
  const weights = Object.fromEntries(OBJECTIVES.map((name, k) => [name, number(first + k, 0, MAX_OBJECTIVE_WEIGHT, 0)])) as Record<Objective, number>;
  const fixedSites = (fields.get("held") ?? "").split(",").filter((text) => /^\d{1,6}$/.test(text)).map(Number);
  const { count, seed, tolerance, maxIterations, deviation } = DEFAULT_VORONOI;
  return {
    count: whole(0, 1, MAX_SITES, count), seed: whole(1, 0, MAX_SITE_SEED, seed), scattered: values[2] === "1",
    exactness: EXACTNESSES.find((one) => one === values[3]) ?? "exact", weights,
    targetLength: number(after, 0, Infinity, 0), fixed: [...new Set(fixedSites)].sort((a, b) => a - b),
    minimizer: MINIMIZERS.find((one) => one === values[after + 1]) ?? "automatic",
    tolerance: number(after + 2, 1e-12, 1, tolerance), maxIterations: whole(after + 3, 1, MAX_VORONOI_ITERATIONS, maxIterations),
    deviation: number(after + 4, 1e-7, 1, deviation),
  };
}
