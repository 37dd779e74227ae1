// The panel of user-drawn strands: lattice, drawing tools, list of strands, and their text.
import { button, Segments } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { touchWords } from "../base/touch_words";
import { showText } from "../base/writing";
import { inWords } from "../contract/places";
import type { Draft } from "./draft";
import { arrayed, type Ends, isLattice, MAX_ARRAY_STRANDS, scaledLayout, strandWords, withDuplicate, withLattice, withoutStrand } from "./layout_edit";
import { LayoutTextError, readLayoutText, writeLayoutText } from "./layout_text";
import type { WeaveSession } from "./session";
import { FIRST_LAYOUT, type Lattice, type Point } from "./state";

export function strandPanel(session: WeaveSession, draft: Draft): HTMLElement {
  const section = h("section", { class: "card controls", "aria-label": "Strands" }, latticeFields(session), drawingTools(draft, session), strandList(session), wholeTools(session),
    textBox(session));
  session.state.watch((state) => (section.hidden = state.pattern !== "layout"));
  return section;
}

/** The controls of the lattice: whether the strands repeat, and the two translations. */
function latticeFields(session: WeaveSession): HTMLElement {
  const kind = new Segments<"cell" | "sheet">("What is drawn", [{ value: "cell", words: "A cell that repeats" }, { value: "sheet", words: "A sheet" }], (value) => {
    const { layout } = session.state.get();
    session.setLayout(withLattice(layout, value === "cell" ? FIRST_LAYOUT.lattice : null));
  });
  const names = ["First translation, x", "First translation, y", "Second translation, x", "Second translation, y"];
  const fields = names.map((name) => h("input", { type: "number", class: "number", step: "any", "aria-label": `${name}, mm`, onchange: () => change() }));
  const row = (words: string, first: number) => h("div", { class: "translation" }, h("span", {}, words), fields[first], fields[first + 1]);
  const table = h("div", { class: "translations" }, row("Translation 1 (mm)", 0), row("Translation 2 (mm)", 2));

  function change(): void {
    const [ax, ay, bx, by] = fields.map((field) => Number(field.value));
    const lattice: Lattice = [[ax, ay], [bx, by]];
    const isValid = fields.every((field) => field.value !== "") && isLattice(lattice);
    fields[3].setCustomValidity(isValid ? "" : "The second translation must lie to the left of the first.");
    if (isValid) session.setLayout(withLattice(session.state.get().layout, lattice));
    else fields[3].reportValidity();
  }

  session.state.watch(({ layout: { lattice } }) => {
    kind.value = lattice ? "cell" : "sheet";
    table.hidden = !lattice;
    lattice?.flat().forEach((value, k) => showText(fields[k], String(value)));
  });
  return h("div", { class: "controls" }, kind.element, table);
}

function drawingTools(draft: Draft, session: WeaveSession): HTMLElement {
  const begin = button("Draw a strand", () => draft.begin(), { icon: "plus", kind: "primary" });
  const end = (words: string, ends: Ends, title: string) => button(words, () => draft.finish(ends), { title });
  const repeats = [end("Goes on →", "along_a", "The strand goes on along the first translation for ever"),
    end("Goes on ↑", "along_b", "The strand goes on along the second translation for ever")];
  const open = end("End", "open", "The strand ends at its last point (Enter)");
  const close = end("Close", "closed", "The strand is a loop");
  const id = uniqueId("point");
  const entry = h("input", { type: "text", class: "number", id, placeholder: "2.5, 4", autocomplete: "off" });
  const form = h("form", {
    class: "point-form",
    onsubmit: (event: Event) => {
      event.preventDefault();
      const point = readPoint(entry.value);
      entry.setCustomValidity(point ? "" : "Write x and y in mm, as 2.5, 4.");
      if (!point) return void entry.reportValidity();
      draft.add(point);
      entry.value = "";
    },
  }, h("label", { for: id }, "Add a point by its coordinates (mm)"), entry, h("button", { class: "button" }, "Add"));
  entry.addEventListener("input", () => entry.setCustomValidity(""));
  const count = h("p", { class: "muted", role: "status" });
  const tools = h("div", { class: "controls drawing-tools" },
    h("p", { class: "muted" },
      touchWords("Click points into the picture; they snap to half millimetres, with Alt they do not.", "Tap points into the picture; they snap to half millimetres.")), form,
    count, h("div", { class: "row" }, open, close, ...repeats),
    h("div", { class: "row" }, button("Take back", () => draft.removeLast(), { title: "Remove the last point (Backspace)" }),
      button("Cancel", () => draft.cancel(), { kind: "quiet" })));

  function show(): void {
    const points = draft.points.get();
    const [begins, ends] = [points !== null && begin.matches(":focus-visible"), points === null && tools.contains(document.activeElement)];
    tools.hidden = points === null;
    begin.hidden = points !== null;
    // The keyboard goes on from what takes the place of the pressed button.
    if (begins) entry.focus();
    if (ends) begin.focus({ preventScroll: true });
    const size = points?.length ?? 0;
    count.textContent = `${size} point${size === 1 ? "" : "s"}`;
    open.disabled = size < 2;
    close.disabled = size < 3;
    for (const repeat of repeats) {
      repeat.hidden = session.state.get().layout.lattice === null;
      repeat.disabled = size < 1;
    }
  }

  draft.points.watch(show);
  session.state.watch(show);
  return h("div", { class: "controls" }, begin, tools);
}

function strandList(session: WeaveSession): HTMLElement {
  const list = h("ol", { class: "points" });
  const clear = button("Remove all", () => session.setLayout({ ...session.state.get().layout, strands: [] }), { kind: "quiet" });
  session.state.watch(({ layout }) => {
    clear.hidden = layout.strands.length === 0;
    replace(list,
      ...layout.strands.map((strand, k) =>
        h("li", {}, h("span", {}, `${k + 1}: ${strandWords(strand)}`), button("", () =>
          session.setLayout(withDuplicate(session.state.get().layout, k, COPY_STEP)), { icon: "copy", kind: "quiet", title: `Duplicate strand ${k + 1}` }), button("", () =>
            session.setLayout(withoutStrand(session.state.get().layout, k)), { icon: "close", kind: "quiet", title: `Remove strand ${k + 1}` }))
      ));
  });
  return h("div", {}, list, clear);
}

/** Where the copy of a strand is placed, in mm from the strand. */
const COPY_STEP: Point = [1, 1];
const MAX_COPIES_ALONG = 12;

/** Tools for all strands: scale them, and repeat them in columns and rows. */
function wholeTools(session: WeaveSession): HTMLElement {
  const field = (label: string, value: number, attributes: Record<string, number | string>) => {
    const id = uniqueId("whole");
    const input = h("input", { type: "number", class: "number", id, value, ...attributes });
    return { input, element: h("div", { class: "field" }, h("label", { for: id }, label), input) };
  };
  const factor = field("Scale by", 1.5, { min: 0.1, max: 10, step: "any" });
  const columns = field("Columns", 2, { min: 1, max: MAX_COPIES_ALONG, step: 1 });
  const rows = field("Rows", 2, { min: 1, max: MAX_COPIES_ALONG, step: 1 });
  const stepX = field("Distance of columns, mm", 10, { step: "any" });
  const stepY = field("Distance of rows, mm", 10, { step: "any" });
  const fault = h("p", { class: "note", role: "alert", hidden: true });
  const tell = (sentence: string): void => {
    fault.textContent = sentence;
    fault.hidden = sentence === "";
  };
  const scale = button("Scale", () => {
    const by = Number(factor.input.value);
    if (!factor.input.checkValidity() || !(by > 0)) return tell("Scale by a factor from 0.1 to 10.");
    tell("");
    session.setLayout(scaledLayout(session.state.get().layout, by));
  }, { title: "Multiplies all lengths; the thickness of strands stays" });
  const repeat = button("Repeat", () => {
    const [across, up] = [columns, rows].map(({ input }) => Number(input.value));
    if (![columns, rows].every(({ input }) => input.value !== "" && input.checkValidity())) return tell(`Take 1 to ${MAX_COPIES_ALONG} columns and rows.`);
    const layout = arrayed(session.state.get().layout, across, up, [Number(stepX.input.value), Number(stepY.input.value)]);
    tell(layout ? "" : `That would be more than ${MAX_ARRAY_STRANDS} strands.`);
    if (layout) session.setLayout(layout);
  }, { title: "Copies all strands in columns and rows" });
  const element = h("details", { class: "more" }, h("summary", {}, "Scale and repeat"), h("div", { class: "row" }, factor.element, scale),
    h("div", { class: "row" }, columns.element, rows.element), h("div", { class: "row" }, stepX.element, stepY.element), repeat, fault);
  session.state.watch(({ layout }) => {
    element.hidden = layout.strands.length === 0;
    // The steps of a cell are its translations.
    for (const { element: step } of [stepX, stepY]) step.hidden = layout.lattice !== null;
  });
  return element;
}

function textBox(session: WeaveSession): HTMLElement {
  const id = uniqueId("text");
  const text = h("textarea", { id, rows: 9, spellcheck: "false", class: "code" });
  const fault = h("p", { class: "note", role: "alert", hidden: true });
  const apply = button("Use this text", () => {
    try {
      const { layout, overrides, radius, youngsModulus } = readLayoutText(text.value);
      const { lengths } = session.state.get();
      session.apply({ layout, overrides, ...(radius !== null && { lengths: { ...lengths, radius } }), ...(youngsModulus !== null && { youngsModulus }) });
      fault.hidden = true;
    } catch (error) {
      if (!(error instanceof LayoutTextError)) throw error;
      fault.hidden = false;
      fault.textContent = inWords(error.message);
    }
  });
  session.state.watch(({ layout }) => {
    if (document.activeElement !== text) text.value = writeLayoutText(layout);
  });
  return h("details", { class: "more" }, h("summary", {}, "As text (JSON)"), h("div", { class: "field" }, h("label", { for: id }, "Strands, as in a request’s weave"), text), fault,
    apply);
}

/** A point from a text such as "x, y" or "x y"; null if the text is invalid. */
export function readPoint(text: string): Point | null {
  const parts = text.trim().split(/[\s,;]+/).map(Number);
  return parts.length === 2 && text.trim() !== "" && parts.every(Number.isFinite) ? [parts[0], parts[1]] : null;
}
