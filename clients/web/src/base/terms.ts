// Terms of the field, each with a definition in a sentence or two, and the button that shows it where the term stands.
import { h, uniqueId } from "./dom";

interface Term {
  readonly name: string;
  readonly definition: string;
}

export const TERMS = {
  strain: { name: "Strain", definition: "How much longer the material becomes over its length: 0.1 is a tenth longer, −0.1 a tenth shorter." },
  stress: { name: "Stress", definition: "Force over the area on which it acts, in MPa (N/mm²). Here it is of the whole structure, holes included." },
  stiffness: { name: "Stiffness", definition: "How much the stress rises with the strain, in MPa. Here it depends on the direction of the load." },
  poisson: {
    name: "Poisson’s ratio",
    definition: "How much narrower something becomes while it is stretched: 0.3 is 3 % narrower at 10 % longer. Below 0 it becomes wider, which is called auxetic.",
  },
  youngs_modulus: { name: "Young’s modulus", definition: "The stiffness of a material in small stretches: its stress over its strain. Rubber has 1 to 30 MPa, PLA 3500 MPa." },
  error_bar: {
    name: "Error bar",
    definition: "The neural model’s own estimate of its error: in nine of ten cases, a simulation lies within it. Where it is wide, simulate before you trust the curve.",
  },
  relative_density: { name: "Relative density", definition: "The fraction of the area that is material; the rest are holes. Lower is lighter and softer." },
  cell_size: { name: "Cell size", definition: "The length after which the pattern repeats, in mm. It grows with the width of the beams; the response does not depend on it." },
  beam_width: { name: "Beam width", definition: "The width of the walls between the holes, in mm. Take at least the width of a line of your printer’s nozzle." },
  tiling: { name: "Tiling", definition: "A pattern of tiles that fills the plane. Its sides become the beams of the structure, and its tiles the holes." },
  family: {
    name: "Family",
    definition: "All tilings of one kind, such as IH01, the hexagons: the numbers are those of the list of isohedral tilings. Parameters choose one of them.",
  },
  isohedral: {
    name: "Isohedral type",
    definition: "One of 81 ways in which copies of one tile fill the plane so that symmetries carry each of them to each other one.",
  },
  atlas: {
    name: "Atlas",
    definition: "What a family can do at rest: the stiffness of tilings all over its bounds, and where there are crossings or narrow places.",
  },
  homogenization: {
    name: "Homogenization",
    definition: "The stiffness of a pattern as if it were one sheet: one cell is computed that repeats without end, so that borders have no influence.",
  },
  simulation: {
    name: "Simulation",
    definition: "A computation of the structure itself, by finite elements with contact. It is slower than the neural model, and what is true where they differ.",
  },
  buckling: { name: "Buckling", definition: "Beams under compression that give way sideways. The stress then stays or falls while the strain grows." },
  geodesic: { name: "Geodesic", definition: "The shortest path between two points that stays on the surface." },
  equilibrium: { name: "Equilibrium", definition: "The shape in which all forces cancel, so that nothing moves any more." },
} as const satisfies Record<string, Term>;

export type TermName = keyof typeof TERMS;

/** What the button for some terms asks, as in "What is meant by “Stress” and “Stiffness”?" */
export function termQuestion(names: readonly TermName[]): string {
  const quoted = names.map((name) => `“${TERMS[name].name}”`);
  const last = quoted.at(-1) ?? "";
  return `What is meant by ${quoted.length > 1 ? `${quoted.slice(0, -1).join(", ")} and ${last}` : last}?`;
}

/** A button that shows the definitions of terms, and the definitions. Escape, a press elsewhere and a second press close it. */
export function termHint(names: readonly TermName[]): HTMLElement {
  const definitions = names.map((name) => h("span", { class: "term-definition" }, h("strong", {}, `${TERMS[name].name}. `), TERMS[name].definition));
  const note = h("span", { class: "term-note", id: uniqueId("term"), role: "note", popover: "auto" }, ...definitions);
  const title = names.map((name) => TERMS[name].definition).join("\n");
  const open = h("button", { type: "button", class: "term-hint", "aria-label": termQuestion(names), title, popovertarget: note.id }, "?");
  return h("span", { class: "term" }, open, note);
}

/** Adds the definitions of terms to the label or the legend of a control, behind one button. */
export function withTerm<Control extends HTMLElement>(element: Control, ...names: TermName[]): Control {
  const hint = termHint(names);
  const legend = element.querySelector("legend");
  const label = element.querySelector("label");
  // Within the legend they would be part of the group's name.
  if (legend) legend.after(h("div", { class: "term-row" }, hint));
  else if (label) {
    const head = h("div", { class: "term-head" });
    label.replaceWith(head);
    head.append(label, hint);
  }
  return element;
}
