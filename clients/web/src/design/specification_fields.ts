// The fields of a specification with numbers: each with one number, or with two for a range.
import { h, uniqueId } from "../base/dom";
import { type TermName, withTerm } from "../base/terms";
import { showText } from "../base/writing";
import { type Fault, isRange, type Range, type Size, type Specification, SPECIFICATION_LIMITS, type SpecificationField } from "./specification";

/** A field with one number, or with two for a range. */
interface Field {
  readonly element: HTMLElement;
  readonly inputs: readonly HTMLInputElement[];
  readonly problem: HTMLElement;
}

/** `maxLabel`: accessible name of the second number of a range. `choice`: a control beside the label. */
function makeField(label: string, changed: () => void, { maxLabel, choice }: { maxLabel?: string; choice?: HTMLElement } = {}): Field {
  const problem = h("p", { class: "note problem", id: uniqueId("problem"), role: "alert", hidden: true });
  const input = (name?: string) =>
    h("input", { type: "number", id: uniqueId("made"), class: "number", step: "any", "aria-label": name, "aria-describedby": problem.id, onchange: changed });
  const inputs = [input(), ...(maxLabel === undefined ? [] : [input(maxLabel)])];
  const row = h("div", { class: "made-inputs" }, inputs[0], inputs[1] && h("span", { class: "muted", "aria-hidden": "true" }, "to"), inputs[1]);
  return { element: h("div", { class: "field" }, h("div", { class: "made-head" }, h("label", { for: inputs[0].id }, label), choice), row, problem), inputs, problem };
}

/** A fraction in per cent, without the rounding error of the multiplication. */
function percentOf(fraction: number): number {
  return Number((100 * fraction).toPrecision(12));
}

function numberIn(input: HTMLInputElement): number {
  return input.value === "" ? NaN : Number(input.value);
}

type NumberField = Exclude<SpecificationField, "materials">;
type Numbers = Pick<Specification, NumberField>;

/** The number in a field, or the two of a range. */
function valueIn({ inputs: [first, second] }: Field, range: boolean): number | Range {
  return range ? [numberIn(first), numberIn(second)] : numberIn(first);
}

/** Whether nothing was entered. An empty field means no limit. */
function isEmpty(input: HTMLInputElement): boolean {
  return input.value === "" && !input.validity.badInput;
}

/** The limits in a field, in units of `unit`; null without any. */
function limitsIn({ inputs }: Field, [min, max]: Range, unit: number): Range | null {
  if (inputs.every(isEmpty)) return null;
  const value = (input: HTMLInputElement, otherwise: number) => (isEmpty(input) ? otherwise : numberIn(input) / unit);
  return [value(inputs[0], min), value(inputs[1], max)];
}

function write({ inputs: [first, second] }: Field, value: number | Range | null, range: boolean): void {
  showText(first, value === null ? "" : String(isRange(value) ? value[0] : value));
  if (!second) return;
  showText(second, value !== null && isRange(value) ? String(value[1]) : "");
  second.hidden = !range;
  (second.previousElementSibling as HTMLElement).hidden = !range;
}

export class SpecificationFields {
  private readonly fields: Record<NumberField, Field>;

  /**
   * `changed`: called when a number was entered; `searched` says whether it affects the search. The other arguments are controls beside the
   * labels of the modulus and of the orientation.
   */
  constructor(changed: (searched: boolean) => void, findModulus: HTMLElement, findOrientation: HTMLElement) {
    const field = (label: string, options: Parameters<typeof makeField>[2] = {}, term?: TermName): Field => {
      const made = makeField(label, () => changed(true), options);
      if (term) withTerm(made.element, term);
      return made;
    };
    this.fields = {
      youngsModulus: field("Young’s modulus, MPa", { maxLabel: "Young’s modulus at most, MPa", choice: findModulus }, "youngs_modulus"),
      density: makeField("Density of the material, g/cm³", () => changed(false)),
      orientation: field("Orientation, °", { maxLabel: "Orientation at most, °", choice: findOrientation }),
      size: field("Beam width, mm", {}, "beam_width"),
      relativeDensity: field("Relative density from, %", { maxLabel: "Relative density at most, %" }, "relative_density"),
      leastBeamWidth: field("Beam width at least, mm", {}, "beam_width"),
      cellSizes: field("Cell size from, mm", { maxLabel: "Cell size at most, mm" }, "cell_size"),
    };
  }

  element(name: NumberField): HTMLElement {
    return this.fields[name].element;
  }

  focus(name: NumberField): void {
    this.fields[name].inputs[0].focus();
  }

  /** The values that were entered, which may be invalid. `made`: says which of them are ranges, and which size is given. */
  read(made: Specification): Numbers {
    const { youngsModulus, density, orientation, size, relativeDensity, leastBeamWidth, cellSizes } = this.fields;
    const [widthInput] = leastBeamWidth.inputs;
    return {
      youngsModulus: valueIn(youngsModulus, isRange(made.youngsModulus)),
      density: numberIn(density.inputs[0]),
      orientation: valueIn(orientation, isRange(made.orientation)),
      size: { kind: made.size.kind, value: numberIn(size.inputs[0]) },
      relativeDensity: limitsIn(relativeDensity, SPECIFICATION_LIMITS.relativeDensity, 100),
      leastBeamWidth: made.size.kind === "beam_width" || isEmpty(widthInput) ? null : numberIn(widthInput),
      cellSizes: made.size.kind === "cell_size" ? null : limitsIn(cellSizes, SPECIFICATION_LIMITS.cellSizes, 1),
    };
  }

  show(made: Specification): void {
    const { fields } = this;
    const { youngsModulus, density, orientation, size, relativeDensity, leastBeamWidth, cellSizes } = made;
    const several = made.materials.length > 0;
    fields.youngsModulus.element.hidden = several;
    fields.density.element.hidden = several;
    write(fields.youngsModulus, youngsModulus, isRange(youngsModulus));
    write(fields.density, density, false);
    write(fields.orientation, orientation, isRange(orientation));
    this.showSize(size);
    write(fields.relativeDensity, relativeDensity && [percentOf(relativeDensity[0]), percentOf(relativeDensity[1])], true);
    write(fields.cellSizes, cellSizes, true);
    for (const name of ["relativeDensity", "cellSizes"] as const) {
      fields[name].inputs.forEach((input, k) => {
        if (made[name]?.[k] === SPECIFICATION_LIMITS[name][k]) showText(input, "");
      });
    }
    write(fields.leastBeamWidth, leastBeamWidth, false);
  }

  showFault(fault: Fault | null): void {
    for (const [name, { inputs, problem }] of Object.entries(this.fields)) {
      const isAtFault = fault?.field === name;
      problem.textContent = isAtFault ? fault.sentence : "";
      problem.hidden = !isAtFault;
      for (const input of inputs) {
        if (isAtFault) input.setAttribute("aria-invalid", "true");
        else input.removeAttribute("aria-invalid");
      }
    }
  }

  private showSize({ kind, value }: Size): void {
    const { size, cellSizes, leastBeamWidth } = this.fields;
    write(size, value, false);
    (size.element.querySelector("label") as HTMLElement).textContent = kind === "beam_width" ? "Beam width, mm" : "Cell size, mm";
    // The limits are those of the size that follows from the given one.
    cellSizes.element.hidden = kind === "cell_size";
    leastBeamWidth.element.hidden = kind === "beam_width";
  }
}
