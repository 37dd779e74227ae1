// A network on the mesh at hand: made, changed, relaxed, saved. Knows no element of the page.
import { Latest } from "../base/latest";
import { Observable } from "../base/observable";
import { type Client, explain, isAbort } from "../contract/client";
import { runJob } from "../contract/jobs";
import type { EmbeddedSystem, EmbeddedSystemRequest, Job, SurfacePoint } from "../contract/types";
import type { MeshData, Vector } from "./mesh_data";
import { type Host, hostFault, hostFor, lowestVertices, patchOf, placeOfSupport, withMoved, withSupport, withSupports } from "./host";
import type { Triple } from "./membrane";
import { fileRequest, makingRequest, materialOf, type Network, networkKey, relaxationRequest, startsAtRest } from "./network";
import { type Frame, Frames } from "./network_frames";
import { changed, DEFAULT_NETWORK, hasMembrane, hasSprings, onAnotherMesh, type NetworkState, withFixed, within, withoutPoint, withSpring } from "./network_state";
import type { MeshActivity, MeshSession } from "./session";

export interface Step {
  readonly iteration: number;
  readonly energy: number;
  readonly gradient: number;
}

/** A relaxation that runs or has ended. */
export interface Relaxing {
  readonly request: EmbeddedSystemRequest;
  /** What the settings ask for where nothing goes on from an earlier relaxation. */
  readonly asked: EmbeddedSystemRequest;
  readonly network: Network;
  /** The start and what came of it so far. */
  readonly steps: readonly Step[];
  readonly frames: readonly Frame[];
  /** |grad E| at which it ends. */
  readonly gradientTolerance: number;
  /** Null while it runs. */
  readonly answer: EmbeddedSystem | null;
}

/** What a click on the surface does where points are picked. */
export type ClickMode = "add" | "join" | "fix";

export type FileKind = "obj" | "vtu";
const FILE_TYPES: Record<FileKind, string> = { obj: "model/obj", vtu: "application/x-vtu+xml" };

export class NetworkSession {
  readonly state = new Observable<NetworkState>(DEFAULT_NETWORK);
  readonly network = new Observable<Network | null>(null);
  readonly relaxing = new Observable<Relaxing | null>(null);
  readonly activity = new Observable<MeshActivity>({ kind: "idle" });
  readonly mode = new Observable<ClickMode>("add");
  /** Whether a click on the surface holds a vertex of a host that gives way. */
  readonly supporting = new Observable(false);
  /** The support that is dragged, or moved by keys. */
  readonly chosenSupport = new Observable<number | null>(null);
  /** Whether supports that edges join to it go along. */
  readonly together = new Observable(true);
  /** The first of two points to join. */
  readonly chosen = new Observable<number | null>(null);
  private running: AbortController | null = null;
  private readonly followings = new Latest();
  /** Of the network that was made. */
  private key = "";
  private mesh = "";

  constructor(
    private readonly session: MeshSession,
    private readonly client: Client,
  ) {
    session.mesh.watch((loaded) => {
      if (!loaded || loaded.info.id === this.mesh) return;
      this.forget();
      this.mesh = loaded.info.id;
      this.state.set(onAnotherMesh(this.state.get(), loaded.info));
    });
    session.points.watch((points) => {
      if (this.state.get().points !== "picked") return;
      this.state.set(within(this.state.get(), points.length));
      this.follow();
    });
  }

  change(change: Partial<NetworkState>): void {
    this.state.set(changed(this.state.get(), change));
    this.follow();
  }

  /** The network of a link, once its mesh is there. */
  restore(state: NetworkState): void {
    const info = this.session.mesh.get()?.info;
    const known = withSupports(state.host, state.host.supports.filter((vertex) => vertex < (info?.vertices ?? 0)));
    // A link tells nothing of a rigid host: shells and solids are then as they are at first.
    const host = state.host.kind === "rigid" && info ? hostFor(info.bounding_box.diagonal) : known;
    this.state.set({ ...state, host });
    this.follow();
  }

  fix(point: number): void {
    this.state.set(withFixed(this.state.get(), point));
  }

  changeHost(change: Partial<Host>): void {
    const { supports, ...rest } = change;
    const before = { ...this.state.get().host, ...rest };
    const host = supports ? withSupports(before, supports) : before;
    if (host.kind === "rigid") this.supporting.set(false);
    const chosen = this.chosenSupport.get();
    if (chosen !== null && (host.kind === "rigid" || !host.supports.includes(chosen))) this.chosenSupport.set(null);
    this.change({ host });
  }

  /** Holds a vertex of the host, or lets it go. */
  support(vertex: number): void {
    this.changeHost(withSupport(this.state.get().host, vertex));
  }

  /** Where a support is taken, or stays. */
  supportPlace(vertex: number): Vector {
    return placeOfSupport(this.state.get().host, this.session.mesh.get()?.data ?? { positions: [] as unknown as MeshData["positions"] }, vertex);
  }

  /** Takes a support to a place; the host follows as fast as it is worked out. */
  moveSupport(vertex: number, to: Vector): void {
    const { host } = this.state.get();
    const { data } = this;
    if (!data || !host.supports.includes(vertex)) return;
    const along = this.together.get() ? patchOf(host.supports, data, vertex) : [vertex];
    this.changeHost({ moves: withMoved(host, data, along, vertex, to).moves });
    this.chosenSupport.set(vertex);
    this.followSupports();
  }

  /** Takes these supports to their places, and all others to where the mesh has them. */
  takeSupports(moves: Host["moves"]): void {
    this.changeHost({ moves });
    this.followSupports();
  }

  supportLowest(): void {
    const data = this.session.mesh.get()?.data;
    if (data) this.changeHost({ supports: lowestVertices(data) });
  }

  /** Chooses the first of two points, or joins the second to it. */
  join(point: number): void {
    const first = this.chosen.get();
    this.chosen.set(first === null ? point : null);
    if (first === null) return;
    this.state.set(withSpring(this.state.get(), first, point));
    this.follow();
  }

  removePicked(point: number): void {
    this.state.set(withoutPoint(this.state.get(), point));
    this.session.setPoints(this.session.points.get().filter((_, k) => k !== point));
  }

  /** The mesh at rest. */
  get data(): MeshData | null {
    return this.session.mesh.get()?.data ?? null;
  }

  /** Whether what is seen is the network of the state. */
  get isMade(): boolean {
    return this.network.get() !== null && this.key === this.keyNow();
  }

  /** Whether the network would be relaxed otherwise now than what is seen was. */
  get isStale(): boolean {
    const relaxing = this.relaxing.get();
    if (!relaxing?.answer) return false;
    return JSON.stringify(relaxationRequest(this.mesh, this.state.get(), relaxing.network)) !== JSON.stringify(relaxing.asked);
  }

  make(): Promise<void> {
    return this.attempt("Making the network", async (signal) => {
      await this.made(signal);
    });
  }

  /**
   * Relaxes the network from where its points were made, or goes on from where the last relaxation ended. A membrane or a host that
   * gives way, which is at rest where it starts, goes the same way once more and then further.
   */
  relax(goOn = false): Promise<void> {
    const start = goOn ? this.relaxing.get()?.answer : null;
    return this.attempt("Making the network", async (signal) => {
      const network = this.isMade ? (this.network.get() as Network) : await this.made(signal);
      const asked = relaxationRequest(this.mesh, this.state.get(), network);
      if (!start) return this.follows(asked, asked, network, network.positions, signal);
      if (startsAtRest(asked)) return this.follows({ ...asked, max_iterations: start.iterations + this.state.get().maxIterations }, asked, network, network.positions, signal);
      await this.follows({ ...asked, points: start.points }, asked, network, start.positions as unknown as Vector[], signal);
    });
  }

  /** A file of the network at rest. */
  async file(kind: FileKind, save: (text: string) => void): Promise<void> {
    const relaxing = this.relaxing.get();
    const answer = relaxing?.answer;
    if (!relaxing || !answer) return;
    await this.attempt("Making the file", async (signal) => {
      const request = fileRequest(relaxing.request, answer.points);
      const response = await this.client.postResponse("/v1/embedded-systems", request, { signal, headers: { Accept: FILE_TYPES[kind] } });
      const text = await response.text();
      if (!signal.aborted) save(text);
    });
  }

  cancel(): void {
    this.followings.cancel();
    this.running?.abort();
    this.running = null;
    this.activity.set({ kind: "idle" });
    const relaxing = this.relaxing.get();
    if (relaxing && !relaxing.answer) this.relaxing.set(null);
  }

  /**
   * Relaxes anew while supports are moved: one request at a time, and of those that wait only the newest. What was at rest before is
   * seen meanwhile.
   */
  private followSupports(): void {
    if (this.running) this.cancel();
    const info = this.session.mesh.get()?.info;
    const fault = info && hostFault(this.state.get().host, info);
    if (!info || fault) return this.activity.set(fault ? { kind: "failed", sentence: fault } : { kind: "idle" });
    this.followings.submit(async (signal) => {
      try {
        const network = this.isMade ? (this.network.get() as Network) : await this.made(signal);
        if (signal.aborted) return;
        const asked = relaxationRequest(this.mesh, this.state.get(), network);
        // Springs are near their rest where they came to rest before. A membrane is at rest where it starts.
        const last = this.relaxing.get();
        const nearby = last?.answer && last.network === network && !asked.triangles ? { points: last.answer.points } : {};
        const request = { ...asked, ...nearby };
        const answer = await this.compute(request, "Following the supports", signal);
        if (signal.aborted) return;
        this.relaxing.set({ request, asked, network, steps: stepsOf(answer), frames: [], gradientTolerance: answer.accuracy.gradient_tolerance, answer });
        this.activity.set({ kind: "idle" });
      } catch (error) {
        if (isAbort(error) || signal.aborted) return;
        this.activity.set({ kind: "failed", sentence: explain(error) });
      }
    });
  }

  private forget(): void {
    this.cancel();
    this.network.set(null);
    this.relaxing.set(null);
    this.chosen.set(null);
    this.key = "";
  }

  /** A network that is picked and drawn by hand needs no server; any other is out of date until it is made again. */
  private follow(): void {
    const state = this.state.get();
    const { points, springs, drawn } = state;
    if (this.isMade) return;
    this.forget();
    const picked = this.session.points.get();
    if (points !== "picked" || !this.session.mesh.get() || picked.length === 0) return;
    const isDrawn = springs === "drawn" && hasSprings(state);
    const pairs = isDrawn ? within(this.state.get(), picked.length).drawn.map(({ between }) => between) : [];
    this.network.set({ points: picked, positions: picked.map((point) => this.session.position(point)), pairs, triangles: [] });
    if (isDrawn && !hasMembrane(state) && drawn.length === pairs.length) this.key = this.keyNow();
  }

  private keyNow(): string {
    return networkKey(this.session.mesh.get()?.info.id ?? "", this.state.get(), this.session.points.get());
  }

  private async made(signal: AbortSignal): Promise<Network> {
    const key = this.keyNow();
    const request = makingRequest(this.mesh, this.state.get(), this.session.points.get());
    const answer = await this.compute(request, "Making the network", signal);
    const network: Network = {
      points: answer.points as SurfacePoint[],
      positions: answer.positions as unknown as Vector[],
      pairs: answer.springs.map(({ between }) => [between[0], between[1]] as const),
      triangles: request.triangles ? ((answer.triangles ?? []) as unknown as Triple[]) : [],
    };
    if (signal.aborted) return network;
    this.key = key;
    this.relaxing.set(null);
    this.state.set(within(this.state.get(), network.points.length));
    this.network.set(network);
    return network;
  }

  private async follows(request: EmbeddedSystemRequest, asked: EmbeddedSystemRequest, network: Network, start: readonly Vector[], signal: AbortSignal): Promise<void> {
    const frames = new Frames();
    frames.add({ iteration: 0, positions: start });
    const steps: Step[] = [];
    const { youngs_modulus, thickness } = materialOf(request);
    const weight = (request.springs as { weight?: number }[]).reduce((most, spring) => Math.max(most, spring.weight ?? 1), request.triangles ? youngs_modulus * thickness : 0);
    const diagonal = this.session.mesh.get()?.info.bounding_box.diagonal ?? 0;
    const gradientTolerance = (request.accuracy?.tolerance ?? 0) * weight * diagonal;
    this.relaxing.set({ request, asked, network, steps, frames: frames.all, gradientTolerance, answer: null });
    const answer = await this.compute(request, "Relaxing", signal, ({ partial }) => {
      if (!partial || !("gradient_norm" in partial) || "step_length" in partial || (steps.length > 0 && partial.iteration <= steps[steps.length - 1].iteration)) return;
      steps.push({ iteration: partial.iteration, energy: partial.energy, gradient: partial.gradient_norm });
      if (partial.positions && partial.iteration > 0) frames.add({ iteration: partial.iteration, positions: partial.positions as unknown as Vector[], ...(partial.vertices && { vertices: partial.vertices as unknown as Vector[] }) });
      this.relaxing.set({ request, asked, network, steps: [...steps], frames: frames.all, gradientTolerance, answer: null });
    });
    if (signal.aborted) return;
    this.relaxing.set({ request, asked, network, steps: stepsOf(answer), frames: frames.all, gradientTolerance: answer.accuracy.gradient_tolerance, answer });
  }

  private compute(request: EmbeddedSystemRequest, words: string, signal: AbortSignal, hear: (job: Job) => void = () => {}): Promise<EmbeddedSystem> {
    return runJob<EmbeddedSystem>(this.client, "/v1/embedded-systems", request, {
      signal,
      onProgress: (job) => {
        if (signal.aborted) return;
        hear(job);
        const { partial } = job;
        const now = partial && "gradient_norm" in partial ? `${words}, iteration ${partial.iteration}` : words;
        this.activity.set({ kind: "busy", words: now, progress: job.progress > 0 ? job.progress : null });
      },
    });
  }

  private async attempt(words: string, act: (signal: AbortSignal) => Promise<void>): Promise<void> {
    this.cancel();
    const { signal } = (this.running = new AbortController());
    this.activity.set({ kind: "busy", words, progress: null });
    try {
      await act(signal);
      if (!signal.aborted) this.activity.set({ kind: "idle" });
    } catch (error) {
      if (isAbort(error) || signal.aborted) return;
      const relaxing = this.relaxing.get();
      if (relaxing && !relaxing.answer) this.relaxing.set(null);
      this.activity.set({ kind: "failed", sentence: explain(error) });
    } finally {
      if (!signal.aborted) this.running = null;
    }
  }
}

function stepsOf({ history }: EmbeddedSystem): Step[] {
  return history.map(({ energy, gradient_norm }, iteration) => ({ iteration, energy, gradient: gradient_norm }));
}
