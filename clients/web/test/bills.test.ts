import { describe, expect, it } from "vitest";
import { accuracyCost, readCsv } from "../src/base/accuracy_cost";
import { billOf, Bills } from "../src/base/bills";
import { Client } from "../src/contract/client";

const cost = { seconds: 0.2, stages: [{ name: "search", seconds: 0.1, count: 3 }], quantities: { designs: 40 } };

describe("the bill of an answer", () => {
  it("is kept for each endpoint, the newest first", () => {
    const bills = new Bills();
    bills.record("/v1/designs", { family: "IH22", cost, effects: [{ name: "polish" }], accuracy: { tolerance: 1e-6 } });
    bills.record("/v1/profiles?x=1", { cost });
    bills.record("/v1/designs", { family: "IH28", cost });
    bills.record("/v1/models", { models: [] });
    expect(bills.list.get().map((bill) => [bill.path, bill.family])).toEqual([["/v1/designs", "IH28"], ["/v1/profiles", null]]);
    expect(billOf("/v1/x", null)).toBeNull();
  });

  it("is heard of every computation that a client asks for", async () => {
    const bills = new Bills();
    const send = globalThis.fetch;
    globalThis.fetch = async () => new Response(JSON.stringify({ cost }), { headers: { "Content-Type": "application/json" } });
    try {
      await new Client("", undefined, undefined, bills.record).post("/v1/geodesics", {});
    } finally {
      globalThis.fetch = send;
    }
    expect(bills.list.get()[0]?.path).toBe("/v1/geodesics");
  });
});

describe("what accuracy costs", () => {
  it("is read from the tables of the benchmarks, of the family that was asked for", () => {
    expect(readCsv('a,b\n"x, y",2\n,3\n')).toEqual([{ a: "x, y", b: "2" }, { a: "", b: "3" }]);
    const of = accuracyCost("/v1/designs", "IH01");
    expect(of?.rows.length).toBeGreaterThan(5);
    expect(of?.rows.every((row) => row.every((field) => field !== ""))).toBe(true);
    for (const path of ["/v1/geodesics", "/v1/weave-homogenizations", "/v1/embedded-systems", "/v1/voronoi-diagrams", "/v1/simulations"]) {
      expect(accuracyCost(path, null)?.rows.length, path).toBeGreaterThan(1);
    }
    expect(accuracyCost("/v1/profiles", null)).toBeNull();
  });
});
