// Reads definitions of families from files and links, which come from anywhere. What is read here can be drawn; whether it tiles the plane is
// for the server's check to say.
import { placeWords } from "../contract/places";
import type { AffineExpression, AffinePoint, EdgeShape, FamilyDefinition, TileDefinition, TileEdge } from "../contract/types";
import { MAX_ID_LENGTH, MAX_PARAMETERS, MAX_WORDS_LENGTH } from "./state";

const MAX_FACTOR = 1e6;
const MAX_VERTICES = 12;
const MAX_PLACEMENTS = 24;
const MAX_SHAPES = 12;
const MAX_POINTS = 32;
const MAX_SINES = 8;
const PIECES: readonly [number, number] = [2, 64];
const LAST_TYPE = 93;
const CLASSES: readonly EdgeShape["class"][] = ["J", "S", "U", "I"];

/** A sentence about the first place of a document that is no definition. */
export class DefinitionError extends Error {
  constructor(pointer: string, fault: string) {
    const place = placeWords(pointer);
    super(`This is no definition of a family: ${place === "" ? "it" : place} ${fault}.`);
    this.name = "DefinitionError";
  }
}

/** The definition in the text of a file: a definition, or a request or an answer of the server with one. Throws DefinitionError. */
export function readDefinitionText(text: string): FamilyDefinition {
  let document: unknown;
  try {
    document = JSON.parse(text);
  } catch {
    throw new DefinitionError("", "is not JSON");
  }
  const { definition } = (document ?? {}) as { definition?: unknown };
  return readDefinition(definition ?? document);
}

/** Throws DefinitionError. */
export function readDefinition(document: unknown): FamilyDefinition {
  const fields = objectAt(document, "");
  const parameters = listAt(fields.parameters, "/parameters", 0, MAX_PARAMETERS, (value, at) => {
    const { description, lower, upper, default: preset } = objectAt(value, at);
    const number = (one: unknown, name: string) => numberAt(one, `${at}/${name}`, -MAX_FACTOR, MAX_FACTOR);
    return { description: textAt(description ?? "", `${at}/description`), lower: number(lower, "lower"), upper: number(upper, "upper"), default: number(preset, "default") };
  });
  const reader = new ExpressionReader(parameters.length);
  const id = textAt(fields.id, "/id");
  if (!isFamilyId(id)) throw new DefinitionError("/id", `must be 1 to ${MAX_ID_LENGTH} letters, digits, “_” or “-”`);
  if ((fields.tile === undefined) === (fields.isohedral_type === undefined)) throw new DefinitionError("", "must have either a tile or an isohedral type");
  return {
    id,
    description: textAt(fields.description ?? "", "/description"),
    parameters,
    beam_width: reader.expression(fields.beam_width, "/beam_width"),
    ...(fields.mesh_size !== undefined && { mesh_size: numberAt(fields.mesh_size, "/mesh_size", 0.01, 2) }),
    ...(fields.isohedral_type !== undefined && { isohedral_type: wholeAt(fields.isohedral_type, "/isohedral_type", 1, LAST_TYPE) }),
    ...(fields.tile !== undefined && { tile: readTile(fields.tile, reader) }),
    ...(fields.shapes !== undefined && { shapes: listAt(fields.shapes, "/shapes", 0, MAX_SHAPES, (value, at) => readShape(value, at, reader)) }),
  };
}

/** Whether a text may be the name of a family. */
export function isFamilyId(text: string): boolean {
  return /^[A-Za-z0-9_-]{1,32}$/.test(text);
}

function readTile(value: unknown, reader: ExpressionReader): TileDefinition {
  const { vertices, edges, translations, placements } = objectAt(value, "/tile");
  return {
    vertices: listAt(vertices, "/tile/vertices", 3, MAX_VERTICES, (one, at) => reader.point(one, at)),
    ...(edges !== undefined && { edges: listAt(edges, "/tile/edges", 0, MAX_VERTICES, readEdge) }),
    translations: listAt(translations, "/tile/translations", 2, 2, (one, at) => reader.point(one, at)),
    placements: listAt(placements, "/tile/placements", 1, MAX_PLACEMENTS, (one, at) => {
      const { linear, offset } = objectAt(one, at);
      return { linear: listAt(linear, `${at}/linear`, 4, 4, (entry, place) => numberAt(entry, place, -1, 1)), offset: reader.point(offset, `${at}/offset`) };
    }),
  };
}

function readEdge(value: unknown, at: string): TileEdge {
  const { shape, turned = false, mirrored = false } = objectAt(value, at);
  if (typeof turned !== "boolean" || typeof mirrored !== "boolean") throw new DefinitionError(at, "must be turned or mirrored, or not");
  return { shape: wholeAt(shape, `${at}/shape`, 0, MAX_SHAPES - 1), turned, mirrored };
}

function readShape(value: unknown, at: string, reader: ExpressionReader): EdgeShape {
  const { class: name, points, sines, pieces } = objectAt(value, at);
  const kind = CLASSES.find((one) => one === name);
  if (!kind) throw new DefinitionError(at, "must be of the class J, S, U or I");
  if (points !== undefined && (sines !== undefined || pieces !== undefined)) throw new DefinitionError(at, "must have points or sines, and not both");
  return {
    class: kind,
    ...(points !== undefined && { points: listAt(points, `${at}/points`, 1, MAX_POINTS, (one, place) => reader.point(one, place)) }),
    ...(sines !== undefined && { sines: listAt(sines, `${at}/sines`, 1, MAX_SINES, (one, place) => reader.expression(one, place)) }),
    ...(pieces !== undefined && { pieces: wholeAt(pieces, `${at}/pieces`, ...PIECES) }),
  };
}

/** Reads expressions of some number of parameters. */
class ExpressionReader {
  constructor(private readonly parameters: number) {}

  expression(value: unknown, at: string): AffineExpression {
    if (!Array.isArray(value)) return numberAt(value, at, -MAX_FACTOR, MAX_FACTOR);
    return listAt(value, at, 1, 1 + this.parameters, (one) => numberAt(one, at, -MAX_FACTOR, MAX_FACTOR));
  }

  point(value: unknown, at: string): AffinePoint {
    return listAt(value, at, 2, 2, (one) => this.expression(one, at));
  }
}

function objectAt(value: unknown, at: string): Readonly<Record<string, unknown>> {
  if (typeof value !== "object" || value === null || Array.isArray(value)) throw new DefinitionError(at, "must be an object with fields");
  return value as Readonly<Record<string, unknown>>;
}

function textAt(value: unknown, at: string): string {
  if (typeof value !== "string" || value.length > MAX_WORDS_LENGTH) throw new DefinitionError(at, `must be a text of at most ${MAX_WORDS_LENGTH} letters`);
  return value;
}

function numberAt(value: unknown, at: string, lower: number, upper: number): number {
  if (typeof value !== "number" || !(value >= lower && value <= upper)) throw new DefinitionError(at, `must be a number from ${lower} to ${upper}`);
  return value;
}

function wholeAt(value: unknown, at: string, lower: number, upper: number): number {
  const number = numberAt(value, at, lower, upper);
  if (!Number.isInteger(number)) throw new DefinitionError(at, "must be a whole number");
  return number;
}

function listAt<Value>(value: unknown, at: string, min: number, max: number, read: (value: unknown, at: string) => Value): Value[] {
  if (!Array.isArray(value) || value.length < min || value.length > max) {
    throw new DefinitionError(at, min === max ? `must be a list of ${min}` : `must be a list of ${min} to ${max}`);
  }
  return value.map((one, k) => read(one, `${at}/${k}`));
}
