// The picture of a part that was made, and its facts.
import { h, replace, svg } from "../base/dom";
import { digits } from "../base/format";
import type { PartAnswer } from "../contract/types";
import type { Part, PartState } from "./part";
import { axisArrow } from "./part_load";
import { pathOf, type Sketch } from "./part_sketch";

/** Why the part cannot be made, or the server's message about it. */
function noteOf(state: PartState): string {
  if (state.kind === "failed") return state.sentence;
  return state.kind === "made" ? state.answer.message : "";
}

/** The narrowest wall, and how many narrower places the server has widened or cut. */
function wallWords({ smallest_neck, smallest_wall, widened_necks, cut_necks }: PartAnswer["checks"]): string {
  const narrowest = `at least ${digits(smallest_neck ?? smallest_wall, 2)} mm`;
  const done = [widened_necks > 0 ? `${widened_necks} widened` : "", cut_necks > 0 ? `${cut_necks} cut` : ""].filter((words) => words !== "");
  return done.length > 0 ? `${narrowest}; narrow places: ${done.join(", ")}` : narrowest;
}

function factsOf(answer: PartAnswer): [string, string][] {
  return [
    ["Size", `${answer.size.map((value) => digits(value)).join(" × ")} mm`],
    ["Mass", `${digits(answer.mass)} g`],
    ["Density", `${digits(100 * answer.relative_density)} % solid`],
    ["Walls", wallWords(answer.checks)],
    ...(answer.tested_direction === null ? [] : [["Load", `along the design’s ${digits((answer.tested_direction * 180) / Math.PI)}°`] as [string, string]]),
    ["Pieces", answer.checks.crumbs > 0 ? `one; ${answer.checks.crumbs} loose left out` : "one"],
  ];
}

/** Space around the sketch, as a fraction of its larger side. */
const MARGIN = 0.04;
/** Length of the arrow of the load, as a fraction of the smaller side. */
const ARROW_LENGTH = 0.6;

/** The picture of a part: its sketch at once, and over it the solid that the server has made. */
class PartPicture {
  private readonly outline = svg("path", { class: "outline", "fill-rule": "evenodd" });
  private readonly regions = svg("g", { class: "sketch-regions" });
  private readonly solid = svg("path", { class: "solid", "fill-rule": "evenodd" });
  private readonly ends = svg("path", { class: "ends" });
  private readonly faults = svg("path", { class: "faults" });
  private readonly halo = svg("path", { class: "load-halo" });
  private readonly arrow = svg("path", { class: "load-arrow" });
  readonly element = svg("svg", { class: "part-drawing", role: "img", "aria-label": "The part" }, this.outline, this.regions, this.solid, this.ends, this.faults, this.halo,
    this.arrow);
  private centre: readonly [number, number] = [0, 0];
  private key = "";

  sketch(sketch: Sketch | null): void {
    const key = JSON.stringify(sketch);
    if (!sketch || key === this.key) return;
    this.key = key;
    this.mark([]);
    const { lower, upper, axis } = sketch;
    const [width, height] = [upper[0] - lower[0], upper[1] - lower[1]];
    const margin = MARGIN * Math.max(width, height);
    this.centre = [(lower[0] + upper[0]) / 2, (lower[1] + upper[1]) / 2];
    this.element.setAttribute("viewBox", [-width / 2 - margin, -height / 2 - margin, width + 2 * margin, height + 2 * margin].join(" "));
    this.outline.setAttribute("d", pathOf(sketch.outline, this.centre));
    this.ends.setAttribute("d", pathOf(sketch.ends, this.centre));
    replace(this.regions, ...sketch.regions.map(({ name, points }) => svg("path", { d: pathOf([points], this.centre) }, svg("title", {}, name))));
    const path = axis === null ? "" : axisArrow([0, 0], axis, ARROW_LENGTH * Math.min(width, height));
    for (const one of [this.halo, this.arrow]) one.setAttribute("d", path);
    // The solid that is shown belongs to another shape until the server has answered.
    this.solid.classList.add("outdated");
    this.name(`Sketch of the part, ${digits(width)} by ${digits(height)} mm`);
  }

  /** Draws the solid of an answer, whose picture has the middle of the solid as its origin. */
  made({ svg: text, lower, upper, size }: PartAnswer): void {
    const file = new DOMParser().parseFromString(text ?? "", "image/svg+xml");
    const [x, y] = [(lower[0] + upper[0]) / 2 - this.centre[0], (lower[1] + upper[1]) / 2 - this.centre[1]];
    this.solid.setAttribute("d", file.querySelector("path")?.getAttribute("d") ?? "");
    this.solid.setAttribute("transform", `translate(${x} ${-y})`);
    this.solid.classList.remove("outdated");
    this.name(`The part, ${size.map((value) => digits(value)).join(" by ")} mm`);
  }

  /** Marks curves that are at fault; none of them removes the marks. */
  mark(curves: Sketch["outline"]): void {
    this.faults.setAttribute("d", pathOf(curves, this.centre));
  }

  private name(words: string): void {
    this.element.setAttribute("aria-label", words);
  }
}

/** `element`: the picture with the facts. `sketch` draws the shape before it is made; `tell` shows a sentence above the picture. */
export function partResult(part: Part): { element: HTMLElement; sketch: (sketch: Sketch | null) => void; tell: (sentence: string) => void } {
  const picture = new PartPicture();
  const facts = h("dl", { class: "facts compact" });
  const note = h("p", { class: "note", role: "status" });
  part.state.watch((state) => {
    note.textContent = noteOf(state);
    picture.element.classList.toggle("old", state.kind === "failed");
    picture.mark(state.kind === "failed" ? state.curves : []);
    if (state.kind !== "made") return;
    const { answer } = state;
    picture.made(answer);
    replace(facts, ...factsOf(answer).flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
  });
  const tell = (sentence: string): void => {
    note.textContent = sentence;
  };
  return { element: h("div", { class: "part-result" }, note, picture.element, facts), sketch: (sketch) => picture.sketch(sketch), tell };
}
