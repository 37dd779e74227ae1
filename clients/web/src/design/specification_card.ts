// The card with material, orientation, size and limits of the structure. Values are given, or the search chooses them from a range.
import { Segments, Select } from "../base/controls";
import { h, uniqueId } from "../base/dom";
import { digits } from "../base/format";
import { showText } from "../base/writing";
import { DEFAULT_SPECIFICATION, type Fault, faultOf, isRange, searchesModulus, type Specification, SPECIFICATION_LIMITS, type SpecificationField, modulusOf, modulusWords,
  orientationOf, PRESETS, type Range, sameSpecification, withFoundValues, type Size } from "./specification";
import { MaterialList } from "./material_list";
import type { DesignSession } from "./session";

/** The initial range of a searched modulus: the given value divided and multiplied by this factor. */
const MODULUS_FACTOR = 2;
const HALF_TURN: Range = [0, 180];
/** Cell size in mm that is offered before a structure was measured. */
const FIRST_CELL_SIZE = 5;
/** Significant digits of values that the page enters into fields. */
const DIGITS = 3;

const OWN = "own";
const SEVERAL = "several";
const DATA = "data";

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

function findBox(what: string, changed: (find: boolean) => void): { element: HTMLElement; input: HTMLInputElement } {
  const input = h("input", { type: "checkbox", onchange: () => changed(input.checked) });
  return { input, element: h("label", { class: "checkbox" }, input, h("span", {}, "Find it", h("span", { class: "visually-hidden" }, `: ${what}`))) };
}

/** A number rounded to a few digits, as a user would write it. */
function rounded(value: number): number {
  return Number(value.toPrecision(DIGITS));
}

/** A fraction in per cent, without the rounding error of the multiplication. */
function percentOf(fraction: number): number {
  return Number((100 * fraction).toPrecision(12));
}

function numberIn(input: HTMLInputElement): number {
  return input.value === "" ? NaN : Number(input.value);
}

export function specificationCard(session: DesignSession): HTMLElement {
  const summary = h("span", { class: "muted" });
  const preset = new Select<string>("Material", [
    { value: DATA, words: `Of the models’ data (${DEFAULT_SPECIFICATION.youngsModulus} MPa)` },
    ...PRESETS.map(({ name, youngsModulus, density }) => ({ value: name, words: `${name} (${youngsModulus} MPa, ${density} g/cm³)` })),
    { value: OWN, words: "Other values" },
    { value: SEVERAL, words: "Several: the search chooses" },
  ], (value) => choose(value));
  const findModulus = findBox("Young’s modulus", (find) => {
    const { made, found } = session.state.get();
    const value = modulusOf(made, found);
    const [min, max] = SPECIFICATION_LIMITS.youngsModulus;
    const range: Range = [Math.max(min, rounded(value / MODULUS_FACTOR)), Math.min(max, rounded(value * MODULUS_FACTOR))];
    apply({ youngsModulus: find ? range : rounded(value) }, true);
  });
  const findOrientation = findBox("orientation", (find) => {
    const { made, found } = session.state.get();
    apply({ orientation: find ? HALF_TURN : rounded((orientationOf(made, found) * 180) / Math.PI) }, true);
  });
  const sizeKind = new Segments<Size["kind"]>("Size", [{ value: "beam_width", words: "Beam width" }, { value: "cell_size", words: "Cell size" }], (kind) => chooseSize(kind));
  const materials = new MaterialList((list) =>
    apply({ materials: list, ...(list.length === 0 && { youngsModulus: DEFAULT_SPECIFICATION.youngsModulus, density: DEFAULT_SPECIFICATION.density }) }, true)
  );
  const fields: Record<Exclude<SpecificationField, "materials">, Field> = {
    youngsModulus: makeField("Young’s modulus, MPa", () => read(true), { maxLabel: "Young’s modulus at most, MPa", choice: findModulus.element }),
    density: makeField("Density of the material, g/cm³", () => read(false)),
    orientation: makeField("Orientation, °", () => read(true), { maxLabel: "Orientation at most, °", choice: findOrientation.element }),
    size: makeField("Beam width, mm", () => read(true)),
    relativeDensity: makeField("Relative density from, %", () => read(true), { maxLabel: "Relative density at most, %" }),
    leastBeamWidth: makeField("Beam width at least, mm", () => read(true)),
    cellSizes: makeField("Cell size from, mm", () => read(true), { maxLabel: "Cell size at most, mm" }),
  };
  const element = h("details", { class: "card controls made", "aria-label": "Material and size" }, h("summary", {}, "Material and size ", summary), preset.element,
    h("p", { class: "muted" }, "Values of materials are typical ones: those of a print differ, so measure yours."), materials.element, fields.youngsModulus.element,
    fields.density.element, fields.orientation.element, sizeKind.element, fields.size.element,
    h("fieldset", { class: "made-limits" }, h("legend", {}, "Limits"), h("p", { class: "muted" }, "The search keeps to designs within them; an empty field is no limit."),
      fields.relativeDensity.element, fields.leastBeamWidth.element, fields.cellSizes.element));

  /** `searched`: the change affects the search, so that parameters set by hand are searched for again if anything is left to the search. */
  function apply(change: Partial<Specification>, searched: boolean): void {
    const before = session.state.get().made;
    const made = { ...before, ...change };
    const fault = faultOf(made);
    showFault(fault);
    if (fault) return;
    if (sameSpecification(made, before)) return show(before);
    const asksForSearch = searched &&
      (searchesModulus(made) || isRange(made.orientation) || made.relativeDensity !== null || made.leastBeamWidth !== null || made.cellSizes !== null);
    session.apply({ made, ...(asksForSearch && { byHand: false }) });
  }

  function choose(value: string): void {
    if (value === OWN) {
      // The found values become the given ones.
      const { made, found } = session.state.get();
      const { youngsModulus, density } = withFoundValues(made, found ?? {});
      if (made.materials.length > 0) apply({ youngsModulus, density, materials: [] }, false);
      return fields.youngsModulus.inputs[0].focus();
    }
    if (value === SEVERAL) return apply({ materials: PRESETS }, true);
    const { youngsModulus, density } = PRESETS.find(({ name }) => name === value) ?? DEFAULT_SPECIFICATION;
    apply({ youngsModulus, density, materials: [] }, false);
  }

  function chooseSize(kind: Size["kind"]): void {
    const measures = session.shown.get()?.measures;
    const value = kind === "beam_width" ? (measures?.beamWidth ?? DEFAULT_SPECIFICATION.size.value) : (measures?.cellSize ?? FIRST_CELL_SIZE);
    apply({ size: { kind, value: rounded(value) }, ...(kind === "beam_width" ? { leastBeamWidth: null } : { cellSizes: null }) }, true);
  }

  /** Applies the values of the fields, unless one is invalid. */
  function read(searched: boolean): void {
    const { made } = session.state.get();
    const pair = ({ inputs: [min, max] }: Field): Range => [numberIn(min), numberIn(max)];
    // An empty field means no limit; if both are empty, there is no range.
    const isEmpty = (input: HTMLInputElement): boolean => input.value === "" && !input.validity.badInput;
    const limits = ({ inputs }: Field, [min, max]: Range, unit: number): Range | null => {
      if (inputs.every(isEmpty)) return null;
      const value = (input: HTMLInputElement, otherwise: number) => (isEmpty(input) ? otherwise : numberIn(input) / unit);
      return [value(inputs[0], min), value(inputs[1], max)];
    };
    const [widthInput] = fields.leastBeamWidth.inputs;
    apply({
      youngsModulus: isRange(made.youngsModulus) ? pair(fields.youngsModulus) : numberIn(fields.youngsModulus.inputs[0]),
      density: numberIn(fields.density.inputs[0]),
      orientation: isRange(made.orientation) ? pair(fields.orientation) : numberIn(fields.orientation.inputs[0]),
      size: { kind: made.size.kind, value: numberIn(fields.size.inputs[0]) },
      relativeDensity: limits(fields.relativeDensity, SPECIFICATION_LIMITS.relativeDensity, 100),
      leastBeamWidth: made.size.kind === "beam_width" || isEmpty(widthInput) ? null : numberIn(widthInput),
      cellSizes: made.size.kind === "cell_size" ? null : limits(fields.cellSizes, SPECIFICATION_LIMITS.cellSizes, 1),
    }, searched);
  }

  function showFault(fault: Fault | null): void {
    materials.showFault(fault);
    for (const [name, { inputs, problem }] of Object.entries(fields)) {
      const isAtFault = fault?.field === name;
      problem.textContent = isAtFault ? fault.sentence : "";
      problem.hidden = !isAtFault;
      for (const input of inputs) {
        if (isAtFault) input.setAttribute("aria-invalid", "true");
        else input.removeAttribute("aria-invalid");
      }
    }
  }

  function write({ inputs: [first, second] }: Field, value: number | Range | null, range: boolean): void {
    showText(first, value === null ? "" : String(isRange(value) ? value[0] : value));
    if (!second) return;
    showText(second, value !== null && isRange(value) ? String(value[1]) : "");
    second.hidden = !range;
    (second.previousElementSibling as HTMLElement).hidden = !range;
  }

  function show(made: Specification): void {
    const { youngsModulus, density, orientation, size, relativeDensity, leastBeamWidth, cellSizes } = made;
    const several = made.materials.length > 0;
    const known = [{ name: DATA, ...DEFAULT_SPECIFICATION }, ...PRESETS].find((one) => one.youngsModulus === youngsModulus && one.density === density);
    preset.value = several ? SEVERAL : (known?.name ?? OWN);
    materials.show(made.materials);
    materials.element.hidden = !several;
    fields.youngsModulus.element.hidden = several;
    fields.density.element.hidden = several;
    findModulus.input.checked = isRange(youngsModulus);
    findOrientation.input.checked = isRange(orientation);
    sizeKind.value = size.kind;
    write(fields.youngsModulus, youngsModulus, isRange(youngsModulus));
    write(fields.density, density, false);
    write(fields.orientation, orientation, isRange(orientation));
    write(fields.size, size.value, false);
    (fields.size.element.querySelector("label") as HTMLElement).textContent = size.kind === "beam_width" ? "Beam width, mm" : "Cell size, mm";
    write(fields.relativeDensity, relativeDensity && [percentOf(relativeDensity[0]), percentOf(relativeDensity[1])], true);
    write(fields.cellSizes, cellSizes, true);
    for (const name of ["relativeDensity", "cellSizes"] as const) {
      fields[name].inputs.forEach((input, k) => {
        if (made[name]?.[k] === SPECIFICATION_LIMITS[name][k]) showText(input, "");
      });
    }
    fields.cellSizes.element.hidden = size.kind === "cell_size";
    write(fields.leastBeamWidth, leastBeamWidth, false);
    fields.leastBeamWidth.element.hidden = size.kind === "beam_width";
    summary.textContent = specificationWords(made);
    showFault(null);
  }

  let drawn: Specification | null = null;
  let region = 0;
  session.state.watch(({ made, regionAt }) => {
    // Fields are not overwritten when other parts of the state change, so that unfinished input stays.
    if (made === drawn && regionAt === region) return;
    [drawn, region] = [made, regionAt];
    show(made);
  });
  return element;
}

/** A summary for the closed card. */
function specificationWords({ youngsModulus, materials, orientation, size, relativeDensity, leastBeamWidth, cellSizes }: Specification): string {
  const words = (value: number | Range, unit: string, write = digits) => `${isRange(value) ? value.map((one) => write(one)).join(" to ") : write(value)}${unit}`;
  return [
    materials.length > 0 ? `${materials.length} material${materials.length === 1 ? "" : "s"}` : words(youngsModulus, " MPa", modulusWords),
    words(orientation, "°"),
    `${size.kind === "beam_width" ? "beams" : "cells"} of ${digits(size.value)} mm`,
    relativeDensity || leastBeamWidth !== null || cellSizes ? "limits" : "",
  ].filter((part) => part !== "").join(", ");
}
