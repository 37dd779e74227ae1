// Checks of a binary STL file for printing: a closed surface, its size and its volume.
import assert from "node:assert/strict";

const HEADER = 84;
const TRIANGLE = 50;
/** Offset of the corners in the record of a triangle, after the normal. */
const CORNERS = 12;

/**
 * Size and volume of the solid, in mm and mm^3. Fails if the surface is not watertight: each edge has to belong to exactly two triangles
 * with opposite directions, and the normals have to point outwards.
 */
export function watertight(stl) {
  const count = stl.readUInt32LE(80);
  assert.ok(count > 0, "there are triangles");
  assert.equal(stl.length, HEADER + TRIANGLE * count, "the file is as long as it says");
  const edges = new Map();
  const lower = [Infinity, Infinity, Infinity];
  const upper = lower.map((value) => -value);
  let volume = 0;
  for (let t = 0; t < count; ++t) {
    const at = HEADER + TRIANGLE * t + CORNERS;
    const corners = [0, 1, 2].map((corner) => [0, 1, 2].map((axis) => stl.readFloatLE(at + 12 * corner + 4 * axis)));
    for (const corner of corners) {
      corner.forEach((value, axis) => {
        lower[axis] = Math.min(lower[axis], value);
        upper[axis] = Math.max(upper[axis], value);
      });
    }
    const [a, b, c] = corners;
    volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
    corners.forEach((from, k) => {
      const edge = `${from.join()}|${corners[(k + 1) % 3].join()}`;
      edges.set(edge, (edges.get(edge) ?? 0) + 1);
    });
  }
  const open = [...edges].filter(([edge, uses]) => uses !== 1 || edges.get(edge.split("|").reverse().join("|")) !== 1);
  assert.equal(open.length, 0, `the surface is closed: ${open.length} of ${edges.size} edges are not those of two triangles, for example ${open[0]?.[0]}`);
  assert.ok(volume > 0, "normals point outwards");
  return { size: upper.map((value, axis) => value - lower[axis]), volume };
}
