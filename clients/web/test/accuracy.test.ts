import { describe, expect, it } from "vitest";
import { NORMAL, readChoice, withSwitch, writeChoice } from "../src/base/accuracy_choice";
import { atLevel, type Capability, estimate, LEVEL_ROWS, LevelMeasures, levelRow, LEVELS, type LevelRow } from "../src/base/accuracy_levels";
import { errorWords, estimateSentence, levelErrorWords, secondsWords, withError } from "../src/base/accuracy_words";
import { readFields, writeFields } from "../src/base/link_fields";

const row = (level: string, seconds: number | null, error: number | null): LevelRow => ({
  capability: "weaves",
  level,
  request: {},
  task: "",
  seconds,
  error,
  error_of: "",
  why: "",
});
const ROWS = [row("draft", 1, 0.25), row("normal", 2, 0.125), row("sure", null, 0.03125)];

describe("the table of levels", () => {
  it("has all levels of everything that a dial offers, with a sentence about each", () => {
    const capabilities: readonly Capability[] = ["designs", "simulations", "networks", "hosts", "voronoi", "voronoi_optimizations", "weaves", "geodesics"];
    for (const capability of capabilities) for (const level of LEVELS) expect(levelRow(capability, level)?.why, `${capability}, ${level}`).toBeTruthy();
  });

  it("asks for nothing at the normal level, which is that of requests without a choice", () => {
    for (const { level, request } of LEVEL_ROWS) if (level === "normal") expect(request).toEqual({});
  });
});

describe("a request at a level", () => {
  const request = { strain: 0.1, accuracy: { segments: 4, tolerance: 1e-6 }, effects: { out_of_plane: "off" } };

  it("has the members of the level in the place of its own, and keeps the others", () => {
    const sure = atLevel(request, "weaves", { level: "sure", switches: {} });
    expect(sure).toMatchObject({ strain: 0.1, accuracy: { segments: 16, tolerance: 1e-6 }, effects: { out_of_plane: "off", error_estimate: "on" } });
    expect(request.accuracy.segments).toBe(4);
  });

  it("is unchanged at the normal level and with values of one's own", () => {
    expect(atLevel(request, "weaves", NORMAL)).toEqual(request);
    expect(atLevel(request, "weaves", { level: "own", switches: {} })).toEqual(request);
  });

  it("has the effects that were switched, of those that it has", () => {
    const switched = withSwitch(withSwitch(NORMAL, "buckling", "off"), "trust", "on");
    expect(atLevel(request, "weaves", switched).effects).toEqual({ out_of_plane: "off", buckling: "off" });
    expect(atLevel({}, "designs", switched)).toEqual({ effects: { trust: "on" } });
    expect(withSwitch(switched, "buckling", "automatic").switches).toEqual({ trust: "on" });
  });
});

describe("what a level takes", () => {
  it("is what was measured at that level, and scales with it at the others", () => {
    const measures = new LevelMeasures();
    measures.record("weaves", { level: "normal", seconds: 6, error: 0.0625 });
    const at = (level: "draft" | "normal" | "sure") => estimate("weaves", level, measures.of("weaves"), ROWS);
    expect(at("normal")).toEqual({ seconds: 6, error: 0.0625, source: "measured", errorSource: "measured" });
    expect(at("draft")).toEqual({ seconds: 3, error: 0.125, source: "scaled", errorSource: "scaled" });
    expect(at("sure")).toMatchObject({ seconds: null, source: "table" });
    expect(at("sure").error).toBeCloseTo(0.015625);
  });

  it("is that of the table before anything was computed", () => {
    const none = new LevelMeasures().of("weaves");
    expect(estimate("weaves", "draft", none, ROWS)).toEqual({ seconds: 1, error: 0.25, source: "table", errorSource: "table" });
    expect(estimate("weaves", "own", none, ROWS)).toEqual({ seconds: null, error: null, source: "measured", errorSource: "measured" });
  });

  it("with values of one's own is known only once they were computed, and does not scale the levels", () => {
    const measures = new LevelMeasures();
    measures.record("weaves", { level: "own", seconds: 60, error: null });
    expect(estimate("weaves", "own", measures.of("weaves"), ROWS).seconds).toBe(60);
    expect(estimate("weaves", "normal", measures.of("weaves"), ROWS)).toEqual({ seconds: 2, error: 0.125, source: "table", errorSource: "table" });
  });
});

describe("accuracy in words", () => {
  it("is an error beside its number, where one is known", () => {
    expect([errorWords(0.004), errorWords(0), errorWords(null), errorWords(undefined), errorWords(NaN)]).toEqual(["±\u00a00.4\u00a0%", "exact", "", "", ""]);
    expect([withError("12 MPa", 0.05), withError("12 MPa", 0), withError("12 MPa", null)]).toEqual(["12 MPa ±\u00a05\u00a0%", "12 MPa", "12 MPa"]);
  });

  it("says whether seconds were measured or are expected", () => {
    expect(secondsWords({ seconds: 0.42, source: "measured" })).toBe("420 ms");
    expect(secondsWords({ seconds: 2.345, source: "scaled" })).toBe("≈ 2.3 s");
    expect(estimateSentence("weaves", "normal", { seconds: 2, error: 0.1, source: "table", errorSource: "table" }, "error of the modulus")).toBe(
      "Stiffness: ≈ 2 s by the benchmarks, ±\u00a010\u00a0% (error of the modulus).",
    );
    expect(estimateSentence("designs", "normal", { seconds: 2, error: 0.1, source: "measured", errorSource: "table" }, "")).toBe(
      "Search: 2 s as measured here, ±\u00a010\u00a0% in the benchmarks.",
    );
    expect(estimateSentence("weaves", "normal", { seconds: null, error: null, source: "table", errorSource: "table" }, "")).toBe("Stiffness: not measured yet.");
  });

  it("calls a setting the most exact one where the others are measured against it, and tells no error of it", () => {
    const host = estimate("hosts", "sure", new LevelMeasures().of("hosts"));
    expect(host.error).toBeNull();
    expect([levelErrorWords("sure", host.error), levelErrorWords("normal", null), levelErrorWords("sure", 0.1)]).toEqual(["most exact", "", "±\u00a010\u00a0%"]);
    expect(estimateSentence("hosts", "sure", host, "error of a place")).toBe("Relaxation with its host: ≈ 280 ms by the benchmarks, the most exact setting.");
    expect(estimateSentence("hosts", "sure", { ...host, seconds: null }, "")).toBe("Relaxation with its host: the most exact setting.");
  });
});

describe("the choice in a link", () => {
  const roundTrip = (choice: Parameters<typeof writeChoice>[0], usual: "normal" | "own" = "normal") => readChoice(readFields(writeFields(writeChoice(choice, usual))), usual);

  it("comes back as it was, and takes no room where nothing was chosen", () => {
    expect(writeChoice(NORMAL)).toEqual([]);
    const choice = { level: "sure" as const, switches: { buckling: "off" as const, trust: "on" as const } };
    expect(roundTrip(choice)).toEqual(choice);
    expect(roundTrip({ level: "normal", switches: {} }, "own")).toEqual(NORMAL);
  });

  it("has no levels and effects that there are not", () => {
    expect(readChoice(readFields("accuracy=perfect&effects=magic:on,buckling:maybe"))).toEqual(NORMAL);
  });
});
