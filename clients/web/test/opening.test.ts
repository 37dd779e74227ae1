import { describe, expect, it } from "vitest";
import type { Client } from "../src/contract/client";
import type { Model } from "../src/contract/types";
import { DesignSession } from "../src/design/session";
import { firstModels, type OfferedProfile, indexOfMostReliable } from "../src/design/verdict";

const STRESS = [-0.2, -0.1, 0, 0.2, 0.5];

/** A profile whose error bars are `ratio` times its values. Its first `outside` samples are out of range, and the first `gaps` have no value. */
function profile(ratio: number | null, { size = 1, outside = 0, gaps = 0 } = {}): NonNullable<OfferedProfile> {
  return {
    y: STRESS.map((value, k) => (k < gaps ? null : size * value)),
    error_bar: ratio === null ? null : STRESS.map((value, k) => (k < outside || k < gaps ? null : Math.abs(ratio * size * value))),
    in_range: STRESS.map((_, k) => k >= outside && k >= gaps),
  };
}

/** A pseudorandom generator of numbers in [0, 1), the same in each run. */
function random(seed: number): () => number {
  let state = seed;
  return () => {
    state = (state * 16807) % 2147483647;
    return state / 2147483647;
  };
}

describe("the profile of which a model is surest", () => {
  it("has the least error bars of those that are in range, whatever the size of its values", () => {
    const next = random(1);
    for (let trial = 0; trial < 200; ++trial) {
      const ratios = Array.from({ length: 1 + Math.floor(5 * next()) }, () => 0.001 + 0.2 * next());
      const trusted = ratios.map(() => next() < 0.6);
      const profiles = ratios.map((ratio, k) => profile(ratio, { size: 10 ** (6 * next() - 3), outside: trusted[k] ? 0 : 1 + Math.floor(4 * next()) }));
      const min = Math.min(...ratios.filter((_, k) => trusted[k]));
      expect(indexOfMostReliable(profiles)).toBe(trusted.includes(true) ? ratios.indexOf(min) : 0);
    }
  });

  it("is one with error bars rather than one of a model that has none", () => {
    expect(indexOfMostReliable([profile(null), profile(0.3), profile(null)])).toBe(1);
    expect(indexOfMostReliable([profile(0.001, { outside: 1 }), profile(null), profile(null)])).toBe(1);
  });

  it("is the first where no model is trusted, and one that was not to be had never comes before another", () => {
    expect(indexOfMostReliable([profile(0.1, { outside: 2 }), profile(0.01, { outside: 1 })])).toBe(0);
    expect(indexOfMostReliable([profile(0.1, { gaps: 1 }), null])).toBe(0);
    expect(indexOfMostReliable([null, profile(0.2), profile(0.1, { gaps: 2 })])).toBe(1);
    expect(indexOfMostReliable([null, null])).toBe(0);
  });
});

describe("the families that a first target is looked for in", () => {
  const described = (...bars: readonly (number | null)[]) =>
    bars.map((median, k) => ({ id: `m${k}`, error_bars: median === null ? null : { stress: { median } } }) as unknown as Model);

  it("are the first and the one whose model describes the shortest bars of all others", () => {
    const next = random(2);
    for (let trial = 0; trial < 200; ++trial) {
      const models = described(...Array.from({ length: 2 + Math.floor(6 * next()) }, () => (next() < 0.2 ? null : next())));
      const [first, other, ...more] = firstModels(models);
      expect(more).toEqual([]);
      expect(first).toBe(models[0]);
      expect(models.slice(1)).toContain(other);
      const bar = (model: Model) => model.error_bars?.stress.median ?? Infinity;
      expect(bar(other)).toBe(Math.min(...models.slice(1).map(bar)));
    }
  });

  it("are one or none where there are no more", () => {
    expect(firstModels(described(0.1))).toHaveLength(1);
    expect(firstModels([])).toEqual([]);
  });
});

describe("a session without a link", () => {
  const described = { IH01: 0.001, IH21: 0.02, IH22: 0.01, IH28: 0.03 };
  const families = Object.keys(described);
  const models = Object.entries(described).map(([family, median], k) =>
    ({ family, parameters: { lower: [0.1, k], upper: [1.1, k + 1] }, error_bars: { stress: { median } } }) as unknown as Model
  );

  /** Opens a session with a mock of the server that answers with the profile of each family, or with a fault if there is none. */
  async function opened(of: Record<string, OfferedProfile>) {
    const requests: { path: string; body: { family: string; parameters: number[] } }[] = [];
    const client = {
      get: async (path: string) => (path === "/v1/families" ? { families: families.map((id) => ({ id })) } : { models }),
      post: (path: string, body: any) => {
        requests.push({ path, body });
        if (path !== "/v1/profiles") return new Promise(() => {});
        const answer = of[body.family];
        return answer ? Promise.resolve({ x: [-0.1, -0.05, 0, 0.1, 0.2], ...answer }) : Promise.reject(new Error("no such profile"));
      },
      request: () => new Promise(() => {}),
    } as unknown as Client;
    const session = new DesignSession(client);
    await session.start(null);
    return { state: session.state.get(), requests };
  }

  const all = { IH01: profile(0.03, { outside: 1, size: 2 }), IH21: profile(0.04), IH22: profile(0.02, { size: 3 }), IH28: profile(0.05) };

  it("opens with the target that its model is surest of, and a search in its family that starts elsewhere", async () => {
    const { state } = await opened(all);
    expect(state.points.at(-1)).toEqual([0.2, 1.5]);
    expect(state.found).toEqual({ family: "IH22", parameters: [0.4, 2.3] });
    expect(state.fixed).toEqual([false, false]);
  });

  it("asks for one profile more than that of the first family, before the search", async () => {
    const { requests } = await opened(all);
    expect(requests.slice(0, 2).map(({ path, body }) => [path, body.family])).toEqual([["/v1/profiles", "IH01"], ["/v1/profiles", "IH22"]]);
    expect(requests.filter(({ path, body }) => path === "/v1/profiles" && body.parameters[0] === 0.1 + 0.7)).toHaveLength(2);
  });

  it("opens with the first family where its model is surer there, whatever the models say of themselves", async () => {
    const { state } = await opened({ ...all, IH01: profile(0.01, { size: 2 }) });
    expect(state.found?.family).toBe("IH01");
    expect(state.points.at(-1)).toEqual([0.2, 1]);
  });

  it("opens with the first family where no model is trusted", async () => {
    const untrusted = Object.fromEntries(Object.entries(all).map(([family, answer], k) => [family, { ...answer, in_range: answer.in_range.map((_, at) => at !== k) }]));
    const { state } = await opened(untrusted);
    expect(state.found?.family).toBe("IH01");
    expect(state.points.at(-1)).toEqual([0.2, 1]);
  });

  it("opens without a target, which the search tells of, where no profile is to be had", async () => {
    const { state } = await opened({});
    expect(state.found?.family).toBe("IH01");
    expect(state.points).toEqual([]);
  });
});
