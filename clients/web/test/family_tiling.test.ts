// The geometry of tilings: the contract's examples, the shipped families, and the shapes of edges.
import { describe, expect, it } from "vitest";
import type { EdgeShape, FamilyDefinition } from "../src/contract/types";
import { definitionKey } from "../src/family/definition_key";
import type { Vector } from "../src/family/expressions";
import { edgePairs } from "../src/family/matching";
import { copiesOf, cameraOn, isInSight, nearestCopy, toPixels, toPlane } from "../src/family/tiling_drawing";
import { areaOf, chordPoints, drawnFamily, meanSide, selfCrossings, tilingAt } from "../src/family/tiling";
import { anywhere, drawn, exampleCheck, random, SHIPPED, shipped, TYPES } from "./family_fixtures";

function expectPoints(found: readonly (readonly number[])[], wanted: readonly (readonly number[])[]): void {
  expect(found).toHaveLength(wanted.length);
  found.forEach(([x, y], k) => {
    expect(Math.hypot(x - wanted[k][0], y - wanted[k][1]), `point ${k}`).toBeLessThan(1e-12);
  });
}

describe("a tiling", () => {
  it("is that of the contract's examples", () => {
    const arches = exampleCheck("arches");
    const { lattice, beamWidth, tiles } = tilingAt(drawn(arches.body.definition), arches.body.parameters ?? []);
    expectPoints(lattice, arches.response.tiling.lattice);
    expect(beamWidth).toBe(arches.response.tiling.beam_width);
    expect(tiles).toHaveLength(4);
    const squares = exampleCheck("squares");
    const plain = tilingAt(drawn(squares.body.definition), squares.response.tiling.parameters);
    expectPoints(plain.lattice, squares.response.tiling.lattice);
    plain.tiles.forEach((tile, k) => expectPoints(tile, squares.response.tiling.tiles[k]));
  });

  it("of each shipped family covers the plane once, and its tiles meet edge to edge, at parameters anywhere in the bounds", () => {
    const next = random(1);
    for (const definition of SHIPPED) {
      const family = drawn(definition);
      for (let trial = 0; trial < 20; ++trial) {
        const parameters = anywhere(family, next);
        const { tiles, lattice: [a, b] } = tilingAt(family, parameters);
        const cell = Math.abs(a[0] * b[1] - a[1] * b[0]);
        expect(tiles.reduce((sum, tile) => sum + Math.abs(areaOf(tile)), 0) / cell, definition.id).toBeCloseTo(1, 12);
        expect(edgePairs(family, parameters), definition.id).toHaveLength((family.tile.vertices.length * tiles.length) / 2);
      }
    }
  });

  it("with bent and curved edges covers the plane once, too", () => {
    const { body } = exampleCheck("arches");
    const { tiles, lattice: [a, b] } = tilingAt(drawn(body.definition), [0.4, 0.1, 0.2]);
    expect(tiles.reduce((sum, tile) => sum + Math.abs(areaOf(tile)), 0)).toBeCloseTo(Math.abs(a[0] * b[1] - a[1] * b[0]), 10);
  });

  it("leaves a gap where the translations do not fit the sides: no edge has a partner there", () => {
    const { body, response } = exampleCheck("squares");
    const pairs = edgePairs(drawn(body.definition), response.tiling.parameters);
    expect(pairs.map(({ first, second }) => [first.ends, second.ends])).toEqual([[[0, 1], [2, 3]]]);
  });

  it("has the mean side of its tile, to which beams are compared", () => {
    expect(meanSide(tilingAt(drawn(exampleCheck("squares").body.definition), [1]))).toBeCloseTo(1, 12);
  });
});

describe("a family that cannot be drawn", () => {
  it("names a type that there is not, has too few parameters for its type, or no tile", () => {
    const definition: FamilyDefinition = { id: "x", description: "", parameters: [], beam_width: 0.1 };
    for (const wrong of [{}, { isohedral_type: 19 }, { isohedral_type: 29 }]) expect(drawnFamily({ ...definition, ...wrong }, TYPES)).toBeNull();
  });
});

describe("the shape of an edge", () => {
  const points = (shape: EdgeShape, parameters: readonly number[] = []) => chordPoints(shape, parameters);

  it("is completed as its class says", () => {
    expectPoints(points({ class: "J", points: [[0.2, 0.1], [0.7, 0.3]] }), [[0.2, 0.1], [0.7, 0.3]]);
    expectPoints(points({ class: "S", points: [[0.2, 0.1]] }), [[0.2, 0.1], [0.5, 0], [0.8, -0.1]]);
    expectPoints(points({ class: "U", points: [[0.2, 0.1]] }), [[0.2, 0.1], [0.8, 0.1]]);
    expectPoints(points({ class: "U", points: [[0.2, 0.1], [0.5, 0.3]] }), [[0.2, 0.1], [0.5, 0.3], [0.8, 0.1]]);
    expect(points({ class: "I" })).toEqual([]);
  });

  it("of sines is drawn with as many pieces as it says, and follows parameters", () => {
    const curve = points({ class: "J", sines: [[0.1, 2]], pieces: 4 }, [0.05]);
    expectPoints(curve, [[0.25, 0.2 * Math.sin(Math.PI / 4)], [0.5, 0.2], [0.75, 0.2 * Math.sin((3 * Math.PI) / 4)]]);
    expect(points({ class: "S", sines: [0, 0.1] })).toHaveLength(15);
  });

  it("crosses others where the drawing marks it", () => {
    expect(selfCrossings([[0, 0], [1, 1], [1, 0], [0, 1]])).toEqual([[0.5, 0.5]]);
    expect(selfCrossings([[0, 0], [1, 0], [1, 1], [0, 1]])).toEqual([]);
  });
});

describe("the drawing of a tiling", () => {
  const tiling = tilingAt(shipped("IH21"), [0.105, 0.65]);
  const camera = cameraOn(tiling, 600, 400);

  it("has the tile in its middle, and converts places to pixels and back", () => {
    expect(isInSight(tiling, camera)).toBe(true);
    expect(isInSight(tiling, { ...camera, scale: 5 * camera.scale })).toBe(false);
    const place: Vector = [0.3, -0.2];
    expectPoints([toPlane(camera, toPixels(camera, place))], [place]);
  });

  it("is filled by copies of the cell: each place of it lies in a tile of one of them", () => {
    const copies = copiesOf(tiling, camera);
    const next = random(3);
    const { lattice: [a, b], tiles } = tiling;
    for (let trial = 0; trial < 60; ++trial) {
      const place = toPlane(camera, [600 * next(), 400 * next()]);
      const windings = copies.reduce((sum, [i, k]) => sum + tiles.filter((tile) => contains(tile, [place[0] - i * a[0] - k * b[0], place[1] - i * a[1] - k * b[1]])).length, 0);
      expect(windings).toBe(1);
    }
  });

  it("marks a place at its copy that is nearest to the middle", () => {
    const { lattice: [a, b] } = tiling;
    const [x, y] = nearestCopy(tiling, camera, [camera.centre[0] + 3 * a[0] - 2 * b[0] + 0.1, camera.centre[1] + 3 * a[1] - 2 * b[1]]);
    expect(Math.hypot(x - camera.centre[0] - 0.1, y - camera.centre[1])).toBeLessThan(1e-9);
  });

  it("is not filled by very many copies of a cell that is nearly a line", () => {
    expect(copiesOf({ ...tiling, lattice: [[1e-7, 0], [0, 1e-7]] }, camera)).toEqual([[0, 0]]);
    expect(copiesOf({ ...tiling, lattice: [[1, 0], [2, 0]] }, camera)).toEqual([[0, 0]]);
  });
});

/** Whether a place is within an outline, by the parity of the crossings to the right of it. */
function contains(outline: readonly Vector[], [x, y]: Vector): boolean {
  return outline.filter(([px, py], k) => {
        const [qx, qy] = outline[(k + 1) % outline.length];
        return py > y !== qy > y && x < px + ((y - py) / (qy - py)) * (qx - px);
      }).length % 2 === 1;
}

describe("the key of a definition", () => {
  it("is the same where a file leaves out what is the default, and another one for another family", () => {
    const [definition] = SHIPPED;
    const written = JSON.parse(JSON.stringify(definition)) as FamilyDefinition;
    for (const edge of written.tile?.edges ?? []) {
      edge.turned ??= false;
      edge.mirrored ??= false;
    }
    written.mesh_size = 0.5;
    const { shapes, ...others } = written;
    expect(definitionKey({ shapes, ...others })).toBe(definitionKey(definition));
    expect(definitionKey({ ...definition, beam_width: [0.1282, 0, 0] })).toBe(definitionKey(definition));
    expect(definitionKey({ ...definition, beam_width: 0.13 })).not.toBe(definitionKey(definition));
    expect(definitionKey({ ...definition, parameters: definition.parameters.slice(1) })).not.toBe(definitionKey(definition));
  });
});
