// The card for measured data: opens a file or pastes the clipboard, and has the settings with which the table is read.
import { button, Segments, Select, Slider } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { digits, percent } from "../base/format";
import { rebuild } from "../base/writing";
import type { MeasuredCurve } from "../contract/types";
import { askedPointers, asksForSense, type Measured, type MeasuredData, type MeasuredSettings, notesOf, reductionSentence, tableOf } from "./measured";
import { isPolar } from "./state";

const FILE_TYPES = ".csv,.tsv,.txt,.dat,text/csv,text/plain,text/tab-separated-values";
const STRAIN_UNITS = ["1", "%", "permille", "microstrain", "stretch", "um", "mm", "cm", "m", "in"];
const STRESS_UNITS = ["Pa", "kPa", "MPa", "GPa", "N/mm^2", "psi", "ksi", "bar", "mN", "N", "kN", "lbf", "kgf", "gf"];
const QUESTIONS = ["/units/x", "/units/y", "/specimen/gauge_length", "/specimen/area", "/columns/x", "/columns/y", "/decimal_separator", "/sense", "/zero", "/block"];
const LENGTHS = ["um", "mm", "cm", "m", "in"];
const FORCES = ["mN", "N", "kN", "lbf", "kgf", "gf"];

const DECIMALS = [{ value: "point", words: "Points: 1.234" }, { value: "comma", words: "Commas: 1,234" }];
const ZEROS = [{ value: "first", words: "The first one" }, { value: "as_written", words: "Zero" }];
const SENSES = [{ value: "tension", words: "Tension" }, { value: "compression", words: "Compression" }] as const;

export function measuredCard(measured: Measured): HTMLElement {
  const file = h("input", {
    type: "file",
    accept: FILE_TYPES,
    class: "visually-hidden",
    id: uniqueId("file"),
    onchange: () => {
      const chosen = file.files?.[0];
      if (chosen) void chosen.arrayBuffer().then((bytes) => measured.read(tableOf(bytes), chosen.name));
      file.value = "";
    },
  });
  const note = h("p", { class: "muted" }, "CSV or text with two columns or more; or drop a file onto the page.");
  const warnings = h("div", { class: "warnings", role: "status" });
  const settings = h("div", { class: "measured-settings" });
  const paste = button("Paste", () => void pasteFrom(measured, note), { title: "Take the table that is in the clipboard" });
  const remove = button("Remove", () => measured.remove(), { title: "Forget the measured data; the target stays" });
  const card = h("details", { class: "card controls measured", "aria-label": "Measured data" }, h("summary", {}, "Measured data"),
    h("div", { class: "row" }, h("label", { class: "button primary", for: file.id }, "Open a file"), file, paste, remove), note, warnings, settings);
  measured.data.watch((data) => {
    remove.hidden = !data;
    replace(warnings, ...(data && !data.problem ? notesOf(data, "warning") : []).map((text) => h("p", {}, text)));
    if (!data) {
      rebuild(settings, () => []);
      note.textContent = "CSV or text with two columns or more; or drop a file onto the page.";
      return;
    }
    note.textContent = data.problem ? `${data.name}: ${data.problem}` : `${data.name}: ${data.curve ? reductionSentence(data.curve, notesOf(data, "note"), digits, percent) : ""}`;
    note.classList.toggle("problem", data.problem !== "");
    rebuild(settings, () => fields(measured, measured.data.get() ?? data));
    // The card opens if the user has to complete what the file does not say.
    const isAsked = data.problem ? QUESTIONS.some((place) => data.pointers.includes(place)) : data.curve?.sense?.told_by === "nothing";
    if (isAsked) card.setAttribute("open", "");
  });
  return card;
}

async function pasteFrom(measured: Measured, note: HTMLElement): Promise<void> {
  try {
    void measured.read({ text: await navigator.clipboard.readText() }, "Clipboard");
  } catch {
    note.textContent = "The browser does not let this page read the clipboard; open a file or drop it onto the page.";
  }
}

function fields(measured: Measured, data: MeasuredData): (HTMLElement | false)[] {
  const { curve, settings } = data;
  const polar = isPolar(data.kind.task);
  const x = settings.units.x ?? curve?.units.x ?? "";
  const y = settings.units.y ?? curve?.units.y ?? "";
  const choice = (label: string, choices: readonly { value: string; words: string }[], value: string, chosen: (value: string) => void) => {
    // An unset value is shown as a request to choose.
    const unset = value === "" ? [{ value: "", words: "Choose …" }] : [];
    const list = new Select<string>(label, [...unset, ...choices], (picked) => picked !== "" && chosen(picked));
    list.value = value;
    return list.element;
  };
  const unit = (label: string, units: readonly string[], value: string, chosen: (value: string) => void) =>
    choice(label, units.map((words) => ({ value: words, words })), value, chosen);
  const points = new Slider({
    label: "Control points at most",
    lower: 3,
    upper: 32,
    step: 1,
    digits: 0,
    changed: (value, done) => done && measured.change({ controlPoints: Math.round(value) }),
  });
  points.value = settings.controlPoints;
  const asked = askedPointers(data);
  const needs = (place: string) => asked.has(place);
  const columns = (change: MeasuredSettings["columns"]) => measured.change({ columns: change });
  const units = (change: MeasuredSettings["units"]) => measured.change({ units: change });
  const specimen = (change: MeasuredSettings["specimen"]) => measured.change({ specimen: change });
  const blocks = curve?.table?.blocks ?? 1;
  return [
    curve?.table !== undefined && column("x from", curve, curve.columns?.x ?? 0, (x) => columns({ x })),
    curve?.table !== undefined && column("y from", curve, curve.columns?.y ?? 1, (y) => columns({ y })),
    !curve && needs("/columns/x") && title("x from the column (number from 0, or title)", settings.columns.x, (x) => columns({ x })),
    !curve && needs("/columns/y") && title("y from the column (number from 0, or title)", settings.columns.y, (y) => columns({ y })),
    blocks > 1 &&
    choice("Block of rows", Array.from({ length: blocks }, (_, k) => ({ value: String(k), words: `${k + 1} of ${blocks}` })), String(curve?.table?.block ?? 0),
      (value) => measured.change({ block: Number(value) })),
    (needs("/decimal_separator") || settings.decimalSeparator !== undefined) &&
    choice("Decimals", DECIMALS, settings.decimalSeparator ?? "", (value) => measured.change({ decimalSeparator: value as MeasuredSettings["decimalSeparator"] })),
    !polar && unit("Unit of strain", STRAIN_UNITS, x, (value) => units({ x: value })),
    polar && unit("Unit of direction", ["rad", "deg"], x, (value) => units({ x: value })),
    data.kind.task !== "poisson" && unit(polar ? "Unit of stiffness" : "Unit of stress", polar ? STRESS_UNITS.slice(0, 8) : STRESS_UNITS, y, (value) => units({ y: value })),
    (LENGTHS.includes(x) || needs("/specimen/gauge_length") || settings.specimen.gauge_length !== undefined) &&
    length("Gauge length, mm", settings.specimen.gauge_length, (value) => specimen({ gauge_length: value })),
    (FORCES.includes(y) || needs("/specimen/area") || settings.specimen.area !== undefined) &&
    length("Cross-section, mm²", settings.specimen.area, (value) => specimen({ area: value })),
    !polar && (curve?.sense !== undefined || needs("/sense") || settings.sense !== undefined) && senseSwitch(measured, data),
    (needs("/zero") || settings.zero !== undefined) &&
    choice("Displacements count from", ZEROS, settings.zero ?? "", (value) => measured.change({ zero: value as MeasuredSettings["zero"] })),
    points.element,
  ];
}

/** Tension or compression, for every curve of stress. Neither is chosen, and a question stands there, if the file does not say which it was. */
function senseSwitch(measured: Measured, data: MeasuredData): HTMLElement {
  const { curve, settings } = data;
  const sense = new Segments<NonNullable<MeasuredSettings["sense"]>>("What was measured", SENSES, (value) => measured.change({ sense: value }));
  const told = curve?.sense?.told_by === "nothing" ? undefined : curve?.sense?.used;
  const used = settings.sense ?? (told === "both" ? undefined : told);
  if (used) sense.value = used;
  const isOpen = asksForSense(data);
  return h("div", { class: "measured-sense" }, isOpen && h("p", { class: "note" }, "The file does not say it: was the specimen pulled or pressed?"), sense.element);
}

function column(label: string, curve: MeasuredCurve, index: number, chosen: (index: number) => void): HTMLElement {
  const columns = curve.table?.columns ?? [];
  const words = (k: number) => (columns[k].name ? `${columns[k].name}${columns[k].unit ? `, ${columns[k].unit}` : ""}` : `Column ${k + 1}`);
  const list = new Select<string>(label, columns.map((_, k) => ({ value: String(k), words: words(k) })), (value) => chosen(Number(value)));
  list.value = String(index);
  return list.element;
}

/** A text field for the index or the title of a column, for a table whose columns the server has not listed. */
function title(label: string, value: number | string | undefined, changed: (value: number | string) => void): HTMLElement {
  const id = uniqueId("title");
  const input = h("input", {
    type: "text",
    id,
    value: value === undefined ? null : String(value),
    onchange: () => {
      if (input.value !== "") changed(/^\d+$/.test(input.value) ? Number(input.value) : input.value);
    },
  });
  return h("div", { class: "field" }, h("label", { for: id }, label), input);
}

function length(label: string, value: number | undefined, changed: (value: number) => void): HTMLElement {
  const id = uniqueId("length");
  const input = h("input", {
    type: "number",
    id,
    min: 0,
    step: "any",
    class: "number",
    value: value ?? null,
    onchange: () => {
      const number = Number(input.value);
      if (input.value !== "" && Number.isFinite(number) && number > 0) changed(number);
    },
  });
  return h("div", { class: "field" }, h("label", { for: id }, label), input);
}
