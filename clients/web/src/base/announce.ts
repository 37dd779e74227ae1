import { h } from "./dom";
import { Sentences, type Topic } from "./sentences";

/** A live region: a screen reader speaks its text when it is idle. */
export const liveRegion = h("div", { class: "visually-hidden", role: "status", "aria-live": "polite", id: "announcements" });

const PAUSE_MS = 150;
const pending = new Sentences();
let timer: ReturnType<typeof setTimeout> | undefined;

/**
 * Announces a sentence to screen readers after a pause. A sentence replaces an earlier one of the same topic that is still pending.
 * An outcome does not replace the change that led to it.
 */
export function announce(sentence: string, topic: Topic = "outcome"): void {
  pending.set(topic, sentence);
  clearTimeout(timer);
  timer = setTimeout(() => {
    liveRegion.textContent = pending.take();
  }, PAUSE_MS);
}
