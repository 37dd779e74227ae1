// The mesh session with a mock of the server, which answers when the test releases an answer.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client } from "../src/contract/client";
import { findings } from "../src/mesh/findings";
import { MeshSession } from "../src/mesh/session";

const [FIRST, SECOND] = ["ab".repeat(32), "cd".repeat(32)];
const PLY =
  "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty double x\nproperty double y\nproperty double z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";

/** Functions that release the pending answers, by method and path. */
const answers = new Map<string, () => void>();

function info(id: string) {
  return { id, vertices: 0, faces: 0, area: 0, bounding_box: { diagonal: 0 }, warnings: [] };
}

function serve(url: string, init: RequestInit = {}): Promise<Response> {
  const path = String(url).split("?")[0];
  const answer = () => {
    if (path.endsWith("/content")) return new Response(PLY);
    if (path === "/v1/meshes" && init.method === "POST") return Response.json(info(FIRST));
    if (path === "/v1/meshes") return Response.json({ meshes: [info(SECOND), info(FIRST)] });
    return Response.json(info(path.slice("/v1/meshes/".length)));
  };
  return new Promise((resolve) => answers.set(`${init.method ?? "GET"} ${path}`, () => resolve(answer())));
}

async function answer(request: string): Promise<void> {
  await vi.waitFor(() => expect(answers.has(request)).toBe(true));
  answers.get(request)?.();
  answers.delete(request);
}

describe("MeshSession", () => {
  let session: MeshSession;

  beforeEach(() => {
    answers.clear();
    vi.stubGlobal("fetch", serve);
    session = new MeshSession(new Client(), findings);
  });

  afterEach(() => vi.unstubAllGlobals());

  it("names an uploaded mesh in its list before the server's list is read again", async () => {
    const listedWhenShown: boolean[] = [];
    session.mesh.watch((loaded) => loaded && listedWhenShown.push(session.known.get().some((mesh) => mesh.id === loaded.info.id)));
    const uploaded = session.upload(new Blob([PLY]), "first.ply");
    await answer("POST /v1/meshes");
    await answer(`GET /v1/meshes/${FIRST}/content`);
    await uploaded;
    expect(listedWhenShown).toEqual([true]);
    await answer("GET /v1/meshes");
    await vi.waitFor(() => expect(session.known.get().map(({ id }) => id)).toEqual([SECOND, FIRST]));
  });

  it("shows the mesh that was asked for last, whichever answer comes first", async () => {
    const opened = [session.open(FIRST), session.open(SECOND)];
    for (const id of [SECOND, FIRST]) {
      await answer(`GET /v1/meshes/${id}`);
      await answer(`GET /v1/meshes/${id}/content`);
    }
    await Promise.all(opened);
    expect(session.mesh.get()?.info.id).toBe(SECOND);
    expect(session.activity.get()).toEqual({ kind: "idle" });
  });

  it("shows nothing of what was cancelled", async () => {
    const opened = session.open(FIRST);
    session.cancel();
    await answer(`GET /v1/meshes/${FIRST}`);
    await answer(`GET /v1/meshes/${FIRST}/content`);
    await opened;
    expect(session.mesh.get()).toBe(null);
  });
});
