// Changes of a definition that are no drags, each of which leaves the drawn tiling as it is, or changes what it says.
import { describe, expect, it } from "vitest";
import type { FamilyDefinition } from "../src/contract/types";
import { dragOf } from "../src/family/drags";
import { changedLine, changedParameter, defaultsHere, type Edited, fixedParameter, fixedWidth, hasFixedHeight, heightAsParameter, lineOf, moveAsParameter, widthAsParameter,
  widthParameter, withoutPoint, withPoint } from "../src/family/edits";
import { expressionOf, substituted, withFactor } from "../src/family/expressions";
import { familyOfType, stateOf, typeName, withinBounds } from "../src/family/state";
import { areaOf, type DrawnFamily, meanSide, tilingAt } from "../src/family/tiling";
import { drawn, exampleCheck, shipped, stateFor, TYPES } from "./family_fixtures";

const ARCHES = exampleCheck("arches").body.definition;
const SHOWN = [0.35, 0.08, 0.25];

function expectSameTiling(before: DrawnFamily, shown: readonly number[], after: Edited): void {
  const [a, b] = [tilingAt(before, shown), tilingAt(drawn(after.definition), after.shown)];
  expect(b.outline).toHaveLength(a.outline.length);
  for (const [k, [x, y]] of a.outline.entries()) expect(Math.hypot(x - b.outline[k][0], y - b.outline[k][1])).toBeLessThan(1e-9);
  for (const [k, [x, y]] of a.lattice.entries()) expect(Math.hypot(x - b.lattice[k][0], y - b.lattice[k][1])).toBeLessThan(1e-9);
  expect(b.beamWidth).toBeCloseTo(a.beamWidth, 12);
}

describe("an expression", () => {
  it("has no zeros at its end, and loses a parameter to its constant", () => {
    expect(expressionOf(1, [0, 2, 0])).toEqual([1, 0, 2]);
    expect(expressionOf(1, [0])).toBe(1);
    expect(substituted([1, 2, 3], 0, 10)).toEqual([21, 3]);
    expect(substituted([1, 2], 1, 10)).toEqual([1, 2]);
    expect(withFactor(5, 2, 7)).toEqual([5, 0, 0, 7]);
  });
});

describe("a parameter", () => {
  it("that is fixed where it is shown leaves the tiling as it is", () => {
    const family = shipped("IH22");
    const shown = family.definition.parameters.map(({ lower, upper }) => 0.3 * lower + 0.7 * upper);
    for (const index of [0, 1, 2]) {
      const after = fixedParameter(family, { definition: family.definition, shown }, index);
      expect(after.definition.parameters).toHaveLength(2);
      expectSameTiling(family, shown, after);
    }
  });

  it("of an isohedral type that is fixed writes the tile out, and one of an edge does not", () => {
    const family = drawn(ARCHES);
    const ofType = fixedParameter(family, { definition: ARCHES, shown: SHOWN }, 0);
    expect(ofType.definition).toMatchObject({ tile: expect.anything(), beam_width: [0, 0, 1] });
    expect(ofType.definition.isohedral_type).toBeUndefined();
    expectSameTiling(family, SHOWN, ofType);
    const ofEdge = fixedParameter(family, { definition: ARCHES, shown: SHOWN }, 1);
    expect(ofEdge.definition).toMatchObject({ isohedral_type: 29, shapes: [{ class: "I" }, { class: "J", sines: [0.08] }], beam_width: [0, 0, 1] });
    expectSameTiling(family, SHOWN, ofEdge);
  });

  it("has its default and what is shown within bounds that are moved", () => {
    const { definition, shown } = changedParameter({ definition: ARCHES, shown: SHOWN }, 0, { lower: 0.38, upper: 0.39 });
    expect(definition.parameters[0]).toMatchObject({ lower: 0.38, upper: 0.39, default: 0.39 });
    expect(shown).toEqual([0.38, 0.08, 0.25]);
    expect(withinBounds(definition, [5])).toEqual([0.39, 0.05, 0.2]);
  });

  it("has the shown value as its default where one says so", () => {
    expect(defaultsHere({ definition: ARCHES, shown: SHOWN }).definition.parameters.map((parameter) => parameter.default)).toEqual(SHOWN);
  });
});

describe("the width of the beams", () => {
  it("becomes a parameter from a twentieth to a fifth of the mean side, with the width as it was", () => {
    const family = shipped("IH21");
    const shown = [0.12, 0.6];
    const after = widthAsParameter(family, { definition: family.definition, shown });
    const { lower, upper, default: preset } = after.definition.parameters[2];
    const side = meanSide(tilingAt(family, shown));
    expect(preset).toBe(0.0641);
    expect(lower).toBeCloseTo(Math.min(0.0641, 0.05 * side), 4);
    expect(upper / side).toBeCloseTo(0.2, 3);
    expect(widthParameter(after.definition)).toBe(2);
    expectSameTiling(family, shown, after);
  });

  it("is fixed again, and its parameter is gone if nothing else depends on it", () => {
    const after = fixedWidth(drawn(ARCHES), { definition: ARCHES, shown: SHOWN }, 0.25);
    expect(after.definition.parameters).toHaveLength(2);
    expect(after.definition.beam_width).toBe(0.25);
    expect(after.shown).toEqual([0.35, 0.08]);
    expect(after.definition.isohedral_type).toBe(29);
  });
});

describe("the line of an edge", () => {
  it("is straight, a curve or bent, and loses the parameters that only it had", () => {
    const family = drawn(ARCHES);
    const straight = changedLine(family, { definition: ARCHES, shown: SHOWN }, 1, "straight");
    expect(straight.definition.shapes).toEqual([{ class: "I" }, { class: "J" }]);
    expect(straight.definition.parameters.map(({ description }) => description)).toEqual(["Height of the pentagon", "Width of the beams"]);
    expect(straight.definition.beam_width).toEqual([0, 0, 1]);
    const bent = changedLine(family, { definition: ARCHES, shown: SHOWN }, 1, "bent");
    expect(bent.definition.shapes?.map(lineOf)).toEqual(["straight", "bent"]);
    const curved = changedLine(shipped("IH21"), stateFor(shipped("IH21")), 0, "curve");
    expect(curved.definition.shapes?.[0]).toEqual({ class: "S", sines: [0, 0.1] });
  });

  it("gets points before others, and loses them until it is straight", () => {
    const family = drawn({ ...ARCHES, parameters: ARCHES.parameters.slice(0, 1), beam_width: 0.2, shapes: [{ class: "I" }, { class: "J", points: [[0.4, 0.2]] }] });
    const more = withPoint(family, stateFor(family), 1, 0);
    expect(more.definition.shapes?.[1].points).toEqual([[0.2, 0.1], [0.4, 0.2]]);
    const fewer = withoutPoint(drawn(more.definition), more, 1, 0);
    expect(fewer.definition.shapes?.[1].points).toEqual([[0.4, 0.2]]);
    expect(withoutPoint(drawn(fewer.definition), fewer, 1, 0).definition.shapes?.[1]).toEqual({ class: "J" });
  });

  it("has a height that becomes a parameter and leaves the tiling as it is", () => {
    for (const shape of [{ class: "J" as const, sines: [0.12, 0.03] }, { class: "J" as const, points: [[0.3, 0.1], [0.6, 0.2]] as [number, number][] }]) {
      const definition: FamilyDefinition = { ...ARCHES, parameters: ARCHES.parameters.slice(0, 1), beam_width: 0.2, shapes: [{ class: "I" }, shape] };
      const family = drawn(definition);
      expect(hasFixedHeight(shape)).toBe(true);
      const after = heightAsParameter(family, stateFor(family), 1);
      expect(after.definition.parameters).toHaveLength(2);
      expectSameTiling(family, stateFor(family).shown, after);
      expect(hasFixedHeight(after.definition.shapes?.[1] ?? { class: "I" })).toBe(false);
    }
    expect([{ class: "J" as const }, { class: "I" as const }].map(hasFixedHeight)).toEqual([false, false]);
  });
});

describe("a drag that becomes a parameter", () => {
  it("leads from the tile before it to the one after it", () => {
    const before = shipped("IH28");
    const state = stateFor(before);
    const drag = dragOf(before, state, { kind: "vertex", vertex: 2 }, "tile");
    if (!drag) throw new Error("The vertex cannot be dragged.");
    const after = drawn(drag([0.03, 0.05]).definition);
    const made = moveAsParameter(before, after, state.shown, "Place of vertex 3");
    expect(made.definition.parameters.at(-1)).toEqual({ description: "Place of vertex 3", lower: 0, upper: 1, default: 1 });
    expectSameTiling(after, state.shown, made);
    expectSameTiling(before, state.shown, { ...made, shown: [...state.shown, 0] });
  });
});

describe("a family of a type", () => {
  it("has the type's parameters near their defaults, and beams of a tenth of the mean side", () => {
    const type = TYPES[1];
    const definition = familyOfType(type);
    expect(typeName(type.number)).toBe("IH21");
    expect(definition).toMatchObject({ id: "my-ih21", isohedral_type: 21, shapes: [{ class: "S" }, { class: "J" }, { class: "J" }] });
    expect(definition.parameters[1].upper - definition.parameters[1].lower).toBeCloseTo(0.2, 3);
    const tiling = tilingAt(drawn(definition), stateOf(definition).shown);
    expect(tiling.beamWidth / meanSide(tiling)).toBeCloseTo(0.1, 3);
  });

  it("has bounds within which its tiles do not nearly vanish", () => {
    const definition = familyOfType(TYPES[0]);
    const width = definition.parameters[0].upper - definition.parameters[0].lower;
    expect(width, "hexagons are turned inside out at a tenth from the defaults").toBeLessThan(0.15);
    const family = drawn(definition);
    const area = (parameters: readonly number[]) => areaOf(tilingAt(family, parameters).outline);
    const [lower, defaults] = [definition.parameters.map((parameter) => parameter.lower), definition.parameters.map((parameter) => parameter.default)];
    expect(area(lower) / area(defaults)).toBeGreaterThan(0.1);
  });
});
