// The card with the designs of all regions: family and deviation of each, and a search for all of them at once.
import { button } from "../base/controls";
import { h, replace } from "../base/dom";
import { percent } from "../base/format";
import { judgedResponses } from "./judged";
import { regionWords } from "./region_list";
import type { DesignSession } from "./session";
import type { Judgement } from "./verdict";
import type { Verification } from "./verification";

export function regionCard(session: DesignSession, verification: Verification): HTMLElement {
  const list = h("ul", { "aria-label": "Design of each region" });
  const search = button("Search all regions", () => session.regionEdits.searchAll(), { title: "Searches for the designs of all regions in one request" });
  const element = h("section", { class: "card regions-card", "aria-label": "Regions", hidden: true }, h("h2", {}, "Regions"), list, search);

  function show(): void {
    const regions = session.regionEdits.all;
    const regionShown = session.results.ofRegions;
    element.hidden = regions.length === 1;
    if (element.hidden) return;
    const { regionAt } = session.state.get();
    replace(list, ...regions.map((region, k) => {
      const shown = regionShown[k];
      return h("li", { class: k === regionAt ? "in-sight" : null }, h("span", { class: "target-name" }, regionWords(region, k)),
        h("span", { class: "muted" }, region.found?.family ?? ""),
        h("strong", {}, shown ? offWords(judgedResponses(session, verification, shown), shown[0].overall) : "not known yet"));
    }));
  }

  session.redraws.follow([session.state, session.results.all, session.results.regionCache, verification.simulations.list], show);
  session.redraws.follow([session.search.activity], () => {
    search.disabled = session.search.activity.get().kind === "busy";
  });
  return element;
}

/** The simulated deviation from the worst target where there is one, otherwise that of the model from all of them. */
function offWords({ source, deviation }: Judgement, byModel: number): string {
  return source === "simulation" && deviation !== null ? `${percent(deviation)}, simulated` : percent(byModel);
}
