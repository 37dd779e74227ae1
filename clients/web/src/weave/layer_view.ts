// The view of a print layer by layer: a drawing, sliders for the layer and for its moves, and a description.
import { Checkbox, Segments, Slider } from "../base/controls";
import { h, replace } from "../base/dom";
import { digits } from "../base/format";
import { longWords } from "./print_facts";
import type { Plan } from "./print_session";
import { type Layer, STAGE_WORDS } from "./toolpath";
import { ToolpathDrawing } from "./toolpath_drawing";

type Extent = "part" | "bed";
const LEGEND: readonly (readonly [kind: string, words: string])[] = [
  ["strand", "On the bed"],
  ["lifted", "Lifted"],
  ["channel", "Channel"],
  ["support", "Frame"],
  ["priming", "Fills the nozzle"],
  ["travel", "Travel, nothing printed"],
];

export class LayerView {
  readonly element: HTMLElement;
  private readonly drawing = new ToolpathDrawing();
  private readonly words = h("p", { class: "layer-words", role: "status" });
  private readonly legend = h("ul", { class: "legend", "aria-label": "Legend of the toolpath" });
  private readonly layerSlider = new Slider({ label: "Layer", lower: 1, upper: 1, step: 1, digits: 0, changed: (value) => this.showLayer(Math.round(value) - 1) });
  private readonly moveSlider = new Slider({ label: "Moves of this layer", lower: 0, upper: 1, step: 1, digits: 0, changed: (value) => this.showMoves(Math.round(value)) });
  private readonly extent: Segments<Extent>;
  private readonly travels: Checkbox;
  private plan: Plan | null = null;
  private layer = 0;
  private moves = 0;
  /** Number of moves of the selected layer. */
  private count = 0;
  private whole = false;
  private withTravels = true;

  constructor() {
    this.extent = new Segments<Extent>("What is shown", [{ value: "part", words: "Part" }, { value: "bed", words: "Whole bed" }], (value) => {
      this.whole = value === "bed";
      this.draw();
    });
    this.travels = new Checkbox("Show travels", (value) => {
      this.withTravels = value;
      this.showLegend();
      this.draw();
    });
    this.extent.value = "part";
    this.travels.value = true;
    this.element = h("div", { class: "layer-view" }, h("div", { class: "layer-tools" }, this.extent.element, this.travels.element),
      h("div", { class: "print-stage dims" }, this.drawing.element), this.legend, h("div", { class: "layer-controls" }, this.layerSlider.element, this.moveSlider.element),
      this.words);
  }

  /** Shows a plan. The selected layer stays selected, if the new plan has as many; the first plan is shown completely. */
  show(plan: Plan | null): void {
    const isFirst = this.plan === null;
    this.plan = plan;
    if (!plan) return this.drawing.show(null);
    this.showLegend();
    const last = plan.layers.length - 1;
    const wasWhole = isFirst || this.moves >= this.count;
    this.layerSlider.limit(1, Math.max(1, last + 1));
    this.layerSlider.disabled = last < 1;
    this.showLayer(isFirst ? last : Math.min(this.layer, last), wasWhole ? Infinity : this.moves);
  }

  private get current(): Layer | undefined {
    return this.plan?.layers[this.layer];
  }

  private showLayer(layer: number, moves = Infinity): void {
    this.layer = Math.max(0, layer);
    const count = this.current?.moves.length ?? 0;
    this.count = count;
    this.layerSlider.value = this.layer + 1;
    this.moveSlider.limit(0, Math.max(1, count));
    this.moveSlider.disabled = count === 0;
    this.showMoves(Math.min(moves, count));
  }

  private showMoves(moves: number): void {
    this.moves = moves;
    this.moveSlider.value = moves;
    this.draw();
  }

  private draw(): void {
    const { plan, current } = this;
    if (!plan) return;
    const { bed, box } = boxesOf(plan);
    this.drawing.show({ layers: plan.layers, bed, box, layer: this.layer, moves: this.moves, travels: this.withTravels, whole: this.whole });
    const words = current ? this.sentence(current) : "Nothing is printed.";
    this.drawing.element.setAttribute("aria-label", `Toolpath from above. ${words}`);
    this.words.textContent = words;
  }

  private showLegend(): void {
    const kinds = new Set<string>(this.plan?.layers.flatMap((layer) => layer.moves.map((move) => move.kind)));
    if (!this.withTravels) kinds.delete("travel");
    replace(this.legend, ...LEGEND.filter(([kind]) => kinds.has(kind)).map(([kind, text]) => h("li", {}, h("span", { class: `move-key ${kind}`, "aria-hidden": "true" }), text)));
  }

  private sentence({ stage, lowest, highest, length, travels, moves }: Layer): string {
    const heights = highest > lowest ? `${digits(lowest)} to ${digits(highest)} mm` : `${digits(lowest)} mm`;
    const part = this.moves < moves.length ? `, of which ${this.moves} of ${moves.length} moves are shown` : "";
    const printed = `${longWords(length)} printed, ${travels} ${travels === 1 ? "travel" : "travels"}${part}`;
    return `Layer ${this.layer + 1} of ${this.plan?.layers.length ?? 0}: ${STAGE_WORDS[stage]}, nozzle at ${heights}; ${printed}.`;
  }
}

function boxesOf({ settings, toolpath: { statistics } }: Plan): { bed: [number, number]; box: [number, number, number, number] } {
  const bed: [number, number] = [Number(settings["/printer/bed/0"]), Number(settings["/printer/bed/1"])];
  const { lowest, highest } = statistics;
  return { bed, box: [lowest[0], lowest[1], highest[0], highest[1]] };
}
