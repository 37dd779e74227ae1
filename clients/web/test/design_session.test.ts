// The design session with a mock of the server, whose searches answer when the test says so.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client } from "../src/contract/client";
import type { DesignRequest } from "../src/contract/types";
import { DesignSession } from "../src/design/session";
import { DEFAULT_STATE, type DesignState } from "../src/design/state";

const X = [0, 0.1, 0.2];
const LINKED: DesignState = {
  ...DEFAULT_STATE,
  points: [[0, 0], [0.2, 2]],
  family: "IH21",
  found: { family: "IH21", parameters: [0.5] },
  fixed: [false],
};

/** Searches that wait for their answer. */
let searches: { request: DesignRequest; answer: (document: object, status?: number) => void; wasAborted: () => boolean }[];

function profile(scale: number): object {
  return {
    task: "stress_strain",
    x: X,
    achieved: X.map((x) => scale * x),
    initial: X.map((x) => x),
    target: X.map((x) => 10 * x),
    error_bar: null,
    in_range: [true, true, true],
    reached: [true, true, true],
    envelope: null,
  };
}

/** A design with one parameter, whose response is a line. */
function design(parameter: number, targets = 1): object {
  return {
    family: "IH21",
    parameters: [parameter],
    model: "m",
    material: { youngs_modulus: 26, density: 1.2 },
    orientation: 0,
    structure: null,
    profile: profile(10 * parameter),
    also: Array.from({ length: targets - 1 }, (_, k) => profile(k + 1)),
    error: { relative_rms: 0.1, max: 0.1 },
    message: "",
    stopped: "converged",
    iterations: 3,
    ranking: [],
    cost: { seconds: 0.1, stages: [], quantities: {} },
  };
}

async function serve(url: string, init: RequestInit = {}): Promise<Response> {
  const path = String(url);
  if (path === "/v1/families") return Response.json({ families: [{ id: "IH21" }] });
  if (path === "/v1/models") return Response.json({ models: [{ id: "m", family: "IH21", parameters: { lower: [0], upper: [1] } }] });
  if (path === "/v1/profiles") {
    return Response.json({ ...profile(5), family: "IH21", parameters: [0.5], model: "m", y: X.map((x) => 5 * x), cost: { seconds: 0.01, stages: [], quantities: {} } });
  }
  if (path === "/v1/structures") return Response.json({ type: "about:blank", status: 422, code: "tiling.invalid", title: "t", detail: "d" }, { status: 500 });
  if (path !== "/v1/designs") return Response.json({});
  return new Promise((resolve, reject) => {
    let aborted = false;
    init.signal?.addEventListener("abort", () => {
      aborted = true;
      reject(new DOMException("stopped", "AbortError"));
    });
    const answer = (document: object, status = 200) => {
      const type = status < 400 ? "application/json" : "application/problem+json";
      resolve(new Response(JSON.stringify(document), { status, headers: { "Content-Type": type } }));
    };
    searches.push({ request: JSON.parse(String(init.body)) as DesignRequest, answer, wasAborted: () => aborted });
  });
}

beforeEach(() => {
  searches = [];
  vi.stubGlobal("fetch", serve);
});
afterEach(() => vi.unstubAllGlobals());

async function started(): Promise<DesignSession> {
  const session = new DesignSession(new Client());
  await session.start(LINKED);
  await searching(1);
  return session;
}

const searching = (count: number) => vi.waitFor(() => expect(searches).toHaveLength(count));
const idle = (session: DesignSession) => vi.waitFor(() => expect(session.search.activity.get()).toEqual({ kind: "idle" }));

describe("a design session", () => {
  it("shows the answer to its state, and makes each change a step that can be undone", async () => {
    const session = await started();
    searches[0].answer(design(0.7));
    await idle(session);
    expect(session.results.isCurrent).toBe(true);
    expect(session.state.get().found?.parameters).toEqual([0.7]);
    session.apply({ points: [[0, 0], [0.2, 3]] });
    await searching(2);
    expect(session.results.isCurrent).toBe(false);
    expect(session.steps.get()).toEqual({ undo: true, redo: false });
    session.undo();
    await searching(3);
    expect(searches[1].wasAborted()).toBe(true);
    expect(session.state.get().points).toBe(LINKED.points);
    expect(session.state.get().found?.parameters).toEqual([0.7]);
  });

  it("stops a search for a drag, whose requests follow each other, and ends with a search", async () => {
    const session = await started();
    for (const y of [2.1, 2.2, 2.3]) session.preview({ points: [[0, 0], [0.2, y]] });
    expect(searches[0].wasAborted()).toBe(true);
    await searching(2);
    for (const y of [2.4, 2.5]) session.preview({ points: [[0, 0], [0.2, y]] });
    searches[1].answer(design(0.6));
    await searching(3);
    expect(searches.slice(1).map(({ request }) => request.target?.control_points.at(-1)?.[1])).toEqual([2.3, 2.5]);
    expect(searches[2].request.effects?.multi_start).toBe("off");
    session.finish();
    await searching(4);
    expect(searches[3].request.effects?.multi_start).toBe("automatic");
    expect(new Set(searches.map(({ request }) => request.session)).size).toBe(1);
  });

  it("repeats a search that the server has replaced by an aborted one, and tells other faults", async () => {
    const session = await started();
    searches[0].answer({ status: 409, code: "design.superseded", title: "t", detail: "d" }, 409);
    await searching(2);
    searches[1].answer({ status: 422, code: "design.infeasible", title: "t", detail: "No design exists." }, 422);
    await vi.waitFor(() => expect(session.search.activity.get()).toMatchObject({ kind: "failed", sentence: "No design exists." }));
    session.search.retry();
    await searching(3);
  });

  it("keeps the best design of a search that the user stops, and searches again on demand", async () => {
    const session = await started();
    await vi.waitFor(() => expect(session.results.shown.get()?.provisional).toBe(true));
    session.search.cancel();
    expect(session.search.activity.get()).toEqual({ kind: "stopped" });
    expect(session.results.shown.get()).toMatchObject({ provisional: false, message: expect.stringMatching(/stopped/) as string });
    session.search.retry();
    await searching(2);
  });
});

describe("targets of a session", () => {
  it("are added on the response of the design, selected without a request, and removed with their results", async () => {
    const session = await started();
    searches[0].answer(design(0.7));
    await idle(session);
    await session.targetEdits.add();
    expect(session.targets).toHaveLength(2);
    expect(session.targets[1]).toMatchObject({ direction: Math.PI / 2, points: [[0, 0], [0.1, 0.5], [0.2, 1]] });
    await searching(2);
    searches[1].answer(design(0.8, 2));
    await idle(session);
    expect(session.results.all.get()).toHaveLength(2);
    session.targetEdits.select(0);
    expect(session.results.shown.get()).toBe(session.results.all.get()[0]);
    expect(searches).toHaveLength(2);
    session.targetEdits.remove(1);
    expect(session.results.all.get()).toHaveLength(1);
    expect(session.state.get().others).toEqual([]);
  });
});

describe("regions of a session", () => {
  it("have results of their own, which are shown again without a request", async () => {
    const session = await started();
    searches[0].answer(design(0.7));
    await idle(session);
    const first = session.results.shown.get();
    session.regionEdits.add();
    expect(session.regionEdits.all).toHaveLength(2);
    expect(session.results.shown.get()).toBe(first);
    session.apply({ points: [[0, 0], [0.2, 4]] });
    await searching(2);
    searches[1].answer(design(0.9));
    await idle(session);
    session.regionEdits.select(0);
    expect(session.results.shown.get()).toBe(first);
    expect(session.state.get().found?.parameters).toEqual([0.7]);
    expect(searches).toHaveLength(2);
    expect(session.results.ofRegions.map((region) => region?.length)).toEqual([1, 1]);
    session.regionEdits.remove(0);
    expect(session.state.get().found?.parameters).toEqual([0.9]);
    expect(session.results.shown.get()?.found.parameters).toEqual([0.9]);
  });

  it("are made of the names of a drawing, as copies of the selected one that need no search", async () => {
    const session = await started();
    searches[0].answer(design(0.7));
    await idle(session);
    session.rename({ region: "Heel" });
    session.regionEdits.make(["arch", "heel", "Rest"]);
    expect(session.regionEdits.all.map(({ region }) => region)).toEqual(["arch", "heel", "Rest"]);
    expect(session.regionEdits.all.map(({ found }) => found?.parameters)).toEqual([[0.7], [0.7], [0.7]]);
    expect(session.results.ofRegions.map((region) => region?.length)).toEqual([1, 1, 1]);
    expect(searches).toHaveLength(1);
  });

  it("are searched for in one request", async () => {
    const session = await started();
    searches[0].answer(design(0.7));
    await idle(session);
    session.regionEdits.add();
    session.regionEdits.searchAll();
    await searching(2);
    expect(searches[1].request.regions).toHaveLength(2);
    searches[1].answer({ regions: [design(0.2), design(0.3)], cost: { seconds: 1, stages: [], quantities: {} } });
    await idle(session);
    expect(session.regionEdits.all.map(({ found }) => found?.parameters)).toEqual([[0.2], [0.3]]);
    expect(session.results.shown.get()?.found.parameters).toEqual([0.3]);
  });
});
