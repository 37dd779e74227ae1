// The card of the result: how close the design comes to its targets, and advice if it does not come close.
import { SWITCHED_EFFECTS } from "../base/accuracy_choice";
import { withError } from "../base/accuracy_words";
import { button } from "../base/controls";
import { h, replace } from "../base/dom";
import { EffectChips } from "../base/effect_chips";
import { chipsOf, outdated } from "../base/effect_words";
import { degrees, digits, percent, seconds } from "../base/format";
import { icon } from "../base/icons";
import type { DesignStop } from "../contract/types";
import { modulusWords } from "./specification";
import type { Overlays } from "./overlays";
import { rankingList } from "./ranking_list";
import { relaxation } from "./reach";
import type { DesignSession } from "./session";
import { freshness, type Measures, type ModelError, modelError, modelUncertainty, sameRequirements, type TargetResponse } from "./shown";
import { type DesignState, isPolar, TASK_WORDS } from "./state";
import { targetWords } from "./target_list";
import type { Background } from "./background";
import { judgedDesign, judgedResponse } from "./judged";
import type { Judgement } from "./verdict";
import { type Grade, gradeWords } from "./verdict_words";
import type { Verification } from "./verification";
import type { WaysOut } from "./ways_out";

const TERMINATION_WORDS: Record<DesignStop, string> = {
  converged: "no step comes closer",
  reached: "the target is met",
  iteration_limit: "the limit of iterations",
  step_too_small: "steps became too small",
  no_free_parameters: "all parameters are fixed",
  trusted: "a nearer design is not trusted",
  deadline: "the deadline; more time may come closer",
  memory: "a limit of memory; this is the best until then",
};

/** Whether nothing else than another target would help. */
export type NothingElseHelps = () => boolean;

export function resultCard(session: DesignSession, overlays: Overlays, verification: Verification, waysOut: WaysOut, background: Background): HTMLElement {
  const nothingElseHelps: NothingElseHelps = () => {
    const found = waysOut.state.get();
    return found.kind === "found" ? found.ways.length === 0 : !background.isOn.get();
  };
  const body = h("div", { class: "dims" });
  const element = h("section", { class: "card result", "aria-label": "Design found" }, h("h2", {}, "Design"), body, effects(session), rankingList(session, overlays, verification));
  let drawn = "";
  let last: TargetResponse | null = null;
  let lastKnown: unknown = null;

  function show(): void {
    const shown = session.results.shown.get();
    const state = session.state.get();
    const fresh = freshness(shown, state);
    const now = `${fresh} ${state.task} ${state.found?.family} ${session.search.activity.get().kind} ${state.at} ${session.targets.map(targetWords).join()} ${nothingElseHelps()}`;
    const known = verification.simulations.list.get();
    if (now === drawn && shown === last && known === lastKnown) return;
    [drawn, last, lastKnown] = [now, shown, known];
    element.setAttribute("aria-busy", String(fresh !== "current"));
    // A design of another family or with another kind of profile is not shown: the sliders do not belong to it.
    if (!shown || fresh === "other") return replace(body, ...waiting(session, state));
    const error = modelError(session.catalogue.model(shown.found.family), shown);
    const judgement = judgedResponse(session, verification, shown);
    const label = fresh === "current" ? chip(shown, judgedDesign(session, verification, shown)) : h("span", { class: "chip plain" }, waitingWords(session));
    replace(body, h("div", { class: "headline" }, h("strong", { class: "family" }, shown.found.family), label), targetList(session, verification, shown),
      facts(shown, error, judgement, judgement.source === "simulation" ? (verification.simulated?.mesh ?? null) : modelUncertainty(shown)), ...notes(shown, judgement),
      ...(fresh === "current" && !shown.provisional && !shown.byHand && judgement.grade !== "reached" ? [advice(session, shown, nothingElseHelps())] : []));
  }

  session.redraws.follow([session.results.shown, session.state, session.search.activity, verification.simulations.list, waysOut.state, background.isOn], show);
  return element;
}

/** The effects of the last search, which can be switched. */
function effects(session: DesignSession): HTMLElement {
  const chips = new EffectChips("What the search did", (effect, value) => session.setEffect(effect, value));
  function show(): void {
    const { switches } = session.state.get().accuracy;
    const settings = Object.fromEntries((SWITCHED_EFFECTS.designs ?? []).map((name) => [name, switches[name] ?? "automatic"] as const));
    const shown = session.results.shown.get();
    const known = chipsOf(shown?.effects ?? [], settings);
    chips.show(shown && session.results.isCurrent && !shown.provisional ? known : outdated(known));
  }
  session.redraws.follow([session.results.shown, session.state], show);
  return chips.element;
}

/** The deviation from each target, if there are several. */
function targetList(session: DesignSession, verification: Verification, inSight: TargetResponse): HTMLElement | false {
  const { targets } = inSight;
  if (targets.length === 1) return false;
  const all = session.results.all.get();
  return h("div", { class: "target-errors" }, h("h3", {}, "Targets"), h("ul", { "aria-label": "Deviation from each target" }, ...targets.map((target, k) => {
    const shown = all[k];
    const known = shown && sameRequirements(shown, inSight) ? shown : null;
    const verdict = known && judgedResponse(session, verification, known);
    return h("li", { class: known === inSight ? "in-sight" : null }, h("span", { class: "target-name" }, targetWords(session.targets[k] ?? target)),
      h("span", { class: `verdict-mark ${verdict?.grade ?? ""}` }, verdict ? markWords(verdict) : "not known yet"),
      h("strong", {}, known && verdict ? percent(deviationFrom(known, verdict)) : "–"));
  })), h("p", { class: "overall" }, h("span", {}, "All together, by the model (rms)"), h("strong", {}, percent(inSight.overall))));
}

function markWords({ grade, source }: Judgement): string {
  return `${gradeWords(grade).toLowerCase()}${source === "simulation" ? ", simulated" : ""}`;
}

/** The simulated deviation where there is one, otherwise that of the model. */
function deviationFrom(shown: TargetResponse, { source, deviation }: Judgement): number {
  return source === "simulation" && deviation !== null ? deviation : shown.deviation;
}

function waitingWords(session: DesignSession): string {
  return session.search.activity.get().kind === "busy" ? "Computing" : "Not computed";
}

function waiting(session: DesignSession, { found, task }: DesignState): HTMLElement[] {
  if (!found) return [h("p", { class: "muted" }, "No design yet.")];
  return [
    h("div", { class: "headline" }, h("strong", { class: "family" }, found.family), h("span", { class: "chip plain" }, waitingWords(session))),
    h("p", { class: "muted" }, `${TASK_WORDS[task].title} of ${found.family} is not known yet.`),
  ];
}

/** Label of a result: the judgement, unless the search is running or the parameters were set by hand. */
export function labelOf(shown: TargetResponse, judgement: Judgement): string {
  if (shown.provisional) return "Searching";
  // A simulation tells as much of a design that was set by hand as of one that was found.
  return shown.byHand && judgement.source === "model" ? "Set by hand" : judgement.words;
}

const CHIP_KINDS: Record<Grade, string> = { reached: "good", close: "close", missed: "out", unknown: "close" };

function chip(shown: TargetResponse, judgement: Judgement): HTMLElement {
  const isPlain = shown.provisional || (shown.byHand && judgement.source === "model");
  const kind = isPlain ? "plain" : CHIP_KINDS[judgement.grade];
  return h("span", { class: `chip ${kind}` }, kind === "good" && icon("check"), labelOf(shown, judgement));
}

/** `uncertainty`: by how much the deviation may be off; null if that is not known. */
function facts(shown: TargetResponse, error: ModelError | null, judgement: Judgement, uncertainty: number | null): HTMLElement {
  const { unit } = TASK_WORDS[shown.task];
  const isSimulated = judgement.source === "simulation" && judgement.deviation !== null;
  const of = shown.targets.length > 1 ? "Target in sight" : "Deviation";
  const rows: [string, string][] = [
    [isSimulated ? `${of}, simulated (rms)` : `${of} (rms)`, withError(percent(deviationFrom(shown, judgement)), uncertainty)],
    ...(isSimulated ? [["By the model (rms)", percent(shown.deviation)] as [string, string]] : []),
    ["Largest, by the model", `${digits(shown.largest)}${unit && ` ${unit}`}`],
    ["Parameters", shown.found.parameters.map((value) => digits(value, 4)).join(", ")],
  ];
  rows.push(...measureRows(shown.measures));
  if (!shown.provisional) rows.push(["Time", seconds(shown.seconds)]);
  if (error) rows.push(["Model’s error", `${percent(error.mean)} in the mean, at most ${percent(error.percentile99)} for 99 in 100`]);
  if (shown.stopped) rows.push(["Stopped by", TERMINATION_WORDS[shown.stopped]]);
  return h("dl", { class: "facts" }, ...rows.flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
}

/** Material and measures of the structure, as far as they are known. */
function measureRows({ material, youngsModulus, orientation, beamWidth, cellSize, relativeDensity, density }: Measures): [string, string][] {
  const known = (term: string, value: number | null, words: (value: number) => string): [string, string][] => (value === null ? [] : [[term, words(value)]]);
  return [
    ...(material === "" ? [] : [["Material", material] as [string, string]]),
    ...known("Young’s modulus", youngsModulus, (value) => `${modulusWords(value)} MPa`),
    ["Orientation", degrees(orientation)],
    ...known("Beam width", beamWidth, (value) => `${digits(value)} mm`),
    ...known("Cell size", cellSize, (value) => `${digits(value)} mm`),
    ...known("Relative density", relativeDensity, percent),
    ...known("Density", density, (value) => `${digits(value)} g/cm³`),
  ];
}

function notes(shown: TargetResponse, { grade, source }: Judgement): HTMLElement[] {
  const outside = shown.inRange.filter((inside) => !inside).length;
  const words: HTMLElement[] = [];
  // The message is a warning only if the target is out of reach.
  if (shown.message) words.push(h("p", { class: grade === "missed" && !shown.byHand ? "note" : "muted" }, shown.message));
  if (source === "model" && outside > 0 && !/samples/.test(shown.message)) {
    words.push(h("p", { class: "note" }, `${outside} of ${shown.inRange.length} samples are beyond what the model can be trusted with: verify them.`));
  }
  return words;
}

/** Buttons that change a target which no design meets: they move all of its control points, or one. */
function advice(session: DesignSession, shown: TargetResponse, nothingElseHelps: boolean): HTMLElement {
  const relaxed = nothingElseHelps ? relaxation(shown) : null;
  const { unit } = TASK_WORDS[shown.task];
  const height = (y: number) => `${digits(y)}${unit && ` ${unit}`}`;
  const at = relaxed && (isPolar(shown.task) ? degrees(relaxed.from[0]) : `a strain of ${digits(relaxed.from[0])}`);
  const moved = relaxed && `with ${height(relaxed.to[1])} there instead of ${height(relaxed.from[1])} it would be within ${percent(relaxed.deviation)}`;
  return h("div", { class: "advice" }, relaxed && h("p", {}, `Control point ${relaxed.index + 1}, at ${at}, keeps this design away most: ${moved}.`),
    h("div", { class: "row" },
      button("Snap to the closest reachable", () => session.targetEdits.project(), { title: "Move the target’s control points onto this design’s response" }),
      relaxed && button(`Relax point ${relaxed.index + 1}`, () => session.targetEdits.relax(relaxed), { title: `Move control point ${relaxed.index + 1} alone` })));
}
