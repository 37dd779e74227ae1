import { describe, expect, it } from "vitest";
import { DEFAULT_SPECIFICATION, type Specification } from "../src/design/specification";
import { targetCurve } from "../src/design/spline";
import { DEFAULT_STATE, type DesignState } from "../src/design/state";
import { changeOf, problemText, shortenedPoints, type WayOut } from "../src/design/ways_out";

const state: DesignState = {
  ...DEFAULT_STATE,
  points: [[-0.1, -1], [0, 0], [0.1, 1], [0.2, 1.2]],
  found: { family: "IH21", parameters: [0.12, 0.7] },
  fixed: [false, true],
};
const way = (more: Partial<WayOut>): WayOut => ({
  change: "turn",
  sentence: "Turn the tiling by 82 degrees: 3.5 % instead of 55 % by the model.",
  family: "IH21",
  parameters: [0.2, 0.7],
  orientation: 1.4312,
  youngs_modulus: 31.4159,
  range: null,
  deviation: 0.035,
  ...more,
});

describe("the change of a way out", () => {
  it("turns the structure, whose design is the next search's start", () => {
    const change = changeOf(way({}), state);
    expect(change).toMatchObject({ family: "IH21", found: { family: "IH21", parameters: [0.2, 0.7] }, fixed: [false, true], byHand: false });
    expect(change.made).toEqual({ ...DEFAULT_SPECIFICATION, orientation: 82 });
    expect(change).not.toHaveProperty("points");
  });

  it("changes the modulus, alone or with the orientation, of the material that the design has", () => {
    expect(changeOf(way({ change: "modulus" }), state).made).toEqual({ ...DEFAULT_SPECIFICATION, youngsModulus: 31.42 });
    expect(changeOf(way({ change: "turn_and_modulus" }), state).made).toEqual({ ...DEFAULT_SPECIFICATION, youngsModulus: 31.42, orientation: 82 });
    const made: Specification = { ...DEFAULT_SPECIFICATION, materials: [{ name: "TPU", youngsModulus: 26, density: 1.2 }, { name: "PLA", youngsModulus: 2500, density: 1.24 }] };
    const listed = changeOf(way({ change: "modulus" }), { ...state, made, found: { family: "IH21", parameters: [0.1, 0.7], material: "PLA" } });
    expect(listed.made?.materials).toEqual([{ name: "Material of 31.42 MPa", youngsModulus: 31.42, density: 1.24 }]);
    expect(listed.found).toMatchObject({ material: "Material of 31.42 MPa" });
    const turned = changeOf(way({}), { ...state, made, found: { family: "IH21", parameters: [0.1, 0.7], material: "PLA" } });
    expect([turned.made?.materials, turned.found?.material]).toEqual([made.materials, "PLA"]);
  });

  it("takes another family, whose parameters are free", () => {
    expect(changeOf(way({ change: "family", family: "IH67", parameters: [0.4] }), state)).toMatchObject({
      family: "IH67",
      found: { family: "IH67", parameters: [0.4] },
      fixed: [false],
    });
  });

  it("keeps values that the search chooses from a range", () => {
    const made: Specification = { ...DEFAULT_SPECIFICATION, youngsModulus: [10, 60] };
    expect(changeOf(way({}), { ...state, made }).found).toMatchObject({ youngsModulus: 31.4159 });
    expect(changeOf(way({ change: "modulus" }), { ...state, made }).found).not.toHaveProperty("youngsModulus");
  });

  it("shortens the target to points on its own curve", () => {
    const change = changeOf(way({ change: "shorten", range: [0, 0.15] }), state);
    expect(change.family).toBe(DEFAULT_STATE.family);
    const points = change.points ?? [];
    expect(points.map(([x]) => x)).toEqual([0, 0.1, 0.15]);
    expect(points[0]).toEqual([0, 0]);
    expect(points[2][1]).toBeCloseTo(targetCurve(false, state.points, "cubic")(0.15), 12);
  });
});

describe("an orientation of a way out", () => {
  it("is that of the same tiling in the range that the state allows", () => {
    const orientation = (range: readonly [number, number]) =>
      changeOf(way({ orientation: 2 }), { ...state, made: { ...DEFAULT_SPECIFICATION, orientation: range } }).made?.orientation;
    expect(orientation([-90, 90])).toBeCloseTo((2 * 180) / Math.PI - 180, 2);
    expect(orientation([0, 180])).toBeCloseTo((2 * 180) / Math.PI, 2);
    const change = changeOf(way({ change: "modulus", orientation: 2 }), { ...state, made: { ...DEFAULT_SPECIFICATION, orientation: [-90, 90] } });
    expect(change.found?.orientation).toBeCloseTo(2 - Math.PI, 12);
  });
});

describe("the problem of ways out", () => {
  const free: DesignState = { ...state, fixed: [false, false] };
  const made = (more: Partial<Specification>): DesignState => ({ ...free, made: { ...DEFAULT_SPECIFICATION, ...more } });

  it("has the limits of the structure, and its size if there are any", () => {
    const cell = { kind: "cell_size", value: 5 } as const;
    const limited = [made({}), made({ relativeDensity: [0, 0.4] }), made({ cellSizes: [1, 5] }), made({ size: cell, leastBeamWidth: 0.4 }),
      made({ size: { ...cell, value: 6 }, leastBeamWidth: 0.4 })];
    expect(new Set(limited.map(problemText)).size).toBe(limited.length);
    expect(problemText(made({ size: cell }))).toBe(problemText(made({})));
  });

  it("has the fixed parameters, but not those that the search chooses", () => {
    const at = (parameters: readonly number[]): DesignState => ({ ...state, found: { family: "IH21", parameters } });
    expect(problemText(at([0.3, 0.7]))).toBe(problemText(state));
    expect(problemText(at([0.12, 0.6]))).not.toBe(problemText(state));
    expect(problemText(free)).not.toBe(problemText(state));
  });
});

describe("a shortened target", () => {
  it("has no points that nearly coincide", () => {
    expect(shortenedPoints({ points: state.points, interpolation: "linear" }, [0, 0.10001]).map(([x]) => x)).toEqual([0, 0.10001]);
    expect(shortenedPoints({ points: state.points, interpolation: "linear" }, [-0.1, 0.1])).toEqual([[-0.1, -1], [0, 0], [0.1, 1]]);
  });
});
