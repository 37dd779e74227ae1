// The mesh session: the present mesh, the points that are picked on it, and the server's answers about them.
import { History } from "../base/history";
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, isAbort, Problem, readJson } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { Geodesics, KarcherMean, Mesh, Repair, SurfacePoint } from "../contract/types";
import { facePosition, type MeshData, parsePly, type Vector, vertexPosition } from "./mesh_data";
import { storeName, nameOf } from "./names";
import { repairsAgainst, ordered, uploadPath } from "./repair";

export type Tool = "path" | "distance" | "mean" | "network" | "voronoi";
export const TOOLS: readonly Tool[] = ["path", "distance", "mean", "network", "voronoi"];

/** Limit of the number of starts for a mean. Each start takes as long as the first. */
export const MAX_STARTS = 50;

/** Tools whose results are updated whenever the points change. Networks and Voronoi diagrams have their own sessions. */
type PointTool = Exclude<Tool, "network" | "voronoi">;

export interface LoadedMesh {
  readonly info: Mesh;
  readonly data: MeshData;
}

/** A result: what is drawn on the surface, and its facts. */
export interface Finding {
  readonly paths: readonly (readonly Vector[])[];
  readonly distances: readonly number[] | null;
  readonly mean: Vector | null;
  readonly facts: readonly (readonly [string, string])[];
  readonly notes: readonly string[];
}

export const NO_FINDING: Finding = { paths: [], distances: null, mean: null, facts: [], notes: [] };

export type MeshActivity = { kind: "idle" } | { kind: "busy"; words: string; progress: number | null } | { kind: "failed"; sentence: string };

/** A file that was refused for faults that repairs may remove, and the repairs that were chosen before. */
export interface RefusedUpload {
  readonly content: Blob;
  readonly words: string;
  readonly repairsBefore: readonly Repair[];
}

/** Time in seconds after which a computation becomes a job with progress. */
const IMMEDIATE_SECONDS = 1;

/** Functions that convert the server's answers to findings. */
export interface FindingReaders {
  path(geodesics: Geodesics): Finding;
  distance(distances: readonly (number | null)[], seconds: number, bound: number | null): Finding;
  mean(mean: KarcherMean, geodesics: Geodesics): Finding;
}

export class MeshSession {
  readonly mesh = new Observable<LoadedMesh | null>(null);
  readonly points = new Observable<readonly SurfacePoint[]>([]);
  readonly tool = new Observable<Tool>("path");
  /** Number of starts of the search for a mean; the lowest minimum is shown. */
  readonly starts = new Observable(1);
  readonly finding = new Observable<Finding>(NO_FINDING);
  readonly activity = new Observable<MeshActivity>({ kind: "idle" });
  readonly known = new Observable<readonly Mesh[]>([]);
  /** Repairs that uploads request. */
  readonly repairs = new Observable<readonly Repair[]>([]);
  readonly refused = new Observable<RefusedUpload | null>(null);
  readonly steps = new Observable({ undo: false, redo: false });
  private history = new History<readonly SurfacePoint[]>([]);
  private readonly requests = new Latest();
  private unanswered = false;
  /** Counts the requests for meshes, so that answers to earlier ones are ignored. */
  private requestCount = 0;

  constructor(
    private readonly client: Client,
    private readonly read: FindingReaders,
  ) {}

  async list(): Promise<void> {
    try {
      this.known.set((await this.client.get<{ meshes: Mesh[] }>("/v1/meshes?limit=50")).meshes);
    } catch {
      // uploads work without the list, and the frame reports a lost connection
    }
  }

  upload(content: Blob, words: string): Promise<void> {
    this.forgetRefused();
    return this.send(content, words);
  }

  /** Uploads the refused file again with the chosen repairs, which are for this file only. */
  async repairRefused(): Promise<void> {
    const refused = this.refused.get();
    if (!refused) return;
    await this.send(refused.content, refused.words);
  }

  /** Uploads the present mesh again with the repairs that it needs, which are for this mesh only. */
  repairShown(): Promise<void> {
    const loaded = this.mesh.get();
    if (!loaded) return Promise.resolve();
    this.forgetRefused();
    const words = nameOf(loaded.info.id) ?? "the mesh";
    return this.attempt(`Repairing ${words}`, async (isWanted) => {
      const content = await this.contentOf(loaded.info);
      await this.showUploaded(await this.post(content, ["automatic"]), words, isWanted);
    });
  }

  private send(content: Blob, words: string): Promise<void> {
    return this.attempt(`Uploading ${words}`, async (isWanted) => {
      const response = await this.post(content, this.repairs.get()).catch((error: unknown) => {
        if (isWanted()) this.offerRepairs(content, words, error);
        throw error;
      });
      await this.showUploaded(response, words, isWanted);
    });
  }

  private post(content: Blob | ArrayBuffer, repairs: readonly Repair[]): Promise<Response> {
    return this.client.send("POST", uploadPath(repairs), content, { headers: { "Content-Type": "application/octet-stream" } });
  }

  private async showUploaded(response: Response, words: string, isWanted: () => boolean): Promise<void> {
    const info = await readJson<Mesh>(response);
    storeName(info.id, words);
    await this.show(info, isWanted);
    if (isWanted()) this.forgetRefused();
    void this.list();
  }

  private async contentOf(info: Mesh): Promise<ArrayBuffer> {
    return (await this.client.send("GET", `/v1/meshes/${info.id}/content`, undefined, { headers: { Accept: "model/ply" } })).arrayBuffer();
  }

  private offerRepairs(content: Blob, words: string, error: unknown): void {
    if (!(error instanceof Problem)) return;
    const repairs = this.repairs.get();
    const help = repairsAgainst(error.document, repairs);
    if (help.length === 0) return this.forgetRefused();
    this.refused.set({ content, words, repairsBefore: this.refused.get()?.repairsBefore ?? repairs });
    this.repairs.set(ordered([...repairs, ...help]));
  }

  private forgetRefused(): void {
    const refused = this.refused.get();
    if (!refused) return;
    this.repairs.set(refused.repairsBefore);
    this.refused.set(null);
  }

  open(id: string, points: readonly SurfacePoint[] = []): Promise<void> {
    this.forgetRefused();
    return this.attempt("Loading the mesh", async (isWanted) => {
      const info = await this.client.get<Mesh>(`/v1/meshes/${id}`);
      await this.show(info, isWanted, points.filter((point) => existsOn(info, point)));
    });
  }

  add(point: SurfacePoint): void {
    const loaded = this.mesh.get();
    if (loaded && existsOn(loaded.info, point)) this.setPoints([...this.points.get(), point]);
  }

  /** Sets the points, as one step of the history. */
  setPoints(points: readonly SurfacePoint[]): void {
    this.history.push(points);
    this.usePoints(points);
  }

  /** Moves a picked point. `done`: the drag has ended, and becomes one step of the history. */
  movePoint(index: number, to: SurfacePoint, done: boolean): void {
    const points = this.points.get().map((point, k) => (k === index ? to : point));
    if (done) return this.setPoints(points);
    this.points.set(points);
    this.compute(false);
  }

  undo(): void {
    if (this.followsPoints && this.history.undo()) this.usePoints(this.history.current);
  }

  redo(): void {
    if (this.followsPoints && this.history.redo()) this.usePoints(this.history.current);
  }

  setTool(tool: Tool): void {
    this.tool.set(tool);
    this.publishSteps();
    this.compute();
  }

  /** Whether the tool uses the points only for its result, so that they can be undone. Networks and Voronoi diagrams refer to points by index. */
  private get followsPoints(): boolean {
    return !["network", "voronoi"].includes(this.tool.get());
  }

  private usePoints(points: readonly SurfacePoint[]): void {
    this.points.set(points);
    this.publishSteps();
    this.compute();
  }

  private publishSteps(): void {
    this.steps.set({ undo: this.followsPoints && this.history.canUndo, redo: this.followsPoints && this.history.canRedo });
  }

  setStarts(starts: number): void {
    this.starts.set(starts);
    if (this.tool.get() === "mean") this.compute();
  }

  cancel(): void {
    ++this.requestCount;
    this.requests.cancel();
    this.activity.set({ kind: "idle" });
  }

  retry(): void {
    if (this.unanswered) this.compute();
  }

  position(point: SurfacePoint): Vector {
    const { data } = this.mesh.get() as LoadedMesh;
    return "vertex" in point ? vertexPosition(data, point.vertex) : facePosition(data, point.face, point.barycentric);
  }

  private async attempt(words: string, act: (isWanted: () => boolean) => Promise<void>): Promise<void> {
    const request = ++this.requestCount;
    const isWanted = () => request === this.requestCount;
    this.requests.cancel();
    this.activity.set({ kind: "busy", words, progress: null });
    try {
      await act(isWanted);
      if (isWanted()) this.activity.set({ kind: "idle" });
    } catch (error) {
      if (isWanted()) this.activity.set({ kind: "failed", sentence: explain(error) });
    }
  }

  /** Shows a mesh. It is also put into the list at once, before the server's list is read again. */
  private async show(info: Mesh, isWanted: () => boolean, points: readonly SurfacePoint[] = []): Promise<void> {
    const data = parsePly(await this.contentOf(info));
    if (!isWanted()) return;
    const known = this.known.get();
    if (!known.some((mesh) => mesh.id === info.id)) this.known.set([info, ...known]);
    this.points.set([]);
    this.finding.set(NO_FINDING);
    this.mesh.set({ info, data });
    this.history = new History(points);
    this.usePoints(points);
  }

  /** Requests a new result. `urgent`: a running request is aborted. It is not urgent while a point is dragged, because then no result would ever appear. */
  private compute(urgent = true): void {
    const mesh = this.mesh.get();
    const points = this.points.get();
    const tool = this.tool.get();
    const followsPoints = tool !== "network" && tool !== "voronoi";
    if (!mesh || !followsPoints || points.length < (tool === "distance" ? 1 : 2)) {
      this.requests.cancel();
      if (!followsPoints) this.activity.set({ kind: "idle" });
      return this.finding.set(NO_FINDING);
    }
    this.requests.submit(async (signal) => {
      this.activity.set({ kind: "busy", words: "Computing", progress: null });
      try {
        const finding = await this.ask(tool, mesh.info.id, points, signal);
        if (signal.aborted) return;
        this.finding.set(finding);
        this.unanswered = false;
        this.activity.set({ kind: "idle" });
      } catch (error) {
        if (isAbort(error)) return;
        this.unanswered = true;
        this.activity.set(error instanceof ConnectionLost ? { kind: "idle" } : { kind: "failed", sentence: explain(error) });
      }
    }, urgent);
  }

  private async ask(tool: PointTool, mesh: string, points: readonly SurfacePoint[], signal: AbortSignal): Promise<Finding> {
    const run = <Answer>(path: string, document: unknown) =>
      runJob<Answer>(this.client, path, document, {
        signal,
        wait: IMMEDIATE_SECONDS,
        onProgress: (job) => this.activity.set({ kind: "busy", words: job.stage || "Computing", progress: job.progress }),
      });
    if (tool === "distance") {
      type Field = { distances: (number | null)[]; cost: { seconds: number }; accuracy: { relative_error_bound: number | null } };
      const field = await run<Field>("/v1/geodesic-fields", { mesh, sources: points });
      return this.read.distance(field.distances, field.cost.seconds, field.accuracy.relative_error_bound);
    }
    if (tool === "path") {
      const pairs = points.slice(1).map((to, k) => ({ from: points[k], to }));
      return this.read.path(await run<Geodesics>("/v1/geodesics", { mesh, pairs, paths: true }));
    }
    const mean = await run<KarcherMean>("/v1/karcher-means", { mesh, points, starts: this.starts.get() });
    const pairs = points.map((to) => ({ from: mean.mean, to }));
    return this.read.mean(mean, await run<Geodesics>("/v1/geodesics", { mesh, pairs, paths: true }));
  }
}

function existsOn(info: Mesh, point: SurfacePoint): boolean {
  return "vertex" in point ? point.vertex < info.vertices : point.face < info.faces;
}
