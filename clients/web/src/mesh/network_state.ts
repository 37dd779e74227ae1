// The state of the network: the source of its points, the elements that join them, and the settings of the relaxation.
import { type AccuracyChoice, NORMAL } from "../base/accuracy_choice";
import type { EffectSwitch, EmbeddedSystemRequest, Mesh } from "../contract/types";
import { type Host, defaultHost, hostOnAnotherMesh } from "./host";

export type PointSource = "poisson_disk" | "per_face" | "picked";
export type SpringSource = "voronoi_dual" | "adjacent_faces" | "drawn";
/** The elements that join the points. */
export type Elements = "springs" | "membrane" | "both";
export type Method = NonNullable<EmbeddedSystemRequest["method"]>;
export type SpringLength = NonNullable<EmbeddedSystemRequest["spring_length"]>;

/** Indices of two points of the network, the smaller first. */
export type Pair = readonly [number, number];

/** A spring between picked points. Missing values are those of the state. */
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
  /** Young's modulus of the membrane, in energy per cubed mesh unit. */
  readonly youngsModulus: number;
  readonly poissonRatio: number;
  readonly thickness: number;
  /** Rest lengths of the membrane, over the lengths at the start. */
  readonly restScale: number;
  /** Indices of fixed points, ascending. */
  readonly fixed: readonly number[];
  readonly method: Method;
  readonly springLength: SpringLength;
  readonly accuracy: AccuracyChoice;
  /** Tolerance and length of the mollifier count only if accuracy is a value of one's own. */
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
export const MAX_ITERATIONS = 2000;
export const MAX_WEIGHT = 100;
export const MAX_SEED = 999;
/** The page's limits, which lie within the server's. */
export const MODULUS_LIMITS = [0.01, 100] as const;
export const POISSON_LIMITS = [-0.9, 0.49] as const;
export const THICKNESS_LIMITS = [0.001, 10] as const;
export const REST_SCALE_LIMITS = [0.2, 2] as const;
/** Approximate number of random points in the initial state. */
const INITIAL_POINTS = 250;
/** Fraction of a surface that the discs of a Poisson disk sample cover, with half the minimum distance of the points as radius. */
const COVERED_FRACTION = 0.7;

export const DEFAULT_NETWORK: NetworkState = {
  points: "poisson_disk",
  elements: "springs",
  radius: 1,
  seed: 1,
  springs: "voronoi_dual",
  drawn: [],
  restLength: 0,
  weight: 1,
  fixed: [],
  youngsModulus: 1,
  poissonRatio: 0.3,
  thickness: 1,
  restScale: 0.9,
  method: "newton",
  springLength: "geodesic",
  accuracy: NORMAL,
  tolerance: 1e-9,
  maxIterations: 200,
  mollifier: "automatic",
  mollifierLength: 1e-6,
  keptStrips: "automatic",
  host: defaultHost(1),
};

/** The radius of a Poisson disk sample that has about `points` points on a surface. */
function radiusOf(area: number, points: number): number {
  return Number(Math.sqrt((COVERED_FRACTION * area * 4) / (Math.PI * points)).toPrecision(2));
}

/** The limits of the radius on a mesh. */
export function radiusLimits({ area }: Pick<Mesh, "area">): readonly [number, number] {
  return [radiusOf(area, 5000), radiusOf(area, 8)];
}

/** The state for another mesh: settings that depend on the mesh are set to their initial values. */
export function onAnotherMesh(state: NetworkState, mesh: Pick<Mesh, "area" | "bounding_box">): NetworkState {
  return { ...state, radius: radiusOf(mesh.area, INITIAL_POINTS), restLength: 0, fixed: [], drawn: [], host: hostOnAnotherMesh(state.host, mesh) };
}

/** The level of a link that names none, as those of earlier versions: values of one's own count. */
export function usualLevel({ tolerance, mollifierLength }: Pick<NetworkState, "tolerance" | "mollifierLength">): AccuracyChoice["level"] {
  return tolerance === DEFAULT_NETWORK.tolerance && mollifierLength === DEFAULT_NETWORK.mollifierLength ? "normal" : "own";
}

/** Applies a change and resets what it makes invalid: springs and fixed points refer to points by index. */
export function withChange(state: NetworkState, change: Partial<NetworkState>): NetworkState {
  const next = { ...state, ...change };
  const renumbered = next.points !== state.points || (next.points === "poisson_disk" && (next.radius !== state.radius || next.seed !== state.seed));
  const fixed = renumbered && !change.fixed ? [] : next.fixed;
  // The sides of triangles are shortest paths, so that springs beside a membrane have to be, too.
  return { ...next, fixed, springs: validSpringSource(next), springLength: hasMembrane(next) ? "geodesic" : next.springLength };
}

export function hasMembrane({ elements }: Pick<NetworkState, "elements">): boolean {
  return elements !== "springs";
}

export function hasSprings({ elements }: Pick<NetworkState, "elements">): boolean {
  return elements !== "membrane";
}

/** The source of the springs, corrected if it needs picked points and there are none. */
function validSpringSource({ points, springs }: NetworkState): SpringSource {
  return springs === "drawn" && points !== "picked" ? "voronoi_dual" : springs;
}

export function withToggledFixed(state: NetworkState, point: number): NetworkState {
  const others = state.fixed.filter((one) => one !== point);
  const fixed = others.length < state.fixed.length ? others : [...others, point].sort((a, b) => a - b);
  return { ...state, fixed };
}

/** Joins two points with a spring, or removes the spring between them. */
export function withToggledSpring(state: NetworkState, a: number, b: number): NetworkState {
  if (a === b) return state;
  const between: Pair = a < b ? [a, b] : [b, a];
  const others = state.drawn.filter((spring) => !samePair(spring.between, between));
  return { ...state, drawn: others.length < state.drawn.length ? others : [...others, { between }] };
}

/** Removes a picked point. The indices of the points after it decrease. */
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

/** Drops references to points with an index of `count` or more. */
export function withExistingPoints(state: NetworkState, count: number): NetworkState {
  const exists = (point: number) => point < count;
  return { ...state, fixed: state.fixed.filter(exists), drawn: state.drawn.filter(({ between }) => between.every(exists)) };
}

function samePair(a: Pair, b: Pair): boolean {
  return a[0] === b[0] && a[1] === b[1];
}
