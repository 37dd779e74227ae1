import { button } from "../base/controls";
import { h, replace, svg } from "../base/dom";
import { digits } from "../base/format";
import type { Pins } from "./pins";
import { extremes } from "./profile";

export function pinList(pins: Pins): HTMLElement {
  const list = h("ul", { class: "pins" });
  const empty = h("p", { class: "muted" }, "Pin a weave to compare others with it.");
  pins.list.watch((all) => {
    empty.hidden = all.length > 0;
    replace(list, ...all.map((pin) => {
      const range = extremes(pin.profile.youngs);
      return h("li", {},
        h("div", { class: "pin-words" },
          h("span", { class: "pin-name" },
            svg("svg", { class: "swatch", viewBox: "0 0 18 6", "aria-hidden": "true" }, svg("path", { class: `curve pin pin-${pin.id % 6}`, d: "M0 3H18" })), pin.name),
          h("span", { class: "muted" }, range ? `${digits(range[0])} to ${digits(range[1])} N/m` : "no values")),
        button("", () => pins.show(pin), { icon: "restore", title: `Go back to ${pin.name}`, kind: "quiet" }),
        button("", () => pins.remove(pin.id), { icon: "close", title: `Remove ${pin.name}`, kind: "quiet" }));
    }));
  });
  return h("section", { class: "card", "aria-label": "Pinned weaves" }, h("h2", {}, "Pinned weaves"), empty, list);
}
