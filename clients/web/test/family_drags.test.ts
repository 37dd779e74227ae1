// Drags of vertices and edges: which parameters or coefficients they change, and that the tiles still fill the plane.
import { describe, expect, it } from "vitest";
import type { AffinePoint, FamilyDefinition } from "../src/contract/types";
import { canDrag, type Drag, dragOf, type DragMode, type Handle, handlesOf, placeOf } from "../src/family/drags";
import { constantOf, factorsOf, type Vector } from "../src/family/expressions";
import { edgePairs } from "../src/family/matching";
import { areaOf, type DrawnFamily, tilingAt } from "../src/family/tiling";
import { drawn, exampleCheck, random, SHIPPED, shipped, stateFor } from "./family_fixtures";

const SLANTED = exampleCheck("slanted").body.definition;

function dragged(family: DrawnFamily, handle: Handle, mode: DragMode, by: Vector, shown?: readonly number[]): ReturnType<Drag> {
  const drag = dragOf(family, stateFor(family, shown), handle, mode);
  if (!drag) throw new Error("The handle cannot be dragged.");
  return drag(by);
}

const vertex = (index: number): Handle => ({ kind: "vertex", vertex: index });
const placeAfter = (state: ReturnType<Drag>, handle: Handle) => placeOf(drawn(state.definition), handle, state.shown);

function expectPoint(point: AffinePoint, constants: Vector, factors: readonly (readonly number[])[]): void {
  point.forEach((expression, axis) => {
    expect(constantOf(expression)).toBeCloseTo(constants[axis], 12);
    expect(factorsOf(expression)).toEqual(factors[axis]);
  });
}

describe("a drag that moves parameters", () => {
  it("changes those on which the vertex depends, and nothing of the definition", () => {
    const family = drawn(SLANTED);
    const after = dragged(family, vertex(2), "parameters", [0.1, 0.7]);
    expect(after.shown[0]).toBeCloseTo(0.4, 12);
    expect(after.definition).toBe(SLANTED);
    expect(dragOf(family, stateFor(family), vertex(1), "parameters"), "it depends on none").toBeNull();
  });

  it("moves bounds along that are in its way", () => {
    const after = dragged(drawn(SLANTED), vertex(2), "parameters", [0.5, 0]);
    expect(after.shown[0]).toBeCloseTo(0.8, 12);
    expect(after.definition.parameters[0]).toMatchObject({ lower: 0.1, default: 0.3 });
    expect(after.definition.parameters[0].upper).toBe(after.shown[0]);
    expect(after.definition.tile).toBe(SLANTED.tile);
  });

  it("brings a vertex of two parameters to the pointer", () => {
    const family = shipped("IH21");
    const [x, y] = placeOf(family, vertex(1), [0.15, 0.65]);
    const after = dragged(family, vertex(1), "parameters", [0.05, -0.03], [0.15, 0.65]);
    const [u, v] = placeAfter(after, vertex(1));
    expect(Math.hypot(u - x - 0.05, v - y + 0.03)).toBeLessThan(1e-12);
  });
});

describe("a drag that changes the tile", () => {
  it("changes the constants of the vertex and of what has to follow, and no factors", () => {
    const { definition, shown } = dragged(drawn(SLANTED), vertex(1), "tile", [0.1, 0.05]);
    const { vertices, translations } = definition.tile as NonNullable<FamilyDefinition["tile"]>;
    expect(shown).toEqual([0.3]);
    expect(vertices[0]).toEqual([0, 0]);
    expectPoint(vertices[1], [1.1, 0.05], [[], []]);
    expect(vertices[2], "the neighbours stay").toEqual([[1, 1], 1]);
    expectPoint(vertices[3], [-0.1, 0.95], [[1], []]);
    expectPoint(translations[0], [1.1, 0.05], [[], []]);
    expectPoint(translations[1], [-0.1, 0.95], [[1], []]);
  });

  it("leaves the tiles of each family edge to edge at all parameters, with the vertex where the pointer is if it can be there", () => {
    const next = random(7);
    for (const definition of SHIPPED) {
      const family = drawn(definition);
      const defaults = definition.parameters.map((parameter) => parameter.default);
      family.tile.vertices.forEach((_, k) => {
        const by: Vector = [0.02 * (next() - 0.5), 0.02 * (next() - 0.5)];
        const drag = dragOf(family, stateFor(family), vertex(k), "tile");
        if (!drag) return;
        const after = drag(by);
        const moved = drawn(after.definition);
        for (const at of [defaults, definition.parameters.map(({ lower, upper }) => (lower + upper) / 2)]) {
          const { tiles, lattice: [a, b] } = tilingAt(moved, at);
          expect(edgePairs(moved, at), `${definition.id}, vertex ${k}`).toHaveLength((family.tile.vertices.length * tiles.length) / 2);
          expect(tiles.reduce((sum, tile) => sum + Math.abs(areaOf(tile)), 0) / Math.abs(a[0] * b[1] - a[1] * b[0])).toBeCloseTo(1, 10);
        }
        const [x, y] = placeOf(family, vertex(k), defaults);
        const [u, v] = placeAfter(after, vertex(k));
        expect(Math.hypot(u - x, v - y), "no farther than the pointer").toBeLessThan(Math.hypot(...by) + 1e-9);
      });
    }
  });

  it("of hexagons moves the vertex and the opposite one alone", () => {
    const family = shipped("IH01");
    const { definition } = dragged(family, vertex(2), "tile", [0.03, 0.01]);
    const moves = (definition.tile?.vertices ?? []).map((point, k) => point.map((expression, axis) => constantOf(expression) - constantOf(family.tile.vertices[k][axis])));
    const still = moves.map(([x, y]) => Math.hypot(x, y) < 1e-12);
    expect(still).toEqual([true, true, false, true, true, false]);
    expect(moves[2][0]).toBeCloseTo(0.03, 12);
    expect(moves[5][0]).toBeCloseTo(-0.03, 12);
  });

  it("writes the tile of a type out, with the shapes of its edges", () => {
    const family = drawn({ id: "a", description: "", parameters: SHIPPED[4].parameters, beam_width: 0.2, isohedral_type: 29 });
    const { definition } = dragged(family, vertex(3), "tile", [0, 0.1]);
    expect(definition.isohedral_type).toBeUndefined();
    expect(definition.tile?.placements).toHaveLength(4);
    expect(definition.shapes).toEqual([{ class: "I" }, { class: "J" }]);
  });
});

describe("a drag of an edge", () => {
  const first = (family: DrawnFamily) => handlesOf(family).find((handle) => handle.kind !== "vertex") as Handle;

  it("bends a straight one to a curve whose height is that of the pointer over its chord", () => {
    const family = drawn(
      SLANTED.tile ? { ...SLANTED, shapes: [{ class: "J" }], tile: { ...SLANTED.tile, edges: [0, 1, 2, 3].map((k) => ({ shape: 0, turned: k > 1 })) } } : SLANTED,
    );
    const handle = first(family);
    expect(handle).toMatchObject({ kind: "sine", sine: 1, edge: 0 });
    const after = dragged(family, handle, "parameters", [0, 0.2]);
    expect(after.definition.shapes).toEqual([{ class: "J", sines: [0.2] }]);
    expect(placeAfter(after, handle)[1]).toBeCloseTo(0.2, 12);
  });

  it("bends one that is symmetric about its middle with its second sine", () => {
    const family = shipped("IH21");
    const handle = first(family);
    expect(handle).toMatchObject({ kind: "sine", sine: 2, shape: 0 });
    const { definition } = dragged(family, handle, "tile", [0.1, 0]);
    const sines = definition.shapes?.[0].sines as number[];
    expect(sines[0]).toBe(0);
    expect(sines[1]).not.toBe(0);
    expect(definition.tile, "shapes are not part of the tile").toBe(family.definition.tile);
  });

  it("moves the parameter of its height, or else the height itself", () => {
    const family = drawn(exampleCheck("arches").body.definition);
    const handle = handlesOf(family).find((one) => one.kind === "sine") as Handle;
    const shown = [0.4, 0.05, 0.2];
    const byParameter = dragged(family, handle, "parameters", [0.1, 0.1], shown);
    expect(byParameter.shown[1]).not.toBe(0.05);
    expect([byParameter.shown[0], byParameter.shown[2]]).toEqual([0.4, 0.2]);
    expect(byParameter.definition.shapes).toBe(family.definition.shapes);
    const byShape = dragged(family, handle, "tile", [0.1, 0.1], shown);
    expect(byShape.shown).toEqual(shown);
    const [constant, ...factors] = (byShape.definition.shapes?.[1].sines ?? [])[0] as number[];
    expect(factors).toEqual([0, 1]);
    expect(constant).toBeCloseTo(byParameter.shown[1] - 0.05, 12);
  });

  it("follows the pointer on edges that are turned and mirrored", () => {
    for (const edge of [{ shape: 0 }, { shape: 0, turned: true }, { shape: 0, mirrored: true }, { shape: 0, turned: true, mirrored: true }]) {
      const family = drawn({
        ...SLANTED,
        shapes: [{ class: "J", points: [[0.3, 0.1]] }],
        tile: { ...(SLANTED.tile as NonNullable<FamilyDefinition["tile"]>), edges: [edge, edge, edge, edge] },
      });
      const handle = first(family);
      const [x, y] = placeOf(family, handle, [0.3]);
      const [u, v] = placeAfter(dragged(family, handle, "tile", [0.07, -0.04]), handle);
      expect(Math.hypot(u - x - 0.07, v - y + 0.04)).toBeLessThan(1e-12);
    }
  });

  it("leaves the middle of a mirrored one in the middle", () => {
    const family = drawn({
      ...SLANTED,
      shapes: [{ class: "U", points: [[0.5, 0.1]] }],
      tile: { ...(SLANTED.tile as NonNullable<FamilyDefinition["tile"]>), edges: [0, 1, 2, 3].map(() => ({ shape: 0 })) },
    });
    const { definition } = dragged(family, first(family), "tile", [0.2, 0.1]);
    expect(definition.shapes?.[0].points?.[0][0]).toBe(0.5);
    expect(definition.shapes?.[0].points?.[0][1]).toBeCloseTo(0.2, 12);
  });
});

describe("the handles of a tile", () => {
  it("are its vertices and one for each shape of edges, and say which of them something moves", () => {
    const family = shipped("IH67");
    const handles = handlesOf(family);
    expect(handles).toHaveLength(4 + 1);
    expect(canDrag(family, stateFor(family), handles, "parameters")).toEqual([false, true, true, false, true]);
    expect(canDrag(family, stateFor(family), handles, "tile").slice(0, 4)).toEqual([true, true, true, true]);
  });
});
