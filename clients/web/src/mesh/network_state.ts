// What a person decides about a network: where its points come from, what joins them, how it is relaxed.
import type { EffectSwitch, EmbeddedSystemRequest, Mesh } from "../contract/types";
import { type Host, hostFor, hostOnAnotherMesh } from "./host";

export type PointSource = "poisson_disk" | "per_face" | "picked";
export type SpringSource = "voronoi_dual" | "adjacent_faces" | "drawn";
/** What joins the points. */
export type Elements = "springs" | "membrane" | "both";
export type Method = NonNullable<EmbeddedSystemRequest["method"]>;
export type SpringLength = NonNullable<EmbeddedSystemRequest["spring_length"]>;

/** Two points of the network, the one with the smaller number first. */
export type Pair = readonly [number, number];

/** A spring between picked points; without values of its own it has those of all. */
export interface DrawnSpring {
  readonly between: Pair;
  readonly restLength?: number;
  readonly weight?: number;
}

/** Lengths are in mesh units. */
export interface NetworkState {
  readonly points: PointSource;
  readonly elements: Elements;
  readonly radius: number;
  readonly seed: number;
  readonly springs: SpringSource;
  readonly drawn: readonly DrawnSpring[];
  readonly restLength: number;
  readonly weight: number;
  /** Energy per cubed mesh unit. */
  readonly youngsModulus: number;
  readonly poissonRatio: number;
  readonly thickness: number;
  /** Lengths at rest over those at the start. */
  readonly restScale: number;
  /** Ascending. */
  readonly fixed: readonly number[];
  readonly method: Method;
  readonly springLength: SpringLength;
  readonly tolerance: number;
  readonly maxIterations: number;
  readonly mollifier: EffectSwitch;
  readonly mollifierLength: number;
  readonly keptStrips: EffectSwitch;
  readonly host: Host;
}

export const POINT_SOURCES: readonly PointSource[] = ["poisson_disk", "per_face", "picked"];
export const SPRING_SOURCES: readonly SpringSource[] = ["voronoi_dual", "adjacent_faces", "drawn"];
export const ELEMENTS: readonly Elements[] = ["springs", "membrane", "both"];
export const METHODS: readonly Method[] = ["newton", "lbfgs", "gradient_descent"];
export const TOLERANCES: readonly number[] = [1e-3, 1e-6, 1e-9, 1e-12];
export const MOLLIFIER_LENGTHS: readonly number[] = [1e-6, 1e-4, 1e-2, 0.1];
export const MOST_ITERATIONS = 2000;
export const MOST_WEIGHT = 100;
export const MOST_SEED = 999;
/** What the page offers, within what the server takes. */
export const MODULUS_LIMITS = [0.01, 100] as const;
export const POISSON_LIMITS = [-0.9, 0.49] as const;
export const THICKNESS_LIMITS = [0.001, 10] as const;
export const REST_SCALE_LIMITS = [0.2, 2] as const;
/** Random points that a mesh has at first, about. */
const POINTS_AT_FIRST = 250;
/** Discs of half the radius that lie apart cover about this share of a surface. */
const COVERED = 0.7;

export const DEFAULT_NETWORK: NetworkState = {
  points: "poisson_disk", elements: "springs", radius: 1, seed: 1, springs: "voronoi_dual", drawn: [], restLength: 0, weight: 1, fixed: [],
  youngsModulus: 1, poissonRatio: 0.3, thickness: 1, restScale: 0.9,
  method: "newton", springLength: "geodesic", tolerance: 1e-9, maxIterations: 200, mollifier: "automatic", mollifierLength: 1e-6, keptStrips: "automatic",
  host: hostFor(1),
};

/** The radius of about so many random points on a surface. */
function radiusOf(area: number, points: number): number {
  return Number(Math.sqrt((COVERED * area * 4) / (Math.PI * points)).toPrecision(2));
}

/** The least and the largest radius that a slider offers on a mesh. */
export function radiusLimits({ area }: Pick<Mesh, "area">): readonly [number, number] {
  return [radiusOf(area, 5000), radiusOf(area, 8)];
}

/** What of a network makes sense on any mesh, with the rest as a mesh has it at first. */
export function onAnotherMesh(state: NetworkState, mesh: Pick<Mesh, "area" | "bounding_box">): NetworkState {
  return { ...state, radius: radiusOf(mesh.area, POINTS_AT_FIRST), restLength: 0, fixed: [], drawn: [], host: hostOnAnotherMesh(state.host, mesh) };
}

/** A change, with what no longer makes sense after it: springs and fixed points go by the numbers of points. */
export function changed(state: NetworkState, change: Partial<NetworkState>): NetworkState {
  const next = { ...state, ...change };
  const renumbered = next.points !== state.points || (next.points === "poisson_disk" && (next.radius !== state.radius || next.seed !== state.seed));
  const fixed = renumbered && !change.fixed ? [] : next.fixed;
  // The sides of triangles are shortest paths: springs beside them are too.
  return { ...next, fixed, springs: suitable(next), springLength: hasMembrane(next) ? "geodesic" : next.springLength };
}

export function hasMembrane({ elements }: Pick<NetworkState, "elements">): boolean {
  return elements !== "springs";
}

export function hasSprings({ elements }: Pick<NetworkState, "elements">): boolean {
  return elements !== "membrane";
}

/** Springs are drawn between picked points only. */
function suitable({ points, springs }: NetworkState): SpringSource {
  return springs === "drawn" && points !== "picked" ? "voronoi_dual" : springs;
}

export function withFixed(state: NetworkState, point: number): NetworkState {
  const others = state.fixed.filter((one) => one !== point);
  const fixed = others.length < state.fixed.length ? others : [...others, point].sort((a, b) => a - b);
  return { ...state, fixed };
}

/** Joins two points, or takes the spring between them away. */
export function withSpring(state: NetworkState, a: number, b: number): NetworkState {
  if (a === b) return state;
  const between: Pair = a < b ? [a, b] : [b, a];
  const others = state.drawn.filter((spring) => !samePair(spring.between, between));
  return { ...state, drawn: others.length < state.drawn.length ? others : [...others, { between }] };
}

/** After a picked point was taken away, the points behind it have smaller numbers. */
export function withoutPoint(state: NetworkState, point: number): NetworkState {
  const renumbered = (other: number) => (other > point ? other - 1 : other);
  return {
    ...state,
    fixed: state.fixed.filter((one) => one !== point).map(renumbered),
    drawn: state.drawn
      .filter(({ between }) => !between.includes(point))
      .map((spring) => ({ ...spring, between: [renumbered(spring.between[0]), renumbered(spring.between[1])] as const })),
  };
}

/** Without numbers of points that there are not. */
export function within(state: NetworkState, count: number): NetworkState {
  const exists = (point: number) => point < count;
  return { ...state, fixed: state.fixed.filter(exists), drawn: state.drawn.filter(({ between }) => between.every(exists)) };
}

function samePair(a: Pair, b: Pair): boolean {
  return a[0] === b[0] && a[1] === b[1];
}
