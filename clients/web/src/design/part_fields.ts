// The numbers of a part: its size, its walls, and how the design lies in it.
import { h, uniqueId } from "../base/dom";
import { showText } from "../base/writing";
import type { PartSettings } from "./part";

type NumberSetting = "width" | "length" | "end" | "beamWidth" | "thickness" | "frame" | "density" | "orientation" | "direction";
const LABELS: Record<NumberSetting, string> = {
  width: "Width, mm",
  length: "Length, mm",
  end: "Grips, mm",
  beamWidth: "Wall thickness, mm",
  thickness: "Thickness, mm",
  frame: "Frame, mm",
  density: "Density, g/cm³",
  orientation: "Orientation, °",
  direction: "Loaded along, °",
};
const END_WORDS = { rectangle: "", coupon: "Each grip, mm", block: "Each plate, mm", drawing: "" } as const;
/** Settings that a drawing replaces by the size of its curves. */
const SIZE_SETTINGS: readonly NumberSetting[] = ["width", "length", "end"];
/** Settings that each region has for itself, if there are several. */
const STRUCTURE_SETTINGS: readonly NumberSetting[] = ["beamWidth", "orientation"];
/** Settings that are angles. */
const ANGLE_SETTINGS: readonly NumberSetting[] = ["orientation", "direction"];

interface NumberField {
  readonly field: HTMLElement;
  readonly label: HTMLElement;
  readonly input: HTMLInputElement;
}

export class PartFields {
  readonly element: HTMLElement;
  private readonly fields = new Map<NumberSetting, NumberField>();

  /** `change`: sets a setting; null for the direction if its field is empty. `refuse`: called for an invalid number. */
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
      if (name === "direction") {
        field.hidden = isDrawing || settings.kind === "rectangle";
        input.title = "The direction of the design that lies along the length of the part; without one the design's 90°";
      }
      if (name === "end") {
        field.hidden ||= settings.kind === "rectangle";
        label.textContent = END_WORDS[settings.kind];
      }
    }
  }

  private field(name: NumberSetting): NumberField {
    const isAngle = ANGLE_SETTINGS.includes(name);
    const id = uniqueId("part");
    const read = (): void => {
      const value = Number(input.value);
      if (input.value === "" && name === "direction" && input.validity.valid) this.change({ direction: null });
      else if (input.value !== "" && Number.isFinite(value) && (value >= 0 || isAngle)) this.change({ [name]: value });
      else this.refuse();
    };
    const input = h("input", { type: "number", id, class: "number", min: isAngle ? null : 0, step: "any", onchange: read });
    const label = h("label", { for: id }, LABELS[name]);
    return { field: h("div", { class: "field" }, label, input), label, input };
  }
}
