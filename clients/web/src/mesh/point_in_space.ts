// A point in space that stands for the point of a surface that is nearest to it.
import type { SurfacePoint } from "../contract/types";
import type { MeshData, Vector } from "./mesh_data";
import { SurfaceGrid } from "./nearest_on_surface";

/** A place as it is typed, "@1,2.5,-3"; null where the text is none. */
export function readPlace(text: string): Vector | null {
  if (!text.trim().startsWith("@")) return null;
  const words = text.trim().slice(1).split(",").map((word) => word.trim());
  const [x, y, z] = words.map(Number);
  return words.length === 3 && words.every((word) => word !== "" && Number.isFinite(Number(word))) ? [x, y, z] : null;
}

/** The nearest point of the surface, and how far away it is, in mesh units. */
export function placedOn(mesh: MeshData, place: Vector): { readonly point: SurfacePoint; readonly distance: number } {
  const { face, barycentric, position } = new SurfaceGrid(mesh).nearest(place);
  return { point: { face, barycentric: [...barycentric] }, distance: Math.hypot(...position.map((value, axis) => value - place[axis])) };
}
