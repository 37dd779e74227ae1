import { describe, expect, it } from "vitest";
import type { WeaveHomogenization, WeaveLayout } from "../src/contract/types";
import { polarPath } from "../src/base/polar";
import { latticeCoordinates } from "../src/base/plane";
import { carriedOverrides } from "../src/weave/carried";
import { clickWords, connectionWords, crossingWords, nextConnection, withConnection } from "../src/weave/connections";
import { blockOf, directionAt, periodicDistance } from "../src/weave/geometry";
import { isLattice, roundedToGrid, strandOf, withLattice } from "../src/weave/layout_edit";
import { csvOf, gapWords, nearestDirection, profileOf } from "../src/weave/profile";
import { sheetOverrides, sheetSupports, sheetWeave, tiledStrands } from "../src/weave/sheet";
import { centroid, restLines, startingAt } from "../src/weave/rest_lines";
import { DEFAULT_STATE, type Lattice } from "../src/weave/state";
import { tubes } from "../src/weave/tubes";

const SKEW: Lattice = [[10, 0], [2, 8]];

type Member = Partial<WeaveLayout["crossings"][number]["members"][number]> & { strand: number; coordinate: number };
const crossing = (x: number, y: number, ...members: Member[]) => ({ position: [x, y], members: members.map((member) => ({ shift: [0, 0], slides: false, ...member })) });
const straight = (from: number[], to: number[], ends: "open" | "periodic" = "open") => ({
  ends,
  translation: [0, 0],
  length: Math.hypot(to[0] - from[0], to[1] - from[1]),
  radius: 0.25,
  polyline: [from, to],
});
const layoutOf = (strands: ReturnType<typeof straight>[], crossings: ReturnType<typeof crossing>[], lattice: number[][] | null) =>
  ({ strands, crossings, lattice, material: {}, warnings: [], effects: [], cost: { seconds: 0 } }) as unknown as WeaveLayout;

describe("the words beside the crossings", () => {
  it("say what a click does to a sheet where the weave is a cell of one", () => {
    expect(clickWords({ lattice: [[4, 0], [0, 4]] })).toMatch(/^Click a crossing to change it, here and in every cell of a sheet\. .*stay as they are\.$/);
    expect(clickWords({ lattice: null })).toBe("Click a crossing to change it.");
  });
});

describe("the connection of a crossing", () => {
  it("goes from fused over each strand that slides back to fused", () => {
    const members = [{ strand: 3, coordinate: 0 }, { strand: 5, coordinate: 0 }];
    const slides = (...which: number[]) => crossing(0, 0, ...members.map((member, k) => ({ ...member, slides: which.includes(k) })));
    expect([slides(), slides(0), slides(1), slides(0, 1)].map(nextConnection)).toEqual([[0], [1], [], []]);
    expect([slides(), slides(1), slides(0, 1)].map(connectionWords)).toEqual(["fused", "strand 6 slides", "strands 4 and 6 slide"]);
    expect(crossingWords(slides(0), 6)).toBe("Crossing 7 of strands 4 and 6: strand 4 slides");
  });

  it("is one override for each crossing, by rising number", () => {
    const once = withConnection([{ crossing: 4, slides: [1] }], 2, [0]);
    expect(once).toEqual([{ crossing: 2, slides: [0] }, { crossing: 4, slides: [1] }]);
    expect(withConnection(once, 4, [])).toEqual([{ crossing: 2, slides: [0] }, { crossing: 4, slides: [] }]);
  });

  it("stays where it is when strands before it are taken away", () => {
    const [a, b, c] = [{ points: [[0, 1], [9, 1]] }, { points: [[0, 2], [9, 2]] }, { points: [[4, 0], [4, 9]] }];
    const state = (...strands: typeof a[]) => ({ ...DEFAULT_STATE, pattern: "layout" as const, layout: { strands, lattice: null } });
    const before = {
      state: state(a, b, c),
      layout: layoutOf([], [crossing(4, 1, { strand: 0, coordinate: 4 }, { strand: 2, coordinate: 1 }),
        crossing(4, 2, { strand: 1, coordinate: 4 }, { strand: 2, coordinate: 2, slides: true })], null),
    };
    const now = { state: state(c, b), layout: layoutOf([], [crossing(4, 2, { strand: 0, coordinate: 2 }, { strand: 1, coordinate: 4 })], null) };
    expect(carriedOverrides(before, now)).toEqual([{ crossing: 0, slides: [0] }]);
  });
});

describe("a lattice", () => {
  it("measures distances between places that repeat", () => {
    expect(periodicDistance(SKEW, [0.5, 0], [12.5, 8])).toBeCloseTo(0, 12);
    expect(periodicDistance(null, [0, 0], [3, 4])).toBe(5);
    latticeCoordinates(SKEW, [12, 8]).forEach((value) => expect(value).toBeCloseTo(1, 12));
    expect(blockOf(3)).toHaveLength(9);
    expect([isLattice(SKEW), isLattice([SKEW[1], SKEW[0]]), isLattice([[1, 1], [2, 2]])]).toEqual([true, false, false]);
  });
});

describe("a drawn strand", () => {
  it("needs points enough for its ends, and leaves out what repeats the first", () => {
    expect(strandOf([[0, 0]], "open", null)).toBeNull();
    expect(strandOf([[0, 0], [1, 0], [1, 1], [0, 0]], "closed", null)).toEqual({ points: [[0, 0], [1, 0], [1, 1]], ends: "closed" });
    expect(strandOf([[0, 1], [5, 2], [10, 1]], "along_a", SKEW)).toEqual({ points: [[0, 1], [5, 2]], ends: "periodic", translation: [10, 0] });
    expect(strandOf([[0, 1]], "along_b", null)).toBeNull();
    expect(roundedToGrid([0.26, -1.2])).toEqual([0.5, -1]);
  });

  it("goes on along the same translations of another lattice, and ends where there is none", () => {
    const layout = { strands: [{ points: [[0, 1]], ends: "periodic" as const, translation: [2, 8] }], lattice: SKEW };
    expect(withLattice(layout, [[6, 0], [0, 5]]).strands[0].translation).toEqual([0, 5]);
    expect(withLattice(layout, null)).toEqual({ strands: [{ points: [[0, 1], [2, 9]] }], lattice: null });
  });
});

describe("a sheet", () => {
  it("has copies of strands, and periodic ones in one piece", () => {
    const layout = { strands: [{ points: [[1, 1], [2, 2]] }, { points: [[0, 4], [5, 5]], ends: "periodic" as const, translation: [10, 0] }], lattice: SKEW };
    const strands = tiledStrands(layout, { columns: 3, rows: 2 });
    expect(strands).toHaveLength(6 + 2);
    expect(strands[1].points[0]).toEqual([11, 1]);
    expect(strands[6]).toEqual({ points: [[0, 4], [5, 5], [10, 4], [15, 5], [20, 4], [25, 5], [30, 4]] });
    expect(strands[7].points[0]).toEqual([2, 12]);
  });

  it("of a periodic weave is a pattern's, of two strands for each cell of the regular one", () => {
    expect(sheetWeave({ ...DEFAULT_STATE, pattern: "regular", overrides: [{ crossing: 0, slides: [0] }] })).toMatchObject({ sheet: { columns: 6, rows: 6 } });
    expect(sheetWeave({ ...DEFAULT_STATE, overrides: [{ crossing: 0, slides: [0] }] })).not.toHaveProperty("overrides");
    expect(sheetWeave({ ...DEFAULT_STATE, pattern: "actuated_rings" })).not.toHaveProperty("sheet");
  });

  it("is connected as the cell is, whichever of a crossing's strands comes first", () => {
    const cell = layoutOf([straight([0, 5], [10, 5], "periodic"), straight([5, 0], [5, 10], "periodic")], [
      crossing(5, 5, { strand: 0, coordinate: 5, slides: true }, { strand: 1, coordinate: 5 }),
    ], [[10, 0], [0, 10]]);
    const sheet = layoutOf([straight([0, 5], [20, 5]), straight([5, 0], [5, 10]), straight([15, 0], [15, 10])], [
      crossing(5, 5, { strand: 1, coordinate: 5 }, { strand: 0, coordinate: 5 }),
      crossing(15, 5, { strand: 0, coordinate: 15, slides: true }, { strand: 2, coordinate: 5 }),
      crossing(9, 9, { strand: 0, coordinate: 9 }, { strand: 1, coordinate: 9 }),
    ], null);
    expect(sheetOverrides(cell, sheet)).toEqual({ overrides: [{ crossing: 0, slides: [1] }], unknown: 1 });
  });

  it("is held at one border and moved at the other", () => {
    const layout = layoutOf([straight([0, 2], [20, 2]), straight([2, 0], [2, 8])], [crossing(2, 2, { strand: 0, coordinate: 2 }, { strand: 1, coordinate: 2 })], null);
    const sheet = { ...DEFAULT_STATE.sheet, amount: 0.5 };
    const [fixedBorder, movedBorder] = sheetSupports({ ...sheet, load: "stretch_x" }, layout);
    expect(fixedBorder.displacement).toBeUndefined();
    expect(movedBorder).toMatchObject({ displacement: [10, 0, 0], at: { box: [[19.9, -0.1], [20.1, 8.1]] } });
    expect(sheetSupports({ ...sheet, load: "shear" }, layout)[1].displacement).toEqual([4, 0, 0]);
    expect(sheetSupports({ ...sheet, load: "push" }, layout)[1].at).toEqual({ strand: 1, share: 1 });
  });
});

describe("a profile", () => {
  const answer = {
    strain: 0.1,
    directions: [0, 1, 2],
    youngs_modulus: [5, null, null],
    poisson_ratio: [0.1, null, null],
    stopped: ["converged", "iteration_limit", "folded_flat"],
    deformation_gradient: [[[1.1, 0], [0, 1]], [[1, 0], [0, 1]], [[1.5, 0], [0, 0]]],
    out_of_plane: [false, false, false],
    stable: [true, true, false],
    cost: { seconds: 1 },
    limit_error: [0.2, 0, 0],
    accuracy: { limit_tolerance: 1e-6, limit_error: 0.2 },
  } as unknown as WeaveHomogenization;
  const profile = profileOf(answer, "key", false);

  it("has gaps with their reasons, also where the cell has no area left", () => {
    expect(profile.youngs).toEqual([5, null, null]);
    expect(profile.reasons.map((reason) => reason === null)).toEqual([true, false, false]);
    expect(gapWords(profile)[0]).toBe("No value at 57.3°: the smallest load step did not converge.");
    expect(gapWords(profile)[1]).toMatch(/^No value at 115°: the cell folds flat/);
    expect(profile.unstable).toBe(0);
    expect([profile.shortOfLimits, profile.limitError]).toEqual([1, 0.2]);
    expect(csvOf(profile).trim().split("\n")[2]).toBe('1,,,"the smallest load step did not converge"');
  });

  it("finds the nearest direction around the half turn", () => {
    expect([nearestDirection(profile, 0.9), nearestDirection(profile, 3.1)]).toEqual([1, 0]);
  });

  it("is one closed line without gaps, and not cut where its samples begin", () => {
    const x = [0, 1, 2];
    const path = (y: (number | null)[]) => polarPath({ x, y }, (value) => value);
    expect(path([1, 1, 1]).match(/M/g)).toHaveLength(1);
    expect(path([1, 1, 1])).toContain("Z");
    expect(path([1, null, 1]).match(/M/g)).toHaveLength(2);
    expect(path([null, null, null])).toBe("");
  });
});

describe("a polyline", () => {
  it("has a direction that is the same both ways along it", () => {
    const line = [[0, 0], [4, 0], [4, 4]];
    expect(directionAt(line, 1)).toBe(0);
    expect(directionAt(line, 6)).toBeCloseTo(Math.PI / 2, 12);
    expect(directionAt([...line].reverse(), 6)).toBeCloseTo(0, 12);
  });
});

describe("a strand at rest", () => {
  it("begins where the deformed one does: at its first crossing, in that crossing's place", () => {
    expect(startingAt([[0, 0], [4, 0], [10, 0]], 6, [10, 0])).toEqual([[6, 0], [10, 0], [14, 0], [16, 0]]);
    const layout = layoutOf([straight([0, 5], [10, 5], "periodic"), straight([0, 0], [4, 4])], [crossing(13, 15, { strand: 0, coordinate: 3 }, { strand: 1, coordinate: 2 })], [[10,
      0], [0, 10]]);
    (layout.strands[0] as { translation: number[] }).translation = [10, 0];
    expect(restLines(layout)).toEqual([[[13, 15], [20, 15], [23, 15]], [[0, 0], [4, 4]]]);
    expect(centroid([[[0, 0], [2, 0]], [[2, 0], [2, 2]]])).toEqual([1.5, 0.5]);
  });
});

describe("a tube", () => {
  it("lies around its strand at its radius, also where points repeat", () => {
    const { positions, normals, triangles } = tubes([[[0, 0, 0], [0, 0, 0], [2, 0, 0], [2, 2, 0]]], [0.5], 6);
    expect(positions).toHaveLength(3 * 6 * 3);
    expect(triangles).toHaveLength(6 * 6 * 2);
    for (let k = 0; k < 6; ++k) {
      expect(positions[3 * k]).toBeCloseTo(0, 6);
      expect(Math.hypot(positions[3 * k + 1], positions[3 * k + 2])).toBeCloseTo(0.5, 6);
      expect(Math.hypot(normals[3 * k], normals[3 * k + 1], normals[3 * k + 2])).toBeCloseTo(1, 6);
    }
    expect(Math.max(...triangles)).toBeLessThan(18);
  });
});
