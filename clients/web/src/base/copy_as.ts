// What is on a page as a command or a program that asks the server for the same.
import { announce } from "./announce";
import { button } from "./controls";
import { h } from "./dom";
import { menu } from "./menu";

export interface Recipe {
  readonly words: string;
  /** Null where there is nothing to ask for yet. */
  readonly text: () => string | null;
}

/** A menu with a button for each recipe, and the text that was copied last. */
export function copyMenu(recipes: readonly Recipe[]): HTMLDetailsElement {
  const shown = h("textarea", { class: "code", rows: 7, readonly: true, spellcheck: "false", "aria-label": "What was copied", hidden: true });
  const told = h("p", { class: "muted", role: "status" });

  async function copy({ words, text }: Recipe): Promise<void> {
    const content = text();
    shown.hidden = content === null;
    shown.value = content ?? "";
    if (content === null) {
      told.textContent = "There is nothing to copy yet.";
      return;
    }
    try {
      await navigator.clipboard.writeText(content);
      told.textContent = `${words}: in the clipboard.`;
    } catch {
      shown.select(); // pages without TLS may not write to the clipboard
      told.textContent = `${words}: copy it from below.`;
    }
    announce(told.textContent);
  }

  const element = menu("Copy as", "code", h("div", { class: "menu-group" }, ...recipes.map((recipe) => button(recipe.words, () => void copy(recipe), { kind: "quiet" }))), told, shown);
  element.classList.add("copy-menu");
  return element;
}
