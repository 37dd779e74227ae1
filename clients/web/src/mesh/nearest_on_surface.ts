// The point of a surface that is nearest to a place in space, by a grid of cells that know the faces in them.
import { type MeshData, type Vector, vertexPosition } from "./mesh_data";

export interface NearestPoint {
  readonly face: number;
  readonly barycentric: Vector;
  readonly position: Vector;
}

/** Cells for each face, at most. */
const CELLS_PER_FACE = 2;
const AXES = [0, 1, 2] as const;

export class SurfaceGrid {
  private readonly lower: number[];
  private readonly cells: number[];
  private readonly size: number;
  /** Faces of cell k: from starts[k] to starts[k + 1]. */
  private readonly starts: Uint32Array;
  private readonly faces: Uint32Array;
  /** The query in which a face was looked at last. */
  private readonly seen: Uint32Array;
  private query = 0;

  constructor(private readonly mesh: MeshData) {
    const count = mesh.faces.length / 3;
    const upper = [-Infinity, -Infinity, -Infinity];
    this.lower = [Infinity, Infinity, Infinity];
    for (let k = 0; k < mesh.positions.length; ++k) {
      this.lower[k % 3] = Math.min(this.lower[k % 3], mesh.positions[k]);
      upper[k % 3] = Math.max(upper[k % 3], mesh.positions[k]);
    }
    const extent = AXES.map((axis) => upper[axis] - this.lower[axis]);
    const most = Math.max(...extent) || 1;
    const volume = extent.reduce((product, length) => product * Math.max(length, most / 100), 1);
    this.size = Math.max(Math.cbrt(volume / (CELLS_PER_FACE * count)), most / 500);
    this.cells = extent.map((length) => Math.max(1, Math.ceil(length / this.size)));
    const [starts, faces] = this.filled(count);
    this.starts = starts;
    this.faces = faces;
    this.seen = new Uint32Array(count);
  }

  nearest(place: Vector): NearestPoint {
    ++this.query;
    const home = AXES.map((axis) => this.cellAlong(axis, place[axis]));
    let found: NearestPoint | null = null;
    let least = Infinity;
    const rings = Math.max(...this.cells);
    for (let ring = 0; ring <= rings && least > Math.max(0, ring - 1) * this.size; ++ring) {
      this.eachOfRing(home, ring, (face) => {
        const point = nearestOfFace(this.mesh, face, place);
        const away = distance(point.position, place);
        if (away < least) [found, least] = [point, away];
      });
    }
    return found ?? nearestOfFace(this.mesh, 0, place);
  }

  private cellAlong(axis: number, coordinate: number): number {
    return Math.min(this.cells[axis] - 1, Math.max(0, Math.floor((coordinate - this.lower[axis]) / this.size)));
  }

  private index(x: number, y: number, z: number): number {
    return (z * this.cells[1] + y) * this.cells[0] + x;
  }

  private filled(count: number): [Uint32Array, Uint32Array] {
    const starts = new Uint32Array(this.cells[0] * this.cells[1] * this.cells[2] + 1);
    const each = (act: (cell: number, face: number) => void) => {
      for (let face = 0; face < count; ++face) {
        const corners = AXES.map((k) => vertexPosition(this.mesh, this.mesh.faces[3 * face + k]));
        const [from, to] = [Math.min, Math.max].map((choose) => AXES.map((axis) => this.cellAlong(axis, choose(corners[0][axis], corners[1][axis], corners[2][axis]))));
        for (let z = from[2]; z <= to[2]; ++z) for (let y = from[1]; y <= to[1]; ++y) for (let x = from[0]; x <= to[0]; ++x) act(this.index(x, y, z), face);
      }
    };
    each((cell) => ++starts[cell + 1]);
    for (let k = 1; k < starts.length; ++k) starts[k] += starts[k - 1];
    const faces = new Uint32Array(starts[starts.length - 1]);
    const next = starts.slice();
    each((cell, face) => (faces[next[cell]++] = face));
    return [starts, faces];
  }

  /** The faces of all cells that are so many cells away from one, each once in a query. */
  private eachOfRing(home: readonly number[], ring: number, act: (face: number) => void): void {
    const [from, to] = [AXES.map((axis) => Math.max(0, home[axis] - ring)), AXES.map((axis) => Math.min(this.cells[axis] - 1, home[axis] + ring))];
    for (let z = from[2]; z <= to[2]; ++z) {
      for (let y = from[1]; y <= to[1]; ++y) {
        const outer = Math.abs(z - home[2]) === ring || Math.abs(y - home[1]) === ring;
        for (let x = from[0]; x <= to[0]; ++x) {
          if (!outer && Math.abs(x - home[0]) !== ring) continue;
          const cell = this.index(x, y, z);
          for (let k = this.starts[cell]; k < this.starts[cell + 1]; ++k) {
            const face = this.faces[k];
            if (this.seen[face] === this.query) continue;
            this.seen[face] = this.query;
            act(face);
          }
        }
      }
    }
  }
}

function distance(a: Vector, b: Vector): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** Ericson 2005, Real-Time Collision Detection, 5.1.5: by the regions of a triangle's corners, sides and inside. */
function nearestOfFace(mesh: MeshData, face: number, place: Vector): NearestPoint {
  const [a, b, c] = AXES.map((k) => vertexPosition(mesh, mesh.faces[3 * face + k]));
  const dot = (u: Vector, v: Vector) => u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
  const minus = (u: Vector, v: Vector): Vector => [u[0] - v[0], u[1] - v[1], u[2] - v[2]];
  const at = (first: number, second: number, third: number): NearestPoint => ({
    face,
    barycentric: [first, second, third],
    position: AXES.map((axis) => first * a[axis] + second * b[axis] + third * c[axis]) as unknown as Vector,
  });
  const [ab, ac] = [minus(b, a), minus(c, a)];
  const fromA = minus(place, a);
  const [d1, d2] = [dot(ab, fromA), dot(ac, fromA)];
  if (d1 <= 0 && d2 <= 0) return at(1, 0, 0);
  const fromB = minus(place, b);
  const [d3, d4] = [dot(ab, fromB), dot(ac, fromB)];
  if (d3 >= 0 && d4 <= d3) return at(0, 1, 0);
  const ofC = d1 * d4 - d3 * d2;
  if (ofC <= 0 && d1 >= 0 && d3 <= 0) return at(1 - d1 / (d1 - d3), d1 / (d1 - d3), 0);
  const fromC = minus(place, c);
  const [d5, d6] = [dot(ab, fromC), dot(ac, fromC)];
  if (d6 >= 0 && d5 <= d6) return at(0, 0, 1);
  const ofB = d5 * d2 - d1 * d6;
  if (ofB <= 0 && d2 >= 0 && d6 <= 0) return at(1 - d2 / (d2 - d6), 0, d2 / (d2 - d6));
  const ofA = d3 * d6 - d5 * d4;
  if (ofA <= 0 && d4 >= d3 && d5 >= d6) {
    const share = (d4 - d3) / (d4 - d3 + (d5 - d6));
    return at(0, 1 - share, share);
  }
  const sum = ofA + ofB + ofC;
  return at(ofA / sum, ofB / sum, ofC / sum);
}
