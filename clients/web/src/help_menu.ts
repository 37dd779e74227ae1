// The help of every page: terms of the field with their definitions, the keys, and where to read on.
import { h } from "./base/dom";
import { menuBelow } from "./base/menu";
import { TERMS } from "./base/terms";

/** Keys and gestures that all pages have. */
const HANDS: readonly (readonly [what: string, does: string])[] = [
  ["Ctrl+Z, Ctrl+Shift+Z", "Undo and redo"],
  ["Double click, or double tap, on a plot", "Adds a control point; on a point, it removes it"],
  ["Pinch, or Ctrl and the wheel", "Zooms a plot"],
  ["Drop a file", "A test curve becomes the target, a drawing a part or a tile, a mesh the surface"],
];

export function helpMenu(): HTMLElement {
  const list = (entries: readonly (readonly [string, string])[]) => h("dl", { class: "help-list" }, ...entries.flatMap(([term, words]) => [h("dt", {}, term), h("dd", {}, words)]));
  const element = menuBelow(h("summary", { class: "button quiet", title: "Help", "aria-label": "Help" }, "?"), h("h3", {}, "What hands do"), list(HANDS),
    h("h3", {}, "What words mean"), list(Object.values(TERMS).map(({ name, definition }) => [name, definition] as const)), h("h3", {}, "Read on"),
    h("p", {}, "The manual is the folder docs of Supple: designs, families, parts, weaves, networks, Voronoi diagrams. "),
    h("p", {}, h("a", { href: "./openapi.yaml", target: "_blank", rel: "noopener" }, "The interface for scripts")));
  element.classList.add("help");
  return element;
}
