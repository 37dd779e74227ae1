// What carries a network, as a person decides it: a rigid surface, a thin shell or an elastic solid, and what of it is held.
import type { EmbeddedSystemRequest, Mesh } from "../contract/types";
import type { MeshData, Vector } from "./mesh_data";

export type HostKind = "rigid" | "shell" | "solid";
export const HOST_KINDS: readonly HostKind[] = ["rigid", "shell", "solid"];

/** A support that is taken elsewhere once all is at rest, in mesh units. */
export interface Move {
  readonly vertex: number;
  readonly to: Vector;
}

/** Lengths are in mesh units, moduli and the weight of the volume in energy per cubed mesh unit. */
export interface Host {
  readonly kind: HostKind;
  readonly thickness: number;
  readonly shellModulus: number;
  readonly solidModulus: number;
  /** Of either. */
  readonly poissonRatio: number;
  readonly keepsVolume: boolean;
  readonly volumeWeight: number;
  /** The volume to keep over that at rest. */
  readonly volumeScale: number;
  readonly bends: boolean;
  /** Force per volume along -z, energy per mesh unit to the fourth. */
  readonly gravity: number;
  /** Vertices of the mesh that are held, ascending. */
  readonly supports: readonly number[];
  /** Of supports that do not stay where they are, by ascending vertices. */
  readonly moves: readonly Move[];
}

export const VOLUME_SCALE_LIMITS = [0.2, 3] as const;
/** Supports that the server takes. */
export const MOST_SUPPORTS = 100_000;

/** Of the diagonal. */
const THICKNESS = 0.03;
/** Young's modulus of a shell times its thickness, in weights of springs: a net of springs of weight 1 bends it by some hundredths. */
const SHELL_STIFFNESS = 120;
/** Young's modulus of a solid times the diagonal, in weights of springs. */
const SOLID_STIFFNESS = 6000;
/** How much less or more than at first the page offers. */
const LEAST = 0.05;
const MOST = 10;
/** The strongest gravity that the page offers, in Young's moduli over the diagonal. */
const MOST_GRAVITY = 0.02;
const LOWEST_SHARE = 0.1;

const rounded = (value: number): number => Number(value.toPrecision(2));

/** A rigid surface, and a shell and a solid that give way visibly under springs of weight 1 on a mesh of such a diagonal. */
export function hostFor(diagonal: number): Host {
  const thickness = rounded(THICKNESS * diagonal);
  const shellModulus = rounded(SHELL_STIFFNESS / thickness);
  return {
    kind: "rigid", thickness, shellModulus, solidModulus: rounded(SOLID_STIFFNESS / diagonal), poissonRatio: 0.3,
    keepsVolume: false, volumeWeight: shellModulus, volumeScale: 1, bends: true, gravity: 0, supports: [], moves: [],
  };
}

export type HostLimits = Record<"thickness" | "shellModulus" | "solidModulus" | "volumeWeight" | "gravity", readonly [number, number]>;

/** What the page offers on a mesh, within what the server takes. */
export function hostLimits(diagonal: number): HostLimits {
  const { thickness, shellModulus, solidModulus } = hostFor(diagonal);
  const about = (value: number) => [rounded(LEAST * value), rounded(MOST * value)] as const;
  return {
    thickness: [rounded(LEAST * thickness), rounded(5 * thickness)], shellModulus: about(shellModulus), solidModulus: about(solidModulus),
    volumeWeight: about(shellModulus), gravity: [0, rounded((MOST_GRAVITY * solidModulus) / diagonal)],
  };
}

/** The same kind on another mesh, with lengths and moduli for its size and without supports. */
export function hostOnAnotherMesh({ kind, poissonRatio, keepsVolume, volumeScale, bends }: Host, { bounding_box }: Pick<Mesh, "bounding_box">): Host {
  return { ...hostFor(bounding_box.diagonal), kind, poissonRatio, keepsVolume, volumeScale, bends };
}

/** Holds a vertex, or lets it go. */
export function withSupport(host: Host, vertex: number): Host {
  const others = host.supports.filter((one) => one !== vertex);
  return withSupports(host, others.length < host.supports.length ? others : [...others, vertex].sort((a, b) => a - b));
}

/** Holds these vertices and no others. */
export function withSupports(host: Host, supports: readonly number[]): Host {
  const held = new Set(supports);
  return { ...host, supports, moves: host.moves.filter(({ vertex }) => held.has(vertex)) };
}

/** Where a support is taken, or where it stays. */
export function placeOfSupport({ moves }: Pick<Host, "moves">, { positions }: Pick<MeshData, "positions">, vertex: number): Vector {
  return moves.find((move) => move.vertex === vertex)?.to ?? [positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]];
}

/** Takes some supports as far as one of them goes to a place. */
export function withMoved(host: Host, mesh: Pick<MeshData, "positions">, vertices: readonly number[], one: number, to: Vector): Host {
  const from = placeOfSupport(host, mesh, one);
  const along = new Set(vertices);
  const moves = vertices.map((vertex): Move => {
    const place = placeOfSupport(host, mesh, vertex);
    return { vertex, to: vertex === one ? to : [place[0] + to[0] - from[0], place[1] + to[1] - from[1], place[2] + to[2] - from[2]] };
  });
  return { ...host, moves: [...host.moves.filter(({ vertex }) => !along.has(vertex)), ...moves].sort((a, b) => a.vertex - b.vertex) };
}

/** A support with those that edges between supports lead to from it, ascending. */
export function patchOf(supports: readonly number[], { faces }: Pick<MeshData, "faces">, one: number): number[] {
  const held = new Set(supports);
  const beside = new Map<number, number[]>();
  for (let k = 0; k < faces.length; k += 3) {
    const corners = [...faces.subarray(k, k + 3)].filter((vertex) => held.has(vertex));
    for (const vertex of corners) beside.set(vertex, [...(beside.get(vertex) ?? []), ...corners]);
  }
  const found = new Set([one]);
  const waiting = [one];
  for (let vertex = waiting.pop(); vertex !== undefined; vertex = waiting.pop())
    for (const other of beside.get(vertex) ?? []) if (!found.has(other)) waiting.push(other), found.add(other);
  return [...found].sort((a, b) => a - b);
}

/** The vertices in the lowest tenth of the mesh's height, by z. */
export function lowestVertices({ positions }: Pick<MeshData, "positions">): number[] {
  let [lower, upper] = [Infinity, -Infinity];
  for (let k = 2; k < positions.length; k += 3) [lower, upper] = [Math.min(lower, positions[k]), Math.max(upper, positions[k])];
  const found: number[] = [];
  for (let vertex = 0; 3 * vertex < positions.length; ++vertex) if (positions[3 * vertex + 2] <= lower + LOWEST_SHARE * (upper - lower)) found.push(vertex);
  return found;
}

/** The fields of a request that say what carries the network; none for a rigid surface. */
export function hostFields(host: Host): Pick<EmbeddedSystemRequest, "host"> {
  const moved = new Set(host.moves.map(({ vertex }) => vertex));
  const moves = host.moves.length > 0 && { moved_vertices: host.moves.map(({ vertex, to }) => ({ vertex, positions: [[...to]] })) };
  const common = { poisson_ratio: host.poissonRatio, fixed_vertices: host.supports.filter((vertex) => !moved.has(vertex)), ...moves };
  if (host.kind === "shell") {
    const volume = host.keepsVolume && { volume_weight: host.volumeWeight, volume_scale: host.volumeScale };
    return { host: { kind: "shell", thickness: host.thickness, youngs_modulus: host.shellModulus, ...common, ...volume } as EmbeddedSystemRequest["host"] };
  }
  if (host.kind === "solid") {
    const gravity = host.gravity > 0 && { gravity: [0, 0, -host.gravity] };
    return { host: { kind: "solid", youngs_modulus: host.solidModulus, ...common, ...gravity } as EmbeddedSystemRequest["host"] };
  }
  return {};
}

/** Why the host does not go with the mesh, in a sentence; null where it does. */
export function hostFault(host: Host, mesh: Pick<Mesh, "boundary_loops">): string | null {
  const isOpen = mesh.boundary_loops > 0;
  if (host.kind === "solid" && isOpen) return "This mesh has a boundary: only closed ones are surfaces of solids.";
  if (host.kind === "shell" && host.keepsVolume && isOpen) return "This mesh has a boundary: it encloses no volume to keep.";
  if (host.kind === "solid" && host.gravity > 0 && host.supports.length < 3) return "Under gravity a solid needs three supports that are not on one line.";
  if (host.kind !== "rigid" && host.moves.length > 0 && host.supports.length < 3) return "Where supports are moved, the host needs three that are not on one line.";
  return null;
}
