import { expect, test } from "vitest";
import type { WeaveLayout } from "../src/contract/types";
import { fused, ownCrossings, spreadFactor, spreadWeave } from "../src/weave/print_repairs";
import { DEFAULT_STATE, FIRST_LAYOUT } from "../src/weave/state";

const lift = (available: number) => ({
  pointer: "/weave/crossings/3",
  detail: `strands/1 must be lifted 3.0000 mm before and after it and has ${available.toFixed(4)} mm to where it lies on the bed: an end, a fused crossing or another channel`,
  needed: 3,
  available,
});
const channel = {
  pointer: "/weave/crossings/4",
  detail: "a channel needs 1.2000 mm and 1.4400 mm for its feet, and there are 1.1000 mm to the end of the strand",
  needed: 1.44,
  available: 1.1,
};

test("crossings too near are spread by the factor that the worst of them needs", () => {
  expect(spreadFactor({ errors: [lift(2.2), channel] })).toBe(1.4);
  expect(spreadFactor({ errors: [channel] })).toBe(1.4);
});

test("no factor is offered without room, far too little of it, or for a fault of another kind", () => {
  expect(spreadFactor({ errors: [lift(0)] })).toBeNull();
  expect(spreadFactor({ errors: [lift(0.5)] })).toBeNull();
  expect(spreadFactor({ errors: [lift(2.2), { pointer: "/weave/crossings/5", detail: "has 2 strands that slide; one can be printed" }] })).toBeNull();
  expect(spreadFactor({})).toBeNull();
  expect(spreadFactor({ errors: [{ ...lift(2.2), detail: "there is too little room" }] }), "the sentence is for people").toBe(1.4);
});

test("a weave that is spread keeps the thickness of its strands", () => {
  const { lengths } = DEFAULT_STATE;
  expect(spreadWeave(DEFAULT_STATE, 1.5)?.lengths).toEqual({ ...lengths, circle_radius: 8.25, distance: 15 });
  expect(spreadWeave({ ...DEFAULT_STATE, pattern: "actuated_rings" }, 1.5)).toBeNull();
  const own = spreadWeave({ ...DEFAULT_STATE, pattern: "layout", layout: FIRST_LAYOUT }, 2);
  expect(own?.layout.lattice).toEqual([[20, 0], [0, 20]]);
  expect(own?.layout.strands[0]).toEqual({ points: [[0, 10], [5, 13], [15, 7]], ends: "periodic", translation: [20, 0] });
});

test("crossings of a sheet are fused where the cell has them, and once for all copies", () => {
  const layoutOf = (places: readonly number[][]) =>
    ({ lattice: [[10, 0], [0, 10]], strands: [{ polyline: [[0, 0]] }], crossings: places.map((position) => ({ position, members: [] })) }) as unknown as WeaveLayout;
  const cell = layoutOf([[2, 2], [7, 7]]);
  const sheet = layoutOf([[2, 2], [12, 2], [17, 7], [4, 4]]);
  expect(ownCrossings(DEFAULT_STATE, cell, sheet, [0, 1, 2])).toEqual([0, 1]);
  expect(ownCrossings(DEFAULT_STATE, cell, sheet, [3])).toBeNull();
  expect(ownCrossings({ ...DEFAULT_STATE, pattern: "actuated_rings" }, null, sheet, [3])).toEqual([3]);
  expect(fused([{ crossing: 1, slides: [0] }], [1, 3])).toEqual([{ crossing: 1, slides: [] }, { crossing: 3, slides: [] }]);
});
