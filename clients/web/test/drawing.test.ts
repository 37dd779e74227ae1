import { describe, expect, it } from "vitest";
import type { Outlines } from "../src/contract/types";
import { type Drawing, isDrawing, layoutOf, regionsIn, withRegionMoved } from "../src/design/drawing";
import { fillingsOf, materialsNote } from "../src/design/fillings";
import { DEFAULT_SPECIFICATION } from "../src/design/specification";
import { type Filling, INITIAL_PART, outlineRequest, partRequest, productOf } from "../src/design/part";
import { regionOf } from "../src/design/region_list";
import type { TargetResponse } from "../src/design/shown";
import { DEFAULT_STATE, type Region } from "../src/design/state";

const square = (side: number, x = 0, y = 0): [number, number][] => [[x, y], [x + side, y], [x + side, y + side], [x, y + side]];
const polygons = [{ names: ["heel", "regions"], points: square(3, 1, 1) }, { names: ["sole"], points: square(9) }, { names: [], points: square(4, 4, 4) }];
const sole: Drawing = { name: "sole.svg", text: "<svg/>", width: null, resolution: null, curves: { polygons } as unknown as Outlines };
const none = { regions: [] };

describe("the curves of a drawing", () => {
  it("bound the part, where no region lies in them", () => {
    expect(layoutOf(sole, ["Region 1"], none)).toEqual({ outline: [0, 1, 2], regions: ["rest"] });
    expect(layoutOf(sole, ["Region 1"], { ...none, outline: 1 })).toEqual({ outline: [1], regions: ["rest"] });
    expect(layoutOf(sole, ["Region 1"], { ...none, outline: 7 }).outline).toEqual([0, 1, 2]);
  });

  it("are no holes where they cross what bounds the part", () => {
    const crossed: Drawing = { ...sole, curves: { polygons: [...polygons, { names: ["forefoot"], points: square(5, 6, 6) }] } as unknown as Outlines };
    expect(layoutOf(crossed, ["Region 1"], none).outline).toEqual([0, 1, 2]);
    expect(layoutOf(crossed, ["Region 1"], { ...none, outline: "others" }).outline).toEqual([0, 1, 2, 3]);
    expect(layoutOf(crossed, ["Region 1", "Region 2"], { regions: ["rest", 1] }).outline).toEqual([3]);
  });

  it("have the regions of their names, and the others in their order", () => {
    expect(layoutOf(sole, ["Midfoot", " HEEL"], none)).toEqual({ outline: [1, 2], regions: ["rest", 0] });
    expect(layoutOf(sole, ["Region 1", "Region 2", "Region 3"], none)).toEqual({ outline: [1], regions: ["rest", 0, 2] });
    expect(layoutOf(sole, ["1", "2", "3", "4"], none).regions).toEqual(["rest", 0, 2, "nowhere"]);
  });

  it("have a region where somebody wants it, and never two", () => {
    const names = ["Toes", "Heel", "Arch"];
    const layout = layoutOf(sole, names, none);
    expect(layout.regions).toEqual(["rest", 0, 2]);
    const after = withRegionMoved(layout, none, 0, 0);
    expect(after.regions).toEqual([0, "rest", 2]);
    expect(layoutOf(sole, names, after)).toEqual({ outline: [1], regions: [0, "rest", 2] });
    expect(withRegionMoved(layout, none, 1, 2).regions).toEqual(["rest", 2, 0]);
    expect(withRegionMoved(layout, none, 2, "nowhere").regions).toEqual(["rest", 0, "nowhere"]);
    expect(withRegionMoved(layout, none, 0, "nowhere").regions).toEqual(["nowhere", "rest", 2]);
  });
});

describe("the regions of a drawing", () => {
  const drawing = (...curves: { names: string[]; points: [number, number][] }[]): Drawing => ({ ...sole, curves: { polygons: curves } as unknown as Outlines });

  it("have the names of its curves, and one is the rest of what is around them", () => {
    expect(regionsIn(sole)).toEqual(["heel", "Rest"]);
    const labelled = drawing({ names: ["path12", "Toes", "regions"], points: square(3, 5, 5) }, { names: ["sole"], points: square(9) }, {
      names: ["heel"],
      points: square(3, 1, 1),
    });
    expect(regionsIn(labelled)).toEqual(["Toes", "heel", "Rest"]);
  });

  it("have no rest where they cover the outline, or need no outline", () => {
    const halves = [{ names: ["left"], points: [[0, 0], [5, 0], [5, 9], [0, 9]] as [number, number][] }, {
      names: ["right"],
      points: [[5, 0], [9, 0], [9, 9], [5, 9]] as [number, number][],
    }];
    expect(regionsIn(drawing({ names: ["sole"], points: square(9) }, ...halves))).toEqual(["left", "right"]);
    expect(regionsIn(drawing(...halves))).toEqual(["left", "right"]);
  });

  it("have a rest where they leave some of the outline, also where they extend beyond it or overlap", () => {
    const band = (low: number, high: number): [number, number][] => [[-1, low], [10, low], [10, high], [-1, high]];
    const ends = [{ names: ["heel"], points: band(-3, 4) }, { names: ["toes"], points: band(5, 12) }];
    expect(regionsIn(drawing({ names: ["sole"], points: square(9) }, ...ends))).toEqual(["heel", "toes", "Rest"]);
    const twice = [{ names: ["left"], points: square(8, 0.5, 0.5) }, { names: ["right"], points: square(8, 0.7, 0.7) }];
    expect(regionsIn(drawing({ names: ["sole"], points: square(9) }, ...twice))).toEqual(["left", "right", "Rest"]);
  });

  it("are none where curves have no names of their own", () => {
    expect(regionsIn(drawing({ names: ["sole"], points: square(9) }, { names: ["circle4"], points: square(2, 2, 2) }))).toEqual([]);
    expect(regionsIn(drawing({ names: ["0"], points: square(9) }, { names: ["0"], points: square(2, 2, 2) }))).toEqual([]);
    expect(regionsIn(drawing({ names: ["sole"], points: square(9) }))).toEqual([]);
  });
});

describe("a file", () => {
  it("is a drawing by its name or by what it begins with", () => {
    expect(isDrawing("SOLE.DXF", "0\nSECTION")).toBe(true);
    expect(isDrawing("clipboard", '\n<?xml version="1.0"?><svg/>')).toBe(true);
    expect(isDrawing("tensile.csv", "0,0\n1,2")).toBe(false);
  });

  it("is asked about with a width where there is one", () => {
    expect(outlineRequest("<svg/>", null)).toEqual({ text: "<svg/>" });
    expect(outlineRequest("<svg/>", 80)).toEqual({ text: "<svg/>", width: 80 });
    expect(outlineRequest("<svg/>", null, 72)).toEqual({ text: "<svg/>", resolution: 72 });
  });
});

describe("a product", () => {
  const filling = (name: string, orientation = 0, direction: number | null = null): Filling => ({
    name,
    found: { family: `of ${name}`, parameters: [0.5] },
    orientation,
    direction,
    beamWidth: 0.4,
  });
  const layout = { outline: [1], regions: ["rest", 0, 2] as const };

  it("has a structure in each region", () => {
    const product = productOf(sole, layout, [filling("a"), filling("b", 0.3), filling("c")]);
    const request = partRequest({ family: "IH22", parameters: [] }, { ...INITIAL_PART, kind: "drawing", orientation: 90 }, product);
    expect(request).toMatchObject({
      outline: { polygons: [square(9)] },
      structure: { family: "of a", parameters: [0.5] },
      regions: [{ name: "b", outline: square(3, 1, 1), structure: { family: "of b" }, orientation: 0.3 }, { name: "c", outline: square(4, 4, 4) }],
    });
    expect(request).not.toHaveProperty("orientation");
  });

  it("is turned towards its axis region by region", () => {
    const product = productOf(sole, layout, [filling("a", 0, 0.1), filling("b", 0.3, 0.2), filling("c")]);
    const request = partRequest({ family: "IH22", parameters: [] }, { ...INITIAL_PART, kind: "drawing", axis: 90 }, product);
    expect(request.axis).toBeCloseTo(Math.PI / 2);
    expect(request.direction).toBe(0.1);
    expect(request.regions?.map((region) => region.direction)).toEqual([0.2, request.axis]);
    const plain = partRequest({ family: "IH22", parameters: [] }, { ...INITIAL_PART, kind: "drawing" }, product);
    expect(plain).not.toHaveProperty("direction");
    expect(plain.regions?.[0]).not.toHaveProperty("direction");
  });

  it("is the union of its regions where no curve is around them", () => {
    const bands = { ...sole, curves: { polygons: [{ names: ["heel"], points: square(4) }, { names: ["toes"], points: square(4, 4) }] } as unknown as Outlines };
    const whole = layoutOf(bands, ["heel", "toes"], none);
    expect(whole).toEqual({ outline: [], regions: [0, 1] });
    const request = partRequest({ family: "IH22", parameters: [] }, { ...INITIAL_PART, kind: "drawing" }, productOf(bands, whole, [filling("heel"), filling("toes")]));
    expect(request.outline).toEqual({ regions: true });
    expect(request.regions?.map((region) => region.name)).toEqual(["heel", "toes"]);
    expect(layoutOf(sole, ["Rest", "Heel"], { ...none, outline: "regions" }).outline).toEqual([]);
  });

  it("is made without the regions that have no design", () => {
    expect(productOf(sole, layout, [null, filling("b"), null])).toMatchObject({ rest: { name: "b" }, regions: [{ filling: { name: "b" } }] });
    expect(productOf(sole, layout, [null, null, null])).toBeNull();
  });

  it("has walls as its designs were asked for, or as somebody chose them", () => {
    const plain: Region = { ...regionOf(DEFAULT_STATE), found: { family: "IH22", parameters: [0.5] } };
    const wide: Region = { ...plain, region: "Heel", made: { ...DEFAULT_SPECIFICATION, size: { kind: "beam_width", value: 0.8 }, orientation: 180 } };
    const cells: Region = { ...plain, made: { ...DEFAULT_SPECIFICATION, size: { kind: "cell_size", value: 5 } } };
    const shown = [null, null, [{ measures: { beamWidth: 0.61234567 } } as TargetResponse], null];
    const all = fillingsOf([plain, wide, cells, { ...plain, found: null }], shown, [undefined, undefined, undefined, 3]);
    expect(all.map((one) => one?.beamWidth)).toEqual([0.3, 0.8, 0.6123, undefined]);
    expect(all[1]).toMatchObject({ name: "Heel", orientation: Math.PI });
    expect(fillingsOf([plain], [null], [1.5])[0]?.beamWidth).toBe(1.5);
  });

  it("is of one material, which is told where its designs are not", () => {
    const soft: Region = { ...regionOf(DEFAULT_STATE), found: { family: "IH22", parameters: [0.5] } };
    const hard: Region = { ...soft, made: { ...DEFAULT_SPECIFICATION, youngsModulus: 2500 } };
    expect(materialsNote([soft, soft])).toBe("");
    expect(materialsNote([soft, { ...hard, found: null }])).toBe("");
    expect(materialsNote([soft, hard])).toMatch(/different materials \(26, 2500 MPa\)/);
  });
});
