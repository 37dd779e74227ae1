import { describe, expect, it } from "vitest";
import { quantile, vonMisesStresses } from "../src/design/patch_stress";

const rest = [[0, 0], [2, 0], [0, 1], [1, 0], [1, 0.5], [0, 0.5]];
const mesh = { points: rest as [number, number][], triangles: [[0, 1, 2, 3, 4, 5]] };
const solid = { youngsModulus: 26, poissonRatio: 0.48 };
const moved = (f: readonly number[]) => rest.map(([x, y]) => [f[0] * x + f[1] * y + 3, f[2] * x + f[3] * y - 1]);
const stress = (f: readonly number[]) => vonMisesStresses(mesh, moved(f), solid)[0];

describe("the stress in a patch", () => {
  it("is none at rest and after a rotation", () => {
    expect(stress([1, 0, 0, 1])).toBeCloseTo(0, 10);
    expect(stress([Math.cos(0.7), -Math.sin(0.7), Math.sin(0.7), Math.cos(0.7)])).toBeCloseTo(0, 10);
  });

  it("is that of Hooke’s law where strains are small", () => {
    const e = 1e-6;
    const mu = 26 / (2 * 1.48);
    expect(stress([1, e, e, 1]) / (Math.sqrt(3) * 2 * mu * e)).toBeCloseTo(1, 4);
    // In uniaxial strain the two other principal stresses are equal, and differ by 2 mu e from the first.
    expect(stress([1 + e, 0, 0, 1]) / (2 * mu * e)).toBeCloseTo(1, 4);
  });

  it("turns with the load", () => {
    expect(stress([1.1, 0, 0, 0.95])).toBeCloseTo(stress([0.95, 0, 0, 1.1]), 9);
  });

  it("is shown up to what nearly all triangles have", () => {
    expect(quantile([5, 1, 2, 3, 4], 0.5)).toBe(3);
    expect(quantile([], 0.5)).toBe(0);
  });
});
