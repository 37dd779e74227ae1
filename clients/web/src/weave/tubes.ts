// Triangle meshes of tubes around strands.

export type Vector = readonly [number, number, number];

export interface TubeMesh {
  /** x, y, z of each vertex. */
  readonly positions: Float32Array;
  /** Unit normal of each vertex. */
  readonly normals: Float32Array;
  /** Three vertices of each triangle. */
  readonly triangles: Uint32Array;
}

/** Open tubes around polylines of at least two points, with `sides` vertices around each point. */
export function tubes(lines: readonly (readonly Vector[])[], radii: readonly number[], sides: number): TubeMesh {
  const usable = lines.map((line, k) => ({ line: withoutRepeats(line), radius: radii[k] })).filter(({ line }) => line.length > 1);
  const count = usable.reduce((sum, { line }) => sum + line.length, 0);
  const pieces = usable.reduce((sum, { line }) => sum + line.length - 1, 0);
  const positions = new Float32Array(3 * sides * count);
  const normals = new Float32Array(3 * sides * count);
  const triangles = new Uint32Array(6 * sides * pieces);
  let vertex = 0;
  let corner = 0;
  for (const { line, radius } of usable) {
    let firstNormal = perpendicular(tangentAt(line, 0));
    line.forEach((place, k) => {
      const tangent = tangentAt(line, k);
      firstNormal = unit(minus(firstNormal, scaled(tangent, dot(firstNormal, tangent))), perpendicular(tangent));
      const secondNormal = cross(tangent, firstNormal);
      for (let side = 0; side < sides; ++side) {
        const angle = (2 * Math.PI * side) / sides;
        for (let axis = 0; axis < 3; ++axis) {
          const normal = Math.cos(angle) * firstNormal[axis] + Math.sin(angle) * secondNormal[axis];
          normals[3 * (vertex + side) + axis] = normal;
          positions[3 * (vertex + side) + axis] = place[axis] + radius * normal;
        }
        if (k === 0) continue;
        const [a, b] = [vertex + side, vertex + ((side + 1) % sides)];
        triangles.set([a - sides, b - sides, a, a, b - sides, b], corner);
        corner += 6;
      }
      vertex += sides;
    });
  }
  return { positions, normals, triangles };
}

function withoutRepeats(line: readonly Vector[]): Vector[] {
  return line.filter((place, k) => k === 0 || place.some((value, axis) => value !== line[k - 1][axis]));
}

/** Unit tangent at a point: the normalized mean of the directions before and after it. */
function tangentAt(line: readonly Vector[], k: number): Vector {
  const before = k > 0 ? unit(minus(line[k], line[k - 1]), [0, 0, 0]) : null;
  const after = k + 1 < line.length ? unit(minus(line[k + 1], line[k]), [0, 0, 0]) : null;
  if (!before || !after) return (before ?? after) as Vector;
  return unit([before[0] + after[0], before[1] + after[1], before[2] + after[2]], after);
}

/** A unit vector normal to a tangent. It points to +z if the tangent is in the plane. */
function perpendicular(tangent: Vector): Vector {
  const up: Vector = Math.abs(tangent[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  return unit(minus(up, scaled(tangent, dot(up, tangent))), [1, 0, 0]);
}

function unit(a: Vector, otherwise: Vector): Vector {
  const length = Math.hypot(...a);
  return length > 1e-12 ? scaled(a, 1 / length) : otherwise;
}

function scaled(a: Vector, factor: number): Vector {
  return [a[0] * factor, a[1] * factor, a[2] * factor];
}

function minus(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

function cross(a: Vector, b: Vector): Vector {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
