import { describe, expect, it } from "vitest";
import { smoothed } from "../src/weave/geometry";
import { arrayed, scaledLayout, withDuplicate } from "../src/weave/layout_edit";
import { FIRST_LAYOUT, type FreeLayout } from "../src/weave/state";

const SHEET: FreeLayout = { strands: [{ points: [[0, 0], [4, 2]] }], lattice: null };

describe("strands of one's own", () => {
  it("are scaled with their lattice", () => {
    const { strands, lattice } = scaledLayout(FIRST_LAYOUT, 2);
    expect(lattice).toEqual([[20, 0], [0, 20]]);
    expect(strands[1]).toEqual({ points: [[10, 0], [7, 5], [13, 15]], ends: "periodic", translation: [0, 20] });
  });

  it("are duplicated beside themselves", () => {
    expect(withDuplicate(SHEET, 0, [1, -1]).strands).toEqual([{ points: [[0, 0], [4, 2]] }, { points: [[1, -1], [5, 1]] }]);
    expect(withDuplicate(SHEET, 5, [1, 1])).toBe(SHEET);
  });

  it("are repeated in a sheet at the distances that are given", () => {
    const repeated = arrayed(SHEET, 2, 2, [10, 5]);
    expect(repeated?.lattice).toBeNull();
    expect(repeated?.strands.map(({ points }) => points[0])).toEqual([[0, 0], [10, 0], [0, 5], [10, 5]]);
  });

  it("are repeated in a cell so that the weave stays the same", () => {
    const repeated = arrayed(FIRST_LAYOUT, 2, 3, [1, 1]);
    expect(repeated?.lattice).toEqual([[20, 0], [0, 30]]);
    // Three strands along x, one for each row, over both columns; and two along y over three rows.
    expect(repeated?.strands.map(({ translation }) => translation)).toEqual([[20, 0], [20, 0], [20, 0], [0, 30], [0, 30]]);
    expect(repeated?.strands.map(({ points }) => points.length)).toEqual([6, 6, 6, 9, 9]);
    expect(repeated?.strands[1].points).toEqual([[0, 15], [2.5, 16.5], [7.5, 13.5], [10, 15], [12.5, 16.5], [17.5, 13.5]]);
  });

  it("are refused beyond the limit", () => {
    expect(arrayed({ ...SHEET, strands: Array.from({ length: 20 }, () => SHEET.strands[0]) }, 12, 12, [1, 1])).toBeNull();
  });
});

describe("a smooth curve through the nodes of a strand", () => {
  const arc = Array.from({ length: 9 }, (_, k) => [Math.cos((k * Math.PI) / 8), Math.sin((k * Math.PI) / 8)]);

  it("passes through all of them and is close to the circle on which they lie", () => {
    const curve = smoothed(arc);
    for (const point of arc) expect(curve.some(([x, y]) => Math.hypot(x - point[0], y - point[1]) < 1e-12)).toBe(true);
    for (const [x, y] of curve) expect(Math.abs(Math.hypot(x, y) - 1)).toBeLessThan(3e-3);
    expect(curve).toHaveLength(8 * 5 + 1);
  });

  it("goes on at the ends of a loop as it began", () => {
    const loop = Array.from({ length: 13 }, (_, k) => [Math.cos((k * Math.PI) / 6), Math.sin((k * Math.PI) / 6)]);
    for (const [x, y] of smoothed(loop, true)) expect(Math.abs(Math.hypot(x, y) - 1)).toBeLessThan(2e-3);
  });

  it("leaves straight lines straight, in space too, and short ones as they are", () => {
    for (const [x, y, z] of smoothed([[0, 0, 0], [1, 2, 3], [2, 4, 6]])) expect([y, z]).toEqual([expect.closeTo(2 * x), expect.closeTo(3 * x)]);
    expect(smoothed([[0, 0], [1, 1]])).toEqual([[0, 0], [1, 1]]);
    expect(smoothed([[0, 0], [0, 0], [1, 1]])).toEqual([[0, 0], [1, 1]]);
  });
});
