// The verdict in words, under the plot: how close the design comes, whether it was simulated, and ways out if the target is missed. It stays in
// sight, with the buttons that verify the design and lead to its part.
import { button, Checkbox } from "../base/controls";
import { h, replace, writeAttribute, writeText } from "../base/dom";
import { keepFocus } from "../base/focus";
import { seconds } from "../base/format";
import { icon } from "../base/icons";
import type { Background } from "./background";
import { judgedDesign, shownGrade } from "./judged";
import type { DesignSession } from "./session";
import { freshness, type TargetResponse } from "./shown";
import type { Judgement } from "./verdict";
import type { Verification, VerificationState } from "./verification";
import type { WayOut, WaysOut } from "./ways_out";

/** `toPart` leads to the card of the part. */
export function verdictLine(session: DesignSession, verification: Verification, waysOut: WaysOut, background: Background, toPart: () => void): HTMLElement {
  const mark = h("span", { class: "verdict-icon", hidden: true }, icon("check"));
  const words = h("p", { class: "verdict-words", tabindex: -1 });
  const state = h("p", { class: "verdict-state muted" });
  const verify = button("Verify", () => void verification.verify(), { kind: "primary", title: "Simulate the whole structure" });
  const stop = button("Stop checking", () => verification.cancel(), { kind: "quiet" });
  const save = button("Save part", toPart, { icon: "download", title: "Choose the shape and the size of the part, and save it" });
  const byItself = new Checkbox("Check by itself", (isOn) => background.switch(isOn));
  byItself.element.title = "Verify the design while the target rests, and look for ways out if it is missed";
  const ways = h("div", { class: "ways-out", role: "group", "aria-label": "Ways out", hidden: true });
  const element = h(
    "section",
    { class: "card verdict-line", "aria-label": "Verdict" },
    h("div", { class: "verdict-main" }, mark, h("div", { class: "verdict-text" }, words, state), h("div", { class: "row verdict-actions" }, verify, stop, save, byItself.element)),
    ways,
  );
  let drawnWays: readonly WayOut[] = [];

  function show(): void {
    keepFocus(element, update, stop, verify, save, words);
  }

  function update(): void {
    const shown = session.results.shown.get();
    const fresh = freshness(shown, session.state.get());
    const judgement = shown && fresh !== "other" && !shown.provisional ? judgedDesign(session, verification, shown) : null;
    const grade = shownGrade(judgement, fresh);
    writeAttribute(element, "data-grade", grade);
    writeAttribute(element, "data-source", judgement?.source ?? "");
    element.classList.toggle("old", fresh !== "current");
    mark.hidden = grade !== "reached";
    writeText(words, judgement?.sentence ?? (session.search.activity.get().kind === "busy" ? "Searching for a design." : "No design yet."));
    const running = verification.state.get();
    const limit = judgement && shown && fresh === "current" ? judgement.bound || envelopeWords(session, shown, judgement) : "";
    writeText(state, [stateWords(running), limit].filter((part) => part).join(" "));
    state.hidden = state.textContent === "";
    verify.hidden = running.kind === "done" || (running.kind === "running" && !running.isBackground);
    verify.disabled = judgement === null || fresh !== "current";
    stop.hidden = running.kind !== "running";
    showWays(judgement);
  }

  function showWays(judgement: Judgement | null): void {
    const found = waysOut.state.get();
    const all = (judgement?.grade === "missed" || judgement?.grade === "close") && found.kind === "found" ? found.ways : [];
    ways.hidden = all.length === 0;
    if (all === drawnWays || (all.length === 0 && drawnWays.length === 0)) return; // new buttons would lose the focus
    drawnWays = all;
    replace(ways, h("span", { class: "muted" }, "What would help:"),
      ...all.map((way) => button(wayWords(way), () => waysOut.apply(way), { title: "Make this change. It can be undone" })));
  }

  session.redraws.follow([session.results.shown, session.results.all, session.results.envelope, session.state, session.search.activity, verification.state,
    verification.simulations.list, waysOut.state], show);
  background.isOn.watch((isOn) => (byItself.value = isOn));
  return element;
}

/** A way out without the full stop of a sentence. */
function wayWords({ sentence }: WayOut): string {
  return sentence.replace(/\.$/, "");
}

/** What the page is doing about a simulation, as in "Checking by simulation, 40 %, about 12 s left." */
function stateWords(state: VerificationState): string {
  if (state.kind === "failed") return state.sentence;
  if (state.kind !== "running") return "";
  const work = state.work === "polish" ? "Polishing by simulation" : "Checking by simulation";
  const left = state.remaining === null ? "" : `about ${seconds(Math.max(1, Math.round(state.remaining)))} left`;
  const parts = [work, state.progress > 0 ? `${Math.round(100 * state.progress)} %` : "", left];
  return `${parts.filter((part) => part !== "").join(", ")}.`;
}

/** Why a target inside the shade can be missed, if no bound of all materials says why. Empty if it is not, or if it leaves the shade. */
function envelopeWords(session: DesignSession, shown: TargetResponse, { grade }: Judgement): string {
  const envelope = session.results.envelope.get();
  if (grade !== "missed" || !envelope || envelope.family !== shown.found.family || envelope.x.length !== shown.target.length) return "";
  const isInside = shown.target.every((y, k) => y >= envelope.lower[k] && y <= envelope.upper[k]);
  return isInside ? `${envelope.family} reaches each value of the target by itself, but no design of it that was found has the whole curve.` : "";
}
