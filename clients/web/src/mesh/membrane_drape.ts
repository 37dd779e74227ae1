// A membrane laid onto the surface: its flat triangles, cut into small ones whose corners go to the surface's nearest points.
import { sidesOf, type Triple } from "./membrane";
import type { MeshData, Vector } from "./mesh_data";
import type { SurfaceGrid } from "./nearest_on_surface";

export interface Drape {
  /** Small triangles of each triangle of the membrane, which follow each other in its order. */
  readonly perTriangle: number;
  /** x, y, z of three corners of each small triangle, and the surface's normals there. */
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  /** x, y, z of both ends of each piece of the sides. */
  readonly sides: Float32Array;
}

/** Nearest points that a picture may cost, about. */
const NEAREST_POINTS = 16_000;
/** Parts of a side. */
const FEWEST_PARTS = 2;
const MOST_PARTS = 10;

function partsFor(triangles: number): number {
  return Math.max(FEWEST_PARTS, Math.min(MOST_PARTS, Math.round(Math.sqrt((2 * NEAREST_POINTS) / Math.max(1, triangles)))));
}

/** `vertexNormals`: x, y, z for each vertex of the mesh. */
export function drape(mesh: MeshData, grid: SurfaceGrid, vertexNormals: ArrayLike<number>, positions: readonly Vector[], triangles: readonly Triple[], parts = partsFor(triangles.length)): Drape {
  const small = parts * parts;
  const corners = new Float32Array(9 * small * triangles.length);
  const normals = new Float32Array(corners.length);
  let at = 0;
  const put = ([place, normal]: readonly [Vector, Vector]) => {
    corners.set(place, at);
    normals.set(normal, at);
    at += 3;
  };
  const landed = (flat: Vector): readonly [Vector, Vector] => {
    const { face, barycentric, position } = grid.nearest(flat);
    const normal = [0, 1, 2].map((axis) => [0, 1, 2].reduce((sum, k) => sum + barycentric[k] * vertexNormals[3 * mesh.faces[3 * face + k] + axis], 0));
    return [position, normal as unknown as Vector];
  };
  for (const [a, b, c] of triangles.map((triple) => triple.map((point) => positions[point]))) {
    const rows = Array.from({ length: parts + 1 }, (_, i) =>
      Array.from({ length: parts + 1 - i }, (_, j) => landed([0, 1, 2].map((axis) => a[axis] + (i / parts) * (b[axis] - a[axis]) + (j / parts) * (c[axis] - a[axis])) as unknown as Vector)));
    for (let i = 0; i < parts; ++i) {
      for (let j = 0; i + j < parts; ++j) {
        for (const corner of [rows[i][j], rows[i + 1][j], rows[i][j + 1]]) put(corner);
        if (i + j + 1 < parts) for (const corner of [rows[i + 1][j], rows[i + 1][j + 1], rows[i][j + 1]]) put(corner);
      }
    }
  }
  const all = sidesOf(triangles);
  const sides = new Float32Array(6 * parts * all.length);
  all.forEach(([from, to], side) => {
    const [a, b] = [positions[from], positions[to]];
    const places = Array.from({ length: parts + 1 }, (_, k) => landed([0, 1, 2].map((axis) => a[axis] + (k / parts) * (b[axis] - a[axis])) as unknown as Vector)[0]);
    for (let k = 0; k < parts; ++k) {
      sides.set(places[k], 6 * (side * parts + k));
      sides.set(places[k + 1], 6 * (side * parts + k) + 3);
    }
  });
  return { perTriangle: small, positions: corners, normals, sides };
}
