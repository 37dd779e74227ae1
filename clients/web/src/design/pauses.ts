// Pauses between attempts of what the page does without being asked to, while the server is busy or does not answer.
const FIRST_MS = 30_000;
const MAX_MS = 600_000;

/** Each pause is twice as long as the one before, up to a limit, until an attempt succeeds or the server is known to answer. */
export class Pauses {
  private length = 0;
  private end = 0;

  /** Milliseconds until the next attempt; 0 if it may be made at once. */
  get remaining(): number {
    return Math.max(0, this.end - Date.now());
  }

  /** Begins the next pause. */
  begin(): void {
    this.length = this.length === 0 ? FIRST_MS : Math.min(2 * this.length, MAX_MS);
    this.end = Date.now() + this.length;
  }

  clear(): void {
    this.length = this.end = 0;
  }
}
