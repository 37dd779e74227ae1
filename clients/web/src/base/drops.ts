// Files that are dropped onto the page, and the highlight of the card below them.
import { h } from "./dom";
import { textOf } from "./text_file";

/** Uses a dropped file. Resolves with the reason for a refusal, or with "". */
export type FileHandler = (text: string, name: string, bytes: ArrayBuffer) => Promise<string>;

/** Passes files that are dropped onto the page to `handle`. A refusal is shown below the card on which the file was dropped. */
export function handleDrops(page: HTMLElement, handle: FileHandler): void {
  const note = h("p", { class: "card note problem drop-problem", role: "alert", hidden: true });
  let highlighted: Element | null = null;

  function highlight(card: Element | null): void {
    highlighted?.classList.remove("dropping");
    highlighted = card;
    highlighted?.classList.add("dropping");
  }

  const cardOf = (event: DragEvent): Element | null => (event.target instanceof Element ? event.target.closest(".card") : null);

  page.addEventListener("dragover", (event) => {
    // Dragged text is left to the browser.
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    highlight(cardOf(event) ?? page);
  });
  page.addEventListener("dragleave", (event) => {
    if (!(event.relatedTarget instanceof Node) || !page.contains(event.relatedTarget)) highlight(null);
  });
  page.addEventListener("drop", (event) => {
    const file = event.dataTransfer?.files[0];
    highlight(null);
    if (!file) return;
    event.preventDefault();
    const card = cardOf(event);
    note.hidden = true;
    void file.arrayBuffer().then((bytes) => handle(textOf(bytes), file.name, bytes)).then((problem) => {
      if (problem === "") return;
      note.textContent = `${file.name}: ${problem}`;
      if (card) card.after(note);
      else page.prepend(note);
      note.hidden = false;
    });
  });
}
