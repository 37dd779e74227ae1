// Affine functions of a family's parameters, as definitions write them: a number, or a constant with the factors of the parameters.
import type { Point } from "../base/plane";
import type { AffineExpression, AffinePoint, EdgeShape, FamilyDefinition, TileDefinition } from "../contract/types";

/** A place in the plane, or the way from one to another. */
export type Vector = Point;

/** The value at parameters. The terms are added in their order, as the server adds them, so that both draw the same numbers. */
export function valueAt(expression: AffineExpression, parameters: readonly number[]): number {
  if (typeof expression === "number") return expression;
  let value = expression[0];
  for (let k = 1; k < expression.length; ++k) value += expression[k] * parameters[k - 1];
  return value;
}

export function pointAt([x, y]: AffinePoint, parameters: readonly number[]): Vector {
  return [valueAt(x, parameters), valueAt(y, parameters)];
}

export function constantOf(expression: AffineExpression): number {
  return typeof expression === "number" ? expression : expression[0];
}

/** The factor of a parameter, counted from 0. */
export function factorOf(expression: AffineExpression, index: number): number {
  return typeof expression === "number" ? 0 : (expression[index + 1] ?? 0);
}

/** The factors of all parameters that it has any of, without zeros at the end. */
export function factorsOf(expression: AffineExpression): number[] {
  if (typeof expression === "number") return [];
  const factors = expression.slice(1);
  while (factors.length > 0 && factors[factors.length - 1] === 0) factors.pop();
  return factors;
}

export function expressionOf(constant: number, factors: readonly number[]): AffineExpression {
  const kept = factorsOf([constant, ...factors]);
  return kept.length === 0 ? constant : [constant, ...kept];
}

export function isConstant(expression: AffineExpression): boolean {
  return factorsOf(expression).length === 0;
}

/** The expression with another constant, and the same factors. */
export function withConstant(expression: AffineExpression, constant: number): AffineExpression {
  return typeof expression === "number" ? constant : [constant, ...expression.slice(1)];
}

/** Adds to the constant. An expression to which nothing is added stays the same object. */
export function shifted(expression: AffineExpression, by: number): AffineExpression {
  return by === 0 ? expression : withConstant(expression, constantOf(expression) + by);
}

export function shiftedPoint(point: AffinePoint, [x, y]: Vector): AffinePoint {
  return x === 0 && y === 0 ? point : [shifted(point[0], x), shifted(point[1], y)];
}

/** The expression with a factor of a parameter, counted from 0. */
export function withFactor(expression: AffineExpression, index: number, factor: number): AffineExpression {
  const factors = factorsOf(expression);
  while (factors.length <= index) factors.push(0);
  factors[index] = factor;
  return expressionOf(constantOf(expression), factors);
}

/** The expression where a parameter has a fixed value. Those after it have one place less. */
export function substituted(expression: AffineExpression, index: number, value: number): AffineExpression {
  const factors = factorsOf(expression);
  if (factors.length <= index) return expression;
  const constant = constantOf(expression) + factors[index] * value;
  return expressionOf(constant, factors.filter((_, k) => k !== index));
}

type Change = (expression: AffineExpression) => AffineExpression;

function mappedPoint([x, y]: AffinePoint, change: Change): AffinePoint {
  return [change(x), change(y)];
}

/** A tile with all of its expressions changed. */
export function mappedTile(tile: TileDefinition, change: Change): TileDefinition {
  return {
    ...tile,
    vertices: tile.vertices.map((point) => mappedPoint(point, change)),
    translations: tile.translations.map((point) => mappedPoint(point, change)),
    placements: tile.placements.map((placement) => ({ ...placement, offset: mappedPoint(placement.offset, change) })),
  };
}

function mappedShape(shape: EdgeShape, change: Change): EdgeShape {
  return {
    ...shape,
    ...(shape.points && { points: shape.points.map((point) => mappedPoint(point, change)) }),
    ...(shape.sines && { sines: shape.sines.map(change) }),
  };
}

/** A definition with all of its expressions changed. */
export function mapped(definition: FamilyDefinition, change: Change): FamilyDefinition {
  return {
    ...definition,
    beam_width: change(definition.beam_width),
    ...(definition.tile && { tile: mappedTile(definition.tile, change) }),
    ...(definition.shapes && { shapes: definition.shapes.map((shape) => mappedShape(shape, change)) }),
  };
}

/** Whether each parameter is one that an expression of a definition depends on. `tile` has the vertices of definitions with an isohedral type, too. */
export function usedParameters(definition: FamilyDefinition, tile: TileDefinition): boolean[] {
  const used = definition.parameters.map(() => false);
  const note: Change = (expression) => {
    for (const [k, factor] of factorsOf(expression).entries()) if (factor !== 0 && k < used.length) used[k] = true;
    return expression;
  };
  mapped(definition, note);
  mappedTile(tile, note);
  return used;
}
