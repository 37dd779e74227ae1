import { button } from "../base/controls";
import { announce } from "../base/announce";
import { h, replace } from "../base/dom";
import { percent, seconds } from "../base/format";
import { PatchView } from "./patch_view";
import type { DesignSession } from "./session";
import type { PatchState, SimulatedTarget, Verification, VerificationState } from "./verification";

export function verificationCard(session: DesignSession, verification: Verification): HTMLElement {
  const verify = button("Verify by simulation", () => void verification.verify(), { kind: "primary" });
  const polish = button("Polish by simulation", () => void verification.polish(), {
    title: "Corrects the parameters until the simulation, not the model alone, follows the target",
  });
  const cancel = button("Cancel", () => verification.clear());
  const words = h("p", { class: "muted" });
  const bar = h("progress", { max: 1, "aria-label": "Progress of the simulation" });
  const view = new PatchView();
  const patchWords = h("p", { class: "muted" });

  session.results.shown.watch((shown) => (verify.disabled = polish.disabled = !shown));
  let lastSeconds: number | null = null;
  const tell = (state: VerificationState) => {
    if (state.kind === "done") lastSeconds = state.seconds;
    words.textContent = sentence(state, verification.simulated, lastSeconds);
    words.className = state.kind === "failed" ? "note" : state.kind === "done" ? "verdict" : "muted";
  };
  verification.state.watch((state) => {
    tell(state);
    if (state.kind === "done" || state.kind === "failed") announce(words.textContent ?? "");
    show();
  });
  // The card shows the result for the selected target.
  session.results.shown.watch(() => tell(verification.state.get()));
  verification.patch.watch((state) => {
    if (state.kind === "done") {
      const material = session.catalogue.model(state.simulation.family)?.material;
      view.show(state.simulation, state.direction, material ? { youngsModulus: material.youngs_modulus, poissonRatio: material.poisson_ratio } : null);
    } else view.clear();
    patchWords.textContent = state.kind === "failed" ? state.sentence : "";
    show();
  });

  function show(): void {
    const state = verification.state.get();
    const patch = verification.patch.get();
    const progress = progressOf(state, patch);
    bar.hidden = cancel.hidden = progress === null;
    verify.hidden = progress !== null || state.kind === "done";
    polish.hidden = progress !== null || (state.kind === "done" && state.polish.rounds.length > 1);
    if (progress !== null) bar.value = progress;
    view.element.hidden = patch.kind !== "done";
    patchWords.hidden = patchWords.textContent === "";
  }

  show();
  const section = h("section", { class: "card verification", "aria-label": "Verification" });
  replace(section, h("h2", {}, "Verification"), words, h("div", { class: "row" }, verify, polish, bar, cancel), view.element, patchWords);
  return section;
}

function progressOf(state: VerificationState, patch: PatchState): number | null {
  if (state.kind === "running") return state.progress;
  return patch.kind === "running" ? patch.progress : null;
}

/** The sentence about the present state. `lastSeconds`: duration of the last simulation, null before the first. */
function sentence(state: VerificationState, simulated: SimulatedTarget | null, lastSeconds: number | null): string {
  const last = lastSeconds === null ? "" : `; the last one took ${seconds(lastSeconds)}`;
  switch (state.kind) {
    case "none":
      return `The curve comes from a neural model. A simulation of the whole structure tells how far it can be trusted${last}.`;
    case "running":
      if (state.round) return `Round ${state.round.count}: ${state.round.error === null ? "not simulated" : `${percent(state.round.error)} from the target`}`;
      return state.stage ? `Simulating: ${state.stage}` : "Simulating the structure";
    case "failed":
      return state.sentence;
    case "done":
      return doneSentence(state, simulated);
  }
}

function doneSentence({ simulated, polish, seconds: elapsed }: Extract<VerificationState, { kind: "done" }>, inSight: SimulatedTarget | null): string {
  const { deviation, mesh } = inSight ?? { deviation: null, mesh: null };
  const words: string[] = [];
  const first = polish.rounds[0]?.target_error ?? null;
  if (polish.target_error !== null) {
    const rounds = polish.rounds.length - 1;
    const before = rounds > 0 && first !== null ? `, ${percent(first)} before it was polished in ${rounds} ${rounds === 1 ? "round" : "rounds"}` : "";
    words.push(`The simulation is ${percent(polish.target_error)} from the ${simulated.length > 1 ? "targets" : "target"} (rms)${before}.`);
  }
  if (deviation !== null) words.push(`${simulated.length > 1 ? "Of the target in sight the" : "The"} simulation and the model differ by ${percent(deviation)} (rms).`);
  if (mesh !== null) words.push(`The mesh of the simulation makes an error of less than about ${percent(mesh)}.`);
  words.push(`Simulated in ${seconds(elapsed)}.`);
  return words.join(" ");
}
