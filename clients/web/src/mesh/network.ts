// A network that was made, the requests that make, relax and save it, and what is known of its springs on the way.
import type { EmbeddedSystem, EmbeddedSystemRequest, NetworkSpring, SurfacePoint } from "../contract/types";
import type { Vector } from "./mesh_data";
import type { NetworkState, Pair } from "./network_state";

/** Points and springs by which a network is drawn and relaxed. */
export interface Network {
  readonly points: readonly SurfacePoint[];
  readonly positions: readonly Vector[];
  readonly pairs: readonly Pair[];
}

/** All that points and springs depend on, fixed points and values of springs not. */
export function networkKey(mesh: string, state: NetworkState, picked: readonly SurfacePoint[]): string {
  const points = state.points === "picked" ? picked : state.points === "poisson_disk" ? [state.radius, state.seed] : [];
  return JSON.stringify([mesh, state.points, points, state.springs, state.springs === "drawn" && state.drawn.map(({ between }) => between)]);
}

/**
 * Asks for the points and springs alone: springs without weight move nothing, so that the answer is the network as its
 * builders make it.
 */
export function makingRequest(mesh: string, state: NetworkState, picked: readonly SurfacePoint[]): EmbeddedSystemRequest {
  const springs: EmbeddedSystemRequest["springs"] =
    state.springs === "drawn" ? state.drawn.map(({ between }) => ({ between: [...between], weight: 0 })) : { kind: state.springs, weight: 0 };
  return { mesh, points: startOf(state, picked), springs, max_iterations: 1 } as EmbeddedSystemRequest;
}

function startOf(state: NetworkState, picked: readonly SurfacePoint[]): EmbeddedSystemRequest["points"] {
  if (state.points === "picked") return [...picked];
  if (state.points === "per_face") return { kind: "per_face", barycentric: [1 / 3, 1 / 3, 1 / 3] };
  return { kind: "poisson_disk", radius: state.radius, seed: state.seed };
}

/** Rest length and weight of each spring, in the order of the pairs. */
export function springsOf(state: NetworkState, pairs: readonly Pair[]): NetworkSpring[] {
  const own = new Map(state.drawn.map((spring) => [spring.between.join(), spring]));
  return pairs.map((pair) => {
    const spring = state.springs === "drawn" ? own.get(pair.join()) : undefined;
    return { between: [...pair], rest_length: spring?.restLength ?? state.restLength, weight: spring?.weight ?? state.weight };
  });
}

/** Asks for the network at rest, from `start`. */
export function relaxationRequest(mesh: string, state: NetworkState, network: Network, start: readonly SurfacePoint[] = network.points): EmbeddedSystemRequest {
  return {
    mesh,
    points: [...start],
    springs: springsOf(state, network.pairs),
    fixed_points: state.fixed.filter((point) => point < start.length),
    method: state.method,
    spring_length: state.springLength,
    accuracy: { tolerance: state.tolerance, mollifier_length: state.mollifierLength },
    max_iterations: state.maxIterations,
    paths: true,
    effects: { mollifier: state.mollifier, kept_strips: state.keptStrips },
  };
}

/** Asks for a file of a network as it is: with all points held, nothing moves. */
export function fileRequest(request: EmbeddedSystemRequest, points: readonly SurfacePoint[]): EmbeddedSystemRequest {
  return { ...request, points: [...points], fixed_points: points.map((_, point) => point), max_iterations: 1 };
}

export interface SpringValues {
  readonly lengths: readonly number[];
  readonly energies: readonly number[];
}

/** Of springs that are straight through space: what is known of them on the way. */
export function straightValues(positions: readonly Vector[], springs: readonly NetworkSpring[]): SpringValues {
  const lengths = springs.map(({ between: [a, b] }) => Math.hypot(...[0, 1, 2].map((axis) => positions[a][axis] - positions[b][axis])));
  return { lengths, energies: springs.map(({ rest_length = 0, weight = 1 }, k) => weight * (lengths[k] - rest_length) ** 2) };
}

export function exactValues(answer: EmbeddedSystem): SpringValues {
  return { lengths: answer.springs.map((spring) => spring.length), energies: answer.springs.map((spring) => spring.energy) };
}
