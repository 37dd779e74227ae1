import { h } from "./dom";
import { icon, type IconName } from "./icons";

/** A menu that opens below its button. Escape and a press elsewhere close it. */
export function menu(words: string, picture: IconName, ...groups: HTMLElement[]): HTMLDetailsElement {
  return menuBelow(h("summary", { class: "button", title: words }, icon(picture), h("span", {}, words)), ...groups);
}

/** The same with a button of one's own. */
export function menuBelow(summary: HTMLElement, ...groups: readonly HTMLElement[]): HTMLDetailsElement {
  const element = h("details", { class: "menu" }, summary, h("div", { class: "menu-body" }, ...groups));
  element.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !element.open) return;
    element.open = false;
    summary.focus();
  });
  document.addEventListener("pointerdown", (event) => {
    if (element.open && !element.contains(event.target as Node)) element.open = false;
  });
  return element;
}
