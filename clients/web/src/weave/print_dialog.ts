// The print dialog: printer settings, toolpath layer by layer, time and material, and the G-code file.
import { button } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { download } from "../base/download";
import { ProgressRow } from "../base/progress_row";
import { FaultView } from "./fault_view";
import { LayerView } from "./layer_view";
import { printFacts, printerWords, printNotes } from "./print_facts";
import { type Fault, faultsOf, type PrintSession } from "./print_session";
import { printerForm } from "./printer_form";
import { fieldsAt } from "./printer";

/** Limit of the faults that are listed below the sentence of a problem. */
const MAX_FAULTS = 6;

export interface PrintDialog {
  readonly element: HTMLDialogElement;
  open(): void;
}

/** `name` returns the name of the file without its suffix. */
export function printDialog(print: PrintSession, name: () => string): PrintDialog {
  const heading = h("h2", { id: uniqueId("print") }, "Print the sheet");
  const view = new LayerView();
  const faultView = new FaultView();
  const printer = h("p", { class: "muted" });
  const facts = h("dl", { class: "facts compact" });
  const notes = h("div", { class: "notes" });
  const status = h("div", { class: "status" });
  const saved = h("p", { class: "muted saved", role: "status" });
  const progressRow = new ProgressRow("Progress of the plan", () => element.close());
  const save = button("Save G-code", () => print.save(saveFile), { kind: "primary", icon: "download" });
  const costs = h("section", { class: "dims", "aria-label": "What the print takes" }, facts, notes);
  const plan = h("div", { class: "print-plan" }, status, faultView.element, view.element, costs);
  const element = h("dialog", { class: "print", "aria-labelledby": heading.id },
    h("div", { class: "print-head" }, h("div", {}, heading, printer), button("", () => element.close(), { icon: "close", title: "Close", kind: "quiet" })),
    h("div", { class: "print-body" }, plan, h("section", { class: "print-settings", "aria-label": "Printer" }, printerForm(print))),
    h("div", { class: "print-foot" }, saved, button("Cancel", () => element.close()), save));

  function saveFile(gcode: string): void {
    const file = `${name()}-sheet.gcode`;
    download(file, "text/x-gcode", gcode);
    saved.textContent = `Saved as ${file}.`;
  }

  function show(): void {
    const { kind } = print.activity.get();
    const current = print.isCurrent;
    element.classList.toggle("outdated", !current);
    plan.setAttribute("aria-busy", String(kind === "busy"));
    save.disabled = !current || kind === "busy";
    // The costs of the last valid settings are hidden while the present ones cannot be printed.
    costs.hidden = kind === "failed" && !current;
    if (!current) saved.textContent = "";
  }

  /** The sentence of a failure, and the faults of no field of the form: those of a setting are shown at its field. */
  function failure(sentence: string, faults: readonly Fault[]): (HTMLElement | false)[] {
    const told = faults.filter((fault) => fieldsAt(fault.pointer).length === 0).slice(0, MAX_FAULTS);
    const list = h("ul", { class: "violations" }, ...told.map((fault) => h("li", {}, fault.sentence)));
    const repairs = print.repairs.map((repair) => button(repair.words, () => print.repair(repair), { title: repair.title }));
    const isCut = faults.length > told.length && told.length === MAX_FAULTS;
    return [
      h("div", { class: "note", role: "alert" }, h("p", {}, sentence), told.length > 1 && list, isCut && h("p", {}, `${faults.length} places in all`)),
      repairs.length > 0 && h("div", { class: "row", role: "group", "aria-label": "Repairs" }, ...repairs),
      // After a fault of a setting, the next change of settings tries again.
      faults.length === 0 && button("Try again", () => print.retry()),
    ];
  }

  print.plan.watch((now) => {
    view.show(now);
    view.element.hidden = facts.hidden = now === null;
    replace(facts, ...(now ? printFacts(now) : []).flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
    replace(notes, ...(now ? printNotes(now) : []));
    show();
  });
  print.settings.watch((settings) => {
    printer.textContent = printerWords(settings);
    show();
  });
  print.activity.watch((activity) => {
    if (activity.kind === "busy") progressRow.show(status, activity.words, activity.progress);
    else replace(status, ...(activity.kind === "failed" ? failure(activity.sentence, faultsOf(activity)) : []));
    faultView.show(print.sheetLayout, print.marked);
    show();
  });
  // Key events stay in the dialog, so that shortcuts such as undo do not change the page below it.
  element.addEventListener("keydown", (event) => event.stopPropagation());
  element.addEventListener("close", () => print.end());

  return {
    element,
    open() {
      if (element.open) return;
      saved.textContent = "";
      element.showModal();
      print.begin();
    },
  };
}
