// A membrane draped over the surface: its plane triangles are subdivided, and the corners are projected to the nearest points of the surface.
import { sidesOf, type Triple } from "./membrane";
import type { MeshData, Vector } from "./mesh_data";
import type { SurfaceGrid } from "./nearest_on_surface";

export interface Drape {
  /** Number of small triangles for each triangle of the membrane. They are in the order of the membrane's triangles. */
  readonly perTriangle: number;
  /** x, y, z of three corners of each small triangle, and the surface's normals there. */
  readonly positions: Float32Array;
  readonly normals: Float32Array;
  /** x, y, z of both ends of each piece of the sides. */
  readonly sides: Float32Array;
}

/** Approximate number of nearest points that are computed for one picture. */
const NEAREST_POINTS = 16_000;
/** Limits of the number of parts of a side. */
const MIN_PARTS = 2;
const MAX_PARTS = 10;

function partsFor(triangles: number): number {
  return Math.max(MIN_PARTS, Math.min(MAX_PARTS, Math.round(Math.sqrt((2 * NEAREST_POINTS) / Math.max(1, triangles)))));
}

/** Drapes a membrane over a surface. `vertexNormals`: x, y, z for each vertex of the mesh; `parts`: number of parts of a side. */
export function drape(
  mesh: MeshData,
  grid: SurfaceGrid,
  vertexNormals: ArrayLike<number>,
  positions: readonly Vector[],
  triangles: readonly Triple[],
  parts = partsFor(triangles.length),
): Drape {
  const smallTriangles = parts * parts;
  const corners = new Float32Array(9 * smallTriangles * triangles.length);
  const normals = new Float32Array(corners.length);
  let at = 0;
  const append = ([place, normal]: readonly [Vector, Vector]) => {
    corners.set(place, at);
    normals.set(normal, at);
    at += 3;
  };
  const projected = (flat: Vector): readonly [Vector, Vector] => {
    const { face, barycentric, position } = grid.nearest(flat);
    const normal = [0, 1, 2].map((axis) => [0, 1, 2].reduce((sum, k) => sum + barycentric[k] * vertexNormals[3 * mesh.faces[3 * face + k] + axis], 0));
    return [position, normal as unknown as Vector];
  };
  for (const [a, b, c] of triangles.map((triple) => triple.map((point) => positions[point]))) {
    const rows = Array.from({ length: parts + 1 }, (_, i) =>
      Array.from({ length: parts + 1 - i }, (_, j) =>
        projected([0, 1, 2].map((axis) =>
          a[axis] + (i / parts) * (b[axis] - a[axis]) + (j / parts) * (c[axis] - a[axis])
        ) as unknown as Vector)));
    for (let i = 0; i < parts; ++i) {
      for (let j = 0; i + j < parts; ++j) {
        for (const corner of [rows[i][j], rows[i + 1][j], rows[i][j + 1]]) append(corner);
        if (i + j + 1 < parts) { for (const corner of [rows[i + 1][j], rows[i + 1][j + 1], rows[i][j + 1]]) append(corner); }
      }
    }
  }
  const all = sidesOf(triangles);
  const sides = new Float32Array(6 * parts * all.length);
  all.forEach(([from, to], side) => {
    const [a, b] = [positions[from], positions[to]];
    const places = Array.from({ length: parts + 1 }, (_, k) => projected([0, 1, 2].map((axis) => a[axis] + (k / parts) * (b[axis] - a[axis])) as unknown as Vector)[0]);
    for (let k = 0; k < parts; ++k) {
      sides.set(places[k], 6 * (side * parts + k));
      sides.set(places[k + 1], 6 * (side * parts + k) + 3);
    }
  });
  return { perTriangle: smallTriangles, positions: corners, normals, sides };
}
