// What the structure is made of, how it lies and how large it is: given, or left to the search between two values.
import { Segments, Select } from "../base/controls";
import { h, uniqueId } from "../base/dom";
import { digits } from "../base/format";
import { showText } from "../base/writing";
import { DEFAULT_MADE, type Fault, faultOf, isRange, leavesModulus, type Made, MADE_LIMITS, type MadeField, modulusOf, modulusWords, orientationOf, PRESETS, type Range, sameMade, settled, type Size } from "./made";
import { MaterialList } from "./material_list";
import type { DesignSession } from "./session";

/** Of a modulus that is left to the search, to begin with: on either side of the one that was given. */
const MODULUS_FACTOR = 2;
const HALF_TURN: Range = [0, 180];
/** Of cells before any design was measured, mm. */
const FIRST_CELL_SIZE = 5;
const DIGITS = 3;

const OWN = "own";
const SEVERAL = "several";
const DATA = "data";

/** A number, or two of them with the choice to leave the value to the search. */
interface Field {
  readonly element: HTMLElement;
  readonly inputs: readonly HTMLInputElement[];
  readonly problem: HTMLElement;
}

/** `least` and `most`: what a screen reader calls the two fields of a range. */
function fieldOf(label: string, changed: () => void, { most, choice }: { most?: string; choice?: HTMLElement } = {}): Field {
  const problem = h("p", { class: "note problem", id: uniqueId("problem"), role: "alert", hidden: true });
  const input = (name?: string) => h("input", { type: "number", id: uniqueId("made"), class: "number", step: "any", "aria-label": name, "aria-describedby": problem.id, onchange: changed });
  const inputs = [input(), ...(most === undefined ? [] : [input(most)])];
  const row = h("div", { class: "made-inputs" }, inputs[0], inputs[1] && h("span", { class: "muted", "aria-hidden": "true" }, "to"), inputs[1]);
  return { element: h("div", { class: "field" }, h("div", { class: "made-head" }, h("label", { for: inputs[0].id }, label), choice), row, problem), inputs, problem };
}

function findBox(what: string, changed: (find: boolean) => void): { element: HTMLElement; input: HTMLInputElement } {
  const input = h("input", { type: "checkbox", onchange: () => changed(input.checked) });
  return { input, element: h("label", { class: "checkbox" }, input, h("span", {}, "Find it", h("span", { class: "visually-hidden" }, `: ${what}`))) };
}

/** A number as a person writes it. */
function rounded(value: number): number {
  return Number(value.toPrecision(DIGITS));
}

/** As it was written, without the tail that 100 times a share may have. */
function inPercent(share: number): number {
  return Number((100 * share).toPrecision(12));
}

function numberIn(input: HTMLInputElement): number {
  return input.value === "" ? NaN : Number(input.value);
}

export function madeCard(session: DesignSession): HTMLElement {
  const summary = h("span", { class: "muted" });
  const preset = new Select<string>("Material", [
    { value: DATA, words: `Of the models’ data (${DEFAULT_MADE.youngsModulus} MPa)` },
    ...PRESETS.map(({ name, youngsModulus, density }) => ({ value: name, words: `${name} (${youngsModulus} MPa, ${density} g/cm³)` })),
    { value: OWN, words: "Other values" },
    { value: SEVERAL, words: "Several: the search chooses" },
  ], (value) => choose(value));
  const findModulus = findBox("Young’s modulus", (find) => {
    const { made, found } = session.state.get();
    const value = modulusOf(made, found);
    const [least, most] = MADE_LIMITS.youngsModulus;
    const range: Range = [Math.max(least, rounded(value / MODULUS_FACTOR)), Math.min(most, rounded(value * MODULUS_FACTOR))];
    apply({ youngsModulus: find ? range : rounded(value) }, true);
  });
  const findOrientation = findBox("orientation", (find) => {
    const { made, found } = session.state.get();
    apply({ orientation: find ? HALF_TURN : rounded((orientationOf(made, found) * 180) / Math.PI) }, true);
  });
  const sizeKind = new Segments<Size["kind"]>("Size", [{ value: "beam_width", words: "Beam width" }, { value: "cell_size", words: "Cell size" }], (kind) => chooseSize(kind));
  const materials = new MaterialList((list) => apply({ materials: list, ...(list.length === 0 && { youngsModulus: DEFAULT_MADE.youngsModulus, density: DEFAULT_MADE.density }) }, true));
  const fields: Record<Exclude<MadeField, "materials">, Field> = {
    youngsModulus: fieldOf("Young’s modulus, MPa", () => read(true), { most: "Young’s modulus at most, MPa", choice: findModulus.element }),
    density: fieldOf("Density of the material, g/cm³", () => read(false)),
    orientation: fieldOf("Orientation, °", () => read(true), { most: "Orientation at most, °", choice: findOrientation.element }),
    size: fieldOf("Beam width, mm", () => read(true)),
    relativeDensity: fieldOf("Relative density from, %", () => read(true), { most: "Relative density at most, %" }),
    leastBeamWidth: fieldOf("Beam width at least, mm", () => read(true)),
    cellSizes: fieldOf("Cell size from, mm", () => read(true), { most: "Cell size at most, mm" }),
  };
  const element = h("details", { class: "card controls made", "aria-label": "Material and size" },
    h("summary", {}, "Material and size ", summary),
    preset.element, h("p", { class: "muted" }, "Values of materials are typical ones: those of a print differ, so measure yours."),
    materials.element, fields.youngsModulus.element, fields.density.element, fields.orientation.element, sizeKind.element, fields.size.element,
    h("fieldset", { class: "made-limits" }, h("legend", {}, "Limits"), h("p", { class: "muted" }, "The search keeps to designs within them; an empty field is no limit."),
      fields.relativeDensity.element, fields.leastBeamWidth.element, fields.cellSizes.element));

  /** `searched`: the search has something else to find, also where parameters were set by hand. */
  function apply(change: Partial<Made>, searched: boolean): void {
    const before = session.state.get().made;
    const made = { ...before, ...change };
    const fault = faultOf(made);
    tell(fault);
    if (fault) return;
    if (sameMade(made, before)) return show(before);
    const asksForSearch = searched && (leavesModulus(made) || isRange(made.orientation) || made.relativeDensity !== null || made.leastBeamWidth !== null || made.cellSizes !== null);
    session.apply({ made, ...(asksForSearch && { byHand: false }) });
  }

  function choose(value: string): void {
    if (value === OWN) {
      // What was found is what to go on from.
      const { made, found } = session.state.get();
      const { youngsModulus, density } = settled(made, found ?? {});
      if (made.materials.length > 0) apply({ youngsModulus, density, materials: [] }, false);
      return fields.youngsModulus.inputs[0].focus();
    }
    if (value === SEVERAL) return apply({ materials: PRESETS }, true);
    const { youngsModulus, density } = PRESETS.find(({ name }) => name === value) ?? DEFAULT_MADE;
    apply({ youngsModulus, density, materials: [] }, false);
  }

  function chooseSize(kind: Size["kind"]): void {
    const measures = session.shown.get()?.measures;
    const value = kind === "beam_width" ? (measures?.beamWidth ?? DEFAULT_MADE.size.value) : (measures?.cellSize ?? FIRST_CELL_SIZE);
    apply({ size: { kind, value: rounded(value) }, ...(kind === "beam_width" ? { leastBeamWidth: null } : { cellSizes: null }) }, true);
  }

  /** What stands in the fields becomes what is wanted, unless something is at fault. */
  function read(searched: boolean): void {
    const { made } = session.state.get();
    const pair = ({ inputs: [least, most] }: Field): Range => [numberIn(least), numberIn(most)];
    // An empty field is no limit, and two of them are none at all.
    const isEmpty = (input: HTMLInputElement): boolean => input.value === "" && !input.validity.badInput;
    const limits = ({ inputs }: Field, [least, most]: Range, unit: number): Range | null => {
      if (inputs.every(isEmpty)) return null;
      const value = (input: HTMLInputElement, otherwise: number) => (isEmpty(input) ? otherwise : numberIn(input) / unit);
      return [value(inputs[0], least), value(inputs[1], most)];
    };
    const [thinnest] = fields.leastBeamWidth.inputs;
    apply({
      youngsModulus: isRange(made.youngsModulus) ? pair(fields.youngsModulus) : numberIn(fields.youngsModulus.inputs[0]),
      density: numberIn(fields.density.inputs[0]),
      orientation: isRange(made.orientation) ? pair(fields.orientation) : numberIn(fields.orientation.inputs[0]),
      size: { kind: made.size.kind, value: numberIn(fields.size.inputs[0]) },
      relativeDensity: limits(fields.relativeDensity, MADE_LIMITS.relativeDensity, 100),
      leastBeamWidth: made.size.kind === "beam_width" || isEmpty(thinnest) ? null : numberIn(thinnest),
      cellSizes: made.size.kind === "cell_size" ? null : limits(fields.cellSizes, MADE_LIMITS.cellSizes, 1),
    }, searched);
  }

  function tell(fault: Fault | null): void {
    materials.tell(fault);
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

  function show(made: Made): void {
    const { youngsModulus, density, orientation, size, relativeDensity, leastBeamWidth, cellSizes } = made;
    const several = made.materials.length > 0;
    const known = [{ name: DATA, ...DEFAULT_MADE }, ...PRESETS].find((one) => one.youngsModulus === youngsModulus && one.density === density);
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
    write(fields.relativeDensity, relativeDensity && [inPercent(relativeDensity[0]), inPercent(relativeDensity[1])], true);
    write(fields.cellSizes, cellSizes, true);
    for (const name of ["relativeDensity", "cellSizes"] as const) {
      fields[name].inputs.forEach((input, k) => {
        if (made[name]?.[k] === MADE_LIMITS[name][k]) showText(input, "");
      });
    }
    fields.cellSizes.element.hidden = size.kind === "cell_size";
    write(fields.leastBeamWidth, leastBeamWidth, false);
    fields.leastBeamWidth.element.hidden = size.kind === "beam_width";
    summary.textContent = madeWords(made);
    tell(null);
  }

  let drawn: Made | null = null;
  let region = 0;
  session.state.watch(({ made, regionAt }) => {
    // What is being written is kept while something else of the state changes.
    if (made === drawn && regionAt === region) return;
    [drawn, region] = [made, regionAt];
    show(made);
  });
  return element;
}

/** In a few words, for the card that is closed. */
function madeWords({ youngsModulus, materials, orientation, size, relativeDensity, leastBeamWidth, cellSizes }: Made): string {
  const words = (value: number | Range, unit: string, write = digits) => `${isRange(value) ? value.map((one) => write(one)).join(" to ") : write(value)}${unit}`;
  return [
    materials.length > 0 ? `${materials.length} material${materials.length === 1 ? "" : "s"}` : words(youngsModulus, " MPa", modulusWords), words(orientation, "°"), `${size.kind === "beam_width" ? "beams" : "cells"} of ${digits(size.value)} mm`,
    relativeDensity || leastBeamWidth !== null || cellSizes ? "limits" : "",
  ].filter((part) => part !== "").join(", ");
}
