// Karcher means from several starts: requests, facts, and links.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client } from "../src/contract/client";
import type { Geodesics, KarcherMean } from "../src/contract/types";
import { findings } from "../src/mesh/findings";
import { readMeshLink, writeMeshLink } from "../src/mesh/link";
import { MeshSession, MAX_STARTS } from "../src/mesh/session";

const MESH = "ab".repeat(32);
const VERTICES = [[0, 0, 0], [1, 0, 0], [0, 1, 0]];

function ply(): string {
  return "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty double x\nproperty double y\nproperty double z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n";
}

function meanOf(starts: number): KarcherMean {
  return {
    mesh: MESH,
    mean: { face: 0, barycentric: [1, 0, 0] },
    position: VERTICES[0],
    objective: 1,
    gradient_norm: 0,
    iterations: 3,
    start: starts - 1,
    history: [],
    stopped: "converged",
    accuracy: { tolerance: 1e-9, gradient_tolerance: 1e-9, gradient_norm: 0 },
    effects: [{ name: "multi_start", ran: starts > 1, why: "", count: starts - 1, seconds: 0 }],
    cost: { seconds: 0.1, stages: [], quantities: {} },
  } as unknown as KarcherMean;
}

const NO_PATHS = { mesh: MESH, results: [], cost: { seconds: 0, stages: [], quantities: {} } } as unknown as Geodesics;

let requests: number[];

beforeEach(() => {
  requests = [];
  vi.stubGlobal("fetch", async (url: string, init: RequestInit = {}) => {
    if (String(url) === `/v1/meshes/${MESH}`) return Response.json({ id: MESH, vertices: 3, faces: 1, area: 0.5, bounding_box: { diagonal: 2 }, warnings: [] });
    if (String(url).endsWith("/content")) return new Response(ply());
    if (String(url) !== "/v1/karcher-means") return Response.json(NO_PATHS);
    const { starts } = JSON.parse(String(init.body)) as { starts: number };
    requests.push(starts);
    return Response.json(meanOf(starts));
  });
});
afterEach(() => vi.unstubAllGlobals());

describe("a mean", () => {
  it("is searched for from as many starts as are asked for, and anew when they change", async () => {
    const session = new MeshSession(new Client(), findings);
    session.setStarts(2);
    session.setTool("mean");
    await session.open(MESH, [{ vertex: 0 }, { vertex: 1 }]);
    await vi.waitFor(() => expect(requests).toEqual([2]));
    await vi.waitFor(() => expect(session.finding.get().facts).toContainEqual(["Start", "2 of 2"]));
    session.setStarts(5);
    await vi.waitFor(() => expect(session.finding.get().facts).toContainEqual(["Start", "5 of 5"]));
    expect(requests).toEqual([2, 5]);
    session.setTool("path");
    await vi.waitFor(() => expect(session.activity.get().kind).toBe("idle"));
    session.setStarts(1);
    session.setTool("mean");
    await vi.waitFor(() => expect(requests).toEqual([2, 5, 1]));
    await vi.waitFor(() => expect(session.finding.get().mean).not.toBeNull());
    expect(session.finding.get().facts.map(([term]) => term)).not.toContain("Start");
  });

  it("keeps its starts in a link", () => {
    const link = { mesh: MESH, tool: "mean" as const, points: [{ vertex: 3 }], starts: 7, network: null };
    expect(readMeshLink(writeMeshLink(link))).toEqual(link);
    expect(writeMeshLink({ ...link, tool: "path" })).not.toContain("starts");
    expect(writeMeshLink({ ...link, starts: 1 })).not.toContain("starts");
    for (const text of ["0", "1", "-3", "x", "9999"]) expect(readMeshLink(`mesh=${MESH}&tool=mean&starts=${text}`)?.starts).toBeUndefined();
    expect(readMeshLink(`mesh=${MESH}&tool=mean&starts=999`)?.starts).toBe(MAX_STARTS);
  });
});
