// The card of the atlas: what the family can do at rest and what it adds to the others, as plots, sentences and tables.
import { announce } from "../base/announce";
import { button, Select } from "../base/controls";
import { h, replace, svg, writeText } from "../base/dom";
import { digits, percent } from "../base/format";
import { ProgressRow } from "../base/progress_row";
import { table } from "../base/tables";
import type { AtlasPlace, AtlasProfile, AtlasSample, FamilyAtlas } from "../contract/types";
import type { AtlasSession } from "./atlas_session";
import { GAIN_WORDS, gainOf, gainSentences, parameterQuantities, PLACE_WORDS, PLACES, profileWords, QUANTITIES, type Quantity } from "./atlas_words";
import { parameterName } from "./parameter_card";
import { ReachPlot } from "./reach_plot";
import { SamplePlot } from "./sample_plot";
import type { FamilySession } from "./session";

const MIN_HEIGHT = 260;

export function atlasCard(session: FamilySession, atlas: AtlasSession): HTMLElement {
  const status = h("div", { class: "status" });
  const progress = new ProgressRow("Progress of the atlas", () => atlas.cancel());
  const make = button("Make the atlas", () => void atlas.make(), { kind: "primary" });
  const stale = h("p", { class: "note", hidden: true }, "The family has changed since: make its atlas again.");
  const sentences = h("div", { class: "atlas-words" });
  const reach = new ReachPlot();
  const reachStage = h("div", { class: "reach-stage" }, reach.element);
  const body = h("div", { class: "atlas-body", hidden: true }, sentences, h("h3", {}, "Reference profiles"), reachLegend(), reachStage, h("h3", {}, "Samples"),
    samplePart(session, atlas));
  const tables = h("details", { class: "table", hidden: true }, h("summary", {}, "Values of the atlas as tables"));
  new ResizeObserver(() => reach.resize(Math.floor(reachStage.clientWidth))).observe(reachStage);

  session.redraws.follow([atlas.shown], () => {
    const shown = atlas.shown.get();
    body.hidden = tables.hidden = shown === null;
    if (!shown) return;
    reach.update(shown.atlas.profiles);
    replace(sentences, ...sentencesOf(shown.atlas).map((words) => h("p", {}, words)));
    replace(tables, h("summary", {}, "Values of the atlas as tables"), ...tablesOf(shown.atlas));
  });
  atlas.shown.watch((shown) => {
    if (shown) announce(gainSentences(shown.atlas).join(" "));
  });
  session.redraws.follow([session.state, session.families, atlas.shown], () => {
    stale.hidden = atlas.shown.get() === null || atlas.isCurrent;
    make.disabled = atlas.isCurrent || session.drawn.get() === null;
    body.classList.toggle("old", !atlas.isCurrent);
  });
  atlas.activity.watch((activity) => {
    if (activity.kind === "busy") return progress.show(status, activity.words, activity.progress);
    if (activity.kind !== "failed") return replace(status);
    announce(activity.sentence);
    replace(status, h("p", { class: "note" }, activity.sentence));
  });
  return h("section", { class: "card atlas", "aria-label": "Atlas" },
    h("div", { class: "atlas-head" },
      h("div", {}, h("h2", {}, "Atlas"),
        h("p", { class: "muted" }, "What the family can do at rest, before any network is trained, and what it adds to the others. It takes 5 to 30 seconds.")), make), status,
    stale, body, tables);
}

function sentencesOf(atlas: FamilyAtlas): string[] {
  const { mesh_error: error, stopped, places } = atlas;
  const avoided = PLACES.filter((place) => place !== "good" && places[place] > 0).map((place) => `${places[place]} × ${PLACE_WORDS[place]}`);
  return [
    ...gainSentences(atlas),
    `${percent(atlas.good_fraction)} of ${atlas.samples.length} tilings between the bounds are good${avoided.length > 0 ? `; of the others: ${avoided.join(", ")}` : ""}.`,
    ...(error ? [`The mesh errs by ${percent(error.median)} at the median, ${percent(error.largest)} at most.`] : []),
    ...(stopped === "none" ? [] : [stopped === "deadline" ? "The time was up before all of them were solved." : "The memory was used up before all of them were solved."]),
  ];
}

function keyEntry(kind: string, words: string): HTMLElement {
  return h("li", {}, svg("svg", { viewBox: "0 0 12 12", class: "sample-key", "aria-hidden": "true" }, svg("circle", { class: kind, cx: 6, cy: 6, r: 4.5 })), words);
}

function reachLegend(): HTMLElement {
  return h("ul", { class: "legend", "aria-label": "Legend of the reference profiles" }, keyEntry("reach-own", "This family"), keyEntry("reach-other", "The nearest of the others"),
    h("li", {}, h("span", { class: "met-key", "aria-hidden": "true" }), "Met: at most 2 % off"));
}

/** The samples by two quantities that can be chosen. */
function samplePart(session: FamilySession, atlas: AtlasSession): HTMLElement {
  const plot = new SamplePlot((index) => atlas.choose(index));
  const stage = h("div", { class: "sample-stage" }, plot.element);
  const legend = h("ul", { class: "legend", "aria-label": "Legend of the samples" });
  const chosen = h("p", { class: "reading" });
  let axes: readonly [string, string] = ["poisson-low", "anisotropy"];
  const select = (label: string, axis: 0 | 1) =>
    new Select<string>(label, [], (id) => {
      axes = axis === 0 ? [id, axes[1]] : [axes[0], id];
      draw();
    });
  const selects = [select("Across", 0), select("Up", 1)] as const;
  new ResizeObserver(() => plot.resize(Math.max(MIN_HEIGHT, stage.clientWidth), Math.max(MIN_HEIGHT, stage.clientHeight))).observe(stage);

  function draw(): void {
    const shown = atlas.shown.get();
    if (!shown) return;
    const { samples } = shown.atlas;
    const quantities = [...QUANTITIES, ...parameterQuantities(shown.definition.parameters.map(({ description }, k) => parameterName(description, k)))];
    const quantity = (id: string, otherwise: number): Quantity => quantities.find((one) => one.id === id) ?? quantities[otherwise];
    const [x, y] = [quantity(axes[0], 0), quantity(axes[1], 2)];
    selects.forEach((one, axis) => {
      one.setChoices(quantities.map(({ id, words }) => ({ value: id, words })));
      one.value = [x, y][axis].id;
    });
    const isOfParameters = x.id.startsWith("parameter") || y.id.startsWith("parameter");
    const others = isOfParameters ? [] : atlas.others.get().flatMap((other) => other.samples);
    plot.update({ samples, others, x, y, chosen: atlas.chosen.get() });
    showLegend(samples.map(({ place }) => place), others.length > 0);
    const index = atlas.chosen.get();
    const words = index === null ? "Choose a sample to draw its tiling." : `Sample ${index + 1}: parameters ${samples[index].parameters.map((value) => digits(value)).join(", ")}.`;
    writeText(chosen, words);
  }

  function showLegend(places: readonly AtlasPlace[], hasOthers: boolean): void {
    const found = PLACES.filter((place) => places.includes(place));
    replace(legend, ...found.map((place) => keyEntry(`sample ${place}`, place === "good" ? "This family" : `This family: ${PLACE_WORDS[place]}`)),
      hasOthers && keyEntry("other-sample", "Other families"));
  }

  session.redraws.follow([atlas.shown, atlas.others, atlas.chosen], draw);
  return h("div", { class: "sample-part" }, h("div", { class: "sample-axes" }, selects[0].element, selects[1].element), stage, legend, chosen);
}

function tablesOf({ profiles, samples, parameters }: FamilyAtlas): HTMLElement[] {
  const range = (values: readonly number[] | null) => (values ? `${digits(values[0])} to ${digits(values[1])}` : "–");
  const names = parameters.default.map((_, k) => `Parameter ${k + 1}`);
  const profileRow = (profile: AtlasProfile): string[] => {
    const { deviation, others } = profile;
    return [profileWords(profile.name), percent(deviation), others ? percent(others.deviation) : "–", others?.family ?? "–", GAIN_WORDS[gainOf(profile)]];
  };
  const sampleRow = ({ parameters: values, place, relative_density: density, stiffness, poisson_ratio: poisson }: AtlasSample, index: number): string[] => [
    String(index + 1),
    ...values.map((value) => digits(value)),
    PLACE_WORDS[place],
    density > 0 ? percent(density) : "–",
    range(stiffness),
    range(poisson),
  ];
  return [
    table("Reference profiles: deviation of this family and of the nearest other one", ["Profile", "This family", "Nearest other", "Family", "Outcome"], profiles.map(profileRow)),
    table("Samples", ["Sample", ...names, "Place", "Density", "Stiffness (MPa)", "Poisson’s ratio"], samples.map(sampleRow)),
  ];
}
