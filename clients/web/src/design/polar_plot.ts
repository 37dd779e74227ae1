// The plot of stiffness or Poisson's ratio over direction. Profiles have period pi: each half turn repeats the other.
import { type ScaleLinear, scaleLinear } from "d3-scale";
import type { Curve } from "../base/curve";
import { svg, uniqueId } from "../base/dom";
import { radialDomain } from "../base/domains";
import { degrees, digits } from "../base/format";
import { Handles } from "../base/handles";
import { zoomedAt } from "../base/plot_zoom";
import { polarGrid, polarPath } from "../base/polar";
import { CONTROL_POINT_NAMES, type PlotActions, type PlotView } from "./plot";
import { type Pixels, ProfilePlot } from "./profile_plot";
import type { Band } from "./shown";
import { type ControlPoint, TASK_WORDS } from "./state";
import { spaced } from "./spline";
import { wrapped } from "./targets";

const MARGIN = 40;
const TARGET_STEPS = 181;
/** Closer to the centre than this, in pixels, a dragged point keeps its direction. */
const MIN_RADIUS = 8;

export class PolarPlot extends ProfilePlot {
  protected readonly handles: Handles;
  /** Vector from the centre to the pointer, which has grabbed a control point. */
  private grabbed: Pixels = [0, 0];
  private readonly radius: ScaleLinear<number, number> = scaleLinear();
  private readonly centre = svg("g");
  private readonly above = svg("g");
  private readonly disc = svg("circle", { class: "ground" });
  private readonly clip = uniqueId("plot-area");
  private readonly clipCircle = svg("circle");
  private readonly grid = svg("g", { class: "axis" });
  private readonly title = svg("text", { class: "axis-title", x: 12, y: 22 });

  constructor(actions: PlotActions) {
    super("polar", "Target and response over direction", actions);
    this.handles = new Handles(
      this.element,
      {
        toPixels: (point) => this.pixels(point),
        grab: (pixels, point) => this.grab(pixels, point),
        toPoint: (pixels, from) => this.draggedTo(pixels, from),
        isFixed: () => false,
        nudged: ([x, y], [right, up]) => [
          wrapped(x - right * Math.PI),
          Math.max(this.radius.domain()[0], y + up * (this.radius.domain()[1] - this.radius.domain()[0])),
        ],
        describe: ([x, y]) => `direction ${degrees(x)}, ${this.unitWords(y)}`,
        echoes: ([x, y]) => [this.pixels([x + Math.PI, y])],
        heights: () => this.radius.domain(),
      },
      actions,
      CONTROL_POINT_NAMES,
    );
    this.backdrop.append(this.centre, this.title);
    this.centre.append(
      svg("defs", {}, svg("clipPath", { id: this.clip }, this.clipCircle)),
      this.disc,
      svg("g", { "clip-path": `url(#${this.clip})` }, ...this.layersBelowAxes),
      this.grid,
      this.above,
    );
    this.above.append(...this.layersAboveAxes);
    this.element.append(this.backdrop, this.handles.group);
  }

  protected scaleToSize(): void {
    this.radius.range([0, Math.max(20, Math.min(this.width, this.height) / 2 - MARGIN)]);
  }

  protected axesKey({ task }: PlotView): string {
    return [task, this.width, this.height, ...this.radius.domain()].join(" ");
  }

  protected layOut(): void {
    this.centre.setAttribute("transform", `translate(${this.width / 2},${this.height / 2})`);
    const rim = this.radius.range()[1];
    for (const circle of [this.disc, this.clipCircle]) circle.setAttribute("r", String(rim));
  }

  protected fitDomains(view: PlotView, curves: readonly Curve[]): void {
    const [centre, rim] = radialDomain(view.task, [...view.points.map((p) => p[1]), ...curves.flatMap((curve) => [...curve.y])]);
    // The centre stays in the middle, so that directions stay directions.
    this.radius.domain([centre, centre + (rim - centre) / this.up.factor]);
    if (this.isZoomed) this.above.setAttribute("clip-path", `url(#${this.clip})`);
    else this.above.removeAttribute("clip-path");
  }

  protected zoomBy(by: number): void {
    this.up = zoomedAt(this.up, by, 0);
  }

  protected drawAxes(view: PlotView): void {
    this.grid.replaceChildren(...polarGrid(this.radius));
    const { y, unit } = TASK_WORDS[view.task];
    this.title.textContent = unit ? `${y} (${unit})` : y;
  }

  protected targetPath(view: PlotView): string {
    const directions = spaced(0, Math.PI, TARGET_STEPS);
    return this.curvePath({ x: directions, y: directions.map(view.target) });
  }

  protected curvePath(curve: Curve): string {
    return polarPath(curve, (value) => this.pixelRadius(value));
  }

  protected bandPath({ x, lower, upper }: Band): { area: string; rim: string } {
    const rings = this.curvePath({ x, y: upper }) + this.curvePath({ x, y: lower });
    return { area: rings, rim: rings };
  }

  protected guidePath(x: number): string {
    const rim = this.radius.range()[1];
    const [right, up] = [rim * Math.cos(x), rim * Math.sin(x)];
    return `M${-right},${up}L${right},${-up}`;
  }

  protected places([x, y]: ControlPoint): readonly Pixels[] {
    const r = this.pixelRadius(y);
    const [right, up] = [r * Math.cos(x), r * Math.sin(x)];
    return [[right, -up], [-right, up]];
  }

  private unitWords(y: number): string {
    return this.view?.task === "poisson" ? `Poisson’s ratio ${digits(y)}` : `stiffness ${digits(y)} MPa`;
  }

  private pixelRadius(y: number): number {
    return Math.max(0, Math.min(4 * this.radius.range()[1], this.radius(y)));
  }

  private pixels([x, y]: ControlPoint): readonly [number, number] {
    const r = this.pixelRadius(y);
    return [this.width / 2 + r * Math.cos(x), this.height / 2 - r * Math.sin(x)];
  }

  /** Remembers on which side of the centre a control point was grabbed. */
  private grab(pixels: Pixels, [angle]: ControlPoint): void {
    const [right, up] = this.fromCentre(pixels);
    this.grabbed = Math.hypot(right, up) < MIN_RADIUS ? [Math.cos(angle), Math.sin(angle)] : [right, up];
  }

  /**
   * The new value of a dragged control point. The point stays on its side: a pointer beyond the centre moves it into the centre and
   * does not turn it by pi.
   */
  private draggedTo(pixels: Pixels, [angle]: ControlPoint): ControlPoint {
    const [right, up] = this.fromCentre(pixels);
    if (right * this.grabbed[0] + up * this.grabbed[1] < 0) return [angle, this.radius.invert(0)];
    // The direction of a pointer next to the centre is not reliable.
    if (Math.hypot(right, up) < MIN_RADIUS) return [angle, this.pointAt(pixels)[1]];
    this.grabbed = [right, up];
    return this.pointAt(pixels);
  }

  private fromCentre([x, y]: Pixels): Pixels {
    return [x - this.width / 2, this.height / 2 - y];
  }

  protected pointAt([x, y]: Pixels): ControlPoint {
    const [right, up] = this.fromCentre([x, y]);
    const r = Math.min(Math.hypot(right, up), this.radius.range()[1]);
    return [wrapped(Math.atan2(up, right)), this.radius.invert(r)];
  }
}
