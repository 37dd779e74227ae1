// The card of a relaxation: termination, convergence plot, legends, facts, files and bill.
import { announce } from "../base/announce";
import { costTables, effectTable } from "../base/bill_tables";
import { button, Select, Slider } from "../base/controls";
import { ConvergencePlot } from "../base/convergence_plot";
import { h, replace } from "../base/dom";
import { download } from "../base/download";
import { EffectChips } from "../base/effect_chips";
import { chipsOf, outdated } from "../base/effect_words";
import { digits, seconds } from "../base/format";
import { savePng } from "../base/png_file";
import { svgOf } from "../base/svg_file";
import { table } from "../base/tables";
import type { EmbeddedSystem } from "../contract/types";
import { hostFacts, hostLegend } from "./host_legend";
import { frameAt } from "./network_frames";
import type { FileKind, NetworkSession, RelaxationRun } from "./network_session";
import type { ColourBy, NetworkView, StretchRange, TriangleColourBy } from "./network_view";
import { GRADIENT_WORDS, notesOf, vertexWords } from "./relaxation_words";
import { cssGradient, type Range, type Rgb, SPRING_RAMP } from "./spring_colours";
import { RAMP } from "./surface_material";

export const TERMINATION_SENTENCES: Record<EmbeddedSystem["stopped"], string> = {
  converged: "The network is at rest: the gradient is below the tolerance.",
  cut_locus: "No step lowers the energy any more: a compressed spring, or a side of a triangle that pushes, is where two paths are equally short.",
  step_too_small: "The network is at rest as far as rounding allows: no step lowers the energy any more.",
  iteration_limit: "The limit of iterations came first: the network is not at rest yet.",
  deadline: "The time was up: this is the best state until then, and the network is not at rest yet.",
  memory: "The memory was used up: this is the best state until then, and the network is not at rest yet.",
};

/** Ends of a relaxation from which another one goes on. */
const RESUMABLE: ReadonlySet<EmbeddedSystem["stopped"]> = new Set(["iteration_limit", "deadline", "memory"]);
/** Limit of the rows in the table of the history. */
const MAX_ROWS = 60;
/** Limit of the points of a network and of the vertices of a host whose positions the server sends in the events of a job. */
const MAX_SHOWN = 5000;

const SPRING_COLOURS = [{ value: "energy", words: "Energy" }, { value: "length", words: "Length" }] as const;
const TRIANGLE_COLOURS = [{ value: "stretch", words: "Greater principal stretch" }, { value: "density", words: "Energy per area at rest" }] as const;

export function relaxationCard(network: NetworkSession, view: NetworkView): HTMLElement {
  const plot = new ConvergencePlot(GRADIENT_WORDS);
  const stage = h("div", { class: "convergence-stage" }, plot.element);
  new ResizeObserver(() => plot.resize(stage.clientWidth, stage.clientHeight)).observe(stage);
  const sentence = h("p", { class: "stop" });
  const stale = h("p", { class: "note", hidden: true }, "The network or how it is relaxed has changed since: relax it again.");
  const facts = h("dl", { class: "facts" });
  const notes = h("div", { class: "notes" });
  const slider = h("div");
  const chips = new EffectChips("What was computed of the network", (effect, value) => network.change(effect === "mollifier" ? { mollifier: value } : { keptStrips: value }));
  const colours = colourLegends(view);
  const resumeButton = button("Go on from here", () => void network.relax(true));
  const files = fileButtons(network, plot);
  const bill = h("details", { class: "more bill" }, h("summary", {}, "Effects, bill and history"));
  const side = h("div", { class: "relaxation-side" }, ...colours.elements, hostLegend(view), slider);
  const card = h("section", { class: "card relaxation", "aria-label": "Relaxation", hidden: true }, h("h2", {}, "Relaxation"), sentence, stale, notes, resumeButton,
    h("div", { class: "relaxation-body" }, stage, facts, side), chips.element, h("div", { class: "row" }, ...files), bill);

  function draw(): void {
    const relaxing = network.relaxing.get();
    if (!relaxing) return;
    const frame = view.frame.get();
    plot.update({
      steps: relaxing.steps.map(({ iteration, gradient }) => ({ count: iteration, value: gradient })),
      tolerance: relaxing.gradientTolerance,
      current: frame?.iteration ?? relaxing.steps.at(-1)?.iteration ?? null,
    });
    replace(facts, ...factsOf(relaxing, frame?.iteration ?? null, view.stretches.get()).flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
  }

  function showSlider({ frames, answer }: RelaxationRun): void {
    if (!answer || frames.length === 0 || answer.iterations === 0) return replace(slider);
    const states = new Slider({
      label: "Iteration that is seen",
      lower: 0,
      upper: answer.iterations,
      step: 1,
      digits: 0,
      changed: (value, done) => {
        const frame = frameAt(frames, answer.iterations, value);
        view.frame.set(frame);
        if (done) states.value = frame?.iteration ?? answer.iterations;
      },
    });
    states.value = answer.iterations;
    replace(slider, states.element);
  }

  network.relaxing.watch((relaxing) => {
    card.hidden = !relaxing;
    if (!relaxing) return;
    const { answer } = relaxing;
    colours.show(relaxing);
    sentence.textContent = answer ? TERMINATION_SENTENCES[answer.stopped] : runningSentence(relaxing, view.restVertices);
    replace(notes, ...(answer ? notesOf(answer) : []).map((words) => h("p", { class: "note" }, words)));
    for (const part of [...files, resumeButton]) part.disabled = !answer;
    resumeButton.hidden = !answer || !RESUMABLE.has(answer.stopped);
    bill.hidden = !answer;
    showSlider(relaxing);
    if (answer) {
      replace(bill, h("summary", {}, "Effects, bill and history"), restWords(answer), effectTable(answer.effects), ...costTables(answer.cost), historyTable(answer));
      announce([TERMINATION_SENTENCES[answer.stopped], ...factsOf(relaxing, null, view.stretches.get()).map(([term, value]) => `${term}: ${value}`)].join(" "));
    }
    draw();
  });
  view.frame.watch(draw);
  const showChips = () => {
    const { mollifier, keptStrips } = network.state.get();
    const answer = network.relaxing.get()?.answer;
    const known = answer ? chipsOf(answer.effects, { mollifier, kept_strips: keptStrips }) : [];
    chips.show(network.isStale ? outdated(known) : known);
  };
  for (const part of [network.state, network.network, network.relaxing]) {
    part.watch(() => {
      stale.hidden = !network.isStale;
      showChips();
    });
  }
  return card;
}

/** The colour scales of springs and triangles, with the choice of what they show. */
function colourLegends(view: NetworkView): { elements: HTMLElement[]; show: (relaxing: RelaxationRun) => void } {
  const springs = new Select<ColourBy>("Colour of the springs", SPRING_COLOURS, (value) => view.colourBy.set(value));
  const triangles = new Select<TriangleColourBy>("Colour of the triangles", TRIANGLE_COLOURS, (value) => view.triangleColourBy.set(value));
  const [springScale, triangleScale] = [legend(SPRING_RAMP), legend(RAMP)];
  const ofSprings = h("div", { class: "ramp-choice" }, springs.element, springScale.element);
  const ofTriangles = h("div", { class: "ramp-choice" }, triangles.element, triangleScale.element);
  view.colourBy.watch((value) => (springs.value = value));
  view.triangleColourBy.watch((value) => (triangles.value = value));
  view.range.watch((range) => springScale.show(range));
  view.triangleRange.watch((range) => triangleScale.show(range));
  return {
    elements: [ofTriangles, ofSprings],
    show({ network }) {
      ofTriangles.hidden = network.triangles.length === 0;
      ofSprings.hidden = network.pairs.length === 0 && !ofTriangles.hidden;
    },
  };
}

/** Buttons that save the network, the plot and the request. */
function fileButtons(network: NetworkSession, plot: ConvergencePlot): HTMLButtonElement[] {
  const file = (kind: FileKind) =>
    button(kind.toUpperCase(), () => void network.file(kind, (text) => download(`network.${kind}`, kind === "obj" ? "model/obj" : "application/xml", text)), {
      icon: "download",
      title: `Save the network as ${kind.toUpperCase()}`,
    });
  const saveRequest = (): void => {
    const relaxing = network.relaxing.get();
    if (relaxing) download("network-request.json", "application/json", `${JSON.stringify(relaxing.request, null, 2)}\n`);
  };
  return [
    file("obj"),
    file("vtu"),
    button("SVG", () => download("network-convergence.svg", "image/svg+xml", svgOf(plot.element)), { icon: "download", title: "Save the plot as SVG" }),
    button("PNG", () => void savePng(plot.element, "network-convergence.png"), { icon: "download", title: "Save the plot as PNG" }),
    button("Request", saveRequest, { icon: "download", title: "Save the request as JSON" }),
  ];
}

/** A colour scale with the smallest and the largest value at its ends. */
function legend(ramp: readonly Rgb[]): { element: HTMLElement; show: (range: Range) => void } {
  const bar = h("div", { class: "ramp", "aria-hidden": "true" });
  bar.style.background = cssGradient(ramp);
  const [min, max] = [h("span"), h("span")];
  return {
    element: h("div", {}, bar, h("div", { class: "ramp-words" }, min, max)),
    show(range) {
      min.textContent = digits(range.min, 3);
      max.textContent = digits(range.max, 3);
    },
  };
}

function runningSentence({ network, request }: RelaxationRun, vertices: number): string {
  if (network.points.length > MAX_SHOWN) return "The network is relaxing. It has too many points to be seen on its way.";
  if (request.host && vertices > MAX_SHOWN) return "The network is relaxing. The surface has too many vertices to be seen on its way.";
  return "The network is relaxing.";
}

function factsOf({ answer, steps, network }: RelaxationRun, iteration: number | null, stretches: StretchRange | null): [string, string][] {
  const step = iteration === null ? steps.at(-1) : steps.find((one) => one.iteration === iteration);
  const rows: [string, string][] = [
    ["Points", network.points.length.toLocaleString("en")],
    ...(network.pairs.length > 0 || network.triangles.length === 0 ? [["Springs", network.pairs.length.toLocaleString("en")] as [string, string]] : []),
    ...(network.triangles.length > 0 ? [["Triangles", network.triangles.length.toLocaleString("en")] as [string, string]] : []),
  ];
  if (step) {
    rows.push(["Energy", digits(step.energy, 5)], ["Gradient", digits(step.gradient, 2)], ["Iteration",
      answer ? `${step.iteration} of ${answer.iterations}` : String(step.iteration)]);
  }
  if (stretches) {
    const about = stretches.exact ? "" : "≈ ";
    rows.push(["Least stretch", about + digits(stretches.min, 4)], ["Greatest stretch", about + digits(stretches.max, 4)]);
  }
  if (!answer) return rows;
  if (network.pairs.length > 0 || network.triangles.length === 0) {
    const compressed = answer.springs.filter((spring) => spring.compressed).length;
    rows.push(["Under compression", compressed === 0 ? "none" : String(compressed)]);
  }
  if (iteration === null) rows.push(...hostFacts(answer));
  return [...rows, ["Time", seconds(answer.cost.seconds)]];
}

/** The sentence about points at rest on vertices, if there are some. */
function restWords(answer: EmbeddedSystem): HTMLElement | false {
  const words = vertexWords(answer);
  return words !== "" && h("p", { class: "muted" }, words);
}

/** A table of evenly selected iterations and the last one. */
function historyTable({ history }: EmbeddedSystem): HTMLElement {
  const every = Math.max(1, Math.ceil(history.length / MAX_ROWS));
  const rows = history.flatMap(({ energy, gradient_norm, step_length, regularization }, k) =>
    k % every === 0 || k === history.length - 1 ? [[String(k), digits(energy, 6), digits(gradient_norm, 3), digits(step_length, 3), digits(regularization, 2)]] : []
  );
  return table("History", ["Iteration", "Energy", "Gradient", "Step", "Regularization"], rows);
}
