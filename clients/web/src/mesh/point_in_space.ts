// A position in space that selects the nearest point of a surface.
import type { SurfacePoint } from "../contract/types";
import type { MeshData, Vector } from "./mesh_data";
import { SurfaceGrid } from "./nearest_on_surface";

/** A position from a text such as "@1,2.5,-3"; null if the text is invalid. */
export function readPlace(text: string): Vector | null {
  if (!text.trim().startsWith("@")) return null;
  const words = text.trim().slice(1).split(",").map((word) => word.trim());
  const [x, y, z] = words.map(Number);
  return words.length === 3 && words.every((word) => word !== "" && Number.isFinite(Number(word))) ? [x, y, z] : null;
}

/** The nearest point of the surface, and its distance in mesh units. */
export function projectedOnto(mesh: MeshData, place: Vector): { readonly point: SurfacePoint; readonly distance: number } {
  const { face, barycentric, position } = new SurfaceGrid(mesh).nearest(place);
  return { point: { face, barycentric: [...barycentric] }, distance: Math.hypot(...position.map((value, axis) => value - place[axis])) };
}
