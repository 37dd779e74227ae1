/**
 * Runs one task at a time; of those that come meanwhile only the newest is kept. So a stream of wishes, as a pointer
 * that is dragged gives them, never piles up.
 */
export class Latest {
  private running: AbortController | undefined;
  private next: ((signal: AbortSignal) => Promise<void>) | undefined;

  /** `urgent`: what runs is stopped; otherwise it may end first. Tasks report their failures themselves. */
  submit(task: (signal: AbortSignal) => Promise<void>, urgent = false): void {
    this.next = task;
    if (urgent) this.running?.abort();
    if (!this.running) void this.run();
  }

  /** Stops what runs and forgets what waits. */
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
