// The training of a network of the family: what it would take, the training itself as a job, and the errors that it has reached on the way.
import { Observable } from "../base/observable";
import { textKey } from "../base/text_key";
import { type Client, ConnectionLost, Problem } from "../contract/client";
import { type Activity, JobRunner, type WorkInWords } from "../contract/runner";
import type { Job, PartialTraining, Training, TrainingPlan, TrainingRequest } from "../contract/types";
import type { FamilySession } from "./session";
import type { FamilyState } from "./state";

const SECONDS = 3600;

/** The mean error of a network that has learned from some number of designs. */
export interface ReachedError {
  readonly designs: number;
  readonly error: number;
}

/** A training that has begun, or has ended. */
export interface TrainingRun {
  readonly family: string;
  /** Error at which it may end earlier; 0 for none. */
  readonly goal: number;
  readonly errors: readonly ReachedError[];
  readonly answer: Training | null;
  /** Whether it was cancelled: what is done is kept by the server. */
  readonly isCancelled: boolean;
}

export interface ShownPlan {
  /** Key of the request. */
  readonly key: string;
  readonly plan: TrainingPlan;
}

/** What is asked for. The same request goes on where an earlier one was stopped. */
export function trainingRequest({ definition: { id }, coreHours, error }: Pick<FamilyState, "definition" | "coreHours" | "error">): TrainingRequest {
  return { family: id, budget: { core_seconds: Math.round(SECONDS * coreHours) }, ...(error > 0 && { accuracy: { error } }) };
}

const STAGE_WORDS: Readonly<Record<string, string>> = {
  designs: "simulating designs",
  committee: "small networks choose designs",
  network: "training the network",
  "error bars": "measuring its error bars",
};

export function stageWords(stage: string): string {
  return stage === "" ? "Training" : `Training: ${STAGE_WORDS[stage] ?? stage}`;
}

/** The errors that a running training has reached; empty if the job tells none. */
export function errorsOf({ partial }: Pick<Job, "partial">): readonly ReachedError[] {
  return partial && "errors" in partial ? (partial as PartialTraining).errors : [];
}

/** Whether the server trains no networks at all: it has no program for it, or is of an earlier version. */
export function trainsNoNetworks(error: unknown): boolean {
  return error instanceof Problem && (error.code === "training.unavailable" || error.code === "http.not_found");
}

/** The errors with that of the finished network, unless the job has told it already. */
export function withError(errors: readonly ReachedError[], { designs, error }: ReachedError): ReachedError[] {
  const last = errors.at(-1);
  return last?.designs === designs && last.error === error ? [...errors] : [...errors, { designs, error }];
}

export class TrainingSession {
  readonly run = new Observable<TrainingRun | null>(null);
  readonly plan = new Observable<ShownPlan | null>(null);
  readonly activity: Observable<Activity<WorkInWords>>;
  private readonly runner: JobRunner;
  private readonly plans: JobRunner;
  readonly planActivity: Observable<Activity<WorkInWords>>;

  constructor(private readonly session: FamilySession, client: Client) {
    this.runner = new JobRunner(client);
    this.plans = new JobRunner(client);
    this.activity = this.runner.activity;
    this.planActivity = this.plans.activity;
  }

  /** The plan of the present request; null if none was asked for. */
  get currentPlan(): TrainingPlan | null {
    const shown = this.plan.get();
    return shown?.key === textKey(trainingRequest(this.session.state.get())) ? shown.plan : null;
  }

  /** Asks what the training would take. The server simulates a few designs for it. */
  estimate(): Promise<void> {
    const request = trainingRequest(this.session.state.get());
    return this.plans.begin({ words: "Simulating four designs for the estimate" }, async (run) => {
      const plan = await run.job<TrainingPlan>("/v1/training-plans", request, {
        onJob: ({ progress }) => run.tell({ words: "Simulating four designs for the estimate" }, progress),
      });
      this.plan.set({ key: textKey(request), plan });
    });
  }

  /** Starts the training, or goes on with one that was stopped. */
  train(): Promise<void> {
    const state = this.session.state.get();
    const request = trainingRequest(state);
    const earlier = this.run.get();
    const errors = earlier?.family === request.family ? earlier.errors : [];
    this.run.set({ family: request.family, goal: state.error, errors, answer: null, isCancelled: false });
    return this.runner.begin({ words: "Training" }, async (run) => {
      const answer = await run.job<Training>("/v1/trainings", { ...request, priority: "background" }, {
        onJob: (job) => {
          run.tell({ words: stageWords(job.stage) }, job.progress);
          this.note(errorsOf(job));
        },
      });
      this.note(withError(this.run.get()?.errors ?? [], answer));
      this.change({ answer });
      await this.session.loadFamilies();
    }, (error) => {
      this.runner.tellFailure(error);
      if (this.activity.get().kind === "stopped") this.change({ isCancelled: true });
    });
  }

  /** Stops the training. What is done is kept by the server, and `train` goes on with it. */
  cancel(): void {
    this.runner.cancel();
    this.change({ isCancelled: true });
  }

  cancelEstimate(): void {
    this.plans.cancel();
  }

  /** Repeats what a lost connection has ended. */
  retry(): void {
    const isLost = (activity: Activity<WorkInWords>) => activity.kind === "failed" && activity.error instanceof ConnectionLost;
    if (isLost(this.activity.get())) void this.train();
    if (isLost(this.planActivity.get())) void this.estimate();
  }

  private change(change: Partial<TrainingRun>): void {
    const run = this.run.get();
    if (run) this.run.set({ ...run, ...change });
  }

  private note(errors: readonly ReachedError[]): void {
    if (errors.length > 0) this.change({ errors });
  }
}
