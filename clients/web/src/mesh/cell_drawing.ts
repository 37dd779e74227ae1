// Cells of a surface in their colours, cut where faces belong to several. Knows three.js and nothing of the server.
import * as THREE from "three";
import { barycentricOf, type MeshData, type Vector, vertexPosition } from "./mesh_data";
import type { Rgb } from "./spring_colours";
import { facesMaterial } from "./surface_material";

export interface CellPicture {
  /** Of each face its cell; null where it is cut, or in none. */
  readonly faceSites: readonly (number | null)[];
  /** Of cut faces, each a simple polygon. */
  readonly pieces: readonly { readonly site: number; readonly face: number; readonly corners: readonly Vector[] }[];
  /** Of each cell. */
  readonly colours: readonly Rgb[];
}

const PLAIN: Rgb = [0.5, 0.53, 0.55];

/** Triangles of a polygon as indices of its corners, given by weights in its face: curved borders leave polygons that no fan fills. */
function polygonTriangles(weights: readonly Vector[]): readonly (readonly number[])[] {
  const corners = weights.map(([, x, y]) => new THREE.Vector2(x, y));
  const turns = corners.map((corner, k) => {
    const next = corners[(k + 1) % corners.length];
    return next.clone().sub(corner).cross(corners[(k + 2) % corners.length].clone().sub(next));
  });
  const fan = corners.slice(2).map((_, k) => [0, k + 1, k + 2]);
  if (turns.every((turn) => turn >= 0)) return fan;
  const triangles = THREE.ShapeUtils.triangulateShape(corners, []);
  return triangles.length === fan.length ? triangles : fan;
}

/** Triangles of all cells: places, normals as the whole surface has them, and colours. */
export function cellTriangles(mesh: MeshData, normals: ArrayLike<number>, picture: CellPicture): { places: Float32Array; normals: Float32Array; colours: Float32Array } {
  const cut = new Set(picture.pieces.map((piece) => piece.face));
  const faces = picture.faceSites.length - cut.size;
  const count = faces + picture.pieces.reduce((sum, piece) => sum + Math.max(0, piece.corners.length - 2), 0);
  const result = { places: new Float32Array(9 * count), normals: new Float32Array(9 * count), colours: new Float32Array(9 * count) };
  let at = 0;
  const add = (place: Vector, normal: Vector, colour: Rgb) => {
    result.places.set(place, at);
    result.normals.set(normal, at);
    result.colours.set(colour, at);
    at += 3;
  };
  const normalAt = (vertex: number): Vector => [normals[3 * vertex], normals[3 * vertex + 1], normals[3 * vertex + 2]];
  picture.faceSites.forEach((site, face) => {
    if (cut.has(face)) return;
    const colour = site === null ? PLAIN : picture.colours[site];
    for (let corner = 0; corner < 3; ++corner) {
      const vertex = mesh.faces[3 * face + corner];
      add(vertexPosition(mesh, vertex), normalAt(vertex), colour);
    }
  });
  for (const { site, face, corners } of picture.pieces) {
    const all = corners.map((place) => barycentricOf(mesh, face, place));
    const own = [0, 1, 2].map((corner) => normalAt(mesh.faces[3 * face + corner]));
    const bent = all.map((weights) => [0, 1, 2].map((axis) => weights[0] * own[0][axis] + weights[1] * own[1][axis] + weights[2] * own[2][axis]) as unknown as Vector);
    for (const triangle of polygonTriangles(all)) for (const corner of triangle) add(corners[corner], bent[corner], picture.colours[site]);
  }
  return result;
}

export class CellDrawing {
  readonly group = new THREE.Group();
  private readonly material = facesMaterial();
  private cells: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;

  /** Null takes them away. */
  show(mesh: MeshData | null, normals: ArrayLike<number>, picture: CellPicture | null): void {
    this.cells?.geometry.dispose();
    this.group.clear();
    this.cells = null;
    if (!mesh || !picture) return;
    const { places, normals: bent, colours } = cellTriangles(mesh, normals, picture);
    const geometry = new THREE.BufferGeometry();
    for (const [name, values] of [["position", places], ["normal", bent], ["colour", colours]] as const) geometry.setAttribute(name, new THREE.BufferAttribute(values, 3));
    this.cells = new THREE.Mesh(geometry, this.material);
    this.cells.frustumCulled = false;
    this.group.add(this.cells);
  }
}
