import { describe, expect, it } from "vitest";
import type { Outlines } from "../src/contract/types";
import type { Drawing } from "../src/design/drawing";
import { INITIAL_PART, type PartSettings } from "../src/design/part";
import { axisArrow, loadWords } from "../src/design/part_load";
import { pathOf, sizeWords, sketchOf } from "../src/design/part_sketch";

const SQUARE: [number, number][] = [[0, 0], [9, 0], [9, 9], [0, 9]];
const HEEL: [number, number][] = [[1, 1], [4, 1], [4, 4], [1, 4]];
const sole: Drawing = {
  name: "sole.svg",
  text: "<svg/>",
  width: null,
  resolution: null,
  curves: { polygons: [{ names: ["heel"], points: HEEL }, { names: ["sole"], points: SQUARE }] } as unknown as Outlines,
};

/** What the card says about the size of a part; null without a sketch. */
function wordsOf(settings: PartSettings): string | null {
  const sketch = sketchOf(settings, null, null, []);
  return sketch && sizeWords(settings, sketch);
}

describe("the sketch of a part", () => {
  it("has solid ends beyond the length of the structure, whose outer size is told", () => {
    const coupon = sketchOf(INITIAL_PART, null, null, []);
    expect(coupon).toMatchObject({ lower: [0, 0], upper: [30, 90], axis: Math.PI / 2 });
    expect(coupon?.ends).toEqual([[[0, 0], [30, 0], [30, 15], [0, 15]], [[0, 75], [30, 75], [30, 90], [0, 90]]]);
    expect(wordsOf(INITIAL_PART)).toBe("Outer size with both grips: 30 × 90 × 1 mm");
    const block = { ...INITIAL_PART, kind: "block" } as const;
    expect(wordsOf(block)).toBe("Outer size with both plates: 30 × 62 × 1 mm");
    const sheet = { ...INITIAL_PART, kind: "rectangle" } as const;
    expect(sketchOf(sheet, null, null, [])).toMatchObject({ ends: [], axis: null, upper: [30, 60] });
    expect(wordsOf(sheet)).toBe("Outer size: 30 × 60 × 1 mm");
  });

  it("has the outline and the regions of a drawing, and the axis that somebody gave", () => {
    const settings = { ...INITIAL_PART, kind: "drawing", axis: 90 } as const;
    expect(sketchOf(settings, null, null, [])).toBeNull();
    const sketch = sketchOf(settings, sole, { outline: [1], regions: ["rest", 0] }, ["Arch", "Heel"]);
    expect(sketch).toMatchObject({ outline: [SQUARE], regions: [{ name: "Heel", points: HEEL }], axis: Math.PI / 2, upper: [9, 9] });
    expect(sketchOf(settings, sole, { outline: [], regions: [0] }, ["Heel"])).toMatchObject({ lower: [1, 1], upper: [4, 4] });
  });

  it("is drawn around its middle, with y upwards", () => {
    expect(pathOf([[[0, 0], [2, 0], [2, 4]]], [1, 2])).toBe("M-1 2L1 2L1 -2Z");
    expect(axisArrow([0, 0], Math.PI / 2, 8)).toMatch(/^M0 4L0 -4M/);
  });
});

describe("the load of a part", () => {
  it("says by how much the structure is turned, as an axis is", () => {
    expect(loadWords(0, Math.PI / 2)).toBe("Turned by 90 degrees so that the design’s load runs along the part: it is loaded as it was designed.");
    expect(loadWords(2.5, Math.PI / 2)).toMatch(/^Turned by −53\.2 degrees/);
    expect(loadWords(Math.PI / 2, Math.PI / 2)).toMatch(/^Not turned: the design’s load runs along/);
    expect(loadWords(-Math.PI / 2, Math.PI / 2)).toMatch(/^Not turned: the design’s load/);
    expect(loadWords(null, Math.PI / 2)).toMatch(/no single direction/);
    expect(loadWords(0, null)).toBe("");
  });
});
