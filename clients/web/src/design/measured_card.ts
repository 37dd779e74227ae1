// Measured data as the target: a file, the clipboard or a drop, and how they are to be read.
import { button, Select, Slider } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { digits, percent } from "../base/format";
import { textOf } from "../base/text_file";
import type { MeasuredCurve } from "../contract/types";
import { type Measured, type MeasuredData, reductionSentence } from "./measured";
import { isPolar } from "./state";

const FILE_TYPES = ".csv,.tsv,.txt,.dat,text/csv,text/plain,text/tab-separated-values";
const STRAIN_UNITS = ["1", "%", "permille", "microstrain", "stretch", "um", "mm", "cm", "m", "in"];
const STRESS_UNITS = ["Pa", "kPa", "MPa", "GPa", "N/mm^2", "psi", "ksi", "bar", "mN", "N", "kN", "lbf", "kgf", "gf"];
const LENGTHS = ["um", "mm", "cm", "m", "in"];
const FORCES = ["mN", "N", "kN", "lbf", "kgf", "gf"];

export function measuredCard(measured: Measured): HTMLElement {
  const file = h("input", { type: "file", accept: FILE_TYPES, class: "visually-hidden", id: uniqueId("file"), onchange: () => {
    const chosen = file.files?.[0];
    if (chosen) void chosen.arrayBuffer().then((bytes) => measured.read(textOf(bytes), chosen.name));
    file.value = "";
  } });
  const note = h("p", { class: "muted" }, "CSV or text with two columns or more; or drop a file onto the page.");
  const settings = h("div", { class: "measured-settings" });
  const paste = button("Paste", () => void pasteFrom(measured, note), { title: "Take the table that is in the clipboard" });
  const remove = button("Remove", () => measured.remove(), { title: "Forget the measured data; the target stays" });
  measured.data.watch((data) => {
    remove.hidden = !data;
    if (!data) {
      replace(settings);
      note.textContent = "CSV or text with two columns or more; or drop a file onto the page.";
      return;
    }
    note.textContent = data.problem ? `${data.name}: ${data.problem}` : `${data.name}: ${data.curve ? reductionSentence(data.curve, digits, percent) : ""}`;
    note.classList.toggle("problem", data.problem !== "");
    replace(settings, ...fields(measured, data));
  });
  return h("details", { class: "card controls measured", "aria-label": "Measured data" },
    h("summary", {}, "Measured data"),
    h("div", { class: "row" }, h("label", { class: "button primary", for: file.id }, "Open a file"), file, paste, remove),
    note, settings);
}

async function pasteFrom(measured: Measured, note: HTMLElement): Promise<void> {
  try {
    measured.read(await navigator.clipboard.readText(), "Clipboard");
  } catch {
    note.textContent = "The browser does not let this page read the clipboard; open a file or drop it onto the page.";
  }
}

function fields(measured: Measured, data: MeasuredData): (HTMLElement | false)[] {
  const { curve, settings } = data;
  const polar = isPolar(data.kind.task);
  const x = settings.units.x ?? curve?.units.x ?? "";
  const y = settings.units.y ?? curve?.units.y ?? "";
  const unit = (label: string, units: readonly string[], value: string, chosen: (value: string) => void) => {
    const list = new Select<string>(label, units.map((words) => ({ value: words, words })), chosen);
    list.value = value;
    return list.element;
  };
  const points = new Slider({
    label: "Control points at most", lower: 3, upper: 32, step: 1, digits: 0,
    changed: (value, done) => done && measured.change({ controlPoints: Math.round(value) }),
  });
  points.value = settings.controlPoints;
  const needs = (place: string) => data.places.includes(place);
  return [
    curve?.table !== undefined && column("x from", curve, curve.columns?.x ?? 0, (index) => measured.change({ columns: { ...settings.columns, x: index } })),
    curve?.table !== undefined && column("y from", curve, curve.columns?.y ?? 1, (index) => measured.change({ columns: { ...settings.columns, y: index } })),
    !polar && unit("Unit of strain", STRAIN_UNITS, x, (value) => measured.change({ units: { ...settings.units, x: value } })),
    polar && unit("Unit of direction", ["rad", "deg"], x, (value) => measured.change({ units: { ...settings.units, x: value } })),
    data.kind.task !== "poisson" && unit(polar ? "Unit of stiffness" : "Unit of stress", polar ? STRESS_UNITS.slice(0, 8) : STRESS_UNITS, y, (value) => measured.change({ units: { ...settings.units, y: value } })),
    (LENGTHS.includes(x) || needs("/specimen/gauge_length")) && length("Gauge length, mm", settings.specimen.gauge_length, (value) => measured.change({ specimen: { ...settings.specimen, gauge_length: value } })),
    (FORCES.includes(y) || needs("/specimen/area")) && length("Cross-section, mm²", settings.specimen.area, (value) => measured.change({ specimen: { ...settings.specimen, area: value } })),
    points.element,
  ];
}

function column(label: string, curve: MeasuredCurve, index: number, chosen: (index: number) => void): HTMLElement {
  const columns = curve.table?.columns ?? [];
  const words = (k: number) => (columns[k].name ? `${columns[k].name}${columns[k].unit ? `, ${columns[k].unit}` : ""}` : `Column ${k + 1}`);
  const list = new Select<string>(label, columns.map((_, k) => ({ value: String(k), words: words(k) })), (value) => chosen(Number(value)));
  list.value = String(index);
  return list.element;
}

function length(label: string, value: number | undefined, changed: (value: number) => void): HTMLElement {
  const id = uniqueId("length");
  const input = h("input", { type: "number", id, min: 0, step: "any", class: "number", value: value ?? null, onchange: () => {
    const number = Number(input.value);
    if (input.value !== "" && Number.isFinite(number) && number > 0) changed(number);
  } });
  return h("div", { class: "field" }, h("label", { for: id }, label), input);
}
