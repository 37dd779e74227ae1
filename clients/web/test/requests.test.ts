import { describe, expect, it } from "vitest";
import { designRequest, patchRequest, profileRequest, structurePath, verificationRequest } from "../src/design/requests";
import { DEFAULT_STATE, type DesignState } from "../src/design/state";
import { copiesOf } from "../src/design/tiling_preview";

const found = { family: "IH21", parameters: [0.12, 0.7] };
const state: DesignState = { ...DEFAULT_STATE, points: [[-0.1, -1], [0, 0], [0.2, 2]], found, fixed: [false, false], direction: 0.3 };

describe("a search", () => {
  it("looks in all families, and in the one at hand while a pointer is followed", () => {
    expect(designRequest(state, "search", "s")).toMatchObject({ family: "any", session: "s", direction: 0.3 });
    expect(designRequest(state, "search", "s").initial).toBeUndefined();
    const follow = designRequest(state, "follow", "s");
    expect(follow).toMatchObject({ family: "IH21", initial: [0.12, 0.7], effects: { multi_start: "off", envelope: "off" } });
  });

  it("has the chosen accuracy and effects where it is thorough, and is quick while a pointer is followed", () => {
    const sure = { level: "sure", switches: { trust: "off" } } as const;
    expect(designRequest(state, "search", "s", sure).effects).toEqual({ multi_start: "automatic", envelope: "on", polish: "on", trust: "off" });
    expect(designRequest(state, "follow", "s", sure)).toEqual(designRequest(state, "follow", "s"));
    expect(designRequest(state, "search", "s", { level: "draft", switches: {} })).toMatchObject({ accuracy: { starts: 1 }, effects: { envelope: "off" } });
    expect(patchRequest({ ...state, accuracy: sure }, found)).not.toHaveProperty("effects");
  });

  it("starts from the design at hand only in its own family", () => {
    expect(designRequest({ ...state, family: "IH29" }, "search", "s").initial).toBeUndefined();
    expect(designRequest({ ...state, family: "IH21" }, "search", "s").initial).toEqual([0.12, 0.7]);
    expect(designRequest({ ...state, family: "IH29" }, "follow", "s").effects?.multi_start).toBe("automatic");
  });

  it("keeps what is fixed, within the family that it was fixed in", () => {
    const request = designRequest({ ...state, fixed: [false, true] }, "search", "s");
    expect(request).toMatchObject({ family: "IH21", fixed: [null, 0.7] });
  });

  it("says the strain of profiles over directions and the direction of those over strain", () => {
    const polar = designRequest({ ...state, task: "poisson" }, "search", "s");
    expect(polar.strain).toBe(0.05);
    expect(polar.direction).toBeUndefined();
  });
});

describe("a verification", () => {
  it("simulates the very design that is shown", () => {
    const request = verificationRequest({ ...state, byHand: true }, found);
    expect(request).toMatchObject({ family: "IH21", fixed: [0.12, 0.7], verify: true });
    expect(request.session).toBeUndefined();
  });

  it("draws the patch from rest into both directions of the target", () => {
    const { load } = patchRequest(state, found);
    const { stretches, direction } = (load as { uniaxial: { stretches: number[]; direction: number } }).uniaxial;
    expect(direction).toBe(0.3);
    expect(stretches[0]).toBe(1);
    expect(Math.max(...stretches)).toBeCloseTo(Math.sqrt(1.4), 12);
    expect(Math.min(...stretches)).toBeCloseTo(Math.sqrt(0.8), 12);
  });
});

describe("a profile", () => {
  it("has the samples of the target", () => {
    expect(profileRequest(state, found, state.made)).toMatchObject({ family: "IH21", range: [-0.1, 0.2], samples: designRequest(state, "search", "s").samples });
    expect(profileRequest({ ...state, points: [] }, found, state.made).range).toBeUndefined();
  });
});

describe("the structure's file", () => {
  it("has an address with all digits of the parameters", () => {
    expect(structurePath({ family: "IH21", parameters: [0.1 + 0.2, 1e-7] }, "dxf", [3, 2])).toBe(
      "/v1/families/IH21/structure?parameters=0.30000000000000004,1e-7&cells=3,2&format=dxf",
    );
  });

  it("is drawn again around itself until a square is covered, also of a slanted lattice", () => {
    // A patch of 5 by 10 extends 2.5 and 5 from its centre, and a square of 20 extends 10: that takes three copies on each side, and two.
    const straight = copiesOf([5, 0, 0, -10], 20);
    expect(straight).toHaveLength(7 * 5 - 1);
    expect(straight).toContainEqual([15, -20]);
    expect(straight).not.toContainEqual([0, 0]);
    // A patch with an extent of 2.6 and 4.9 from its centre does not reach the square from 15 to its right, nor from 20 below its centre.
    expect(copiesOf([5, 0, 0, -10], 20, [2.6, 4.9])).toHaveLength(5 * 3 - 1);
    for (const [a, b] of [[[5, 5], [5, -5]], [[6, 1], [2, 7]]]) {
      const places = [[0, 0], ...copiesOf([...a, ...b], 20)];
      // Each point of the square is at most half a diagonal away from the centre of a patch.
      const reach = Math.max(Math.hypot(a[0] + b[0], a[1] + b[1]), Math.hypot(a[0] - b[0], a[1] - b[1])) / 2;
      for (let x = -10; x <= 10; x += 2) {
        for (let y = -10; y <= 10; y += 2) expect(Math.min(...places.map(([px, py]) => Math.hypot(x - px, y - py)))).toBeLessThanOrEqual(reach);
      }
    }
  });
});
