import { afterEach, expect, test, vi } from "vitest";
import { Client, isUnauthorized } from "../src/contract/client";

function answers(...statuses: number[]) {
  const fetched = vi.fn(async (_url: string, _init?: RequestInit) => {
    const status = statuses.shift() ?? 500;
    const type = status < 400 ? "application/json" : "application/problem+json";
    return new Response(JSON.stringify({ status, code: "c", title: "t", detail: "d" }), { status, headers: { "Content-Type": type } });
  });
  vi.stubGlobal("fetch", fetched);
  return fetched;
}

afterEach(() => vi.unstubAllGlobals());

test("a request that needs a key is sent again, the same, once somebody has signed in", async () => {
  const fetched = answers(401, 200);
  let signIn = () => {};
  const asked = vi.fn(() => new Promise<void>((resolve) => (signIn = resolve)));
  const answer = new Client("", () => {}, asked).post("/v1/geodesics", { mesh: "m" });
  await vi.waitFor(() => expect(asked).toHaveBeenCalledOnce());
  expect(fetched).toHaveBeenCalledOnce();
  signIn();
  expect(await answer).toMatchObject({ status: 200 });
  const [first, second] = fetched.mock.calls;
  expect(second).toEqual(first);
});

test("a key that may not do it asks nobody, and neither does a second refusal", async () => {
  const asked = vi.fn(async () => {});
  answers(403);
  await expect(new Client("", () => {}, asked).get("/v1/meshes")).rejects.toThrow();
  expect(asked).not.toHaveBeenCalled();
  answers(401, 401);
  const refused = await new Client("", () => {}, asked).get("/v1/meshes").catch((error: unknown) => error);
  expect(isUnauthorized(refused)).toBe(true);
  expect(asked).toHaveBeenCalledOnce();
});
