// The Voronoi session: sites on the present mesh are scattered, placed, moved and optimized, and the diagram is updated and saved. It
// does not depend on elements of the page.
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
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
  readonly state = new Observable<VoronoiState>(DEFAULT_VORONOI);
  readonly sites = new Observable<readonly SurfacePoint[]>([]);
  readonly result = new Observable<DiagramResult | null>(null);
  readonly optimizing = new Observable<OptimizationRun | null>(null);
  readonly chosen = new Observable<number | null>(null);
  readonly activity = new Observable<MeshActivity>({ kind: "idle" });
  private readonly diagramRequests = new Latest();
  private running: AbortController | null = null;
  private mesh = "";

  constructor(
    private readonly session: MeshSession,
    private readonly client: Client,
  ) {
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
    const needsDiagram = (change.exactness ?? before.exactness) !== before.exactness || (change.deviation ?? before.deviation) !== before.deviation;
    if (needsDiagram) this.requestDiagram(true);
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
    return this.attempt("Scattering sites", async (signal) => {
      const answer = await this.ask({ ...diagramRequest(this.mesh, this.state.get(), { count, seed }, true) }, signal);
      if (signal.aborted) return;
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
    return this.attempt("Optimizing", async (signal) => {
      const steps: VoronoiStep[] = [];
      let seen: PartialOptimization | null = null;
      this.optimizing.set({ request, steps, partial: null, answer: null });
      const answer = await runJob<VoronoiOptimization>(this.client, PATH.optimizations, request, {
        signal,
        onProgress: (job) => {
          if (signal.aborted) return;
          const partial = partialOf(job);
          this.activity.set({ kind: "busy", words: partial ? `Optimizing, iteration ${partial.iteration}` : "Optimizing", progress: job.progress > 0 ? job.progress : null });
          if (!partial || (steps.length > 0 && partial.iteration <= steps[steps.length - 1].iteration)) return;
          steps.push({ iteration: partial.iteration, energy: partial.energy, gradient: partial.gradient_norm });
          if (partial.borders && partial.site_positions) seen = partial;
          this.optimizing.set({ request, steps: [...steps], partial: seen, answer: null });
        },
      });
      if (signal.aborted) return;
      const history = answer.history.map(({ energy, gradient_norm }, iteration): VoronoiStep => ({ iteration, energy, gradient: gradient_norm }));
      this.state.set({ ...this.state.get(), scattered: false });
      this.sites.set(answer.sites as SurfacePoint[]);
      this.result.set({ diagram: answer, before: answer.statistics.before, now: answer.statistics.after });
      this.optimizing.set({ request, steps: history, partial: null, answer });
    });
  }

  /** Saves a file of the present diagram. `scale`: millimetres for each mesh unit, for panels. */
  file(kind: VoronoiFile, scale: number, save: (text: string) => void): Promise<void> {
    return this.attempt("Making the file", async (signal) => {
      const request = { ...diagramRequest(this.mesh, this.state.get(), [...this.sites.get()], false), panel_scale: scale };
      const response = await this.client.postResponse(PATH.diagrams, request, { signal, headers: { Accept: FILE_TYPES[kind] } });
      const text = await response.text();
      if (!signal.aborted) save(text);
    });
  }

  cancel(): void {
    this.diagramRequests.cancel();
    this.running?.abort();
    this.running = null;
    this.activity.set({ kind: "idle" });
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
    if (this.running) this.cancel();
    if (this.optimizing.get()) this.optimizing.set(null);
    if (this.state.get().scattered) this.state.set({ ...this.state.get(), scattered: false });
    this.sites.set(sites);
    if (sites.length === 0) this.result.set(null);
    this.requestDiagram(done);
  }

  /** Requests the diagram of the present sites. One request runs at a time, and only the newest waits. */
  private requestDiagram(done: boolean): void {
    this.diagramRequests.submit(async (signal) => {
      const sites = this.sites.get();
      if (!this.session.mesh.get() || sites.length === 0) return;
      try {
        const answer = await this.ask({ ...diagramRequest(this.mesh, this.state.get(), [...sites], done), keep: true }, signal);
        // The answer is obsolete if sites were added or removed meanwhile; another request is waiting.
        if (signal.aborted || this.sites.get().length !== sites.length) return;
        this.result.set({ diagram: answer, before: null, now: answer.statistics ?? null });
        this.activity.set({ kind: "idle" });
      } catch (error) {
        if (isAbort(error) || signal.aborted) return;
        this.activity.set(error instanceof ConnectionLost ? { kind: "idle" } : { kind: "failed", sentence: explain(error) });
      }
    });
  }

  private ask(request: VoronoiDiagramRequest, signal: AbortSignal): Promise<VoronoiDiagram> {
    return runJob<VoronoiDiagram>(this.client, PATH.diagrams, request, {
      signal,
      wait: IMMEDIATE_SECONDS,
      onProgress: (job) => !signal.aborted && this.activity.set({ kind: "busy", words: job.stage || "Dividing the surface", progress: job.progress > 0 ? job.progress : null }),
    });
  }

  private async attempt(words: string, act: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.cancel();
    this.running = new AbortController();
    const { signal } = this.running;
    this.activity.set({ kind: "busy", words, progress: null });
    try {
      await act(signal);
      if (!signal.aborted) this.activity.set({ kind: "idle" });
    } catch (error) {
      if (isAbort(error) || signal.aborted) return;
      const optimizing = this.optimizing.get();
      if (optimizing && !optimizing.answer) this.optimizing.set(null);
      this.activity.set({ kind: "failed", sentence: explain(error) });
    } finally {
      if (!signal.aborted) this.running = null;
    }
  }
}

function partialOf({ partial }: Job): PartialOptimization | null {
  return partial && "step_length" in partial ? partial : null;
}
