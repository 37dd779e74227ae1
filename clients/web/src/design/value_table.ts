// Tables of the curves, for users who do not see the plot, and of the control points, with fields to edit them.
import { h, replace } from "../base/dom";
import { degrees, digits } from "../base/format";
import { showText } from "../base/writing";
import type { Task } from "../contract/types";
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

/** The text of a control point's cell: of its strain or of its direction in degrees (axis 0), or of its value (axis 1). */
export function cellText(polar: boolean, point: ControlPoint, axis: number): string {
  return String(Number((axis === 0 && polar ? (point[0] * 180) / Math.PI : point[axis]).toPrecision(6)));
}

/** A control point after a text was entered in one of its cells; null if the text is not a number. */
export function editedPoint(polar: boolean, point: ControlPoint, axis: number, text: string): ControlPoint | null {
  const value = Number(text);
  if (text.trim() === "" || !Number.isFinite(value)) return null;
  return axis === 0 ? [polar ? (value * Math.PI) / 180 : value, point[1]] : [point[0], value];
}

export function valueTable(session: DesignSession): HTMLElement {
  const curves = h("div", { class: "table-box dims", tabindex: 0, role: "region", "aria-label": "Values of the curves" });
  const { element: points, show: showPoints } = pointTable(session);
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

  details.addEventListener("toggle", show);
  session.redraws.follow([session.results.shown, session.state], () => details.open && showCurves());
  session.state.watch(() => details.open && showPoints());
  return details;
}

/** The table of the control points, with fields to edit them. */
function pointTable(session: DesignSession): { readonly element: HTMLElement; show(): void } {
  const points = h("div", { class: "table-box" });
  const caption = h("caption", {});
  /** The fields of each control point, by axis, and what they were built for. */
  let fields: readonly (readonly HTMLInputElement[])[] = [];
  let builtKind = "";

  /** Shows the control points. The fields stay where they are as long as their number and meaning do, because new fields would lose the focus on its way to the next cell. */
  function showPoints(): void {
    const { task, points: shown, others } = session.state.get();
    const kind = `${task} ${shown.length}`;
    if (kind !== builtKind) {
      builtKind = kind;
      buildPoints(task, shown.length);
    }
    caption.textContent = `Control points of ${named(session.state.get(), others.length + 1)}`;
    fields.forEach((row, k) => {
      const isFixed = isAtRest(task, shown[k]);
      row.forEach((input, axis) => {
        showText(input, cellText(isPolar(task), shown[k], axis));
        input.disabled = isFixed;
        input.title = isFixed ? "Without strain there is no stress" : "";
      });
    });
  }

  function buildPoints(task: Task, count: number): void {
    const polar = isPolar(task);
    const names = [polar ? "direction in degrees" : "strain", TASK_WORDS[task].y];
    fields = Array.from({ length: count }, (_, k) =>
      names.map((name, axis) =>
        h("input", {
          type: "number",
          step: "any",
          class: "number",
          "aria-label": `Control point ${k + 1}, ${name}`,
          onchange: (event: Event) => edit(k, axis, event.target as HTMLInputElement),
        })
      ));
    replace(
      points,
      h("table", {}, caption,
        h("thead", {},
          h("tr", {}, h("th", { scope: "col" }, "Point"), h("th", { scope: "col" }, polar ? "Direction (°)" : "Strain"), h("th", { scope: "col" }, TASK_WORDS[task].y))),
        h("tbody", {}, ...fields.map((row, k) => h("tr", {}, h("th", { scope: "row" }, String(k + 1)), ...row.map((input) => h("td", {}, input)))))),
    );
  }

  function edit(index: number, axis: number, input: HTMLInputElement): void {
    const state = session.state.get();
    const point = editedPoint(isPolar(state.task), state.points[index], axis, input.value);
    if (!point) return showPoints(); // the previous value replaces an entry that is not a number
    const [edited, at] = movePoint(state.task, state.points, index, point, session.targetEdits.extent);
    if (at !== index) followRow(index, at);
    session.apply({ points: edited, byHand: false });
    showPoints(); // shows the clamped value if the entered one was out of bounds
  }

  /** Over direction a point may pass others, and then has another row: the focus that stays in the row, or comes to it next, goes to the point's new row. */
  function followRow(from: number, to: number): void {
    const follow = (): void => {
      points.removeEventListener("focusin", follow);
      clearTimeout(timer);
      const axis = fields[from]?.indexOf(document.activeElement as HTMLInputElement) ?? -1;
      if (axis < 0) return;
      fields[to]?.[axis]?.focus();
      fields[to]?.[axis]?.select();
    };
    // Tab moves the focus right after the change; Enter leaves it where it is.
    points.addEventListener("focusin", follow);
    const timer = setTimeout(follow);
  }

  return { element: points, show: showPoints };
}
