// Fields for a line of text and for a number, with labels. What cannot be used is reported at the field, which keeps it until it is changed.
import { h, uniqueId } from "./dom";
import { showText } from "./writing";

export interface TextFieldOptions {
  readonly label: string;
  readonly maxLength: number;
  /** Why a text cannot be used; empty if it can. */
  readonly fault?: (text: string) => string;
  readonly changed: (text: string) => void;
}

export class TextField {
  readonly element: HTMLElement;
  readonly input: HTMLInputElement;

  constructor({ label, maxLength, fault = () => "", changed }: TextFieldOptions) {
    const id = uniqueId("text");
    this.input = h("input", { type: "text", class: "number text", id, maxlength: maxLength, autocomplete: "off", spellcheck: "false" });
    this.input.addEventListener("input", () => this.input.setCustomValidity(""));
    this.input.addEventListener("change", () => {
      const text = this.input.value.trim();
      this.input.setCustomValidity(fault(text));
      if (this.input.validity.valid) changed(text);
      else this.input.reportValidity();
    });
    this.element = h("div", { class: "field" }, h("label", { for: id }, label), this.input);
  }

  set value(text: string) {
    if (document.activeElement !== this.input || this.input.validity.valid) showText(this.input, text);
  }
}

export interface NumberFieldOptions {
  readonly label: string;
  /** Why a number cannot be used; empty if it can. */
  readonly fault?: (value: number) => string;
  readonly changed: (value: number) => void;
}

export class NumberField {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement;

  constructor({ label, fault = () => "", changed }: NumberFieldOptions) {
    const id = uniqueId("number");
    this.input = h("input", { type: "number", class: "number", id, step: "any" });
    this.input.addEventListener("input", () => this.input.setCustomValidity(""));
    this.input.addEventListener("change", () => {
      const value = this.input.value === "" ? NaN : Number(this.input.value);
      this.input.setCustomValidity(Number.isFinite(value) ? fault(value) : "Write a number.");
      if (this.input.validity.valid) changed(value);
      else this.input.reportValidity();
    });
    this.element = h("div", { class: "field" }, h("label", { for: id }, label), this.input);
  }

  set value(value: number) {
    if (document.activeElement !== this.input || this.input.validity.valid) showText(this.input, String(value));
  }
}
