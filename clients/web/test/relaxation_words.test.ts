import { describe, expect, it } from "vitest";
import { notesOf, vertexWords } from "../src/mesh/relaxation_words";

const ANSWER = { warnings: ["Springs cross."], springs: [], history: [], mollified: false, at_vertices: [1, 4] };

describe("the words about a relaxed network", () => {
  it("begin with what its user has to know, which points at rest on vertices are not", () => {
    expect(notesOf(ANSWER)).toEqual(["Springs cross."]);
    expect(notesOf({ ...ANSWER, mollified: true })).toHaveLength(2);
  });

  it("say what it means that points rest on vertices", () => {
    expect(vertexWords(ANSWER)).toMatch(/^2 points rest exactly at corners .* nothing has to be done\.$/);
    expect(vertexWords({ at_vertices: ANSWER.at_vertices.slice(0, 1) })).toMatch(/^1 point rests exactly/);
    expect(vertexWords({ at_vertices: [] })).toBe("");
  });
});
