// The legend of a deformed host: colour scale, switch to the shape at rest, and the facts of the host.
import { Checkbox, Select } from "../base/controls";
import { h } from "../base/dom";
import { digits } from "../base/format";
import type { EmbeddedSystem } from "../contract/types";
import { DEFORMATION_RAMP, type DeformationBy } from "./deformation";
import type { NetworkView } from "./network_view";
import { cssGradient } from "./spring_colours";

export function hostLegend(view: NetworkView): HTMLElement {
  const colours = new Select<DeformationBy>("Colour of the surface", [
    { value: "area", words: "Area over that at rest" },
    { value: "stretch", words: "Greater principal stretch" },
    { value: "none", words: "Plain" },
  ], (value) => view.deformationBy.set(value));
  const bar = h("div", { class: "ramp", "aria-hidden": "true" });
  bar.style.background = cssGradient(DEFORMATION_RAMP);
  const [min, max] = [h("span"), h("span")];
  const scale = h("div", {}, bar, h("div", { class: "ramp-words" }, min, h("span", {}, "1"), max));
  const atRest = new Checkbox("Show the shape at rest", (value) => view.atRest.set(value));
  const element = h("div", { class: "ramp-choice host-legend", hidden: true }, colours.element, scale, atRest.element);
  view.atRest.watch((value) => (atRest.value = value));
  view.deformationBy.watch((value) => {
    colours.value = value;
    scale.hidden = value === "none";
  });
  view.deformation.watch((factor) => {
    min.textContent = digits(1 / factor, 4);
    max.textContent = digits(factor, 4);
  });
  view.host.watch((host) => (element.hidden = !host));
  return element;
}

const TERM_WORDS: Record<string, string> = {
  geodesic_springs: "Energy of springs",
  euclidean_springs: "Energy of springs",
  membrane: "Energy of the membrane",
  shell_membrane: "Energy of stretching the shell",
  shell_bending: "Energy of bending the shell",
  shell_volume: "Energy of the volume",
  solid: "Energy of the solid",
  gravity: "Energy of gravity",
};

/** The facts of a deformed host; none for a rigid one. */
export function hostFacts({ host, terms }: Pick<EmbeddedSystem, "host" | "terms">): [string, string][] {
  if (!host) return [];
  const rows = terms.map(({ name, energy }): [string, string] => [TERM_WORDS[name] ?? name.replace(/_/g, " "), digits(energy, 4)]);
  rows.push(["Largest displacement", digits(host.largest_displacement, 4)]);
  if (host.volume_ratio !== undefined) rows.push(["Volume over that at rest", digits(host.volume_ratio, 4)]);
  if (host.tetrahedra !== undefined) rows.push(["Tetrahedra", host.tetrahedra.toLocaleString("en")]);
  if (host.stops) rows.push(["Equilibria lost on the way", String(host.stops.reduce((sum, stop) => sum + stop.jumps, 0))]);
  return rows;
}
