// Asks the server after jobs that no page follows: those of a page that was left, and those that others have begun with the same key.
import { Observable } from "../base/observable";
import { Client, statusOf } from "../contract/client";
import type { Job } from "../contract/types";
import { isUnfinished, type KeptJobs } from "./kept_jobs";

const PAUSE_MS = 2500;
/** Limit of the jobs of the key that are listed. */
const MAX_LISTED = 40;
/** Starts of the server that differ by less, in milliseconds, are the same: clocks differ. */
const SAME_START_MS = 10_000;

export class JobWatch {
  /** Jobs of the key that this browser has not begun, the newest first. They are known while the tray is open. */
  readonly others = new Observable<readonly Job[]>([]);
  /** When the server was started again while this browser had jobs; null if it was not. */
  readonly restarted = new Observable<Date | null>(null);
  /** Its requests tell nothing about whether the server serves: it answers them while it starts, too. */
  private readonly health = new Client();
  private isOpen = false;
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly client: Client, private readonly jobs: KeptJobs) {
    jobs.list.watch(() => this.schedule(PAUSE_MS));
  }

  /** Whether the tray is open. */
  setOpen(isOpen: boolean): void {
    this.isOpen = isOpen;
    if (isOpen) this.schedule(0);
  }

  /** Called when the editor begins, and when the server answers again: notices that it was started again. */
  async begin(): Promise<void> {
    const { serverStart, list } = this.jobs;
    const health = await this.health.get<{ uptime_seconds: number }>("/healthz").catch(() => null);
    if (!health) return;
    const start = Date.now() - 1000 * health.uptime_seconds;
    const isOther = serverStart !== null && Math.abs(start - serverStart) > SAME_START_MS;
    if (isOther && list.get().some(isUnfinished)) this.restarted.set(new Date(start));
    if (isOther || serverStart === null) this.jobs.setServerStart(start);
    this.schedule(0);
  }

  /** Cancels a job. A page that follows it notices. */
  async cancel(id: string): Promise<void> {
    this.jobs.cancel(id);
    await this.client.send("DELETE", `/v1/jobs/${id}`).catch(() => {}); // it has ended, or the server is gone
    this.others.set(this.others.get().filter((job) => job.id !== id));
  }

  private schedule(pause: number): void {
    if (pause > 0 && this.timer !== undefined) return;
    clearTimeout(this.timer);
    this.timer = undefined;
    if (this.isOpen || this.unfollowed.length > 0) this.timer = setTimeout(() => void this.ask(), pause);
  }

  private get unfollowed(): readonly string[] {
    return this.jobs.list.get().filter((job) => isUnfinished(job) && !this.jobs.isFollowed(job.id)).map(({ id }) => id);
  }

  private async ask(): Promise<void> {
    for (const id of this.unfollowed) {
      try {
        this.jobs.tell(await this.client.get<Job>(`/v1/jobs/${id}`));
      } catch (error) {
        if (statusOf(error) === 404) this.jobs.tellRemoved(id);
      }
    }
    if (this.isOpen) {
      const answer = await this.client.get<{ jobs: readonly Job[] }>(`/v1/jobs?limit=${MAX_LISTED}`).catch(() => null);
      if (answer) this.others.set(answer.jobs.filter(({ id, state }) => !this.jobs.isOwn(id) && state !== "dismissed"));
    }
    this.timer = undefined;
    this.schedule(PAUSE_MS);
  }
}
