// Simulations of the shown design at its native scale: its curves, its deformed patch, and on request its correction by simulations
// (polish). Results are kept (`simulations.ts`), and jobs are found again after the page was left (`started_jobs.ts`).
import type { Curve } from "../base/curve";
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, isBusy, type Problem, statusOf } from "../contract/client";
import { type JobSettings, JobRunner, type Run } from "../contract/runner";
import type { DesignAnswer, Effect, Job, Polish, Simulation } from "../contract/types";
import { writeLink } from "./link";
import { Pauses } from "./pauses";
import { PolishRounds } from "./polish_rounds";
import { patchDirection, patchRequest, polishRequest, verificationRequest } from "./requests";
import type { SimulatedAnswer } from "./search";
import type { DesignSession } from "./session";
import { designOf, kindOf, type TargetResponse } from "./shown";
import { sameSimulatedDesign, type SimulatedDesign, simulatedDesign, simulatedTarget, type SimulatedTarget, type SimulationRecord, Simulations } from "./simulations";
import { sameSpecification } from "./specification";
import { forgetJob, rememberJob, rememberRounds, type SimulationWork, type StartedJob, startedJob, targetsText } from "./started_jobs";
import type { DesignState } from "./state";
import { askedOrder, targetsOf } from "./target_list";

export type { SimulatedTarget } from "./simulations";

const PATH = "/v1/designs";
/** A simulation in the background of which so much is done goes on in its place when the user asks for it. */
const MIN_PROGRESS_TO_KEEP = 0.5;

export type VerificationState =
  | { readonly kind: "none" }
  | RunningSimulation
  | { readonly kind: "failed"; readonly sentence: string }
  | { readonly kind: "done"; readonly simulated: readonly SimulatedTarget[]; readonly polish: Polish | null; readonly effects: readonly Effect[]; readonly seconds: number };

export interface RunningSimulation {
  readonly kind: "running";
  readonly work: SimulationWork;
  /** Whether it began without being asked for. */
  readonly isBackground: boolean;
  readonly progress: number;
  readonly stage: string;
  /** Estimated seconds until it ends; null if they are not known. */
  readonly remaining: number | null;
}

export type PatchState =
  | { readonly kind: "none" }
  | { readonly kind: "running"; readonly progress: number }
  | { readonly kind: "failed"; readonly sentence: string }
  | { readonly kind: "done"; readonly simulation: Simulation; readonly direction: number };

/** What a running simulation is of. */
interface Subject {
  readonly work: SimulationWork;
  readonly isBackground: boolean;
  readonly design: SimulatedDesign;
  readonly asked: DesignState;
  readonly targets: string;
  /** Indices of the targets in the order of the request, which is that of the answer. */
  readonly order: readonly number[];
}

type AnswerOf = (run: Run<object>, settings: JobSettings) => Promise<DesignAnswer>;

export class Verification {
  readonly state = new Observable<VerificationState>({ kind: "none" });
  readonly patch = new Observable<PatchState>({ kind: "none" });
  readonly rounds: PolishRounds;
  /** Pauses of what nobody has asked for, after a lost connection or while the server is busy. */
  readonly pauses = new Pauses();
  private readonly runner: JobRunner;
  private subject: Subject | null = null;
  /** The id of its job; empty until the server has told it. */
  private jobId = "";
  /** The simulation that is shown, and its targets in the order of the tabs. */
  private record: SimulationRecord | null = null;
  private recordTargets = "";
  /** The simulation whose deformed patch is being computed. */
  private patched: SimulationRecord | null = null;
  private readonly patches = new WeakMap<SimulationRecord, Extract<PatchState, { kind: "done" }>>();
  /** Designs and targets whose verification has failed or was stopped: it does not begin by itself again. */
  private readonly declined = new Set<string>();

  constructor(
    private readonly session: DesignSession,
    private readonly client: Client,
    readonly simulations = new Simulations(),
  ) {
    this.runner = new JobRunner(client);
    this.rounds = new PolishRounds(session);
    for (const part of [session.results.shown, session.state, simulations.list]) part.watch(() => this.follow());
    session.search.simulated.watch((found) => found && this.keep(found));
  }

  /** Keeps the simulation of a search that simulates. */
  private keep({ answer, asked }: SimulatedAnswer): void {
    const { targets, order } = askedOf(asked);
    const profiles = simulatedProfiles(answer, { asked, order });
    if (!profiles) return;
    const design = simulatedDesign(designOf(answer, asked), asked.made);
    this.simulations.add({ design, profiles, polish: answer.polish, targets, effects: answer.effects, seconds: answer.cost.seconds });
  }

  /** The simulated response to the selected target. */
  get simulated(): SimulatedTarget | null {
    const state = this.state.get();
    return state.kind === "done" ? (state.simulated[this.session.state.get().at] ?? null) : null;
  }

  /** The simulated curve of a response; null if there is none. */
  curveOf(shown: TargetResponse): Curve | null {
    return shown.provisional ? null : this.simulations.curveOf(shown);
  }

  /** Whether the shown design rests and could be verified without being asked for: it was not, and nobody has stopped it. */
  get isWanted(): boolean {
    const subject = this.restingSubject("verify");
    return subject !== null && this.state.get().kind === "none" && !this.declined.has(textOf(subject)) && this.pauses.remaining === 0;
  }

  /** Simulates the shown design, and its deformed patch if somebody has asked for it. */
  async verify({ background = false } = {}): Promise<void> {
    const { subject } = this;
    const state = this.state.get();
    // What runs in the background already goes on for the user if most of it is done. Otherwise it begins anew with the user's priority, since
    // others may delay what is in the background for as long as they like.
    const isMostlyDone = state.kind === "running" && state.progress >= MIN_PROGRESS_TO_KEEP;
    if (subject?.work === "verify" && !background && (!subject.isBackground || isMostlyDone)) return this.adopt(subject);
    await this.simulate("verify", background);
  }

  /** Corrects the design by simulations and shows the result. */
  async polish(): Promise<void> {
    await this.simulate("polish", false);
  }

  /** Cancels running simulations for the user. The best design of a polish stays. */
  cancel(): void {
    const { subject } = this;
    if (subject) this.declined.add(textOf(subject));
    const best = subject?.work === "polish" ? this.rounds.best : null;
    this.drop();
    this.patch.set({ kind: "none" });
    if (best) this.session.setFound(best);
    this.follow();
  }

  /** Ends a simulation that nobody has asked for, which may begin again. */
  dropBackground(): void {
    if (this.subject?.isBackground) this.drop();
  }

  /** Goes on at once, since the server answers again. */
  resume(): void {
    this.pauses.clear();
    this.follow();
  }

  /** Simulates the deformed patch of the shown design, for example where its curve was found again without it. */
  async showPatch(): Promise<void> {
    const { record } = this;
    const asked = this.session.state.get();
    if (record && !this.subject) await this.runner.start((run) => this.simulatePatch(record, asked, run));
  }

  /** Goes on with what belongs to the state: a running simulation, one that was found again, or none. */
  follow(): void {
    if (this.subject && !this.isStillOf(this.subject)) this.drop();
    if (this.subject) return;
    this.showRecord();
    if (this.record === null) this.findJob();
  }

  /** Whether a running simulation is of the present design, targets and specification. A design that a search is still looking for is not compared. */
  private isStillOf({ asked, design, targets }: Subject): boolean {
    const state = this.session.state.get();
    if (targetsText(targetsOf(state)) !== targets || !sameSpecification({ ...state.made, size: asked.made.size }, asked.made)) return false;
    const shown = this.restingShown;
    return shown === null || sameSimulatedDesign(simulatedDesign(shown.found, shown.made), design);
  }

  /** The shown response once it is the answer to the present state. */
  private get restingShown(): TargetResponse | null {
    const { results } = this.session;
    const shown = results.shown.get();
    return shown && !shown.provisional && results.isCurrent ? shown : null;
  }

  private restingSubject(work: SimulationWork, isBackground = false): Subject | null {
    const shown = this.restingShown;
    const asked = this.session.state.get();
    return shown && { work, isBackground, design: simulatedDesign(shown.found, shown.made), ...askedOf(asked) };
  }

  /** Shows the simulation of the present design, if there is one. */
  private showRecord(): void {
    const { found, made } = this.session.state.get();
    const targets = targetsOf(this.session.state.get());
    const record = this.simulations.find(found, made, targets);
    const text = targetsText(targets);
    if (record === this.record && text === this.recordTargets && (record !== null || this.state.get().kind !== "done")) return this.forgetFailure();
    if (this.patched && this.patched !== record && this.restingShown) this.drop();
    [this.record, this.recordTargets] = [record, text];
    this.state.set(record
      ? {
        kind: "done",
        simulated: targets.map((target) => simulatedTarget(record, target) as SimulatedTarget),
        polish: record.targets === text ? record.polish : null, // its deviation is that from the targets of that time
        effects: record.effects ?? [],
        seconds: record.seconds,
      }
      : { kind: "none" });
    this.patch.set((record && this.patches.get(record)) ?? { kind: "none" });
  }

  /** A failure goes with its design. */
  private forgetFailure(): void {
    const subject = this.restingSubject("verify");
    if (this.state.get().kind === "failed" && subject && !this.declined.has(textOf(subject))) this.state.set({ kind: "none" });
  }

  /** Goes on with a job that the page has started before it was left. */
  private findJob(): void {
    const subject = this.restingSubject("verify");
    const job = subject && startedJob(subject.design, subject.targets);
    if (subject && job && this.pauses.remaining === 0) void this.goOn({ ...subject, isBackground: job.isBackground }, job);
  }

  private adopt(subject: Subject): void {
    this.subject = { ...subject, isBackground: false };
    const state = this.state.get();
    if (state.kind === "running") this.state.set({ ...state, isBackground: false });
  }

  private async simulate(work: SimulationWork, isBackground: boolean): Promise<void> {
    const shown = this.session.results.shown.get();
    const asked = this.session.state.get();
    // The design of an outdated response is of another material or orientation than the state.
    if (!shown || !sameSpecification(shown.made, asked.made)) return;
    const request = work === "polish" ? polishRequest(asked, shown.found) : verificationRequest(asked, shown.found, isBackground ? "background" : "normal");
    const subject = { work, isBackground, design: simulatedDesign(shown.found, shown.made), ...askedOf(asked) };
    // The job of a page that was left, or of a connection that was lost, goes on in the place of another one.
    const known = this.subject ? null : startedJob(subject.design, subject.targets);
    if (known && (isBackground || known.work === work)) return this.goOn({ ...subject, isBackground: isBackground && known.isBackground }, known);
    await this.run(subject, (run, settings) => run.job<DesignAnswer>(PATH, request, settings));
  }

  /** Follows a job that is known from before. */
  private goOn(subject: Subject, { id, work, order, rounds = [] }: StartedJob): Promise<void> {
    return this.run({ ...subject, work, order }, (run, settings) => run.startedJob<DesignAnswer>(id, PATH, {}, settings), id, rounds);
  }

  /** Runs a job of the subject. `known`: the id of one that was started before the page was left, `rounds`: those of its polish that were seen before. */
  private async run(subject: Subject, answerOf: AnswerOf, known = "", rounds: StartedJob["rounds"] = []): Promise<void> {
    this.drop();
    this.subject = subject;
    this.jobId = known;
    this.record = null;
    this.rounds.begin(subject.asked, rounds);
    this.patch.set({ kind: "none" });
    this.state.set({ kind: "running", work: subject.work, isBackground: subject.isBackground, progress: 0, stage: "", remaining: null });
    await this.runner.start(async (run) => {
      const record = await this.simulateProfiles(subject, run, answerOf, known);
      if (record && !subject.isBackground) await this.simulatePatch(record, subject.asked, run);
    });
  }

  /** Ends the running simulation, whose job is dismissed. */
  private drop(): void {
    this.runner.stop();
    this.patched = null;
    if (this.subject === null) return;
    forgetJob(this.jobId);
    this.subject = null;
    this.record = null;
    this.rounds.clear();
    this.state.set({ kind: "none" });
  }

  private async simulateProfiles(subject: Subject, run: Run<object>, answerOf: AnswerOf, known: string): Promise<SimulationRecord | null> {
    let id = known;
    const onJob = (job: Job): void => {
      if (id === "") rememberJob({ id: job.id, work: subject.work, isBackground: subject.isBackground, design: subject.design, targets: subject.targets, order: subject.order });
      this.jobId = id = job.id;
      this.showProgress(job, subject);
      rememberRounds(id, this.rounds.answered);
    };
    try {
      const answer = await answerOf(run, { onJob, isBackground: () => (this.subject ?? subject).isBackground });
      forgetJob(id);
      return this.accept(answer, subject);
    } catch (error) {
      // The server goes on with a job that it does not tell of for a while. It is found again later.
      if (!isBusy(error)) forgetJob(id);
      if (run.isCancelled) throw error;
      this.fail(error, this.subject ?? subject, id, known);
      return null;
    }
  }

  /** Ends a simulation without a result. `id`: its job, empty if none was begun; `known`: that of a job that was begun before. */
  private fail(error: unknown, subject: Subject, id: string, known: string): void {
    this.subject = null;
    this.rounds.clear();
    const isLost = isBusy(error) && (subject.isBackground || id !== "" || error instanceof ConnectionLost);
    if (isLost) this.pauses.begin();
    // A job may have been removed meanwhile, or dismissed by another tab, which is no failure of a simulation.
    const isRemoved = known !== "" && statusOf(error) === 404;
    const isGone = isRemoved || (statusOf(error) === 410 && (error as Problem).code === "job.dismissed");
    if ((!isLost && !isGone) || this.client.jobs?.wasCancelled(id)) this.declined.add(textOf(subject));
    this.state.set(isLost || isGone ? { kind: "none" } : { kind: "failed", sentence: explain(error) });
    if (isRemoved && !subject.isBackground) void this.simulate(subject.work, false);
  }

  private showProgress({ progress, stage, partial, remaining_seconds: remaining = null }: Job, { work }: Subject): void {
    // A verification tells of its only simulation in the same way.
    if (work === "polish" && partial && "round" in partial) this.rounds.add(partial.round, partial.family);
    this.state.set({ kind: "running", work, isBackground: this.subject?.isBackground ?? false, progress, stage, remaining });
  }

  /** Stores what an answer has simulated, and makes the design of a polish the shown one. Returns null if nothing was simulated, or nothing that is shown. */
  private accept(answer: DesignAnswer, subject: Subject): SimulationRecord | null {
    const { asked } = subject;
    this.subject = null;
    this.pauses.clear();
    const profiles = simulatedProfiles(answer, subject);
    if (!profiles) {
      this.declined.add(textOf(subject));
      this.state.set({ kind: "failed", sentence: answer.message || "Nothing was simulated." });
      return null;
    }
    const found = designOf(answer, asked);
    // The parameters of a verification are those that were asked for, but for rounding.
    const design = subject.work === "polish" ? simulatedDesign(found, asked.made) : subject.design;
    const record = { design, profiles, polish: answer.polish, targets: subject.targets, effects: answer.effects, seconds: answer.cost.seconds };
    const isMoved = subject.work === "polish" && !sameSimulatedDesign(design, subject.design);
    // What the user is changing is not taken out of their hands.
    const isHeld = this.session.edited.isBeingChanged;
    if (isMoved && !isHeld) {
      this.session.setFound(found);
      this.client.jobs?.place(this.jobId, writeLink(this.session.state.get()));
    }
    this.simulations.add(record);
    this.follow();
    return isMoved && isHeld ? null : record;
  }

  private async simulatePatch(record: SimulationRecord, asked: DesignState, run: Run<object>): Promise<void> {
    const isShown = (): boolean => this.record === record;
    const tell = (state: PatchState): void => {
      if (isShown()) this.patch.set(state);
    };
    this.patched = record;
    tell({ kind: "running", progress: 0 });
    try {
      const { family, parameters, youngsModulus, orientation } = record.design;
      const found = { family, parameters, youngsModulus, orientation };
      const made = { ...asked.made, youngsModulus, materials: [], orientation: (orientation * 180) / Math.PI };
      const state = { ...asked, made };
      const onJob = ({ progress }: Job): void => tell({ kind: "running", progress });
      const simulation = await run.job<Simulation>("/v1/simulations", patchRequest(state, found), { onJob });
      const done = { kind: "done", simulation, direction: patchDirection(state, found) } as const;
      this.patched = null;
      this.patches.set(record, done);
      tell(done);
    } catch (error) {
      if (run.isCancelled) throw error;
      this.patched = null;
      tell({ kind: "failed", sentence: explain(error) });
    }
  }
}

/** What a subject has of the state that is asked for. */
function askedOf(asked: DesignState): Pick<Subject, "asked" | "targets" | "order"> {
  return { asked, targets: targetsText(targetsOf(asked)), order: askedOrder(asked) };
}

function textOf({ design, targets }: Subject): string {
  return `${design.family} ${design.parameters.map((value) => value.toFixed(4)).join()} ${design.youngsModulus} ${design.orientation.toFixed(4)} ${targets}`;
}

/** Whether time or memory ran out before any structure was simulated, so that `message` says all there is. */
function endedBeforeSimulation({ polish, profile, also }: DesignAnswer): boolean {
  const wasStopped = polish?.stopped === "deadline" || polish?.stopped === "memory";
  return wasStopped && [profile, ...also].every(({ verified }) => !verified?.y.some((value) => value !== null));
}

/** The simulated responses in the order of the tabs; null if a target was not simulated. */
function simulatedProfiles(answer: DesignAnswer, { asked, order }: Pick<Subject, "asked" | "order">): SimulationRecord["profiles"] | null {
  const profiles = [answer.profile, ...answer.also];
  if (endedBeforeSimulation(answer)) return null;
  const targets = targetsOf(asked);
  const found = targets.map((target, place) => {
    const profile = profiles[order.indexOf(place)];
    const verified = profile?.verified ?? null;
    const beamWidth = profile?.beam_width_sensitivity;
    return verified && {
      kind: kindOf(target),
      curve: { x: verified.x, y: verified.y },
      deviation: verified.relative_rms ?? null,
      mesh: verified.discretization_error,
      ...(beamWidth && { beamWidth }),
    };
  });
  return found.every((one) => one !== null) ? found : null;
}
