import { describe, expect, it } from "vitest";
import { beamWidthSentence } from "../src/design/beam_width_words";

describe("the sensitivity to the beam width", () => {
  it("is one sentence about what is known", () => {
    expect(beamWidthSentence({ wider: 0.124, narrower: 0.0512 })).toBe("At rest, beams that are 5 % wider change the response by 12 %, narrower ones by 5.1 %.");
    expect(beamWidthSentence({ wider: null, narrower: 0.1 })).toBe("At rest, beams that are 5 % narrower change the response by 10 %.");
    expect(beamWidthSentence({ wider: 0.1, narrower: null })).toBe("At rest, beams that are 5 % wider change the response by 10 %.");
    expect(beamWidthSentence({ wider: null, narrower: null })).toBe("");
  });
});
