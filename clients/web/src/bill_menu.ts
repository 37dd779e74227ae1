// The bill of a page's last computations. The header always shows the time of the newest; the menu below it lists stages,
// optional parts, accuracy, and the time that other accuracies cost.
import { accuracyTable, costTables, effectTable } from "./base/bill_tables";
import type { Bill, Bills } from "./base/bills";
import { announce } from "./base/announce";
import { button } from "./base/controls";
import { curlText } from "./base/curl";
import { h, replace } from "./base/dom";
import { seconds } from "./base/format";
import { menu } from "./base/menu";
import { table } from "./base/tables";
import { endpointWords } from "./jobs/job_words";

export class BillMenu {
  readonly element: HTMLDetailsElement;
  private readonly body = h("div", { class: "bills" });
  private unwatch = () => {};
  private bills: readonly Bill[] = [];

  constructor() {
    this.element = menu("Bill", "clock", this.body);
    this.element.classList.add("bill-menu");
    this.element.addEventListener("toggle", () => this.draw());
    this.updateSummary();
  }

  /** Shows the bills of another page and follows them. */
  show(bills: Bills): void {
    this.unwatch();
    this.unwatch = bills.list.watch((list) => {
      this.bills = list;
      this.updateSummary();
      this.draw();
    });
  }

  private updateSummary(): void {
    const label = this.element.querySelector("summary span");
    const [newest] = this.bills;
    if (label) label.textContent = newest ? seconds(newest.cost.seconds) : "Bill";
    this.element.querySelector("summary")?.setAttribute("aria-label", newest ? `Bill: ${nameOf(newest)} took ${seconds(newest.cost.seconds)}` : "Bill: nothing computed yet");
  }

  private draw(): void {
    if (!this.element.open) return;
    if (this.bills.length === 0) return replace(this.body, h("p", { class: "muted" }, "Nothing was computed on this page yet."));
    const openPaths = new Set([...this.body.querySelectorAll<HTMLDetailsElement>("details[open]")].map((one) => one.dataset.path));
    replace(this.body, h("h2", {}, "Bill of this page"), h("p", { class: "muted" }, "What the last answers took on the server: stages, optional parts, accuracy."),
      ...this.bills.map((bill, k) => section(bill, openPaths.size > 0 ? openPaths.has(bill.path) : k === 0)));
  }
}

function nameOf({ path }: Bill): string {
  return endpointWords(path);
}

function section(bill: Bill, open: boolean): HTMLElement {
  const costPanel = h("div", { class: "accuracy-cost" });
  void showAccuracyCost(costPanel, bill);
  const details = h("details", { class: "bill", "data-path": bill.path },
    h("summary", {}, h("strong", {}, nameOf(bill)), h("span", { class: "muted" }, seconds(bill.cost.seconds))), ...costTables(bill.cost),
    bill.effects.length > 0 ? effectTable(bill.effects) : h("p", { class: "muted" }, "This answer has no optional parts."), accuracyTable(bill.accuracy), costPanel,
    bill.request !== null && copyButton(bill));
  details.open = open;
  return details;
}

/** Loads the tables of the benchmarks at the first use. */
async function showAccuracyCost(place: HTMLElement, { path, family }: Bill): Promise<void> {
  const { accuracyCost } = await import("./base/accuracy_cost");
  const found = accuracyCost(path, family);
  if (found) replace(place, table(`Accuracy against time. ${found.caption}; measured on the machine of the benchmarks`, found.head, found.rows));
}

function copyButton({ path, request }: Bill): HTMLElement {
  const words = "Copy the request as curl";
  const element = button(words, () => void copy(), { icon: "code", kind: "quiet" });
  async function copy(): Promise<void> {
    const text = curlText(location.origin, path, request);
    const outcome = await navigator.clipboard.writeText(text).then(() => "Copied", () => "This page may not write to the clipboard");
    element.querySelector("span")?.replaceChildren(outcome);
    announce(outcome);
  }
  return element;
}
