// The network session: constructs, changes, relaxes and saves a network on the present mesh. It does not depend on elements of the page.
import { rememberedLevel } from "../base/accuracy_choice";
import { LevelMeasures } from "../base/accuracy_levels";
import { Observable } from "../base/observable";
import type { Client } from "../contract/client";
import { JobRunner, type Run, type Task, type WorkInWords } from "../contract/runner";
import type { EmbeddedSystem, EmbeddedSystemRequest, Job, SurfacePoint } from "../contract/types";
import type { MeshData, Vector } from "./mesh_data";
import { type Host, hostFault, defaultHost, lowestVertices, connectedSupports, supportPosition, withMovedSupports, withToggledSupport, withSupports } from "./host";
import type { Triple } from "./membrane";
import { capabilityOf, fileRequest, constructionRequest, materialOf, type Network, networkKey, relaxationRequest, startsAtRest } from "./network";
import { type Frame, Frames } from "./network_frames";
import { withChange, DEFAULT_NETWORK, hasMembrane, hasSprings, onAnotherMesh, type NetworkState, withToggledFixed, withExistingPoints, withoutPoint,
  withToggledSpring } from "./network_state";
import type { MeshActivity, MeshSession } from "./session";

export interface Step {
  readonly iteration: number;
  readonly energy: number;
  readonly gradient: number;
}

/** A running or finished relaxation. */
export interface RelaxationRun {
  readonly request: EmbeddedSystemRequest;
  /** The request for the same settings without resuming an earlier relaxation. */
  readonly asked: EmbeddedSystemRequest;
  readonly network: Network;
  /** The iterations so far, beginning with the start. */
  readonly steps: readonly Step[];
  readonly frames: readonly Frame[];
  /** Norm of the gradient at which it ends. */
  readonly gradientTolerance: number;
  /** The answer; null while it runs. */
  readonly answer: EmbeddedSystem | null;
}

/** The effect of a click on the surface while points are picked. */
export type ClickMode = "add" | "join" | "fix";

export type FileKind = "obj" | "vtu";
const PATH = "/v1/embedded-systems";
const FILE_TYPES: Record<FileKind, string> = { obj: "model/obj", vtu: "application/x-vtu+xml" };

export class NetworkSession {
  readonly state = new Observable<NetworkState>({ ...DEFAULT_NETWORK, accuracy: { ...DEFAULT_NETWORK.accuracy, level: rememberedLevel("network") } });
  readonly network = new Observable<Network | null>(null);
  readonly relaxing = new Observable<RelaxationRun | null>(null);
  readonly activity = new Observable<MeshActivity>({ kind: "idle" });
  /** What the last relaxations took. */
  readonly measures = new LevelMeasures();
  readonly mode = new Observable<ClickMode>("add");
  /** Whether a click on the surface fixes or releases a vertex of a deformable host. */
  readonly supportMode = new Observable(false);
  /** The support that is dragged, or that keys move. */
  readonly chosenSupport = new Observable<number | null>(null);
  /** Whether supports that edges connect to it move with it. */
  readonly moveTogether = new Observable(true);
  /** The first of two points to join. */
  readonly chosen = new Observable<number | null>(null);
  /** Runs what the user has asked for. */
  private readonly runner: JobRunner;
  /** Computes new equilibria while supports are moved. */
  private readonly following: JobRunner;
  /** Key of the constructed network. */
  private key = "";
  private mesh = "";

  constructor(
    private readonly session: MeshSession,
    client: Client,
  ) {
    this.runner = new JobRunner(client, this.activity);
    this.following = new JobRunner(client, this.activity);
    session.mesh.watch((loaded) => {
      if (!loaded || loaded.info.id === this.mesh) return;
      this.forget();
      this.mesh = loaded.info.id;
      this.state.set(onAnotherMesh(this.state.get(), loaded.info));
    });
    session.points.watch((points) => {
      if (this.state.get().points !== "picked") return;
      this.state.set(withExistingPoints(this.state.get(), points.length));
      this.updateDrawnNetwork();
    });
  }

  change(change: Partial<NetworkState>): void {
    this.state.set(withChange(this.state.get(), change));
    this.updateDrawnNetwork();
  }

  /** Sets the state of a link after its mesh was loaded. */
  restore(state: NetworkState): void {
    const info = this.session.mesh.get()?.info;
    const known = withSupports(state.host, state.host.supports.filter((vertex) => vertex < (info?.vertices ?? 0)));
    // A link has no parameters of a rigid host, so that those of shell and solid are the initial ones.
    const host = state.host.kind === "rigid" && info ? defaultHost(info.bounding_box.diagonal) : known;
    this.state.set({ ...state, host });
    this.updateDrawnNetwork();
  }

  toggleFixed(point: number): void {
    this.state.set(withToggledFixed(this.state.get(), point));
  }

  changeHost(change: Partial<Host>): void {
    const { supports, ...rest } = change;
    const before = { ...this.state.get().host, ...rest };
    const host = supports ? withSupports(before, supports) : before;
    if (host.kind === "rigid") this.supportMode.set(false);
    const chosen = this.chosenSupport.get();
    if (chosen !== null && (host.kind === "rigid" || !host.supports.includes(chosen))) this.chosenSupport.set(null);
    this.change({ host });
  }

  /** Fixes a vertex of the host, or releases it if it is fixed. */
  toggleSupport(vertex: number): void {
    this.changeHost(withToggledSupport(this.state.get().host, vertex));
  }

  /** The position of a support after its displacement. */
  supportPlace(vertex: number): Vector {
    return supportPosition(this.state.get().host, this.session.mesh.get()?.data ?? { positions: [] as unknown as MeshData["positions"] }, vertex);
  }

  /** Moves a support to a position and requests new equilibria of the host. */
  moveSupport(vertex: number, to: Vector): void {
    const { host } = this.state.get();
    const { data } = this;
    if (!data || !host.supports.includes(vertex)) return;
    const group = this.moveTogether.get() ? connectedSupports(host.supports, data, vertex) : [vertex];
    this.changeHost({ moves: withMovedSupports(host, data, group, vertex, to).moves });
    this.chosenSupport.set(vertex);
    this.followSupports();
  }

  /** Displaces these supports; all others return to their positions in the mesh. */
  setMoves(moves: Host["moves"]): void {
    this.changeHost({ moves });
    this.followSupports();
  }

  supportLowest(): void {
    const data = this.session.mesh.get()?.data;
    if (data) this.changeHost({ supports: lowestVertices(data) });
  }

  /** Chooses the first of two points, or joins the second one to it with a spring. */
  join(point: number): void {
    const first = this.chosen.get();
    this.chosen.set(first === null ? point : null);
    if (first === null) return;
    this.state.set(withToggledSpring(this.state.get(), first, point));
    this.updateDrawnNetwork();
  }

  removePicked(point: number): void {
    this.state.set(withoutPoint(this.state.get(), point));
    this.session.setPoints(this.session.points.get().filter((_, k) => k !== point));
  }

  /** The mesh at rest. */
  get data(): MeshData | null {
    return this.session.mesh.get()?.data ?? null;
  }

  /** Whether the constructed network is that of the present state. */
  get isMade(): boolean {
    return this.network.get() !== null && this.key === this.currentKey();
  }

  /** Whether the settings have changed since the shown relaxation. */
  get isStale(): boolean {
    const relaxing = this.relaxing.get();
    if (!relaxing?.answer) return false;
    return JSON.stringify(relaxationRequest(this.mesh, this.state.get(), relaxing.network)) !== JSON.stringify(relaxing.asked);
  }

  make(): Promise<void> {
    return this.attempt("Making the network", async (run) => {
      await this.constructNetwork(run);
    });
  }

  /**
   * Relaxes the network from its constructed points, or resumes from the end of the last relaxation. With a membrane or a deformable host,
   * which are at rest at the start, resuming repeats the last relaxation with more iterations.
   */
  relax(resume = false): Promise<void> {
    const start = resume ? this.relaxing.get()?.answer : null;
    return this.attempt("Making the network", async (run) => {
      const network = this.isMade ? (this.network.get() as Network) : await this.constructNetwork(run);
      const asked = relaxationRequest(this.mesh, this.state.get(), network);
      if (!start) return this.runRelaxation(asked, asked, network, network.positions, run);
      if (startsAtRest(asked)) {
        return this.runRelaxation({ ...asked, max_iterations: start.iterations + this.state.get().maxIterations }, asked, network, network.positions, run);
      }
      await this.runRelaxation({ ...asked, points: start.points }, asked, network, start.positions as unknown as Vector[], run);
    });
  }

  /** Saves a file of the relaxed network. */
  async file(kind: FileKind, save: (text: string) => void): Promise<void> {
    const relaxing = this.relaxing.get();
    const answer = relaxing?.answer;
    if (!relaxing || !answer) return;
    const request = fileRequest(relaxing.request, answer.points);
    await this.attempt("Making the file", async (run) => save(await run.file(PATH, request, FILE_TYPES[kind])));
  }

  cancel(): void {
    this.following.cancel();
    this.runner.cancel();
    this.forgetUnfinished();
  }

  /**
   * Computes a new equilibrium while supports are moved. One request runs at a time, and only the newest waits. The last equilibrium is
   * shown meanwhile.
   */
  private followSupports(): void {
    if (this.runner.isRunning) this.cancel();
    const info = this.session.mesh.get()?.info;
    const fault = info && hostFault(this.state.get().host, info);
    if (!info || fault) return this.activity.set(fault ? { kind: "failed", sentence: fault } : { kind: "idle" });
    this.following.follow(async (run) => {
      const network = this.isMade ? (this.network.get() as Network) : await this.constructNetwork(run);
      const asked = relaxationRequest(this.mesh, this.state.get(), network);
      // The last equilibrium is a good start for springs. A membrane cannot use it, because its start defines its rest state.
      const last = this.relaxing.get();
      const startPoints = last?.answer && last.network === network && !asked.triangles ? { points: last.answer.points } : {};
      const request = { ...asked, ...startPoints };
      const answer = await this.compute(request, "Following the supports", run);
      this.relaxing.set({ request, asked, network, steps: stepsOf(answer), frames: [], gradientTolerance: answer.accuracy.gradient_tolerance, answer });
    });
  }

  private forgetUnfinished(): void {
    const relaxing = this.relaxing.get();
    if (relaxing && !relaxing.answer) this.relaxing.set(null);
  }

  private forget(): void {
    this.cancel();
    this.network.set(null);
    this.relaxing.set(null);
    this.chosen.set(null);
    this.key = "";
  }

  /** Constructs a network of picked points and drawn springs, which needs no server. Any other network is outdated until the server constructs it again. */
  private updateDrawnNetwork(): void {
    const state = this.state.get();
    const { points, springs, drawn } = state;
    if (this.isMade) return;
    this.forget();
    const picked = this.session.points.get();
    if (points !== "picked" || !this.session.mesh.get() || picked.length === 0) return;
    const isDrawn = springs === "drawn" && hasSprings(state);
    const pairs = isDrawn ? withExistingPoints(this.state.get(), picked.length).drawn.map(({ between }) => between) : [];
    this.network.set({ points: picked, positions: picked.map((point) => this.session.position(point)), pairs, triangles: [] });
    if (isDrawn && !hasMembrane(state) && drawn.length === pairs.length) this.key = this.currentKey();
  }

  private currentKey(): string {
    return networkKey(this.session.mesh.get()?.info.id ?? "", this.state.get(), this.session.points.get());
  }

  private async constructNetwork(run: Run<WorkInWords>): Promise<Network> {
    const key = this.currentKey();
    const request = constructionRequest(this.mesh, this.state.get(), this.session.points.get());
    const answer = await this.compute(request, "Making the network", run);
    const network: Network = {
      points: answer.points as SurfacePoint[],
      positions: answer.positions as unknown as Vector[],
      pairs: answer.springs.map(({ between }) => [between[0], between[1]] as const),
      triangles: request.triangles ? ((answer.triangles ?? []) as unknown as Triple[]) : [],
    };
    this.key = key;
    this.relaxing.set(null);
    this.state.set(withExistingPoints(this.state.get(), network.points.length));
    this.network.set(network);
    return network;
  }

  private async runRelaxation(request: EmbeddedSystemRequest, asked: EmbeddedSystemRequest, network: Network, start: readonly Vector[], run: Run<WorkInWords>): Promise<void> {
    const frames = new Frames();
    frames.add({ iteration: 0, positions: start });
    const steps: Step[] = [];
    const { youngs_modulus, thickness } = materialOf(request);
    const weight = (request.springs as { weight?: number }[]).reduce((max, spring) => Math.max(max, spring.weight ?? 1), request.triangles ? youngs_modulus * thickness : 0);
    const diagonal = this.session.mesh.get()?.info.bounding_box.diagonal ?? 0;
    const gradientTolerance = (request.accuracy?.tolerance ?? 0) * weight * diagonal;
    this.relaxing.set({ request, asked, network, steps, frames: frames.all, gradientTolerance, answer: null });
    const state = this.state.get();
    const answer = await this.compute(request, "Relaxing", run, (partial) => {
      if (!partial || !("gradient_norm" in partial) || "step_length" in partial || (steps.length > 0 && partial.iteration <= steps[steps.length - 1].iteration)) return;
      steps.push({ iteration: partial.iteration, energy: partial.energy, gradient: partial.gradient_norm });
      if (partial.positions && partial.iteration > 0) {
        frames.add({
          iteration: partial.iteration,
          positions: partial.positions as unknown as Vector[],
          ...(partial.vertices && { vertices: partial.vertices as unknown as Vector[] }),
        });
      }
      this.relaxing.set({ request, asked, network, steps: [...steps], frames: frames.all, gradientTolerance, answer: null });
    });
    this.measures.record(capabilityOf(state), { level: state.accuracy.level, seconds: answer.cost.seconds, error: null });
    this.relaxing.set({ request, asked, network, steps: stepsOf(answer), frames: frames.all, gradientTolerance: answer.accuracy.gradient_tolerance, answer });
  }

  private compute(request: EmbeddedSystemRequest, words: string, run: Run<WorkInWords>, onPartial: (partial: Job["partial"]) => void = () => {}): Promise<EmbeddedSystem> {
    return run.job<EmbeddedSystem>(PATH, request, {
      onJob: ({ partial, progress }) => {
        onPartial(partial);
        const now = partial && "gradient_norm" in partial ? `${words}, iteration ${partial.iteration}` : words;
        run.tell({ words: now }, progress > 0 ? progress : null);
      },
    });
  }

  private attempt(words: string, task: Task<WorkInWords>): Promise<void> {
    this.cancel();
    return this.runner.begin({ words }, task, (error) => {
      this.forgetUnfinished();
      this.runner.tellFailure(error);
    });
  }
}

function stepsOf({ history }: EmbeddedSystem): Step[] {
  return history.map(({ energy, gradient_norm }, iteration) => ({ iteration, energy, gradient: gradient_norm }));
}
