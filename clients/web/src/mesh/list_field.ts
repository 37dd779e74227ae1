// A text field for a list. An invalid text is reported at the field.
import { h, uniqueId } from "../base/dom";
import { showText } from "../base/writing";

export interface ListField {
  readonly element: HTMLElement;
  set(text: string): void;
}

export function listField<Value>(label: string, placeholder: string, fault: string, read: (text: string) => Value | null, accept: (value: Value) => boolean): ListField {
  const id = uniqueId("list");
  const input = h("input", { class: "number list", id, placeholder, autocomplete: "off", spellcheck: "false" });
  input.addEventListener("input", () => input.setCustomValidity(""));
  input.addEventListener("change", () => {
    const value = read(input.value);
    if (value !== null && accept(value)) return;
    input.setCustomValidity(fault);
    input.reportValidity();
  });
  return {
    element: h("div", { class: "field" }, h("label", { for: id }, label), input),
    set(text) {
      if (document.activeElement !== input || input.validity.valid) showText(input, text);
    },
  };
}
