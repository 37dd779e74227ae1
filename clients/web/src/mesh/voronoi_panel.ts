// The panel in which a Voronoi diagram is set up: its sites, its accuracy, and the objective that is minimized.
import { AccuracyDial } from "../base/accuracy_dial";
import { button, type Choice, Segments, Select, Slider } from "../base/controls";
import { digits, plain } from "../base/format";
import { h, uniqueId } from "../base/dom";
import { touchWords } from "../base/touch_words";
import { pointWords, readPoint } from "./link";
import { projectedOnto, readPlace } from "./point_in_space";
import { listField } from "./list_field";
import { type Nudge, nudgeButtons } from "./nudge_buttons";
import { readFixed, writeFixed } from "./network_text";
import type { MeshSession } from "./session";
import type { VoronoiSession } from "./voronoi_session";
import { BORDER_DEVIATIONS, type Exactness, type Minimizer, MAX_OBJECTIVE_WEIGHT, MAX_SITE_SEED, MAX_SITES, MAX_VORONOI_ITERATIONS, type Objective, OBJECTIVES, VORONOI_TOLERANCES,
  type VoronoiState } from "./voronoi_state";

const EXACTNESS_WORDS: Record<Exactness, string> = { exact: "Exact", bounded: "Within 1 %", edges: "Along edges" };
const OBJECTIVE_WORDS: Record<Objective, string> = {
  centroidal: "Sites at their cells’ centres",
  regularity: "Regular cells",
  equal_area: "Equal areas",
  edge_length: "Equal edges",
  planarity: "Flat panels",
};
const MINIMIZER_WORDS: Record<Minimizer, string> = { automatic: "by objective", gauss_newton: "Gauss–Newton", lbfgs: "L-BFGS" };

export function voronoiPanel(mesh: MeshSession, voronoi: VoronoiSession, nudge: Nudge): HTMLElement {
  const element = h("section", { class: "card controls", "aria-label": "Voronoi diagram" }, randomSites(mesh, voronoi), objectives(mesh, voronoi), actions(voronoi),
    siteControls(mesh, voronoi, nudge), accuracyControls(voronoi));
  mesh.tool.watch((tool) => (element.hidden = tool !== "voronoi"));
  return element;
}

function randomSites(mesh: MeshSession, voronoi: VoronoiSession): HTMLElement {
  const count = new Slider({
    label: "Random sites",
    lower: 1,
    upper: MAX_SITES,
    step: 1,
    digits: 0,
    changed: (value, done) => done && voronoi.change({ count: Math.round(value) }),
  });
  const seed = new Slider({ label: "Seed", lower: 0, upper: MAX_SITE_SEED, step: 1, digits: 0, changed: (value, done) => done && voronoi.change({ seed: Math.round(value) }) });
  const scatter = button("Scatter sites", () => void voronoi.scatter());
  mesh.mesh.watch((loaded) => (scatter.disabled = loaded === null));
  voronoi.state.watch((state) => {
    count.value = state.count;
    seed.value = state.seed;
  });
  return h("div", { class: "parameters" }, count.element, seed.element, scatter);
}

function siteControls(mesh: MeshSession, voronoi: VoronoiSession, nudge: Nudge): HTMLElement {
  const words = h("p", { class: "muted" });
  const chosen = new Slider({ label: "Chosen site", lower: 0, upper: 1, step: 1, digits: 0, changed: (value) => voronoi.chosen.set(Math.round(value)) });
  const where = h("p", { class: "muted" });
  const arrows = nudgeButtons("the chosen site", nudge);
  const withChosen = (act: (site: number) => void) => () => {
    const site = voronoi.chosen.get();
    if (site !== null) act(site);
  };
  const fixButton = button("Hold it", withChosen((site) => voronoi.toggleFixed(site)));
  const remove = button("Remove it", withChosen((site) => voronoi.remove(site)));
  const clear = button("Remove all sites", () => voronoi.clear(), { kind: "quiet" });
  const id = uniqueId("site");
  const entry = h("input", { class: "number", id, placeholder: "v120, 7:0.2,0.3,0.5 or @1,2,3" });
  const distanceNote = h("p", { class: "muted", role: "status", hidden: true });
  entry.addEventListener("input", () => entry.setCustomValidity(""));
  const form = h("form", {
    class: "point-form",
    onsubmit: (event: Event) => {
      event.preventDefault();
      const place = readPlace(entry.value);
      const shown = mesh.mesh.get();
      const placed = place && shown ? projectedOnto(shown.data, place) : null;
      const point = placed?.point ?? readPoint(entry.value);
      const info = shown?.info;
      const exists = point && info && ("vertex" in point ? point.vertex < info.vertices : point.face < info.faces);
      entry.setCustomValidity(exists ? "" : "Write v and a vertex’s number, or face:a,b,c, of this mesh, or @x,y,z for the point nearest to a place.");
      distanceNote.hidden = !placed;
      distanceNote.textContent = placed ? `The nearest point of the surface was added, ${digits(placed.distance, 4)} away from the place.` : "";
      if (exists) {
        voronoi.place(point);
        entry.value = "";
      } else entry.reportValidity();
    },
  }, h("label", { for: id }, "Add a site"), entry, h("button", { class: "button" }, "Add"), distanceNote);
  const fixedField = listField<readonly number[]>("Held sites", "none", "Write numbers of sites, from 0, between commas.", readFixed, (fixed) => {
    if (fixed.some((site) => site >= voronoi.sites.get().length)) return false;
    voronoi.change({ fixed });
    return true;
  });
  const chosenControls = h("div", { class: "parameters" }, where, h("div", { class: "row", role: "group", "aria-label": "Move the chosen site" }, ...arrows),
    h("div", { class: "row" }, fixButton, remove));
  const show = () => {
    const sites = voronoi.sites.get();
    const site = voronoi.chosen.get();
    const { fixed } = voronoi.state.get();
    words.textContent = sites.length === 0 ? touchWords("Scatter sites, or click on the surface to place one.")
      : touchWords(`${sites.length === 1 ? "1 site" : `${sites.length} sites`}. Drag one to move it; a click on the surface adds one.`);
    chosen.element.hidden = sites.length === 0;
    chosenControls.hidden = site === null || site >= sites.length;
    clear.hidden = fixedField.element.hidden = sites.length === 0;
    chosen.limit(0, Math.max(1, sites.length - 1));
    chosen.value = site ?? 0;
    if (site === null || site >= sites.length) return;
    where.textContent = `Site ${site}: ${pointWords(sites[site])}. Shift and an arrow key move it in the view, too.`;
    fixButton.querySelector("span")?.replaceChildren(fixed.includes(site) ? "Let it go" : "Hold it");
  };
  for (const part of [voronoi.sites, voronoi.chosen, voronoi.state]) part.watch(show);
  voronoi.state.watch((state) => fixedField.set(writeFixed(state.fixed)));
  return h("div", { class: "parameters" }, words, form, chosen.element, chosenControls, fixedField.element, clear);
}

function exactness(voronoi: VoronoiSession, change: (own: Partial<VoronoiState>) => void): HTMLElement {
  const choices = (Object.keys(EXACTNESS_WORDS) as Exactness[]).map((value): Choice<Exactness> => ({ value, words: EXACTNESS_WORDS[value] }));
  const segments = new Segments<Exactness>("Distances", choices, (value) => change({ exactness: value }));
  voronoi.state.watch((state) => (segments.value = state.exactness));
  return segments.element;
}

function objectives(mesh: MeshSession, voronoi: VoronoiSession): HTMLElement {
  const sliders = OBJECTIVES.map((name) =>
    new Slider({
      label: OBJECTIVE_WORDS[name],
      lower: 0,
      upper: MAX_OBJECTIVE_WEIGHT,
      digits: 3,
      changed: (value, done) => done && voronoi.change({ weights: { ...voronoi.state.get().weights, [name]: value } }),
    })
  );
  const target = new Slider({ label: "Length of edges (0: their mean)", lower: 0, upper: 1, digits: 5, changed: (value, done) => done && voronoi.change({ targetLength: value }) });
  mesh.mesh.watch((loaded) => loaded && target.limit(0, Number((loaded.info.bounding_box.diagonal / 2).toPrecision(2))));
  voronoi.state.watch((state) => {
    OBJECTIVES.forEach((name, k) => (sliders[k].value = state.weights[name]));
    target.element.hidden = state.weights.edge_length === 0;
    target.value = state.targetLength;
  });
  return h("fieldset", { class: "parameters objectives" }, h("legend", {}, "What is to be reached, by weight"), ...sliders.map((slider) => slider.element), target.element);
}

/** The dial of accuracy, with the method and the values of one's own. */
function accuracyControls(voronoi: VoronoiSession): HTMLElement {
  const changeOwn = (own: Partial<VoronoiState>): void => voronoi.change({ ...own, accuracy: { ...voronoi.state.get().accuracy, level: "own" } });
  const choices = (Object.keys(MINIMIZER_WORDS) as Minimizer[]).map((value): Choice<Minimizer> => ({ value, words: MINIMIZER_WORDS[value] }));
  const method = new Select<Minimizer>("Method", choices, (value) => voronoi.change({ minimizer: value }));
  const tolerance = new Select<string>("Tolerance of the gradient", [], (value) => changeOwn({ tolerance: Number(value) }));
  const iterations = new Slider({
    label: "Most iterations",
    lower: 1,
    upper: MAX_VORONOI_ITERATIONS,
    step: 1,
    digits: 0,
    changed: (value, done) => done && voronoi.change({ maxIterations: Math.round(value) }),
  });
  const deviation = new Select<string>("Borders are drawn to, in diagonals of the mesh", [], (value) => changeOwn({ deviation: Number(value) }));
  const dial = new AccuracyDial({
    place: "voronoi",
    capabilities: () => ["voronoi", ...(voronoi.optimizing.get() ? ["voronoi_optimizations" as const] : [])],
    measures: voronoi.measures,
    choose: (level) => voronoi.change({ accuracy: { ...voronoi.state.get().accuracy, level } }),
    own: {
      words: "Own values: method and accuracy",
      controls: [exactness(voronoi, changeOwn), method.element, tolerance.element, iterations.element, deviation.element],
    },
  });
  voronoi.optimizing.watch(() => dial.update());
  voronoi.state.watch((state) => {
    dial.value = state.accuracy.level;
    deviation.setChoices([...new Set([...BORDER_DEVIATIONS, state.deviation])].map((value) => ({ value: String(value), words: plain(value) })));
    deviation.value = String(state.deviation);
    method.value = state.minimizer;
    tolerance.setChoices([...new Set([...VORONOI_TOLERANCES, state.tolerance])].map((value) => ({ value: String(value), words: String(value) })));
    tolerance.value = String(state.tolerance);
    iterations.value = state.maxIterations;
  });
  return dial.element;
}

function actions(voronoi: VoronoiSession): HTMLElement {
  const optimize = button("Optimize", () => void voronoi.optimize(), { kind: "primary" });
  for (const part of [voronoi.sites, voronoi.state]) part.watch(() => (optimize.disabled = !voronoi.canOptimize));
  return h("div", { class: "row" }, optimize);
}
