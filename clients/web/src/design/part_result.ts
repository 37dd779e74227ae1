// The picture of a part that was made, and its facts.
import { h, replace, svg } from "../base/dom";
import { digits } from "../base/format";
import type { PartAnswer } from "../contract/types";
import type { Part, PartState } from "./part";

/** Why the part cannot be made, or the server's message about it. */
function noteOf(state: PartState): string {
  if (state.kind === "failed") return state.sentence;
  return state.kind === "made" ? state.answer.message : "";
}

/** The narrowest wall, and how many narrower places the server has widened or cut. */
function wallWords({ smallest_neck, smallest_wall, widened_necks, cut_necks }: PartAnswer["checks"]): string {
  const narrowest = `at least ${digits(smallest_neck ?? smallest_wall, 2)} mm`;
  const done = [widened_necks > 0 ? `${widened_necks} widened` : "", cut_necks > 0 ? `${cut_necks} cut` : ""].filter((words) => words !== "");
  return done.length > 0 ? `${narrowest}; narrow places: ${done.join(", ")}` : narrowest;
}

function factsOf(answer: PartAnswer): [string, string][] {
  return [
    ["Size", `${answer.size.map((value) => digits(value)).join(" × ")} mm`],
    ["Mass", `${digits(answer.mass)} g`],
    ["Density", `${digits(100 * answer.relative_density)} % solid`],
    ["Walls", wallWords(answer.checks)],
    ...(answer.tested_direction === null ? [] : [["Load", `along the design’s ${digits((answer.tested_direction * 180) / Math.PI)}°`] as [string, string]]),
    ["Pieces", answer.checks.crumbs > 0 ? `one; ${answer.checks.crumbs} loose left out` : "one"],
  ];
}

/** `element`: the picture with the facts and `files`. `tell` shows a sentence below the facts. */
export function partResult(part: Part, files: HTMLElement): { element: HTMLElement; tell: (sentence: string) => void } {
  const shape = svg("path", { class: "solid", "fill-rule": "evenodd" });
  const drawing = svg("svg", { class: "part-drawing", role: "img", "aria-label": "The part" }, shape);
  const facts = h("dl", { class: "facts compact" });
  const note = h("p", { class: "note", role: "status" });
  part.state.watch((state) => {
    note.textContent = noteOf(state);
    drawing.classList.toggle("old", state.kind === "failed");
    if (state.kind !== "made") return;
    const { answer } = state;
    const solid = new DOMParser().parseFromString(answer.svg ?? "", "image/svg+xml");
    shape.setAttribute("d", solid.querySelector("path")?.getAttribute("d") ?? "");
    drawing.setAttribute("viewBox", solid.documentElement.getAttribute("viewBox") ?? "0 0 1 1");
    drawing.setAttribute("aria-label", `The part, ${answer.size.map((value) => digits(value)).join(" by ")} mm`);
    replace(facts, ...factsOf(answer).flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
  });
  const tell = (sentence: string): void => {
    note.textContent = sentence;
  };
  return { element: h("div", { class: "part-result" }, drawing, facts, note, files), tell };
}
