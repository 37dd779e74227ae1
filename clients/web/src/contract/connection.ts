// Whether the server answers. Every request reports it; after a failure, probes repeat until one succeeds.
import { Observable } from "../base/observable";

const FIRST_PROBE_MS = 500;
const MAX_PROBE_MS = 8000;

export class Connection {
  readonly lost = new Observable(false);
  private timer: ReturnType<typeof setTimeout> | undefined;
  private delay = FIRST_PROBE_MS;

  constructor(private readonly probe: () => Promise<boolean>) {}

  /** Called with the outcome of every request. */
  report(answered: boolean): void {
    this.lost.set(!answered);
    if (answered) {
      clearTimeout(this.timer);
      this.timer = undefined;
      this.delay = FIRST_PROBE_MS;
    } else if (this.timer === undefined) {
      this.schedule();
    }
  }

  private schedule(): void {
    this.timer = setTimeout(() => void this.tryAgain(), this.delay);
    this.delay = Math.min(2 * this.delay, MAX_PROBE_MS);
  }

  private async tryAgain(): Promise<void> {
    this.timer = undefined;
    this.report(await this.probe());
  }
}
