// The parameters of the shown design: sliders that update its profile at once, and locks that fix parameters in searches.
import { button, Slider } from "../base/controls";
import { h, replace, replaceChanged, writeAttribute, writeText } from "../base/dom";
import { icon } from "../base/icons";
import { parameterWords } from "./parameter_words";
import type { DesignSession } from "./session";
import { ANY, type DesignState } from "./state";

interface Row {
  slider: Slider;
  lock: HTMLButtonElement;
}

export function parameterPanel(session: DesignSession): HTMLElement {
  const list = h("div", { class: "parameters" });
  const title = h("h2", {}, "Parameters");
  const fit = button("Fit to the target", () => session.apply({ byHand: false }), { kind: "primary", icon: "target" });
  const note = h("div", { class: "hand-note" }, h("p", {}, "Set by hand: the target is not searched for."), fit);
  let rows: Row[] = [];
  let family = "";

  const wordsOf = (index: number) => parameterWords(family, index, session.catalogue.family(family)?.definition?.parameters[index]?.description);

  function build(state: DesignState): void {
    const model = state.found && session.catalogue.model(state.found.family);
    family = state.found?.family ?? "";
    rows = [];
    if (!model) return replace(list);
    const { lower, upper } = model.parameters;
    rows = lower.map((min, k) => ({
      slider: new Slider({
        label: wordsOf(k).name,
        title: wordsOf(k).help,
        lower: min,
        upper: upper[k],
        digits: 4,
        changed: (value, done) => set(k, value, done),
      }),
      lock: h("button", { type: "button", class: "button quiet lock", onclick: () => toggle(k) }),
    }));
    replace(list, ...rows.map((row) => h("div", { class: "parameter" }, row.slider.element, row.lock)));
  }

  function set(index: number, value: number, done: boolean): void {
    const { found } = session.state.get();
    if (found) session.setParameters(found.parameters.map((old, k) => (k === index ? value : old)), done);
  }

  function toggle(index: number): void {
    const { fixed, found, family: wanted } = session.state.get();
    if (!found) return;
    const next = found.parameters.map((_, k) => (k === index ? !fixed[k] : Boolean(fixed[k])));
    // Fixed parameters belong to one family, so that fixing one also selects the family.
    session.apply({ fixed: next, family: wanted === ANY && next.some(Boolean) ? found.family : wanted });
  }

  session.redraws.follow([session.state], () => {
    const state = session.state.get();
    if ((state.found?.family ?? "") !== family || rows.length !== (state.found?.parameters.length ?? 0)) build(state);
    writeText(title, state.found ? `Parameters of ${state.found.family}` : "Parameters");
    rows.forEach((row, k) => {
      const isFixed = Boolean(state.fixed[k]);
      row.slider.value = state.found?.parameters[k] ?? 0;
      writeAttribute(row.lock, "aria-pressed", String(isFixed));
      writeAttribute(row.lock, "aria-label", `Keep “${wordsOf(k).name}” in searches`);
      writeAttribute(row.lock, "title", isFixed ? "Kept in searches" : "Searched for");
      replaceChanged(row.lock, icon(isFixed ? "lock" : "unlock"));
    });
    note.hidden = !state.byHand;
  });
  return h("section", { class: "card", "aria-label": "Parameters" }, title, list, note);
}
