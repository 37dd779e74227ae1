import { button } from "../base/controls";
import { announce } from "../base/announce";
import { h, replace } from "../base/dom";
import { percent, seconds } from "../base/format";
import { PatchView } from "./patch_view";
import type { DesignSession } from "./session";
import type { PatchState, Verification, VerificationState } from "./verification";

export function verificationCard(session: DesignSession, verification: Verification): HTMLElement {
  const verify = button("Verify by simulation", () => void verification.verify(), { kind: "primary" });
  const cancel = button("Cancel", () => verification.clear());
  const words = h("p", { class: "muted" });
  const bar = h("progress", { max: 1, "aria-label": "Progress of the simulation" });
  const view = new PatchView();
  const patchWords = h("p", { class: "muted" });

  session.shown.watch((shown) => (verify.disabled = !shown));
  verification.state.watch((state) => {
    words.textContent = sentence(state);
    words.className = state.kind === "failed" ? "note" : state.kind === "done" ? "verdict" : "muted";
    if (state.kind === "done" || state.kind === "failed") announce(words.textContent);
    show();
  });
  verification.patch.watch((state) => {
    if (state.kind === "done") view.show(state.simulation, state.direction);
    else view.clear();
    patchWords.textContent = state.kind === "failed" ? state.sentence : "";
    show();
  });

  function show(): void {
    const state = verification.state.get();
    const patch = verification.patch.get();
    const progress = progressOf(state, patch);
    bar.hidden = cancel.hidden = progress === null;
    verify.hidden = progress !== null || state.kind === "done";
    if (progress !== null) bar.value = progress;
    view.element.hidden = patch.kind !== "done";
    patchWords.hidden = patchWords.textContent === "";
  }

  show();
  const section = h("section", { class: "card verification", "aria-label": "Verification" });
  replace(section, h("h2", {}, "Verification"), words, h("div", { class: "row" }, verify, bar, cancel), view.element, patchWords);
  return section;
}

function progressOf(state: VerificationState, patch: PatchState): number | null {
  if (state.kind === "running") return state.progress;
  return patch.kind === "running" ? patch.progress : null;
}

function sentence(state: VerificationState): string {
  switch (state.kind) {
    case "none": return "The curve comes from a neural model. A simulation of the whole structure takes seconds to minutes.";
    case "running": return state.stage ? `Simulating: ${state.stage}` : "Simulating the structure";
    case "failed": return state.sentence;
    case "done":
      return state.deviation === null
        ? `Simulated in ${seconds(state.seconds)}.`
        : `The simulation and the model differ by ${percent(state.deviation)} (rms). Simulated in ${seconds(state.seconds)}.`;
  }
}
