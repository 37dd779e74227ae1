// The Voronoi session: sites on the present mesh are scattered, placed, moved and optimized, and the diagram is updated and saved. It
// does not depend on elements of the page.
import { rememberedLevel } from "../base/accuracy_choice";
import { LevelMeasures } from "../base/accuracy_levels";
import { Observable } from "../base/observable";
import type { Client } from "../contract/client";
import { JobRunner, type Run, type Task, type WorkInWords } from "../contract/runner";
import type { Job, PartialOptimization, SurfacePoint, VoronoiDiagram, VoronoiDiagramRequest, VoronoiOptimization, VoronoiOptimizationRequest,
  VoronoiStatistics } from "../contract/types";
import type { MeshData, Vector } from "./mesh_data";
import type { MeshActivity, MeshSession } from "./session";
import { DEFAULT_VORONOI, diagramRequest, hasObjective, optimizationRequest, type VoronoiState, withToggledFixed, withoutSite } from "./voronoi_state";

const PATH = { diagrams: "/v1/voronoi-diagrams", optimizations: "/v1/voronoi-optimizations" };
/** Time in seconds after which a computation becomes a job with progress. */
const IMMEDIATE_SECONDS = 1;

export interface VoronoiStep {
  readonly iteration: number;
  readonly energy: number;
  readonly gradient: number;
}

/** A running or finished optimization. */
export interface OptimizationRun {
  readonly request: VoronoiOptimizationRequest;
  readonly steps: readonly VoronoiStep[];
  /** The last intermediate diagram with borders; null if there is none. */
  readonly partial: PartialOptimization | null;
  /** The answer; null while it runs. */
  readonly answer: VoronoiOptimization | null;
}

/** A diagram with its statistics; after an optimization also those before it. */
export interface DiagramResult {
  readonly diagram: VoronoiDiagram | VoronoiOptimization;
  readonly before: VoronoiStatistics | null;
  /** Statistics of the diagram; null while sites are moved. */
  readonly now: VoronoiStatistics | null;
}

export type VoronoiFile = "obj" | "vtu" | "svg" | "csv";
const FILE_TYPES: Record<VoronoiFile, string> = { obj: "model/obj", vtu: "application/x-vtu+xml", svg: "image/svg+xml", csv: "text/csv" };

export class VoronoiSession {
  readonly state = new Observable<VoronoiState>({ ...DEFAULT_VORONOI, accuracy: { ...DEFAULT_VORONOI.accuracy, level: rememberedLevel("voronoi") } });
  readonly sites = new Observable<readonly SurfacePoint[]>([]);
  readonly result = new Observable<DiagramResult | null>(null);
  readonly optimizing = new Observable<OptimizationRun | null>(null);
  readonly chosen = new Observable<number | null>(null);
  readonly activity = new Observable<MeshActivity>({ kind: "idle" });
  /** What the last diagrams and optimizations took. */
  readonly measures = new LevelMeasures();
  /** Runs what the user has asked for. */
  private readonly runner: JobRunner;
  /** Computes diagrams while sites are moved. */
  private readonly following: JobRunner;
  private mesh = "";

  constructor(
    private readonly session: MeshSession,
    client: Client,
  ) {
    this.runner = new JobRunner(client, this.activity);
    this.following = new JobRunner(client, this.activity);
    session.mesh.watch((loaded) => {
      if (!loaded || loaded.info.id === this.mesh) return;
      this.cancel();
      this.mesh = loaded.info.id;
      this.setSites([]);
    });
  }

  get data(): MeshData | null {
    return this.session.mesh.get()?.data ?? null;
  }

  position(site: SurfacePoint): Vector {
    return this.session.position(site);
  }

  change(change: Partial<VoronoiState>): void {
    const before = this.state.get();
    this.state.set({ ...before, ...change });
    const accuracyOf = (state: VoronoiState) => JSON.stringify(diagramRequest(this.mesh, state, [], true).accuracy);
    if (accuracyOf(this.state.get()) !== accuracyOf(before)) this.requestDiagram(true);
  }

  /** Sets the state of a link after its mesh was loaded. */
  async restore(state: VoronoiState, sites: readonly SurfacePoint[]): Promise<void> {
    this.state.set(state);
    if (state.scattered) await this.scatter();
    else {
      this.sites.set(sites);
      this.requestDiagram(true);
    }
  }

  /** Replaces all sites by random ones. */
  scatter(): Promise<void> {
    const { count, seed } = this.state.get();
    return this.attempt("Scattering sites", async (run) => {
      const answer = await this.ask(diagramRequest(this.mesh, this.state.get(), { count, seed }, true), run);
      this.state.set({ ...this.state.get(), scattered: true, fixed: [] });
      this.optimizing.set(null);
      this.chosen.set(null);
      this.sites.set(answer.sites as SurfacePoint[]);
      this.result.set({ diagram: answer, before: null, now: answer.statistics ?? null });
    });
  }

  place(site: SurfacePoint): void {
    this.chosen.set(this.sites.get().length);
    this.changeSites([...this.sites.get(), site], true);
  }

  /** Moves a site. `done`: it was released there. */
  move(site: number, to: SurfacePoint, done: boolean): void {
    this.chosen.set(site);
    this.changeSites(this.sites.get().map((one, k) => (k === site ? to : one)), done);
  }

  remove(site: number): void {
    this.state.set(withoutSite(this.state.get(), site));
    this.chosen.set(null);
    this.changeSites(this.sites.get().filter((_, k) => k !== site), true);
  }

  clear(): void {
    this.cancel();
    this.setSites([]);
  }

  toggleFixed(site: number): void {
    this.state.set(withToggledFixed(this.state.get(), site));
  }

  get canOptimize(): boolean {
    return this.sites.get().length > 0 && hasObjective(this.state.get());
  }

  /** Optimizes the sites for the objectives. Intermediate diagrams are shown. */
  optimize(): Promise<void> {
    const request = optimizationRequest(this.mesh, this.state.get(), this.sites.get());
    return this.attempt("Optimizing", async (run) => {
      const steps: VoronoiStep[] = [];
      let seen: PartialOptimization | null = null;
      this.optimizing.set({ request, steps, partial: null, answer: null });
      const onJob = (job: Job): void => {
        const partial = partialOf(job);
        run.tell({ words: partial ? `Optimizing, iteration ${partial.iteration}` : "Optimizing" }, job.progress > 0 ? job.progress : null);
        if (!partial || (steps.length > 0 && partial.iteration <= steps[steps.length - 1].iteration)) return;
        steps.push({ iteration: partial.iteration, energy: partial.energy, gradient: partial.gradient_norm });
        if (partial.borders && partial.site_positions) seen = partial;
        this.optimizing.set({ request, steps: [...steps], partial: seen, answer: null });
      };
      const { level } = this.state.get().accuracy;
      const answer = await run.job<VoronoiOptimization>(PATH.optimizations, request, { onJob });
      this.measures.record("voronoi_optimizations", { level, seconds: answer.cost.seconds, error: null });
      const history = answer.history.map(({ energy, gradient_norm }, iteration): VoronoiStep => ({ iteration, energy, gradient: gradient_norm }));
      this.state.set({ ...this.state.get(), scattered: false });
      this.sites.set(answer.sites as SurfacePoint[]);
      this.result.set({ diagram: answer, before: answer.statistics.before, now: answer.statistics.after });
      this.optimizing.set({ request, steps: history, partial: null, answer });
    });
  }

  /** Saves a file of the present diagram. `scale`: millimetres for each mesh unit, for panels. */
  file(kind: VoronoiFile, scale: number, save: (text: string) => void): Promise<void> {
    return this.attempt("Making the file", async (run) => {
      const request = { ...diagramRequest(this.mesh, this.state.get(), [...this.sites.get()], false), panel_scale: scale };
      save(await run.file(PATH.diagrams, request, FILE_TYPES[kind]));
    });
  }

  cancel(): void {
    this.following.cancel();
    this.runner.cancel();
    this.forgetUnfinished();
  }

  private forgetUnfinished(): void {
    const optimizing = this.optimizing.get();
    if (optimizing && !optimizing.answer) this.optimizing.set(null);
  }

  private setSites(sites: readonly SurfacePoint[]): void {
    this.state.set({ ...this.state.get(), scattered: false, fixed: this.state.get().fixed.filter((site) => site < sites.length) });
    this.chosen.set(null);
    this.sites.set(sites);
    this.optimizing.set(null);
    this.result.set(null);
  }

  private changeSites(sites: readonly SurfacePoint[], done: boolean): void {
    if (this.runner.isRunning) this.cancel();
    if (this.optimizing.get()) this.optimizing.set(null);
    if (this.state.get().scattered) this.state.set({ ...this.state.get(), scattered: false });
    this.sites.set(sites);
    if (sites.length === 0) this.result.set(null);
    this.requestDiagram(done);
  }

  /** Requests the diagram of the present sites. One request runs at a time, and only the newest waits. */
  private requestDiagram(done: boolean): void {
    this.following.follow(async (run) => {
      const sites = this.sites.get();
      if (!this.session.mesh.get() || sites.length === 0) return;
      const answer = await this.ask({ ...diagramRequest(this.mesh, this.state.get(), [...sites], done), keep: true }, run);
      // The answer is obsolete if sites were added or removed meanwhile; another request is waiting.
      if (this.sites.get().length === sites.length) this.result.set({ diagram: answer, before: null, now: answer.statistics ?? null });
    }, this.following.tellFault);
  }

  private async ask(request: VoronoiDiagramRequest, run: Run<WorkInWords>): Promise<VoronoiDiagram> {
    const { level } = this.state.get().accuracy;
    const onJob = ({ stage, progress }: Job): void => run.tell({ words: stage || "Dividing the surface" }, progress > 0 ? progress : null);
    const answer = await run.job<VoronoiDiagram>(PATH.diagrams, request, { wait: IMMEDIATE_SECONDS, onJob });
    // What a moved site takes, of which most of the diagram is kept, says nothing of a whole one.
    if (request.statistics && !request.keep) this.measures.record("voronoi", { level, seconds: answer.cost.seconds, error: null });
    return answer;
  }

  private attempt(words: string, task: Task<WorkInWords>): Promise<void> {
    this.cancel();
    return this.runner.begin({ words }, task, (error) => {
      this.forgetUnfinished();
      this.runner.tellFailure(error);
    });
  }
}

function partialOf({ partial }: Job): PartialOptimization | null {
  return partial && "step_length" in partial ? partial : null;
}
