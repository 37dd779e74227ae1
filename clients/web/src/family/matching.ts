// Edges of the tiles of a cell that lie on each other, and what has to move with a vertex so that they still do. The tiles of a definition
// meet edge to edge. Each pair of edges is two equations, which are linear in the vertices, the translations and the offsets of the copies.
import { latticeCoordinates } from "../base/plane";
import { pointAt, type Vector } from "./expressions";
import { Constraints, rankOf, solved, type Symmetric, unitVector } from "./linear";
import { type DrawnFamily, placed } from "./tiling";

/** Ends of edges that are nearer than this fraction of the tile's size are the same. */
const TOLERANCE = 1e-6;
/** Part of a pull that a vertex has to follow, squared over the squares of all that move with it: otherwise the others would move ten times as far. */
const MIN_MOBILITY = 0.01;

/** An edge of a placed tile, in the order in which its tile runs counterclockwise. */
interface PlacedEdge {
  readonly placement: number;
  /** Vertices of the tile at its ends. */
  readonly ends: readonly [number, number];
  readonly from: Vector;
  readonly to: Vector;
}

/** Two edges that lie on each other when the second is moved by `shift`, in multiples of the two translations. */
interface Pair {
  readonly first: PlacedEdge;
  readonly second: PlacedEdge;
  readonly shift: Vector;
}

function placedEdges({ tile }: DrawnFamily, parameters: readonly number[]): PlacedEdge[] {
  const vertices = tile.vertices.map((vertex) => pointAt(vertex, parameters));
  return tile.placements.flatMap(({ linear, offset }, placement) => {
    const at = pointAt(offset, parameters);
    const corners = vertices.map((vertex) => placed(linear, at, vertex));
    const isMirrored = linear[0] * linear[3] - linear[1] * linear[2] < 0;
    return corners.map((corner, k): PlacedEdge => {
      const next = (k + 1) % corners.length;
      return isMirrored ? { placement, ends: [next, k], from: corners[next], to: corner } : { placement, ends: [k, next], from: corner, to: corners[next] };
    });
  });
}

/** The pairs of edges that lie on each other at parameters. An edge at a gap or an overlap is in none. */
export function edgePairs(family: DrawnFamily, parameters: readonly number[]): Pair[] {
  const edges = placedEdges(family, parameters);
  const [a, b] = family.tile.translations.map((translation) => pointAt(translation, parameters));
  const size = Math.max(...edges.flatMap(({ from, to }) => [Math.hypot(to[0] - from[0], to[1] - from[1])]));
  const meets = ([x, y]: Vector, [u, v]: Vector, [i, k]: Vector) => Math.hypot(x - u - i * a[0] - k * b[0], y - v - i * a[1] - k * b[1]) < TOLERANCE * size;
  const pairs: Pair[] = [];
  edges.forEach((first, n) => {
    for (const second of edges.slice(n)) {
      const [u, v] = latticeCoordinates([a, b], [first.from[0] - second.to[0], first.from[1] - second.to[1]]);
      const shift: Vector = [Math.round(u), Math.round(v)];
      // Neighbouring tiles run along their common edge in opposite directions.
      if (meets(first.from, second.to, shift) && meets(first.to, second.from, shift)) pairs.push({ first, second, shift });
    }
  });
  return pairs;
}

/** What a vertex of the tile takes along: the moves of all vertices, translations and offsets. */
export interface Move {
  readonly vertices: readonly Vector[];
  readonly translations: readonly Vector[];
  readonly offsets: readonly Vector[];
}

/** Places of the unknowns in a move: vertices, translations, and the offsets of all copies but the first, which stays. */
class Unknowns {
  readonly size: number;

  constructor(private readonly vertices: number, private readonly placements: number) {
    this.size = 2 * (vertices + 2 + placements - 1);
  }

  vertex(index: number): number {
    return 2 * index;
  }

  translation(index: number): number {
    return 2 * (this.vertices + index);
  }

  /** Negative for the first copy. */
  offset(placement: number): number {
    return placement === 0 ? -1 : 2 * (this.vertices + 2 + placement - 1);
  }

  read(values: Float64Array): Move {
    const pairs = Array.from({ length: this.size / 2 }, (_, k): Vector => [values[2 * k], values[2 * k + 1]]);
    const rest = pairs.slice(this.vertices + 2);
    return {
      vertices: pairs.slice(0, this.vertices),
      translations: pairs.slice(this.vertices, this.vertices + 2),
      offsets: Array.from({ length: this.placements }, (_, k): Vector => (k === 0 ? [0, 0] : rest[k - 1])),
    };
  }
}

/** The equations of all pairs of edges: the ends of the first lie on those of the second, also after a move. */
function equations({ tile }: DrawnFamily, pairs: readonly Pair[], unknowns: Unknowns): Float64Array[] {
  return pairs.flatMap(({ first, second, shift }) =>
    [0, 1].flatMap((end) =>
      [0, 1].map((axis) => {
        const row = new Float64Array(unknowns.size);
        const add = (edge: PlacedEdge, vertex: number, sign: number) => {
          const { linear } = tile.placements[edge.placement];
          for (const column of [0, 1]) row[unknowns.vertex(vertex) + column] += sign * linear[2 * axis + column];
          const offset = unknowns.offset(edge.placement);
          if (offset >= 0) row[offset + axis] += sign;
        };
        add(first, first.ends[end], 1);
        add(second, second.ends[1 - end], -1);
        for (const k of [0, 1]) row[unknowns.translation(k) + axis] -= shift[k];
        return row;
      })
    )
  );
}

/** How far a vertex follows when it is pulled along x and along y, as a symmetric matrix. */
function mobility(constraints: Constraints, at: number): { readonly matrix: Symmetric; readonly moves: readonly [Float64Array, Float64Array] } {
  const moves = [constraints.projected(unitVector(constraints.size, at)), constraints.projected(unitVector(constraints.size, at + 1))] as const;
  return { matrix: [moves[0][at], (moves[0][at + 1] + moves[1][at]) / 2, moves[1][at + 1]], moves };
}

/** How the vertices of a tile may move so that all edges still lie on each other. */
export class TileMotion {
  private readonly unknowns: Unknowns;
  private readonly constraints: Constraints;
  private readonly count: number;

  /** Cubic in the number of vertices and copies. */
  constructor(family: DrawnFamily, parameters: readonly number[]) {
    this.count = family.tile.vertices.length;
    this.unknowns = new Unknowns(this.count, family.tile.placements.length);
    this.constraints = Constraints.none(this.unknowns.size).with(equations(family, edgePairs(family, parameters), this.unknowns));
  }

  canMove(vertex: number): boolean {
    return rankOf(mobility(this.constraints, this.unknowns.vertex(vertex)).matrix, MIN_MOBILITY) > 0;
  }

  /**
   * What moves when a vertex is dragged by some vector; null if the vertex cannot move. The other vertices stay where they can, first
   * those that are near along the outline.
   */
  movesOf(vertex: number): ((by: Vector) => Move) | null {
    const { unknowns, count } = this;
    const at = unknowns.vertex(vertex);
    let { constraints } = this;
    const rank = rankOf(mobility(constraints, at).matrix, MIN_MOBILITY);
    if (rank === 0) return null;
    const others = Array.from({ length: count }, (_, k) => k).filter((k) => k !== vertex);
    const distance = (k: number) => Math.min(Math.abs(k - vertex), count - Math.abs(k - vertex));
    for (const other of others.sort((p, q) => distance(p) - distance(q))) {
      const place = unknowns.vertex(other);
      const fixing = constraints.with([unitVector(unknowns.size, place), unitVector(unknowns.size, place + 1)]);
      if (rankOf(mobility(fixing, at).matrix, MIN_MOBILITY) === rank) constraints = fixing;
    }
    const { matrix, moves } = mobility(constraints, at);
    return (by) => {
      const [x, y] = solved(matrix, by, MIN_MOBILITY);
      return unknowns.read(moves[0].map((value, k) => tidied(x * value + y * moves[1][k])));
    };
  }
}

/** Moves of the size of rounding errors are none, so that the numbers of what stays in place stay the same. */
function tidied(value: number): number {
  return Math.abs(value) < 1e-12 ? 0 : value;
}
