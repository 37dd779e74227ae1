// Form controls with labels. Sliders report every movement, and whether it is the last one.
import { h, uniqueId } from "./dom";
import { icon, type IconName } from "./icons";
import { showText } from "./writing";

export interface ButtonOptions {
  icon?: IconName;
  /** Tooltip; also the accessible name of a button that shows only its icon. */
  title?: string;
  kind?: "primary" | "quiet";
}

export function button(words: string, act: () => void, options: ButtonOptions = {}): HTMLButtonElement {
  const element = h(
    "button",
    { type: "button", class: `button ${options.kind ?? ""}`.trim(), title: options.title, onclick: act },
    options.icon && icon(options.icon),
    words && h("span", {}, words),
  );
  if (!words && options.title) element.setAttribute("aria-label", options.title);
  return element;
}

export interface Choice<Value extends string> {
  value: Value;
  words: string;
}

/** A drop-down list with its label. */
export class Select<Value extends string> {
  readonly element: HTMLElement;
  private readonly list = h("select", { id: uniqueId("select") });

  constructor(label: string, choices: readonly Choice<Value>[], changed: (value: Value) => void) {
    this.setChoices(choices);
    this.list.addEventListener("change", () => changed(this.list.value as Value));
    this.element = h("div", { class: "field" }, h("label", { for: this.list.id }, label), this.list);
  }

  setChoices(choices: readonly Choice<Value>[]): void {
    const { options, value } = this.list;
    if (choices.length === options.length && choices.every((choice, k) => choice.value === options[k].value && choice.words === options[k].text)) return;
    this.list.replaceChildren(...choices.map((choice) => h("option", { value: choice.value }, choice.words)));
    this.list.value = value;
  }

  set value(value: Value) {
    this.list.value = value;
  }
}

/** A checkbox with its label. */
export class Checkbox {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement;

  constructor(label: string, changed: (value: boolean) => void) {
    this.input = h("input", { type: "checkbox", onchange: () => changed(this.input.checked) });
    this.element = h("label", { class: "checkbox" }, this.input, h("span", {}, label));
  }

  set value(value: boolean) {
    this.input.checked = value;
  }

  set disabled(disabled: boolean) {
    this.input.disabled = disabled;
  }
}

export interface SliderOptions {
  label: string;
  /** Tooltip: what a larger value does. */
  title?: string;
  lower: number;
  upper: number;
  step?: number;
  /** Decimals that the number field shows. */
  digits: number;
  unit?: string;
  /** `done`: the slider was released, or a number was entered. */
  changed: (value: number, done: boolean) => void;
}

/** A slider and a number field for the same value. */
export class Slider {
  readonly element: HTMLElement;
  private readonly range: HTMLInputElement;
  private readonly number: HTMLInputElement;
  private lower: number;
  private upper: number;
  private current = 0;

  constructor(private readonly options: SliderOptions) {
    const { label, lower, upper, unit } = options;
    [this.lower, this.upper] = [lower, upper];
    const id = uniqueId("slider");
    const step = options.step ?? "any";
    this.range = h("input", { type: "range", id, min: lower, max: upper, step });
    this.number = h("input", { type: "number", class: "number", min: lower, max: upper, step: "any", "aria-label": `${label}${unit ? `, ${unit}` : ""}, as a number` });
    this.range.addEventListener("input", () => this.notify(Number(this.range.value), false));
    this.range.addEventListener("change", () => this.notify(Number(this.range.value), true));
    this.number.addEventListener("change", () => {
      const value = Number(this.number.value);
      if (this.number.value !== "" && Number.isFinite(value)) {
        this.current = Math.max(this.lower, Math.min(this.upper, value));
        this.notify(this.current, true);
      }
      this.showNumber(); // the clamped or previous value replaces an entry that is not used
    });
    this.element = h(
      "div",
      { class: "field slider", title: options.title || null },
      h("label", { for: id }, label),
      h("div", { class: "slider-row" }, this.range,
        h("span", { class: "number-box" }, this.number, unit && h("span", { class: `unit of-${unit.length}`, "aria-hidden": "true" }, unit))),
    );
  }

  set value(value: number) {
    this.current = value;
    this.range.value = String(value);
    this.showNumber();
    const fraction = (value - this.lower) / (this.upper - this.lower);
    const share = `${100 * Math.max(0, Math.min(1, fraction))}%`;
    if (this.range.style.getPropertyValue("--share") !== share) this.range.style.setProperty("--share", share);
  }

  /** Changes the limits. The caller sets the value afterwards. */
  limit(lower: number, upper: number): void {
    [this.lower, this.upper] = [lower, upper];
    for (const input of [this.range, this.number]) {
      input.min = String(lower);
      input.max = String(upper);
    }
  }

  set disabled(disabled: boolean) {
    this.range.disabled = disabled;
    this.number.disabled = disabled;
  }

  private showNumber(): void {
    showText(this.number, String(Number(this.current.toFixed(this.options.digits))));
  }

  private notify(value: number, done: boolean): void {
    this.value = value;
    this.options.changed(value, done);
  }
}

/** Radio buttons in a row. */
export class Segments<Value extends string> {
  readonly element: HTMLElement;
  private readonly inputs = new Map<Value, HTMLInputElement>();

  constructor(label: string, choices: readonly Choice<Value>[], changed: (value: Value) => void) {
    const name = uniqueId("segments");
    this.element = h("fieldset", { class: "segments" }, h("legend", {}, label));
    const row = h("div", { class: "segment-row" });
    for (const { value, words } of choices) {
      const input = h("input", { type: "radio", name, value, onchange: () => changed(value) });
      this.inputs.set(value, input);
      row.append(h("label", {}, input, h("span", {}, words)));
    }
    this.element.append(row);
  }

  set value(value: Value) {
    const input = this.inputs.get(value);
    if (input) input.checked = true;
  }
}
