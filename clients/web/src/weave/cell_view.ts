// A drawing of the deformed cell for the selected direction, repeated along its deformed translations.
import { Segments } from "../base/controls";
import { h, svg } from "../base/dom";
import { degrees, percent } from "../base/format";
import { boxAround, latticePoint, pathOf, type Polyline } from "../base/plane";
import type { Cell, DeformedCell } from "./deformed_cell";
import { blockOf, smoothed } from "./geometry";
import { centroid, restLines } from "./rest_lines";
import type { WeaveSession } from "./session";
import { isPeriodic, type Lattice, type Point } from "./state";

type Count = "1" | "2" | "3";

export function cellView(session: WeaveSession, deformed: DeformedCell): HTMLElement {
  const rest = svg("g", { class: "rest" });
  const strands = svg("g", { class: "strands" });
  const arrow = svg("path", { class: "pull" });
  const drawing = svg("svg", { class: "cell", role: "img", "aria-label": "No deformed cell yet", preserveAspectRatio: "xMidYMid meet" },
    svg("g", { transform: "scale(1,-1)" }, rest, strands, arrow));
  const words = h("p", { class: "muted" });
  const note = h("p", { class: "note", hidden: true });
  let count: Count = "2";
  const counts = new Segments<Count>("Cells", [{ value: "1", words: "1" }, { value: "2", words: "2 × 2" }, { value: "3", words: "3 × 3" }], (value) => {
    count = value;
    draw();
  });
  counts.value = count;

  function draw(): void {
    const cell = deformed.cell.get();
    const laidOut = session.laidOut.get();
    const periodic = isPeriodic(session.state.get());
    const fault = deformed.fault.get();
    // A fault that the layout reports, too, is not repeated here.
    note.textContent = !periodic || (fault && fault === session.fault.get()) ? "" : fault || cell?.note || "";
    note.hidden = note.textContent === "";
    drawing.classList.toggle("empty", !cell);
    element.classList.toggle("unrepeated", !periodic);
    drawing.toggleAttribute("hidden", !periodic);
    counts.element.hidden = !periodic;
    if (!cell || !laidOut?.layout.lattice) {
      for (const part of [rest, strands]) part.replaceChildren();
      arrow.setAttribute("d", "");
      words.textContent = periodic ? "" : "Only a cell that repeats has a stiffness in every direction. The sheet below can be put under load.";
      return;
    }
    const block = blockOf(Number(count));
    // The answer has a point for each node of the rods, which are smooth between them.
    const smooth = cell.strands.map((line, k) => smoothed(line, laidOut.layout.strands[k]?.ends !== "open"));
    const deformedBlock = centred(smooth, cell.lattice, block);
    const restBlock = centred(restLines(laidOut.layout), laidOut.layout.lattice as unknown as Lattice, block);
    const box = boxAround([...deformedBlock.corners, ...restBlock.corners]);
    // Both blocks and the picture are centred at the origin, so that the weave stretches from the middle.
    const side = 1.06 * Math.max(-2 * box.x, 2 * (box.x + box.width), -2 * box.y, 2 * (box.y + box.height));
    drawing.setAttribute("viewBox", `${-side / 2} ${-side / 2} ${side} ${side}`);
    const radii = laidOut.layout.strands.map((strand) => 2 * strand.radius);
    rest.replaceChildren(...tiles(restBlock, laidOut.layout.lattice as unknown as Lattice, block, radii));
    strands.replaceChildren(...tiles(deformedBlock, cell.lattice, block, radii));
    arrow.setAttribute("d", arrows(cell, side));
    arrow.setAttribute("stroke-width", String(side / 160));
    const sentence = `Strained by ${percent(cell.state.strain)} along ${degrees(cell.direction)}`;
    words.textContent = `${sentence}; faint: at rest.`;
    drawing.setAttribute("aria-label", `Deformed cells, ${sentence.toLowerCase()}`);
  }

  const element = h("div", { class: "panel" }, drawing, h("div", { class: "panel-words" }, h("div", { class: "row between" }, words, counts.element), note));
  for (const part of [session.laidOut, session.fault, deformed.cell, deformed.fault, session.state]) part.watch(draw);
  return element;
}

interface Block {
  readonly lines: readonly Polyline[];
  readonly offset: Point;
  readonly corners: readonly Point[];
}

/** A block of cells, moved so that its centre of mass is at the origin, with its bounding corners. */
function centred(lines: readonly Polyline[], lattice: Lattice, block: readonly Point[]): Block {
  const { x, y, width, height } = boxAround(lines.flat());
  const [first, last] = [latticePoint(lattice, ...block[0]), latticePoint(lattice, ...block[block.length - 1])];
  const [middleX, middleY] = centroid(lines);
  const offset: Point = [-middleX - (first[0] + last[0]) / 2, -middleY - (first[1] + last[1]) / 2];
  const corners = block.flatMap(([i, k]): Point[] => {
    const [u, v] = latticePoint(lattice, i, k);
    const [left, bottom] = [x + u + offset[0], y + v + offset[1]];
    return [[left, bottom], [left + width, bottom + height]];
  });
  return { lines, offset, corners };
}

function tiles({ lines, offset }: Block, lattice: Lattice, block: readonly Point[], widths: readonly number[]): SVGElement[] {
  const paths = lines.map((line, k) => svg("path", { d: pathOf(line), "stroke-width": widths[k] ?? widths[0] }));
  return block.map(([i, k]) => {
    const [x, y] = latticePoint(lattice, i, k);
    return svg("g", { transform: `translate(${x + offset[0]},${y + offset[1]})` }, ...paths.map((path) => path.cloneNode() as SVGElement));
  });
}

/** Two arrows at the border of the picture as the data of an SVG path. They point outwards for tension and inwards for compression. */
function arrows({ direction, state }: Cell, side: number): string {
  const [x, y] = [Math.cos(direction), Math.sin(direction)];
  const [outer, inner, wing] = [0.49 * side, 0.42 * side, 0.018 * side];
  const sign = state.strain > 0 ? 1 : -1;
  return [1, -1].map((end) => {
    const at = (along: number, across: number) => `${end * (along * x - across * y)} ${end * (along * y + across * x)}`;
    const [tip, tail] = sign > 0 ? [outer, inner] : [inner, outer];
    const back = tip - sign * 1.6 * wing;
    return `M${at(tail, 0)}L${at(tip, 0)}M${at(back, wing)}L${at(tip, 0)}L${at(back, -wing)}`;
  }).join("");
}
