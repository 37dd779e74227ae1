// Whether the server answers: told by every request, and asked for while none does.
import { Observable } from "../base/observable";

const FIRST_PROBE_MS = 500;
const LONGEST_PROBE_MS = 8000;

export class Connection {
  readonly lost = new Observable(false);
  private timer: ReturnType<typeof setTimeout> | undefined;
  private wait = FIRST_PROBE_MS;

  constructor(private readonly probe: () => Promise<boolean>) {}

  /** To be called with the outcome of every request. */
  report(answered: boolean): void {
    this.lost.set(!answered);
    if (answered) {
      clearTimeout(this.timer);
      this.timer = undefined;
      this.wait = FIRST_PROBE_MS;
    } else if (this.timer === undefined) {
      this.schedule();
    }
  }

  private schedule(): void {
    this.timer = setTimeout(() => void this.tryAgain(), this.wait);
    this.wait = Math.min(2 * this.wait, LONGEST_PROBE_MS);
  }

  private async tryAgain(): Promise<void> {
    this.timer = undefined;
    this.report(await this.probe());
  }
}
