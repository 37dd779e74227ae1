import { h } from "./dom";

/** A region whose words a screen reader speaks once it has nothing else to say. */
export const liveRegion = h("div", { class: "visually-hidden", role: "status", "aria-live": "polite", id: "announcements" });

let timer: ReturnType<typeof setTimeout> | undefined;

/** Says a sentence; of several in a row only the last. */
export function announce(sentence: string): void {
  clearTimeout(timer);
  timer = setTimeout(() => {
    liveRegion.textContent = sentence;
  }, 150);
}
