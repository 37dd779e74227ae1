import { describe, expect, it } from "vitest";
import type { DesignCandidate, Model, PartialDesign, Profile } from "../src/contract/types";
import { relaxation, projectedTarget } from "../src/design/reach";
import { errorBand, expectedDeviation, freshness, modelError, partialResponse, profileResponses, type TargetResponse } from "../src/design/shown";
import { relativeDeviation, targetCurve } from "../src/design/spline";
import { type ControlPoint, DEFAULT_STATE, type DesignState } from "../src/design/state";

const model = { errors: { design_split: { gradient: { mean: 0.1, percentile_99: 0.4 } } } } as unknown as Model;
const shown = (achieved: readonly (number | null)[]) => ({ task: "stress_strain", x: [-0.1, 0, 0.1], achieved }) as unknown as TargetResponse;

describe("a model's error", () => {
  it("is that of the stress on unseen designs", () => {
    expect(modelError(model, shown([]))).toEqual({ mean: 0.1, percentile99: 0.4 });
    expect(modelError(undefined, shown([]))).toBeNull();
    expect(modelError({ errors: { design_split: null } } as unknown as Model, shown([]))).toBeNull();
  });

  it("says nothing of Poisson's ratio", () => {
    expect(modelError(model, { ...shown([]), task: "poisson" })).toBeNull();
  });

  it("lies about the profile on either side of rest", () => {
    const band = errorBand(shown([-2, 0, 3]), { mean: 0.1, percentile99: 0.4 });
    expect(band?.lower.map((y) => Number(y.toFixed(9)))).toEqual([-2.2, 0, 2.7]);
    expect(band?.upper.map((y) => Number(y.toFixed(9)))).toEqual([-1.8, 0, 3.3]);
  });

  it("gives way to the error bars of the answer", () => {
    const error = { mean: 0.1, percentile99: 0.4 };
    const band = errorBand({ ...shown([-2, 0, 3]), errorBar: [0.5, 0, 0.25] }, error);
    expect(band?.lower).toEqual([-2.5, 0, 2.75]);
    expect(band?.upper).toEqual([-1.5, 0, 3.25]);
    expect(errorBand({ ...shown([-2, 0, 3]), errorBar: [0.5, null, 0.25] }, error)).toBeNull();
  });

  it("is not drawn across gaps", () => {
    expect(errorBand(shown([-2, null, 3]), { mean: 0.1, percentile99: 0.4 })).toBeNull();
    expect(errorBand(shown([-2, 0, 3]), null)).toBeNull();
  });
});

describe("families", () => {
  const candidate = (deviation: number, model: number | null): DesignCandidate => ({ error: { relative_rms: deviation, max: 0 }, model_error: model }) as DesignCandidate;

  it("are compared by deviation and by the model’s error, an unknown one being the worst", () => {
    expect(expectedDeviation(candidate(0.03, 0.04))).toBeCloseTo(0.05);
    expect(expectedDeviation(candidate(0.01, 0.01))).toBeLessThan(expectedDeviation(candidate(0.0001, 0.08)));
    expect(expectedDeviation(candidate(0, null))).toBeGreaterThan(expectedDeviation(candidate(0.9, 0.1)));
  });
});

const state: DesignState = { ...DEFAULT_STATE, points: [[0, 0], [0.1, 1], [0.2, 2]], found: { family: "IH22", parameters: [0.3] } };
const profileOf = (points: DesignState["points"], y: (number | null)[]): TargetResponse =>
  profileResponses([{ family: "IH22", parameters: [0.3], model: "m", x: [0, 0.05, 0.1, 0.15, 0.2], y, error_bar: [], in_range: [], cost: { seconds: 1 } } as unknown as Profile], {
    ...state,
    points,
  })[0];

describe("what is shown beside what was decided", () => {
  const shown = profileOf(state.points, [0, 0.5, 1, 1.5, 2]);

  it("is current, of an earlier target or earlier parameters, or of something else", () => {
    expect(freshness(shown, state)).toBe("current");
    expect(freshness(shown, { ...state, points: [...state.points] })).toBe("outdated");
    expect(freshness(shown, { ...state, interpolation: "linear" })).toBe("outdated");
    expect(freshness(shown, { ...state, found: { family: "IH22", parameters: [0.4] } })).toBe("outdated");
    expect(freshness(shown, { ...state, found: { family: "IH28", parameters: [0.3] } })).toBe("other");
    expect(freshness(shown, { ...state, task: "stiffness" })).toBe("other");
    expect(freshness(null, state)).toBe("other");
  });

  it("pairs the samples of a search on its way with its own target", () => {
    const partial = { family: "IH28", model: "m", parameters: [0.1, 0.2], x: [0, 0.2], achieved: [0, 1], error: { relative_rms: 0.5, max: 1 }, iteration: 3 } as PartialDesign;
    const best = partialResponse(partial, state);
    expect(best.x).toEqual([0, 0.2]);
    expect(best.target.map((y) => Number(y.toFixed(9)))).toEqual([0, 2]);
    expect(best.reached).toEqual([true, false]);
    expect(best.inRange).toHaveLength(2);
    expect(best.largest).toBeCloseTo(1);
    expect([best.byHand, best.provisional]).toEqual([false, true]);
  });
});

describe("a target that no design meets", () => {
  it("names the control point that has to give way, and what is left then", () => {
    const points: ControlPoint[] = [[0, 0], [0.05, 0.5], [0.1, 2], [0.15, 1.5], [0.2, 2]];
    const answer = { ...profileOf(points, [0, 0.5, 1, 1.5, 2]), byHand: false };
    const found = relaxation(answer);
    expect(found?.index).toBe(2);
    expect(found?.to[1]).toBeCloseTo(1, 6);
    expect(found?.deviation).toBeLessThan(1e-6);
    expect(relaxation({ ...answer, target: answer.achieved as number[], points: state.points })).toBeNull();
  });

  it("moves onto what the design does, with as many points where these suffice", () => {
    const answer = profileOf(state.points, [0, 0.375, 0.75, 1.125, 1.5]);
    const { points: projected, interpolation } = projectedTarget(answer);
    expect(interpolation).toBe(state.interpolation);
    expect(projected.map((point) => point[0])).toEqual([0, 0.1, 0.2]);
    expect(projected[0]).toEqual([0, 0]);
    expect(projected[1][1]).toBeCloseTo(0.75, 9);
    const wavy = profileOf(state.points, [0, 1, 0.2, 1.4, 0.1]);
    const followed = projectedTarget(wavy);
    expect(relativeDeviation(wavy.achieved, wavy.x.map(targetCurve(false, followed.points, followed.interpolation)))).toBeLessThan(0.01);
  });

  it("moves onto a response that jumps, too, with a curve that does not swing beside the jump", () => {
    const x = Array.from({ length: 60 }, (_, k) => (k * Math.PI) / 60);
    const jumps = x.map((angle) => (Math.abs(Math.sin(2 * angle)) > 0.4 ? 0.13 - 0.08 * Math.abs(Math.sin(2 * angle)) : 0.05));
    const points: ControlPoint[] = [[0, 1], [1, 1], [2, 1]];
    const { points: projected, interpolation } = projectedTarget({
      ...profileOf(points, []),
      task: "stiffness",
      points,
      interpolation: "cubic",
      x,
      achieved: jumps,
      target: x.map(() => 1),
    });
    expect(relativeDeviation(jumps, x.map(targetCurve(true, projected, interpolation)))).toBeLessThan(0.02);
  });
});
