import { describe, expect, it } from "vitest";
import { NORMAL } from "../src/base/accuracy_choice";
import { commandOf, curlOf, pythonOf } from "../src/design/copy_text";
import { readLink, writeLink } from "../src/design/link";
import { MAX_REGIONS, regionOf, regionsOf, regionWords, withRegions } from "../src/design/region_list";
import { designRequest, regionsRequest } from "../src/design/requests";
import { type ControlPoint, DEFAULT_STATE, type Region } from "../src/design/state";
import { targetOf, withTargets } from "../src/design/target_list";

const line: readonly ControlPoint[] = [[0, 0], [0.1, 1], [0.2, 2]];
const steep: readonly ControlPoint[] = [[0, 0], [0.1, 5]];
const forefoot: Region = { ...regionOf(DEFAULT_STATE), region: "Forefoot", points: line };
const midfoot: Region = {
  ...forefoot,
  ...withTargets([targetOf(forefoot), { ...targetOf(forefoot), direction: 1.5, points: steep }], 1),
  region: "",
  family: "IH22",
  found: { family: "IH22", parameters: [0.25, 0.5] },
  fixed: [true, false],
};
const heel: Region = { ...forefoot, region: "Heel & ankle", points: steep, family: "any", found: { family: "IH28", parameters: [0.3] }, fixed: [false], byHand: true };
const all = [forefoot, midfoot, heel];
const origin = "http://127.0.0.1:8080";

describe("several regions", () => {
  it("stay in their order, whichever is in sight", () => {
    for (const at of [0, 1, 2]) {
      const state = withRegions(all, at);
      expect(regionsOf(state)).toEqual(all);
      expect(regionOf(state)).toEqual(all[at]);
      expect(state).toMatchObject({ ...all[at], regionAt: at });
    }
    expect(withRegions(all, 7).regionAt).toBe(2);
    expect(all.map(regionWords)).toEqual(["Forefoot", "Region 2", "Heel & ankle"]);
  });

  it("are searched one by one while they are edited: a request for the one in sight says nothing of others", () => {
    expect(designRequest(withRegions(all, 1), "search", "s")).toEqual(designRequest(midfoot, "search", "s"));
    expect(designRequest(withRegions(all, 1), "search", "s")).not.toHaveProperty("regions");
  });

  it("are all in one request, each with its targets, and what was set by hand as it is", () => {
    const request = regionsRequest(all, "s");
    expect(request).not.toHaveProperty("task");
    expect(request.effects).toEqual({ multi_start: "automatic", envelope: "on" });
    expect(request.regions).toHaveLength(3);
    expect(request.regions?.[0]).toMatchObject({ name: "Forefoot", family: "any" });
    expect(request.regions?.[1]).toMatchObject({ name: "Region 2", family: "IH22", initial: [0.25, 0.5], fixed: [0.25, null], direction: 1.5, also: [{ direction: 0 }] });
    expect(request.regions?.[2]).toMatchObject({ name: "Heel & ankle", family: "IH28", fixed: [0.3] });
  });

  it("are copied with their targets in the order of the tabs", () => {
    const state = { ...withRegions(all, 2), accuracy: NORMAL };
    const body = JSON.parse(/-d '(.*)'\n$/.exec(curlOf(state, origin))?.[1] ?? "");
    expect(body.regions[1]).toMatchObject({ direction: 0, also: [{ direction: 1.5 }] });
    expect(JSON.parse(/<<'END'\n(.*)\nEND\n/.exec(commandOf(state, origin))?.[1] ?? "")).toEqual(body);
    const program = pythonOf(state, origin);
    expect(program).toContain('name="Region 2", family="IH22", initial=[0.25, 0.5], fixed=[0.25, None]');
    expect(program).toContain("client.design_regions(regions, options=options).regions:");
    expect(program.match(/supple\.Region\(/g)).toHaveLength(3);
    expect(program.match(/supple\.Target\(/g)).toHaveLength(4);
  });

  it("are in a link, and a broken one is no link", () => {
    const state = { ...withRegions(all, 2), accuracy: NORMAL };
    expect(readLink(writeLink(state))).toEqual(state);
    expect(readLink(writeLink(state).replace("region-tab=3", "region-tab=x"))?.regionAt).toBe(0);
    expect(readLink(writeLink(state).replace("region2=task", "region2=tusk"))).toBeNull();
    const one = encodeURIComponent("task=stress_strain&points=0,0;1,1");
    const many = Array.from({ length: 30 }, (_, k) => `region${k + 1}=${one}`).join("&");
    expect(regionsOf(readLink(many) ?? DEFAULT_STATE)).toHaveLength(MAX_REGIONS);
    expect(writeLink({ ...withRegions([forefoot], 0), accuracy: NORMAL })).toMatch(/^task=stress_strain&.*region=Forefoot/);
  });
});
