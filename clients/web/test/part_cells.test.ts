import { describe, expect, it } from "vitest";
import { INITIAL_PART } from "../src/design/part";
import { cellsOf, cellWords } from "../src/design/part_cells";

const MEASURES = { beamWidth: 0.3, cellSize: 10 };

describe("the cells of a part", () => {
  it("are counted across and along, and a coupon with few of them is offered a better size", () => {
    const cells = cellsOf(INITIAL_PART, MEASURES);
    expect(cells).toEqual({ across: 3, along: 6, minAlong: 12, better: { width: 60, length: 120 } });
    expect(cells && cellWords(cells)).toBe("About 3 cells across: the edges count. 6 or more are better.");
    const enough = cellsOf({ ...INITIAL_PART, width: 60, length: 120 }, MEASURES);
    expect(enough?.better).toBeNull();
    expect(enough && cellWords(enough)).toBe("");
  });

  it("grow with the walls", () => {
    expect(cellsOf({ ...INITIAL_PART, beamWidth: 0.6 }, MEASURES)).toMatchObject({ across: 1.5, along: 3, better: { width: 120, length: 240 } });
  });

  it("are needed twice as many between grips as between plates", () => {
    const short = { ...INITIAL_PART, width: 60, length: 70 };
    const cells = cellsOf(short, MEASURES);
    expect(cells?.better).toEqual({ width: 60, length: 120 });
    expect(cells && cellWords(cells)).toBe("About 7 cells along: the edges count. 12 or more are better.");
    expect(cellsOf({ ...short, kind: "block" }, MEASURES)?.better).toBeNull();
    const block = cellsOf({ ...short, kind: "block", length: 20 }, MEASURES);
    expect(block && cellWords(block)).toBe("About 2 cells along: the edges count. 6 or more are better.");
  });

  it("are unknown for a drawing, and before a design has a size", () => {
    expect(cellsOf({ ...INITIAL_PART, kind: "drawing" }, MEASURES)).toBeNull();
    expect(cellsOf(INITIAL_PART, { beamWidth: null, cellSize: null })).toBeNull();
    expect(cellsOf(INITIAL_PART, null)).toBeNull();
  });
});
