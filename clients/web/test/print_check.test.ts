// Whether a weave prints, which the card says, with a mock of the server.
import { afterEach, beforeEach, expect, test, vi } from "vitest";
import { Observable } from "../src/base/observable";
import { Client } from "../src/contract/client";
import { PrintCheck, unprintableWords } from "../src/weave/print_check";
import { DEFAULT_SETTINGS } from "../src/weave/printer";
import type { WeaveSession } from "../src/weave/session";
import { DEFAULT_STATE, type WeaveState } from "../src/weave/state";

const LAYOUT = { strands: [], crossings: [], lattice: null, warnings: [], cost: { seconds: 0, stages: [], quantities: {} } };
const fault = (crossing: number) => ({ pointer: `/weave/crossings/${crossing}`, detail: "has 2 strands that slide; one can be printed" });
const REFUSAL = { type: "about:blank", title: "Not printable", status: 422, code: "weave.not_printable", detail: "The sheet cannot be printed.", errors: [fault(3), fault(7)] };

let refusal: object | null;
let asked: { path: string; request: Record<string, unknown> }[];
let session: { state: Observable<WeaveState>; laidOut: Observable<object | null> };
let check: PrintCheck;

beforeEach(() => {
  vi.useFakeTimers();
  refusal = REFUSAL;
  asked = [];
  vi.stubGlobal("fetch", async (url: string, init: { body: string }) => {
    const path = String(url).replace(/^https?:\/\/[^/]+/, "");
    asked.push({ path, request: JSON.parse(init.body) });
    if (path.endsWith("/v1/weave-layouts")) return Response.json(LAYOUT);
    return refusal ? Response.json(refusal, { status: 422, headers: { "Content-Type": "application/problem+json" } }) : Response.json({ moves: [] });
  });
  session = { state: new Observable<WeaveState>({ ...DEFAULT_STATE, pattern: "actuated_rings" }), laidOut: new Observable<object | null>(null) };
  check = new PrintCheck(session as unknown as WeaveSession, new Observable(DEFAULT_SETTINGS), new Client());
});

afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const rested = () => vi.advanceTimersByTimeAsync(2000);

test("a sheet that does not print says so, with the first place and the number of others", async () => {
  session.laidOut.set(LAYOUT);
  expect(asked).toEqual([]);
  await rested();
  const toolpath = asked.find(({ path }) => path.endsWith("/v1/weave-toolpaths"));
  expect(toolpath?.request).toMatchObject({ priority: "background", include: [] });
  expect(check.words.get()).toMatch(/^This sheet does not print as it is\. Crossing 4.* one can be printed\. So it is at 1 more place\. Print shows where/);
});

test("a sheet that prints says nothing, and a change of the weave takes the sentence back", async () => {
  session.laidOut.set(LAYOUT);
  await rested();
  expect(check.words.get()).not.toBe("");
  session.state.set({ ...session.state.get(), type: 1 });
  expect(check.words.get()).toBe("");
  refusal = null;
  await rested();
  expect(check.words.get()).toBe("");
});

test("what fails for another reason, and a page that is left, say nothing", async () => {
  refusal = { ...REFUSAL, code: "request.invalid" };
  session.laidOut.set(LAYOUT);
  await rested();
  expect(check.words.get()).toBe("");
  const before = asked.length;
  session.laidOut.set({ ...LAYOUT });
  check.end();
  await rested();
  expect(asked.length).toBe(before);
});

test("a refusal without places is told by its sentence", () => {
  expect(unprintableWords({ detail: "A periodic cell has no ends" })).toBe(
    "This sheet does not print as it is. A periodic cell has no ends. Print shows where, and offers repairs.",
  );
});
