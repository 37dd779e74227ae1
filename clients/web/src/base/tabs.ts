// Tabs that are added, named and taken away: one of them is in sight.
import { announce } from "./announce";
import { button } from "./controls";
import { h, replace, uniqueId } from "./dom";

export interface Tab {
  readonly words: string;
  /** What it would be called without a name of its own. */
  readonly plainWords: string;
  /** Beside the words. */
  readonly detail: string;
}

export interface TabWishes {
  select(at: number): void;
  add(): void;
  rename(name: string): void;
  remove(at: number): void;
}

export interface TabOptions {
  /** What all of them are. */
  readonly label: string;
  /** What one of them is, as in "Rename this target". */
  readonly noun: string;
  readonly addTitle: string;
  readonly longestName: number;
  /** What shows the one in sight. */
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
  private drawn: HTMLButtonElement[] = [];
  private tabs: readonly Tab[] = [];
  private at = 0;

  constructor(private readonly options: TabOptions, private readonly wishes: TabWishes) {
    const { label, noun, addTitle, longestName } = options;
    const capital = noun[0].toUpperCase() + noun.slice(1);
    this.list = h("div", { class: "tabs", role: "tablist", "aria-label": label });
    this.addButton = button(capital, () => wishes.add(), { icon: "plus", title: addTitle, kind: "quiet" });
    this.renameButton = button("", () => this.startNaming(), { icon: "pencil", title: `Rename this ${noun}`, kind: "quiet" });
    this.removeButton = button("", () => this.removeSelected(), { icon: "close", title: `Remove this ${noun}`, kind: "quiet" });
    this.name = h("input", { type: "text", class: "number text", maxlength: longestName, "aria-label": `Name of this ${noun}`, spellcheck: "false" });
    this.naming = h("form", { class: "naming", hidden: true, onsubmit: (event: Event) => {
      event.preventDefault();
      this.stopNaming(true);
    } }, this.name);
    this.element = h("div", { class: "tab-row" }, this.list, this.naming, this.renameButton, this.removeButton, this.addButton);
    this.list.addEventListener("keydown", (event) => this.key(event));
    this.name.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.preventDefault();
      this.stopNaming(false);
    });
    this.name.addEventListener("blur", () => this.stopNaming(true));
  }

  /** `more`: whether there may be more of them. */
  show(tabs: readonly Tab[], at: number, more: boolean): void {
    [this.tabs, this.at] = [tabs, at];
    if (this.drawn.length !== tabs.length) {
      const focused = this.list.contains(document.activeElement);
      this.drawn = tabs.map((_, k) => this.tab(k));
      replace(this.list, ...this.drawn);
      if (focused) this.drawn[at]?.focus();
    }
    this.drawn.forEach((element, k) => {
      element.children[0].textContent = tabs[k].words;
      element.children[1].textContent = tabs[k].detail;
      element.setAttribute("aria-selected", String(k === at));
      element.tabIndex = k === at ? 0 : -1;
    });
    this.options.panel.setAttribute("aria-labelledby", this.drawn[at]?.id ?? "");
    this.scrollToSelected();
    this.removeButton.hidden = tabs.length < 2;
    this.renameButton.hidden = tabs.length < 2 || !this.naming.hidden;
    this.addButton.disabled = !more;
  }

  private tab(at: number): HTMLButtonElement {
    return h("button", { type: "button", role: "tab", id: uniqueId("tab"), class: "tab", "aria-controls": this.options.panel.id, onclick: () => this.wishes.select(at), ondblclick: () => this.startNaming() },
      h("span", { class: "tab-name" }), h("span", { class: "tab-detail muted" }));
  }

  /** Of more tabs than there is room for, the one in sight is. */
  private scrollToSelected(): void {
    const { list } = this;
    const element = this.drawn[this.at];
    if (!element) return;
    const [left, right] = [element.offsetLeft, element.offsetLeft + element.offsetWidth];
    if (left < list.scrollLeft) list.scrollLeft = left;
    else if (right > list.scrollLeft + list.clientWidth) list.scrollLeft = right - list.clientWidth;
  }

  focusSelected(): void {
    this.drawn[this.at]?.focus();
  }

  private removeSelected(): void {
    const { words } = this.tabs[this.at];
    this.wishes.remove(this.at);
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

  private stopNaming(take: boolean): void {
    if (this.naming.hidden) return;
    this.naming.hidden = true;
    this.renameButton.hidden = false;
    const { words, plainWords } = this.tabs[this.at];
    const given = this.name.value.trim();
    // What it is called anyway is no name of its own.
    if (take && given !== words) this.wishes.rename(given === plainWords ? "" : given);
    this.focusSelected();
  }

  private key(event: KeyboardEvent): void {
    const last = this.tabs.length - 1;
    const to = { ArrowLeft: this.at === 0 ? last : this.at - 1, ArrowRight: this.at === last ? 0 : this.at + 1, Home: 0, End: last }[event.key];
    if (event.key === "F2") this.startNaming();
    else if (event.key === "Delete" && last > 0) this.removeSelected();
    else if (to !== undefined) {
      this.wishes.select(to);
      this.focusSelected();
    } else return;
    event.preventDefault();
  }
}
