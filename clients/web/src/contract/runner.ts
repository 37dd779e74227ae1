// Runs the computations of one part of a page, one at a time: requests, jobs and their partial results, what is told meanwhile, cancellation, and
// what has to be repeated once the server answers again.
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, isAbort, isDismissed } from "./client";
import { followJob, runJob } from "./jobs";
import type { Job } from "./types";

/** What a part of a page is doing. `Work` says what is computed; the progress is a fraction from 0 to 1, or null if it is not known. */
export type Activity<Work extends object> =
  | { readonly kind: "idle" }
  | ({ readonly kind: "busy"; readonly progress: number | null } & Work)
  /** The user has cancelled the computation. */
  | { readonly kind: "stopped" }
  | { readonly kind: "failed"; readonly sentence: string; readonly error?: unknown };

/** A computation that is described by a few words. */
export interface WorkInWords {
  readonly words: string;
}

export interface JobSettings {
  /** Seconds that the server may take for an immediate answer. Without it, the computation is a job from the start. */
  readonly wait?: number;
  /** Called with each state of the job, which may have a partial result. */
  readonly onJob?: (job: Job) => void;
  /** Whether nobody waits for the job; by default if its request has the priority `background`. */
  readonly isBackground?: () => boolean;
}

/** A task that is running. Once it was cancelled, each of its requests throws, so that nothing of it is shown. */
export class Run<Work extends object> {
  constructor(
    private readonly client: Client,
    private readonly activity: Observable<Activity<Work>>,
    private readonly signal: AbortSignal,
  ) {}

  get isCancelled(): boolean {
    return this.signal.aborted;
  }

  /** Tells what is computed. */
  tell(work: Work, progress: number | null = null): void {
    if (!this.isCancelled) this.activity.set({ kind: "busy", progress, ...work });
  }

  /** The answer of a computation of any duration. */
  job<Answer>(path: string, request: unknown, { wait, onJob, isBackground }: JobSettings = {}): Promise<Answer> {
    const onProgress = (job: Job): void => {
      if (!this.isCancelled) onJob?.(job);
    };
    return this.unlessCancelled(runJob<Answer>(this.client, path, request, { signal: this.signal, wait, onProgress, isBackground }));
  }

  /** The answer of a job that was started before. `path`, `request`: those that started it. */
  startedJob<Answer>(id: string, path: string, request: unknown, { onJob, isBackground }: JobSettings = {}): Promise<Answer> {
    const onProgress = (job: Job): void => {
      if (!this.isCancelled) onJob?.(job);
    };
    return this.unlessCancelled(followJob<Answer>(this.client, { id }, path, request, { signal: this.signal, onProgress, isBackground }));
  }

  /** The answer of a computation that is no job. */
  post<Answer>(path: string, request: unknown): Promise<Answer> {
    return this.unlessCancelled(this.client.post<Answer>(path, request, { signal: this.signal }));
  }

  /** The answer of a computation as the text of a file. */
  async file(path: string, request: unknown, type: string): Promise<string> {
    const response = await this.client.postResponse(path, request, { signal: this.signal, headers: { Accept: type } });
    return this.unlessCancelled(response.text());
  }

  /** The text at a path. */
  async text(path: string): Promise<string> {
    const response = await this.client.send("GET", path, undefined, { signal: this.signal });
    return this.unlessCancelled(response.text());
  }

  /** The value of a promise. Throws if the task was cancelled meanwhile. */
  async unlessCancelled<Value>(promise: Promise<Value>): Promise<Value> {
    const value = await promise;
    this.signal.throwIfAborted();
    return value;
  }
}

export type Task<Work extends object> = (run: Run<Work>) => Promise<void>;

export class JobRunner<Work extends object = WorkInWords> {
  /** Whether the last task that was not cancelled has failed. */
  hasFailed = false;
  private running: AbortController | null = null;
  private waiting: (() => Promise<void>) | null = null;

  /** `activity`: shared by several runners of one part of a page. */
  constructor(
    private readonly client: Client,
    readonly activity = new Observable<Activity<Work>>({ kind: "idle" }),
  ) {}

  /** Whether a task waits, or runs and was not aborted. */
  get isRunning(): boolean {
    return this.waiting !== null || (this.running !== null && !this.running.signal.aborted);
  }

  /** Stops the running task and runs this one at once. Resolves when it has ended. `failed`: what is done with its error. */
  start(task: Task<Work>, failed: (error: unknown) => void = this.tellFailure): Promise<void> {
    this.stop();
    return this.run(task, failed);
  }

  /** Starts a task and tells what it computes. */
  begin(work: Work, task: Task<Work>, failed?: (error: unknown) => void): Promise<void> {
    return this.start((run) => {
      run.tell(work);
      return task(run);
    }, failed);
  }

  /**
   * Runs a task when the running one has ended; `urgent`: the running one is aborted. Only the newest of the tasks that arrive meanwhile
   * is run, so that the requests of a dragged pointer do not accumulate.
   */
  follow(task: Task<Work>, failed: (error: unknown) => void = this.tellFailure, urgent = false): void {
    if (urgent) this.running?.abort();
    if (this.running) this.waiting = () => this.run(task, failed);
    else void this.run(task, failed);
  }

  /** Aborts the running task and forgets the waiting one. A task that follows still waits until the aborted one has ended. */
  stop(): void {
    this.waiting = null;
    this.running?.abort();
  }

  /** Stops the running task and tells that there is none. */
  cancel(): void {
    this.stop();
    this.activity.set({ kind: "idle" });
  }

  /** Tells an error. A job that was dismissed elsewhere, for example in the tray of jobs, counts as cancelled. */
  readonly tellFailure = (error: unknown): void => this.activity.set(isDismissed(error) ? { kind: "stopped" } : { kind: "failed", sentence: explain(error), error });

  /** Tells an error, but for a lost connection: the page's frame reports that, and the page repeats the task when the server answers again. */
  readonly tellFault = (error: unknown): void => {
    if (error instanceof ConnectionLost) this.activity.set({ kind: "idle" });
    else this.tellFailure(error);
  };

  private async run(task: Task<Work>, failed: (error: unknown) => void): Promise<void> {
    const controller = new AbortController();
    this.running = controller;
    try {
      await task(new Run(this.client, this.activity, controller.signal));
      controller.signal.throwIfAborted();
      this.hasFailed = false;
      this.activity.set({ kind: "idle" });
    } catch (error) {
      if (!controller.signal.aborted && !isAbort(error)) {
        this.hasFailed = !isDismissed(error);
        failed(error);
      }
    }
    if (this.running !== controller) return;
    this.running = null;
    const next = this.waiting;
    this.waiting = null;
    void next?.();
  }
}
