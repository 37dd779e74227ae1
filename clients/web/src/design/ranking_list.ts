// The ranking of the families by their deviation from the target. The design of each can be shown or overlaid.
import { button } from "../base/controls";
import { h, replace } from "../base/dom";
import { percent } from "../base/format";
import type { DesignCandidate } from "../contract/types";
import { searchesModulus, type Specification, modulusWords } from "./specification";
import type { Overlays } from "./overlays";
import type { DesignSession } from "./session";
import type { Ranking } from "./results";
import { designOf, expectedDeviation, overallDeviation } from "./shown";
import { ANY, sameProfile } from "./state";
import { targetsOf } from "./target_list";
import { simulatedDeviation } from "./verdict";
import type { Verification } from "./verification";

export function rankingList(session: DesignSession, overlays: Overlays, verification: Verification): HTMLElement {
  const list = h("ol");
  const again = button("Search all families", () => session.apply({ family: ANY, byHand: false }), { kind: "quiet" });
  const element = h("div", { class: "ranking dims" }, h("h3", {}, "Families, best first"),
    h("p", { class: "muted" },
      "Bar: the deviation that a simulation is expected to show, made of the design’s deviation and of the model’s mean error (±), or the deviation that it has shown. Shorter is better."),
    list, again);

  function row({ candidate, simulated, expected }: RankedFamily, maxDeviation: number, made: Specification): HTMLElement {
    const { family } = candidate;
    const chosen = family === session.state.get().found?.family;
    const words = simulated !== null ? `${percent(simulated)} simulated` : candidate.model_error === null ? "an unknown error" : `${percent(expected)} expected`;
    const bar = h("meter", { min: 0, max: 1, value: Math.max(0.02, Math.min(1, expected / maxDeviation)), title: words, "aria-hidden": "true" });
    const look = h("button", {
      type: "button",
      class: "rank",
      "aria-current": chosen ? "true" : null,
      title: `Look at ${family}: ${words}`,
      onclick: () => session.lookAt(candidate),
    }, h("span", { class: "rank-name" }, family), bar, h("span", { class: "rank-error" }, percent(simulated ?? candidate.error.relative_rms)),
      h("span", { class: "rank-error muted" }, simulated === null ? `± ${modelWords(candidate)}` : "simulated"),
      searchesModulus(made) && h("span", { class: "rank-material muted" }, materialWords(candidate)));
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
    const answered = session.results.ranking.get();
    // A ranking for other kinds of profiles does not apply to these targets.
    const targets = targetsOf(state);
    const fits = answered && answered.targets.length === targets.length && answered.targets.every((target, k) => sameProfile(target, targets[k]));
    const ranking = fits ? answered : null;
    element.hidden = !ranking;
    again.hidden = family === ANY;
    const ranked = ranking ? rankedFamilies(ranking, verification) : [];
    const now = `${found?.family} ${overlays.list.get().map((curve) => curve.name).join()} ${ranked.map(({ simulated }) => simulated).join()}`;
    if (!ranking || (now === signature && drawn === ranking)) return; // a new list would lose the focus
    [signature, drawn] = [now, ranking];
    // Families with an unknown model error get a full bar. They do not count for the scale, so that the other bars stay visible.
    const maxDeviation = Math.max(...ranked.filter(({ candidate, simulated }) => simulated !== null || candidate.model_error !== null).map(({ expected }) => expected), 1e-9);
    const focused = [...list.querySelectorAll("button")].indexOf(document.activeElement as HTMLButtonElement);
    replace(list, ...ranked.map((one) => row(one, maxDeviation, ranking.made)));
    if (focused >= 0) list.querySelectorAll("button")[focused]?.focus();
  }
  for (const part of [session.results.ranking, session.state, overlays.list, verification.simulations.list]) part.watch(show);
  return element;
}

interface RankedFamily {
  readonly candidate: DesignCandidate;
  /** Simulated deviation from the targets; null if the design was not simulated. */
  readonly simulated: number | null;
  /** The deviation that counts: the simulated one, or the one that a simulation is expected to show. */
  readonly expected: number;
}

/** The families, best first. What was simulated stands where its simulation puts it. */
function rankedFamilies({ candidates, targets, made }: Ranking, { simulations }: Verification): readonly RankedFamily[] {
  const ranked = candidates.map((candidate): RankedFamily => {
    const found = designOf(candidate, { made });
    const deviations = targets.map((target) => {
      const curve = simulations.curveOf({ ...target, found, made });
      return curve && simulatedDeviation(target, curve);
    });
    const isKnown = deviations.every((deviation): deviation is number => deviation !== null);
    const simulated = isKnown ? overallDeviation(deviations.map((deviation, k) => ({ deviation: deviation as number, weight: targets[k].weight }))) : candidate.simulated_error;
    return { candidate, simulated, expected: simulated ?? expectedDeviation(candidate) };
  });
  return ranked.some(({ simulated }) => simulated !== null) ? ranked.sort((a, b) => a.expected - b.expected) : ranked;
}

function modelWords({ model_error: error }: DesignCandidate): string {
  return error === null ? "an unknown amount" : percent(error);
}

/** The material with which this family comes closest to the targets. */
function materialWords({ material: { name, youngs_modulus } }: DesignCandidate): string {
  return `${name ? `${name}, ` : ""}${modulusWords(youngs_modulus)} MPa`;
}
