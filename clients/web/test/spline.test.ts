import { describe, expect, it } from "vitest";
import { openCurve, periodicCurve, relativeDeviation, spaced } from "../src/design/spline";
import type { ControlPoint } from "../src/design/state";

const points: ControlPoint[] = [[-0.1, -0.2], [0, 0], [0.05, 0.3], [0.2, 0.25]];

function secondDerivative(curve: (x: number) => number, x: number, h = 1e-4): number {
  return (curve(x + h) - 2 * curve(x) + curve(x - h)) / (h * h);
}

describe("a curve through control points", () => {
  it.each(["cubic", "monotone", "linear"] as const)("passes all of them (%s)", (interpolation) => {
    const curve = openCurve(points, interpolation);
    for (const [x, y] of points) expect(curve(x)).toBeCloseTo(y, 12);
    const around = periodicCurve(points, interpolation);
    for (const [x, y] of points) {
      expect(around(x)).toBeCloseTo(y, 9);
      expect(around(x + 3 * Math.PI)).toBeCloseTo(y, 9);
    }
  });

  it("gives straight lines where the points lie on one", () => {
    const line: ControlPoint[] = [[0, 1], [0.3, 1.6], [1, 3]];
    for (const interpolation of ["cubic", "monotone", "linear"] as const) {
      for (const x of spaced(-0.5, 1.5, 17)) expect(openCurve(line, interpolation)(x)).toBeCloseTo(1 + 2 * x, 12);
    }
  });

  it("is twice continuously differentiable where it is cubic, with natural ends", () => {
    const curve = openCurve(points, "cubic");
    for (const [x] of points.slice(1, -1)) {
      expect(secondDerivative(curve, x - 3e-4)).toBeCloseTo(secondDerivative(curve, x + 3e-4), -0.7);
    }
    expect(Math.abs(secondDerivative(curve, points[0][0] + 1e-4))).toBeLessThan(1);
  });

  it("joins itself smoothly around half a turn", () => {
    const curve = periodicCurve([[0.2, 1], [1, 3], [2, 2], [2.9, 1.5]], "cubic");
    const slope = (x: number) => (curve(x + 1e-5) - curve(x - 1e-5)) / 2e-5;
    expect(slope(0.2 - 2e-5)).toBeCloseTo(slope(0.2 + 2e-5), 2);
    expect(slope(0.2 + Math.PI)).toBeCloseTo(slope(0.2), 5);
  });

  it("never leaves the range of its neighbours where it is monotone", () => {
    const curve = openCurve([[0, 0], [1, 0], [1.1, 5], [3, 5.1]], "monotone");
    for (const x of spaced(0, 3, 301)) {
      expect(curve(x)).toBeGreaterThanOrEqual(0);
      expect(curve(x)).toBeLessThanOrEqual(5.1);
    }
  });
});

describe("the deviation from a target", () => {
  it("is relative to the target and skips what is unknown", () => {
    expect(relativeDeviation([1.1, null, 2.2], [1, 7, 2])).toBeCloseTo(0.1, 12);
    expect(relativeDeviation([null], [1])).toBe(Infinity);
  });
});
