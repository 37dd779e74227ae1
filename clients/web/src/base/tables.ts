// Tables of words and numbers.
import { h } from "./dom";

export function table(caption: string, head: readonly string[], rows: readonly (readonly string[])[], kind = ""): HTMLElement {
  return h("div", { class: `table-box ${kind}`.trim(), tabindex: 0, role: "region", "aria-label": caption },
    h("table", {}, h("caption", {}, caption), h("thead", {}, h("tr", {}, ...head.map((words) => h("th", { scope: "col" }, words)))),
      h("tbody", {}, ...rows.map(([first, ...others]) => h("tr", {}, h("th", { scope: "row" }, first), ...others.map((words) => h("td", {}, words)))))));
}
