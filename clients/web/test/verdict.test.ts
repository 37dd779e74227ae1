import { describe, expect, it, vi } from "vitest";
import { samples } from "../../../api/verdicts.json";
import type { Profile } from "../src/contract/types";
import { shownGrade } from "../src/design/judged";
import { profileResponses, type TargetResponse, withBoundOf } from "../src/design/shown";
import { spaced } from "../src/design/spline";
import { type ControlPoint, DEFAULT_STATE, type DesignState } from "../src/design/state";
import { type CurveEvidence, judge, judgeAll, verdictFacts } from "../src/design/verdict";
import { fitRanges, joinedAcrossPeriod, type JudgedCurve, reachedSamples } from "../src/design/verdict_ranges";
import { verdictSentence } from "../src/design/verdict_sentence";

// A busy machine has time.
vi.setConfig({ testTimeout: 60_000 });

const X = spaced(0, 0.2, 11);
const state: DesignState = { ...DEFAULT_STATE, points: [[0, 0], [0.1, 1], [0.2, 2]], interpolation: "linear", found: { family: "IH22", parameters: [0.3] } };

/** A response to a target of control points. */
function responseTo(points: readonly ControlPoint[], y: readonly (number | null)[], more: Partial<TargetResponse> = {}): TargetResponse {
  const profile = { family: "IH22", parameters: [0.3], model: "m", x: X, y, error_bar: null, in_range: X.map(() => true), cost: { seconds: 1 } };
  const [shown] = profileResponses([profile as unknown as Profile], { ...state, points });
  return { ...shown, byHand: false, ...more };
}

const scaled = (factor: number, more: Partial<TargetResponse> = {}) => responseTo(state.points, X.map((x) => 10 * x * factor), more);
const bars = (fraction: number) => X.map((x) => 10 * x * fraction);
const trusted = (count: number) => X.map((_, k) => k < count);
const simulatedAs = (factor: number) => ({ x: X, y: X.map((x) => 10 * x * factor) });

/** A pseudorandom generator of numbers in [0, 1), the same in each run. */
function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state * 16807) % 2147483647;
    return state / 2147483647;
  };
}

describe("the judgement of any design", () => {
  it("is never green beyond 5 % or where half of the samples are not trusted, and never red within 1 %", () => {
    const next = random(7);
    for (let trial = 0; trial < 500; ++trial) {
      const off = (next() < 0.5 ? 0.02 : 0.4) * next();
      const wave = X.map(() => 2 * next() - 1);
      const y = X.map((x, k) => 10 * x + 1.2 * off * wave[k] + 10 * x * off * (next() - 0.5));
      const count = Math.floor(12 * next());
      const shown = responseTo(state.points, y, { inRange: trusted(count), errorBar: next() < 0.5 ? bars(0.4 * next()) : null });
      const error = next() < 0.5 ? { mean: 0.3 * next(), percentile99: 0.5 } : null;
      const simulated = next() < 0.5 ? { x: X, y: X.map((x) => 10 * x * (1 + 0.3 * (next() - 0.5))) } : null;
      const { grade, deviation, source, isWithinError } = judge(shown, error, simulated);
      expect(source).toBe(simulated ? "simulation" : "model");
      if (!simulated) expect(deviation).toBeCloseTo(shown.deviation, 9);
      const isTrusted = simulated !== null || 2 * (X.length - count) < X.length;
      if (grade === "reached" || isWithinError) expect(deviation).toBeLessThanOrEqual(0.05);
      if (grade === "reached" || isWithinError) expect(isTrusted).toBe(true);
      if (isWithinError) expect([grade, source]).toEqual(["reached", "model"]);
      if (deviation !== null && deviation <= 0.01) expect(grade).not.toBe("missed");
      if (!isTrusted) expect(grade).toBe("unknown");
      else expect(grade).toBe((deviation as number) <= 0.05 ? "reached" : (deviation as number) <= 0.15 ? "close" : "missed");
    }
  });

  it("is that of the worst of several targets, and by simulation only if all of them are simulated", () => {
    const evidence = (factor: number, simulated: number | null) => ({ shown: scaled(factor), error: null, simulated: simulated === null ? null : simulatedAs(simulated) });
    expect(judgeAll([evidence(1.01, null), evidence(1.3, null)])).toMatchObject({ grade: "missed", source: "model" });
    expect(judgeAll([evidence(1.01, 1.02), evidence(1.01, null)])).toMatchObject({ grade: "reached", source: "model" });
    const judged = judgeAll([evidence(1.01, 1.02), evidence(1.01, 1.45)]);
    expect(judged).toMatchObject({ grade: "missed", source: "simulation", words: "Simulated: missed" });
    expect(judged.sentence).toContain("Of 2 targets, number 2 is the furthest off.");
  });

  it("is by the simulation of one of several targets if that one is not reached", () => {
    const evidence = (factor: number, simulated: number | null, count = 11) => ({
      shown: scaled(factor, { inRange: trusted(count) }),
      error: null,
      simulated: simulated === null ? null : simulatedAs(simulated),
    });
    const judged = judgeAll([evidence(1.01, null), evidence(1.01, 1.45)]);
    expect(judged).toMatchObject({ grade: "missed", source: "simulation" });
    expect(judged.sentence).toMatch(/^Simulated: 45 % off\. Of 2 targets, number 2 is the furthest off\./);
    expect(judgeAll([evidence(1.6, null, 2), evidence(1.01, 1.45)])).toMatchObject({ grade: "missed", source: "simulation" });
    expect(judgeAll([evidence(1.6, null), evidence(1.01, 1.1)])).toMatchObject({ grade: "missed", source: "model" });
  });

  it("colours only what belongs to the present state", () => {
    const judged = judge(scaled(1.01), null);
    expect([shownGrade(judged, "current"), shownGrade(judged, "outdated"), shownGrade(null, "current")]).toEqual(["reached", "", ""]);
  });

  it("is by simulation wherever there is one: a model that is close does not hide a miss", () => {
    const judged = judge(scaled(1.035, { errorBar: bars(0.04) }), null, simulatedAs(1.45));
    expect(judged).toMatchObject({ grade: "missed", source: "simulation", isWithinError: false });
    expect(judged.sentence).toMatch(/^Simulated: 45 % off\./);
    expect(judge(scaled(1.45), null, simulatedAs(1.02))).toMatchObject({ grade: "reached", source: "simulation", sentence: "Simulated: reached, 2 % off." });
  });
});

describe("the error of a model", () => {
  it("explains a deviation only where it is small against the target", () => {
    expect(judge(scaled(1.02, { errorBar: bars(0.03) }), null)).toMatchObject({ grade: "reached", isWithinError: true, words: "Within the model’s error" });
    expect(judge(scaled(1.02, { errorBar: bars(0.3) }), null)).toMatchObject({ grade: "reached", isWithinError: false, words: "Reached" });
    expect(judge(scaled(1.2, { errorBar: bars(0.3) }), null)).toMatchObject({ grade: "missed", isWithinError: false });
    expect(judge(scaled(1.02), { mean: 0.03, percentile99: 0.1 }).isWithinError).toBe(true);
    expect(judge(scaled(1.02), null).isWithinError).toBe(false);
  });

  it("does not count where the model is not trusted: half of the samples make the verdict uncertain, fewer are told", () => {
    const few = judge(scaled(1.02, { inRange: trusted(8) }), { mean: 0.03, percentile99: 0.1 });
    expect(few).toMatchObject({ grade: "reached", isWithinError: false });
    expect(few.sentence).toContain("The model is not trusted at 3 of 11 samples.");
    const half = judge(scaled(1.02, { inRange: trusted(5) }), { mean: 0.03, percentile99: 0.1 });
    expect(half).toMatchObject({ grade: "unknown", words: "Not certain" });
    expect(half.sentence).toBe("By the model: 2 % off, not certain. The model is not trusted at 6 of 11 samples: verify it by simulation.");
  });
});

describe("Poisson’s ratios near 0", () => {
  const directions = [0, 0.5, 1, 1.5, 2, 2.5];
  const curve = (target: number, y: number) => ({ task: "poisson" as const, x: directions, target: directions.map(() => target), y: directions.map(() => y) });
  const facts = (...curves: JudgedCurve[]) => verdictFacts(curves.map((model): CurveEvidence => ({ model, simulated: null, inRange: model.x.map(() => true) })));

  it("are reached within 0.02, however far off they are relative to the target", () => {
    const near = facts(curve(0.01, 0.0299));
    expect(near).toMatchObject({ grade: "reached", deviation: expect.closeTo(0.199, 9) });
    expect(verdictSentence(near)).toBe("By the model: reached, each Poisson's ratio within 0.02.");
    expect(facts(curve(0.01, 0.0301)).grade).toBe("missed");
    expect(reachedSamples(curve(3, 3.029))).toBe(6);
  });

  it("do not decide beside a target that is missed", () => {
    const stiffness = { ...curve(1, 1.08), task: "stiffness" as const };
    expect(facts(curve(0, 0.019), stiffness)).toMatchObject({ grade: "close", worst: 1 });
  });
});

describe("missing values", () => {
  it("leave the verdict open", () => {
    const gap = X.map((x, k) => (k === 4 ? null : 10 * x));
    expect(judge(responseTo(state.points, gap), null)).toMatchObject({
      grade: "unknown",
      deviation: null,
      sentence: expect.stringMatching(/^By the model: not at every sample\./),
    });
    expect(judge(scaled(1), null, { x: X, y: gap })).toMatchObject({ grade: "unknown", source: "simulation" });
    expect(judge(scaled(1), null, { x: X, y: X.map(() => null) })).toMatchObject({
      grade: "unknown",
      source: "simulation",
      sentence: "Simulated: no result. By the model it is less than 0.1 % off.",
    });
  });
});

describe("the parts of a target", () => {
  const plateau: ControlPoint[] = [[0, 0], [0.08, 1], [0.2, 1.05]];

  it("are named by what the curve does there, with the strains between which they are reached", () => {
    const y = X.map((x) => (x < 0.08 ? 20 * x : 1 + 0.4 * (x - 0.08)));
    const { sentence } = judge(responseTo(plateau, y.map((value, k) => (X[k] >= 0.08 ? value + (X[k] - 0.08) * 0.0167 : value))), null);
    expect(sentence).toMatch(/^By the model: \d+ % off\. The plateau is reached from [\d.]+ to 20 %, the rise is missed from 0 to [\d.]+ % \([\d.]+ % off\)\.$/);
  });

  it("are not told where the target is reached, and all are missed where none is reached", () => {
    expect(judge(scaled(1.001), null).sentence).toBe("By the model: reached, 0.1 % off.");
    expect(judge(scaled(0.3), null).sentence).toBe("By the model: 70 % off. No part of it is reached.");
  });

  it("count zeros of the target away from rest, and speak of rest where a preload is missed", () => {
    const parts = (target: readonly number[], y: readonly number[]) =>
      fitRanges({ task: "stress_strain", x: [-0.1, -0.05, 0, 0.05, 0.1].slice(5 - target.length), target, y }).map(({ part, fit }) => `${part} ${fit}`);
    expect(parts([0, 1, 0], [0, 2, 0])).toEqual(["rise missed", "drop reached"]);
    expect(parts([-0.5, 0.1, 0.5, 1, 1.5], [-0.5, 0.1, 0, 1, 1.5])).toEqual(["compression reached", "around_rest missed", "tension reached"]);
    expect(parts([0.5, 1, 1.5], [0, 1, 1.5])).toEqual(["around_rest missed", "whole reached"]);
  });

  it("touch each other and cover the target, and over directions those at both ends are one", () => {
    const next = random(3);
    for (let trial = 0; trial < 300; ++trial) {
      const task = next() < 0.5 ? "stress_strain" : "poisson";
      const target = X.map(() => 2 * next() - 1);
      const y = target.map((value) => (next() < 0.1 ? null : value + (next() < 0.5 ? 0 : 0.5 * next())));
      const ranges = fitRanges({ task, x: X, target, y });
      expect(ranges[0].from).toBe(0);
      expect(ranges[ranges.length - 1].to).toBeCloseTo(task === "poisson" ? Math.PI : 0.2, 12);
      ranges.slice(1).forEach((range, k) => {
        expect(range.from).toBe(ranges[k].to);
        expect(range.fit).not.toBe(ranges[k].fit);
      });
      const joined = joinedAcrossPeriod(ranges, task);
      const ends = task === "poisson" && ranges.length > 1 && ranges[0].fit === ranges[ranges.length - 1].fit;
      expect(joined.length).toBe(ranges.length - Number(ends));
    }
  });
});

describe("a worked sample of the table", () => {
  // The page has no structures: it judges what the server has answered.
  it.each(samples.filter(({ has_structure }) => has_structure))("is judged as the server judges it: $name", ({ targets, grade, source, deviation, sentence }) => {
    const facts = verdictFacts(targets.map(({ task, x, target, model, in_range, simulated }): CurveEvidence => {
      const curve = { task: task as TargetResponse["task"], x, target };
      return { model: { ...curve, y: model }, simulated: simulated && { ...curve, y: simulated }, inRange: in_range };
    }));
    expect([facts.grade, facts.source]).toEqual([grade, source]);
    if (deviation === null) expect(facts.deviation).toBeNull();
    else expect(facts.deviation).toBeCloseTo(deviation, 4);
    expect(verdictSentence(facts)).toBe(sentence);
  });
});

describe("the server's verdict", () => {
  const answered = { grade: "missed", source: "model", deviation: 0.3, sentence: "By the model: 30 % off, with a band." } as const;

  it("says what no material can have where the target is missed", () => {
    const bound = { deviation: 0.07, x: X, y: X, sentence: "No material at rest comes nearer than 7 % to it." };
    expect(judge(scaled(1.3, { bound }), null).bound).toBe(bound.sentence);
    expect(judge(scaled(1.3), null).bound).toBe("");
    expect(judge(scaled(1.3, { bound }), null, simulatedAs(1.02)).bound).toBe("");
  });

  it("about materials holds for the same target while parameters are set by hand", () => {
    const bound = { deviation: 0.07, x: X, y: X, sentence: "No material at rest comes nearer than 7 % to it." };
    const [before, now] = [scaled(1.3, { bound }), scaled(1.2)];
    expect(withBoundOf(now, before).bound).toBe(bound);
    expect(withBoundOf({ ...now, targets: now.targets.map((target) => ({ ...target, points: [...target.points].reverse() })) }, before).bound).toBeNull();
    expect(withBoundOf(now, null).bound).toBeNull();
  });

  it("is what is said of a design that it has judged, unless the page knows of a simulation", () => {
    expect(judge(scaled(1.3, { answered }), null).sentence).toBe(answered.sentence);
    expect(judge(scaled(1.3, { answered }), null, simulatedAs(1.02)).sentence).toBe("Simulated: reached, 2 % off.");
    expect(judge(scaled(1.02, { answered }), null)).toMatchObject({ grade: "reached", sentence: "By the model: reached, 2 % off." });
  });
});
