import { describe, expect, it } from "vitest";
import type { MeasuredCurve } from "../src/contract/types";
import type { Client } from "../src/contract/client";
import { askedPointers, asksForSense, drawnBehind, tableOf, Measured, type MeasuredData, measuredRequest, INITIAL_SETTINGS, notesOf,
  reductionSentence } from "../src/design/measured";
import { textOf } from "../src/base/text_file";
import { DesignSession } from "../src/design/session";
import { DEFAULT_STATE } from "../src/design/state";

const CURVE: MeasuredCurve = {
  task: "stress_strain",
  units: { x: "%", y: "kPa" },
  target: { control_points: [[0, 0], [0.1, 0.2], [0.2, 0.6]], interpolation: "monotone" },
  points: [[0, 0], [0.1, 0.21], [0.2, 0.6]],
  point_count: 500,
  set_aside: 0,
  error: { relative_rms: 0.004, max: 0.01, max_at: 0.1, noise: 0 },
  set_aside_reasons: [],
  notes: [],
  offset: 0,
  message: "",
  accuracy: { tolerance: 0.005, max_control_points: 12 },
  effects: [],
  cost: { seconds: 0.01, stages: [], quantities: {} },
} as unknown as MeasuredCurve;

function data(change: Partial<MeasuredData> = {}): MeasuredData {
  return {
    name: "a.csv",
    table: { text: "1,2" },
    settings: INITIAL_SETTINGS,
    curve: CURVE,
    problem: "",
    pointers: [],
    kind: { task: "stress_strain", measure: "engineering" },
    ...change,
  };
}

describe("the question whether a specimen was pulled or pressed", () => {
  it("is asked where the sense is what is missing, and not for another fault", () => {
    const data = { curve: null, settings: INITIAL_SETTINGS, problem: "The unit of strain must be one of 1, %.", pointers: ["/units/x"] };
    expect(asksForSense(data)).toBe(false);
    expect(asksForSense({ ...data, pointers: ["/units/x", "/sense"] })).toBe(true);
    expect(asksForSense({ ...data, pointers: ["/sense"], settings: { ...INITIAL_SETTINGS, sense: "tension" } })).toBe(false);
    const curve = { sense: { used: "tension", told_by: "nothing" } } as unknown as MeasuredCurve;
    expect(asksForSense({ ...data, curve, problem: "", pointers: [] })).toBe(true);
  });

  it("stands alone: nothing is said to be assumed until it is answered", () => {
    const notes: MeasuredCurve["notes"] = [{ level: "note", text: "3 points were set aside.", pointer: "" }, { level: "note", text: "Tension was assumed.", pointer: "/sense" }];
    const untold = { ...CURVE, sense: { used: "tension", told_by: "nothing" }, notes } as MeasuredCurve;
    expect(notesOf(data({ curve: untold }), "note")).toEqual(["3 points were set aside."]);
    expect(notesOf(data({ curve: untold }), "warning")).toEqual([]);
    const told = { ...untold, sense: { used: "tension", told_by: "request" } } as MeasuredCurve;
    expect(notesOf(data({ curve: told }), "note")).toHaveLength(2);
  });
});

describe("measured data", () => {
  it("asks with the settings that were chosen", () => {
    const request = measuredRequest({ text: "1;2" }, "stress_strain", { columns: { x: 2 }, units: { y: "N" }, specimen: { area: 12 }, controlPoints: 8 });
    expect(request).toEqual({ task: "stress_strain", text: "1;2", columns: { x: 2 }, units: { y: "N" }, specimen: { area: 12 }, accuracy: { max_control_points: 8 } });
  });

  it("is drawn behind profiles of its own kind only", () => {
    expect(drawnBehind(data(), { task: "stress_strain", measure: "engineering" })).toHaveLength(3);
    expect(drawnBehind(data(), { task: "stress_strain", measure: "green" })).toEqual([]);
    expect(drawnBehind(data(), { task: "poisson", measure: "engineering" })).toEqual([]);
    expect(drawnBehind(data({ curve: null }), { task: "stress_strain", measure: "engineering" })).toEqual([]);
    expect(drawnBehind(null, DEFAULT_STATE)).toEqual([]);
    const second = data({ kind: { task: "stress_strain", measure: "engineering", at: 1, regionAt: 0 } });
    expect(drawnBehind(second, { ...DEFAULT_STATE, measure: "engineering", at: 1 })).toHaveLength(3);
    expect(drawnBehind(second, { ...DEFAULT_STATE, measure: "engineering", at: 0 })).toEqual([]);
    expect(drawnBehind(second, { ...DEFAULT_STATE, measure: "engineering", at: 1, regionAt: 1 })).toEqual([]);
  });

  it("says how close the control points come", () => {
    const notes: MeasuredCurve["notes"] = [{ level: "note", text: "3 points were set aside.", pointer: "" }, { level: "warning", text: "Half were.", pointer: "" }];
    const sentence = reductionSentence(CURVE, notesOf(data({ curve: { ...CURVE, notes } }), "note"), String, (fraction) => `${100 * fraction} %`);
    expect(sentence).toBe("3 control points follow 500 measured ones within 0.4 %, at most 0.01 MPa apart. 3 points were set aside.");
  });

  it("reads UTF-8 and what older instruments write", () => {
    expect(textOf(new TextEncoder().encode("µ").buffer as ArrayBuffer)).toBe("µ");
    expect(textOf(new Uint8Array([0xb5]).buffer)).toBe("µ");
  });

  it("sends bytes of other encodings as they are", () => {
    expect(tableOf(new TextEncoder().encode("µ;1").buffer as ArrayBuffer)).toEqual({ text: "µ;1" });
    expect(tableOf(new Uint8Array([0xb5]).buffer)).toEqual({ content: "tQ==" });
    expect(tableOf(new Uint8Array([0x31, 0]).buffer)).toEqual({ content: "MQA=" });
  });

  it("asks for what a file does not tell, and for what was assumed", () => {
    expect([...askedPointers(data({ problem: "units/y: …", pointers: ["/units/y"], curve: null }))]).toEqual(["/units/y"]);
    const assumed = { ...CURVE, notes: [{ level: "note", text: "Tension was assumed.", pointer: "/sense" }] } as MeasuredCurve;
    expect([...askedPointers(data({ curve: assumed }))]).toEqual(["/sense"]);
    const answers = { ...INITIAL_SETTINGS, sense: "compression", decimalSeparator: "comma", zero: "first", block: 1 } as const;
    expect(measuredRequest({ content: "MQA=" }, "stress_strain", answers)).toMatchObject({
      content: "MQA=",
      sense: "compression",
      decimal_separator: "comma",
      zero: "first",
      block: 1,
    });
    expect(measuredRequest({ text: "1" }, "poisson", answers)).not.toHaveProperty("sense");
  });

  it("keeps every change, also those that come before the answer to earlier ones", async () => {
    const requests: any[] = [];
    const client = {
      post: async (path: string, body: unknown) => {
        if (path !== "/v1/measured-curves") return new Promise(() => {});
        requests.push(body);
        return CURVE;
      },
    } as unknown as Client;
    const measured = new Measured(new DesignSession(client), client);
    await measured.read({ text: "0;0" }, "test.csv");
    measured.change({ units: { x: "mm" } });
    measured.change({ units: { y: "N" } });
    measured.change({ specimen: { area: 20 } });
    measured.change({ specimen: { gauge_length: 50 } });
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(requests.at(-1)).toMatchObject({ units: { x: "mm", y: "N" }, specimen: { area: 20, gauge_length: 50 } });
    // The settings of one file do not apply to the next.
    await measured.read({ text: "1;1" }, "other.csv");
    expect(requests.at(-1).specimen ?? {}).toEqual({});
  });

  it("becomes the target, of engineering strain", async () => {
    const requests: unknown[] = [];
    const client = {
      post: async (path: string, body: unknown) => {
        requests.push([path, body]);
        return path === "/v1/measured-curves" ? CURVE : new Promise(() => {});
      },
    } as unknown as Client;
    const session = new DesignSession(client);
    const measured = new Measured(session, client);
    await measured.read({ text: "0;0" }, "test.csv");
    expect(measured.data.get()?.curve).toBe(CURVE);
    expect(session.state.get()).toMatchObject({ points: [[0, 0], [0.1, 0.2], [0.2, 0.6]], interpolation: "monotone", measure: "engineering" });
    measured.change({ controlPoints: 5 });
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect((requests.filter(([path]: any) => path === "/v1/measured-curves")[1] as any)[1].accuracy.max_control_points).toBe(5);
    measured.remove();
    expect(measured.data.get()).toBeNull();
  });
});
