// The card with material, orientation, size and limits of the structure. Values are given, or the search chooses them from a range.
import { Segments, Select } from "../base/controls";
import { h } from "../base/dom";
import { digits } from "../base/format";
import { DEFAULT_SPECIFICATION, type Fault, faultOf, isRange, searchesModulus, type Specification, SPECIFICATION_LIMITS, modulusOf, modulusWords, orientationOf, PRESETS,
  type Range, sameSpecification, withFoundValues, type Size } from "./specification";
import { MaterialList } from "./material_list";
import type { DesignSession } from "./session";
import type { DesignState } from "./state";
import { SpecificationFields } from "./specification_fields";

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

function findBox(what: string, changed: (find: boolean) => void): { element: HTMLElement; input: HTMLInputElement } {
  const input = h("input", { type: "checkbox", onchange: () => changed(input.checked) });
  return { input, element: h("label", { class: "checkbox" }, input, h("span", {}, "Find it", h("span", { class: "visually-hidden" }, `: ${what}`))) };
}

/** A number rounded to a few digits, as a user would write it. */
function rounded(value: number): number {
  return Number(value.toPrecision(DIGITS));
}

/** The change that an entry of the list of materials makes; null if it only leads to the fields. */
function withMaterial(entry: string, { made, found }: DesignState): Partial<Specification> | null {
  if (entry === SEVERAL) return { materials: PRESETS };
  // Values of one's own begin with those that were found.
  if (entry === OWN && made.materials.length === 0) return null;
  const { youngsModulus, density } = entry === OWN ? withFoundValues(made, found ?? {}) : (PRESETS.find(({ name }) => name === entry) ?? DEFAULT_SPECIFICATION);
  return { youngsModulus, density, materials: [] };
}

/** A modulus, or its range if the search is to find it. */
function withModulus(find: boolean, { made, found }: DesignState): number | Range {
  const value = modulusOf(made, found);
  const [min, max] = SPECIFICATION_LIMITS.youngsModulus;
  return find ? [Math.max(min, rounded(value / MODULUS_FACTOR)), Math.min(max, rounded(value * MODULUS_FACTOR))] : rounded(value);
}

export function specificationCard(session: DesignSession): HTMLElement {
  const summary = h("span", { class: "muted" });
  const preset = new Select<string>("Material", [
    { value: DATA, words: `Of the models’ data (${DEFAULT_SPECIFICATION.youngsModulus} MPa)` },
    ...PRESETS.map(({ name, youngsModulus, density }) => ({ value: name, words: `${name} (${youngsModulus} MPa, ${density} g/cm³)` })),
    { value: OWN, words: "Other values" },
    { value: SEVERAL, words: "Several: the search chooses" },
  ], (value) => choose(value));
  const findModulus = findBox("Young’s modulus", (find) => apply({ youngsModulus: withModulus(find, session.state.get()) }, true));
  const findOrientation = findBox("orientation", (find) => {
    const { made, found } = session.state.get();
    apply({ orientation: find ? HALF_TURN : rounded((orientationOf(made, found) * 180) / Math.PI) }, true);
  });
  const sizeKind = new Segments<Size["kind"]>("Size", [{ value: "beam_width", words: "Beam width" }, { value: "cell_size", words: "Cell size" }], (kind) => chooseSize(kind));
  const materials = new MaterialList((list) =>
    apply({ materials: list, ...(list.length === 0 && { youngsModulus: DEFAULT_SPECIFICATION.youngsModulus, density: DEFAULT_SPECIFICATION.density }) }, true)
  );
  const fields = new SpecificationFields((searched) => apply(fields.read(session.state.get().made), searched), findModulus.element, findOrientation.element);
  const element = h("details", { class: "card controls made", "aria-label": "Material and size" }, h("summary", {}, "Material and size ", summary), preset.element,
    h("p", { class: "muted" }, "Values of materials are typical ones: those of a print differ, so measure yours."), materials.element, fields.element("youngsModulus"),
    fields.element("density"), fields.element("orientation"), sizeKind.element, fields.element("size"),
    h("fieldset", { class: "made-limits" }, h("legend", {}, "Limits"), h("p", { class: "muted" }, "The search keeps to designs within them; an empty field is no limit."),
      fields.element("relativeDensity"), fields.element("leastBeamWidth"), fields.element("cellSizes")));

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

  function showFault(fault: Fault | null): void {
    materials.showFault(fault);
    fields.showFault(fault);
  }

  function choose(value: string): void {
    const change = withMaterial(value, session.state.get());
    if (change) apply(change, value === SEVERAL);
    if (value === OWN) fields.focus("youngsModulus");
  }

  function chooseSize(kind: Size["kind"]): void {
    const measures = session.results.shown.get()?.measures;
    const value = kind === "beam_width" ? (measures?.beamWidth ?? DEFAULT_SPECIFICATION.size.value) : (measures?.cellSize ?? FIRST_CELL_SIZE);
    apply({ size: { kind, value: rounded(value) }, ...(kind === "beam_width" ? { leastBeamWidth: null } : { cellSizes: null }) }, true);
  }

  function show(made: Specification): void {
    const { youngsModulus, density, orientation, size } = made;
    const several = made.materials.length > 0;
    const known = [{ name: DATA, ...DEFAULT_SPECIFICATION }, ...PRESETS].find((one) => one.youngsModulus === youngsModulus && one.density === density);
    preset.value = several ? SEVERAL : (known?.name ?? OWN);
    materials.show(made.materials);
    materials.element.hidden = !several;
    findModulus.input.checked = isRange(youngsModulus);
    findOrientation.input.checked = isRange(orientation);
    sizeKind.value = size.kind;
    fields.show(made);
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
