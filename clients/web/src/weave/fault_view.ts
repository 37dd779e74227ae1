// A drawing of a sheet that cannot be printed, with the crossings and strands at fault in red.
import { h, replace, svg } from "../base/dom";
import { boxAround, pathOf } from "../base/plane";
import type { WeaveLayout } from "../contract/types";
import { crossingWords } from "./connections";

/** Radius of a mark, as a fraction of the larger side of the sheet. */
const MARK_FRACTION = 0.022;
const MARGIN_FRACTION = 0.05;

/** Indices of what is at fault. */
export interface Marked {
  readonly crossings: readonly number[];
  readonly strands: readonly number[];
}

export class FaultView {
  private readonly drawing = svg("svg", { class: "fault-sheet", role: "img", preserveAspectRatio: "xMidYMid meet" });
  readonly element = h("div", { class: "fault-stage", hidden: true }, this.drawing);

  /** Shows a sheet; nothing without a sheet or without anything to mark. */
  show(sheet: WeaveLayout | null, { crossings, strands }: Marked): void {
    const marked = crossings.flatMap((index) => (sheet?.crossings[index] ? [{ index, crossing: sheet.crossings[index] }] : []));
    this.element.hidden = !sheet || (marked.length === 0 && strands.length === 0);
    if (!sheet || this.element.hidden) return replace(this.drawing);
    const all = boxAround(sheet.strands.flatMap(({ polyline }) => polyline));
    const side = Math.max(all.width, all.height);
    const { x, y, width, height } = boxAround(sheet.strands.flatMap(({ polyline }) => polyline), MARGIN_FRACTION * side);
    this.drawing.setAttribute("viewBox", `${x} ${-y - height} ${width} ${height}`);
    this.drawing.setAttribute("aria-label", `The sheet from above, with ${counted(marked.length, "crossing")} and ${counted(strands.length, "strand")} at fault in red`);
    const faulty = new Set(strands);
    replace(this.drawing,
      svg("g", { transform: "scale(1,-1)" },
        ...sheet.strands.map(({ polyline, radius }, k) => svg("path", { class: faulty.has(k) ? "fault-strand" : "strand", d: pathOf(polyline), "stroke-width": 2 * radius })),
        ...marked.map(({ index, crossing }) =>
          svg("circle", { class: "fault-mark", cx: crossing.position[0], cy: crossing.position[1], r: MARK_FRACTION * side }, svg("title", {}, crossingWords(crossing, index)))
        )));
  }
}

function counted(count: number, noun: string): string {
  return `${count} ${noun}${count === 1 ? "" : "s"}`;
}
