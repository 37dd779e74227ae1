// The mesh session: the present mesh, the points that are picked on it, and the server's answers about them.
import { type AccuracyChoice, NORMAL, rememberedLevel } from "../base/accuracy_choice";
import { atLevel, LevelMeasures } from "../base/accuracy_levels";
import { History } from "../base/history";
import { Observable } from "../base/observable";
import { type Client, Problem, readJson } from "../contract/client";
import { type Activity, JobRunner, type Run, type Task, type WorkInWords } from "../contract/runner";
import type { Effect, Geodesics, Job, KarcherMean, Mesh, Repair, SurfacePoint } from "../contract/types";
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
  /** Optional parts of the computation. */
  readonly effects: readonly Effect[];
}

export const NO_FINDING: Finding = { paths: [], distances: null, mean: null, facts: [], notes: [], effects: [] };

export type MeshActivity = Activity<WorkInWords>;

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
  distance(distances: readonly (number | null)[], seconds: number, bound: number | null, effects?: readonly Effect[]): Finding;
  mean(mean: KarcherMean, geodesics: Geodesics): Finding;
}

export class MeshSession {
  readonly mesh = new Observable<LoadedMesh | null>(null);
  readonly points = new Observable<readonly SurfacePoint[]>([]);
  readonly tool = new Observable<Tool>("path");
  /** Number of starts of the search for a mean; the lowest minimum is shown. */
  readonly starts = new Observable(1);
  /** Accuracy of distance fields. Paths and means are exact. */
  readonly accuracy = new Observable<AccuracyChoice>({ ...NORMAL, level: rememberedLevel("distances") });
  /** What the last distance fields took. */
  readonly measures = new LevelMeasures();
  readonly finding = new Observable<Finding>(NO_FINDING);
  readonly activity = new Observable<MeshActivity>({ kind: "idle" });
  readonly known = new Observable<readonly Mesh[]>([]);
  /** Repairs that uploads request. */
  readonly repairs = new Observable<readonly Repair[]>([]);
  readonly refused = new Observable<RefusedUpload | null>(null);
  readonly steps = new Observable({ undo: false, redo: false });
  private history = new History<readonly SurfacePoint[]>([]);
  /** Loads meshes. */
  private readonly loading: JobRunner;
  /** Computes findings. */
  private readonly computing: JobRunner;

  constructor(
    private readonly client: Client,
    private readonly read: FindingReaders,
  ) {
    this.loading = new JobRunner(client, this.activity);
    this.computing = new JobRunner(client, this.activity);
  }

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
    return this.load(`Repairing ${words}`, async (run) => {
      const content = await this.contentOf(loaded.info);
      await this.showUploaded(await this.post(content, ["automatic"]), words, run);
    });
  }

  private send(content: Blob, words: string): Promise<void> {
    return this.load(`Uploading ${words}`, async (run) => {
      const response = await this.post(content, this.repairs.get()).catch((error: unknown) => {
        if (!run.isCancelled) this.offerRepairs(content, words, error);
        throw error;
      });
      await this.showUploaded(response, words, run);
    });
  }

  private post(content: Blob | ArrayBuffer, repairs: readonly Repair[]): Promise<Response> {
    return this.client.send("POST", uploadPath(repairs), content, { headers: { "Content-Type": "application/octet-stream" } });
  }

  /** Shows an uploaded mesh. The list has it even if it is no longer to be shown. */
  private async showUploaded(response: Response, words: string, run: Run<WorkInWords>): Promise<void> {
    const info = await readJson<Mesh>(response);
    storeName(info.id, words);
    try {
      await this.show(info, run);
      this.forgetRefused();
    } finally {
      void this.list();
    }
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
    return this.load("Loading the mesh", async (run) => {
      const info = await this.client.get<Mesh>(`/v1/meshes/${id}`);
      await this.show(info, run, points.filter((point) => existsOn(info, point)));
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

  setAccuracy(accuracy: AccuracyChoice): void {
    this.accuracy.set(accuracy);
    if (this.tool.get() === "distance") this.compute();
  }

  cancel(): void {
    this.loading.cancel();
    this.computing.cancel();
  }

  retry(): void {
    if (this.computing.hasFailed) this.compute();
  }

  position(point: SurfacePoint): Vector {
    const { data } = this.mesh.get() as LoadedMesh;
    return "vertex" in point ? vertexPosition(data, point.vertex) : facePosition(data, point.face, point.barycentric);
  }

  private load(words: string, task: Task<WorkInWords>): Promise<void> {
    this.computing.stop();
    return this.loading.begin({ words }, task);
  }

  /** Shows a mesh. It is also put into the list at once, before the server's list is read again. */
  private async show(info: Mesh, run: Run<WorkInWords>, points: readonly SurfacePoint[] = []): Promise<void> {
    const data = parsePly(await run.unlessCancelled(this.contentOf(info)));
    const known = this.known.get();
    if (!known.some((mesh) => mesh.id === info.id)) this.known.set([info, ...known]);
    this.points.set([]);
    this.finding.set(NO_FINDING);
    this.mesh.set({ info, data });
    this.history = new History(points);
    this.usePoints(points);
  }

  /** Requests a new result. `urgent`: a running request is stopped. It is not urgent while a point is dragged, because then no result would ever appear. */
  private compute(urgent = true): void {
    const mesh = this.mesh.get();
    const points = this.points.get();
    const tool = this.tool.get();
    if (!mesh || tool === "network" || tool === "voronoi" || points.length < (tool === "distance" ? 1 : 2)) {
      this.computing.stop();
      if (!this.loading.isRunning) this.activity.set({ kind: "idle" });
      return this.finding.set(NO_FINDING);
    }
    this.computing.follow(async (run) => {
      run.tell({ words: "Computing" });
      this.finding.set(await this.ask(tool, mesh.info.id, points, run));
    }, this.computing.tellFault, urgent);
  }

  private async ask(tool: PointTool, mesh: string, points: readonly SurfacePoint[], run: Run<WorkInWords>): Promise<Finding> {
    const onJob = ({ stage, progress }: Job) => run.tell({ words: stage || "Computing" }, progress);
    const answerOf = <Answer>(path: string, document: unknown) => run.job<Answer>(path, document, { wait: IMMEDIATE_SECONDS, onJob });
    if (tool === "distance") {
      type Field = { distances: (number | null)[]; cost: { seconds: number }; accuracy: { relative_error_bound: number | null }; effects?: readonly Effect[] };
      const accuracy = this.accuracy.get();
      const request: { mesh: string; sources: readonly SurfacePoint[]; accuracy?: object } = { mesh, sources: points };
      const field = await answerOf<Field>("/v1/geodesic-fields", atLevel(request, "geodesics", accuracy));
      const { relative_error_bound: error } = field.accuracy;
      this.measures.record("geodesics", { level: accuracy.level, seconds: field.cost.seconds, error });
      return this.read.distance(field.distances, field.cost.seconds, error, field.effects);
    }
    if (tool === "path") {
      const pairs = points.slice(1).map((to, k) => ({ from: points[k], to }));
      return this.read.path(await answerOf<Geodesics>("/v1/geodesics", { mesh, pairs, paths: true }));
    }
    const mean = await answerOf<KarcherMean>("/v1/karcher-means", { mesh, points, starts: this.starts.get() });
    const pairs = points.map((to) => ({ from: mean.mean, to }));
    return this.read.mean(mean, await answerOf<Geodesics>("/v1/geodesics", { mesh, pairs, paths: true }));
  }
}

function existsOn(info: Mesh, point: SurfacePoint): boolean {
  return "vertex" in point ? point.vertex < info.vertices : point.face < info.faces;
}
