// How close the design comes, and which families come closest.
import { h, replace } from "../base/dom";
import { digits, percent, seconds } from "../base/format";
import { icon } from "../base/icons";
import type { DesignCandidate, DesignStop } from "../contract/types";
import type { DesignSession } from "./session";
import { expectedDeviation, type ModelError, modelError, type Shown } from "./shown";
import { TASK_WORDS } from "./state";

const STOP_WORDS: Record<DesignStop, string> = {
  converged: "no step comes closer",
  reached: "the target is met",
  iteration_limit: "the limit of iterations",
  step_too_small: "steps became too small",
  no_free_parameters: "all parameters are fixed",
};

export function resultCard(session: DesignSession): HTMLElement {
  const body = h("div");
  const ranking = h("div", { class: "ranking" });
  session.shown.watch((shown) => {
    if (!shown) return replace(body, h("p", { class: "muted" }, "No design yet."));
    replace(body, headline(shown), facts(shown, modelError(session.model(shown.found.family), shown)), ...notes(shown));
    if (shown.ranking.length > 1) replace(ranking, ...rankingList(session, shown));
    else if (!shown.provisional && !shown.byHand && session.state.get().family !== "any") replace(ranking);
  });
  return h("section", { class: "card result", "aria-label": "Design found" }, h("h2", {}, "Design"), body, ranking);
}

export function isReached(shown: Shown): boolean {
  return shown.reached.length > 0 && shown.reached.every(Boolean);
}

function headline(shown: Shown): HTMLElement {
  const reached = isReached(shown);
  const words = reached ? "Target reached" : shown.byHand ? "Set by hand" : shown.provisional ? "Searching" : "Closest design";
  return h(
    "div",
    { class: "headline" },
    h("strong", { class: "family" }, shown.found.family),
    h("span", { class: reached ? "chip good" : "chip" }, reached && icon("check"), words),
  );
}

function facts(shown: Shown, error: ModelError | null): HTMLElement {
  const { unit } = TASK_WORDS[shown.task];
  const rows: [string, string][] = [
    ["Deviation (rms)", percent(shown.deviation)],
    ["Largest", `${digits(shown.largest)}${unit && ` ${unit}`}`],
    ["Parameters", shown.found.parameters.map((value) => digits(value, 4)).join(", ")],
    ["Time", seconds(shown.seconds)],
  ];
  if (error) rows.push(["Model’s error", `${percent(error.mean)} in the mean, at most ${percent(error.percentile99)} for 99 in 100`]);
  if (shown.stopped) rows.push(["Stopped by", STOP_WORDS[shown.stopped]]);
  return h("dl", { class: "facts" }, ...rows.flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
}

function notes(shown: Shown): HTMLElement[] {
  const outside = shown.inRange.filter((inside) => !inside).length;
  const words: string[] = [];
  if (shown.message) words.push(shown.message);
  if (outside > 0) words.push(`${outside} of ${shown.inRange.length} samples are beyond what the model can be trusted with: verify them.`);
  return words.map((sentence) => h("p", { class: "note" }, sentence));
}

function rankingList(session: DesignSession, shown: Shown): HTMLElement[] {
  const best = expectedDeviation(shown.ranking[0]);
  const items = shown.ranking.map((candidate) => {
    const chosen = candidate.family === shown.found.family;
    // A bar of full length is the best; others are as short as they are worse.
    const bar = h("meter", { min: 0, max: 1, value: best / Math.max(expectedDeviation(candidate), best), "aria-hidden": "true" });
    const row = h(
      "button",
      { type: "button", class: "rank", "aria-current": chosen ? "true" : null, title: `Go on with ${candidate.family}, whose model errs by ${modelWords(candidate)}`,
        onclick: () => session.apply({ family: candidate.family, found: { family: candidate.family, parameters: candidate.parameters }, byHand: false }) },
      h("span", { class: "rank-name" }, candidate.family), bar,
      h("span", { class: "rank-error" }, percent(candidate.error.relative_rms)),
      h("span", { class: "rank-error muted" }, `± ${modelWords(candidate)}`),
    );
    return h("li", {}, row);
  });
  return [
    h("h3", {}, "Families, best first"),
    h("p", { class: "muted" }, "Deviation ± the model’s mean error"),
    h("ol", {}, ...items),
  ];
}

function modelWords({ model_error: error }: DesignCandidate): string {
  return error === null ? "an unknown amount" : percent(error);
}
