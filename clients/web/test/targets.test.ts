import { describe, expect, it } from "vitest";
import type { ControlPoint, Interpolation } from "../src/design/state";
import { relativeDeviation, targetCurve } from "../src/design/spline";
import { addPoint, convertedPoints, HALF_TURN, isAtRest, movePoint, pointsOnProfile, removePoint, middleOfGapAfter, targetOnProfile, wrapped } from "../src/design/targets";

const extent = { lower: -0.1, upper: 0.2 };
const line: ControlPoint[] = [[-0.1, -1], [0, 0], [0.1, 1], [0.2, 2]];
const ring: ControlPoint[] = [[0.1, 1], [1, 2], [2, 3]];

const increasing = (points: readonly ControlPoint[]) => points.every((p, k) => k === 0 || p[0] > points[k - 1][0]);

describe("control points over strain", () => {
  it("stay between their neighbours and within the extent", () => {
    for (const x of [-5, -0.1, 0, 0.05, 0.1, 5]) {
      for (const index of [0, 2, 3]) {
        const [moved, at] = movePoint("stress_strain", line, index, [x, 7], extent);
        expect(at).toBe(index);
        expect(moved[index][1]).toBe(7);
        expect(increasing(moved)).toBe(true);
        expect(moved[0][0]).toBeGreaterThanOrEqual(-0.1);
        expect(moved[3][0]).toBeLessThanOrEqual(0.2);
      }
    }
  });

  it("stay without stress where there is no strain", () => {
    expect(movePoint("stress_strain", line, 1, [0.05, 7], extent)).toEqual([line, 1]);
    expect(addPoint("stress_strain", [line[0], line[2]], [0, 3], extent)?.[0][1]).toEqual([0, 0]);
    expect(isAtRest("stress_strain", [9.13e-9, 3])).toBe(true);
    expect(isAtRest("stiffness", [0, 3])).toBe(false);
    const points = pointsOnProfile("stress_strain", [-0.1, 0, 0.1], [-1, 1.38778e-17, 2], 3);
    expect(points[1]).toEqual([0, 0]);
  });

  it("are added where there is room and removed while enough remain", () => {
    expect(addPoint("stress_strain", line, [0.05, 3], extent)).toEqual([[line[0], line[1], [0.05, 3], line[2], line[3]], 2]);
    expect(addPoint("stress_strain", line, [0.1, 3], extent)).toBeNull();
    expect(addPoint("stress_strain", line, [0.3, 3], extent)).toBeNull();
    expect(removePoint("stress_strain", line, 1)).toEqual([line[0], line[2], line[3]]);
    expect(removePoint("stress_strain", line.slice(0, 2), 1)).toHaveLength(2);
    expect(middleOfGapAfter("stress_strain", line, 1)).toBeCloseTo(0.05);
    expect(middleOfGapAfter("stress_strain", line, 3)).toBeCloseTo(0.15);
  });
});

describe("control points over directions", () => {
  it("pass each other and wrap around half a turn", () => {
    const [moved, at] = movePoint("stiffness", ring, 0, [1.5 + Math.PI, 9], HALF_TURN);
    expect(moved.map((p) => p[1])).toEqual([2, 9, 3]);
    expect(at).toBe(1);
    expect(moved[1][0]).toBeCloseTo(1.5);
    expect(wrapped(-0.1)).toBeCloseTo(Math.PI - 0.1);
  });

  it("do not fall onto each other, also across the seam", () => {
    const [moved] = movePoint("poisson", ring, 1, [2, 5], HALF_TURN);
    expect(moved.map((p) => p[0])).toEqual([0.1, 1, 2]);
    expect(addPoint("poisson", [[0.001, 1], [1, 1], [2, 1]], [Math.PI - 0.001, 1], HALF_TURN)).toBeNull();
    expect(removePoint("poisson", ring, 0)).toHaveLength(3);
  });
});

describe("a target taken from a profile", () => {
  it("lies on it, with both ends over strain", () => {
    const x = Array.from({ length: 31 }, (_, k) => k / 100);
    const points = pointsOnProfile("stress_strain", x, x.map((value) => 2 * value), 6);
    expect(points).toHaveLength(6);
    expect(points[0]).toEqual([0, 0]);
    expect(points[5]).toEqual([0.3, 0.6]);
  });

  it("becomes a curve that follows it, also beside a jump, where a smooth one swings", () => {
    const x = Array.from({ length: 60 }, (_, k) => (k * Math.PI) / 60);
    // A stiffness that is large in four sectors and small between them, as of pentagons whose beams are straightened by tension.
    const jumps = x.map((angle) => (Math.abs(Math.sin(2 * angle)) > 0.4 ? 0.05 + 0.08 * (1 - Math.abs(Math.sin(2 * angle))) : 0.05));
    const curve = targetOnProfile("stiffness", x, jumps, 6, "cubic");
    expect(curve?.interpolation).toBe("monotone");
    const deviation = (interpolation: Interpolation, points = curve?.points ?? []) => relativeDeviation(x.map(targetCurve(true, points, interpolation)), jumps, 0);
    expect(deviation("monotone")).toBeLessThan(0.015);
    expect(deviation("cubic", pointsOnProfile("stiffness", x, jumps, 6, "cubic"))).toBeGreaterThan(0.05);
    expect(targetOnProfile("stiffness", x, x.map((angle) => 1 + 0.1 * Math.cos(2 * angle)), 6, "cubic")?.interpolation).toBe("cubic");
    expect(targetOnProfile("stiffness", x, x.map(() => null), 6, "cubic")).toBeNull();
  });

  it("is followed by the curve through its points, by more of them where the profile turns often", () => {
    const x = Array.from({ length: 60 }, (_, k) => (k * Math.PI) / 60);
    const lobes = x.map((angle) => 0.2 + 0.5 * Math.cos(6 * angle));
    const points = pointsOnProfile("poisson", x, lobes, 6);
    expect(points.length).toBeGreaterThan(6);
    expect(relativeDeviation(lobes, x.map(targetCurve(true, points, "cubic")), 0.1)).toBeLessThan(0.01);
    expect(pointsOnProfile("poisson", x, x.map((angle) => 0.2 + 0.1 * Math.cos(2 * angle)), 6)).toHaveLength(6);
  });

  it("leaves out the end that repeats the start over directions, and what has no value", () => {
    const x = Array.from({ length: 61 }, (_, k) => (k * Math.PI) / 60);
    const points = pointsOnProfile("stiffness", x, x.map(() => 1), 6);
    expect(points.length).toBeGreaterThanOrEqual(5);
    expect(points[points.length - 1][0]).toBeLessThan(Math.PI);
    expect(pointsOnProfile("stress_strain", [0, 1, 2], [null, null, 1], 3)).toEqual([]);
  });
});

describe("another measure of strain", () => {
  it("keeps the target when it is changed there and back", () => {
    const there = convertedPoints(line, "engineering");
    expect(there[3][0]).toBeCloseTo(Math.sqrt(1.4) - 1, 12);
    expect(there[3][1]).toBeCloseTo(2 * Math.sqrt(1.4), 12);
    convertedPoints(there, "green").forEach(([x, y], k) => {
      expect(x).toBeCloseTo(line[k][0], 12);
      expect(y).toBeCloseTo(line[k][1], 12);
    });
  });
});
