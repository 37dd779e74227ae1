// The menu of example targets, each with a sketch of its curve.
import { announce } from "../base/announce";
import { h, svg } from "../base/dom";
import { menu } from "../base/menu";
import type { DesignSession } from "./session";
import { spaced, targetCurve } from "./spline";
import { type Start, STARTS, startState } from "./starts";
import { isPolar } from "./state";

const SIDE = 64;
const SAMPLES = 121;

export function startMenu(session: DesignSession): HTMLDetailsElement {
  const list = h("ul", { class: "starts" });
  const element = menu("Examples", "target", h("h3", {}, "Targets to start from"), list);
  element.classList.add("start-menu");
  list.append(
    ...STARTS.map((start) =>
      h("li", {}, h("button", {
        type: "button",
        class: "start",
        onclick: () => choose(start),
      }, targetSketch(start), h("span", { class: "start-words" }, h("strong", {}, start.name), h("span", { class: "muted" }, start.words))))
    ),
  );

  function choose(start: Start): void {
    beginWith(session, start);
    element.open = false;
  }
  return element;
}

/** Makes an example the target. */
export function beginWith(session: DesignSession, start: Start): void {
  session.apply(startState(start));
  announce(`${start.name}: ${start.words}`, "change");
}

/** A small drawing of the curve with an axis. */
export function targetSketch({ state: { task, points, interpolation } }: Start): SVGSVGElement {
  const polar = isPolar(task);
  const x = polar ? spaced(0, 2 * Math.PI, SAMPLES) : spaced(points[0][0], points[points.length - 1][0], SAMPLES);
  const y = x.map(targetCurve(polar, points, interpolation));
  const [min, max] = [Math.min(0, ...y), Math.max(0, ...y)];
  const pointAt = (k: number): string => {
    const fraction = (y[k] - min) / (max - min || 1);
    const [across, up] = polar ? [0.5 + 0.46 * fraction * Math.cos(x[k]), 0.5 + 0.46 * fraction * Math.sin(x[k])] : [0.06 + (0.88 * k) / (SAMPLES - 1), 0.08 + 0.84 * fraction];
    return `${(SIDE * across).toFixed(1)},${(SIDE * (1 - up)).toFixed(1)}`;
  };
  const axis = polar ? `M0,${SIDE / 2}H${SIDE}M${SIDE / 2},0V${SIDE}` : `M0,${SIDE * (1 - 0.08 - (0.84 * -min) / (max - min || 1))}H${SIDE}`;
  return svg("svg", { class: "sketch", viewBox: `0 0 ${SIDE} ${SIDE}`, "aria-hidden": "true" }, svg("path", { class: "zero", d: axis }),
    svg("path", { class: "curve target-sketch", d: `M${x.map((_, k) => pointAt(k)).join("L")}` }));
}
