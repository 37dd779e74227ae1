// A polar plot of one quantity. The pointer, or keys on a handle, select the direction.
import { scaleLinear, scaleLog } from "d3-scale";
import type { Curve } from "../base/curve";
import { svg } from "../base/dom";
import { radialDomain } from "../base/domains";
import { degrees, digits, quantity, suitedUnit } from "../base/format";
import { polarGrid, polarPath, type RadiusScale } from "../base/polar";
import { undirected } from "./geometry";

const MARGIN = 36;
/** Height of the title above the plot, in pixels. */
const TITLE_HEIGHT = 20;
/** Lower limit of a logarithmic scale, over the largest value; smaller values lie in the centre. */
const MIN_FRACTION = 1e-5;
const MARGIN_FACTOR = 1.25;

export interface PinnedCurve extends Curve {
  readonly id: number;
  readonly name: string;
}

export interface ChartView {
  readonly curve: Curve | null;
  readonly provisional: boolean;
  readonly reasons: readonly (string | null)[];
  readonly pins: readonly PinnedCurve[];
  /** The selected direction in radians, and the value there. */
  readonly direction: number;
  readonly value: number | null;
  readonly logarithmic: boolean;
}

export interface ChartOptions {
  readonly kind: "stiffness" | "poisson";
  readonly title: string;
  readonly unit: string;
  hover(angle: number | null): void;
  choose(angle: number): void;
  step(count: number): void;
}

export class PolarChart {
  readonly element: SVGSVGElement;
  private readonly centre = svg("g");
  private readonly heading = svg("text", { class: "axis-title", x: 12, y: 15 });
  private readonly ground = svg("circle", { class: "ground" });
  private readonly grid = svg("g", { class: "axis" });
  private readonly pins = svg("g", { class: "pinned" });
  private readonly curve = svg("path", { class: "curve achieved" });
  private readonly gaps = svg("g", { class: "gaps" });
  private readonly ray = svg("path", { class: "ray" });
  private readonly handle: SVGGElement;
  private radius: RadiusScale = scaleLinear();
  private width = 320;
  private height = 320;
  private view: ChartView | null = null;

  constructor(private readonly options: ChartOptions) {
    const { title } = options;
    this.handle = svg("g", { class: "handle direction", role: "slider", tabindex: 0, "aria-label": `Direction, ${title}`, "aria-valuemin": 0, "aria-valuemax": 180 },
      svg("circle", { class: "halo", r: 11 }), svg("circle", { class: "dot", r: 5 }));
    this.centre.append(this.ground, this.grid, this.pins, this.gaps, this.ray, this.curve, this.handle);
    this.element = svg("svg", { class: "plot polar", role: "group", "aria-label": `${title} over direction` }, this.centre, this.heading);
    this.element.addEventListener("pointermove", (event) => options.hover(this.angle(event)));
    this.element.addEventListener("pointerleave", () => options.hover(null));
    this.element.addEventListener("click", (event) => options.choose(this.angle(event)));
    this.handle.addEventListener("keydown", (event) => this.key(event));
  }

  resize(width: number, height: number): void {
    [this.width, this.height] = [width, height];
    if (this.view) this.update(this.view);
  }

  update(view: ChartView): void {
    this.view = view;
    const { width, height } = this;
    for (const [name, value] of [["viewBox", `0 0 ${width} ${height}`], ["width", width], ["height", height]] as const) this.element.setAttribute(name, String(value));
    this.centre.setAttribute("transform", `translate(${width / 2},${(height + TITLE_HEIGHT) / 2})`);
    const rim = Math.max(20, Math.min(width, height - TITLE_HEIGHT) / 2 - MARGIN);
    this.ground.setAttribute("r", String(rim));
    this.fit(view, rim);
    const ticks = this.ticks(view);
    const { title } = this.options;
    const { unit, factor } = suitedUnit(Math.max(0, ...ticks), this.options.unit);
    this.grid.replaceChildren(...polarGrid(this.radius, ticks, (value) => digits(factor * value)));
    this.heading.textContent = unit ? `${title} (${unit})` : title;
    const path = (curve: Curve) => polarPath(curve, (value) => this.pixelRadius(value));
    this.curve.setAttribute("d", view.curve ? path(view.curve) : "");
    this.curve.classList.toggle("provisional", view.provisional);
    this.pins.replaceChildren(...view.pins.map((pin) => svg("path", { class: `curve pin pin-${pin.id % 6}`, d: path(pin) }, svg("title", {}, pin.name))));
    this.drawGaps(view, rim);
    this.drawDirection(view, rim);
  }

  private fit(view: ChartView, rim: number): void {
    const values = [view.curve, ...view.pins].flatMap((curve) => [...(curve?.y ?? [])]);
    const domain = radialDomain(this.options.kind, values);
    if (!view.logarithmic) {
      this.radius = scaleLinear().domain(domain).range([0, rim]);
      return;
    }
    const positive = values.filter((value): value is number => value !== null && value > 0);
    const max = Math.max(1e-6, ...positive);
    const min = Math.max(Math.min(max, ...positive), max * MIN_FRACTION);
    this.radius = scaleLog().domain([min / MARGIN_FACTOR ** 2, max * MARGIN_FACTOR]).range([0, rim]);
  }

  /** Powers of ten if a logarithmic scale has more than one of them; otherwise the ticks of the scale, thinned out if there are many. */
  private ticks(view: ChartView): number[] {
    const ticks = this.radius.ticks(5);
    const powers = ticks.filter((value) => Math.abs(Math.log10(value) - Math.round(Math.log10(value))) < 1e-9);
    return view.logarithmic && powers.length > 1 ? powers : ticks.filter((_, k) => ticks.length < 8 || k % 3 === 0);
  }

  private drawGaps(view: ChartView, rim: number): void {
    const marks = view.reasons.flatMap((reason, k) => {
      if (reason === null || !view.curve) return [];
      const angle = view.curve.x[k];
      return [angle, angle + Math.PI].map((turned) =>
        svg("path", { d: "M-3.5,-3.5L3.5,3.5M-3.5,3.5L3.5,-3.5", transform: `translate(${rim * Math.cos(turned)},${-rim * Math.sin(turned)})` },
          svg("title", {}, `${degrees(angle)}: ${reason}`))
      );
    });
    this.gaps.replaceChildren(...marks);
  }

  private drawDirection({ direction, value }: ChartView, rim: number): void {
    const [x, y] = [Math.cos(direction), -Math.sin(direction)];
    this.ray.setAttribute("d", `M${-rim * x},${-rim * y}L${rim * x},${rim * y}`);
    const r = value === null ? rim : this.pixelRadius(value);
    this.handle.setAttribute("transform", `translate(${r * x},${r * y})`);
    this.handle.setAttribute("aria-valuenow", ((direction * 180) / Math.PI).toFixed(1));
    const words = value === null ? "no value" : quantity(value, this.options.unit);
    this.handle.setAttribute("aria-valuetext", `${degrees(direction)}, ${this.options.title} ${words}`);
  }

  private pixelRadius(value: number): number {
    const pixels = this.radius(value);
    return Number.isFinite(pixels) ? Math.max(0, Math.min(4 * this.radius.range()[1], pixels)) : 0;
  }

  private angle(event: MouseEvent): number {
    const { left, top } = this.element.getBoundingClientRect();
    return undirected(Math.atan2(top + (this.height + TITLE_HEIGHT) / 2 - event.clientY, event.clientX - left - this.width / 2));
  }

  private key(event: KeyboardEvent): void {
    const steps: Record<string, number> = { ArrowLeft: 1, ArrowUp: 1, ArrowRight: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 };
    const step = steps[event.key];
    if (step !== undefined) this.options.step(event.shiftKey ? 5 * step : step);
    else if (event.key === "Home") this.options.choose(0);
    else if (event.key === "End") {
      this.options.choose(0);
      this.options.step(-1);
    } else return;
    event.preventDefault();
  }
}
