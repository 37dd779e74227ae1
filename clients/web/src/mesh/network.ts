// A constructed network; the requests that construct, relax and save it; and lengths and energies of its springs and triangles.
import { atLevel, type Capability } from "../base/accuracy_levels";
import type { EmbeddedSystem, EmbeddedSystemRequest, NetworkSpring, SurfacePoint } from "../contract/types";
import { hostFields } from "./host";
import { energyDensity, type MembraneMaterial, straightSides, type Stretches, stretchesOf, type Triple } from "./membrane";
import type { Vector } from "./mesh_data";
import { DEFAULT_NETWORK, hasMembrane, hasSprings, type NetworkState, type Pair } from "./network_state";

/** Points, springs and triangles of a constructed network. */
export interface Network {
  readonly points: readonly SurfacePoint[];
  readonly positions: readonly Vector[];
  readonly pairs: readonly Pair[];
  /** Triangles of the membrane; none in a network of springs alone. */
  readonly triangles: readonly Triple[];
}

/** A key of all that points, springs and triangles depend on. Fixed points, values of springs and the material of the membrane are not part of it. */
export function networkKey(mesh: string, state: NetworkState, picked: readonly SurfacePoint[]): string {
  const points = state.points === "picked" ? picked : state.points === "poisson_disk" ? [state.radius, state.seed] : [];
  const springs = hasSprings(state) && [state.springs, state.springs === "drawn" && state.drawn.map(({ between }) => between)];
  return JSON.stringify([mesh, state.points, points, springs, hasMembrane(state)]);
}

/**
 * The request that constructs points, springs and triangles. Springs without weight and triangles at rest exert no forces, so that the
 * answer is the network before any relaxation.
 */
export function constructionRequest(mesh: string, state: NetworkState, picked: readonly SurfacePoint[]): EmbeddedSystemRequest {
  const { springs: source } = state;
  const springs: EmbeddedSystemRequest["springs"] = !hasSprings(state) ? []
    : source === "drawn" ? state.drawn.map(({ between }) => ({ between: [...between], weight: 0 })) : { kind: source, weight: 0 };
  const triangles = hasMembrane(state) && { triangles: { kind: "voronoi_dual" } };
  return { mesh, points: pointsField(state, picked), springs, ...triangles, max_iterations: 1 } as EmbeddedSystemRequest;
}

function pointsField(state: NetworkState, picked: readonly SurfacePoint[]): EmbeddedSystemRequest["points"] {
  if (state.points === "picked") return [...picked];
  if (state.points === "per_face") return { kind: "per_face", barycentric: [1 / 3, 1 / 3, 1 / 3] };
  return { kind: "poisson_disk", radius: state.radius, seed: state.seed };
}

/** Rest length and weight of each spring, in the order of the pairs. */
export function springsOf(state: NetworkState, pairs: readonly Pair[]): NetworkSpring[] {
  const drawnSprings = new Map(state.drawn.map((spring) => [spring.between.join(), spring]));
  return pairs.map((pair) => {
    const spring = state.springs === "drawn" ? drawnSprings.get(pair.join()) : undefined;
    return { between: [...pair], rest_length: spring?.restLength ?? state.restLength, weight: spring?.weight ?? state.weight };
  });
}

/** The request for the equilibrium of a network, from the points `start`. A membrane is at rest at its start, apart from the rest scale. */
export function relaxationRequest(mesh: string, state: NetworkState, network: Network, start: readonly SurfacePoint[] = network.points): EmbeddedSystemRequest {
  const { tolerance, mollifierLength } = state.accuracy.level === "own" ? state : DEFAULT_NETWORK;
  const request: EmbeddedSystemRequest = {
    mesh,
    points: [...start],
    springs: springsOf(state, network.pairs),
    ...(hasMembrane(state) && {
      triangles: network.triangles.map((corners) => [...corners]),
      membrane: { youngs_modulus: state.youngsModulus, poisson_ratio: state.poissonRatio, thickness: state.thickness, rest_scale: state.restScale },
    }),
    ...hostFields(state.host),
    fixed_points: state.fixed.filter((point) => point < start.length),
    method: state.method,
    spring_length: state.springLength,
    accuracy: { tolerance, mollifier_length: mollifierLength },
    max_iterations: state.maxIterations,
    paths: true,
    effects: { mollifier: state.mollifier, kept_strips: state.keptStrips, ...(state.host.kind === "shell" && { bending: state.host.bends ? "on" : "off" }) },
  };
  return atLevel(request, capabilityOf(state), state.accuracy);
}

/** What a relaxation is, by its host. */
export function capabilityOf({ host }: NetworkState): Capability {
  return host.kind === "rigid" ? "networks" : "hosts";
}

/**
 * The request for a file of a relaxed network. All of its points are fixed, so that nothing moves. A membrane would take this state as
 * its rest state, and a deformable host would start undeformed: these are relaxed again from their start, with the same result.
 */
export function fileRequest(request: EmbeddedSystemRequest, points: readonly SurfacePoint[]): EmbeddedSystemRequest {
  if (startsAtRest(request)) return request;
  return { ...request, points: [...points], fixed_points: points.map((_, point) => point), max_iterations: 1 };
}

/** Whether the start of a relaxation defines a rest state, so that a relaxation cannot resume from the end of another. */
export function startsAtRest({ triangles, host }: Pick<EmbeddedSystemRequest, "triangles" | "host">): boolean {
  return triangles !== undefined || host !== undefined;
}

export interface SpringValues {
  readonly lengths: readonly number[];
  readonly energies: readonly number[];
}

/** Lengths and energies of springs as straight segments in space, for states whose exact values are not known. */
export function straightValues(positions: readonly Vector[], springs: readonly NetworkSpring[]): SpringValues {
  const lengths = springs.map(({ between: [a, b] }) => Math.hypot(...[0, 1, 2].map((axis) => positions[a][axis] - positions[b][axis])));
  return { lengths, energies: springs.map(({ rest_length = 0, weight = 1 }, k) => weight * (lengths[k] - rest_length) ** 2) };
}

export function exactValues(answer: EmbeddedSystem): SpringValues {
  return { lengths: answer.springs.map((spring) => spring.length), energies: answer.springs.map((spring) => spring.energy) };
}

export interface TriangleValues {
  readonly stretches: readonly Stretches[];
  /** Energy per area at rest. */
  readonly densities: readonly number[];
  /** Whether the values are of shortest paths; otherwise of straight segments in space. */
  readonly exact: boolean;
}

/** Stretches and energy densities of triangles with straight sides, for states whose exact values are not known. */
export function straightTriangles({ positions: start, triangles }: Network, positions: readonly Vector[], material: MembraneMaterial, restScale: number): TriangleValues {
  const stretches = triangles.map((corners): Stretches => {
    const [greater, lesser] = stretchesOf(straightSides(start, corners), straightSides(positions, corners));
    return [greater / restScale, lesser / restScale];
  });
  return { stretches, densities: stretches.map((pair) => energyDensity(pair, material)), exact: false };
}

export function exactTriangles({ membrane = [] }: EmbeddedSystem, material: MembraneMaterial): TriangleValues {
  const stretches = membrane.map((triangle): Stretches => [triangle.stretches[0], triangle.stretches[1]]);
  return { stretches, densities: stretches.map((pair) => energyDensity(pair, material)), exact: true };
}

/** The material of the membrane in a request, with defaults for missing values. */
export function materialOf({ membrane }: Pick<EmbeddedSystemRequest, "membrane">): MembraneMaterial & { readonly rest_scale: number } {
  return { youngs_modulus: 1, poisson_ratio: 0.3, thickness: 1, rest_scale: 1, ...membrane };
}
