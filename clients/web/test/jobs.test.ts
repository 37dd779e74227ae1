// The jobs that the editor keeps, their words, and how they are followed, with a mock of the server.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { textKey } from "../src/base/text_key";
import { Client, isDismissed } from "../src/contract/client";
import { runJob } from "../src/contract/jobs";
import { JobRunner } from "../src/contract/runner";
import type { Job } from "../src/contract/types";
import { JobWatch } from "../src/jobs/job_watch";
import { bestWords, outcomeWords, stateWords, workWords } from "../src/jobs/job_words";
import { KeptJobs } from "../src/jobs/kept_jobs";

const PATH = "/v1/designs";
const REQUEST = { task: "stress_strain", family: "IH21", initial: [0.1234567], session: "web-1" };
const PLACE = { page: "design", link: "family=IH21" };

// A busy machine has time.
vi.setConfig({ testTimeout: 120_000 });

const storage = new Map<string, string>();
const stub = { getItem: (key: string) => storage.get(key) ?? null, setItem: (key: string, value: string) => void storage.set(key, value) };

/** What the mock server was asked for, and its jobs. */
let asked: string[];
let jobs: Map<string, Job>;
let uptime: number;

function job(id: string, more: Partial<Job> = {}): Job {
  return {
    id,
    kind: "designs",
    state: "running",
    progress: 0.25,
    stage: "starts",
    priority: "normal",
    created: "2026-01-01T00:00:00Z",
    deadline: 600,
    remaining_seconds: 12,
    ...more,
  };
}

const ended = (id: string, seconds: number): Job =>
  job(id, { state: "successful", progress: 1, remaining_seconds: null, finished: new Date(Date.parse("2026-01-01T00:00:00Z") + 1000 * seconds).toISOString() });

function problem(status: number, code: string): Response {
  return new Response(JSON.stringify({ type: "about:blank", status, code, title: "t", detail: "It is gone." }), {
    status,
    headers: { "Content-Type": "application/problem+json" },
  });
}

async function serve(url: string, init: RequestInit = {}): Promise<Response> {
  const name = `${init.method ?? "GET"} ${String(url)}`;
  asked.push(name);
  if (name === "GET /healthz") return Response.json({ status: "ok", uptime_seconds: uptime });
  if (init.method === "POST") {
    const next = job(`job-${jobs.size + 1}`);
    jobs.set(next.id, next);
    return Response.json(next, { status: 202 });
  }
  if (name.startsWith("GET /v1/jobs?")) return Response.json({ jobs: [...jobs.values()] });
  const [, id, rest] = /\/v1\/jobs\/([\w-]+)(\/\w+)?/.exec(String(url)) ?? [];
  const known = jobs.get(id);
  if (!known) return problem(404, "job.not_found");
  if (init.method === "DELETE") jobs.set(id, job(id, { state: "dismissed" }));
  if (rest === "/events") return problem(503, "server.too_many_event_streams");
  if (rest === "/result") return known.state === "dismissed" ? problem(410, "job.dismissed") : Response.json({ verdict: { sentence: "By the model: 3 % off." } });
  return Response.json(jobs.get(id));
}

beforeEach(() => {
  [asked, jobs, uptime] = [[], new Map(), 100];
  storage.clear();
  vi.useFakeTimers();
  vi.stubGlobal("fetch", serve);
  vi.stubGlobal("localStorage", stub);
});
afterEach(() => {
  vi.unstubAllGlobals();
  vi.useRealTimers();
});

const pass = (ms: number) => vi.advanceTimersByTimeAsync(ms);
const clientOf = (kept: KeptJobs, place = PLACE) => new Client("", undefined, undefined, undefined, kept.of(() => place));
const run = (client: Client, request: unknown = REQUEST, signal = new AbortController().signal) => runJob<object>(client, PATH, request, { signal });

describe("a key of a request", () => {
  it("does not depend on the order of fields, on rounding and on what has no effect", () => {
    expect(textKey({ a: 1, b: { c: [0.12345678], d: undefined } })).toBe(textKey({ b: { c: [0.12345679] }, a: 1 }));
    expect(textKey({ a: 1, session: "x" }, ["session"])).toBe(textKey({ session: "y", a: 1 }, ["session"]));
    expect(textKey({ a: 1 })).not.toBe(textKey({ a: 1.001 }));
    expect(textKey({ a: [1, 2] })).not.toBe(textKey({ a: [2, 1] }));
  });
});

describe("the words of a job", () => {
  it("say what it computes", () => {
    expect(workWords(PATH, REQUEST)).toBe("Search for a design: stress over strain of IH21");
    expect(workWords(PATH, { task: "poisson", family: "any", verify: true })).toMatch(/^Verification by simulation: .*over direction$/);
    expect(workWords(PATH, { effects: { polish: "on" } })).toBe("Polish by simulation");
    expect(workWords(PATH, { effects: { ways_out: "on" } })).toBe("Ways out of a missed target");
    expect(workWords(PATH, { regions: [{}, {}, {}] })).toBe("Designs of 3 regions");
    expect(workWords("/v1/embedded-systems", {})).toBe("Relaxation");
    expect(workWords("/v1/gcode-reports", null)).toBe("Gcode reports");
  });

  it("say how far it is and what it has found", () => {
    const at = (state: Job["state"], more = {}) => stateWords({ state, progress: 0.4, remaining: null, took: null, ...more });
    expect(at("accepted")).toBe("Waiting");
    expect(at("running", { remaining: 12.3 })).toBe("40 %, about 12 s left");
    expect(at("successful", { took: 75 })).toBe("Ready after 1 min 15 s");
    expect(stateWords({ state: "removed", progress: 0, remaining: null, took: null })).toBe("The server no longer has it");
    const round = (error: number | null, accepted: boolean) => ({ partial: { round: { target_error: error, accepted } } }) as unknown as Job;
    expect(bestWords(round(0.2, true), "")).toBe("Best so far: 20 % from the target, simulated");
    expect(bestWords(round(0.3, false), "as before")).toBe("as before");
    const part = { number: 2, states: 10, state: { largest_strain: 0.125 } };
    expect(bestWords({ partial: part } as unknown as Job, "")).toMatch(/^State 2 of 10, strain up to 1[23](\.\d+)? %$/);
    expect(bestWords({ partial: { iteration: 3, energy: 1.5, gradient_norm: 1 } } as unknown as Job, "")).toBe("Iteration 3, energy 1.5");
    expect(outcomeWords({ verdict: { sentence: "Reached." } }, "x")).toBe("Reached.");
    expect(outcomeWords(null, "Best so far: 20 %")).toBe("Best: 20 %");
  });
});

describe("kept jobs", () => {
  it("list a job with its page from its beginning to its result, also after a reload", async () => {
    const kept = new KeptJobs("tab");
    const answer = run(clientOf(kept));
    await pass(10);
    expect(kept.list.get()).toMatchObject([{ id: "job-1", ...PLACE, words: "Search for a design: stress over strain of IH21", state: "running", progress: 0.25, remaining: 12 }]);
    expect(new KeptJobs("tab").list.get()).toHaveLength(1);
    jobs.set("job-1", ended("job-1", 34));
    await pass(1000);
    expect(await answer).toHaveProperty("verdict");
    for (const list of [kept.list.get(), new KeptJobs("tab").list.get()]) {
      expect(list).toMatchObject([{ state: "successful", took: 34, remaining: null, found: "By the model: 3 % off." }]);
    }
  });

  it("leave out what has taken less than a moment, and what was cancelled", async () => {
    const kept = new KeptJobs("tab");
    const client = clientOf(kept);
    void run(client);
    await pass(10);
    jobs.set("job-1", ended("job-1", 1));
    await pass(1000);
    expect(kept.list.get()).toEqual([]);
    expect(kept.isOwn("job-1")).toBe(true);
    const stopped = new AbortController();
    const failed = run(client, { ...REQUEST, task: "poisson" }, stopped.signal).catch(() => "aborted");
    await pass(10);
    stopped.abort();
    expect(await failed).toBe("aborted");
    expect(kept.list.get()).toEqual([]);
    expect(asked).toContain("DELETE /v1/jobs/job-2");
  });

  it("go on with a job of the same tab that computes the same, without another request", async () => {
    void run(clientOf(new KeptJobs("tab")));
    await pass(10);
    const reloaded = new KeptJobs("tab");
    const answer = run(clientOf(reloaded), { ...REQUEST, initial: [0.12345671], session: "web-2" });
    await pass(10);
    expect(asked.filter((name) => name.startsWith("POST"))).toHaveLength(1);
    jobs.set("job-1", ended("job-1", 5));
    await pass(1000);
    await answer;
    expect(reloaded.list.get()).toMatchObject([{ id: "job-1", state: "successful" }]);
  });

  it("are those of their tab: another tab begins its own, unless the job is wanted", async () => {
    const first = new KeptJobs("tab");
    void run(clientOf(first));
    await pass(10);
    const other = new KeptJobs("another tab");
    void run(clientOf(other));
    await pass(10);
    expect(asked.filter((name) => name.startsWith("POST"))).toHaveLength(2);
    jobs.set("job-1", ended("job-1", 5));
    await pass(1000);
    const third = new KeptJobs("a third tab");
    third.want("job-1");
    expect(await run(clientOf(third))).toHaveProperty("verdict");
    expect(asked.filter((name) => name.startsWith("POST"))).toHaveLength(2);
    void run(clientOf(third));
    await pass(10);
    expect(asked.filter((name) => name.startsWith("POST")), "a result is taken once").toHaveLength(3);
  });

  it("begin anew where the server has lost the job", async () => {
    void run(clientOf(new KeptJobs("tab"))).catch(() => {});
    await pass(10);
    jobs.clear();
    void run(clientOf(new KeptJobs("tab"))).catch(() => {});
    await pass(10);
    expect(asked.filter((name) => name.startsWith("POST"))).toHaveLength(2);
  });

  it("survive what another version has stored", () => {
    storage.set("supple-jobs", JSON.stringify({ jobs: [{ id: "../x" }, null, 3], ids: [1] }));
    expect(new KeptJobs("tab").list.get()).toEqual([]);
  });
});

describe("jobs that no page follows", () => {
  it("are asked after until they end, and said to be gone where the server has lost them", async () => {
    void run(clientOf(new KeptJobs("tab"))).catch(() => {});
    void run(clientOf(new KeptJobs("tab")), { ...REQUEST, task: "poisson" }).catch(() => {});
    await pass(10);
    const kept = new KeptJobs("tab");
    const watch = new JobWatch(new Client(), kept);
    jobs.set("job-1", ended("job-1", 30));
    jobs.delete("job-2");
    await watch.begin();
    await pass(3000);
    expect(kept.list.get().map(({ id, state }) => [id, state]).sort()).toEqual([["job-1", "successful"], ["job-2", "removed"]]);
    asked = [];
    await pass(20_000);
    expect(asked).toEqual([]);
  });

  it("tell that the server was started again", async () => {
    const kept = new KeptJobs("tab");
    const watch = new JobWatch(new Client(), kept);
    await watch.begin();
    void run(clientOf(kept)).catch(() => {});
    await pass(60_000);
    uptime = 160;
    await watch.begin();
    expect(watch.restarted.get()).toBeNull();
    uptime = 3;
    await watch.begin();
    expect(watch.restarted.get()?.getTime()).toBe(Date.now() - 3000);
  });

  it("include those of the key while the tray is open, and can be cancelled", async () => {
    const kept = new KeptJobs("tab");
    void run(clientOf(kept)).catch(() => {});
    await pass(10);
    jobs.set("elsewhere", job("elsewhere", { kind: "voronoi-optimizations" }));
    const watch = new JobWatch(new Client(), kept);
    watch.setOpen(true);
    await pass(100);
    expect(watch.others.get().map(({ id }) => id)).toEqual(["elsewhere"]);
    await watch.cancel("elsewhere");
    expect(watch.others.get()).toEqual([]);
    expect(asked).toContain("DELETE /v1/jobs/elsewhere");
    watch.setOpen(false);
    await pass(5000);
    asked = [];
    await pass(10_000);
    expect(asked.filter((name) => name.includes("limit"))).toEqual([]);
  });
});

describe("following a job", () => {
  it("needs no event stream in the background, and no more than two at once", async () => {
    const client = new Client();
    const streams = () => asked.filter((name) => name.endsWith("/events")).length;
    void run(client, { ...REQUEST, priority: "background" });
    await pass(5000);
    expect(streams()).toBe(0);
    vi.stubGlobal("fetch", async (url: string, init: RequestInit = {}) => {
      if (!String(url).endsWith("/events")) return serve(url, init);
      asked.push(String(url));
      return new Response(new ReadableStream({ start() {} })); // it stays open
    });
    for (let k = 0; k < 4; ++k) void run(client, { ...REQUEST, initial: [k] });
    await pass(2000);
    expect(streams()).toBe(2);
  });

  it("ends without a complaint where the job is cancelled elsewhere", async () => {
    const kept = new KeptJobs("tab");
    const runner = new JobRunner(clientOf(kept));
    const done = runner.begin({ words: "Searching" }, async (task) => void (await task.job(PATH, REQUEST)));
    await pass(10);
    await new JobWatch(new Client(), kept).cancel("job-1");
    await pass(1000);
    await done;
    expect(runner.activity.get()).toEqual({ kind: "stopped" });
    expect(runner.hasFailed).toBe(false);
    expect([kept.of(() => PLACE).wasCancelled("job-1"), kept.of(() => PLACE).wasCancelled("job-2")]).toEqual([true, false]);
    expect(kept.list.get()).toEqual([]);
    expect(isDismissed(new Error("x"))).toBe(false);
  });
});
