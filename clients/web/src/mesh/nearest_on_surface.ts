// The nearest point of a surface to a position in space, with a uniform grid whose cells list the faces in them.
import { type MeshData, type Vector, vertexPosition } from "./mesh_data";

export interface NearestPoint {
  readonly face: number;
  readonly barycentric: Vector;
  readonly position: Vector;
}

/** Number of grid cells for each face, at most approximately. */
const CELLS_PER_FACE = 2;
const AXES = [0, 1, 2] as const;

export class SurfaceGrid {
  private readonly lower: number[];
  private readonly cells: number[];
  private readonly size: number;
  /** The faces of cell k are faces[starts[k]] to faces[starts[k + 1] - 1]. */
  private readonly starts: Uint32Array;
  private readonly faces: Uint32Array;
  /** Number of the query that has visited each face last, so that a query visits a face once. */
  private readonly lastQuery: Uint32Array;
  private query = 0;
  /** The nearest face of the present query so far, and its squared distance. */
  private nearestFace = 0;
  private minSquared = Infinity;
  private readonly weights = new Float64Array(3);

  constructor(private readonly mesh: MeshData) {
    const count = mesh.faces.length / 3;
    const upper = [-Infinity, -Infinity, -Infinity];
    this.lower = [Infinity, Infinity, Infinity];
    for (let k = 0; k < mesh.positions.length; ++k) {
      this.lower[k % 3] = Math.min(this.lower[k % 3], mesh.positions[k]);
      upper[k % 3] = Math.max(upper[k % 3], mesh.positions[k]);
    }
    const extent = AXES.map((axis) => upper[axis] - this.lower[axis]);
    const maxExtent = Math.max(...extent) || 1;
    const volume = extent.reduce((product, length) => product * Math.max(length, maxExtent / 100), 1);
    this.size = Math.max(Math.cbrt(volume / (CELLS_PER_FACE * count)), maxExtent / 500);
    this.cells = extent.map((length) => Math.max(1, Math.ceil(length / this.size)));
    const [starts, faces] = this.facesByCell(count);
    this.starts = starts;
    this.faces = faces;
    this.lastQuery = new Uint32Array(count);
  }

  nearest(place: Vector): NearestPoint {
    ++this.query;
    const homeCell = AXES.map((axis) => this.cellAlong(axis, place[axis]));
    this.nearestFace = 0;
    this.minSquared = Infinity;
    const rings = Math.max(...this.cells);
    for (let ring = 0; ring <= rings && this.minSquared > (Math.max(0, ring - 1) * this.size) ** 2; ++ring) this.searchRing(homeCell, ring, place);
    squaredDistance(this.mesh, this.nearestFace, place, this.weights);
    const [first, second, third] = this.weights;
    const [a, b, c] = AXES.map((k) => vertexPosition(this.mesh, this.mesh.faces[3 * this.nearestFace + k]));
    return { face: this.nearestFace, barycentric: [first, second, third], position: AXES.map((axis) => first * a[axis] + second * b[axis] + third * c[axis]) as unknown as Vector };
  }

  private cellAlong(axis: number, coordinate: number): number {
    return Math.min(this.cells[axis] - 1, Math.max(0, Math.floor((coordinate - this.lower[axis]) / this.size)));
  }

  private index(x: number, y: number, z: number): number {
    return (z * this.cells[1] + y) * this.cells[0] + x;
  }

  private facesByCell(count: number): [Uint32Array, Uint32Array] {
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

  /** Searches the faces of all cells at a Chebyshev distance of `ring` cells from a cell. */
  private searchRing(homeCell: readonly number[], ring: number, place: Vector): void {
    const [from, to] = [AXES.map((axis) => Math.max(0, homeCell[axis] - ring)), AXES.map((axis) => Math.min(this.cells[axis] - 1, homeCell[axis] + ring))];
    for (let z = from[2]; z <= to[2]; ++z) {
      for (let y = from[1]; y <= to[1]; ++y) {
        const outer = Math.abs(z - homeCell[2]) === ring || Math.abs(y - homeCell[1]) === ring;
        for (let x = from[0]; x <= to[0]; ++x) {
          if (!outer && Math.abs(x - homeCell[0]) !== ring) continue;
          const cell = this.index(x, y, z);
          for (let k = this.starts[cell]; k < this.starts[cell + 1]; ++k) this.searchFace(this.faces[k], place);
        }
      }
    }
  }

  private searchFace(face: number, place: Vector): void {
    if (this.lastQuery[face] === this.query) return;
    this.lastQuery[face] = this.query;
    const squared = squaredDistance(this.mesh, face, place, this.weights);
    if (squared < this.minSquared) [this.nearestFace, this.minSquared] = [face, squared];
  }
}

/**
 * The squared distance of a position from a face. `weights` receives the barycentric coordinates of the nearest point, which is found
 * by the Voronoi regions of the triangle's corners, sides and interior [Ericson2005, 5.1.5]. A picture of a membrane calls this some
 * hundred thousand times, so that nothing is allocated that the garbage collector would have to free.
 */
function squaredDistance({ positions, faces }: MeshData, face: number, place: Vector, weights: Float64Array): number {
  const [a, b, c] = [3 * faces[3 * face], 3 * faces[3 * face + 1], 3 * faces[3 * face + 2]];
  const [ax, ay, az] = [positions[a], positions[a + 1], positions[a + 2]];
  const [abx, aby, abz] = [positions[b] - ax, positions[b + 1] - ay, positions[b + 2] - az];
  const [acx, acy, acz] = [positions[c] - ax, positions[c + 1] - ay, positions[c + 2] - az];
  const [px, py, pz] = [place[0] - ax, place[1] - ay, place[2] - az];
  // Dot products of the sides ab and ac with the vectors from a, b and c to the position.
  const [d1, d2] = [abx * px + aby * py + abz * pz, acx * px + acy * py + acz * pz];
  const [aa, ab, bb] = [abx * abx + aby * aby + abz * abz, abx * acx + aby * acy + abz * acz, acx * acx + acy * acy + acz * acz];
  const [d3, d4, d5, d6] = [d1 - aa, d2 - ab, d1 - ab, d2 - bb];
  const [ofA, ofB, ofC] = [d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2];
  let [second, third] = [0, 0];
  if (d1 <= 0 && d2 <= 0) [second, third] = [0, 0];
  else if (d3 >= 0 && d4 <= d3) [second, third] = [1, 0];
  else if (ofC <= 0 && d1 >= 0 && d3 <= 0) [second, third] = [d1 / (d1 - d3), 0];
  else if (d6 >= 0 && d5 <= d6) [second, third] = [0, 1];
  else if (ofB <= 0 && d2 >= 0 && d6 <= 0) [second, third] = [0, d2 / (d2 - d6)];
  else if (ofA <= 0 && d4 >= d3 && d5 >= d6) {
    third = (d4 - d3) / (d4 - d3 + (d5 - d6));
    second = 1 - third;
  } else {
    const sum = ofA + ofB + ofC;
    [second, third] = [ofB / sum, ofC / sum];
  }
  weights[0] = 1 - second - third;
  weights[1] = second;
  weights[2] = third;
  const [x, y, z] = [second * abx + third * acx - px, second * aby + third * acy - py, second * abz + third * acz - pz];
  return x * x + y * y + z * z;
}
