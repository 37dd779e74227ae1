// The network session with a mock of the server, whose job sends the events of the test.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client } from "../src/contract/client";
import type { EmbeddedSystem, EmbeddedSystemRequest } from "../src/contract/types";
import { findings } from "../src/mesh/findings";
import { NetworkSession } from "../src/mesh/network_session";
import { DEFAULT_NETWORK } from "../src/mesh/network_state";
import { NetworkView } from "../src/mesh/network_view";
import { MeshSession } from "../src/mesh/session";

const ID = "cd".repeat(32);
const INFO = { id: ID, vertices: 3, faces: 1, area: 0.5, bounding_box: { diagonal: 2 }, warnings: [] };
const PLACES = [[0, 0, 0], [1, 0, 0], [0, 1, 0]];

/** The answer to a request: three points near the vertices of the mesh, with springs, and with a membrane and a host if they were requested. */
function answerTo(request: EmbeddedSystemRequest): EmbeddedSystem {
  const springs = Array.isArray(request.springs) ? request.springs : [{ between: [0, 1], weight: 0 }, { between: [0, 2], weight: 0 }];
  const weight = request.paths ? 0.9 : 1;
  return {
    mesh: ID,
    points: PLACES.map((_, vertex) => ({ face: 0, barycentric: [0, 1, 2].map((corner) => (corner === vertex ? weight : (1 - weight) / 2)) })),
    positions: PLACES,
    springs: springs.map(({ between }) => ({
      between,
      length: 1,
      energy: 0.25,
      compressed: false,
      at_cut_locus: false,
      path: [[0, 0, 0], [0.5, 0.1, 0], [1, 0, 0]].map((position) => ({ face: 0, barycentric: [1, 0, 0], position })),
    })),
    energy: 0.5,
    terms: [],
    gradient_norm: 1e-12,
    iterations: 2,
    history: [3, 1e-3, 1e-12].map((gradient_norm, k) => ({ energy: 2 - k, gradient_norm, step_length: 0, regularization: 0 })),
    ...(request.triangles && { triangles: [[0, 1, 2]], membrane: [{ energy: 0.5, stretches: [1.5, 0.75], at_cut_locus: false }] }),
    ...(request.host && { host: { vertices: PLACES.map(([x, y, z]) => [2 * x, y, z]), largest_displacement: 1 } }),
    stopped: "converged",
    mollified: false,
    at_vertices: [],
    loose_points: [],
    warnings: [],
    accuracy: { tolerance: 1e-9, gradient_tolerance: 2e-9, gradient_norm: 1e-12, mollifier_length: 1e-6 },
    effects: [],
    cost: { seconds: 0.1, stages: [], quantities: {} },
  } as unknown as EmbeddedSystem;
}

function ply(): ArrayBuffer {
  const header = new TextEncoder().encode(
    "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
  );
  const buffer = new ArrayBuffer(header.length + 72 + 13);
  new Uint8Array(buffer).set(header);
  const view = new DataView(buffer, header.length);
  PLACES.flat().forEach((value, k) => view.setFloat64(8 * k, value, true));
  view.setUint8(72, 3);
  [0, 1, 2].forEach((vertex, k) => view.setInt32(73 + 4 * k, vertex, true));
  return buffer;
}

let requests: EmbeddedSystemRequest[];
let dismissed: number;
/** Sends an event of the job; undefined while there is no job. */
let sendEvent: ((name: string, partial?: object) => void) | undefined;

function job(state: string, partial?: object): string {
  return JSON.stringify({
    id: "j1",
    kind: "embedded-systems",
    state,
    progress: 0.5,
    stage: "step",
    priority: "normal",
    created: "",
    deadline: 600,
    remaining_seconds: null,
    partial,
  });
}

async function serve(url: string, init: RequestInit = {}): Promise<Response> {
  const path = String(url);
  if (path === `/v1/meshes/${ID}`) return Response.json(INFO);
  if (path.endsWith("/content")) return new Response(ply());
  if (init.method === "DELETE") {
    ++dismissed;
    return new Response(null, { status: 200 });
  }
  if (path === "/v1/embedded-systems") {
    requests.push(JSON.parse(String(init.body)) as EmbeddedSystemRequest);
    return requests.at(-1)?.paths ? new Response(job("accepted"), { status: 202 }) : Response.json(answerTo(requests.at(-1) as EmbeddedSystemRequest));
  }
  if (path.endsWith("/events")) {
    const stream = new ReadableStream<Uint8Array>({
      start(controller) {
        sendEvent = (name, partial) => controller.enqueue(new TextEncoder().encode(`event: ${name}\ndata: ${job(name === "finished" ? "successful" : "running", partial)}\n\n`));
        init.signal?.addEventListener("abort", () => controller.error(new DOMException("stopped", "AbortError")));
      },
    });
    return new Response(stream);
  }
  return Response.json(answerTo(requests.at(-1) as EmbeddedSystemRequest));
}

beforeEach(() => {
  [requests, dismissed, sendEvent] = [[], 0, undefined];
  vi.stubGlobal("fetch", serve);
});
afterEach(() => vi.unstubAllGlobals());

async function openSession(): Promise<{ mesh: MeshSession; network: NetworkSession; view: NetworkView }> {
  const client = new Client();
  const mesh = new MeshSession(client, findings);
  const network = new NetworkSession(mesh, client);
  mesh.setTool("network");
  await mesh.open(ID);
  return { mesh, network, view: new NetworkView(network) };
}

function forgetJob(): void {
  sendEvent = undefined;
}

const jobStarted = () => vi.waitFor(() => expect(sendEvent).toBeDefined());
const moved = (iteration: number) => ({
  iteration,
  energy: 2 - iteration,
  gradient_norm: 10 ** (-3 * iteration),
  positions: PLACES.map(([x, y, z]) => [x + 0.1 * iteration, y, z]),
});

describe("a network session", () => {
  it("makes the network, shows where its points are while it relaxes, and its paths in the end", async () => {
    const { network, view } = await openSession();
    const relaxed = network.relax();
    await jobStarted();
    expect(requests[0].springs).toEqual({ kind: "voronoi_dual", weight: 0 });
    expect(requests[1].springs).toEqual([{ between: [0, 1], rest_length: 0, weight: 1 }, { between: [0, 2], rest_length: 0, weight: 1 }]);
    for (const iteration of [0, 1, 1]) sendEvent?.("progress", moved(iteration));
    await vi.waitFor(() => expect(network.relaxing.get()?.steps.map((step) => step.gradient)).toEqual([1, 1e-3]));
    expect(network.relaxing.get()?.gradientTolerance).toBeCloseTo(2e-9, 15);
    expect(view.picture.get()?.positions[1]).toEqual([1.1, 0, 0]);
    expect(view.picture.get()?.lines[0]).toEqual([[0.1, 0, 0], [1.1, 0, 0]]);
    sendEvent?.("finished");
    await relaxed;
    expect(network.relaxing.get()?.steps.map((step) => step.gradient)).toEqual([3, 1e-3, 1e-12]);
    expect(view.picture.get()?.lines[0]).toHaveLength(3);
    view.frame.set(network.relaxing.get()?.frames[1] ?? null);
    expect(view.picture.get()?.positions[1]).toEqual([1.1, 0, 0]);
    expect(network.activity.get()).toEqual({ kind: "idle" });
  });

  it("dismisses the job when it is cancelled, and keeps the network as it was made", async () => {
    const { network, view } = await openSession();
    const relaxed = network.relax();
    await jobStarted();
    sendEvent?.("progress", moved(1));
    await vi.waitFor(() => expect(network.relaxing.get()?.steps).toHaveLength(1));
    network.cancel();
    await relaxed;
    expect(dismissed).toBe(1);
    expect(network.relaxing.get()).toBeNull();
    expect(network.isMade).toBe(true);
    expect(view.picture.get()?.positions).toEqual(PLACES);
  });

  it("needs no server for a network that is picked and drawn, and follows what is taken away", async () => {
    const { mesh, network, view } = await openSession();
    network.change({ points: "picked", springs: "drawn" });
    mesh.setPoints([{ vertex: 0 }, { vertex: 1 }, { vertex: 2 }]);
    network.join(2);
    network.join(1);
    network.toggleFixed(2);
    expect(view.picture.get()?.lines).toEqual([[[1, 0, 0], [0, 1, 0]]]);
    expect(view.picture.get()?.kinds).toEqual(["free", "free", "fixed"]);
    network.removePicked(0);
    expect(network.state.get()).toMatchObject({ fixed: [1], drawn: [{ between: [0, 1] }] });
    expect(view.picture.get()?.lines).toEqual([[[1, 0, 0], [0, 1, 0]]]);
    expect(requests).toEqual([]);
  });

  it("says where a relaxation is no longer that of the settings, and goes on from where one ended", async () => {
    const { network } = await openSession();
    const relaxed = network.relax();
    await jobStarted();
    sendEvent?.("finished");
    await relaxed;
    expect(network.isStale).toBe(false);
    network.change({ restLength: 0.5 });
    expect(network.isStale).toBe(true);
    network.change({ restLength: 0 });
    expect(network.isStale).toBe(false);
    forgetJob();
    const further = network.relax(true);
    await jobStarted();
    expect(requests.at(-1)?.points).toEqual(answerTo(requests[1]).points);
    sendEvent?.("finished");
    await further;
    expect(network.isStale).toBe(false);
  });

  it("shows a membrane’s stretches by straight sides while it relaxes, exactly in the end, and goes on from where it is at rest", async () => {
    const { network, view } = await openSession();
    network.change({ elements: "membrane", restScale: 0.5 });
    const relaxed = network.relax();
    await jobStarted();
    expect(requests[0]).toMatchObject({ springs: [], triangles: { kind: "voronoi_dual" } });
    expect(requests[1]).toMatchObject({ triangles: [[0, 1, 2]], membrane: { rest_scale: 0.5 } });
    expect(view.stretches.get()).toEqual({ min: 2, max: 2, exact: false });
    sendEvent?.("progress", { ...moved(1), positions: [[0, 0, 0], [2, 0, 0], [0, 1, 0]] });
    await vi.waitFor(() => expect(view.stretches.get()).toEqual({ min: 2, max: 4, exact: false }));
    expect(network.relaxing.get()?.gradientTolerance).toBeCloseTo(2e-9, 15);
    sendEvent?.("finished");
    await relaxed;
    expect(view.stretches.get()).toEqual({ min: 0.75, max: 1.5, exact: true });
    expect(view.picture.get()?.triangles).toEqual([[0, 1, 2]]);
    expect(view.triangleRange.get()).toEqual({ min: 1.5, max: 1.5 });
    view.triangleColourBy.set("density");
    expect(view.triangleRange.get().max).not.toBe(1.5);
    forgetJob();
    const further = network.relax(true);
    await jobStarted();
    expect(requests.at(-1)).toEqual({ ...requests[1], max_iterations: 202 });
    sendEvent?.("finished");
    await further;
    expect(network.isStale).toBe(false);
    network.change({ youngsModulus: 3 });
    expect(network.isStale).toBe(true);
  });

  it("shows the surface as it gives way, in the end as well, at rest on demand, and starts anew to go on", async () => {
    const { network, view } = await openSession();
    network.changeHost({ kind: "shell", supports: [0] });
    const relaxed = network.relax();
    await jobStarted();
    expect(requests[0]).not.toHaveProperty("host");
    expect(requests[1]).toMatchObject({ host: { kind: "shell", fixed_vertices: [0] } });
    expect(view.host.get()).toBeNull();
    const vertices = PLACES.map(([x, y, z]) => [1.5 * x, y, z]);
    sendEvent?.("progress", { ...moved(1), vertices });
    await vi.waitFor(() => expect(view.host.get()?.vertices).toEqual(vertices));
    expect(view.deformation.get()).toBeCloseTo(1.5, 12);
    expect(view.host.get()?.colours).toHaveLength(1);
    sendEvent?.("finished");
    await relaxed;
    expect(view.host.get()?.vertices?.[1]).toEqual([2, 0, 0]);
    expect(view.deformation.get()).toBeCloseTo(2, 12);
    view.deformationBy.set("none");
    expect(view.host.get()?.colours).toBeNull();
    view.atRest.set(true);
    expect(view.host.get()?.vertices).toBeNull();
    const [first] = view.picture.get()?.positions ?? [];
    expect(first[0]).toBeCloseTo(0.05, 12);
    expect(first[1]).toBeCloseTo(0.05, 12);
    view.atRest.set(false);
    view.frame.set(network.relaxing.get()?.frames[0] ?? null);
    expect(view.host.get()).toBeNull();
    forgetJob();
    const further = network.relax(true);
    await jobStarted();
    expect(requests.at(-1)).toEqual({ ...requests[1], max_iterations: 202 });
    sendEvent?.("finished");
    await further;
    network.toggleSupport(2);
    expect(network.isStale).toBe(true);
    network.toggleSupport(2);
    expect(network.isStale).toBe(false);
  });

  it("follows supports that are moved, with one request at a time, and shows what was at rest meanwhile", async () => {
    const { network, view } = await openSession();
    network.changeHost({ kind: "shell", supports: [0, 1] });
    network.moveTogether.set(false);
    network.moveSupport(1, [2, 0, 0]);
    expect(network.activity.get()).toMatchObject({ kind: "failed", sentence: expect.stringMatching(/three/) as string });
    expect(requests).toEqual([]);
    network.changeHost({ supports: [0, 1, 2] });
    network.moveSupport(1, [2, 0, 0]);
    await jobStarted();
    expect(network.chosenSupport.get()).toBe(1);
    expect(requests[1].host).toMatchObject({ fixed_vertices: [0, 2], moved_vertices: [{ vertex: 1, positions: [[2, 0, 0]] }] });
    for (const x of [3, 4, 5]) network.moveSupport(1, [x, 0, 0]);
    sendEvent?.("progress", { ...moved(1), vertices: PLACES });
    sendEvent?.("finished");
    await vi.waitFor(() => expect(requests).toHaveLength(3));
    expect(requests[2].host).toMatchObject({ moved_vertices: [{ vertex: 1, positions: [[5, 0, 0]] }] });
    expect(view.host.get()?.vertices?.[1]).toEqual([2, 0, 0]);
    network.setMoves([]);
    await vi.waitFor(() => {
      sendEvent?.("finished");
      expect(requests).toHaveLength(4);
    });
    expect(requests[3].host).not.toHaveProperty("moved_vertices");
    network.changeHost({ supports: [0, 2] });
    expect(network.chosenSupport.get()).toBeNull();
    network.cancel();
  });

  it("has a host for the size of its mesh where a link tells of none, and supports that the mesh has", async () => {
    const { network } = await openSession();
    network.restore(DEFAULT_NETWORK);
    expect(network.state.get().host.thickness).toBe(0.06);
    network.restore({ ...DEFAULT_NETWORK, host: { ...DEFAULT_NETWORK.host, kind: "shell", supports: [1, 3] } });
    expect(network.state.get().host).toMatchObject({ thickness: 0.03, supports: [1] });
  });

  it("asks for the triangles of picked points too", async () => {
    const { mesh, network, view } = await openSession();
    network.change({ points: "picked", springs: "drawn", elements: "both" });
    mesh.setPoints([{ vertex: 0 }, { vertex: 1 }, { vertex: 2 }]);
    expect(network.isMade).toBe(false);
    expect(view.picture.get()?.positions).toEqual(PLACES);
    await network.make();
    expect(requests[0]).toMatchObject({ springs: [], triangles: { kind: "voronoi_dual" } });
    expect(network.isMade).toBe(true);
    expect(view.picture.get()?.triangles).toEqual([[0, 1, 2]]);
  });
});
