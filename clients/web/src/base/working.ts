// Work that goes on: its words, its progress and a button that stops it.
import { button } from "./controls";
import { h, replace } from "./dom";

/** One row for all of the work: a button that is replaced with each word of progress loses its focus and clicks. */
export class Working {
  private readonly words = h("span");
  private readonly bar: HTMLProgressElement;
  private readonly element: HTMLElement;

  constructor(label: string, cancel: () => void) {
    this.bar = h("progress", { max: 1, "aria-label": label });
    this.element = h("div", { class: "working" }, this.words, this.bar, button("Cancel", cancel));
  }

  /** Alone within `place`. Progress is a share from 0 to 1, or null where nobody knows it. */
  show(place: Element, words: string, progress: number | null): void {
    this.words.textContent = words;
    if (progress === null) this.bar.removeAttribute("value");
    else this.bar.value = progress;
    if (this.element.parentElement !== place) replace(place, this.element);
  }
}
