// The targets of the design as tabs above the plot: one is in sight and edited, all of them are asked for.
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { percent } from "../base/format";
import type { DesignSession } from "./session";
import { MOST_NAME, MOST_TARGETS, sameTargets, targetsOf, targetWords } from "./target_list";

/** `panel` shows the target in sight. */
export function targetTabs(session: DesignSession, panel: HTMLElement): HTMLElement {
  const list = h("div", { class: "tabs", role: "tablist", "aria-label": "Targets of the design" });
  const add = button("Target", () => void session.add(), { icon: "plus", title: "Add a further target of the same design", kind: "quiet" });
  const rename = button("", () => startNaming(), { icon: "pencil", title: "Rename this target", kind: "quiet" });
  const remove = button("", () => removeSelected(), { icon: "close", title: "Remove this target", kind: "quiet" });
  const name = h("input", { type: "text", class: "number text", maxlength: MOST_NAME, "aria-label": "Name of this target", spellcheck: "false" });
  const naming = h("form", { class: "naming", hidden: true, onsubmit: (event: Event) => {
    event.preventDefault();
    stopNaming(true);
  } }, name);
  const element = h("div", { class: "target-tabs" }, list, naming, rename, remove, add);

  function tab(at: number): HTMLButtonElement {
    const id = uniqueId("tab");
    return h("button", { type: "button", role: "tab", id, class: "tab", "aria-controls": panel.id, onclick: () => session.select(at), ondblclick: () => startNaming() },
      h("span", { class: "tab-name" }), h("span", { class: "tab-error muted" }));
  }

  /** Of more tabs than there is room for, the one in sight is. */
  function scrollTo(element: HTMLElement): void {
    const [left, right] = [element.offsetLeft, element.offsetLeft + element.offsetWidth];
    if (left < list.scrollLeft) list.scrollLeft = left;
    else if (right > list.scrollLeft + list.clientWidth) list.scrollLeft = right - list.clientWidth;
  }

  let drawn: HTMLButtonElement[] = [];
  function show(): void {
    const state = session.state.get();
    const targets = targetsOf(state);
    const all = session.all.get();
    if (drawn.length !== targets.length) {
      const focused = list.contains(document.activeElement);
      drawn = targets.map((_, k) => tab(k));
      replace(list, ...drawn);
      if (focused) drawn[state.at]?.focus();
    }
    drawn.forEach((element, k) => {
      const [words, error] = [element.children[0], element.children[1]];
      const found = all[k];
      words.textContent = targetWords(targets[k]);
      error.textContent = found && targets.length > 1 && sameTargets(found.targets, targets) ? percent(found.deviation) : "";
      element.setAttribute("aria-selected", String(k === state.at));
      element.tabIndex = k === state.at ? 0 : -1;
    });
    panel.setAttribute("aria-labelledby", drawn[state.at]?.id ?? "");
    if (drawn[state.at]) scrollTo(drawn[state.at]);
    const several = targets.length > 1;
    remove.hidden = !several;
    rename.hidden = !several || !naming.hidden;
    add.disabled = targets.length >= MOST_TARGETS || state.points.length === 0;
  }

  function removeSelected(): void {
    const { at } = session.state.get();
    const words = targetWords(session.state.get());
    session.remove(at);
    drawn[session.state.get().at]?.focus();
    announce(`${words} is removed.`, "change");
  }

  function startNaming(): void {
    const state = session.state.get();
    if (state.others.length === 0) return;
    name.value = targetWords(state);
    naming.hidden = false;
    rename.hidden = true;
    name.select();
    name.focus();
  }

  function stopNaming(take: boolean): void {
    if (naming.hidden) return;
    naming.hidden = true;
    const state = session.state.get();
    // What it is called anyway is no name of its own: it goes on to follow the direction.
    const given = name.value.trim() === targetWords({ ...state, name: "" }) ? "" : name.value;
    if (take && given.trim() !== state.name) session.rename(given);
    show();
    drawn[session.state.get().at]?.focus();
  }

  list.addEventListener("keydown", (event) => {
    const { at, others } = session.state.get();
    const last = others.length;
    const to = { ArrowLeft: at === 0 ? last : at - 1, ArrowRight: at === last ? 0 : at + 1, Home: 0, End: last }[event.key];
    if (event.key === "F2") startNaming();
    else if (event.key === "Delete" && last > 0) removeSelected();
    else if (to !== undefined) {
      session.select(to);
      drawn[to]?.focus();
    } else return;
    event.preventDefault();
  });
  name.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    event.preventDefault();
    stopNaming(false);
  });
  name.addEventListener("blur", () => stopNaming(true));

  for (const part of [session.state, session.all]) part.watch(show);
  return element;
}
