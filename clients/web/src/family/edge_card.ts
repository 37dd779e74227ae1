// The shapes of the tile's edges: what each class allows, how each is drawn, and heights that become parameters.
import { button, Select } from "../base/controls";
import { h, writeText } from "../base/dom";
import { keepFocus } from "../base/focus";
import { rebuild } from "../base/writing";
import type { EdgeShape } from "../contract/types";
import { canAddParameter, changedLine, hasFixedHeight, heightAsParameter, type LineKind, lineOf, shapeName, withPoint } from "./edits";
import type { FamilySession } from "./session";

const CLASS_WORDS: Record<EdgeShape["class"], string> = {
  J: "any curve",
  S: "looks the same after half a turn",
  U: "looks the same in a mirror",
  I: "always straight",
};
const LINES: readonly { readonly value: LineKind; readonly words: string }[] = [
  { value: "straight", words: "Straight" },
  { value: "curve", words: "Curve" },
  { value: "bent", words: "Bent line" },
];

export function classWords(kind: EdgeShape["class"]): string {
  return `${kind}: ${CLASS_WORDS[kind]}`;
}

interface Row {
  readonly element: HTMLElement;
  show(shape: EdgeShape): void;
}

export function edgeCard(session: FamilySession): HTMLElement {
  const list = h("ul", { class: "edge-shapes", "aria-label": "Shapes of edges" });
  const element = h("section", { class: "card", "aria-label": "Edges" }, h("h2", {}, "Edges"),
    h("p", { class: "muted" }, "Edges with the same letter have the same shape. Drag the small circles on them, or bend them here."), list);
  let rows: Row[] = [];
  let builtKey = "";
  session.redraws.follow([session.state, session.drawn], () => {
    const shapes = session.drawn.get()?.shapes ?? [];
    const key = shapes.map((shape) => shape.class).join();
    if (key !== builtKey) {
      builtKey = key;
      rows = shapes.map((shape, k) => edgeRow(session, k, shape.class));
      rebuild(list, () => rows.map((row) => row.element));
    }
    element.hidden = shapes.length === 0;
    rows.forEach((row, k) => row.show(shapes[k]));
  });
  return element;
}

function edgeRow(session: FamilySession, index: number, kind: EdgeShape["class"]): Row {
  const name = shapeName(index);
  const line = new Select<LineKind>(`Edges ${name}`, LINES, (value) => session.edit((family, edited) => changedLine(family, edited, index, value)));
  const height = button("Height as a parameter", () => session.edit((family, edited) => heightAsParameter(family, edited, index)), { kind: "quiet" });
  const point = button("Add a point", () => {
    const selected = session.selected.get();
    session.edit((family, edited) => {
      const last = (family.shapes[index].points?.length ?? 1) - 1;
      const at = selected?.kind === "point" && selected.shape === index ? selected.point : last;
      return withPoint(family, edited, index, at);
    });
  }, { kind: "quiet", title: "Adds a point before the chosen one; Delete on a point removes it" });
  const words = h("p", { class: "muted" });
  for (const control of [height, point]) control.setAttribute("aria-label", `${control.textContent} (edges ${name})`);
  const element = h("li", {}, kind !== "I" && line.element, words, h("div", { class: "row" }, height, point));
  const next = [...element.querySelectorAll<HTMLElement>("select"), point];
  return {
    element,
    show(shape) {
      line.value = lineOf(shape);
      writeText(words, kind === "I" ? `Edges ${name}: ${CLASS_WORDS.I}` : classWords(shape.class));
      keepFocus(element, () => {
        height.hidden = !hasFixedHeight(shape);
        height.disabled = !canAddParameter(session.state.get().definition);
        point.hidden = !shape.points;
      }, ...next);
    },
  };
}
