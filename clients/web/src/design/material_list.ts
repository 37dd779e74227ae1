// The list of materials from which the search chooses one, each with a name, a modulus or a range of moduli, and a density.
import { button } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { showText } from "../base/writing";
import { DEFAULT_SPECIFICATION, type Fault, isRange, type Material, MAX_MATERIAL_NAME_LENGTH, MAX_MATERIALS, PRESETS } from "./specification";

interface Row {
  readonly element: HTMLElement;
  readonly name: HTMLInputElement;
  readonly min: HTMLInputElement;
  readonly max: HTMLInputElement;
  readonly density: HTMLInputElement;
}

export class MaterialList {
  readonly element: HTMLElement;
  private readonly list = h("ul", { class: "materials", "aria-label": "Materials to choose from" });
  private readonly problem = h("p", { class: "note problem", id: uniqueId("problem"), role: "alert", hidden: true });
  private readonly addOne = button("Add a material", () => this.add(), { icon: "plus" });
  private rows: readonly Row[] = [];

  constructor(private readonly changed: (materials: readonly Material[]) => void) {
    this.element = h("fieldset", { class: "made-limits" }, h("legend", {}, "Materials"),
      h("p", { class: "muted" }, "The search takes the one that serves the target best. Two moduli are a range within which it finds the best one."), this.list, this.problem,
      this.addOne);
  }

  show(materials: readonly Material[]): void {
    // Rows are rebuilt only if their number has changed, because new rows lose the focus.
    if (this.rows.length !== materials.length) this.build(materials.length);
    materials.forEach((material, k) => this.write(this.rows[k], material));
    this.addOne.disabled = materials.length >= MAX_MATERIALS;
  }

  showFault(fault: Fault | null): void {
    const isMine = fault?.field === "materials";
    this.problem.textContent = isMine ? fault.sentence : "";
    this.problem.hidden = !isMine;
    this.rows.forEach(({ name, min, max, density }, k) => {
      const at = isMine && fault.at === k ? fault.part : undefined;
      for (const [input, part] of [[name, "name"], [min, "youngsModulus"], [max, "youngsModulus"], [density, "density"]] as const) {
        if (part === at) input.setAttribute("aria-invalid", "true");
        else input.removeAttribute("aria-invalid");
      }
    });
  }

  private build(count: number): void {
    this.rows = Array.from({ length: count }, (_, k) => this.row(k));
    replace(this.list, ...this.rows.map(({ element }) => element));
  }

  private row(k: number): Row {
    const notify = (): void => this.changed(this.read());
    const number = (): HTMLInputElement => h("input", { type: "number", class: "number", step: "any", "aria-describedby": this.problem.id, onchange: notify });
    const name = h("input", {
      type: "text",
      class: "number text",
      maxlength: MAX_MATERIAL_NAME_LENGTH,
      "aria-label": `Name of material ${k + 1}`,
      "aria-describedby": this.problem.id,
      onchange: notify,
    });
    const [min, max, density] = [number(), number(), number()];
    const remove = button("", () => this.changed(this.read().filter((_, at) => at !== k)), { icon: "minus", kind: "quiet", title: `Remove material ${k + 1}` });
    const words = (text: string) => h("span", { class: "muted", "aria-hidden": "true" }, text);
    const element = h("li", {}, h("div", { class: "made-inputs" }, name, density, words("g/cm³"), remove), h("div", { class: "made-inputs" }, min, words("to"), max, words("MPa")));
    return { element, name, min, max, density };
  }

  private write({ name, min, max, density }: Row, material: Material): void {
    const { youngsModulus } = material;
    showText(name, material.name);
    showText(min, String(isRange(youngsModulus) ? youngsModulus[0] : youngsModulus));
    showText(max, isRange(youngsModulus) ? String(youngsModulus[1]) : "");
    showText(density, String(material.density));
    min.setAttribute("aria-label", `Young’s modulus of ${material.name}, MPa`);
    max.setAttribute("aria-label", `Young’s modulus of ${material.name} at most, MPa`);
    density.setAttribute("aria-label", `Density of ${material.name}, g/cm³`);
  }

  private read(): Material[] {
    const value = (input: HTMLInputElement): number => (input.value === "" ? NaN : Number(input.value));
    return this.rows.map(({ name, min, max, density }) => ({
      name: name.value.trim(),
      density: value(density),
      youngsModulus: max.value === "" && !max.validity.badInput ? value(min) : [value(min), value(max)],
    }));
  }

  private add(): void {
    const materials = this.read();
    const isFree = (name: string): boolean => !materials.some((one) => one.name === name);
    const { youngsModulus, density } = DEFAULT_SPECIFICATION;
    const names = materials.map((_, k) => `Material ${k + 1}`).concat(`Material ${materials.length + 1}`);
    const next = PRESETS.find(({ name }) => isFree(name)) ?? { name: names.find(isFree) ?? "", youngsModulus, density };
    this.changed([...materials, next]);
    this.rows[materials.length]?.name.focus();
  }
}
