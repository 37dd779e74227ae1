// Redraws of a page's cards: each takes place at most once before the browser repaints, however many of the values that a card shows have changed.

/**
 * Pause in ms before cards are redrawn while the user drags. What is under the pointer is redrawn at once; it would wait for the cards
 * otherwise, because the browser styles, arranges and paints all of them in the same frame.
 */
const DRAG_PAUSE_MS = 150;

/** What can be watched, such as an observable value. */
interface Watched {
  watch(listener: () => void): unknown;
}

export class Redraws {
  private readonly waiting = new Set<() => void>();
  private timer: ReturnType<typeof setTimeout> | undefined;
  private hasFrame = false;

  constructor(private readonly isDragging: () => boolean) {}

  /** Draws now, and again after changes of some parts. */
  follow(parts: readonly Watched[], draw: () => void): void {
    let isFirst = true;
    for (const part of parts) part.watch(() => !isFirst && this.schedule(draw));
    isFirst = false;
    draw();
  }

  /** Draws before the next repaint, or after a pause while the user drags. */
  schedule(draw: () => void): void {
    this.waiting.add(draw);
    if (this.isDragging()) this.timer ??= setTimeout(() => this.requestFrame(), DRAG_PAUSE_MS);
    else this.requestFrame();
  }

  private requestFrame(): void {
    clearTimeout(this.timer);
    this.timer = undefined;
    if (this.hasFrame) return;
    this.hasFrame = true;
    requestAnimationFrame(() => {
      this.hasFrame = false;
      const draws = [...this.waiting];
      this.waiting.clear();
      for (const draw of draws) draw();
    });
  }
}
