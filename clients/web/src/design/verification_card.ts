import { button } from "../base/controls";
import { announce } from "../base/announce";
import { h, replace } from "../base/dom";
import { EffectChips } from "../base/effect_chips";
import { type Chip, chipsOf } from "../base/effect_words";
import { keepFocus } from "../base/focus";
import { percent, seconds } from "../base/format";
import { beamWidthSentence } from "./beam_width_words";
import { PatchView } from "./patch_view";
import type { DesignSession } from "./session";
import { goesOn, polishHelp } from "./polish_help";
import type { PolishRound } from "./polish_rounds";
import type { PatchState, RunningSimulation, SimulatedTarget, Verification, VerificationState } from "./verification";
import type { WaysOut } from "./ways_out";

export function verificationCard(session: DesignSession, verification: Verification, waysOut: WaysOut): HTMLElement {
  const verify = button("Verify by simulation", () => void verification.verify(), { kind: "primary" });
  const polish = button("Polish by simulation", () => void verification.polish(), {
    title: "Corrects the parameters until the simulation, not the model alone, follows the target",
  });
  const cancel = button("Cancel", () => verification.cancel());
  const patch = button("Show the deformed patch", () => void verification.showPatch());
  const chips = new EffectChips("What the simulation found");
  const rounds = h("ol", { class: "polish-rounds", "aria-label": "Rounds of the polish" });
  const words = h("p", { class: "muted", tabindex: -1 });
  const bar = h("progress", { max: 1, "aria-label": "Progress of the simulation" });
  const view = new PatchView();
  const patchWords = h("p", { class: "muted" });
  const section = h("section", { class: "card verification", "aria-label": "Verification" });

  // A response to an earlier state is not verified: its curve would be stored for another material or orientation.
  session.redraws.follow([session.results.shown, session.state], () => {
    verify.disabled = polish.disabled = !session.results.isCurrent;
  });
  let lastSeconds: number | null = null;
  let announced = "";
  const tell = (state: VerificationState) => {
    if (state.kind === "done") lastSeconds = state.seconds;
    words.textContent = sentence(state, verification.simulated, lastSeconds, verification.rounds.list.get());
    chips.show(state.kind === "done" ? simulationChips(state, verification.simulated) : []);
    if (state.kind === "done" && state.polish) words.textContent = [words.textContent, polishHelp(state.polish, waysOut.state.get())].join(" ").trim();
    words.className = state.kind === "failed" ? "note" : state.kind === "done" ? "verdict" : "muted";
  };
  verification.state.watch((state) => {
    tell(state);
    if (state.kind !== "none" && state.kind !== "running" && state.kind !== announced) announce(words.textContent ?? "");
    announced = state.kind;
    show();
  });
  // The card shows the result for the selected target.
  session.redraws.follow([session.results.shown, waysOut.state], () => tell(verification.state.get()));
  verification.rounds.list.watch((list) => {
    replace(rounds, ...list.map((round) => h("li", { class: round.isBest ? "best" : null }, roundWords(round))));
    rounds.hidden = list.length === 0;
    tell(verification.state.get());
  });
  verification.patch.watch((state) => {
    if (state.kind === "done") {
      const material = session.catalogue.model(state.simulation.family)?.material;
      view.show(state.simulation, state.direction, material ? { youngsModulus: material.youngs_modulus, poissonRatio: material.poisson_ratio } : null);
    } else view.clear();
    patchWords.textContent = state.kind === "failed" ? state.sentence : "";
    show();
  });

  function show(): void {
    keepFocus(section, update, cancel, patch, words);
  }

  function update(): void {
    const state = verification.state.get();
    const patchState = verification.patch.get();
    const progress = progressOf(state, patchState);
    bar.hidden = cancel.hidden = progress === null;
    verify.hidden = progress !== null || state.kind === "done";
    polish.hidden = progress !== null || (state.kind === "done" && state.polish !== null && state.polish.rounds.length > 1 && !goesOn(state.polish));
    patch.hidden = progress !== null || state.kind !== "done" || patchState.kind !== "none";
    if (progress !== null) bar.value = progress;
    view.element.hidden = patchState.kind !== "done";
    patchWords.hidden = patchWords.textContent === "";
  }

  replace(section, h("h2", {}, "Verification"), words, chips.element, rounds, h("div", { class: "row" }, verify, polish, patch, bar, cancel), view.element, patchWords);
  show();
  return section;
}

/** Effects of simulations; the others are those of the search for the design. */
const SIMULATED_EFFECTS: readonly string[] = ["buckling", "contact", "patch", "refinement", "polish"];

function simulationChips({ effects }: Extract<VerificationState, { kind: "done" }>, inSight: SimulatedTarget | null): Chip[] {
  return chipsOf(effects.filter(({ name }) => SIMULATED_EFFECTS.includes(name)), {}, inSight ? { discretization_error: inSight.mesh } : {});
}

function progressOf(state: VerificationState, patch: PatchState): number | null {
  if (state.kind === "running") return state.progress;
  return patch.kind === "running" ? patch.progress : null;
}

/** The sentence about the present state. `lastSeconds`: duration of the last simulation, null before the first. */
function sentence(state: VerificationState, simulated: SimulatedTarget | null, lastSeconds: number | null, rounds: readonly PolishRound[]): string {
  const last = lastSeconds === null ? "" : `; the last one took ${seconds(lastSeconds)}`;
  switch (state.kind) {
    case "none":
      return `The curve comes from a neural model. A simulation of the whole structure tells how far it can be trusted${last}.`;
    case "running":
      return [rounds.length > 0 ? roundWords(rounds[rounds.length - 1]) : state.stage ? `Simulating: ${state.stage}` : "Simulating the structure", leftWords(state)]
        .filter((part) => part).join("; ");
    case "failed":
      return state.sentence;
    case "done":
      return doneSentence(state, simulated);
  }
}

function doneSentence({ simulated, polish, seconds: elapsed }: Extract<VerificationState, { kind: "done" }>, inSight: SimulatedTarget | null): string {
  const { deviation, mesh } = inSight ?? { deviation: null, mesh: null };
  const words: string[] = [];
  const first = polish?.rounds[0]?.target_error ?? null;
  if (polish && polish.target_error !== null) {
    const rounds = polish.rounds.length - 1;
    const before = rounds > 0 && first !== null ? `, ${percent(first)} before it was polished in ${rounds} ${rounds === 1 ? "round" : "rounds"}` : "";
    words.push(`The simulation is ${percent(polish.target_error)} from the ${simulated.length > 1 ? "targets" : "target"} (rms)${before}.`);
  }
  if (deviation !== null) words.push(`${simulated.length > 1 ? "Of the target in sight the" : "The"} simulation and the model differ by ${percent(deviation)} (rms).`);
  if (mesh !== null) words.push(`The mesh of the simulation makes an error of less than about ${percent(mesh)}.`);
  if (inSight?.beamWidth) words.push(beamWidthSentence(inSight.beamWidth));
  words.push(`Simulated in ${seconds(elapsed)}.`);
  return words.join(" ");
}

/** A round as in "Round 3: 12 % from the target, 4.2 s, the best so far". */
function roundWords({ number, deviation, seconds: took, isBest }: PolishRound): string {
  return `Round ${number}: ${deviation === null ? "not simulated" : `${percent(deviation)} from the target`}, ${seconds(took)}${isBest ? ", the best so far" : ""}`;
}

function leftWords({ remaining }: RunningSimulation): string {
  return remaining === null ? "" : `about ${seconds(Math.max(1, Math.round(remaining)))} left`;
}
