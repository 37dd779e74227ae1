/**
 * Runs one task at a time. Only the newest of the tasks that arrive meanwhile waits, so that requests of a dragged pointer
 * do not accumulate.
 */
export class Latest {
  private running: AbortController | undefined;
  private next: ((signal: AbortSignal) => Promise<void>) | undefined;

  /** `urgent`: the running task is aborted; otherwise it ends first. Tasks report their failures themselves. */
  submit(task: (signal: AbortSignal) => Promise<void>, urgent = false): void {
    this.next = task;
    if (urgent) this.running?.abort();
    if (!this.running) void this.run();
  }

  /** Aborts the running task and drops the waiting one. */
  cancel(): void {
    this.next = undefined;
    this.running?.abort();
  }

  get busy(): boolean {
    return this.running !== undefined;
  }

  private async run(): Promise<void> {
    while (this.next) {
      const task = this.next;
      this.next = undefined;
      this.running = new AbortController();
      try {
        await task(this.running.signal);
      } catch (error) {
        console.error(error);
      }
      this.running = undefined;
    }
  }
}
