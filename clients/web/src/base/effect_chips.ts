// Effects as chips with what they found. A chip whose effect can be switched is a button: where needed, always, never.
import type { EffectSwitch } from "../contract/types";
import { announce } from "./announce";
import { h, replaceChanged, writeAttribute } from "./dom";
import { type Chip, nextSetting, SETTING_WORDS } from "./effect_words";

interface ChipElement {
  readonly item: HTMLElement;
  readonly face: HTMLElement;
  chip: Chip;
}

export class EffectChips {
  readonly element: HTMLElement;
  /** The elements by effect. They stay while their words change, so that a pressed one keeps the focus. */
  private readonly shown = new Map<string, ChipElement>();

  /** `set`: changes the switch of an effect. */
  constructor(label: string, private readonly set: (effect: string, value: EffectSwitch) => void = () => {}) {
    this.element = h("ul", { class: "effect-chips", "aria-label": label, hidden: true });
  }

  show(chips: readonly Chip[]): void {
    this.element.hidden = chips.length === 0;
    const names = new Set(chips.map(({ effect }) => effect));
    for (const [effect, { item }] of this.shown) {
      if (names.has(effect)) continue;
      item.remove();
      this.shown.delete(effect);
    }
    chips.forEach((chip, place) => {
      const known = this.shown.get(chip.effect);
      const one = known && (known.chip.setting === null) === (chip.setting === null) ? known : this.make(chip, known);
      one.chip = chip;
      if (this.element.children[place] !== one.item) this.element.insertBefore(one.item, this.element.children[place] ?? null);
      this.draw(one);
    });
  }

  private make(chip: Chip, before: ChipElement | undefined): ChipElement {
    before?.item.remove();
    const face = chip.setting === null ? h("span", { class: "effect-chip" }) : h("button", { type: "button", class: "effect-chip", onclick: () => this.press(chip.effect) });
    const made: ChipElement = { item: h("li", {}, face), face, chip };
    this.shown.set(chip.effect, made);
    return made;
  }

  private draw({ face, chip: { name, words, tone, why, setting } }: ChipElement): void {
    writeAttribute(face, "class", `effect-chip ${tone}`);
    const told = setting === null || setting === "automatic" ? "" : `, ${SETTING_WORDS[setting]}`;
    replaceChanged(face, h("span", { class: "effect-name" }, `${name}: `), h("span", {}, words), h("span", { class: "effect-setting" }, told));
    const press = setting === null ? "" : `It runs ${SETTING_WORDS[setting]}; a press makes it run ${SETTING_WORDS[nextSetting(setting)]}.`;
    writeAttribute(face, "title", [why, press].filter((part) => part).join(" "));
  }

  private press(effect: string): void {
    const chip = this.shown.get(effect)?.chip;
    if (!chip || chip.setting === null) return;
    const next = nextSetting(chip.setting);
    this.set(effect, next);
    announce(`${chip.name}: ${SETTING_WORDS[next]}.`, "change");
  }
}
