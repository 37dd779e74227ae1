import { describe, expect, it } from "vitest";
import { isShareable, readLink, writeLink } from "../src/weave/link";
import { LayoutTextError, readLayoutText, writeLayoutText } from "../src/weave/layout_text";
import { lengthLimits, PATTERN_IDS, PATTERNS, withLength } from "../src/weave/patterns";
import { cellRequest, homogenizationRequest, previewRequest, weaveOf } from "../src/weave/requests";
import { DEFAULT_STATE, FIRST_LAYOUT, isPeriodic, usableStrain, type WeaveState } from "../src/weave/state";

const state: WeaveState = {
  ...DEFAULT_STATE,
  pattern: "interlacing_squares",
  type: 2,
  overrides: [{ crossing: 2, slides: [] }, { crossing: 5, slides: [0, 1], backward: 0.5, forward: null }],
  strain: 0.25,
  shear: "suppressed",
  space: "off",
  segments: 6,
  sheet: { columns: 4, rows: 7, load: "shear", amount: -0.3 },
};

describe("a link of a weave", () => {
  it.each(PATTERN_IDS)("brings %s back", (pattern) => {
    const one: WeaveState = { ...state, pattern, type: Math.max(1, PATTERNS[pattern].types.length) };
    expect(readLink(writeLink(one))).toEqual(one);
  });

  it("brings strands of one's own back, and says where they are too many", () => {
    const strands = [{ points: [[0, 0], [3.5, 1]] }, { points: [[1, 2]], ends: "periodic" as const, translation: [10, 0] }];
    const drawn: WeaveState = { ...state, pattern: "layout", type: 1, layout: { strands, lattice: [[10, 0], [1, 8]], sliding_share: 0.5 } };
    expect(readLink(writeLink(drawn))).toEqual(drawn);
    expect(isShareable(drawn)).toBe(true);
    expect(isShareable({ ...drawn, layout: { ...drawn.layout, strands: Array.from({ length: 2000 }, () => strands[0]) } })).toBe(false);
  });

  it.each(["", "pattern=knitting", "pattern=layout", "pattern=layout&layout=%E0%A4%A", "pattern=layout&layout={}", "pattern=regular&crossings=x",
    "pattern=regular&crossings=1:2:3"])(
      "that is none is refused: %s",
      (text) => expect(readLink(text)).toBeNull(),
    );

  it("gives limits and defaults for numbers out of range", () => {
    const read = readLink("pattern=interlacing_circles&type=9&circle_radius=8&distance=1&strain=0&sheet=1000,2,juggle,9");
    expect(read).toMatchObject({ type: 1, strain: 0.001, sheet: { columns: DEFAULT_STATE.sheet.columns, rows: 2, load: "stretch_x" } });
    const [lower, upper] = lengthLimits("distance", read?.lengths ?? DEFAULT_STATE.lengths);
    expect(read?.lengths.distance).toBeGreaterThanOrEqual(lower);
    expect(read?.lengths.distance).toBeLessThanOrEqual(upper);
  });
});

describe("lengths", () => {
  it("that are bound to each other keep their proportion", () => {
    const { lengths } = DEFAULT_STATE;
    expect(withLength(lengths, "side", 24)).toMatchObject({ side: 24, overlap: 6 });
    expect(withLength(lengths, "circle_radius", 11)).toMatchObject({ circle_radius: 11, distance: 20 });
    expect(withLength(lengths, "pitch", 5)).toEqual({ ...lengths, pitch: 5 });
  });
});

describe("a request", () => {
  it("has only the fields of its pattern", () => {
    expect(weaveOf({ ...DEFAULT_STATE, pattern: "regular", type: 4 })).toEqual({
      pattern: "regular",
      pitch: 4,
      radius: 0.25,
      material: { youngs_modulus: 3500 },
      connections: [["slides_x", "slides_y"], ["slides_y", "slides_x"]],
    });
    expect(weaveOf(state)).toMatchObject({ pattern: "interlacing_squares", type: 2, side: 12, overlap: 3, overrides: state.overrides });
    const layout = weaveOf({ ...DEFAULT_STATE, pattern: "layout" });
    expect(layout).toMatchObject({ strands: FIRST_LAYOUT.strands, lattice: [[10, 0], [0, 10]] });
    expect(layout).not.toHaveProperty("pattern");
  });

  it("asks for the deformed cell of one direction alone", () => {
    const whole = homogenizationRequest(state, [0.5]);
    expect(cellRequest(state, 0.5)).toEqual({ ...whole, effects: { ...whole.effects, error_estimate: "off" }, deformed: [0] });
    expect(homogenizationRequest({ ...state, accuracy: { level: "own", switches: {} } }, 24)).toMatchObject({
      strain: 0.25,
      directions: 24,
      shear: "suppressed",
      accuracy: { segments: 6 },
      effects: { out_of_plane: "off" },
    });
  });

  it("estimates no error of a preview, at any level", () => {
    for (const level of ["draft", "normal", "sure", "own"] as const) {
      const asked: WeaveState = { ...state, accuracy: { level, switches: { error_estimate: "on" } } };
      const { effects, ...preview } = previewRequest(asked, 24);
      const { effects: own, ...request } = homogenizationRequest(asked, 24);
      expect(preview).toEqual(request);
      expect(effects).toEqual({ ...own, error_estimate: "off" });
    }
  });

  it("has no strain of 0, and no profile where nothing repeats", () => {
    expect([usableStrain(0), usableStrain(-0.0001), usableStrain(0.2)]).toEqual([0.001, -0.001, 0.2]);
    expect(isPeriodic({ ...DEFAULT_STATE, pattern: "actuated_rings" })).toBe(false);
    expect(isPeriodic({ ...DEFAULT_STATE, pattern: "layout", layout: { strands: [], lattice: null } })).toBe(false);
  });
});

describe("a layout as text", () => {
  it("comes back as it was", () => {
    const layout = { ...FIRST_LAYOUT, sliding_share: 0.7 };
    expect(readLayoutText(writeLayoutText(layout)).layout).toEqual(layout);
  });

  it("may be a whole request, with material, radius and overrides", () => {
    const text = JSON.stringify({
      weave: { strands: [{ points: [[0, 0], [1, 1]] }], radius: 0.4, material: { youngs_modulus: 10 }, overrides: [{ crossing: 1, slides: [0] }] },
      strain: 0.1,
    });
    expect(readLayoutText(text)).toEqual({
      layout: { strands: [{ points: [[0, 0], [1, 1]] }], lattice: null },
      overrides: [{ crossing: 1, slides: [0] }],
      radius: 0.4,
      youngsModulus: 10,
    });
  });

  it.each([
    ["{", /no JSON/],
    ["[]", /must be an object/],
    ['{"pattern":"regular"}', /list of patterns/],
    ["{}", /strands is missing/],
    ['{"strands":[{"points":[[0,0],[1]]}]}', /strands\/0\/points\/1 must be a number/],
    ['{"strands":[{"points":[[0,0]],"ends":"frayed"}]}', /strands\/0\/ends/],
    ['{"strands":[],"lattice":[[1,0]]}', /two translations/],
    ['{"strands":[],"overrides":[{"slides":[]}]}', /overrides\/0\/crossing/],
  ])("with a fault is refused with the field: %s", (text, words) => {
    expect(() => readLayoutText(text)).toThrow(LayoutTextError);
    expect(() => readLayoutText(text)).toThrow(words);
  });
});
