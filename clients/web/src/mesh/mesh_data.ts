// A mesh as the server sends it: binary canonical PLY with double coordinates and triangles.

export interface MeshData {
  /** x, y, z of each vertex. */
  readonly positions: Float64Array;
  /** Three vertices of each face. */
  readonly faces: Uint32Array;
}

export type Vector = readonly [number, number, number];

const HEADER_END = "end_header\n";

export class MeshFormatError extends Error {}

export function parsePly(buffer: ArrayBuffer): MeshData {
  const text = new TextDecoder("latin1").decode(buffer.slice(0, 2048));
  const end = text.indexOf(HEADER_END);
  const header = text.slice(0, end);
  const vertices = Number(/element vertex (\d+)/.exec(header)?.[1]);
  const faces = Number(/element face (\d+)/.exec(header)?.[1]);
  const start = end + HEADER_END.length;
  const size = start + vertices * 24 + faces * 13;
  if (end < 0 || !header.includes("binary_little_endian") || !header.includes("property double x") || size !== buffer.byteLength) {
    throw new MeshFormatError("The mesh’s file is not in the form that this editor reads.");
  }
  const data = { positions: new Float64Array(3 * vertices), faces: new Uint32Array(3 * faces) };
  const view = new DataView(buffer, start);
  for (let k = 0; k < 3 * vertices; ++k) data.positions[k] = view.getFloat64(8 * k, true);
  for (let face = 0; face < faces; ++face) {
    const at = 24 * vertices + 13 * face;
    for (let corner = 0; corner < 3; ++corner) data.faces[3 * face + corner] = view.getInt32(at + 1 + 4 * corner, true);
  }
  return data;
}

export function vertexPosition(mesh: MeshData, vertex: number): Vector {
  return [mesh.positions[3 * vertex], mesh.positions[3 * vertex + 1], mesh.positions[3 * vertex + 2]];
}

export function facePosition(mesh: MeshData, face: number, barycentric: readonly number[]): Vector {
  const sum = [0, 0, 0];
  for (let corner = 0; corner < 3; ++corner) {
    const vertex = mesh.faces[3 * face + corner];
    for (let axis = 0; axis < 3; ++axis) sum[axis] += barycentric[corner] * mesh.positions[3 * vertex + axis];
  }
  return [sum[0], sum[1], sum[2]];
}

/** Barycentric coordinates in a face of a position near its plane. Negative ones are clamped to 0, and the sum is made 1. */
export function barycentricOf(mesh: MeshData, face: number, place: Vector): Vector {
  const corner = (k: number) => vertexPosition(mesh, mesh.faces[3 * face + k]);
  const [a, b, c] = [corner(0), corner(1), corner(2)];
  const u = minus(b, a);
  const v = minus(c, a);
  const w = minus(place, a);
  const [uu, uv, vv, wu, wv] = [dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)];
  const area = uu * vv - uv * uv;
  const second = Math.max(0, (vv * wu - uv * wv) / area);
  const third = Math.max(0, (uu * wv - uv * wu) / area);
  const first = Math.max(0, 1 - second - third);
  const sum = first + second + third;
  return [first / sum, second / sum, Math.max(1 - first / sum - second / sum, 0)];
}

function minus(a: Vector, b: Vector): Vector {
  return [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
}

function dot(a: Vector, b: Vector): number {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** A round distance, 1, 2 or 5 times a power of ten, that fits about `count` times into `extent`. */
export function roundStep(extent: number, count: number): number {
  const raw = extent / count;
  const power = 10 ** Math.floor(Math.log10(raw));
  const lead = raw / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

const ISOLINES = 18;
const RAMP_TICKS = 5;

/** A round spacing of isolines for a field with a largest value. */
export function isolineSpacing(largest: number): number {
  return roundStep(largest || 1, ISOLINES);
}

/** Round values from 0 to at most the largest value. */
export function rampTicks(largest: number): number[] {
  const step = roundStep(largest || 1, RAMP_TICKS);
  return Array.from({ length: Math.floor((largest || 1) / step + 1e-9) + 1 }, (_, k) => Number((k * step).toPrecision(12)));
}
