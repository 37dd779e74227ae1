import { describe, expect, it } from "vitest";
import { chipsOf, effectChip, nextSetting, outdated } from "../src/base/effect_words";
import type { Effect } from "../src/contract/types";

const effect = (name: string, ran: boolean, why: string, count = ran ? 1 : 0): Effect => ({ name, ran, why, count, seconds: 0 });
const told = (one: Effect) => {
  const chip = effectChip(one);
  return chip && [`${chip.name}: ${chip.words}`, chip.tone];
};

describe("an effect as a chip", () => {
  it("says what was found, in a designer's words", () => {
    expect(told(effect("buckling", false, "the tangent stiffness stayed positive definite"))).toEqual(["buckling: checked, none", "clear"]);
    expect(told(effect("buckling", true, "the tangent stiffness was not positive definite"))).toEqual(["buckling: found and followed", "found"]);
    expect(told(effect("contact", false, "no pair of boundary points came within the barrier's range"))).toEqual(["contact: not needed", "idle"]);
    expect(told(effect("multi_start", true, "the request asks for it", 24))).toEqual(["further starts: 24 tried", "done"]);
    expect(told(effect("approximation", false, "the request asks for exact distances"))).toEqual(["distances: exact", "clear"]);
  });

  it("is never green where nothing was computed", () => {
    for (const why of ["switched off by the request", "the request turns it off", "asked not to", "the request leaves it out"]) {
      expect(told(effect("buckling", false, why))).toEqual(["buckling: switched off", "idle"]);
    }
    expect(told(effect("trust", false, "the request says where to begin"))).toEqual(["surer designs: not checked", "idle"]);
    expect(told(effect("self_contact", false, "a host does not notice where it touches itself"))).toEqual(["contact of the host with itself: not checked", "idle"]);
    expect(chipsOf([], { buckling: "automatic", out_of_plane: "off" }).map(({ words, tone }) => [words, tone])).toEqual([["not computed yet", "idle"], ["switched off", "idle"]]);
    expect(chipsOf([], {}, { discretization_error: null })[0]).toMatchObject({ words: "not estimated", tone: "idle" });
    expect(outdated(chipsOf([effect("buckling", false, "the tangent stiffness stayed positive definite")], {})).map(({ tone }) => tone)).toEqual(["idle"]);
  });

  it("is left out where it tells a designer nothing", () => {
    expect([told(effect("joint_bend", false, "no crossing is fused")), told(effect("polish", false, "designs are corrected where they are verified"))]).toEqual([null, null]);
  });

  it("of an error has the error, which is green only while it is small", () => {
    expect(chipsOf([], {}, { discretization_error: 0.004 })).toMatchObject([{ name: "discretization", words: "±0.4\u00a0%", tone: "clear" }]);
    expect(chipsOf([], {}, { discretization_error: { youngs_modulus: 0.09, poisson_ratio: 0.01 } })).toMatchObject([{ words: "±9\u00a0%", tone: "found" }]);
    expect(chipsOf([], {}, { tolerance: 1e-6 })).toEqual([]);
  });

  it("is switched from where needed to always to never and back", () => {
    expect((["automatic", "on", "off"] as const).map(nextSetting)).toEqual(["on", "off", "automatic"]);
    const chips = chipsOf([effect("buckling", true, "the tangent stiffness was not positive definite"), effect("patch", false, "one cell was stable")], { buckling: "on" });
    expect(chips.map(({ effect: name, setting }) => [name, setting])).toEqual([["buckling", "on"], ["patch", null]]);
  });
});
