import { h } from "./dom";
import { Sentences, type Topic } from "./sentences";

/** A region whose words a screen reader speaks once it has nothing else to say. */
export const liveRegion = h("div", { class: "visually-hidden", role: "status", "aria-live": "polite", id: "announcements" });

const PAUSE_MS = 150;
const waiting = new Sentences();
let timer: ReturnType<typeof setTimeout> | undefined;

/** Says a sentence. Of several in a row about one topic only the last is said; an outcome does not silence the change that led to it. */
export function announce(sentence: string, topic: Topic = "outcome"): void {
  waiting.set(topic, sentence);
  clearTimeout(timer);
  timer = setTimeout(() => {
    liveRegion.textContent = waiting.take();
  }, PAUSE_MS);
}
