import { describe, expect, it } from "vitest";
import type { Polish } from "../src/contract/types";
import { goesOn, polishHelp } from "../src/design/polish_help";
import type { WayOut } from "../src/design/ways_out";

const rounds = (count: number) => Array.from({ length: count }, () => ({})) as unknown as Polish["rounds"];
const polish = (stopped: Polish["stopped"], error: number | null = 0.3, count = 3) => ({ rounds: rounds(count), stopped, target_error: error });
const none = { kind: "none" } as const;

describe("what would help after a polish", () => {
  it("is nothing where the target is reached, or where nothing was polished", () => {
    expect(polishHelp(polish("reached", 0.01), none)).toBe("");
    expect(polishHelp(polish("time_limit", 0.4, 1), none)).toBe("");
    expect([goesOn(polish("round_limit", 0.01)), goesOn(polish("time_limit", 0.4, 1))]).toEqual([false, false]);
  });

  it("is to polish again where a limit has ended it", () => {
    expect(polishHelp(polish("round_limit"), none)).toBe("It has ended by its limit of rounds: polishing again goes on from here.");
    expect([goesOn(polish("round_limit")), goesOn(polish("no_improvement"))]).toEqual([true, false]);
  });

  it("is the best way out that is known, and a sentence of what may help before one is", () => {
    const way = { sentence: "Turn the tiling by 82 degrees: 3.5 % instead of 55 % by the model." } as WayOut;
    expect(polishHelp(polish("no_improvement"), { kind: "found", ways: [way] })).toBe(`No polish brings it closer. What would help: ${way.sentence}`);
    expect(polishHelp(polish("no_improvement"), { kind: "found", ways: [] })).toMatch(/no change that was tried helps/);
    expect(polishHelp(polish("no_improvement"), none)).toMatch(/another family may\.$/);
    expect(polishHelp(polish("not_simulated", null), none)).toMatch(/a shorter range may help/);
  });
});
