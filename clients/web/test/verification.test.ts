// Verifications of a design session with a mock of the server, whose searches answer at once and whose jobs end when the test says so.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client } from "../src/contract/client";
import type { DesignRequest } from "../src/contract/types";
import { Background, REST_MS } from "../src/design/background";
import { judgedDesign } from "../src/design/judged";
import { DesignSession } from "../src/design/session";
import type { TargetResponse } from "../src/design/shown";
import { Simulations } from "../src/design/simulations";
import { DEFAULT_STATE, type DesignState } from "../src/design/state";
import { targetOf } from "../src/design/target_list";
import { Verification } from "../src/design/verification";
import { type WayOut, WaysOut } from "../src/design/ways_out";

const X = [0, 0.1, 0.2];
const LINKED: DesignState = { ...DEFAULT_STATE, points: [[0, 0], [0.2, 2]], family: "IH21", found: { family: "IH21", parameters: [0.5] }, fixed: [false] };
const TWO_TARGETS: DesignState = { ...LINKED, others: [{ ...targetOf(LINKED), direction: 0.5 }] };
const WAY: WayOut = {
  change: "turn",
  sentence: "Turn the tiling by 82 degrees: 3.5 % instead of 55 % by the model.",
  family: "IH21",
  parameters: [0.31],
  orientation: 1.43,
  youngs_modulus: 26,
  range: null,
  deviation: 0.035,
};

type JobRequest = DesignRequest & { priority?: string; effects?: { ways_out?: string; polish?: string } };

interface MockJob {
  readonly id: string;
  readonly request: JobRequest;
  document: { state: string; progress: number; remaining_seconds?: number; partial?: object };
  result: object | null;
}

/** Everything that the page has asked the mock server for. */
let jobs: MockJob[];
let dismissed: string[];
/** The searched designs have this parameter, and their response is a line of the slope 10. */
let parameter: number;

const curve = (slope: number) => X.map((x) => slope * x);

function profile(slope: number, verified: number | null = null): object {
  return {
    task: "stress_strain",
    x: X,
    achieved: curve(slope),
    initial: curve(1),
    target: curve(10),
    error_bar: null,
    in_range: [true, true, true],
    reached: [true, true, true],
    envelope: null,
    verified: verified === null ? null : { x: X, target: curve(10), y: curve(verified), model: curve(slope), relative_rms: 0.3, target_error: 0.4, discretization_error: 0.001 },
  };
}

function design(slope: number, verified: number | null = null, more: object = {}): object {
  return {
    family: "IH21",
    parameters: [parameter],
    model: "m",
    material: { youngs_modulus: 26, density: 1.2 },
    orientation: 0,
    structure: null,
    profile: profile(slope, verified),
    also: [],
    error: { relative_rms: Math.abs(slope - 10) / 10, max: 0.1 },
    message: "",
    stopped: "converged",
    iterations: 3,
    ranking: [],
    polish: verified === null ? null : { target_error: 0.4, stopped: "round_limit", rounds: [] },
    ways_out: [],
    cost: { seconds: 0.1, stages: [], quantities: {} },
    ...more,
  };
}

/** The slope of the responses of searched designs. */
let slope: number;
/** With what the mock server answers all requests for jobs and after jobs: a status, 0 for a lost connection, or null if it serves them. */
let refusal: number | null;

async function serve(url: string, init: RequestInit = {}): Promise<Response> {
  const path = String(url);
  if (path === "/v1/families") return Response.json({ families: [{ id: "IH21" }] });
  if (path === "/v1/models") return Response.json({ models: [{ id: "m", family: "IH21", errors: {}, parameters: { lower: [0], upper: [1] } }] });
  if (path === "/v1/profiles") {
    const asked = JSON.parse(String(init.body)) as { parameters: number[] };
    return Response.json({ ...profile(slope), family: "IH21", parameters: asked.parameters, model: "m", y: curve(slope), cost: { seconds: 0.01, stages: [], quantities: {} } });
  }
  if (path === "/v1/structures") return problem(422);
  const isOfJob = path.startsWith("/v1/jobs/") || new Headers(init.headers).get("Prefer") === "respond-async";
  if (isOfJob && refusal === 0) throw new TypeError("no connection");
  if (isOfJob && refusal !== null) return problem(refusal);
  const [, id, result] = /^\/v1\/jobs\/([\w-]+)(\/\w+)?$/.exec(path) ?? [];
  if (id) return answerOfJob(id, result, init.method ?? "GET");
  if (path !== "/v1/designs" && path !== "/v1/simulations") return Response.json({});
  const request = JSON.parse(String(init.body)) as JobRequest;
  if (new Headers(init.headers).get("Prefer") !== "respond-async") return Response.json(design(slope, null, { also: (request.also ?? []).map(() => profile(slope)) }));
  const job: MockJob = { id: `job-${jobs.length + 1}`, request, document: { state: "running", progress: 0 }, result: null };
  jobs.push(job);
  return Response.json({ id: job.id, kind: "designs", stage: "", created: "", deadline: 60, ...job.document }, { status: 202 });
}

function answerOfJob(id: string, result: string | undefined, method: string): Response {
  const job = jobs.find((one) => one.id === id);
  if (!job) return problem(404);
  if (dismissed.includes(id)) return problem(410, "job.dismissed");
  if (method === "DELETE") {
    dismissed.push(id);
    return Response.json({});
  }
  if (result === "/events") return problem(503);
  if (result === "/result") return Response.json(job.result);
  return Response.json({ id, kind: "designs", stage: "simulating", created: "", deadline: 60, ...job.document });
}

function problem(status: number, code = "x.y"): Response {
  return new Response(JSON.stringify({ type: "about:blank", status, code, title: "t", detail: "d" }), { status, headers: { "Content-Type": "application/problem+json" } });
}

function finish(job: MockJob, result: object): void {
  job.result = result;
  job.document = { state: "successful", progress: 1 };
}

// A busy machine has time.
vi.setConfig({ testTimeout: 120_000 });

const storage = new Map<string, string>();

beforeEach(() => {
  [jobs, dismissed, parameter, slope, refusal] = [[], [], 0.7, 10.3, null];
  storage.clear();
  vi.useFakeTimers();
  vi.stubGlobal("fetch", serve);
  vi.stubGlobal("localStorage", {
    getItem: (key: string) => storage.get(key) ?? null,
    setItem: (key: string, value: string) => void storage.set(key, value),
    removeItem: (key: string) => void storage.delete(key),
  });
});
afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

interface Opened {
  readonly session: DesignSession;
  readonly verification: Verification;
  readonly waysOut: WaysOut;
  readonly background: Background;
  hide(isHidden: boolean): void;
}

/** A page that was opened with a link. Its requests that answer at once are answered. */
async function opened(linked: DesignState = LINKED): Promise<Opened> {
  const client = new Client();
  const session = new DesignSession(client);
  const verification = new Verification(session, client, new Simulations());
  const waysOut = new WaysOut(session, client);
  let hidden = false;
  let seen = (): void => {};
  const background = new Background(session, verification, waysOut, {
    isHidden: () => hidden,
    watch(changed) {
      seen = changed;
    },
  });
  await session.start(linked);
  await pass(10);
  return {
    session,
    verification,
    waysOut,
    background,
    hide(isHidden) {
      hidden = isHidden;
      seen();
    },
  };
}

/** Lets time pass, and with it what waits for answers. */
const pass = (ms: number) => vi.advanceTimersByTimeAsync(ms);

const shownJudgement = ({ session, verification }: Opened) => {
  const shown = session.results.shown.get();
  return shown && judgedDesign(session, verification, shown);
};

describe("a verification in the background", () => {
  it("begins once the target rests, at the lowest priority, and its result outranks the model", async () => {
    const page = await opened();
    expect(shownJudgement(page)).toMatchObject({ grade: "reached", source: "model" });
    await pass(REST_MS - 100);
    expect(jobs).toHaveLength(0);
    await pass(200);
    expect(jobs).toHaveLength(1);
    expect(jobs[0].request).toMatchObject({ verify: true, priority: "background", fixed: [0.7], effects: { ways_out: "off" } });
    jobs[0].document = { state: "running", progress: 0.4, remaining_seconds: 12 };
    await pass(1000);
    expect(page.verification.state.get()).toMatchObject({ kind: "running", isBackground: true, progress: 0.4, remaining: 12 });
    finish(jobs[0], design(10.3, 14.5));
    await pass(1000);
    expect(page.verification.state.get().kind).toBe("done");
    expect(shownJudgement(page)).toMatchObject({ grade: "missed", source: "simulation" });
    expect(shownJudgement(page)?.sentence).toMatch(/^Simulated: 45 % off\./);
    await pass(3 * REST_MS);
    expect(jobs.filter(({ request }) => request.verify)).toHaveLength(1);
  });

  it("is dropped when the target changes, and begins anew for the new one", async () => {
    const { session, verification } = await opened();
    await pass(REST_MS + 100);
    parameter = 0.72;
    session.apply({ points: [[0, 0], [0.2, 2.02]] });
    expect(verification.state.get().kind).toBe("none");
    await pass(10);
    expect(dismissed).toEqual(["job-1"]);
    await pass(REST_MS + 100);
    expect(jobs.at(-1)?.request.fixed).toEqual([0.72]);
  });

  it("does not begin while a point is dragged, where the page is hidden, where it is switched off, or after it was stopped", async () => {
    const { session, verification, background, hide } = await opened();
    session.gesture();
    await pass(2 * REST_MS);
    expect(jobs).toHaveLength(0);
    hide(true);
    session.finish();
    await pass(2 * REST_MS);
    expect(jobs).toHaveLength(0);
    background.switch(false);
    hide(false);
    await pass(2 * REST_MS);
    expect(jobs).toHaveLength(0);
    expect(storage.get("supple-background")).toBe("off");
    background.switch(true);
    await pass(REST_MS + 100);
    expect(jobs).toHaveLength(1);
    verification.cancel();
    await pass(2 * REST_MS);
    expect([jobs.length, dismissed]).toEqual([1, ["job-1"]]);
  });

  it("begins again after it was switched off and on", async () => {
    const { background } = await opened();
    await pass(REST_MS + 100);
    background.switch(false);
    await pass(2 * REST_MS);
    expect([jobs.length, dismissed]).toEqual([1, ["job-1"]]);
    background.switch(true);
    await pass(REST_MS + 100);
    expect(jobs).toHaveLength(2);
  });

  it("is dropped when the direction of the target changes, and goes on when the size does", async () => {
    const { session, verification } = await opened();
    await pass(REST_MS + 100);
    session.apply({ made: { ...session.state.get().made, size: { kind: "cell_size", value: 5 } } });
    expect(verification.state.get().kind).toBe("running");
    session.apply({ direction: 0.5 });
    expect(verification.state.get().kind).toBe("none");
    await pass(10);
    expect(dismissed).toEqual(["job-1"]);
  });

  it.each([429, 503, 0])("waits for a server that answers %i, without a complaint, longer each time", async (status) => {
    const { verification, background } = await opened();
    refusal = status;
    const asked = vi.fn(serve);
    vi.stubGlobal("fetch", asked);
    const attempts = () => asked.mock.calls.filter(([, init]) => new Headers(init?.headers).get("Prefer") === "respond-async").length;
    await pass(REST_MS + 100);
    expect([attempts(), verification.state.get().kind]).toEqual([1, "none"]);
    await pass(29_000);
    expect(attempts()).toBe(1);
    await pass(2000);
    expect([attempts(), verification.state.get().kind]).toEqual([2, "none"]);
    await pass(55_000);
    expect(attempts()).toBe(2);
    refusal = null;
    background.reconnected();
    await pass(REST_MS + 100);
    expect([attempts(), verification.state.get().kind]).toEqual([3, "running"]);
  });

  it("is found again after a lost connection, and no second job is begun", async () => {
    const { verification, background } = await opened();
    await pass(REST_MS + 100);
    refusal = 0;
    await pass(1000);
    expect(verification.state.get().kind).toBe("none");
    refusal = null;
    void verification.verify({ background: true });
    await pass(100);
    expect([jobs.length, verification.state.get().kind]).toEqual([1, "running"]);
    background.reconnected();
    finish(jobs[0], design(10.3, 14.5));
    await pass(1000);
    expect([jobs.length, verification.state.get().kind]).toEqual([1, "done"]);
  });

  it("begins anew with the user's priority if the user asks for it meanwhile", async () => {
    const { verification } = await opened();
    await pass(REST_MS + 100);
    void verification.verify();
    await pass(10);
    expect(dismissed).toEqual(["job-1"]);
    expect(jobs).toHaveLength(2);
    expect(jobs[1].request).not.toHaveProperty("priority");
    expect(verification.state.get()).toMatchObject({ kind: "running", isBackground: false });
  });

  it("goes on for the user who asks for it when most of it is done", async () => {
    const { verification } = await opened();
    await pass(REST_MS + 100);
    jobs[0].document = { state: "running", progress: 0.6 };
    await pass(1000);
    await verification.verify();
    expect([jobs.length, dismissed]).toEqual([1, []]);
    expect(verification.state.get()).toMatchObject({ kind: "running", isBackground: false });
  });
});

describe("a response to an earlier state", () => {
  it("is not verified: its curve would be stored for another material", async () => {
    const { session, verification, background } = await opened();
    background.switch(false);
    session.apply({ made: { ...session.state.get().made, youngsModulus: 40 } });
    void verification.verify();
    void verification.polish();
    expect(verification.state.get().kind).toBe("none");
    expect(jobs).toHaveLength(0);
  });
});

describe("a search that was stopped", () => {
  /** A page whose search has a best design so far. Its later searches do not end. */
  async function stopped(linked: DesignState): Promise<Opened> {
    const page = await opened(linked);
    const { session } = page;
    const shown = session.results.shown.get() as TargetResponse;
    session.results.acceptPartial({ ...shown, found: { family: "IH21", parameters: [0.4] }, provisional: true, inRange: [true, true, true] }, session.state.get());
    session.results.finalizePartial();
    return page;
  }

  it("has a result that is not certain, since nothing tells where the model is trusted", async () => {
    expect(shownJudgement(await stopped(LINKED))?.grade).toBe("unknown");
  });

  it("is not judged by the responses of another design to the other targets", async () => {
    slope = 15;
    expect(shownJudgement(await stopped(TWO_TARGETS))).toMatchObject({ grade: "unknown", sentence: "Not all targets of this design are known yet." });
  });
});

describe("a simulated curve", () => {
  async function verified(): Promise<Opened> {
    const page = await opened();
    await pass(REST_MS + 100);
    finish(jobs[0], design(10.3, 14.5));
    await pass(1000);
    expect(shownJudgement(page)?.source).toBe("simulation");
    return page;
  }

  it("stays when the size changes, and comes back with undo and with another target's tab", async () => {
    const page = await verified();
    const { session, verification } = page;
    session.apply({ made: { ...session.state.get().made, size: { kind: "cell_size", value: 5 } } });
    await pass(100);
    expect(shownJudgement(page)?.source).toBe("simulation");
    parameter = 0.1;
    session.apply({ points: [[0, 0], [0.2, 4]] });
    await pass(100);
    expect(shownJudgement(page)?.source).toBe("model");
    parameter = 0.70001; // a search that is repeated ends a little elsewhere
    session.undo();
    await pass(100);
    expect(shownJudgement(page)).toMatchObject({ source: "simulation", grade: "missed" });
    expect(verification.simulated?.curve.y).toEqual(curve(14.5));
  });

  it("survives a reload, whose link has rounded the parameters", async () => {
    await verified();
    parameter = 0.70000001;
    const again = await opened({ ...LINKED, found: { family: "IH21", parameters: [0.70000001] } });
    expect(shownJudgement(again)).toMatchObject({ source: "simulation", grade: "missed" });
    await pass(2 * REST_MS);
    expect(jobs.filter(({ request }) => request.verify)).toHaveLength(1);
  });

  it("is left out of the browser's storage if its polish has no rounds", async () => {
    await verified();
    const text = storage.get("supple-simulations") as string;
    expect(new Simulations().list.get()).toHaveLength(1);
    storage.set("supple-simulations", text.replace('"rounds":[]', '"round":[]'));
    expect(new Simulations().list.get()).toHaveLength(0);
  });

  it("is not that of another material, another direction or another range", async () => {
    const page = await verified();
    const { session } = page;
    for (const change of [{ made: { ...LINKED.made, youngsModulus: 40 } }, { direction: 0.5 }, { points: [[0, 0], [0.3, 3]] as const }]) {
      session.apply(change);
      await pass(100);
      expect(shownJudgement(page)?.source).toBe("model");
      session.undo();
      await pass(100);
      expect(shownJudgement(page)?.source).toBe("simulation");
    }
  });
});

describe("a deformed patch", () => {
  it("is simulated for a user who asks, cancelled alone, and shown on demand where the curve was found again", async () => {
    const { session, verification, background } = await opened();
    background.switch(false);
    void verification.verify();
    await pass(10);
    finish(jobs[0], design(10.3, 10.2));
    await pass(1000);
    expect(jobs[1].request).toHaveProperty("load");
    expect(verification.patch.get().kind).toBe("running");
    verification.cancel();
    await pass(10);
    expect(dismissed).toEqual(["job-2"]);
    expect([verification.state.get().kind, verification.patch.get().kind]).toEqual(["done", "none"]);
    void verification.showPatch();
    await pass(10);
    finish(jobs[2], { family: "IH21" });
    await pass(1000);
    expect(verification.patch.get()).toMatchObject({ kind: "done", direction: 0 });
    parameter = 0.1;
    session.apply({ points: [[0, 0], [0.2, 4]] });
    await pass(100);
    expect(verification.patch.get().kind).toBe("none");
    parameter = 0.7;
    session.undo();
    await pass(100);
    expect(verification.patch.get().kind).toBe("done");
  });
});

describe("a job of a page that was left", () => {
  it("is found again by the page that is opened next, without another request", async () => {
    await opened();
    await pass(REST_MS + 100);
    expect(jobs).toHaveLength(1);
    const again = await opened();
    await pass(100);
    expect(jobs).toHaveLength(1);
    expect(again.verification.state.get().kind).toBe("running");
    finish(jobs[0], design(10.3, 10.2));
    await pass(1000);
    expect(shownJudgement(again)).toMatchObject({ source: "simulation", grade: "reached" });
  });

  it("keeps the order of its targets where another one of them is selected meanwhile", async () => {
    const first = await opened(TWO_TARGETS);
    await pass(REST_MS + 100);
    const again = await opened({ ...TWO_TARGETS, ...TWO_TARGETS.others[0], at: 1, others: [targetOf(TWO_TARGETS)] });
    await pass(100);
    expect(jobs).toHaveLength(1);
    expect(storage.get("supple-verifying")).toContain('"order":[0,1]');
    finish(jobs[0], design(10.3, 14.5, { also: [profile(10.3, 20)] }));
    await pass(1000);
    for (const { verification } of [first, again]) {
      const state = verification.state.get();
      expect(state.kind === "done" && state.simulated.map(({ curve: { y } }) => y)).toEqual([curve(14.5), curve(20)]);
    }
  });

  it("is forgotten if another tab has dismissed it, and the check begins again", async () => {
    await opened();
    await pass(REST_MS + 100);
    const again = await opened();
    await pass(100);
    dismissed.push("job-1");
    await pass(1000);
    expect(again.verification.state.get().kind).toBe("none");
    expect(storage.get("supple-verifying")).toBe("[]");
    await pass(REST_MS);
    expect(again.verification.state.get().kind).toBe("running");
  });

  it("is begun anew for the user who has asked for it, if the server has lost it", async () => {
    const first = await opened();
    first.background.switch(false);
    void first.verification.verify();
    await pass(10);
    jobs = [];
    const again = await opened();
    await pass(100);
    expect([jobs.length, again.verification.state.get().kind]).toEqual([1, "running"]);
    expect(again.verification.state.get()).toMatchObject({ isBackground: false });
  });

  it("is forgotten if the server has lost it", async () => {
    await opened();
    await pass(REST_MS + 100);
    jobs = []; // the first page is told so, too
    const again = await opened();
    await pass(100);
    expect(again.verification.state.get().kind).not.toBe("running");
    expect(storage.get("supple-verifying")).toBe("[]");
  });
});

describe("a polish", () => {
  const round = (value: number, error: number, accepted: boolean) => ({
    family: "IH21",
    model: "m",
    round: { proposal: "step", parameters: [value], orientation: 0, target_error: error, accepted, reason: "", seconds: 3 },
  });

  it("shows the curve of each round, and keeps the best when it is stopped", async () => {
    const { session, verification, background } = await opened();
    background.switch(false);
    void verification.polish();
    await pass(10);
    for (const [value, error, accepted] of [[0.7, 0.45, true], [0.6, 0.2, true], [0.5, 0.3, false]] as const) {
      jobs[0].document = { state: "running", progress: 0.5, partial: round(value, error, accepted) };
      await pass(500);
    }
    expect(verification.rounds.list.get()).toMatchObject([{ number: 1, isBest: false }, { number: 2, isBest: true, deviation: 0.2 }, { number: 3, isBest: false }]);
    expect(verification.rounds.list.get().every(({ curve: drawn }) => drawn !== null)).toBe(true);
    verification.cancel();
    expect(session.state.get()).toMatchObject({ byHand: true, found: { parameters: [0.6] } });
    expect(verification.rounds.list.get()).toEqual([]);
  });

  it("counts its rounds on after a reload", async () => {
    const first = await opened();
    first.background.switch(false);
    void first.verification.polish();
    await pass(10);
    for (const [value, error] of [[0.7, 0.45], [0.6, 0.2]] as const) {
      jobs[0].document = { state: "running", progress: 0.5, partial: round(value, error, true) };
      await pass(500);
    }
    const again = await opened();
    await pass(500);
    jobs[0].document = { state: "running", progress: 0.7, partial: round(0.5, 0.3, false) };
    await pass(500);
    expect(again.verification.rounds.list.get()).toMatchObject([{ number: 1, deviation: 0.45 }, { number: 2, isBest: true }, { number: 3, deviation: 0.3 }]);
    again.verification.cancel();
    expect(again.session.state.get()).toMatchObject({ found: { parameters: [0.6] } });
  });
});

describe("a polish that has ended", () => {
  async function polishing(): Promise<Opened> {
    const page = await opened();
    page.background.switch(false);
    void page.verification.polish();
    await pass(10);
    return page;
  }
  const polished = () => design(10.3, 14.5, { parameters: [0.6] });

  it("does not change a design that the user is changing", async () => {
    const { session, verification } = await polishing();
    session.gesture();
    finish(jobs[0], polished());
    await pass(1000);
    expect(session.state.get()).toMatchObject({ byHand: false, found: { parameters: [0.7] } });
    expect(session.edited.isBeingChanged).toBe(true);
    expect(verification.simulations.list.get()).toHaveLength(1);
    expect(jobs).toHaveLength(1);
  });

  it("tells its deviation from the target of that time only", async () => {
    const { session, verification } = await polishing();
    finish(jobs[0], polished());
    await pass(1000);
    expect(verification.state.get()).toMatchObject({ kind: "done", polish: { target_error: 0.4 } });
    session.apply({ points: [[0, 0], [0.2, 2.5]] });
    expect(verification.state.get()).toMatchObject({ kind: "done", polish: null });
  });
});

describe("ways out of a miss", () => {
  it.each([429, 503, 504, 0])("are not counted as none if the search for them was answered by %i", async (status) => {
    slope = 15.5;
    refusal = status;
    const { waysOut } = await opened();
    await pass(REST_MS + 100);
    expect(waysOut.state.get().kind).toBe("none");
    refusal = null;
    await pass(32_000);
    expect(waysOut.state.get().kind).toBe("looking");
  });

  it("are looked for in the background without a session, known again after undo, and one click makes the change as one step", async () => {
    slope = 15.5;
    const page = await opened();
    await pass(REST_MS + 100);
    const job = jobs.find(({ request }) => request.effects?.ways_out === "on") as MockJob;
    expect(job.request).toMatchObject({ priority: "background" });
    expect(job.request).not.toHaveProperty("session");
    finish(job, design(15.5, null, { ways_out: [WAY] }));
    await pass(1000);
    expect(page.waysOut.state.get()).toEqual({ kind: "found", ways: [WAY] });
    [slope, parameter] = [10.3, 0.31];
    page.waysOut.apply(WAY);
    expect(page.session.state.get()).toMatchObject({ made: { orientation: 81.93 }, found: { parameters: [0.31] } });
    expect(page.waysOut.state.get().kind).toBe("none");
    await pass(100);
    expect(shownJudgement(page)?.grade).toBe("reached");
    page.session.undo();
    expect(page.session.state.get().made.orientation).toBe(0);
    expect(page.waysOut.state.get()).toEqual({ kind: "found", ways: [WAY] });
  });

  it("are not looked for where the target is reached, and dropped when it changes", async () => {
    const reached = await opened();
    await pass(2 * REST_MS);
    expect(jobs.filter(({ request }) => request.effects?.ways_out === "on")).toHaveLength(0);
    slope = 15.5;
    reached.session.apply({ points: [[0, 0], [0.2, 2.001]] });
    await pass(REST_MS + 100);
    const job = jobs.find(({ request }) => request.effects?.ways_out === "on") as MockJob;
    reached.session.apply({ points: [[0, 0], [0.2, 2.002]] });
    await pass(10);
    expect(dismissed).toContain(job.id);
  });
});
