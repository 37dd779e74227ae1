// The plot of stress over strain.
import { axisBottom, axisLeft } from "d3-axis";
import { scaleLinear } from "d3-scale";
import { select } from "d3-selection";
import { area, curveMonotoneX, line } from "d3-shape";
import { type Curve, pieces } from "../base/curve";
import { svg, uniqueId } from "../base/dom";
import { digits } from "../base/format";
import { Handles } from "../base/handles";
import { heightDomain, widthDomain } from "../base/domains";
import { panned, section, zoomedAt } from "../base/plot_zoom";
import { CONTROL_POINT_NAMES, type PlotActions, type PlotView } from "./plot";
import { type Pixels, ProfilePlot } from "./profile_plot";
import type { Band } from "./shown";
import { type ControlPoint, TASK_WORDS } from "./state";
import { spaced } from "./spline";
import { isAtRest } from "./targets";

const MARGIN = { top: 18, right: 18, bottom: 46, left: 62 };
const TARGET_STEPS = 160;

export class CartesianPlot extends ProfilePlot {
  protected readonly handles: Handles;
  private readonly x = scaleLinear();
  private readonly y = scaleLinear();
  private readonly clip = uniqueId("plot-area");
  private readonly clipBox = svg("rect");
  private readonly plane = svg("rect", { class: "ground" });
  private readonly xAxis = svg("g", { class: "axis" });
  private readonly yAxis = svg("g", { class: "axis" });
  private readonly xTitle = svg("text", { class: "axis-title", "text-anchor": "end" });
  private readonly yTitle = svg("text", { class: "axis-title" });
  private readonly zero = svg("path", { class: "zero" });

  constructor(actions: PlotActions) {
    super("cartesian", "Target and response: stress over strain", actions);
    this.handles = new Handles(
      this.element,
      {
        toPixels: ([x, y]) => [this.x(x), this.y(y)],
        grab: () => {},
        toPoint: (pixels) => this.pointAt(pixels),
        isFixed: (point) => isAtRest("stress_strain", point),
        nudged: ([x, y], [right, up]) => [
          x + right * (this.x.domain()[1] - this.x.domain()[0]),
          y + up * (this.y.domain()[1] - this.y.domain()[0]),
        ],
        describe: ([x, y]) => `strain ${digits(x)}, stress ${digits(y)} MPa${isAtRest("stress_strain", [x, y]) ? ", at rest: it stays there" : ""}`,
        echoes: () => [],
        heights: () => this.y.domain(),
      },
      actions,
      CONTROL_POINT_NAMES,
    );
    const clipped = { "clip-path": `url(#${this.clip})` };
    this.backdrop.append(
      svg("defs", {}, svg("clipPath", { id: this.clip }, this.clipBox)),
      this.plane,
      svg("g", clipped, ...this.layersBelowAxes),
      this.xAxis,
      this.yAxis,
      this.xTitle,
      this.yTitle,
      svg("g", clipped, this.zero, ...this.layersAboveAxes),
    );
    this.element.append(this.backdrop, this.handles.group);
  }

  protected scaleToSize(): void {
    this.x.range([MARGIN.left, this.width - MARGIN.right]);
    this.y.range([this.height - MARGIN.bottom, MARGIN.top]);
  }

  protected axesKey({ task, strainWord }: PlotView): string {
    return [task, strainWord, this.width, this.height, ...this.x.domain(), ...this.y.domain()].join(" ");
  }

  protected layOut(): void {
    const { width, height } = this;
    for (const box of [this.clipBox, this.plane]) {
      box.setAttribute("x", String(MARGIN.left));
      box.setAttribute("y", String(MARGIN.top));
      box.setAttribute("width", String(Math.max(0, width - MARGIN.left - MARGIN.right)));
      box.setAttribute("height", String(Math.max(0, height - MARGIN.top - MARGIN.bottom)));
    }
  }

  protected fitDomains(view: PlotView, curves: readonly Curve[]): void {
    const width = widthDomain([...[...view.points, ...view.measured].map((p) => p[0]), ...curves.flatMap((curve) => [curve.x[0], curve.x[curve.x.length - 1]])]);
    const height = heightDomain([...[...view.points, ...view.measured].map((p) => p[1]), ...curves.flatMap((curve) => [...curve.y])]);
    this.x.domain(section(width, this.across));
    this.y.domain(section(height, this.up));
    // Control points outside of the visible section would lie on the axes.
    if (this.isZoomed) this.handles.group.setAttribute("clip-path", `url(#${this.clip})`);
    else this.handles.group.removeAttribute("clip-path");
  }

  protected zoomBy(by: number, [x, y]: Pixels, [right, down]: Pixels): void {
    const [left, end] = this.x.range();
    const [bottom, top] = this.y.range();
    this.across = panned(zoomedAt(this.across, by, (x - left) / (end - left)), right / (end - left));
    this.up = panned(zoomedAt(this.up, by, (y - bottom) / (top - bottom)), down / (top - bottom));
  }

  protected drawAxes(view: PlotView): void {
    const ticks = Math.max(3, Math.round(this.width / 90));
    const rows = Math.max(3, Math.round(this.height / 60));
    const innerHeight = this.height - MARGIN.top - MARGIN.bottom;
    const innerWidth = this.width - MARGIN.left - MARGIN.right;
    this.xAxis.setAttribute("transform", `translate(0,${this.height - MARGIN.bottom})`);
    this.yAxis.setAttribute("transform", `translate(${MARGIN.left},0)`);
    select(this.xAxis).call(axisBottom(this.x).ticks(ticks).tickSize(-innerHeight).tickPadding(9));
    select(this.yAxis).call(axisLeft(this.y).ticks(rows).tickSize(-innerWidth).tickPadding(9));
    this.xTitle.textContent = view.strainWord;
    this.xTitle.setAttribute("x", String(this.width - MARGIN.right));
    this.xTitle.setAttribute("y", String(this.height - 8));
    this.yTitle.textContent = `${TASK_WORDS[view.task].y} (MPa)`;
    this.yTitle.setAttribute("x", String(MARGIN.left + 8));
    this.yTitle.setAttribute("y", String(MARGIN.top + 14));
    const [x, y] = [this.x(0), this.y(0)];
    this.zero.setAttribute("d", `M${MARGIN.left},${y}H${this.width - MARGIN.right}M${x},${MARGIN.top}V${this.height - MARGIN.bottom}`);
  }

  protected targetPath(view: PlotView): string {
    const ends = view.points.map((point) => point[0]);
    const steps = spaced(ends[0] ?? 0, ends[ends.length - 1] ?? 1, TARGET_STEPS);
    const shape = line<number>().x((x) => this.x(x)).y((x) => this.clampedHeight(view.target(x)));
    return shape(steps) ?? "";
  }

  protected curvePath(curve: Curve): string {
    const shape = line<ControlPoint>().x((p) => this.x(p[0])).y((p) => this.clampedHeight(p[1])).curve(curveMonotoneX);
    return pieces(curve).map((piece) => shape([...piece]) ?? "").join("");
  }

  protected bandPath(band: Band): { area: string; rim: string } {
    const samples = band.x.map((x, k): [number, number, number] => [x, band.lower[k], band.upper[k]]);
    const shape = area<[number, number, number]>()
      .x((sample) => this.x(sample[0]))
      .y0((sample) => this.clampedHeight(sample[1]))
      .y1((sample) => this.clampedHeight(sample[2]))
      .curve(curveMonotoneX);
    return { area: shape(samples) ?? "", rim: (shape.lineY0()(samples) ?? "") + (shape.lineY1()(samples) ?? "") };
  }

  protected guidePath(x: number): string {
    return `M${this.x(x)},${MARGIN.top}V${this.height - MARGIN.bottom}`;
  }

  protected places([x, y]: ControlPoint): readonly Pixels[] {
    return [[this.x(x), this.clampedHeight(y)]];
  }

  /** A stress in pixels. Values far outside the plot are clamped, so that the coordinates of paths stay small. */
  private clampedHeight(y: number): number {
    return Math.max(-2 * this.height, Math.min(3 * this.height, this.y(y)));
  }

  private withinX(pixels: number): number {
    return Math.max(MARGIN.left, Math.min(this.width - MARGIN.right, pixels));
  }

  private withinY(pixels: number): number {
    return Math.max(MARGIN.top, Math.min(this.height - MARGIN.bottom, pixels));
  }

  protected pointAt([x, y]: Pixels): ControlPoint {
    return [this.x.invert(this.withinX(x)), this.y.invert(this.withinY(y))];
  }
}
