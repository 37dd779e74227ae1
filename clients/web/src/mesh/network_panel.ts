// The panel of the network: points, springs, membrane, fixed points, host, and the method of the relaxation.
import { AccuracyDial } from "../base/accuracy_dial";
import { button, type Choice, Segments, Select, Slider } from "../base/controls";
import { h } from "../base/dom";
import { touchWords } from "../base/touch_words";
import type { EffectSwitch } from "../contract/types";
import { hostControls } from "./host_panel";
import { listField } from "./list_field";
import { capabilityOf } from "./network";
import type { Nudge } from "./nudge_buttons";
import type { ClickMode, NetworkSession } from "./network_session";
import { type Elements, ELEMENTS, hasMembrane, hasSprings, type Method, METHODS, MODULUS_LIMITS, MOLLIFIER_LENGTHS, MAX_ITERATIONS, MAX_SEED, MAX_WEIGHT, type NetworkState,
  type PointSource, POISSON_LIMITS, radiusLimits, REST_SCALE_LIMITS, type SpringLength, type SpringSource, THICKNESS_LIMITS, TOLERANCES,
  withExistingPoints } from "./network_state";
import { readFixed, readSprings, writeFixed, writeSprings } from "./network_text";
import type { MeshSession } from "./session";
import { shrinkingNote } from "./shrinking_note";

const POINT_WORDS: Record<PointSource, string> = { poisson_disk: "Random, evenly spread", per_face: "One in each face", picked: "Picked by hand" };
const SPRING_WORDS: Record<SpringSource, string> = {
  voronoi_dual: "Neighbours (Voronoi cells that meet)",
  adjacent_faces: "Across each edge of the mesh",
  drawn: "Drawn between points",
};
const ELEMENT_WORDS: Record<Elements, string> = { springs: "Springs", membrane: "Membrane", both: "Both" };
const METHOD_WORDS: Record<Method, string> = { newton: "Newton, exact Hessians", lbfgs: "L-BFGS", gradient_descent: "Gradient descent" };
const CLICK_WORDS: Record<ClickMode, string> = { add: "Adds", join: "Joins", fix: "Fixes" };
const SWITCHES: readonly Choice<EffectSwitch>[] = [{ value: "automatic", words: "Automatic" }, { value: "on", words: "On" }, { value: "off", words: "Off" }];

const chooseFrom = <Value extends string>(words: Record<Value, string>, values: readonly Value[]): Choice<Value>[] => values.map((value) => ({ value, words: words[value] }));
const powerChoices = (values: readonly number[]): Choice<string>[] =>
  values.map((value) => ({
    value: String(value),
    words: value < 0.01 ? `10${value.toExponential().replace(/^1e-(\d+)$/, (_, digits: string) => `⁻${[...digits].map((digit) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[Number(digit)]).join("")}`)}`
      : String(value),
  }));

export function networkPanel(mesh: MeshSession, network: NetworkSession, nudge: Nudge): HTMLElement {
  const element = h("section", { class: "card controls", "aria-label": "Network" }, pointControls(mesh, network), elementControls(network), springControls(mesh, network),
    membraneControls(network), fixedField(network), hostControls(mesh, network, nudge), accuracyControls(network), shrinkingNote(network), actions(mesh, network));
  mesh.tool.watch((tool) => (element.hidden = tool !== "network"));
  return element;
}

function pointControls(mesh: MeshSession, network: NetworkSession): HTMLElement {
  const source = new Select<PointSource>("Points", chooseFrom(POINT_WORDS, ["poisson_disk", "per_face", "picked"]), (points) => network.change({ points }));
  const radius = new Slider({
    label: "Least distance of two points",
    lower: 0.01,
    upper: 1,
    digits: 4,
    changed: (value, done) => done && network.change({ radius: value }),
  });
  const seed = new Slider({ label: "Seed", lower: 0, upper: MAX_SEED, step: 1, digits: 0, changed: (value, done) => done && network.change({ seed: Math.round(value) }) });
  const mode = new Segments<ClickMode>(touchWords("A click on the surface"), chooseFrom(CLICK_WORDS, ["add", "join", "fix"]), (value) => {
    network.mode.set(value);
    network.chosen.set(null);
  });
  const help = h("p", { class: "muted" });
  const updateHelp = () => {
    const { points, springs, elements } = network.state.get();
    const chosen = network.chosen.get();
    mode.element.hidden = points !== "picked";
    const picked: Record<ClickMode, string> = {
      add: "Adds a point of the network.",
      join: elements === "membrane" ? "A membrane has no springs to draw."
        : springs !== "drawn" ? "Springs are made, not drawn: choose “Drawn between points” to join them."
        : chosen === null ? "Choose a point, then the one that it is joined to; once more takes the spring away." : `Point ${chosen} is chosen: now the other one.`,
      fix: "Fixes a point, or lets it go.",
    };
    help.textContent = points === "picked" ? picked[network.mode.get()] : touchWords("Make the network, then click on points to fix them or let them go.");
  };
  mesh.mesh.watch((loaded) => loaded && radius.limit(...radiusLimits(loaded.info)));
  network.state.watch((state) => {
    source.value = state.points;
    radius.value = state.radius;
    seed.value = state.seed;
    radius.element.hidden = seed.element.hidden = state.points !== "poisson_disk";
    updateHelp();
  });
  network.mode.watch((value) => {
    mode.value = value;
    updateHelp();
  });
  network.chosen.watch(updateHelp);
  return h("div", { class: "parameters" }, source.element, radius.element, seed.element, mode.element, help);
}

function elementControls(network: NetworkSession): HTMLElement {
  const elements = new Segments<Elements>("Made of", chooseFrom(ELEMENT_WORDS, ELEMENTS), (value) => network.change({ elements: value }));
  network.state.watch((state) => (elements.value = state.elements));
  return elements.element;
}

function membraneControls(network: NetworkSession): HTMLElement {
  const slider = (label: string, [lower, upper]: readonly [number, number], digits: number, change: (value: number) => Partial<NetworkState>) =>
    new Slider({ label, lower, upper, digits, changed: (value, done) => done && network.change(change(value)) });
  const modulus = slider("Young’s modulus", MODULUS_LIMITS, 4, (youngsModulus) => ({ youngsModulus }));
  const poisson = slider("Poisson’s ratio", POISSON_LIMITS, 4, (poissonRatio) => ({ poissonRatio }));
  const thickness = slider("Thickness", THICKNESS_LIMITS, 4, (value) => ({ thickness: value }));
  const scale = slider("Rest scale", REST_SCALE_LIMITS, 4, (restScale) => ({ restScale }));
  const help = h("p", { class: "muted" },
    "Triangles of points whose Voronoi cells meet. They are at rest where they start, or on lengths that the rest scale makes longer or shorter: below 1 they are stretched.");
  const element = h("div", { class: "parameters" }, help, scale.element, modulus.element, poisson.element, thickness.element);
  network.state.watch((state) => {
    element.hidden = !hasMembrane(state);
    modulus.value = state.youngsModulus;
    poisson.value = state.poissonRatio;
    thickness.value = state.thickness;
    scale.value = state.restScale;
  });
  return element;
}

function springControls(mesh: MeshSession, network: NetworkSession): HTMLElement {
  const source = new Select<SpringSource>("Springs", [], (springs) => network.change({ springs }));
  const drawn = listField<NetworkState["drawn"]>("Springs between points", "0-1, 1-2:0.5:3",
    "Write two points as 0-1, and if need be rest length and weight: 0-1:0.5:3. Points are numbered from 0.", readSprings, (springs) => {
    const state = withExistingPoints({ ...network.state.get(), drawn: springs }, mesh.points.get().length);
    if (state.drawn.length < springs.length) return false;
    network.change({ drawn: springs });
    return true;
  });
  const rest = new Slider({ label: "Rest length", lower: 0, upper: 1, digits: 5, changed: (value, done) => done && network.change({ restLength: value }) });
  const weight = new Slider({ label: "Weight", lower: 0, upper: MAX_WEIGHT, digits: 4, changed: (value, done) => done && network.change({ weight: value }) });
  mesh.mesh.watch((loaded) => loaded && rest.limit(0, Number((loaded.info.bounding_box.diagonal / 2).toPrecision(2))));
  network.state.watch((state) => {
    source.setChoices(chooseFrom(SPRING_WORDS, state.points === "picked" ? ["drawn", "voronoi_dual", "adjacent_faces"] : ["voronoi_dual", "adjacent_faces"]));
    source.value = state.springs;
    drawn.element.hidden = state.springs !== "drawn";
    drawn.set(writeSprings(state.drawn));
    rest.value = state.restLength;
    weight.value = state.weight;
  });
  const element = h("div", { class: "parameters" }, source.element, drawn.element, rest.element, weight.element);
  network.state.watch((state) => (element.hidden = !hasSprings(state)));
  return element;
}

function fixedField(network: NetworkSession): HTMLElement {
  const field = listField<readonly number[]>("Fixed points", "none", "Write numbers of points of this network, from 0, between commas.", readFixed, (fixed) => {
    const count = network.network.get()?.points.length ?? Infinity;
    if (fixed.some((point) => point >= count)) return false;
    network.change({ fixed });
    return true;
  });
  network.state.watch((state) => field.set(writeFixed(state.fixed)));
  return field.element;
}

const SPRING_LENGTHS = [{ value: "geodesic", words: "Of the shortest path on the surface" }, { value: "euclidean", words: "Straight through space" }] as const;

function accuracyControls(network: NetworkSession): HTMLElement {
  const method = new Select<Method>("Method", chooseFrom(METHOD_WORDS, METHODS), (value) => network.change({ method: value }));
  const length = new Select<SpringLength>("Length of a spring", SPRING_LENGTHS, (value) => network.change({ springLength: value }));
  const tolerance = new Select<string>("Tolerance of the gradient", powerChoices(TOLERANCES), (value) => changeOwn({ tolerance: Number(value) }));
  const iterations = new Slider({
    label: "Most iterations",
    lower: 1,
    upper: MAX_ITERATIONS,
    step: 1,
    digits: 0,
    changed: (value, done) => done && network.change({ maxIterations: Math.round(value) }),
  });
  const mollifier = new Select<EffectSwitch>("Smoothing next to vertices (mollifier)", SWITCHES, (value) => network.change({ mollifier: value }));
  const mollifierLength = new Select<string>("Its length, in shares of an edge", powerChoices(MOLLIFIER_LENGTHS), (value) => changeOwn({ mollifierLength: Number(value) }));
  const strips = new Select<EffectSwitch>("Paths unfolded from the iteration before (kept strips)", SWITCHES, (value) => network.change({ keptStrips: value }));
  const dial = new AccuracyDial({
    place: "network",
    capabilities: () => [capabilityOf(network.state.get())],
    measures: network.measures,
    choose: (level) => network.change({ accuracy: { ...network.state.get().accuracy, level } }),
    own: {
      words: "Own values: accuracy, method and effects",
      controls: [method, length, tolerance, iterations, mollifier, mollifierLength, strips].map(({ element }) => element),
    },
  });
  const setOffered = (list: Select<string>, values: readonly number[], value: number) => {
    list.setChoices(powerChoices([...new Set([...values, value])]));
    list.value = String(value);
  };
  network.state.watch((state) => {
    method.value = state.method;
    length.value = state.springLength;
    length.element.hidden = hasMembrane(state);
    setOffered(tolerance, TOLERANCES, state.tolerance);
    iterations.value = state.maxIterations;
    mollifier.value = state.mollifier;
    setOffered(mollifierLength, MOLLIFIER_LENGTHS, state.mollifierLength);
    mollifierLength.element.hidden = state.mollifier === "off";
    strips.value = state.keptStrips;
    dial.value = state.accuracy.level;
  });
  function changeOwn(own: Partial<NetworkState>): void {
    network.change({ ...own, accuracy: { ...network.state.get().accuracy, level: "own" } });
  }
  return dial.element;
}

function actions(mesh: MeshSession, network: NetworkSession): HTMLElement {
  const make = button("Make the network", () => void network.make());
  const relax = button("Relax", () => void network.relax(), { kind: "primary" });
  const show = () => {
    const { points } = network.state.get();
    const ready = mesh.mesh.get() !== null && (points !== "picked" || mesh.points.get().length > 0);
    make.disabled = !ready || network.isMade;
    relax.disabled = !ready;
  };
  for (const part of [mesh.mesh, mesh.points, network.state, network.network]) part.watch(show);
  return h("div", { class: "row" }, relax, make);
}
