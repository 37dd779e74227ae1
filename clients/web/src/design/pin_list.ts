import { button } from "../base/controls";
import { h, replace, svg } from "../base/dom";
import { digits } from "../base/format";
import type { Pins } from "./pins";
import type { Client } from "../contract/client";
import { structurePath } from "./requests";

export function pinList(pins: Pins, client: Client): HTMLElement {
  const list = h("ul", { class: "pins" });
  const empty = h("p", { class: "muted" }, "Pin a design to compare others with it.");
  pins.list.watch((all) => {
    empty.hidden = all.length > 0;
    replace(
      list,
      ...all.map((pin) =>
        h(
          "li",
          {},
          h("img", { class: "thumbnail", src: client.url(structurePath(pin.state.found, "svg", [2, 2])), alt: "" }),
          h(
            "div",
            { class: "pin-words" },
            h("span", { class: "pin-name" },
              svg("svg", { class: "swatch", viewBox: "0 0 18 6", "aria-hidden": "true" }, svg("path", { class: `curve pin pin-${pin.id % 6}`, d: "M0 3H18" })), pin.name),
            h("span", { class: "muted" }, pin.state.found.parameters.map((value) => digits(value, 4)).join(", ")),
          ),
          button("", () => pins.show(pin), { icon: "restore", title: `Go back to ${pin.name}`, kind: "quiet" }),
          button("", () => pins.remove(pin.id), { icon: "close", title: `Remove ${pin.name}`, kind: "quiet" }),
        )
      ),
    );
  });
  return h("section", { class: "card", "aria-label": "Pinned designs" }, h("h2", {}, "Pinned designs"), empty, list);
}
