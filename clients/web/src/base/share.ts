import { announce } from "./announce";
import { button } from "./controls";

const FLASH_MS = 2000;

/** A button that copies the page's address. `write` puts the state into the address; a text that it returns says why it could not. */
export function shareButton(title: string, write: () => string | undefined): HTMLButtonElement {
  const element = button("Share", () => void share(), { icon: "link", title });

  async function share(): Promise<void> {
    const refusal = write();
    if (refusal) return flash(refusal);
    try {
      await navigator.clipboard.writeText(location.href);
      announce("The link is in the clipboard.");
      flash("Copied");
    } catch {
      flash("Copy it from the address bar"); // pages without TLS may not write to the clipboard
    }
  }

  function flash(words: string): void {
    const label = element.querySelector("span");
    if (!label) return;
    label.textContent = words;
    element.classList.add("told");
    setTimeout(() => {
      label.textContent = "Share";
      element.classList.remove("told");
    }, FLASH_MS);
  }

  return element;
}
