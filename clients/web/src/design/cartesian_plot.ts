// Stress over strain.
import { axisBottom, axisLeft } from "d3-axis";
import { scaleLinear } from "d3-scale";
import { select } from "d3-selection";
import { area, curveMonotoneX, line } from "d3-shape";
import { type Curve, pieces } from "../base/curve";
import { svg, uniqueId } from "../base/dom";
import { digits } from "../base/format";
import { heightDomain, widthDomain } from "../base/domains";
import { Handles, pixelsOf } from "./handles";
import type { PlotView, PlotWishes } from "./plot";
import type { Band } from "./shown";
import { type ControlPoint, TASK_WORDS } from "./state";
import { spaced } from "./spline";

const MARGIN = { top: 18, right: 18, bottom: 46, left: 62 };
const TARGET_STEPS = 160;

export class CartesianPlot {
  readonly element = svg("svg", { class: "plot cartesian", role: "group", "aria-label": "Target and response: stress over strain" });
  private readonly x = scaleLinear();
  private readonly y = scaleLinear();
  private readonly clip = uniqueId("plot-area");
  private readonly clipBox = svg("rect");
  private readonly ground = svg("rect", { class: "ground" });
  private readonly xAxis = svg("g", { class: "axis" });
  private readonly yAxis = svg("g", { class: "axis" });
  private readonly xTitle = svg("text", { class: "axis-title", "text-anchor": "end" });
  private readonly yTitle = svg("text", { class: "axis-title" });
  private readonly zero = svg("path", { class: "zero" });
  private readonly envelope = svg("path", { class: "envelope" });
  private readonly envelopeRim = svg("path", { class: "envelope-rim" });
  private readonly doubt = svg("path", { class: "doubt" });
  private readonly pins = svg("g", { class: "pinned" });
  private readonly before = svg("path", { class: "curve before" });
  private readonly target = svg("path", { class: "curve target" });
  private readonly achieved = svg("path", { class: "curve achieved" });
  private readonly verified = svg("g", { class: "verified" });
  private readonly missed = svg("g", { class: "missed" });
  private readonly handles: Handles;
  private width = 640;
  private height = 420;
  private view: PlotView | null = null;

  constructor(private readonly wishes: PlotWishes) {
    this.handles = new Handles(
      this.element,
      {
        toPixels: ([x, y]) => [this.x(x), this.y(y)],
        toPoint: ([x, y]) => [this.x.invert(this.withinX(x)), this.y.invert(this.withinY(y))],
        nudged: ([x, y], [right, up]) => [
          x + right * (this.x.domain()[1] - this.x.domain()[0]),
          y + up * (this.y.domain()[1] - this.y.domain()[0]),
        ],
        describe: ([x, y]) => `strain ${digits(x)}, stress ${digits(y)} MPa`,
        echoes: () => [],
        heights: () => this.y.domain(),
      },
      wishes,
    );
    const clipped = { "clip-path": `url(#${this.clip})` };
    this.element.append(
      svg("defs", {}, svg("clipPath", { id: this.clip }, this.clipBox)),
      this.ground,
      svg("g", clipped, this.envelope, this.envelopeRim),
      this.xAxis, this.yAxis, this.xTitle, this.yTitle,
      svg("g", clipped, this.zero, this.doubt, this.pins, this.before, this.target, this.missed, this.achieved, this.verified),
      this.handles.group,
    );
    this.ground.addEventListener("dblclick", (event) => this.add(event));
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
    this.layOut();
    if (!view.dragging || !this.view) this.fitDomains(view);
    this.view = view;
    this.drawAxes(view);
    const rim = this.drawBand(this.envelope, view.envelope);
    this.envelopeRim.setAttribute("d", rim);
    this.drawBand(this.doubt, view.doubt);
    const targetX = view.points.map((point) => point[0]);
    const target = spaced(targetX[0] ?? 0, targetX[targetX.length - 1] ?? 1, TARGET_STEPS);
    this.target.setAttribute("d", this.straight(target.map((x) => [x, view.target(x)])));
    this.draw(this.before, view.before);
    this.draw(this.achieved, view.achieved);
    this.achieved.classList.toggle("provisional", view.provisional);
    this.drawPins(view);
    this.drawMarks(this.verified, view.verified ? pieces(view.verified).flat() : [], "M0,-5L5,0L0,5L-5,0Z");
    this.drawMarks(this.missed, view.missed, "M-3.5,-3.5L3.5,3.5M-3.5,3.5L3.5,-3.5");
    this.handles.update(view);
  }

  private withinX(pixels: number): number {
    return Math.max(MARGIN.left, Math.min(this.width - MARGIN.right, pixels));
  }

  private withinY(pixels: number): number {
    return Math.max(MARGIN.top, Math.min(this.height - MARGIN.bottom, pixels));
  }

  private add(event: MouseEvent): void {
    const [x, y] = pixelsOf(this.element, event);
    this.wishes.add([this.x.invert(x), this.y.invert(y)]);
  }

  private layOut(): void {
    const { width, height } = this;
    this.element.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.element.setAttribute("width", String(width));
    this.element.setAttribute("height", String(height));
    for (const box of [this.clipBox, this.ground]) {
      box.setAttribute("x", String(MARGIN.left));
      box.setAttribute("y", String(MARGIN.top));
      box.setAttribute("width", String(Math.max(0, width - MARGIN.left - MARGIN.right)));
      box.setAttribute("height", String(Math.max(0, height - MARGIN.top - MARGIN.bottom)));
    }
    this.x.range([MARGIN.left, width - MARGIN.right]);
    this.y.range([height - MARGIN.bottom, MARGIN.top]);
  }

  private fitDomains(view: PlotView): void {
    const curves = [view.achieved, view.before, view.verified, ...view.pins].filter((curve): curve is Curve => curve !== null);
    this.x.domain(widthDomain([...view.points.map((p) => p[0]), ...curves.flatMap((curve) => [curve.x[0], curve.x[curve.x.length - 1]])]));
    this.y.domain(heightDomain([...view.points.map((p) => p[1]), ...curves.flatMap((curve) => [...curve.y])]));
  }

  private drawAxes(view: PlotView): void {
    const ticks = Math.max(3, Math.round(this.width / 90));
    const rows = Math.max(3, Math.round(this.height / 60));
    const inner = this.height - MARGIN.top - MARGIN.bottom;
    const across = this.width - MARGIN.left - MARGIN.right;
    this.xAxis.setAttribute("transform", `translate(0,${this.height - MARGIN.bottom})`);
    this.yAxis.setAttribute("transform", `translate(${MARGIN.left},0)`);
    select(this.xAxis).call(axisBottom(this.x).ticks(ticks).tickSize(-inner).tickPadding(9));
    select(this.yAxis).call(axisLeft(this.y).ticks(rows).tickSize(-across).tickPadding(9));
    this.xTitle.textContent = view.strainWord;
    this.xTitle.setAttribute("x", String(this.width - MARGIN.right));
    this.xTitle.setAttribute("y", String(this.height - 8));
    this.yTitle.textContent = `${TASK_WORDS[view.task].y} (MPa)`;
    this.yTitle.setAttribute("x", String(MARGIN.left + 8));
    this.yTitle.setAttribute("y", String(MARGIN.top + 14));
    const [x, y] = [this.x(0), this.y(0)];
    this.zero.setAttribute("d", `M${MARGIN.left},${y}H${this.width - MARGIN.right}M${x},${MARGIN.top}V${this.height - MARGIN.bottom}`);
  }

  /** Returns the path of its upper and lower end. */
  private drawBand(path: SVGPathElement, band: Band | null): string {
    const samples = band ? band.x.map((x, k): [number, number, number] => [x, band.lower[k], band.upper[k]]) : [];
    const shape = area<[number, number, number]>()
      .x((sample) => this.x(sample[0]))
      .y0((sample) => this.far(sample[1]))
      .y1((sample) => this.far(sample[2]))
      .curve(curveMonotoneX);
    path.setAttribute("d", shape(samples) ?? "");
    return (shape.lineY0()(samples) ?? "") + (shape.lineY1()(samples) ?? "");
  }

  /** A height in pixels; what lies far outside comes nearer, for the drawing's sake. */
  private far(y: number): number {
    return Math.max(-2 * this.height, Math.min(3 * this.height, this.y(y)));
  }

  private draw(path: SVGPathElement, curve: Curve | null): void {
    const shape = line<ControlPoint>().x((p) => this.x(p[0])).y((p) => this.far(p[1])).curve(curveMonotoneX);
    path.setAttribute("d", curve ? pieces(curve).map((piece) => shape([...piece]) ?? "").join("") : "");
  }

  private straight(points: ControlPoint[]): string {
    return line<ControlPoint>().x((p) => this.x(p[0])).y((p) => this.far(p[1]))(points) ?? "";
  }

  private drawPins(view: PlotView): void {
    this.pins.replaceChildren(
      ...view.pins.map((pin) => {
        const path = svg("path", { class: `curve pin pin-${pin.id % 6}` }, svg("title", {}, pin.name));
        this.draw(path, pin);
        return path;
      }),
    );
  }

  private drawMarks(group: SVGGElement, points: readonly ControlPoint[], mark: string): void {
    group.replaceChildren(...points.map(([x, y]) => svg("path", { d: mark, transform: `translate(${this.x(x)},${this.far(y)})` })));
  }
}
