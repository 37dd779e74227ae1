// What is seen before a sheet is printed: the printer, the toolpath layer by layer, what it takes, and the file.
import { button } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { download } from "../base/download";
import { Working } from "../base/working";
import { LayerView } from "./layer_view";
import { printFacts, printerWords, printNotes } from "./print_facts";
import type { PrintSession } from "./print_session";
import { printerForm } from "./printer_form";
import { fieldsAt } from "./printer";

/** Places that a problem lists by name beside its sentence. */
const MOST_FAULTS = 6;

export interface PrintDialog {
  readonly element: HTMLDialogElement;
  open(): void;
}

/** `name`: of the file, without its ending. */
export function printDialog(print: PrintSession, name: () => string): PrintDialog {
  const heading = h("h2", { id: uniqueId("print") }, "Print the sheet");
  const view = new LayerView();
  const printer = h("p", { class: "muted" });
  const facts = h("dl", { class: "facts compact" });
  const notes = h("div", { class: "notes" });
  const status = h("div", { class: "status" });
  const saved = h("p", { class: "muted saved", role: "status" });
  const working = new Working("Progress of the plan", () => element.close());
  const save = button("Save G-code", () => print.save(take), { kind: "primary", icon: "download" });
  const costs = h("section", { class: "dims", "aria-label": "What the print takes" }, facts, notes);
  const plan = h("div", { class: "print-plan" }, status, view.element, costs);
  const element = h("dialog", { class: "print", "aria-labelledby": heading.id },
    h("div", { class: "print-head" }, h("div", {}, heading, printer), button("", () => element.close(), { icon: "close", title: "Close", kind: "quiet" })),
    h("div", { class: "print-body" }, plan, h("section", { class: "print-settings", "aria-label": "Printer" }, printerForm(print))),
    h("div", { class: "print-foot" }, saved, button("Cancel", () => element.close()), save));

  function take(gcode: string): void {
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
    // Of settings that cannot be printed nothing is known, and what was before them is no answer.
    costs.hidden = kind === "failed" && !current;
    if (!current) saved.textContent = "";
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
    if (activity.kind === "idle") replace(status);
    else if (activity.kind === "busy") working.show(status, activity.words, activity.progress);
    else {
      // Those at a field of the dialog stand there too.
      const faults = activity.faults.filter((fault) => fieldsAt(fault.pointer).length === 0).slice(0, MOST_FAULTS);
      replace(status, h("div", { class: "note", role: "alert" }, h("p", {}, activity.sentence),
        faults.length > 1 && h("ul", { class: "violations" }, ...faults.map(({ pointer, words }) => h("li", {}, `${pointer}: ${words}`))),
        activity.faults.length > faults.length && faults.length === MOST_FAULTS && h("p", {}, `${activity.faults.length} places in all`)),
        // What a setting is at fault for is tried again once that is changed.
        activity.faults.length === 0 && button("Try again", () => print.retry()));
    }
    show();
  });
  // Keys of the page, such as those that undo, do not reach below the dialog.
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
