// The form with the printer's settings, where faults that the server reports are shown at their fields.
import { button, Checkbox, Select } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { download } from "../base/download";
import { showText } from "../base/writing";
import { faultsOf, type PrintSession } from "./print_session";
import { ASSUMED_WORDS, type Field, type FieldGroup, fieldsAt, KNOWN_PRINTERS, PRINT_FIELDS, printerOf, profileText, type Value } from "./printer";

interface Row {
  readonly element: HTMLElement;
  /** Shows a value. */
  readonly show: (value: Value) => void;
  readonly tell: (words: readonly string[]) => void;
}

export function printerForm(print: PrintSession): HTMLElement {
  const rows = new Map<string, Row>();

  function group({ title, fields, isAdvanced }: FieldGroup): HTMLElement {
    const body = h("div", { class: "print-fields" }, ...fields.map((field) => {
      const row = rowOf(print, field);
      rows.set(field.pointer, row);
      return row.element;
    }));
    return isAdvanced
      ? h("details", { class: "more" }, h("summary", {}, title), body)
      : h("fieldset", { class: "print-group" }, h("legend", {}, title), body);
  }

  const element = h("div", { class: "printer-form" }, printerList(print), profileFiles(print), ...PRINT_FIELDS.map(group));

  print.settings.watch((settings) => {
    for (const [pointer, row] of rows) row.show(settings[pointer]);
    for (const [pointer, row] of rows) if (pointer.startsWith("/frame/")) row.element.hidden = settings["/frame"] !== true;
  });
  print.activity.watch((activity) => {
    const faults = faultsOf(activity);
    // A fault that applies to several fields, such as those of the bed, is shown at the first one.
    const first = faults.map((fault) => ({ words: fault.words, pointer: fieldsAt(fault.pointer)[0]?.pointer }));
    for (const [pointer, row] of rows) row.tell(first.filter((fault) => fault.pointer === pointer).map((fault) => fault.words));
    // Groups with invalid fields are unfolded.
    if (faults.length > 0) element.querySelectorAll<HTMLDetailsElement>("details:has([aria-invalid])").forEach((details) => (details.open = true));
  });
  return element;
}

function rowOf(print: PrintSession, field: Field): Row {
  const change = (value: Value) => print.change(field.pointer, value);
  if (field.kind === "switch") {
    const box = new Checkbox(field.words, change);
    return { element: box.element, show: (value) => (box.value = value === true), tell: () => {} };
  }
  if (field.kind === "choice") {
    const list = new Select<string>(field.words, (field.choices ?? []).map(([value, words]) => ({ value, words })), change);
    return { element: list.element, show: (value) => (list.value = String(value)), tell: () => {} };
  }
  const id = uniqueId("print");
  const fault = h("p", { class: "fault", id: `${id}-fault`, hidden: true });
  const input = field.kind === "lines" ? h("textarea", { id, class: "code", rows: 3, spellcheck: "false" })
    : field.kind === "text" ? h("input", { id, type: "text", class: "number text", spellcheck: "false", autocomplete: "off" })
    : h("input", { id, type: "number", class: "number", step: "any" });
  let current: Value = null;
  const show = (value: Value) => {
    current = value;
    showText(input, value === null ? "" : String(value));
  };
  input.addEventListener("change", () => {
    if (field.kind !== "number") return change(input.value);
    if (input.value === "") change(field.initial);
    else if (Number.isFinite(Number(input.value))) change(Number(input.value));
    show(print.settings.get()[field.pointer] ?? current); // the present value replaces an invalid entry
  });
  const unit = field.unit && h("span", { class: "unit", "aria-hidden": "true" }, field.unit);
  const label = h("label", { for: id }, field.words, field.unit && h("span", { class: "visually-hidden" }, `, ${field.unit}`));
  return {
    element: h("div", { class: `field print-field of-${field.kind}` }, label, h("span", { class: "print-input" }, input, unit), fault),
    show,
    tell(words) {
      fault.hidden = words.length === 0;
      fault.textContent = words.join("; ");
      if (words.length === 0) {
        input.removeAttribute("aria-invalid");
        input.removeAttribute("aria-describedby");
      } else {
        input.setAttribute("aria-invalid", "true");
        input.setAttribute("aria-describedby", fault.id);
      }
    },
  };
}

/** The list of printers by name. The chosen one is remembered with the other settings. */
function printerList(print: PrintSession): HTMLElement {
  const other = { value: "", words: "Another printer: the values below" };
  const list = new Select<string>("Printer by name", [...KNOWN_PRINTERS.map(({ name }) => ({ value: name, words: name })), other], (name) => {
    const printer = KNOWN_PRINTERS.find((one) => one.name === name);
    if (printer) print.choosePrinter(printer);
  });
  print.settings.watch((settings) => (list.value = printerOf(settings)?.name ?? ""));
  return h("div", {}, list.element, h("p", { class: "muted" }, ASSUMED_WORDS));
}

/** Buttons to open and save printer profiles, in the file format of the command line. */
function profileFiles(print: PrintSession): HTMLElement {
  const file = h("input", { type: "file", accept: ".json,application/json", class: "visually-hidden", id: uniqueId("file"), onchange: () => void openFile() });
  async function openFile(): Promise<void> {
    const chosen = file.files?.[0];
    if (chosen) print.openProfile(await chosen.text());
    file.value = "";
  }
  const save = button("Save profile", () => download("printer.json", "application/json", profileText(print.settings.get())), { title: "Save the printer’s settings as a file" });
  const row = h("div", { class: "row profile-files", role: "group", "aria-label": "Printer’s profile" });
  replace(row, file, h("label", { class: "button", for: file.id }, "Open profile"), save,
    button("Reset", () => print.reset(), { title: "All settings as they were to begin with: a Prusa i3 MK3S with PLA" }));
  return row;
}
