// Files that are dropped onto the page: a drawing becomes the shape of the part, anything else is read as measured data.
import { h } from "../base/dom";
import { textOf } from "../base/text_file";

/** What a dropped file is for; ends with why it was refused, or with "". */
export type Take = (text: string, name: string, bytes: ArrayBuffer) => Promise<string>;

/** A refusal stands beside the place where the file was dropped, which is what a person looks at then. */
export function takeDrops(page: HTMLElement, take: Take): void {
  const note = h("p", { class: "card note problem drop-problem", role: "alert", hidden: true });
  let over: Element | null = null;

  function isOver(card: Element | null): void {
    over?.classList.remove("dropping");
    over = card;
    over?.classList.add("dropping");
  }

  const cardOf = (event: DragEvent): Element | null => (event.target instanceof Element ? event.target.closest(".card") : null);

  page.addEventListener("dragover", (event) => {
    // Text that is dragged goes into fields as everywhere.
    if (!event.dataTransfer?.types.includes("Files")) return;
    event.preventDefault();
    isOver(cardOf(event) ?? page);
  });
  page.addEventListener("dragleave", (event) => {
    if (!(event.relatedTarget instanceof Node) || !page.contains(event.relatedTarget)) isOver(null);
  });
  page.addEventListener("drop", (event) => {
    const file = event.dataTransfer?.files[0];
    isOver(null);
    if (!file) return;
    event.preventDefault();
    const card = cardOf(event);
    note.hidden = true;
    void file.arrayBuffer().then((bytes) => take(textOf(bytes), file.name, bytes)).then((problem) => {
      if (problem === "") return;
      note.textContent = `${file.name}: ${problem}`;
      if (card) card.after(note);
      else page.prepend(note);
      note.hidden = false;
    });
  });
}
