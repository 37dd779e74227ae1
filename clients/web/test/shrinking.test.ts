import { expect, test } from "vitest";
import type { Vector } from "../src/mesh/mesh_data";
import { DEFAULT_NETWORK } from "../src/mesh/network_state";
import { farthestPoints, hasShrunk, willShrink } from "../src/mesh/shrinking";

test("springs without a rest length shrink where no point is held", () => {
  const springs = { ...DEFAULT_NETWORK, elements: "springs", fixed: [], restLength: 0 } as const;
  expect(willShrink(springs)).toBe(true);
  expect(willShrink({ ...springs, fixed: [3] })).toBe(false);
  expect(willShrink({ ...springs, restLength: 0.2 })).toBe(false);
  expect(willShrink({ ...springs, elements: "membrane" })).toBe(false);
  expect(willShrink({ ...springs, springs: "drawn", drawn: [{ between: [0, 1], restLength: 0.1 }] })).toBe(false);
  expect(willShrink({ ...springs, springs: "drawn", drawn: [{ between: [0, 1] }] })).toBe(true);
});

test("a network that came to rest without any energy has shrunk", () => {
  expect(hasShrunk([2.3, 0.4, 2.2e-24])).toBe(true);
  expect(hasShrunk([2.3, 0.4, 0.1])).toBe(false);
  expect(hasShrunk([0, 0])).toBe(false);
  expect(hasShrunk([])).toBe(false);
});

test("points far from each other are on all sides", () => {
  const corners: Vector[] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
  const inner: Vector[] = corners.map(([x, y, z]) => [0.4 * x + 0.01, 0.4 * y, 0.4 * z]);
  const found = farthestPoints([...inner, ...corners], 6);
  expect(found).toEqual([6, 7, 8, 9, 10, 11]);
  expect(farthestPoints([[0, 0, 0], [1, 0, 0]], 6)).toEqual([0, 1]);
  expect(farthestPoints([], 6)).toEqual([]);
});
