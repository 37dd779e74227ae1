// Tabs that can be added, renamed and removed. The panel of one of them is visible.
import { announce } from "./announce";
import { button } from "./controls";
import { h, replace, uniqueId, writeAttribute, writeText } from "./dom";

export interface Tab {
  readonly words: string;
  /** Its label if the user gives it no name. */
  readonly defaultWords: string;
  /** Text beside the label. */
  readonly detail: string;
}

export interface TabActions {
  select(at: number): void;
  add(): void;
  rename(name: string): void;
  remove(at: number): void;
}

export interface TabOptions {
  /** Accessible name of the list of tabs. */
  readonly label: string;
  /** Noun for one tab, as in "Rename this target". */
  readonly noun: string;
  readonly addTitle: string;
  readonly maxNameLength: number;
  /** The panel that shows the selected tab. */
  readonly panel: HTMLElement;
}

export class Tabs {
  readonly element: HTMLElement;
  private readonly list: HTMLElement;
  private readonly addButton: HTMLButtonElement;
  private readonly renameButton: HTMLButtonElement;
  private readonly removeButton: HTMLButtonElement;
  private readonly name: HTMLInputElement;
  private readonly naming: HTMLFormElement;
  private buttons: HTMLButtonElement[] = [];
  private tabs: readonly Tab[] = [];
  private at = 0;

  constructor(private readonly options: TabOptions, private readonly actions: TabActions) {
    const { label, noun, addTitle, maxNameLength } = options;
    const capital = noun[0].toUpperCase() + noun.slice(1);
    this.list = h("div", { class: "tabs", role: "tablist", "aria-label": label });
    this.addButton = button(capital, () => actions.add(), { icon: "plus", title: addTitle, kind: "quiet" });
    this.renameButton = button("", () => this.startNaming(), { icon: "pencil", title: `Rename this ${noun}`, kind: "quiet" });
    this.removeButton = button("", () => this.removeSelected(), { icon: "close", title: `Remove this ${noun}`, kind: "quiet" });
    this.name = h("input", { type: "text", class: "number text", maxlength: maxNameLength, "aria-label": `Name of this ${noun}`, spellcheck: "false" });
    this.naming = h("form", {
      class: "naming",
      hidden: true,
      onsubmit: (event: Event) => {
        event.preventDefault();
        this.stopNaming(true);
      },
    }, this.name);
    this.element = h("div", { class: "tab-row" }, this.list, this.naming, this.renameButton, this.removeButton, this.addButton);
    this.list.addEventListener("keydown", (event) => this.key(event));
    this.name.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.preventDefault();
      this.stopNaming(false);
    });
    this.name.addEventListener("blur", () => this.stopNaming(true));
  }

  /** `canAdd`: whether the number of tabs is below its limit. */
  show(tabs: readonly Tab[], at: number, canAdd: boolean): void {
    const isSame = at === this.at && tabs.length === this.buttons.length && tabs.every(({ words, detail }, k) => words === this.tabs[k].words && detail === this.tabs[k].detail);
    [this.tabs, this.at] = [tabs, at];
    if (this.buttons.length !== tabs.length) {
      const focused = this.list.contains(document.activeElement);
      this.buttons = tabs.map((_, k) => this.tab(k));
      replace(this.list, ...this.buttons);
      if (focused) this.buttons[at]?.focus();
    }
    this.buttons.forEach((element, k) => {
      writeText(element.children[0], tabs[k].words);
      writeText(element.children[1], tabs[k].detail);
      writeAttribute(element, "aria-selected", String(k === at));
      writeAttribute(element, "tabindex", k === at ? "0" : "-1");
    });
    writeAttribute(this.options.panel, "aria-labelledby", this.buttons[at]?.id ?? "");
    // Reading where the tabs are makes the browser arrange the page at once, also what has changed elsewhere.
    if (!isSame) this.scrollToSelected();
    this.removeButton.hidden = tabs.length < 2;
    this.renameButton.hidden = tabs.length < 2 || !this.naming.hidden;
    this.addButton.disabled = !canAdd;
  }

  private tab(at: number): HTMLButtonElement {
    return h("button", {
      type: "button",
      role: "tab",
      id: uniqueId("tab"),
      class: "tab",
      "aria-controls": this.options.panel.id,
      onclick: () => this.actions.select(at),
      ondblclick: () => this.startNaming(),
    }, h("span", { class: "tab-name" }), h("span", { class: "tab-detail muted" }));
  }

  /** Scrolls the list until the selected tab is visible. */
  private scrollToSelected(): void {
    const { list } = this;
    const element = this.buttons[this.at];
    if (!element) return;
    const [left, right] = [element.offsetLeft, element.offsetLeft + element.offsetWidth];
    if (left < list.scrollLeft) list.scrollLeft = left;
    else if (right > list.scrollLeft + list.clientWidth) list.scrollLeft = right - list.clientWidth;
  }

  focusSelected(): void {
    this.buttons[this.at]?.focus();
  }

  private removeSelected(): void {
    const { words } = this.tabs[this.at];
    this.actions.remove(this.at);
    this.focusSelected();
    announce(`${words} is removed.`, "change");
  }

  private startNaming(): void {
    if (this.tabs.length < 2) return;
    this.name.value = this.tabs[this.at].words;
    this.naming.hidden = false;
    this.renameButton.hidden = true;
    this.name.select();
    this.name.focus();
  }

  private stopNaming(accept: boolean): void {
    if (this.naming.hidden) return;
    this.naming.hidden = true;
    this.renameButton.hidden = false;
    const { words, defaultWords } = this.tabs[this.at];
    const given = this.name.value.trim();
    // The default label is stored as an empty name.
    if (accept && given !== words) this.actions.rename(given === defaultWords ? "" : given);
    this.focusSelected();
  }

  private key(event: KeyboardEvent): void {
    const last = this.tabs.length - 1;
    const to = { ArrowLeft: this.at === 0 ? last : this.at - 1, ArrowRight: this.at === last ? 0 : this.at + 1, Home: 0, End: last }[event.key];
    if (event.key === "F2") this.startNaming();
    else if (event.key === "Delete" && last > 0) this.removeSelected();
    else if (to !== undefined) {
      this.actions.select(to);
      this.focusSelected();
    } else return;
    event.preventDefault();
  }
}
