// The editor of the weave at rest: crossings are buttons that change their connection, and the user can draw strands.
import { announce } from "../base/announce";
import { h, replace, svg } from "../base/dom";
import { digits } from "../base/format";
import { touchWords } from "../base/touch_words";
import { type Box, boxAround, latticePoint, pathOf } from "../base/plane";
import type { LayoutResult } from "./carried";
import { clickWords, type Crossing, connectionWords, crossingsSummary, crossingWords, slidingMembers } from "./connections";
import type { Draft } from "./draft";
import { blockOf, directionAt } from "./geometry";
import { roundedToGrid } from "./layout_edit";
import type { WeaveSession } from "./session";
import type { Lattice, Point, WeaveState } from "./state";

/** Radius of the marks of crossings: this fraction of the picture's side, but at most this ratio of the smallest distance of crossings. */
const MARK_FRACTION = 0.019;
const MARK_DISTANCE_RATIO = 0.36;
const COPIES = 3;
/** Side of the picture without strands, in mm. */
const EMPTY_SIDE = 40;

export class LayoutEditor {
  readonly element: HTMLElement;
  private readonly copies = svg("g", { class: "copies" });
  private readonly cell = svg("path", { class: "cell-border" });
  private readonly strands = svg("g", { class: "strands" });
  private readonly draftPath = svg("path", { class: "draft" });
  private readonly draftPoints = svg("g", { class: "draft-points" });
  private readonly crossings = svg("g", { class: "crossings" });
  private readonly plane = svg("g", { transform: "scale(1,-1)" }, this.copies, this.cell, this.strands, this.draftPath, this.draftPoints, this.crossings);
  private readonly drawing = svg("svg", { class: "layout", role: "group", "aria-label": "Weave at rest", preserveAspectRatio: "xMidYMid meet" }, this.plane);
  private readonly summary = h("p", { class: "muted" });
  private readonly fault = h("p", { class: "note", role: "alert", hidden: true });
  private readonly warnings = h("ul", { class: "warnings" });
  private side = 1;
  /** The crossing that was changed last; its new connection is announced when the layout has arrived. */
  private cycled: number | null = null;

  constructor(
    private readonly session: WeaveSession,
    private readonly draft: Draft,
  ) {
    this.element = h("div", { class: "panel" }, this.drawing, h("div", { class: "panel-words" }, this.summary, this.fault, this.warnings));
    session.laidOut.watch(() => this.draw());
    session.state.watch(() => {
      if (!session.laidOut.get()) this.draw();
    });
    session.fault.watch((sentence) => {
      this.fault.hidden = sentence === "";
      this.fault.textContent = sentence;
    });
    draft.points.watch(() => this.drawDraft());
    this.drawing.addEventListener("click", (event) => this.addPoint(event));
  }

  private draw(): void {
    const laidOut = this.session.laidOut.get();
    const state = laidOut?.state ?? this.session.state.get();
    // User-drawn strands have a lattice before there is a layout; patterns get theirs with the layout.
    const lattice = (laidOut?.layout.lattice ?? (state.pattern === "layout" ? state.layout.lattice : null)) as Lattice | null;
    const box = pictureBox(laidOut, state, lattice);
    this.side = Math.max(box.width, box.height);
    this.drawing.setAttribute("viewBox", `${box.x} ${-box.y - box.height} ${box.width} ${box.height}`);
    const paths = (laidOut?.layout.strands ?? []).map((strand) => svg("path", { d: pathOf(strand.polyline), "stroke-width": 2 * strand.radius }));
    this.strands.replaceChildren(...paths);
    this.drawCopies(paths, lattice);
    this.cell.setAttribute("d", lattice ? borderOf(cellCorner(laidOut, state, lattice), lattice) : "");
    this.cell.setAttribute("stroke-width", String(this.side / 250));
    this.cell.setAttribute("stroke-dasharray", `${this.side / 60} ${this.side / 80}`);
    this.drawCrossings(laidOut);
    this.drawDraft();
    this.summary.textContent = laidOut ? touchWords(`${crossingsSummary(laidOut.layout)}. ${clickWords(laidOut.layout)}`) : "No strands yet.";
    replace(this.warnings, ...(laidOut?.layout.warnings ?? []).map((sentence) => h("li", {}, sentence)));
  }

  private drawCopies(paths: readonly SVGPathElement[], lattice: Lattice | null): void {
    if (!lattice) return this.copies.replaceChildren();
    const others = blockOf(COPIES).filter(([i, k]) => i !== 0 || k !== 0);
    this.copies.replaceChildren(...others.map(([i, k]) => {
      const [x, y] = latticePoint(lattice, i, k);
      return svg("g", { transform: `translate(${x},${y})` }, ...paths.map((path) => path.cloneNode() as SVGElement));
    }));
  }

  /** Draws the marks of crossings. Their elements are reused, so that the focus stays. */
  private drawCrossings(laidOut: LayoutResult | null): void {
    const all = laidOut?.layout.crossings ?? [];
    while (this.crossings.children.length > all.length) this.crossings.lastChild?.remove();
    while (this.crossings.children.length < all.length) this.crossings.append(this.mark(this.crossings.children.length));
    const size = Math.min(MARK_FRACTION * this.side, MARK_DISTANCE_RATIO * minDistance(all));
    const changed = new Set(laidOut?.state.overrides.map((override) => override.crossing));
    all.forEach((crossing, k) => {
      const mark = this.crossings.children[k];
      const sliding = slidingMembers(crossing);
      mark.setAttribute("class", `crossing ${sliding.length > 0 ? "sliding" : "fused"}${changed.has(k) ? " changed" : ""}`);
      mark.setAttribute("aria-label", `${crossingWords(crossing, k)}${changed.has(k) ? ", changed by hand" : ""}`);
      mark.setAttribute("transform", `translate(${crossing.position[0]},${crossing.position[1]}) scale(${size})`);
      const lines = sliding.map((member) => {
        const { strand, coordinate } = crossing.members[member];
        const angle = directionAt(laidOut?.layout.strands[strand].polyline ?? [], coordinate);
        const [x, y] = [2.1 * Math.cos(angle), 2.1 * Math.sin(angle)];
        return `M${-x} ${-y}L${x} ${y}`;
      });
      mark.querySelector(".slide-line")?.setAttribute("d", lines.join(""));
      mark.querySelector("title")?.replaceChildren(crossingWords(crossing, k));
    });
    if (this.cycled !== null && all[this.cycled]) announce(`Crossing ${this.cycled + 1}: ${connectionWords(all[this.cycled])}.`, "change");
    this.cycled = null;
  }

  private mark(index: number): SVGGElement {
    const cycle = () => {
      this.cycled = index;
      this.session.cycle(index);
    };
    const mark = svg("g", { role: "button", tabindex: 0 }, svg("title"), svg("circle", { class: "hit", r: 2 }), svg("circle", { class: "halo", r: 1.9 }),
      svg("path", { class: "slide-line" }), svg("circle", { class: "dot", r: 1 }));
    mark.addEventListener("click", (event) => {
      if (this.draft.points.get() !== null) return; // the click adds a point to the draft
      event.stopPropagation();
      cycle();
    });
    mark.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      cycle();
    });
    return mark;
  }

  private drawDraft(): void {
    const points = this.draft.points.get();
    this.drawing.classList.toggle("drawing", points !== null);
    const radius = this.session.state.get().lengths.radius;
    this.draftPath.setAttribute("d", pathOf(points ?? []));
    this.draftPath.setAttribute("stroke-width", String(2 * radius));
    this.draftPoints.replaceChildren(...(points ?? []).map(([x, y]) => svg("circle", { cx: x, cy: y, r: this.side / 90 })));
  }

  private addPoint(event: MouseEvent): void {
    if (this.draft.points.get() === null) return;
    const matrix = this.plane.getScreenCTM();
    if (!matrix) return;
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
    const point: Point = event.altKey ? [Number(x.toFixed(3)), Number(y.toFixed(3))] : roundedToGrid([x, y]);
    this.draft.add(point);
    announce(`Point at ${digits(point[0])}, ${digits(point[1])}.`, "change");
  }
}

/** Lower left corner of the drawn cell: the origin for user-drawn strands; for patterns, the cell is centred on the strands. */
function cellCorner(laidOut: LayoutResult | null, state: WeaveState, [a, b]: Lattice): Point {
  if (state.pattern === "layout" || !laidOut) return [0, 0];
  const { x, y, width, height } = boxAround(laidOut.layout.strands.flatMap((strand) => strand.polyline));
  return [x + width / 2 - (a[0] + b[0]) / 2, y + height / 2 - (a[1] + b[1]) / 2];
}

function corners([x, y]: Point, [a, b]: Lattice): Point[] {
  return [[x, y], [x + a[0], y + a[1]], [x + a[0] + b[0], y + a[1] + b[1]], [x + b[0], y + b[1]]];
}

function borderOf(corner: Point, lattice: Lattice): string {
  return `${pathOf(corners(corner, lattice))}Z`;
}

/** The section of the plane in the picture: all strands and the cell, with a margin. */
function pictureBox(laidOut: LayoutResult | null, state: WeaveState, lattice: Lattice | null): Box {
  const points: Point[] = (laidOut?.layout.strands ?? []).flatMap((strand) => strand.polyline as unknown as Point[]);
  if (lattice) points.push(...corners(cellCorner(laidOut, state, lattice), lattice));
  if (points.length === 0) points.push([0, 0], [EMPTY_SIDE, EMPTY_SIDE]);
  const { width, height } = boxAround(points);
  return boxAround(points, 0.1 * Math.max(width, height));
}

function minDistance(crossings: readonly Crossing[]): number {
  // Crossings are sorted by x, so that only near ones are compared.
  const places = crossings.map((crossing) => crossing.position).sort((p, q) => p[0] - q[0]);
  let min = Infinity;
  places.forEach((p, k) => {
    for (let n = k + 1; n < places.length && places[n][0] - p[0] < min; ++n) {
      const distance = Math.hypot(places[n][0] - p[0], places[n][1] - p[1]);
      if (distance > 0) min = Math.min(min, distance);
    }
  });
  return min;
}
