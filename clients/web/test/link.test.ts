import { describe, expect, it } from "vitest";
import { readLink, writeLink } from "../src/design/link";
import { DEFAULT_STATE, type DesignState } from "../src/design/state";

const state: DesignState = {
  ...DEFAULT_STATE,
  points: [[-0.1, -0.25], [0, 0], [0.2, 1.125]],
  direction: 0.5,
  family: "IH21",
  found: { family: "IH21", parameters: [0.125, 0.7] },
  fixed: [true, false],
  byHand: true,
};

describe("a link", () => {
  it("brings a state back", () => {
    expect(readLink(writeLink(state))).toEqual(state);
    const polar: DesignState = { ...state, task: "poisson", points: [[0, 0.1], [1, -0.3], [2, 0.4]], direction: 0, strain: 0.03 };
    expect(readLink(writeLink(polar))).toEqual(polar);
    const bare: DesignState = { ...state, found: null, fixed: [], byHand: false, interpolation: "linear", measure: "engineering" };
    expect(readLink(writeLink(bare))).toEqual(bare);
  });

  it("brings the accuracy back, which is that of the page and not of a region", () => {
    const accuracy = { level: "sure", switches: { trust: "off" } } as const;
    expect(readLink(writeLink({ ...state, accuracy }))).toEqual({ ...state, accuracy });
    const { accuracy: _, otherRegions: __, regionAt: ___, ...region } = state;
    const regions: DesignState = { ...state, accuracy, otherRegions: [{ ...region, region: "Heel" }] };
    expect(readLink(writeLink(regions))).toEqual(regions);
    expect(writeLink(regions).match(/accuracy/g)).toHaveLength(1);
  });

  it.each([
    "",
    "task=juggling",
    "task=stress_strain&points=0,0",
    "task=stress_strain&points=0,0;0,1",
    "task=stress_strain&points=0,0;x,1",
    "task=stress_strain&points=0,0;1,NaN",
    "task=stress_strain&points=0,0;1,1e9",
    "task=stiffness&points=0,1;1,1;3.2,1",
    "task=stress_strain&points=0,0;1,1&family=%3Cscript%3E",
    "task=stress_strain&points=0,0;1,1&design=IH21&parameters=",
    `task=stress_strain&points=${Array.from({ length: 65 }, (_, k) => `${k},0`).join(";")}`,
    "task=%E0%A4%A&points=0,0;1,1",
  ])("that is none is refused: %s", (text) => {
    expect(readLink(text)).toBeNull();
  });

  it("gives defaults for numbers out of range", () => {
    const read = readLink("task=stiffness&points=0,1;1,1;2,1&strain=99&measure=furlongs");
    expect(read).toMatchObject({ strain: DEFAULT_STATE.strain, measure: "green" });
  });
});
