// The ranking of the families by their deviation from the target. The design of each can be shown or overlaid.
import { button } from "../base/controls";
import { h, replace } from "../base/dom";
import { percent } from "../base/format";
import type { DesignCandidate } from "../contract/types";
import { searchesModulus, type Specification, modulusWords } from "./specification";
import type { Overlays } from "./overlays";
import type { DesignSession } from "./session";
import { expectedDeviation } from "./shown";
import { ANY, sameProfile } from "./state";
import { targetsOf } from "./target_list";

export function rankingList(session: DesignSession, overlays: Overlays): HTMLElement {
  const list = h("ol");
  const again = button("Search all families", () => session.apply({ family: ANY, byHand: false }), { kind: "quiet" });
  const element = h("div", { class: "ranking dims" }, h("h3", {}, "Families, best first"),
    h("p", { class: "muted" }, "Bar: the deviation that a simulation is expected to show, made of the design’s deviation and of the model’s mean error (±). Shorter is better."),
    list, again);

  function row(candidate: DesignCandidate, maxDeviation: number, made: Specification): HTMLElement {
    const { family } = candidate;
    const chosen = family === session.state.get().found?.family;
    const expected = expectedDeviation(candidate);
    const words = candidate.model_error === null ? "an unknown error" : `${percent(expected)} expected`;
    const bar = h("meter", { min: 0, max: 1, value: Math.max(0.02, Math.min(1, expected / maxDeviation)), title: words, "aria-hidden": "true" });
    const look = h("button", {
      type: "button",
      class: "rank",
      "aria-current": chosen ? "true" : null,
      title: `Look at ${family}: ${words}`,
      onclick: () => session.lookAt(candidate),
    }, h("span", { class: "rank-name" }, family), bar, h("span", { class: "rank-error" }, percent(candidate.error.relative_rms)),
      h("span", { class: "rank-error muted" }, `± ${modelWords(candidate)}`), searchesModulus(made) && h("span", { class: "rank-material muted" }, materialWords(candidate)));
    const overlaid = overlays.has(family);
    const overlay = button("", () => void overlays.toggle(candidate), { icon: "overlay", kind: "quiet", title: `Overlay the curve of ${family}` });
    overlay.setAttribute("aria-pressed", String(overlaid));
    return h("li", {}, look, overlay);
  }

  let signature = "";
  let drawn: object | null = null;
  function show(): void {
    const state = session.state.get();
    const { found, family } = state;
    const ranked = session.results.ranking.get();
    // A ranking for other kinds of profiles does not apply to these targets.
    const targets = targetsOf(state);
    const fits = ranked && ranked.targets.length === targets.length && ranked.targets.every((target, k) => sameProfile(target, targets[k]));
    const ranking = fits ? ranked : null;
    element.hidden = !ranking;
    again.hidden = family === ANY;
    const now = `${found?.family} ${overlays.list.get().map((curve) => curve.name).join()}`;
    if (!ranking || (now === signature && drawn === ranking)) return; // a new list would lose the focus
    [signature, drawn] = [now, ranking];
    // Families with an unknown model error get a full bar. They do not count for the scale, so that the other bars stay visible.
    const maxDeviation = Math.max(...ranking.candidates.filter((one) => one.model_error !== null).map(expectedDeviation), 1e-9);
    const focused = [...list.querySelectorAll("button")].indexOf(document.activeElement as HTMLButtonElement);
    replace(list, ...ranking.candidates.map((candidate) => row(candidate, maxDeviation, ranking.made)));
    if (focused >= 0) list.querySelectorAll("button")[focused]?.focus();
  }
  for (const part of [session.results.ranking, session.state, overlays.list]) part.watch(show);
  return element;
}

function modelWords({ model_error: error }: DesignCandidate): string {
  return error === null ? "an unknown amount" : percent(error);
}

/** The material with which this family comes closest to the targets. */
function materialWords({ material: { name, youngs_modulus } }: DesignCandidate): string {
  return `${name ? `${name}, ` : ""}${modulusWords(youngs_modulus)} MPa`;
}
