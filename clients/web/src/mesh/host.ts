// The host of a network, as the user has chosen it: a rigid surface, a thin shell or an elastic solid, and its supports.
import type { EmbeddedSystemRequest, Mesh } from "../contract/types";
import type { MeshData, Vector } from "./mesh_data";

export type HostKind = "rigid" | "shell" | "solid";
export const HOST_KINDS: readonly HostKind[] = ["rigid", "shell", "solid"];

/** The displacement of a support to a position in mesh units, which is applied after the first equilibrium. */
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
  /** Poisson's ratio of the shell or the solid. */
  readonly poissonRatio: number;
  readonly keepsVolume: boolean;
  readonly volumeWeight: number;
  /** The enclosed volume that is kept, over the volume at rest. */
  readonly volumeScale: number;
  readonly bends: boolean;
  /** Force per volume in the direction of -z, in energy per mesh unit to the fourth. */
  readonly gravity: number;
  /** Fixed vertices of the mesh, ascending. */
  readonly supports: readonly number[];
  /** Displacements of supports, by ascending vertex. */
  readonly moves: readonly Move[];
}

export const VOLUME_SCALE_LIMITS = [0.2, 3] as const;
/** The server's limit of the number of supports. */
export const MAX_SUPPORTS = 100_000;

/** Initial thickness of a shell over the diagonal of the mesh. */
const THICKNESS_RATIO = 0.03;
/** Young's modulus of a shell times its thickness, in weights of springs. With it, a network of springs of weight 1 deforms the shell by a few per cent. */
const SHELL_STIFFNESS = 120;
/** Young's modulus of a solid times the diagonal, in weights of springs. */
const SOLID_STIFFNESS = 6000;
/** The page offers values from the initial one times MIN_FACTOR to the initial one times MAX_FACTOR. */
const MIN_FACTOR = 0.05;
const MAX_FACTOR = 10;
/** Upper limit of gravity on the page, in Young's moduli over the diagonal. */
const MAX_GRAVITY = 0.02;
/** Fraction of the mesh's height in which vertices count as the lowest. */
const LOWEST_FRACTION = 0.1;

const rounded = (value: number): number => Number(value.toPrecision(2));

/** The initial host on a mesh with a diagonal: rigid, with parameters of a shell and a solid that springs of weight 1 deform visibly. */
export function defaultHost(diagonal: number): Host {
  const thickness = rounded(THICKNESS_RATIO * diagonal);
  const shellModulus = rounded(SHELL_STIFFNESS / thickness);
  return {
    kind: "rigid",
    thickness,
    shellModulus,
    solidModulus: rounded(SOLID_STIFFNESS / diagonal),
    poissonRatio: 0.3,
    keepsVolume: false,
    volumeWeight: shellModulus,
    volumeScale: 1,
    bends: true,
    gravity: 0,
    supports: [],
    moves: [],
  };
}

export type HostLimits = Record<"thickness" | "shellModulus" | "solidModulus" | "volumeWeight" | "gravity", readonly [number, number]>;

/** The page's limits on a mesh, which lie within the server's. */
export function hostLimits(diagonal: number): HostLimits {
  const { thickness, shellModulus, solidModulus } = defaultHost(diagonal);
  const limitsAround = (value: number) => [rounded(MIN_FACTOR * value), rounded(MAX_FACTOR * value)] as const;
  return {
    thickness: [rounded(MIN_FACTOR * thickness), rounded(5 * thickness)],
    shellModulus: limitsAround(shellModulus),
    solidModulus: limitsAround(solidModulus),
    volumeWeight: limitsAround(shellModulus),
    gravity: [0, rounded((MAX_GRAVITY * solidModulus) / diagonal)],
  };
}

/** A host of the same kind for another mesh, with lengths and moduli for its size and without supports. */
export function hostOnAnotherMesh({ kind, poissonRatio, keepsVolume, volumeScale, bends }: Host, { bounding_box }: Pick<Mesh, "bounding_box">): Host {
  return { ...defaultHost(bounding_box.diagonal), kind, poissonRatio, keepsVolume, volumeScale, bends };
}

/** Fixes a vertex, or releases it if it is fixed. */
export function withToggledSupport(host: Host, vertex: number): Host {
  const others = host.supports.filter((one) => one !== vertex);
  return withSupports(host, others.length < host.supports.length ? others : [...others, vertex].sort((a, b) => a - b));
}

/** Fixes these vertices and no others. */
export function withSupports(host: Host, supports: readonly number[]): Host {
  const supported = new Set(supports);
  return { ...host, supports, moves: host.moves.filter(({ vertex }) => supported.has(vertex)) };
}

/** The position of a support after its displacement. */
export function supportPosition({ moves }: Pick<Host, "moves">, { positions }: Pick<MeshData, "positions">, vertex: number): Vector {
  return moves.find((move) => move.vertex === vertex)?.to ?? [positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]];
}

/** Displaces several supports by the vector that takes support `one` to a position. */
export function withMovedSupports(host: Host, mesh: Pick<MeshData, "positions">, vertices: readonly number[], one: number, to: Vector): Host {
  const from = supportPosition(host, mesh, one);
  const group = new Set(vertices);
  const moves = vertices.map((vertex): Move => {
    const place = supportPosition(host, mesh, vertex);
    return { vertex, to: vertex === one ? to : [place[0] + to[0] - from[0], place[1] + to[1] - from[1], place[2] + to[2] - from[2]] };
  });
  return { ...host, moves: [...host.moves.filter(({ vertex }) => !group.has(vertex)), ...moves].sort((a, b) => a.vertex - b.vertex) };
}

/** The supports that are connected to one of them by edges between supports, ascending. */
export function connectedSupports(supports: readonly number[], { faces }: Pick<MeshData, "faces">, one: number): number[] {
  const supported = new Set(supports);
  const neighbours = new Map<number, number[]>();
  for (let k = 0; k < faces.length; k += 3) {
    const corners = [...faces.subarray(k, k + 3)].filter((vertex) => supported.has(vertex));
    for (const vertex of corners) neighbours.set(vertex, [...(neighbours.get(vertex) ?? []), ...corners]);
  }
  const found = new Set([one]);
  const pending = [one];
  for (let vertex = pending.pop(); vertex !== undefined; vertex = pending.pop()) {
    for (const other of neighbours.get(vertex) ?? []) {
      if (found.has(other)) continue;
      found.add(other);
      pending.push(other);
    }
  }
  return [...found].sort((a, b) => a - b);
}

/** The vertices in the lowest tenth of the mesh's height, by z. */
export function lowestVertices({ positions }: Pick<MeshData, "positions">): number[] {
  let [lower, upper] = [Infinity, -Infinity];
  for (let k = 2; k < positions.length; k += 3) [lower, upper] = [Math.min(lower, positions[k]), Math.max(upper, positions[k])];
  const found: number[] = [];
  for (let vertex = 0; 3 * vertex < positions.length; ++vertex) if (positions[3 * vertex + 2] <= lower + LOWEST_FRACTION * (upper - lower)) found.push(vertex);
  return found;
}

/** The host in a request; no fields for a rigid surface. */
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

/** A sentence that says why the host is impossible on a mesh; null if it is possible. */
export function hostFault(host: Host, mesh: Pick<Mesh, "boundary_loops">): string | null {
  const isOpen = mesh.boundary_loops > 0;
  if (host.kind === "solid" && isOpen) return "This mesh has a boundary: only closed ones are surfaces of solids.";
  if (host.kind === "shell" && host.keepsVolume && isOpen) return "This mesh has a boundary: it encloses no volume to keep.";
  if (host.kind === "solid" && host.gravity > 0 && host.supports.length < 3) return "Under gravity a solid needs three supports that are not on one line.";
  if (host.kind !== "rigid" && host.moves.length > 0 && host.supports.length < 3) return "Where supports are moved, the host needs three that are not on one line.";
  return null;
}
