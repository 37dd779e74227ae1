// Changes of a definition that are no drags: parameters, bounds, the width of the beams, and the lines of edges.
import type { AffineExpression, EdgeShape, FamilyDefinition } from "../contract/types";
import { firstSine, writtenOut } from "./drags";
import { constantOf, expressionOf, factorOf, factorsOf, isConstant, mapped, mappedTile, pointAt, substituted, usedParameters, type Vector, withFactor } from "./expressions";
import { type FamilyState, MAX_PARAMETERS, rounded } from "./state";
import { type DrawnFamily, meanSide, tilingAt } from "./tiling";

type Parameter = FamilyDefinition["parameters"][number];
/** What an edit changes. */
export type Edited = Pick<FamilyState, "definition" | "shown">;

/** Widths of beams over the mean side of the tile between which a parameter of the width lies. */
const WIDTHS: readonly [number, number] = [0.05, 0.2];
/** Height of a line that is bent or curved by a press, in lengths of its chord. */
const FIRST_HEIGHT = 0.1;
/** Bounds of the parameter of a curve's height, about the height. */
const HEIGHT_REACH = 0.1;
/** Bounds of the parameter of a bent line's height, times the height. */
const HEIGHT_FACTORS: readonly [number, number] = [0.5, 1.5];

export function canAddParameter({ parameters }: FamilyDefinition): boolean {
  return parameters.length < MAX_PARAMETERS;
}

function withParameter({ definition, shown }: Edited, parameter: Parameter): Edited {
  return { definition: { ...definition, parameters: [...definition.parameters, parameter] }, shown: [...shown, parameter.default] };
}

/** A parameter with other words or bounds. The default and the shown value stay within them. */
export function changedParameter({ definition, shown }: Edited, index: number, change: Partial<Parameter>): Edited {
  const changed = { ...definition.parameters[index], ...change };
  const clamp = (value: number) => Math.max(changed.lower, Math.min(changed.upper, value));
  const parameter = { ...changed, default: clamp(changed.default) };
  const parameters = definition.parameters.map((one, k) => (k === index ? parameter : one));
  return { definition: { ...definition, parameters }, shown: shown.map((value, k) => (k === index ? clamp(value) : value)) };
}

/** Makes the shown parameters the defaults. */
export function defaultsHere({ definition, shown }: Edited): Edited {
  return { definition: { ...definition, parameters: definition.parameters.map((parameter, k) => ({ ...parameter, default: shown[k] })) }, shown };
}

/** Whether the parameter is one of the vertices of an isohedral type. */
export function isOfType({ type }: DrawnFamily, index: number): boolean {
  return type !== null && index < type.defaults.length;
}

/** The family without a parameter, which has its shown value from then on. If it is one of the type's, the tile is written out. */
export function fixedParameter(family: DrawnFamily, { definition, shown }: Edited, index: number): Edited {
  const whole = isOfType(family, index) ? writtenOut(family, definition) : definition;
  const changed = mapped(whole, (expression) => substituted(expression, index, shown[index]));
  return { definition: { ...changed, parameters: definition.parameters.filter((_, k) => k !== index) }, shown: shown.filter((_, k) => k !== index) };
}

/** The parameter that is the width of the beams; null if the width is fixed or depends on parameters in another way. */
export function widthParameter({ beam_width }: FamilyDefinition): number | null {
  const factors = factorsOf(beam_width);
  return constantOf(beam_width) === 0 && factors.filter((factor) => factor !== 0).length === 1 && factors[factors.length - 1] === 1 ? factors.length - 1 : null;
}

/** Makes the width of the beams a parameter. */
export function widthAsParameter(family: DrawnFamily, edited: Edited): Edited {
  const tiling = tilingAt(family, edited.shown);
  const side = meanSide(tiling);
  const width = tiling.beamWidth;
  const added = withParameter(edited, {
    description: "Width of the beams",
    lower: Math.min(width, rounded(WIDTHS[0] * side)),
    upper: Math.max(width, rounded(WIDTHS[1] * side)),
    default: width,
  });
  return { ...added, definition: { ...added.definition, beam_width: withFactor(0, edited.shown.length, 1) } };
}

/** Fixes the width of the beams. Parameters that nothing else depends on are taken away. */
export function fixedWidth(family: DrawnFamily, { definition, shown }: Edited, width: number): Edited {
  const fixed = { definition: { ...definition, beam_width: width }, shown };
  const used = usedParameters(fixed.definition, family.tile);
  const index = used.findIndex((isUsed, k) => !isUsed && factorOf(definition.beam_width, k) !== 0);
  return index < 0 ? fixed : fixedParameter({ ...family, definition: fixed.definition }, fixed, index);
}

/** How a shape of edges is drawn. */
export type LineKind = "straight" | "curve" | "bent";

export function lineOf({ points, sines }: EdgeShape): LineKind {
  return points ? "bent" : sines ? "curve" : "straight";
}

/** A shape of the same class with another line. */
function withLine({ class: kind }: EdgeShape, line: LineKind): EdgeShape {
  if (line === "curve") return { class: kind, sines: [...Array.from({ length: firstSine(kind) - 1 }, () => 0), FIRST_HEIGHT] };
  if (line === "bent") return { class: kind, points: [[kind === "S" ? 0.25 : 0.5, FIRST_HEIGHT]] };
  return { class: kind };
}

/** The shapes of a family in which one has another line. Parameters that nothing depends on any more are taken away. */
export function changedLine(family: DrawnFamily, { definition, shown }: Edited, index: number, line: LineKind): Edited {
  const shapes = family.shapes.map((shape, k) => (k === index ? withLine(shape, line) : shape));
  return withoutUnused({ ...family, shapes }, { definition: { ...definition, shapes }, shown });
}

/** A bent line with a further point before one of its points. */
export function withPoint(family: DrawnFamily, edited: Edited, index: number, point: number): Edited {
  const points = family.shapes[index].points ?? [];
  const at = (k: number): Vector => (points[k] ? pointAt(points[k], edited.shown) : [0, 0]);
  const [p, q] = [at(point - 1), at(point)];
  const between: AffineExpression[] = [rounded((p[0] + q[0]) / 2), rounded((p[1] + q[1]) / 2)];
  return changedPoints(family, edited, index, [...points.slice(0, point), between, ...points.slice(point)]);
}

/** A bent line without one of its points. Without any it is straight. */
export function withoutPoint(family: DrawnFamily, edited: Edited, index: number, point: number): Edited {
  const points = family.shapes[index].points ?? [];
  return changedPoints(family, edited, index, points.filter((_, k) => k !== point));
}

function changedPoints(family: DrawnFamily, { definition, shown }: Edited, index: number, points: NonNullable<EdgeShape["points"]>): Edited {
  const { class: kind } = family.shapes[index];
  const shapes = family.shapes.map((shape, k): EdgeShape => (k === index ? { class: kind, ...(points.length > 0 && { points }) } : shape));
  return withoutUnused({ ...family, shapes }, { definition: { ...definition, shapes }, shown });
}

/** Without the parameters on which nothing depends, except for those of the type. */
function withoutUnused(family: DrawnFamily, edited: Edited): Edited {
  const index = usedParameters(edited.definition, family.tile).findIndex((isUsed, k) => !isUsed && !isOfType(family, k));
  if (index < 0) return edited;
  const fewer = fixedParameter({ ...family, definition: edited.definition }, edited, index);
  return withoutUnused({ ...family, definition: fewer.definition }, fewer);
}

/** Whether a shape has a height that no parameter moves yet, and that may become one. */
export function hasFixedHeight({ class: kind, points, sines }: EdgeShape): boolean {
  if (points) return points.every(([, y]) => isConstant(y)) && points.some(([, y]) => constantOf(y) !== 0);
  const amplitude = sines?.[firstSine(kind) - 1];
  return amplitude !== undefined && isConstant(amplitude);
}

/** Makes the height of a shape of edges a parameter. */
export function heightAsParameter(family: DrawnFamily, edited: Edited, index: number): Edited {
  const shape = family.shapes[index];
  const place = edited.shown.length;
  const name = `Height of the edges ${shapeName(index)}`;
  const sine = firstSine(shape.class) - 1;
  const height = constantOf(shape.sines?.[sine] ?? 0);
  const parameter = shape.points
    ? { description: name, lower: HEIGHT_FACTORS[0], upper: HEIGHT_FACTORS[1], default: 1 }
    : { description: name, lower: rounded(height - HEIGHT_REACH), upper: rounded(height + HEIGHT_REACH), default: height };
  const changed: EdgeShape = shape.points
    ? { ...shape, points: shape.points.map(([x, y]) => [x, withFactor(0, place, constantOf(y))]) }
    : { ...shape, sines: (shape.sines ?? []).map((amplitude, k) => (k === sine ? withFactor(0, place, 1) : amplitude)) };
  const added = withParameter(edited, parameter);
  return { ...added, definition: { ...added.definition, shapes: family.shapes.map((one, k) => (k === index ? changed : one)) } };
}

/** Letters name the shapes of edges, as in the published table of the types. */
export function shapeName(index: number): string {
  return String.fromCharCode("a".charCodeAt(0) + index);
}

/** A parameter that leads from the tile before a drag to the one after it: 0 is before, 1 is after. Both have the same parameters. */
export function moveAsParameter(before: DrawnFamily, after: DrawnFamily, shown: readonly number[], words: string): Edited {
  const place = before.definition.parameters.length;
  const expressions: AffineExpression[] = [];
  mappedTile(after.tile, (expression) => {
    expressions.push(expression);
    return expression;
  });
  let next = 0;
  const tile = mappedTile(before.tile, (expression) => {
    const factors = factorsOf(expression);
    while (factors.length < place) factors.push(0);
    return expressionOf(constantOf(expression), [...factors, constantOf(expressions[next++]) - constantOf(expression)]);
  });
  const { isohedral_type: _, ...rest } = before.definition;
  return withParameter({ definition: { ...rest, tile, shapes: [...before.shapes] }, shown }, { description: words, lower: 0, upper: 1, default: 1 });
}
