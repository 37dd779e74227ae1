import { describe, expect, it } from "vitest";
import type { DesignAnswer, Profile } from "../src/contract/types";
import { commandOf, curlOf, pythonOf } from "../src/design/copy_text";
import { jsonOf } from "../src/design/exports";
import { readLink, writeLink } from "../src/design/link";
import { designRequest, polishRequest, verificationRequest } from "../src/design/requests";
import { freshness, overallDeviation, designResponses, profileResponses } from "../src/design/shown";
import { type ControlPoint, DEFAULT_STATE, type DesignState, type Target } from "../src/design/state";
import { askedOrder, furtherTarget, MAX_TARGETS, sameTargets, targetOf, targetsOf, targetWords, withTargets } from "../src/design/target_list";

const line: readonly ControlPoint[] = [[0, 0], [0.1, 1], [0.2, 2]];
const ring: readonly ControlPoint[] = [[0, 0.1], [1, 0.2], [2, 0.3]];
const along: Target = { ...targetOf(DEFAULT_STATE), points: line };
const across: Target = { ...along, name: "Across", direction: Math.PI / 2, weight: 3 };
const ratio: Target = { ...along, task: "poisson", points: ring };
const all = [along, across, ratio];
const state: DesignState = { ...DEFAULT_STATE, ...withTargets(all, 1), family: "IH22", found: { family: "IH22", parameters: [0.3] }, fixed: [false] };

describe("several targets", () => {
  it("stay in their order, whichever is in sight", () => {
    for (const at of [0, 1, 2]) {
      const one = { ...state, ...withTargets(targetsOf(state), at) };
      expect(targetsOf(one)).toEqual(all);
      expect(one).toMatchObject({ ...all[at], at });
      expect(askedOrder(one)).toEqual([at, ...[0, 1, 2].filter((k) => k !== at)]);
    }
    expect(withTargets(all, 9).at).toBe(2);
    expect(withTargets(all, 0.6).at).toBe(1);
  });

  it("are the same whatever they are called, and others with another curve, kind, weight or order", () => {
    expect(sameTargets(all, [along, { ...across, name: "Sideways" }, ratio])).toBe(true);
    const changed = [{ weight: 1 }, { points: [...line] }, { direction: 1 }].map((change) => [along, { ...across, ...change }, ratio]);
    for (const other of [[along, across], [across, along, ratio], ...changed]) expect(sameTargets(all, other)).toBe(false);
  });

  it("are called by their name, or by what they show", () => {
    expect(all.map(targetWords)).toEqual(["Stress, 0°", "Across", "Poisson’s ratio, at 0.05"]);
  });

  it("begin in a direction or at a strain that none of them has", () => {
    const directions = [along];
    for (let k = 0; k < 3; ++k) directions.push(furtherTarget(directions, along));
    expect(directions.map((target) => Math.round((target.direction * 180) / Math.PI))).toEqual([0, 90, 45, 135]);
    expect(furtherTarget([ratio], ratio)).toMatchObject({ task: "poisson", strain: 0.07, name: "", weight: 1 });
  });
});

describe("a request with several targets", () => {
  it("has all of them at once, the one in sight first", () => {
    const request = designRequest(state, "search", "s");
    expect(request).toMatchObject({ task: "stress_strain", direction: Math.PI / 2, weight: 3, family: "IH22" });
    expect(request.also).toMatchObject([{ task: "stress_strain", direction: 0, samples: 31, target: { control_points: [[0, 0], [0.1, 1], [0.2, 2]] } }, {
      task: "poisson",
      strain: 0.05,
      samples: 60,
    }]);
    expect(request.also?.[0]).not.toHaveProperty("weight");
    const found = { family: "IH22", parameters: [0.3] };
    for (const other of [designRequest(state, "follow", "s"), verificationRequest(state, found), polishRequest(state, found)]) expect(other.also).toHaveLength(2);
    expect(designRequest({ ...state, ...withTargets([along], 0) }, "search", "s")).not.toHaveProperty("also");
  });

  it("is copied with its targets in the order of the tabs", () => {
    const origin = "http://127.0.0.1:8080";
    const body = JSON.parse(/-d '(.*)'\n$/.exec(curlOf(state, origin))?.[1] ?? "");
    expect(body.direction).toBe(0);
    expect(body.also.map((target: { task: string }) => target.task)).toEqual(["stress_strain", "poisson"]);
    const command = commandOf(state, origin);
    expect(JSON.parse(/<<'END'\n(.*)\nEND\n/.exec(command)?.[1] ?? "")).toEqual(body);
    expect(command).toMatch(/supple --server http:\/\/127.0.0.1:8080 design --request design.json\n$/);
    const program = pythonOf(state, origin);
    expect(program).toContain('also = [\n    supple.Target("stress_strain", [[0, 0], [0.1, 1], [0.2, 2]], direction=1.5707963267948966');
    expect(program).toContain('weight=3),\n    supple.Target("poisson"');
    expect(program).toContain('client.design(target, also=also, family="IH22", initial=[0.3], options=options)');
  });
});

describe("a link with several targets", () => {
  it("brings them back with their names, weights and the one in sight", () => {
    const named = { ...state, name: "100 % & äöü=;" };
    const read = readLink(writeLink(named));
    expect(read).toMatchObject({ at: 1, name: named.name, weight: 3 });
    expect(read && targetsOf(read).map((target) => target.points)).toEqual(all.map((target) => target.points));
    expect(read && targetsOf(read).map((target) => Number(target.direction.toFixed(6)))).toEqual([0, 1.570796, 0]);
  });

  it("is none where a target is broken, and has the first one in sight where there is no such tab", () => {
    const link = writeLink(state);
    expect(readLink(link.replace("points2=0,0", "points2=x"))).toBeNull();
    expect(readLink(link.replace("tab=2", "tab=7"))?.at).toBe(0);
    expect(readLink(link.replace("weight2=3", "weight2=1e9"))?.weight).toBe(1);
    const many = Array.from({ length: 12 }, (_, k) => `task${k + 1}=stress_strain&points${k + 1}=0,0;1,1`).join("&").replace("task1", "task").replace("points1", "points");
    expect(targetsOf(readLink(many) ?? DEFAULT_STATE)).toHaveLength(MAX_TARGETS);
  });
});

describe("what a design does about several targets", () => {
  const profile = (x: number[], target: number[], achieved: number[]) => ({
    x,
    target,
    achieved,
    initial: achieved,
    error_bar: null,
    in_range: x.map(() => true),
    reached: x.map(() => false),
    verified: null,
    envelope: null,
  });
  const answer = {
    family: "IH22",
    parameters: [0.3],
    model: "m",
    orientation: 0,
    material: { youngs_modulus: 26, density: 1.2 },
    structure: null,
    error: { relative_rms: 0.4, max: 0.2 },
    message: "",
    stopped: "converged",
    iterations: 3,
    ranking: [],
    cost: { seconds: 1 },
    profile: profile([0, 0.1, 0.2], [0, 1, 2], [0, 1.1, 2.2]),
    also: [profile([0, 0.1, 0.2], [0, 1, 2], [0, 0.5, 1]), profile([0, 1, 2], [0.1, 0.2, 0.3], [0.1, 0.2, 0.3])],
  } as unknown as DesignAnswer;

  it("is told in the order of the tabs, each with its own deviation", () => {
    const shown = designResponses(answer, state);
    expect(shown.map((one) => Number(one.deviation.toFixed(9)))).toEqual([0.5, 0.1, 0]);
    expect(shown.map((one) => one.name)).toEqual(["", "Across", ""]);
    expect(shown.map((one) => one.overall)).toEqual([0.4, 0.4, 0.4]);
    expect(shown[1].largest).toBe(0.2);
    expect(shown[0].largest).toBe(1);
  });

  it("is of an earlier decision as soon as any target is another one", () => {
    const shown = designResponses(answer, state);
    expect(freshness(shown[1], state)).toBe("current");
    expect(freshness(shown[0], { ...state, ...withTargets(all, 0) })).toBe("current");
    expect(freshness(shown[1], { ...state, ...withTargets([{ ...along, points: [...line] }, across, ratio], 1) })).toBe("outdated");
    expect(freshness(shown[1], { ...state, name: "Renamed" })).toBe("current");
  });

  it("of parameters set by hand is weighed as a search weighs it", () => {
    const profiles = all.map(({ points }) =>
      ({
        family: "IH22",
        parameters: [0.3],
        model: "m",
        x: points.map(([x]) => x),
        y: points.map(([, y]) => 2 * y),
        error_bar: [],
        in_range: [],
        cost: { seconds: 1 },
      }) as unknown as Profile
    );
    const shown = profileResponses(profiles, state);
    expect(shown.map((one) => one.seconds)).toEqual([3, 3, 3]);
    expect(shown[0].overall).toBeCloseTo(1, 9);
    expect(overallDeviation([{ deviation: 0.1, weight: 3 }, { deviation: 0.5, weight: 1 }])).toBeCloseTo(Math.sqrt((0.03 + 0.25) / 4), 12);
  });

  it("is saved with all targets", () => {
    const shown = designResponses(answer, state);
    const document = JSON.parse(jsonOf(shown[1], null, [shown[0], shown[2]]));
    expect(document).toMatchObject({ name: "Across", direction: Math.PI / 2, weight: 3, overall: { relative_rms: 0.4 } });
    expect(document.also.map((target: { task: string }) => target.task)).toEqual(["stress_strain", "poisson"]);
    expect(JSON.parse(jsonOf(shown[1], null))).not.toHaveProperty("also");
  });
});
