// Tables of the curves, for users who do not see the plot, and of the control points, with fields to edit them.
import { h, replace } from "../base/dom";
import { degrees, digits } from "../base/format";
import type { DesignSession } from "./session";
import { freshness } from "./shown";
import { type ControlPoint, isPolar, STRAIN_WORDS, type Target, TASK_WORDS } from "./state";
import { targetWords } from "./target_list";
import { isAtRest, movePoint } from "./targets";

/** A target in a caption, with its label if there are several. */
function named(target: Target, count: number): string {
  return count > 1 ? `the target ${targetWords(target)}` : "the target";
}

/** Numbers below this fraction of the largest value in their column are rounding errors and shown as 0. */
const ROUNDING = 1e-6;

function withoutRounding(value: number, all: readonly (number | null)[]): number {
  return Math.abs(value) < ROUNDING * Math.max(...all.map((other) => Math.abs(other ?? 0))) ? 0 : value;
}

export function valueTable(session: DesignSession): HTMLElement {
  const curves = h("div", { class: "table-box dims", tabindex: 0, role: "region", "aria-label": "Values of the curves" });
  const points = h("div", { class: "table-box" });
  const details = h("details", { class: "card table" }, h("summary", {}, "Values as tables"), h("div", { class: "tables" }, points, curves));

  function show(): void {
    if (!details.open) return;
    showCurves();
    showPoints();
  }

  function showCurves(): void {
    const shown = session.results.shown.get();
    if (!shown || freshness(shown, session.state.get()) === "other") return replace(curves, h("p", { class: "muted" }, "Not computed yet."));
    const polar = isPolar(shown.task);
    const { y, unit } = TASK_WORDS[shown.task];
    const head = [polar ? "Direction" : STRAIN_WORDS[shown.measure], "Target", "Design", "Reached"];
    replace(
      curves,
      h(
        "table",
        {},
        h("caption", {}, `${y}${unit && ` in ${unit}`} of ${named(session.state.get(), shown.targets.length)} and of ${shown.found.family}`),
        h("thead", {}, h("tr", {}, ...head.map((words) => h("th", { scope: "col" }, words)))),
        h("tbody", {}, ...shown.x.map((x, k) => {
          const value = shown.achieved[k];
          const cells = [digits(withoutRounding(shown.target[k], shown.target)), value === null ? "none" : digits(withoutRounding(value, shown.achieved)),
            shown.reached[k] ? "yes" : "no"];
          return h("tr", {}, h("th", { scope: "row" }, polar ? degrees(x) : digits(withoutRounding(x, shown.x))), ...cells.map((words) => h("td", {}, words)));
        })),
      ),
    );
  }

  /** Rebuilds the table unless one of its fields is being edited. `anew`: rebuilds it in any case and restores the focus. */
  function showPoints(anew = false): void {
    const fields = () => [...points.querySelectorAll("input")];
    const focused = fields().indexOf(document.activeElement as HTMLInputElement);
    if (focused >= 0 && !anew) return; // a field is being edited
    const state = session.state.get();
    const polar = isPolar(state.task);
    const x = (value: number) => (polar ? (value * 180) / Math.PI : value);
    const field = (point: ControlPoint, index: number, axis: 0 | 1) =>
      h("input", {
        type: "number",
        step: "any",
        class: "number",
        disabled: isAtRest(state.task, point),
        title: isAtRest(state.task, point) ? "Without strain there is no stress" : null,
        value: Number((axis === 0 ? x(point[0]) : point[1]).toPrecision(6)),
        "aria-label": `Control point ${index + 1}, ${axis === 0 ? (polar ? "direction in degrees" : "strain") : TASK_WORDS[state.task].y}`,
        onchange: (event: Event) => edit(index, axis, (event.target as HTMLInputElement).value),
      });
    replace(
      points,
      h("table", {}, h("caption", {}, `Control points of ${named(state, state.others.length + 1)}`),
        h("thead", {},
          h("tr", {}, h("th", { scope: "col" }, "Point"), h("th", { scope: "col" }, polar ? "Direction (°)" : "Strain"), h("th", { scope: "col" }, TASK_WORDS[state.task].y))),
        h("tbody", {}, ...state.points.map((point, k) => h("tr", {}, h("th", { scope: "row" }, String(k + 1)), h("td", {}, field(point, k, 0)), h("td", {}, field(point, k, 1)))))),
    );
    if (focused >= 0) fields()[focused]?.focus();
  }

  function edit(index: number, axis: 0 | 1, text: string): void {
    const value = Number(text);
    const state = session.state.get();
    if (text === "" || !Number.isFinite(value)) return showPoints(true);
    const point = state.points[index];
    const to: ControlPoint = axis === 0 ? [isPolar(state.task) ? (value * Math.PI) / 180 : value, point[1]] : [point[0], value];
    session.apply({ points: movePoint(state.task, state.points, index, to, session.targetEdits.extent)[0], byHand: false });
    showPoints(true); // shows the clamped value if the entered one was out of bounds
  }

  details.addEventListener("toggle", show);
  session.results.shown.watch(show);
  session.state.watch(show);
  return details;
}
