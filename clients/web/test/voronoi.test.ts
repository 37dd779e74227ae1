// Voronoi diagrams: requests, links, coloured and cut cells, and moving sites.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client } from "../src/contract/client";
import type { SurfacePoint } from "../src/contract/types";
import { cellTriangles } from "../src/mesh/cell_drawing";
import { findings } from "../src/mesh/findings";
import { readMeshLink, writeMeshLink } from "../src/mesh/link";
import { MeshSession } from "../src/mesh/session";
import { VoronoiSession } from "../src/mesh/voronoi_session";
import { DEFAULT_VORONOI, diagramRequest, hasObjective, optimizationRequest, readVoronoi, withToggledFixed, withoutSite, writeVoronoi } from "../src/mesh/voronoi_state";
import { statisticsRows } from "../src/mesh/voronoi_statistics";
import { cellColours, VoronoiView } from "../src/mesh/voronoi_view";

const MESH = "ab".repeat(32);
const SITES: SurfacePoint[] = [{ vertex: 0 }, { vertex: 2 }, { face: 0, barycentric: [0.25, 0.25, 0.5] }];
const SPREAD = { mean: 2, least: 1, greatest: 3, deviation: 0.5 };
const STATISTICS = { edge_length: SPREAD, planarity: SPREAD, area: { ...SPREAD, mean: 5 }, vertex_distance: SPREAD };
const COST = { seconds: 0.01, stages: [], quantities: {} };

describe("the state of a diagram", () => {
  it("asks for cells with what colours them, by the distances that were chosen", () => {
    expect(diagramRequest(MESH, DEFAULT_VORONOI, SITES, false)).toEqual({
      mesh: MESH,
      sites: SITES,
      accuracy: { method: "exact", border_deviation: 1e-5 },
      pieces: true,
      statistics: false,
    });
    const own = { ...DEFAULT_VORONOI, accuracy: { level: "own", switches: {} }, exactness: "bounded" } as const;
    expect(diagramRequest(MESH, own, SITES, true).accuracy).toEqual({ method: "bounded", relative_error: 0.01, border_deviation: 1e-5 });
  });

  it("asks for what its level does, whatever its values of one's own are", () => {
    const sure = { ...DEFAULT_VORONOI, accuracy: { level: "sure", switches: {} }, exactness: "edges", deviation: 0.5, tolerance: 0.1 } as const;
    expect(diagramRequest(MESH, sure, SITES, true).accuracy).toEqual({ method: "exact", border_deviation: 1e-7 });
    expect(optimizationRequest(MESH, sure, SITES).accuracy).toEqual({ tolerance: 1e-9, border_deviation: 1e-5 });
  });

  it("asks for objectives of some weight alone, and for a length of edges where they count", () => {
    const state = { ...DEFAULT_VORONOI, weights: { ...DEFAULT_VORONOI.weights, planarity: 2 }, targetLength: 0.5, fixed: [1, 9] };
    expect(optimizationRequest(MESH, state, SITES)).toEqual({
      mesh: MESH,
      sites: SITES,
      objectives: { centroidal: 1, planarity: 2 },
      pieces: true,
      fixed_sites: [1],
      method: "automatic",
      accuracy: { tolerance: 1e-4, border_deviation: 1e-5 },
      max_iterations: 100,
    });
    expect(optimizationRequest(MESH, { ...state, weights: { ...state.weights, edge_length: 1 } }, SITES).target_length).toBe(0.5);
    expect(hasObjective({ ...state, weights: { centroidal: 0, regularity: 0, equal_area: 0, edge_length: 0, planarity: 0 } })).toBe(false);
  });

  it("keeps held sites by their numbers when another is removed", () => {
    const held = withToggledFixed(withToggledFixed(DEFAULT_VORONOI, 5), 2);
    expect(held.fixed).toEqual([2, 5]);
    expect(withToggledFixed(held, 5).fixed).toEqual([2]);
    expect(withoutSite(held, 3).fixed).toEqual([2, 4]);
    expect(withoutSite({ ...held, scattered: true }, 2)).toMatchObject({ fixed: [4], scattered: false });
  });

  it("comes back from a link, with its sites unless they are random ones", () => {
    const state = {
      ...DEFAULT_VORONOI,
      count: 12,
      seed: 3,
      exactness: "edges" as const,
      deviation: 1e-4,
      weights: { ...DEFAULT_VORONOI.weights, equal_area: 0.5 },
      targetLength: 0.25,
      fixed: [0, 2],
      minimizer: "lbfgs" as const,
      tolerance: 1e-6,
      maxIterations: 7,
    };
    const link = { mesh: MESH, tool: "voronoi" as const, points: SITES, network: null, voronoi: state };
    expect(readMeshLink(writeMeshLink(link))).toEqual(link);
    expect(writeMeshLink({ ...link, tool: "path" })).not.toContain("voronoi");
    const fields = new Map([["voronoi", "0,-1,1,wrong,,x,1e9"]]);
    expect(readVoronoi(fields)).toEqual({ ...DEFAULT_VORONOI, scattered: true, weights: { centroidal: 0, regularity: 0, equal_area: 0, edge_length: 0, planarity: 0 } });
    expect(readVoronoi(new Map())).toBeNull();
    expect(writeVoronoi(state)).toContainEqual(["fixed-sites", "0,2"]);
  });
});

describe("cells", () => {
  it("fill polygons that a curved border makes hollow, and nothing beside them", () => {
    const mesh = { positions: Float64Array.from([0, 0, 0, 4, 0, 0, 0, 4, 0]), faces: Uint32Array.from([0, 1, 2]) };
    const corners = [[0, 0, 0], [2, 0, 0], [0.25, 0.25, 0], [0, 2, 0]] as const;
    const turned = [1, 2, 3, 0].map((k) => corners[k]);
    for (const hollow of [corners, turned]) {
      const { places } = cellTriangles(mesh, [0, 0, 1, 0, 0, 1, 0, 0, 1], { faceSites: [null], pieces: [{ site: 0, face: 0, corners: hollow }], colours: [[1, 0, 0]] });
      const areas = [0, 9].map((at) =>
        0.5 * ((places[at + 3] - places[at]) * (places[at + 7] - places[at + 1]) - (places[at + 4] - places[at + 1]) * (places[at + 6] - places[at]))
      );
      expect(Math.min(...areas)).toBeGreaterThan(0);
      expect(areas[0] + areas[1]).toBeCloseTo(0.5, 12);
    }
  });

  it("that meet have different colours", () => {
    const neighbours = [[1, 2, 3], [0, 2], [0, 1, 3], [0, 2]];
    const colours = cellColours(neighbours, 4);
    neighbours.forEach((others, cell) => others.forEach((other) => expect(colours[other]).not.toBe(colours[cell])));
    expect(cellColours([[1, 2], [0, 2], [0, 1]], 2)).toHaveLength(3);
  });

  it("are drawn face by face, and cut where a face belongs to several", () => {
    const mesh = { positions: Float64Array.from([0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0]), faces: Uint32Array.from([0, 1, 2, 0, 2, 3]) };
    const normals = [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1];
    const picture = {
      faceSites: [1, null],
      pieces: [{ site: 0, face: 1, corners: [[0, 0, 0], [1, 1, 0], [0, 2, 0]] as const }, { site: 1, face: 1, corners: [[1, 1, 0], [2, 2, 0], [1, 2, 0], [0, 2, 0]] as const }],
      colours: [[1, 0, 0], [0, 0, 1]] as const,
    };
    const { places, normals: bent, colours } = cellTriangles(mesh, normals, picture);
    expect(places).toHaveLength(9 * (1 + 1 + 2));
    expect([...places.slice(0, 9)]).toEqual([0, 0, 0, 2, 0, 0, 2, 2, 0]);
    expect([...colours.slice(0, 3)]).toEqual([0, 0, 1]);
    expect([...colours.slice(9, 12)]).toEqual([1, 0, 0]);
    expect(bent.every((value, k) => value === (k % 3 === 2 ? 1 : 0))).toBe(true);
  });

  it("are told of before and after an optimization", () => {
    expect(statisticsRows(null, STATISTICS).map(([words]) => words)).toEqual(["Length of edges", "Vertices off their plane", "Area of cells", "Vertex to site"]);
    const rows = statisticsRows(STATISTICS, { ...STATISTICS, area: { ...SPREAD, mean: 7 } });
    expect(rows[4]).toEqual(["Area of cells, before", "5", "0.5", "1", "3"]);
    expect(rows[5][1]).toBe("7");
  });
});

const PIECES = { vertex_sites: [0, 0, 1], face_sites: [0], cut_faces: [] };

function diagramOf(sites: readonly unknown[], more: object = {}): object {
  return {
    mesh: MESH,
    sites,
    site_positions: sites.map(() => [0, 0, 0]),
    cells: sites.map((_, site) => ({ site, area: 1, boundary: [], neighbours: [] })),
    vertices: [],
    edges: [{ sites: [0, 1], vertices: [null, null], length: 1, points: [0, 1] }],
    dual: [],
    positions: [[0, 0, 0], [1, 0, 0]],
    pieces: PIECES,
    unreached_area: 0,
    warnings: [],
    effects: [],
    cost: COST,
    ...more,
  };
}

const PLY =
  "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

function ply(): ArrayBuffer {
  const head = new TextEncoder().encode(PLY);
  const bytes = new Uint8Array(head.length + 72 + 13);
  bytes.set(head);
  const view = new DataView(bytes.buffer);
  [0, 0, 0, 1, 0, 0, 0, 1, 0].forEach((value, k) => view.setFloat64(head.length + 8 * k, value, true));
  bytes[head.length + 72] = 3;
  [0, 1, 2].forEach((value, k) => view.setInt32(head.length + 73 + 4 * k, value, true));
  return bytes.buffer;
}

let requests: { path: string; document: { sites: unknown; statistics?: boolean } }[];
let heldAnswers: ((value: Response) => void)[];
let holdsAnswers: boolean;

beforeEach(() => {
  requests = [];
  heldAnswers = [];
  holdsAnswers = false;
  vi.stubGlobal("fetch", async (url: string, init: RequestInit = {}) => {
    if (String(url) === `/v1/meshes/${MESH}`) return Response.json({ id: MESH, vertices: 3, faces: 1, area: 0.5, bounding_box: { diagonal: 2 }, warnings: [] });
    if (String(url).endsWith("/content")) return new Response(ply());
    if (init.method !== "POST") return Response.json({});
    const document = JSON.parse(String(init.body)) as { sites: unknown; statistics?: boolean };
    requests.push({ path: String(url), document });
    const sites = Array.isArray(document.sites) ? document.sites : [{ face: 0, barycentric: [1, 0, 0] }, { face: 0, barycentric: [0, 1, 0] }];
    const answer = String(url).endsWith("optimizations")
      ? diagramOf(sites, {
        energy: 1,
        terms: [],
        gradient_norm: 0,
        iterations: 1,
        history: [{ energy: 2, gradient_norm: 1, step_length: 0 }, { energy: 1, gradient_norm: 0, step_length: 1 }],
        stopped: "converged",
        statistics: { before: STATISTICS, after: STATISTICS },
        accuracy: { tolerance: 1, gradient_tolerance: 1, gradient_norm: 0 },
      })
      : diagramOf(sites, { ...(document.statistics && { statistics: STATISTICS }), accuracy: { method: "exact", relative_error: 0, relative_error_bound: 0 } });
    if (!holdsAnswers) return Response.json(answer);
    return new Promise<Response>((resolve) => heldAnswers.push(() => resolve(Response.json(answer))));
  });
});
afterEach(() => vi.unstubAllGlobals());

async function openSession(): Promise<{ voronoi: VoronoiSession; view: VoronoiView; mesh: MeshSession }> {
  const mesh = new MeshSession(new Client(), findings);
  const voronoi = new VoronoiSession(mesh, new Client());
  const view = new VoronoiView(voronoi);
  mesh.setTool("voronoi");
  await mesh.open(MESH);
  return { voronoi, view, mesh };
}

describe("sites", () => {
  it("are scattered by the server and seen with their cells", async () => {
    const { voronoi, view } = await openSession();
    voronoi.change({ count: 2, seed: 9 });
    await voronoi.scatter();
    expect(requests[0]).toMatchObject({ path: "/v1/voronoi-diagrams", document: { sites: { count: 2, seed: 9 } } });
    expect(voronoi.sites.get()).toHaveLength(2);
    expect(voronoi.state.get().scattered).toBe(true);
    expect(view.picture.get()?.lines).toEqual([[[0, 0, 0], [1, 0, 0]]]);
    expect(view.cells.get()?.faceSites).toEqual([0]);
    view.colourBy.set("none");
    expect(view.cells.get()).toBeNull();
  });

  it("that are dragged have their cells divided anew one request at a time, the last with statistics", async () => {
    const { voronoi } = await openSession();
    voronoi.place({ vertex: 0 });
    voronoi.place({ vertex: 1 });
    await vi.waitFor(() => expect(voronoi.result.get()?.diagram.cells).toHaveLength(2));
    holdsAnswers = true;
    const before = requests.length;
    for (const weight of [0.1, 0.2, 0.3]) voronoi.move(1, { face: 0, barycentric: [1 - weight, weight, 0] }, false);
    voronoi.move(1, { face: 0, barycentric: [0.5, 0.5, 0] }, true);
    await vi.waitFor(() => expect(heldAnswers).toHaveLength(1));
    expect(requests).toHaveLength(before + 1);
    expect(requests[before].document.statistics).toBe(false);
    holdsAnswers = false;
    heldAnswers[0](undefined as unknown as Response);
    await vi.waitFor(() => expect(requests).toHaveLength(before + 2));
    expect(requests[before + 1].document).toMatchObject({ sites: [{ vertex: 0 }, { face: 0, barycentric: [0.5, 0.5, 0] }], statistics: true });
    await vi.waitFor(() => expect(voronoi.result.get()?.now).not.toBeNull());
    expect(voronoi.chosen.get()).toBe(1);
    voronoi.remove(0);
    await vi.waitFor(() => expect(voronoi.result.get()?.diagram.cells).toHaveLength(1));
    voronoi.remove(0);
    expect(voronoi.result.get()).toBeNull();
  });

  it("are optimized, and what was said of them before stays beside what is said now", async () => {
    const { voronoi } = await openSession();
    await voronoi.scatter();
    await voronoi.optimize();
    expect(requests[1].path).toBe("/v1/voronoi-optimizations");
    expect(voronoi.result.get()).toMatchObject({ before: STATISTICS, now: STATISTICS });
    expect(voronoi.optimizing.get()?.steps).toEqual([{ iteration: 0, energy: 2, gradient: 1 }, { iteration: 1, energy: 1, gradient: 0 }]);
    expect(voronoi.state.get().scattered).toBe(false);
    voronoi.move(0, { vertex: 2 }, true);
    expect(voronoi.optimizing.get()).toBeNull();
  });

  it("are forgotten with their mesh", async () => {
    const { voronoi, mesh } = await openSession();
    await voronoi.scatter();
    mesh.mesh.set({ ...(mesh.mesh.get() as NonNullable<ReturnType<typeof mesh.mesh.get>>), info: { id: "cd".repeat(32) } as never });
    expect(voronoi.sites.get()).toEqual([]);
    expect(voronoi.result.get()).toBeNull();
  });
});
