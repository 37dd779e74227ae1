// Stiffness or Poisson's ratio over direction. The profile has the period pi: each half is the other's picture.
import { type ScaleLinear, scaleLinear } from "d3-scale";
import { type Curve, pieces } from "../base/curve";
import { svg, uniqueId } from "../base/dom";
import { radialDomain } from "../base/domains";
import { degrees, digits } from "../base/format";
import { polarGrid, polarPath } from "../base/polar";
import { Handles, pixelsOf } from "./handles";
import type { PlotView, PlotWishes } from "./plot";
import type { Band } from "./shown";
import { type ControlPoint, TASK_WORDS } from "./state";
import { spaced } from "./spline";
import { wrapped } from "./targets";

const MARGIN = 40;
const TARGET_STEPS = 181;

export class PolarPlot {
  readonly element = svg("svg", { class: "plot polar", role: "group", "aria-label": "Target and response over direction" });
  private readonly radius: ScaleLinear<number, number> = scaleLinear();
  private readonly centre = svg("g");
  private readonly ground = svg("circle", { class: "ground" });
  private readonly clip = uniqueId("plot-area");
  private readonly clipCircle = svg("circle");
  private readonly grid = svg("g", { class: "axis" });
  private readonly envelope = svg("path", { class: "envelope", "fill-rule": "evenodd" });
  private readonly doubt = svg("path", { class: "doubt", "fill-rule": "evenodd" });
  private readonly pins = svg("g", { class: "pinned" });
  private readonly before = svg("path", { class: "curve before" });
  private readonly target = svg("path", { class: "curve target" });
  private readonly achieved = svg("path", { class: "curve achieved" });
  private readonly verified = svg("g", { class: "verified" });
  private readonly missed = svg("g", { class: "missed" });
  private readonly title = svg("text", { class: "axis-title", x: 12, y: 22 });
  private readonly handles: Handles;
  private width = 640;
  private height = 420;
  private view: PlotView | null = null;

  constructor(private readonly wishes: PlotWishes) {
    this.handles = new Handles(
      this.element,
      {
        toPixels: (point) => this.pixels(point),
        toPoint: (pixels) => this.point(pixels),
        nudged: ([x, y], [right, up]) => [
          wrapped(x - right * Math.PI),
          Math.max(this.radius.domain()[0], y + up * (this.radius.domain()[1] - this.radius.domain()[0])),
        ],
        describe: ([x, y]) => `direction ${degrees(x)}, ${this.unitWords(y)}`,
        echoes: ([x, y]) => [this.pixels([x + Math.PI, y])],
        heights: () => this.radius.domain(),
      },
      wishes,
    );
    const reach = svg("g", { "clip-path": `url(#${this.clip})` }, this.envelope);
    this.centre.append(svg("defs", {}, svg("clipPath", { id: this.clip }, this.clipCircle)), this.ground, reach, this.grid, this.doubt, this.pins, this.before, this.target, this.missed, this.achieved, this.verified);
    this.element.append(this.centre, this.title, this.handles.group);
    this.ground.addEventListener("dblclick", (event) => this.wishes.add(this.point(pixelsOf(this.element, event))));
    this.ground.addEventListener("pointerdown", () => this.wishes.select(null));
  }

  resize(width: number, height: number): void {
    if (width === this.width && height === this.height) return;
    this.width = width;
    this.height = height;
    if (this.view) this.update(this.view);
  }

  focus(index: number): void {
    this.handles.focus(index);
  }

  follow(index: number): void {
    this.handles.follow(index);
  }

  update(view: PlotView): void {
    this.element.setAttribute("viewBox", `0 0 ${this.width} ${this.height}`);
    this.element.setAttribute("width", String(this.width));
    this.element.setAttribute("height", String(this.height));
    this.centre.setAttribute("transform", `translate(${this.width / 2},${this.height / 2})`);
    const rim = Math.max(20, Math.min(this.width, this.height) / 2 - MARGIN);
    this.radius.range([0, rim]);
    for (const circle of [this.ground, this.clipCircle]) circle.setAttribute("r", String(rim));
    if (!view.dragging || this.view?.task !== view.task) this.fitDomain(view);
    this.view = view;
    this.drawGrid(view);
    this.drawBand(this.envelope, view.envelope);
    this.drawBand(this.doubt, view.doubt);
    const directions = spaced(0, Math.PI, TARGET_STEPS);
    this.draw(this.target, { x: directions, y: directions.map(view.target) });
    this.draw(this.before, view.before);
    this.draw(this.achieved, view.achieved);
    this.achieved.classList.toggle("provisional", view.provisional);
    this.pins.replaceChildren(
      ...view.pins.map((pin) => {
        const path = svg("path", { class: `curve pin pin-${pin.id % 6}` }, svg("title", {}, pin.name));
        this.draw(path, pin);
        return path;
      }),
    );
    this.drawMarks(this.verified, view.verified ? pieces(view.verified).flat() : [], "M0,-5L5,0L0,5L-5,0Z");
    this.drawMarks(this.missed, view.missed, "M-3.5,-3.5L3.5,3.5M-3.5,3.5L3.5,-3.5");
    this.handles.update(view);
  }

  private unitWords(y: number): string {
    return this.view?.task === "poisson" ? `Poisson’s ratio ${digits(y)}` : `stiffness ${digits(y)} MPa`;
  }

  private away(y: number): number {
    return Math.max(0, Math.min(4 * this.radius.range()[1], this.radius(y)));
  }

  private pixels([x, y]: ControlPoint): readonly [number, number] {
    const r = this.away(y);
    return [this.width / 2 + r * Math.cos(x), this.height / 2 - r * Math.sin(x)];
  }

  private point([x, y]: readonly [number, number]): ControlPoint {
    const [right, up] = [x - this.width / 2, this.height / 2 - y];
    const r = Math.min(Math.hypot(right, up), this.radius.range()[1]);
    return [wrapped(Math.atan2(up, right)), this.radius.invert(r)];
  }

  private fitDomain(view: PlotView): void {
    const curves = [view.achieved, view.before, view.verified, ...view.pins].filter((curve): curve is Curve => curve !== null);
    this.radius.domain(radialDomain(view.task, [...view.points.map((p) => p[1]), ...curves.flatMap((curve) => [...curve.y])]));
  }

  private drawGrid(view: PlotView): void {
    this.grid.replaceChildren(...polarGrid(this.radius));
    const { y, unit } = TASK_WORDS[view.task];
    this.title.textContent = unit ? `${y} (${unit})` : y;
  }

  private drawBand(path: SVGPathElement, band: Band | null): void {
    if (!band) return path.setAttribute("d", "");
    const ring = (y: readonly number[]) => polarPath({ x: band.x, y }, (value) => this.away(value));
    path.setAttribute("d", ring(band.upper) + ring(band.lower));
  }

  private draw(path: SVGPathElement, curve: Curve | null): void {
    path.setAttribute("d", curve ? polarPath(curve, (value) => this.away(value)) : "");
  }

  private drawMarks(group: SVGGElement, points: readonly ControlPoint[], mark: string): void {
    const both = points.flatMap(([x, y]): ControlPoint[] => [[x, y], [x + Math.PI, y]]);
    group.replaceChildren(
      ...both.map(([x, y]) => svg("path", { d: mark, transform: `translate(${this.away(y) * Math.cos(x)},${-this.away(y) * Math.sin(x)})` })),
    );
  }
}
