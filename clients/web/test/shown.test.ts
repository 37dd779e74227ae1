import { describe, expect, it } from "vitest";
import type { DesignCandidate, Model } from "../src/contract/types";
import { errorBand, expectedDeviation, modelError, type Shown } from "../src/design/shown";

const model = { errors: { design_split: { gradient: { mean: 0.1, percentile_99: 0.4 } } } } as unknown as Model;
const shown = (achieved: readonly (number | null)[]) => ({ task: "stress_strain", x: [-0.1, 0, 0.1], achieved }) as unknown as Shown;

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
  const candidate = (deviation: number, model: number | null): DesignCandidate =>
    ({ error: { relative_rms: deviation, max: 0 }, model_error: model }) as DesignCandidate;

  it("are compared by deviation and by the model’s error, an unknown one being the worst", () => {
    expect(expectedDeviation(candidate(0.03, 0.04))).toBeCloseTo(0.05);
    expect(expectedDeviation(candidate(0.01, 0.01))).toBeLessThan(expectedDeviation(candidate(0.0001, 0.08)));
    expect(expectedDeviation(candidate(0, null))).toBeGreaterThan(expectedDeviation(candidate(0.9, 0.1)));
  });
});
