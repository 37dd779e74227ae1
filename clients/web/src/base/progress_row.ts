// A row that shows running work: a text, a progress bar and a cancel button.
import { button } from "./controls";
import { h, replace } from "./dom";

/** The same elements serve for all of the work, because a button that is replaced while it is updated would lose its focus and clicks. */
export class ProgressRow {
  private readonly words = h("span");
  private readonly bar: HTMLProgressElement;
  private readonly element: HTMLElement;

  constructor(label: string, cancel: () => void) {
    this.bar = h("progress", { max: 1, "aria-label": label });
    this.element = h("div", { class: "working" }, this.words, this.bar, button("Cancel", cancel));
  }

  /** Shows the row as the only child of `place`. Progress is a fraction from 0 to 1; null if it is unknown. */
  show(place: Element, words: string, progress: number | null): void {
    this.words.textContent = words;
    if (progress === null) this.bar.removeAttribute("value");
    else this.bar.value = progress;
    if (this.element.parentElement !== place) replace(place, this.element);
  }
}
