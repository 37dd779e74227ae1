// A menu that copies the request of a page as a command or a program.
import { announce } from "./announce";
import { button } from "./controls";
import { h } from "./dom";
import { menu } from "./menu";

export interface Recipe {
  readonly words: string;
  /** Null if there is no request yet. */
  readonly text: () => string | null;
}

/** A menu with a button for each recipe, and the text that was copied last. */
export function copyMenu(recipes: readonly Recipe[]): HTMLDetailsElement {
  const shown = h("textarea", { class: "code", rows: 7, readonly: true, spellcheck: "false", "aria-label": "What was copied", hidden: true });
  const message = h("p", { class: "muted", role: "status" });

  async function copy({ words, text }: Recipe): Promise<void> {
    const content = text();
    shown.hidden = content === null;
    shown.value = content ?? "";
    if (content === null) {
      message.textContent = "There is nothing to copy yet.";
      return;
    }
    try {
      await navigator.clipboard.writeText(content);
      message.textContent = `${words}: in the clipboard.`;
    } catch {
      shown.select(); // pages without TLS may not write to the clipboard
      message.textContent = `${words}: copy it from below.`;
    }
    announce(message.textContent);
  }

  const element = menu("Copy as", "code", h("div", { class: "menu-group" }, ...recipes.map((recipe) => button(recipe.words, () => void copy(recipe), { kind: "quiet" }))), message,
    shown);
  element.classList.add("copy-menu");
  return element;
}
