// The runner of computations with a mock of the server, which answers when the test says so.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client, ConnectionLost } from "../src/contract/client";
import { type Activity, JobRunner, type WorkInWords } from "../src/contract/runner";

const PATH = "/v1/geodesics";

/** Requests in the order of their arrival, with functions that answer them. */
let requests: { name: string; answer: (response: Response) => void; fail: (error: Error) => void }[];
/** Sends an event of the running job. */
let sendEvent: (name: string, partial?: object) => void;
/** Ends the stream of events. */
let endStream: () => void;

function job(state: string, partial?: object): object {
  return { id: "j1", kind: "geodesics", state, progress: 0.5, stage: "searching", priority: "normal", created: "", deadline: 600, remaining_seconds: null, partial };
}

function serve(url: string, init: RequestInit = {}): Promise<Response> {
  const name = `${init.method ?? "GET"} ${String(url)}`;
  if (name === "GET /v1/jobs/j1/events") {
    const stream = new ReadableStream<Uint8Array>({
      start(controller) {
        sendEvent = (event, partial) =>
          controller.enqueue(new TextEncoder().encode(`event: ${event}\ndata: ${JSON.stringify(job(event === "finished" ? "successful" : "running", partial))}\n\n`));
        endStream = () => controller.close();
        init.signal?.addEventListener("abort", () => controller.error(new DOMException("stopped", "AbortError")));
      },
    });
    requests.push({ name, answer: () => {}, fail: () => {} });
    return Promise.resolve(new Response(stream));
  }
  return new Promise((answer, fail) => {
    requests.push({ name, answer, fail });
    init.signal?.addEventListener("abort", () => fail(new DOMException("stopped", "AbortError")));
  });
}

/** Waits for a request, and answers it. */
async function answer(name: string, document: object, status = 200): Promise<void> {
  const request = await vi.waitFor(() => {
    const found = requests.find((one) => one.name === name);
    expect(found).toBeDefined();
    return found;
  });
  requests.splice(requests.indexOf(request as (typeof requests)[number]), 1);
  const type = status >= 400 ? "application/problem+json" : "application/json";
  request?.answer(new Response(JSON.stringify(document), { status, headers: { "Content-Type": type } }));
}

const settled = () => new Promise((resolve) => setTimeout(resolve, 0));

beforeEach(() => {
  requests = [];
  vi.stubGlobal("fetch", serve);
});
afterEach(() => vi.unstubAllGlobals());

function newRunner(): { runner: JobRunner; told: Activity<WorkInWords>[] } {
  const runner = new JobRunner(new Client());
  const told: Activity<WorkInWords>[] = [];
  runner.activity.watch((activity) => told.push(activity));
  return { runner, told };
}

describe("tasks that follow each other", () => {
  it("run one at a time; only the newest of those that wait is run", async () => {
    const { runner } = newRunner();
    const ran: number[] = [];
    let end = () => {};
    let running = 0;
    for (let k = 0; k < 5; ++k) {
      runner.follow(async () => {
        expect(++running).toBe(1);
        ran.push(k);
        await new Promise<void>((resolve) => (end = resolve));
        --running;
      });
    }
    expect(runner.isRunning).toBe(true);
    end();
    await settled();
    expect(ran).toEqual([0, 4]);
    end();
    await settled();
    expect(runner.isRunning).toBe(false);
  });

  it("abort the running one if they are urgent, and still run one at a time", async () => {
    const { runner } = newRunner();
    const shown: string[] = [];
    const ask = (path: string, urgent: boolean) =>
      runner.follow(async (run) => {
        shown.push((await run.post<{ of: string }>(path, {})).of);
      }, undefined, urgent);
    ask("/v1/profiles", false);
    ask("/v1/parts", true);
    ask("/v1/structures", true);
    expect(requests.map(({ name }) => name)).toEqual(["POST /v1/profiles"]);
    await answer("POST /v1/structures", { of: "newest" });
    await settled();
    expect(shown).toEqual(["newest"]);
    expect(requests.map(({ name }) => name)).toEqual(["POST /v1/profiles"]);
    expect(runner.activity.get()).toEqual({ kind: "idle" });
  });
});

describe("a task that was cancelled", () => {
  it("ends at the next value that it waits for, though that was computed", async () => {
    const { runner, told } = newRunner();
    const shown: number[] = [];
    let give = (_: number) => {};
    const done = runner.start(async (run) => {
      shown.push(await run.unlessCancelled(new Promise<number>((resolve) => (give = resolve))));
      run.tell({ words: "later" });
    });
    runner.cancel();
    give(1);
    await done;
    expect(shown).toEqual([]);
    expect(told.every(({ kind }) => kind === "idle")).toBe(true);
  });
});

describe("a job", () => {
  it("tells its progress and partial results, and gives its answer", async () => {
    const { runner, told } = newRunner();
    const partials: unknown[] = [];
    let length = 0;
    const done = runner.begin({ words: "Computing" }, async (run) => {
      const onJob = ({ stage, progress, partial }: { stage: string; progress: number; partial?: unknown }) => {
        if (partial) partials.push(partial);
        run.tell({ words: stage }, progress);
      };
      length = (await run.job<{ length: number }>(PATH, {}, { onJob })).length;
    });
    await answer(`POST ${PATH}`, job("accepted"), 202);
    await vi.waitFor(() => expect(requests.map(({ name }) => name)).toContain("GET /v1/jobs/j1/events"));
    sendEvent("progress", { iteration: 1 });
    sendEvent("finished");
    await answer("GET /v1/jobs/j1/result", { length: 2.5 });
    await done;
    expect(partials).toEqual([{ iteration: 1 }]);
    expect(length).toBe(2.5);
    expect(told).toContainEqual({ kind: "busy", words: "Computing", progress: null });
    expect(told).toContainEqual({ kind: "busy", words: "searching", progress: 0.5 });
    expect(told.at(-1)).toEqual({ kind: "idle" });
  });

  it("is dismissed when it is cancelled, and tells nothing any more", async () => {
    const { runner, told } = newRunner();
    const seen: unknown[] = [];
    const done = runner.begin({ words: "Computing" }, async (run) => {
      seen.push(await run.job(PATH, {}, { onJob: ({ partial }) => partial && seen.push(partial) }));
    });
    await answer(`POST ${PATH}`, job("accepted"), 202);
    await vi.waitFor(() => expect(requests.map(({ name }) => name)).toContain("GET /v1/jobs/j1/events"));
    runner.cancel();
    await done;
    await vi.waitFor(() => expect(requests.map(({ name }) => name)).toContain("DELETE /v1/jobs/j1"));
    expect(seen).toEqual([]);
    expect(told.at(-1)).toEqual({ kind: "idle" });
    expect(runner.hasFailed).toBe(false);
  });

  it("is polled if its events end before it has finished", async () => {
    const { runner } = newRunner();
    let length = 0;
    const done = runner.start(async (run) => {
      length = (await run.job<{ length: number }>(PATH, {})).length;
    });
    await answer(`POST ${PATH}`, job("accepted"), 202);
    await vi.waitFor(() => expect(requests.map(({ name }) => name)).toContain("GET /v1/jobs/j1/events"));
    endStream();
    await answer("GET /v1/jobs/j1", job("successful"));
    await answer("GET /v1/jobs/j1/result", { length: 4 });
    await done;
    expect(length).toBe(4);
  });

  it("may be answered at once", async () => {
    const { runner } = newRunner();
    let text = "";
    const done = runner.start(async (run) => {
      const { length } = await run.job<{ length: number }>(PATH, {}, { wait: 1 });
      text = `${length} ${await run.file(PATH, {}, "model/obj")}`;
    });
    await answer(`POST ${PATH}`, { length: 1 });
    await answer(`POST ${PATH}`, { v: 0 });
    await done;
    expect(text).toBe('1 {"v":0}');
  });
});

describe("a task that fails", () => {
  const problem = { status: 422, code: "mesh.not_closed", title: "t", detail: "The mesh is open." };

  it("is told by its sentence, with the error, and counts as failed until one succeeds", async () => {
    const { runner } = newRunner();
    const ask = () => runner.start(async (run) => void (await run.post(PATH, {})));
    const failed = ask();
    await answer(`POST ${PATH}`, problem, 422);
    await failed;
    expect(runner.activity.get()).toMatchObject({ kind: "failed", sentence: "The mesh is open.", error: { code: "mesh.not_closed" } });
    expect(runner.hasFailed).toBe(true);
    const repeated = ask();
    await answer(`POST ${PATH}`, {});
    await repeated;
    expect(runner.hasFailed).toBe(false);
  });

  it("leaves a lost connection to the frame of the page, if it is repeated when the server answers again", async () => {
    const { runner } = newRunner();
    runner.follow(async (run) => void (await run.post(PATH, {})), runner.tellFault);
    requests[0].fail(new TypeError("no connection"));
    await settled();
    expect(runner.activity.get()).toEqual({ kind: "idle" });
    expect(runner.hasFailed).toBe(true);
    const shown = runner.start(async () => Promise.reject(new ConnectionLost()));
    await shown;
    expect(runner.activity.get()).toMatchObject({ kind: "failed", sentence: "The server does not answer." });
  });

  it("may ask for a further task, which runs next", async () => {
    const { runner } = newRunner();
    let repeats = 0;
    const ask = (): void =>
      runner.follow(async (run) => void (await run.post(PATH, {})), () => {
        ++repeats;
        ask();
      });
    ask();
    await answer(`POST ${PATH}`, problem, 422);
    await answer(`POST ${PATH}`, {});
    await vi.waitFor(() => expect(runner.isRunning).toBe(false));
    expect([repeats, runner.hasFailed]).toEqual([1, false]);
  });
});

describe("runners of one part of a page", () => {
  it("tell one activity", async () => {
    const first = new JobRunner(new Client());
    const second = new JobRunner(new Client(), first.activity);
    void first.begin({ words: "Loading" }, async (run) => void (await run.text("/v1/meshes/m/content")));
    second.follow(async (run) => run.tell({ words: "Following" }));
    await settled();
    expect(first.isRunning).toBe(true);
    expect(first.activity.get()).toEqual({ kind: "idle" });
    second.cancel();
    expect(first.isRunning).toBe(true);
    first.stop();
    expect(first.isRunning).toBe(false);
  });
});
