// The card of a Voronoi diagram: counts, convergence of the optimization, statistics before and after, and files.
import { announce } from "../base/announce";
import { button, Select, Slider } from "../base/controls";
import { ConvergencePlot } from "../base/convergence_plot";
import { h, replace } from "../base/dom";
import { download } from "../base/download";
import { EffectChips } from "../base/effect_chips";
import { chipsOf } from "../base/effect_words";
import { digits, seconds } from "../base/format";
import { table } from "../base/tables";
import { inWords } from "../contract/places";
import type { VoronoiOptimization, VoronoiStatistics } from "../contract/types";
import { GRADIENT_WORDS } from "./relaxation_words";
import { cssGradient } from "./spring_colours";
import { RAMP } from "./surface_material";
import { statisticsRows } from "./voronoi_statistics";
import type { VoronoiFile, VoronoiSession } from "./voronoi_session";
import type { CellColourBy, VoronoiView } from "./voronoi_view";

export const VORONOI_TERMINATIONS: Record<VoronoiOptimization["stopped"], string> = {
  converged: "The sites are at rest: the gradient is below the tolerance.",
  step_too_small: "The sites are at rest: neither steps of all sites nor moves of single sites lower the energy by more than a thousandth.",
  iteration_limit: "The limit of iterations, or of passes over moves of single sites, came first: the sites are not at rest yet.",
  deadline: "The time was up: these are the best sites until then, and they are not at rest yet.",
  memory: "The memory was used up: these are the best sites until then, and they are not at rest yet.",
};

const CELL_COLOURS = [{ value: "cells", words: "One for each" }, { value: "area", words: "By area" }, { value: "none", words: "None" }] as const;
const FILE_KINDS: readonly (readonly [VoronoiFile, string, string])[] = [
  ["obj", "model/obj", "Save borders and cells as OBJ"],
  ["vtu", "application/xml", "Save cells and borders as VTU"],
  ["svg", "image/svg+xml", "Save flat panels as SVG"],
  ["csv", "text/csv", "Save the panels’ lengths and angles as CSV"],
];

export function voronoiCard(voronoi: VoronoiSession, view: VoronoiView): HTMLElement {
  const plot = new ConvergencePlot(GRADIENT_WORDS);
  const stage = h("div", { class: "convergence-stage" }, plot.element);
  new ResizeObserver(() => plot.resize(stage.clientWidth, stage.clientHeight)).observe(stage);
  const sentence = h("p", { class: "stop" });
  const facts = h("dl", { class: "facts" });
  const notes = h("div", { class: "notes" });
  const statistics = h("div");
  const chips = new EffectChips("What was computed of the diagram");
  const colours = new Select<CellColourBy>("Colour of the cells", CELL_COLOURS, (value) => view.colourBy.set(value));
  const bar = h("div", { class: "ramp", "aria-hidden": "true" });
  bar.style.background = cssGradient(RAMP);
  const [min, max] = [h("span"), h("span")];
  const scale = h("div", {}, bar, h("div", { class: "ramp-words" }, min, max));
  let panelScale = 100;
  const panels = new Slider({ label: "Millimetres for each unit, on panels", lower: 0.1, upper: 1000, digits: 3, changed: (value) => (panelScale = value) });
  panels.value = panelScale;
  const files = FILE_KINDS.map(([kind, type, title]) =>
    button(kind.toUpperCase(), () => void voronoi.file(kind, panelScale, (text) => download(`voronoi.${kind}`, type, text)), { icon: "download", title })
  );
  const side = h("div", { class: "relaxation-side" }, colours.element, scale, panels.element);
  const card = h("section", { class: "card relaxation voronoi", "aria-label": "Diagram", hidden: true }, h("h2", {}, "Diagram"), sentence, notes,
    h("div", { class: "relaxation-body" }, stage, facts, side), chips.element, statistics, h("div", { class: "row" }, ...files));

  function factsNow(): [string, string][] {
    const diagram = voronoi.result.get()?.diagram;
    const optimizing = voronoi.optimizing.get();
    const step = optimizing?.steps.at(-1);
    const moves = optimizing?.answer?.site_moves;
    return [
      ...(diagram
        ? [["Cells", diagram.cells.length.toLocaleString("en")], ["Edges", diagram.edges.length.toLocaleString("en")], ["Vertices",
          diagram.vertices.length.toLocaleString("en")]] as [string, string][] : []),
      ...(step ? [["Energy", digits(step.energy, 5)], ["Gradient", digits(step.gradient, 2)], ["Iteration", String(step.iteration)]] as [string, string][] : []),
      ...(moves ? [["Moves of single sites", `${moves.taken.toLocaleString("en")} of ${moves.tried.toLocaleString("en")} taken`]] as [string, string][] : []),
      ...(diagram && (!optimizing || optimizing.answer) ? [["Time", seconds(diagram.cost.seconds)]] as [string, string][] : []),
    ];
  }

  function draw(): void {
    const result = voronoi.result.get();
    const optimizing = voronoi.optimizing.get();
    card.hidden = !result;
    if (!result) return;
    const answer = optimizing?.answer ?? null;
    sentence.textContent = answer ? VORONOI_TERMINATIONS[answer.stopped] : optimizing ? "The sites are moving." : "";
    sentence.hidden = sentence.textContent === "";
    stage.hidden = !optimizing;
    if (optimizing) {
      const steps = optimizing.steps.map(({ iteration, gradient }) => ({ count: iteration, value: gradient }));
      plot.update({ steps, tolerance: answer?.accuracy.gradient_tolerance ?? 0, current: steps.at(-1)?.count ?? null });
    }
    replace(facts, ...factsNow().flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
    chips.show(chipsOf(result.diagram.effects, {}));
    replace(notes, ...result.diagram.warnings.map(inWords).map((words) => h("p", { class: "note" }, words)));
    if (result.now) replace(statistics, statisticsTable(result.before, result.now));
    for (const file of files) file.disabled = optimizing !== null && !answer;
  }
  for (const part of [voronoi.result, voronoi.optimizing]) part.watch(draw);
  voronoi.result.watch((result) => {
    if (!result?.now) return;
    const stopped = "stopped" in result.diagram ? VORONOI_TERMINATIONS[result.diagram.stopped] : "";
    announce([stopped, ...factsNow().map(([term, value]) => `${term}: ${value}.`)].join(" ").trim());
  });
  view.colourBy.watch((value) => {
    colours.value = value;
    scale.hidden = value !== "area";
  });
  view.range.watch((range) => {
    min.textContent = digits(range.min, 3);
    max.textContent = digits(range.max, 3);
  });
  return card;
}

function statisticsTable(before: VoronoiStatistics | null, now: VoronoiStatistics): HTMLElement {
  return table("Statistics", ["Quantity", "Mean", "Deviation", "Least", "Greatest"], statisticsRows(before, now));
}
