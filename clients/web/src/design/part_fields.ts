// The numbers of a part: its size, its walls, and how the design lies in it.
import { h, uniqueId } from "../base/dom";
import { showText } from "../base/writing";
import type { PartSettings } from "./part";
import { axisOf } from "./part_sketch";

type NumberSetting = "width" | "length" | "grip" | "plate" | "beamWidth" | "thickness" | "frame" | "density" | "orientation" | "direction" | "axis";
const LABELS: Record<NumberSetting, string> = {
  width: "Width, mm",
  length: "Length, mm",
  grip: "Each grip, mm",
  plate: "Each plate, mm",
  beamWidth: "Wall thickness, mm",
  thickness: "Thickness, mm",
  frame: "Frame, mm",
  density: "Density, g/cm³",
  orientation: "Orientation, °",
  direction: "Loaded along, °",
  axis: "Axis of the load, °",
};
const LENGTH_WORDS = { rectangle: "Length, mm", coupon: "Length between grips, mm", block: "Height between plates, mm", drawing: "" } as const;
/** Settings that a drawing replaces by the size of its curves. */
const SIZE_SETTINGS: readonly NumberSetting[] = ["width", "length"];
/** Settings that each region has for itself, if there are several. */
const STRUCTURE_SETTINGS: readonly NumberSetting[] = ["beamWidth", "orientation", "direction"];
/** Settings that are angles. */
const ANGLE_SETTINGS: readonly NumberSetting[] = ["orientation", "direction", "axis"];
/** Settings that may be empty. */
const OPTIONAL_SETTINGS: readonly NumberSetting[] = ["direction", "axis"];
const TITLES: Partial<Record<NumberSetting, string>> = {
  direction: "The direction of the design that lies along the load of the part; without one the structure is not turned",
  axis: "The direction in the part along which it will be loaded, counterclockwise from the right; without one the structure is not turned",
};

interface NumberField {
  readonly field: HTMLElement;
  readonly label: HTMLElement;
  readonly input: HTMLInputElement;
}

export class PartFields {
  readonly element: HTMLElement;
  private readonly fields = new Map<NumberSetting, NumberField>();

  /** `change`: sets a setting; null for a direction whose field is empty. `refuse`: called for an invalid number. */
  constructor(private readonly change: (values: Partial<PartSettings>) => void, private readonly refuse: () => void) {
    for (const name of Object.keys(LABELS) as NumberSetting[]) this.fields.set(name, this.field(name));
    this.element = h("div", { class: "part-fields" }, ...[...this.fields.values()].map(({ field }) => field));
  }

  /** `several`: whether there are several regions. */
  show(settings: PartSettings, several: boolean): void {
    const isDrawing = settings.kind === "drawing";
    for (const [name, { field, label, input }] of this.fields) {
      showText(input, String(settings[name] ?? ""));
      field.hidden = isDrawing && (SIZE_SETTINGS.includes(name) || (STRUCTURE_SETTINGS.includes(name) && several));
      if (name === "length") label.textContent = LENGTH_WORDS[settings.kind];
      if (name === "grip") field.hidden = settings.kind !== "coupon";
      if (name === "plate") field.hidden = settings.kind !== "block";
      if (name === "axis") field.hidden = settings.kind === "coupon" || settings.kind === "block";
      if (name === "direction") field.hidden ||= axisOf(settings) === null;
    }
  }

  private field(name: NumberSetting): NumberField {
    const isAngle = ANGLE_SETTINGS.includes(name);
    const id = uniqueId("part");
    const read = (): void => {
      const value = Number(input.value);
      if (input.value === "" && OPTIONAL_SETTINGS.includes(name) && input.validity.valid) this.change({ [name]: null });
      else if (input.value !== "" && Number.isFinite(value) && (value >= 0 || isAngle)) this.change({ [name]: value });
      else this.refuse();
    };
    const input = h("input", { type: "number", id, class: "number", title: TITLES[name], min: isAngle ? null : 0, step: "any", onchange: read });
    const label = h("label", { for: id }, LABELS[name]);
    return { field: h("div", { class: "field" }, label, input), label, input };
  }
}
