// Fields that show a value and that people write in: an answer that comes while somebody writes does not take the words away.
import { type Child, replace } from "./dom";

type Field = HTMLInputElement | HTMLTextAreaElement;

let written: Field | undefined;
/** What the field would show by now. */
let meanwhile: string | undefined;
/** Places whose fields are built anew once nobody writes in one of them. */
const waiting = new Map<Element, () => readonly Child[]>();

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
  // After the browser has moved the focus to the next field: a field that goes away under it would take the focus along.
  if (waiting.size > 0) setTimeout(() => {
    for (const [place, build] of [...waiting]) rebuild(place, build);
  });
}

function isText(target: EventTarget | null): target is Field {
  return target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && ["text", "number"].includes(target.type));
}

/** Shows a value in a field; in one that is being written in, only once that ended without a change. */
export function showText(field: Field, text: string): void {
  if (field === written) meanwhile = text;
  else field.value = text;
}

/** Builds the fields of a place anew; while somebody writes in one of them, only once that ended. The field with the same label keeps the focus. */
export function rebuild(place: Element, build: () => readonly Child[]): void {
  if (written && place.contains(written)) {
    waiting.set(place, build);
    return;
  }
  waiting.delete(place);
  const fields = () => [...place.querySelectorAll<HTMLInputElement | HTMLSelectElement>("input, select")];
  const focused = fields().find((field) => field === document.activeElement);
  const [label, type] = [focused?.labels?.[0]?.textContent, focused?.type];
  replace(place, ...build());
  const next = focused && fields().find((field) => field.type === type && field.labels?.[0]?.textContent === label);
  next?.focus();
  // Like a field that is reached with the keyboard: what is written next takes the place of what it holds.
  if (next && isText(next)) next.select();
}
