// The coloured cells of a surface. Faces that belong to several cells are cut. It uses three.js and does not depend on the server.
import * as THREE from "three";
import { barycentricOf, type MeshData, type Vector, vertexPosition } from "./mesh_data";
import type { Rgb } from "./spring_colours";
import { facesMaterial } from "./surface_material";

export interface CellPicture {
  /** The cell of each face; null if the face is cut or belongs to no cell. */
  readonly faceSites: readonly (number | null)[];
  /** The pieces of cut faces, each a simple polygon. */
  readonly pieces: readonly { readonly site: number; readonly face: number; readonly corners: readonly Vector[] }[];
  /** The colour of each cell. */
  readonly colours: readonly Rgb[];
}

const PLAIN: Rgb = [0.5, 0.53, 0.55];

/** A triangulation of a polygon as indices of its corners, which are given in barycentric coordinates. Curved borders make non-convex polygons, for which a fan is wrong. */
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

/** The triangles of all cells: positions, normals interpolated from the surface, and colours. */
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
    const weightsOfCorners = corners.map((place) => barycentricOf(mesh, face, place));
    const cornerNormals = [0, 1, 2].map((corner) => normalAt(mesh.faces[3 * face + corner]));
    const interpolated = weightsOfCorners.map((weights) =>
      [0, 1, 2].map((axis) => weights[0] * cornerNormals[0][axis] + weights[1] * cornerNormals[1][axis] + weights[2] * cornerNormals[2][axis]) as unknown as Vector
    );
    for (const triangle of polygonTriangles(weightsOfCorners)) for (const corner of triangle) add(corners[corner], interpolated[corner], picture.colours[site]);
  }
  return result;
}

export class CellDrawing {
  readonly group = new THREE.Group();
  private readonly material = facesMaterial();
  private cells: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;

  /** Shows the cells of a mesh; null removes them. */
  show(mesh: MeshData | null, normals: ArrayLike<number>, picture: CellPicture | null): void {
    this.cells?.geometry.dispose();
    this.group.clear();
    this.cells = null;
    if (!mesh || !picture) return;
    const { places, normals: interpolated, colours } = cellTriangles(mesh, normals, picture);
    const geometry = new THREE.BufferGeometry();
    for (const [name, values] of [["position", places], ["normal", interpolated], ["colour", colours]] as const) geometry.setAttribute(name, new THREE.BufferAttribute(values, 3));
    this.cells = new THREE.Mesh(geometry, this.material);
    this.cells.frustumCulled = false;
    this.group.add(this.cells);
  }
}
