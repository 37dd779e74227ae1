// What a first visit begins with: one sentence of what this is, and three examples as pictures. It is shown until it was closed.
import { button } from "../base/controls";
import { h } from "../base/dom";
import { targetSketch } from "./start_menu";
import { type Start, STARTS, WELCOME_SENTENCE, WELCOME_STARTS } from "./starts";

const KEY = "supple-welcome";

function wasClosed(): boolean {
  try {
    return localStorage.getItem(KEY) === "closed";
  } catch {
    return false;
  }
}

/** `choose`: starts with an example. `closed`: called when it is closed, so that the focus goes elsewhere. */
export function welcome(choose: (start: Start) => void, closed: () => void): HTMLElement {
  const starts = WELCOME_STARTS.flatMap((name) => STARTS.find((start) => start.name === name) ?? []);
  const close = (): void => {
    element.hidden = true;
    try {
      localStorage.setItem(KEY, "closed");
    } catch {
      // storage is blocked: the next visit begins with it again
    }
    closed();
  };
  const pictures = starts.map((start) =>
    h("li", {}, h("button", {
      type: "button",
      class: "start",
      onclick: () => {
        choose(start);
        close();
      },
    }, targetSketch(start), h("span", { class: "start-words" }, h("strong", {}, start.name), h("span", { class: "muted" }, start.words))))
  );
  const element = h("section", { class: "card wide welcome", "aria-label": "What this is", hidden: wasClosed() },
    h("div", { class: "welcome-head" }, h("p", { class: "welcome-words" }, WELCOME_SENTENCE),
      button("", close, { icon: "close", kind: "quiet", title: "Close, and do not show it again" })),
    h("ul", { class: "starts welcome-starts", "aria-label": "Examples to begin with" }, ...pictures));
  return element;
}
