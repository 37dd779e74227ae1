// The deformation of each face of a surface, and its colours.
import { straightSides, stretchesOf } from "./membrane";
import { type MeshData, type Vector, vertexPosition } from "./mesh_data";
import { rampColour, type Rgb } from "./spring_colours";

export type DeformationBy = "area" | "stretch" | "none";

/** Colours in linear light: smaller than at rest, as at rest, larger. The colours of springs are darker or warmer, so that they stand out. */
export const DEFORMATION_RAMP: readonly Rgb[] = [
  [0.03, 0.2, 0.46],
  [0.26, 0.48, 0.68],
  [0.66, 0.69, 0.7],
  [0.38, 0.6, 0.24],
  [0.09, 0.33, 0.06],
];

/** Smallest factor of the colour scale; smaller changes are rounding errors. */
const MIN_FACTOR = 1 + 1e-6;

/** The area of each face over that at rest, or its greater principal stretch. */
export function deformationOf(mesh: MeshData, vertices: readonly Vector[], by: "area" | "stretch"): readonly number[] {
  return Array.from({ length: mesh.faces.length / 3 }, (_, face) => {
    const corners = [0, 1, 2].map((corner) => mesh.faces[3 * face + corner]);
    const rest = corners.map((vertex) => vertexPosition(mesh, vertex));
    const now = corners.map((vertex) => vertices[vertex]);
    const [greater, lesser] = stretchesOf(straightSides(rest, [0, 1, 2]), straightSides(now, [0, 1, 2]));
    return by === "area" ? greater * lesser : greater;
  });
}

/** The largest of all values and their inverses. Colours range from its inverse to it. */
export function greatestFactor(values: readonly number[]): number {
  return values.reduce((max, value) => (value > 0 && value < Infinity ? Math.max(max, value, 1 / value) : max), MIN_FACTOR);
}

export function deformationColour(value: number, factor: number): Rgb {
  return rampColour(0.5 + Math.log(value) / (2 * Math.log(factor)), DEFORMATION_RAMP);
}
