// The tiling of a definition at parameters: the outline of its tile, the copies of one cell, and the translations that repeat it. It is drawn
// here, and not by the server, so that it follows the pointer within a frame.
import type { EdgeShape, FamilyDefinition, IsohedralType, TileDefinition, TileEdge } from "../contract/types";
import { pointAt, type Vector, valueAt } from "./expressions";

/** A definition with its tile, which definitions with an isohedral type take from the table of the types. */
export interface DrawnFamily {
  readonly definition: FamilyDefinition;
  readonly tile: TileDefinition;
  readonly shapes: readonly EdgeShape[];
  /** The type that the definition names; null for one with a tile of its own. */
  readonly type: IsohedralType | null;
}

export interface Tiling {
  /** The tile's outline, with the points of its edges. */
  readonly outline: readonly Vector[];
  /** Index of each edge's first point in the outline. */
  readonly starts: readonly number[];
  /** The outlines of the tiles of one cell where they lie. */
  readonly tiles: readonly (readonly Vector[])[];
  readonly lattice: readonly [Vector, Vector];
  /** Width of the beams in tiling units. */
  readonly beamWidth: number;
}

const DEFAULT_PIECES = 16;

/** Null for a type that is not in the table or has more parameters than the definition, and for a definition without a tile. */
export function drawnFamily(definition: FamilyDefinition, types: readonly IsohedralType[]): DrawnFamily | null {
  const type = types.find(({ number }) => number === definition.isohedral_type) ?? null;
  const tile = definition.isohedral_type === undefined ? definition.tile : type?.tile;
  if (!tile || (type && definition.parameters.length < type.defaults.length)) return null;
  const given = definition.shapes ?? [];
  const shapes = given.length === 0 && type ? type.classes.map((name): EdgeShape => ({ class: name })) : given;
  return { definition, tile, shapes, type };
}

/** The second half of an edge that looks the same after half a turn or in a mirror, of which the first half is given. */
function completed({ class: kind, points = [] }: EdgeShape, half: readonly Vector[]): Vector[] {
  const back = [...half].reverse();
  if (kind === "S") return [...half, [0.5, 0], ...back.map(([x, y]): Vector => [1 - x, -y])];
  const last = points.at(-1)?.[0];
  // A last point in the middle is its own image.
  const hasMiddle = last === 0.5 || (Array.isArray(last) && last.length === 1 && last[0] === 0.5);
  return [...half, ...back.slice(hasMiddle ? 1 : 0).map(([x, y]): Vector => [1 - x, y])];
}

/** Height of a sum of sines at a place of the chord. */
export function sineHeight(amplitudes: readonly number[], x: number): number {
  return amplitudes.reduce((height, amplitude, k) => height + amplitude * Math.sin((k + 1) * Math.PI * x), 0);
}

/** The inner points of an edge relative to its chord, from (0, 0) to (1, 0). */
export function chordPoints(shape: EdgeShape, parameters: readonly number[]): Vector[] {
  if (shape.points) {
    const points = shape.points.map((point) => pointAt(point, parameters));
    return shape.class === "S" || shape.class === "U" ? completed(shape, points) : points;
  }
  if (!shape.sines) return [];
  const amplitudes = shape.sines.map((sine) => valueAt(sine, parameters));
  const pieces = shape.pieces ?? DEFAULT_PIECES;
  return Array.from({ length: pieces - 1 }, (_, k): Vector => [(k + 1) / pieces, sineHeight(amplitudes, (k + 1) / pieces)]);
}

/** A vector relative to a shape's chord, as an edge has it that turns or mirrors the shape. The same edge takes it back. */
export function orientedVector({ turned, mirrored }: TileEdge, [x, y]: Vector): Vector {
  const sign = turned ? -1 : 1;
  return [sign * x, (mirrored ? -sign : sign) * y];
}

/** The points of a shape as an edge has them. */
function orientedPoints(edge: TileEdge, points: readonly Vector[]): Vector[] {
  const ordered = edge.turned ? [...points].reverse() : points;
  const side = Boolean(edge.turned) === Boolean(edge.mirrored) ? 1 : -1;
  return ordered.map(([x, y]): Vector => [edge.turned ? 1 - x : x, side * y]);
}

/** A place relative to a chord, in the plane. */
export function onChord(from: Vector, to: Vector, [x, y]: Vector): Vector {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  return [from[0] + x * dx - y * dy, from[1] + x * dy + y * dx];
}

/** The place of a shape's point on an edge of the tile, in the plane. */
export function onEdge(edge: TileEdge, from: Vector, to: Vector, point: Vector): Vector {
  return onChord(from, to, orientedPoints(edge, [point])[0]);
}

export function edgeOf({ tile }: DrawnFamily, index: number): TileEdge | null {
  return tile.edges?.[index] ?? null;
}

/** A point of the tile where a placement puts it. */
export function placed(linear: readonly number[], [dx, dy]: Vector, [x, y]: Vector): Vector {
  const [a, b, c, d] = linear;
  return [a * x + b * y + dx, c * x + d * y + dy];
}

/** The tiling at parameters, by the formulas that the server draws it with. */
export function tilingAt(family: DrawnFamily, parameters: readonly number[]): Tiling {
  const { tile, shapes } = family;
  const lines = shapes.map((shape) => chordPoints(shape, parameters));
  const vertices = tile.vertices.map((vertex) => pointAt(vertex, parameters));
  const outline: Vector[] = [];
  const starts: number[] = [];
  vertices.forEach((from, k) => {
    starts.push(outline.length);
    outline.push(from);
    const edge = edgeOf(family, k);
    const line = edge && lines[edge.shape];
    if (!edge || !line) return;
    const to = vertices[(k + 1) % vertices.length];
    for (const point of orientedPoints(edge, line)) outline.push(onChord(from, to, point));
  });
  const tiles = tile.placements.map(({ linear, offset }) => {
    const at = pointAt(offset, parameters);
    return outline.map((point) => placed(linear, at, point));
  });
  const [a, b] = tile.translations.map((translation) => pointAt(translation, parameters));
  return { outline, starts, tiles, lattice: [a, b], beamWidth: valueAt(family.definition.beam_width, parameters) };
}

/** Area within a closed outline; negative if it runs clockwise. */
export function areaOf(outline: readonly Vector[]): number {
  return outline.reduce((sum, [x, y], k) => {
    const [u, v] = outline[(k + 1) % outline.length];
    return sum + (x * v - u * y) / 2;
  }, 0);
}

/** Mean length of the sides between vertices, to which widths of beams are compared. */
export function meanSide({ outline, starts }: Tiling): number {
  const vertices = starts.map((at) => outline[at]);
  const lengths = vertices.map(([x, y], k) => {
    const [u, v] = vertices[(k + 1) % vertices.length];
    return Math.hypot(u - x, v - y);
  });
  return lengths.reduce((sum, length) => sum + length, 0) / lengths.length;
}

/** Where two pieces of a closed outline cross. Pieces that only share an end do not. */
export function selfCrossings(outline: readonly Vector[]): Vector[] {
  const count = outline.length;
  const found: Vector[] = [];
  for (let i = 0; i < count; ++i) {
    for (let k = i + 2; k < count; ++k) {
      if (i === 0 && k === count - 1) continue;
      const place = crossing(outline[i], outline[(i + 1) % count], outline[k], outline[(k + 1) % count]);
      if (place) found.push(place);
    }
  }
  return found;
}

/** Where two segments cross within both; null if they do not. */
function crossing(p: Vector, q: Vector, r: Vector, s: Vector): Vector | null {
  const [ax, ay, bx, by] = [q[0] - p[0], q[1] - p[1], s[0] - r[0], s[1] - r[1]];
  const area = ax * by - ay * bx;
  if (area === 0) return null;
  const [dx, dy] = [r[0] - p[0], r[1] - p[1]];
  const along = (dx * by - dy * bx) / area;
  const other = (dx * ay - dy * ax) / area;
  return along > 0 && along < 1 && other > 0 && other < 1 ? [p[0] + along * ax, p[1] + along * ay] : null;
}
