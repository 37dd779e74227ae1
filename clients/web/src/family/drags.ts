// What a drag of a vertex or of a point of an edge changes: the shown parameters, or the tile itself.
import type { AffineExpression, EdgeShape, FamilyDefinition } from "../contract/types";
import { constantOf, factorOf, isConstant, pointAt, shifted, shiftedPoint, type Vector, valueAt, withConstant } from "./expressions";
import { rankOf, solved, type Symmetric } from "./linear";
import { type Move, TileMotion } from "./matching";
import type { FamilyState } from "./state";
import { type DrawnFamily, edgeOf, onEdge, orientedVector, sineHeight } from "./tiling";

/** `parameters`: a drag moves the shown parameters; `tile`: it changes the coordinates of the tile, for all parameters alike. */
export type DragMode = "parameters" | "tile";

/** A place of the drawing that can be dragged. */
export type Handle =
  | { readonly kind: "vertex"; readonly vertex: number }
  /** A point of a polyline; its place within the list of the shape. */
  | { readonly kind: "point"; readonly edge: number; readonly shape: number; readonly point: number }
  /** The height of a curve where one of its sines is greatest, counted from 1. `leans`: the sine makes the curve lean to a side. */
  | { readonly kind: "sine"; readonly edge: number; readonly shape: number; readonly sine: number; readonly leans: boolean };

/** A drag that has begun: the state after a movement from where it began. */
export type Drag = (by: Vector) => Pick<FamilyState, "definition" | "shown">;

/** Heights of curves and places of points on edges are within this many lengths of the chord. */
const MAX_CHORD = 3;
/** Largest parameter that a drag leads to. The server has the same limit for coordinates. */
const MAX_PARAMETER = 1000;
/** A movement per parameter below this ratio to the tile's size is none. */
const MIN_EFFECT = 1e-9;

/** The first sine of each class, which bends a straight edge as its class allows: "S" twice, the others once. */
export function firstSine(kind: EdgeShape["class"]): number {
  return kind === "S" ? 2 : 1;
}

/** The handles of the tile: its vertices, and for each shape of edges its points on the first edge that has it. */
export function handlesOf(family: DrawnFamily): Handle[] {
  const vertices = family.tile.vertices.map((_, vertex): Handle => ({ kind: "vertex", vertex }));
  const edges = family.shapes.flatMap((shape, index): Handle[] => {
    const edge = family.tile.edges?.findIndex((one) => one.shape === index) ?? -1;
    if (edge < 0 || shape.class === "I") return [];
    if (shape.points) return shape.points.map((_, point): Handle => ({ kind: "point", edge, shape: index, point }));
    const first = firstSine(shape.class);
    // A curve of any kind has its second sine, too, with which it leans to a side.
    const sines = shape.class === "J" && shape.sines ? [first, 2] : [first];
    return sines.map((sine): Handle => ({ kind: "sine", edge, shape: index, sine, leans: sine !== first }));
  });
  return [...vertices, ...edges];
}

/** Where along the chord the handle of a sine is: where the sine is 1. */
function sinePlace(sine: number): number {
  return 1 / (2 * sine);
}

/** The place of a handle relative to the chord of its shape. */
function chordPlace(shape: EdgeShape, handle: Exclude<Handle, { kind: "vertex" }>, parameters: readonly number[]): Vector {
  if (handle.kind === "point") {
    const point = shape.points?.[handle.point];
    return point ? pointAt(point, parameters) : [0.5, 0];
  }
  const x = sinePlace(handle.sine);
  return [x, sineHeight((shape.sines ?? []).map((sine) => valueAt(sine, parameters)), x)];
}

/** The ends of an edge of the tile. */
function endsOf({ tile }: DrawnFamily, edge: number, parameters: readonly number[]): readonly [Vector, Vector] {
  return [pointAt(tile.vertices[edge], parameters), pointAt(tile.vertices[(edge + 1) % tile.vertices.length], parameters)];
}

/** The place of a handle in the plane. */
export function placeOf(family: DrawnFamily, handle: Handle, parameters: readonly number[]): Vector {
  if (handle.kind === "vertex") return pointAt(family.tile.vertices[handle.vertex], parameters);
  const edge = edgeOf(family, handle.edge);
  const [from, to] = endsOf(family, handle.edge, parameters);
  return edge ? onEdge(edge, from, to, chordPlace(family.shapes[handle.shape], handle, parameters)) : from;
}

/** A drag of a handle that begins at a state. Null if nothing of what it may change moves the handle. */
export function dragOf(family: DrawnFamily, state: FamilyState, handle: Handle, mode: DragMode): Drag | null {
  if (handle.kind !== "vertex") return edgeDrag(family, state, handle, mode);
  return mode === "parameters" ? parameterDrag(state, family.tile.vertices[handle.vertex]) : tileDrag(family, state, handle.vertex);
}

/** Whether a drag of each handle would change anything. */
export function canDrag(family: DrawnFamily, state: FamilyState, handles: readonly Handle[], mode: DragMode): boolean[] {
  const motion = mode === "tile" ? new TileMotion(family, state.shown) : null;
  return handles.map((handle) => (motion && handle.kind === "vertex" ? motion.canMove(handle.vertex) : dragOf(family, state, handle, mode) !== null));
}

/** Moves the parameters on which coordinates depend, as little as possible over the ranges of their bounds. Bounds that are in the way move along. */
function parameterDrag({ definition, shown }: FamilyState, coordinates: readonly AffineExpression[], spread: (by: Vector) => Vector = (by) => by): Drag | null {
  const ranges = definition.parameters.map(({ lower, upper }) => upper - lower);
  const effects = ranges.map((range, k) => [factorOf(coordinates[0], k) * range, factorOf(coordinates[1], k) * range] as const);
  const matrix = effects.reduce<Symmetric>(([xx, xy, yy], [x, y]) => [xx + x * x, xy + x * y, yy + y * y], [0, 0, 0]);
  const min = MIN_EFFECT * (matrix[0] + matrix[2]);
  if (rankOf(matrix, min) === 0) return null;
  return (by) => {
    const [u, v] = solved(matrix, spread(by), min);
    const next = shown.map((value, k) => clamped(value + ranges[k] * (effects[k][0] * u + effects[k][1] * v), MAX_PARAMETER));
    return { definition: widened(definition, next), shown: next };
  };
}

function clamped(value: number, max: number): number {
  return Math.max(-max, Math.min(max, value));
}

/** The definition with bounds that contain the parameters. */
export function widened(definition: FamilyDefinition, shown: readonly number[]): FamilyDefinition {
  if (definition.parameters.every(({ lower, upper }, k) => shown[k] >= lower && shown[k] <= upper)) return definition;
  const parameters = definition.parameters.map((parameter, k) => ({
    ...parameter,
    lower: Math.min(parameter.lower, shown[k]),
    upper: Math.max(parameter.upper, shown[k]),
  }));
  return { ...definition, parameters };
}

/** Moves the constants of the vertex, and of what has to follow so that the tiles still fill the plane. The tile of a type is written out. */
function tileDrag(family: DrawnFamily, { definition, shown }: FamilyState, vertex: number): Drag | null {
  const moves = new TileMotion(family, shown).movesOf(vertex);
  return moves && ((by) => ({ definition: movedTile(family, definition, moves(by)), shown }));
}

/** The definition with its tile written out and moved. */
export function movedTile(family: DrawnFamily, definition: FamilyDefinition, { vertices, translations, offsets }: Move): FamilyDefinition {
  const { tile } = family;
  return {
    ...writtenOut(family, definition),
    tile: {
      ...tile,
      vertices: tile.vertices.map((point, k) => shiftedPoint(point, vertices[k])),
      translations: tile.translations.map((point, k) => shiftedPoint(point, translations[k])),
      placements: tile.placements.map((placement, k) => ({ ...placement, offset: shiftedPoint(placement.offset, offsets[k]) })),
    },
  };
}

/** The same definition with a tile of its own in place of the isohedral type. */
export function writtenOut({ tile, shapes }: DrawnFamily, definition: FamilyDefinition): FamilyDefinition {
  if (definition.isohedral_type === undefined) return definition;
  const { isohedral_type: _, ...rest } = definition;
  return { ...rest, tile, shapes: [...shapes] };
}

/** A drag of a point of an edge. What no parameter moves is changed itself, since edges have shapes of their own in all types. */
function edgeDrag(family: DrawnFamily, state: FamilyState, handle: Exclude<Handle, { kind: "vertex" }>, mode: DragMode): Drag | null {
  const edge = edgeOf(family, handle.edge);
  if (!edge) return null;
  const shape = family.shapes[handle.shape];
  const [from, to] = endsOf(family, handle.edge, state.shown);
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const square = dx * dx + dy * dy;
  if (square === 0) return null;
  /** A movement in the plane as one relative to the shape's chord. */
  const relative = ([x, y]: Vector): Vector => orientedVector(edge, [(x * dx + y * dy) / square, (y * dx - x * dy) / square]);
  if (handle.kind === "point") {
    const point = shape.points?.[handle.point];
    if (!point) return null;
    const byParameters = mode === "parameters" ? parameterDrag(state, point, relative) : null;
    return byParameters ?? ((by) => changedShape(family, state, handle.shape, { ...shape, points: movedPoint(shape, handle.point, relative(by)) }));
  }
  const sines = shape.sines ?? [];
  const amplitude = sines[handle.sine - 1] ?? 0;
  const upwards = (by: Vector): Vector => [0, relative(by)[1]];
  const byParameters = mode === "parameters" ? parameterDrag(state, [0, amplitude], upwards) : null;
  return byParameters ?? ((by) => {
    const next = Array.from({ length: Math.max(sines.length, handle.sine) }, (_, k) => sines[k] ?? 0);
    next[handle.sine - 1] = withConstant(amplitude, clamped(constantOf(amplitude) + relative(by)[1], MAX_CHORD));
    return changedShape(family, state, handle.shape, { ...shape, sines: next });
  });
}

function movedPoint({ class: kind, points = [] }: EdgeShape, index: number, [x, y]: Vector): NonNullable<EdgeShape["points"]> {
  return points.map((point, k) => {
    if (k !== index) return point;
    // The middle of an edge that mirrors itself stays in the middle.
    const isMiddle = kind === "U" && k === points.length - 1 && isConstant(point[0]) && constantOf(point[0]) === 0.5;
    return [isMiddle ? point[0] : within(shifted(point[0], x)), within(shifted(point[1], y))];
  });
}

function within(expression: AffineExpression): AffineExpression {
  return withConstant(expression, clamped(constantOf(expression), MAX_CHORD));
}

/** The state with one shape of edges replaced. */
function changedShape({ shapes }: DrawnFamily, { definition, shown }: FamilyState, index: number, shape: EdgeShape): Pick<FamilyState, "definition" | "shown"> {
  return { definition: { ...definition, shapes: shapes.map((one, k) => (k === index ? shape : one)) }, shown };
}
