// A text that is the same for definitions of the same family, however their files leave out what is the default.
import type { AffineExpression, FamilyDefinition, TileDefinition } from "../contract/types";
import { constantOf, expressionOf, factorsOf, mapped } from "./expressions";

const DEFAULT_MESH_SIZE = 0.5;
const DEFAULT_PIECES = 16;

const tidy = (expression: AffineExpression): AffineExpression => expressionOf(constantOf(expression), factorsOf(expression));

function tileKey({ vertices, edges = [], translations, placements }: TileDefinition): unknown {
  return [vertices, edges.map(({ shape, turned = false, mirrored = false }) => [shape, turned, mirrored]), translations, placements.map(({ linear, offset }) => [linear, offset])];
}

export function definitionKey(definition: FamilyDefinition): string {
  const { id, description, parameters, beam_width, mesh_size = DEFAULT_MESH_SIZE, isohedral_type, tile, shapes = [] } = mapped(definition, tidy);
  return JSON.stringify([
    id,
    description,
    parameters.map((parameter) => [parameter.description, parameter.lower, parameter.upper, parameter.default]),
    beam_width,
    mesh_size,
    isohedral_type ?? (tile && tileKey(tile)),
    shapes.map(({ class: kind, points, sines, pieces = DEFAULT_PIECES }) => [kind, points ?? sines ?? null, points ? "bent" : sines ? pieces : "straight"]),
  ]);
}
