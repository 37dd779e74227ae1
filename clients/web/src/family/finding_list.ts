// What the server's check has found, below the drawing: a sentence for each finding, with the number of its mark, and a button that shows it.
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h, replaceChanged, writeText } from "../base/dom";
import { keepFocus } from "../base/focus";
import { isShownAt, summaryOf } from "./findings";
import type { FamilySession } from "./session";
import type { TilingView } from "./tiling_view";

export function findingList(session: FamilySession, view: TilingView): HTMLElement {
  const summary = h("p", { class: "check-summary", tabindex: -1 });
  const glance = h("p", { class: "note", hidden: true });
  const list = h("ol", { class: "findings", "aria-label": "What the check has found" });
  const element = h("div", { class: "check" }, glance, summary, list);
  let announced: unknown = null;

  function words(): string {
    const activity = session.checks.activity.get();
    if (session.fault.get() !== "") return session.fault.get();
    if (session.isStarted && session.drawn.get() === null) {
      return "This definition cannot be drawn: it names an isohedral type that there is not, or has fewer parameters than its type.";
    }
    if (session.findings) return summaryOf(session.findings);
    return activity.kind === "failed" ? activity.sentence : "Checking whether the tiles fill the plane …";
  }

  function draw(): void {
    const { findings } = session;
    const { shown } = session.state.get();
    writeText(summary, words());
    summary.dataset.grade = findings === null ? "unknown" : findings.some(({ kind }) => kind === "fault") ? "faulty" : findings.length > 0 ? "warned" : "good";
    glance.hidden = view.faultWords === "";
    writeText(glance, view.faultWords);
    const known = findings ?? session.checked.get()?.findings ?? [];
    element.classList.toggle("old", findings === null);
    const items = known.map((finding, k) => {
      const canShow = finding.parameters !== null && !isShownAt(finding, shown);
      return h("li", { class: finding.kind, "data-index": k }, h("span", { class: "finding-number", "aria-hidden": "true" }, String(k + 1)), h("span", {}, finding.sentence),
        canShow && h("button", { type: "button", class: "button quiet", "data-index": k, "aria-label": `Show where: ${finding.sentence}` }, h("span", {}, "Show where")));
    });
    keepFocus(list, () => replaceChanged(list, ...items), summary);
    if (findings && findings !== announced) {
      announced = findings;
      announce([summaryOf(findings), ...findings.map(({ sentence }) => sentence)].slice(0, 4).join(" "));
    }
  }

  // The buttons are equal from one drawing to the next, so that the list listens for all of them.
  list.addEventListener("click", (event) => {
    const pressed = event.target instanceof Element ? event.target.closest<HTMLElement>("button[data-index]") : null;
    const finding = pressed && session.findings?.[Number(pressed.dataset.index)];
    if (finding?.parameters) session.apply({ shown: finding.parameters });
  });
  session.redraws.follow([session.state, session.checked, session.checks.activity, session.drawn, session.fault], draw);
  return element;
}

/** Tools of the drawing: what a drag changes, and the last drag as a parameter. */
export function dragControls(session: FamilySession, mode: HTMLElement, makeParameter: () => void): HTMLElement {
  const asParameter = button("Make the last drag a parameter", makeParameter, { title: "A parameter that leads from the tile before the drag to the one after it" });
  const words = h("p", { class: "muted" });
  session.redraws.follow([session.state, session.mode, session.lastDrag, session.drawn], () => {
    const family = session.drawn.get();
    keepFocus(asParameter, () => {
      asParameter.hidden = session.lastDrag.get() === null;
    }, ...mode.querySelectorAll<HTMLElement>("input:checked"));
    writeText(words, session.mode.get() === "parameters" ? parameterModeWords(family?.definition.parameters.length ?? 0) : tileModeWords(family?.type !== null));
  });
  return h("div", { class: "drag-controls" }, mode, asParameter, words);
}

function parameterModeWords(parameters: number): string {
  if (parameters === 0) return "There are no parameters that move vertices: choose “the tile” to drag them.";
  return "Vertices move along their parameters, whose bounds follow beyond their ends. Dashed ones are moved by none.";
}

function tileModeWords(isOfType: boolean): string {
  const follows = "What has to move along does, so that the tiles still fill the plane.";
  return isOfType ? `${follows} The tile of the isohedral type becomes one of your own.` : follows;
}
