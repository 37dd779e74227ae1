// The parameters of the family: sliders of the shown tiling, and for each parameter its words and bounds; and the width of the beams.
import { button, Slider } from "../base/controls";
import { h, writeText } from "../base/dom";
import { NumberField, TextField } from "../base/fields";
import { keepFocus } from "../base/focus";
import { percent } from "../base/format";
import { rebuild } from "../base/writing";
import { canAddParameter, changedParameter, defaultsHere, fixedParameter, fixedWidth, isOfType, widthAsParameter, widthParameter } from "./edits";
import { isConstant } from "./expressions";
import type { FamilySession } from "./session";
import { defaultsOf, type FamilyState, MAX_WORDS_LENGTH, rounded } from "./state";
import { meanSide, tilingAt } from "./tiling";

/** Limits of the width of beams over the mean side of the tile, in per cent. */
const WIDTHS: readonly [number, number] = [1, 40];
/** Bounds of parameters are within this number of 0, as coordinates are. */
const MAX_BOUND = 1000;

interface Row {
  readonly element: HTMLElement;
  show(state: FamilyState): void;
}

export function parameterName(description: string, index: number): string {
  return description === "" ? `Parameter ${index + 1}` : description;
}

export function parameterCard(session: FamilySession): HTMLElement {
  const list = h("div", { class: "parameters" });
  const none = h("p", { class: "muted" }, "This family has no parameters: it is one tiling.");
  const toDefaults = button("Back to the defaults", () => session.apply({ shown: defaultsOf(session.state.get().definition) }), { kind: "quiet" });
  const asDefaults = button("Make these the defaults", () => session.edit((_, edited) => defaultsHere(edited)), {
    title: "The shown parameters become those of a request without parameters",
  });
  let rows: Row[] = [];
  let builtKey = "";

  session.redraws.follow([session.state], () => {
    const state = session.state.get();
    const { parameters } = state.definition;
    const key = JSON.stringify(parameters.map(({ description }) => description));
    if (key !== builtKey) {
      builtKey = key;
      rows = parameters.map((_, k) => parameterRow(session, k));
      rebuild(list, () => rows.map(({ element }) => element));
    }
    for (const row of rows) row.show(state);
    none.hidden = parameters.length > 0;
    const isAtDefaults = defaultsOf(state.definition).every((value, k) => value === state.shown[k]);
    toDefaults.disabled = asDefaults.disabled = isAtDefaults;
    toDefaults.hidden = asDefaults.hidden = parameters.length === 0;
  });
  return h("section", { class: "card", "aria-label": "Parameters" }, h("h2", {}, "Parameters"), none, list, h("div", { class: "row" }, asDefaults, toDefaults),
    widthControls(session));
}

function parameterRow(session: FamilySession, index: number): Row {
  const { definition } = session.state.get();
  const { description, lower, upper } = definition.parameters[index];
  const name = parameterName(description, index);
  const slider = new Slider({
    label: name,
    lower,
    upper,
    digits: 4,
    changed: (value, done) => {
      session.preview({ shown: session.state.get().shown.map((old, k) => (k === index ? value : old)) });
      if (done) session.finish();
    },
  });
  const change = (changed: Parameters<typeof changedParameter>[2]) => session.edit((_, edited) => changedParameter(edited, index, changed));
  const present = () => session.state.get().definition.parameters[index];
  const within = (value: number) => (Math.abs(value) <= MAX_BOUND ? "" : `Bounds lie between −${MAX_BOUND} and ${MAX_BOUND}.`);
  const words = new TextField({ label: "What changes with it", maxLength: MAX_WORDS_LENGTH, changed: (text) => change({ description: text }) });
  const from = new NumberField({
    label: "From",
    fault: (value) => within(value) || (value < present().upper ? "" : "The lower bound must be below the upper one."),
    changed: (value) => change({ lower: value }),
  });
  const to = new NumberField({
    label: "To",
    fault: (value) => within(value) || (value > present().lower ? "" : "The upper bound must be above the lower one."),
    changed: (value) => change({ upper: value }),
  });
  const fix = button("Fix it here", () => session.edit((family, edited) => fixedParameter(family, edited, index)), {
    title: "The family keeps the shown value, and has one parameter less",
  });
  const note = h("p", { class: "muted" });
  const more = h("details", { class: "more" }, h("summary", { "aria-label": `Words and bounds of “${name}”` }, "Words and bounds"), words.element,
    h("div", { class: "bounds" }, from.element, to.element), h("div", { class: "row" }, fix), note);
  return {
    element: h("div", { class: "family-parameter" }, slider.element, more),
    show({ definition: { parameters }, shown }) {
      const parameter = parameters[index];
      if (!parameter) return;
      slider.limit(parameter.lower, parameter.upper);
      slider.value = shown[index];
      words.value = parameter.description;
      from.value = parameter.lower;
      to.value = parameter.upper;
      const family = session.drawn.get();
      writeText(note, family && isOfType(family, index) ? "It is a parameter of the isohedral type. To fix it writes the tile out: the family then has a tile of its own." : "");
      note.hidden = note.textContent === "";
    },
  };
}

/** The width of the beams, relative to the mean side of the tile: fixed, or a parameter. */
function widthControls(session: FamilySession): HTMLElement {
  const slider = new Slider({
    label: "Beam width over the mean side",
    lower: WIDTHS[0],
    upper: WIDTHS[1],
    digits: 2,
    unit: "%",
    changed: (value, done) => {
      const side = sideNow();
      session.preview({ definition: { ...session.state.get().definition, beam_width: rounded((value / 100) * side) } });
      if (done) session.finish();
    },
  });
  const words = h("p", { class: "muted" });
  const free = button("Make it a parameter", () => session.edit(widthAsParameter), { title: "Designs then choose the width of the beams, too" });
  const fix = button("Fix the width", () => {
    const family = session.drawn.get();
    const width = family && tilingAt(family, session.state.get().shown).beamWidth;
    if (width) session.edit((drawn, edited) => fixedWidth(drawn, edited, width));
  }, { title: "All tilings of the family get beams of the shown width" });

  const element = h("div", { class: "width-controls" }, h("h3", {}, "Beams"), slider.element, words, h("div", { class: "row" }, free, fix));

  function sideNow(): number {
    const family = session.drawn.get();
    return family ? meanSide(tilingAt(family, session.state.get().shown)) : 1;
  }

  session.redraws.follow([session.state], () => {
    const { definition, shown } = session.state.get();
    const family = session.drawn.get();
    if (!family) return;
    const tiling = tilingAt(family, shown);
    const relative = tiling.beamWidth / meanSide(tiling);
    const isFixed = isConstant(definition.beam_width);
    const parameter = widthParameter(definition);
    slider.value = 100 * relative;
    words.hidden = isFixed;
    writeText(words, parameter === null
      ? `The width of the beams changes with parameters; here it is ${percent(relative)} of the mean side.`
      : `The width of the beams is parameter ${parameter + 1}; here it is ${percent(relative)} of the mean side.`);
    keepFocus(element, () => {
      slider.element.hidden = !isFixed;
      free.hidden = !isFixed;
      free.disabled = !canAddParameter(definition);
      fix.hidden = isFixed;
    }, free, fix);
  });
  return element;
}
