// Text fields that show values of the state. While the user edits a field, updates of it are deferred, so that an answer does not
// overwrite the input.
import { type Child, replace } from "./dom";

type Field = HTMLInputElement | HTMLTextAreaElement;

/** The field that is being edited. */
let edited: Field | undefined;
/** The value that the edited field would show now. */
let pendingText: string | undefined;
/** Containers whose fields are rebuilt when none of them is being edited any more. */
const pendingRebuilds = new Map<Element, () => readonly Child[]>();

/** Keeps track of the field that is being edited, from its first input event to its change event or the loss of the focus. */
export function watchWriting(page: Document): void {
  page.addEventListener("input", ({ target }) => {
    if (!isText(target) || target === edited) return;
    edited = target;
    pendingText = undefined;
  }, true);
  // The capture phase comes first: listeners of the field itself may set another value.
  page.addEventListener("change", () => end(), true);
  page.addEventListener("focusout", () => end(pendingText), true);
}

function end(text?: string): void {
  const field = edited;
  edited = undefined;
  if (field && text !== undefined) field.value = text;
  // The timeout waits until the browser has moved the focus to the next field; replacing that field earlier would lose the focus.
  if (pendingRebuilds.size > 0) {
    setTimeout(() => {
      for (const [place, build] of [...pendingRebuilds]) rebuild(place, build);
    });
  }
}

function isText(target: EventTarget | null): target is Field {
  return target instanceof HTMLTextAreaElement || (target instanceof HTMLInputElement && ["text", "number"].includes(target.type));
}

/** Shows a value in a field. In the edited field it appears only after editing has ended without a change. */
export function showText(field: Field, text: string): void {
  if (field === edited) pendingText = text;
  else field.value = text;
}

/** The label by which a field is found again; several fields of a container may have no label element. */
function labelOf(field: HTMLInputElement | HTMLSelectElement): string {
  return field.getAttribute("aria-label") ?? field.labels?.[0]?.textContent ?? "";
}

/** Rebuilds the fields of a container, or defers this while one of them is edited. The new field with the same label gets the focus. */
export function rebuild(place: Element, build: () => readonly Child[]): void {
  if (edited && place.contains(edited)) {
    pendingRebuilds.set(place, build);
    return;
  }
  pendingRebuilds.delete(place);
  const fields = () => [...place.querySelectorAll<HTMLInputElement | HTMLSelectElement>("input, select")];
  const focused = fields().find((field) => field === document.activeElement);
  const [label, type] = [focused && labelOf(focused), focused?.type];
  replace(place, ...build());
  const next = focused && fields().find((field) => field.type === type && labelOf(field) === label);
  next?.focus();
  // The text is selected, as in a field that is reached with the keyboard, so that input replaces it.
  if (next && isText(next)) next.select();
}
