import { afterEach, expect, test, vi } from "vitest";
import { Client, ConnectionLost, isServing, Problem } from "../src/contract/client";

function refuses(code: string) {
  vi.stubGlobal("fetch",
    vi.fn(async () => new Response(JSON.stringify({ status: 503, code, title: "t", detail: "d" }), { status: 503, headers: { "Content-Type": "application/problem+json" } })));
}

afterEach(() => vi.unstubAllGlobals());

test("a server that starts or ends is waited for as one that is not there", async () => {
  for (const code of ["server.not_ready", "server.shutting_down"]) {
    refuses(code);
    const heard: boolean[] = [];
    await expect(new Client("", (answered) => heard.push(answered)).post("/v1/designs", {})).rejects.toThrow(ConnectionLost);
    expect(heard).toEqual([false]);
    expect(await isServing()).toBe(false);
  }
});

test("a server that serves is there, whatever troubles it", async () => {
  refuses("store.full");
  await expect(new Client().get("/v1/meshes")).rejects.toThrow(Problem);
  expect(await isServing()).toBe(true);
  vi.stubGlobal("fetch", vi.fn(async () => new Response("{}", { status: 200 })));
  expect(await isServing()).toBe(true);
  vi.stubGlobal("fetch", vi.fn(async () => {
    throw new TypeError("no connection");
  }));
  expect(await isServing()).toBe(false);
});
