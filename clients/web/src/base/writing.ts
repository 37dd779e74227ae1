// Fields that show a value and that people write in: an answer that comes while somebody writes does not take the words away.

type Field = HTMLInputElement | HTMLTextAreaElement;

let written: Field | undefined;
/** What the field would show by now. */
let meanwhile: string | undefined;

/** From now on knows the field that is being written in, from its first letter until the browser takes what was written. */
export function watchWriting(page: Document): void {
  page.addEventListener("input", ({ target }) => {
    if (!isText(target) || target === written) return;
    written = target;
    meanwhile = undefined;
  }, true);
  // In the capture phase: whoever listens to the field itself may already show something else in it.
  page.addEventListener("change", () => end(), true);
  page.addEventListener("focusout", () => end(meanwhile), true);
}

function end(text?: string): void {
  const field = written;
  written = undefined;
  if (field && text !== undefined) field.value = text;
}

function isText(target: EventTarget | null): target is Field {
  return target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && ["text", "number"].includes(target.type));
}

/** Shows a value in a field; in one that is being written in, only once that ended without a change. */
export function showText(field: Field, text: string): void {
  if (field === written) meanwhile = text;
  else field.value = text;
}
