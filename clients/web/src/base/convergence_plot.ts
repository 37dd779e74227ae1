// A quantity that falls while something converges, on a logarithmic axis: the gradient's norm over iterations, an error over designs.
import { axisBottom, axisLeft } from "d3-axis";
import { scaleLinear, scaleLog } from "d3-scale";
import { select } from "d3-selection";
import { line } from "d3-shape";
import { svg } from "./dom";

const MARGIN = { top: 26, right: 14, bottom: 40, left: 58 };
/** Minimum distance of two labels in pixels. */
const LABEL_PIXELS = 26;
const MAX_DOTS = 80;

export interface ConvergenceView {
  /** The known values, each after a count of iterations, designs or the like. */
  readonly steps: readonly { readonly count: number; readonly value: number }[];
  /** The value at which the computation ends; 0 for none. */
  readonly tolerance: number;
  /** The count that is marked. */
  readonly current: number | null;
}

export interface ConvergenceWords {
  readonly xTitle: string;
  readonly yTitle: string;
  /** What is counted, as in "over the iterations". */
  readonly counted: string;
  readonly tolerance: string;
  valueWords(value: number): string;
  /** Label of a line of the grid. */
  tickWords(value: number): string;
  /** Multiples of powers of ten that have a line of the grid, too. */
  readonly multiples: readonly number[];
}

/** Exponents of the powers of ten that enclose all positive values; one decade if there are none. */
export function decades(values: readonly number[]): readonly [number, number] {
  const logs = values.filter((value) => value > 0).map(Math.log10);
  if (logs.length === 0) return [-1, 0];
  const lower = logs.reduce((min, value) => Math.min(min, value), Infinity);
  const upper = logs.reduce((max, value) => Math.max(max, value), -Infinity);
  return [Math.floor(lower), Math.max(Math.ceil(upper), Math.floor(lower) + 1)];
}

export class ConvergencePlot {
  readonly element = svg("svg", { class: "plot convergence", role: "img" });
  private readonly x = scaleLinear();
  private readonly y = scaleLog();
  private readonly ground = svg("rect", { class: "ground" });
  private readonly xAxis = svg("g", { class: "axis" });
  private readonly yAxis = svg("g", { class: "axis" });
  private readonly xTitle = svg("text", { class: "axis-title", "text-anchor": "end" });
  private readonly yTitle = svg("text", { class: "axis-title", x: 8, y: 15 });
  private readonly goal = svg("path", { class: "curve target" });
  private readonly goalWords = svg("text", { class: "axis-title goal-words", "text-anchor": "end" });
  private readonly curve = svg("path", { class: "curve achieved" });
  private readonly dots = svg("g", { class: "dots" });
  private readonly mark = svg("circle", { class: "current", r: 5.5 });
  private width = 420;
  private height = 240;
  private view: ConvergenceView | null = null;

  constructor(private readonly words: ConvergenceWords) {
    this.xTitle.textContent = words.xTitle;
    this.yTitle.textContent = words.yTitle;
    this.goalWords.textContent = words.tolerance;
    this.element.append(this.ground, this.xAxis, this.yAxis, this.goal, this.curve, this.dots, this.mark, this.goalWords, this.xTitle, this.yTitle);
  }

  resize(width: number, height: number): void {
    [this.width, this.height] = [width, height];
    if (this.view) this.update(this.view);
  }

  update(view: ConvergenceView): void {
    this.view = view;
    const { width, height } = this;
    const { steps, tolerance } = view;
    for (const [name, value] of [["viewBox", `0 0 ${width} ${height}`], ["width", width], ["height", height]] as const) this.element.setAttribute(name, String(value));
    const last = steps[steps.length - 1];
    const { yTitle, counted, valueWords } = this.words;
    const name = `${yTitle} over the ${counted}`;
    this.element.setAttribute("aria-label", last ? `${name}: ${valueWords(steps[0].value)} at first, ${valueWords(last.value)} after ${last.count}` : name);
    const [lower, upper] = decades([...steps.map((step) => step.value), tolerance]);
    this.x.domain([0, Math.max(1, last?.count ?? 1)]).range([MARGIN.left, width - MARGIN.right]);
    this.y.domain([10 ** lower, 10 ** upper]).range([height - MARGIN.bottom, MARGIN.top]);
    this.drawAxes(lower, upper);
    const shape = line<readonly [number, number]>();
    const places = steps.map((step) => [this.x(step.count), this.heightOf(step.value)] as const);
    this.curve.setAttribute("d", shape(places) ?? "");
    this.dots.replaceChildren(...(places.length <= MAX_DOTS ? places : []).map(([cx, cy]) => svg("circle", { cx, cy, r: 2.6 })));
    const goal = this.heightOf(tolerance);
    this.goal.setAttribute("d", tolerance > 0 ? `M${MARGIN.left},${goal}H${width - MARGIN.right}` : "");
    this.goalWords.setAttribute("visibility", tolerance > 0 ? "visible" : "hidden");
    this.goalWords.setAttribute("x", String(width - MARGIN.right - 4));
    this.goalWords.setAttribute("y", String(goal - 6));
    const current = steps.findIndex((step) => step.count === view.current);
    this.mark.setAttribute("visibility", current >= 0 ? "visible" : "hidden");
    if (current >= 0) {
      this.mark.setAttribute("cx", String(places[current][0]));
      this.mark.setAttribute("cy", String(places[current][1]));
    }
  }

  private drawAxes(lower: number, upper: number): void {
    const { width, height } = this;
    const [across, inner] = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    for (const [name, value] of [["x", MARGIN.left], ["y", MARGIN.top], ["width", Math.max(0, across)], ["height", Math.max(0, inner)]] as const) {
      this.ground.setAttribute(name, String(value));
    }
    const every = Math.max(1, Math.ceil(((upper - lower) * LABEL_PIXELS) / Math.max(1, inner)));
    const powers = Array.from({ length: upper - lower + 1 }, (_, k) => lower + k).filter((power) => (power - lower) % every === 0);
    const lines = powers.flatMap((power) => [1, ...this.words.multiples].map((multiple) => multiple * 10 ** power)).filter((value) => value <= 10 ** upper);
    const whole = this.x.ticks(Math.max(2, Math.round(across / 70))).filter(Number.isInteger);
    this.xAxis.setAttribute("transform", `translate(0,${height - MARGIN.bottom})`);
    this.yAxis.setAttribute("transform", `translate(${MARGIN.left},0)`);
    select(this.xAxis).call(axisBottom(this.x).tickValues(whole).tickFormat(String).tickSize(-inner).tickPadding(8));
    select(this.yAxis).call(axisLeft(this.y).tickValues(lines).tickFormat((value) => this.words.tickWords(Number(value))).tickSize(-across).tickPadding(8));
    this.xTitle.setAttribute("x", String(width - MARGIN.right));
    this.xTitle.setAttribute("y", String(height - 6));
  }

  /** Height of a value in pixels; 0 is drawn at the lower end of the axis. */
  private heightOf(value: number): number {
    const [min] = this.y.domain();
    return this.y(Math.max(value, min));
  }
}

const RAISED: Record<string, string> = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

/** A power of ten as text, such as "10⁻³". */
export function powerWords(value: number): string {
  return `10${[...String(Math.round(Math.log10(value)))].map((letter) => RAISED[letter]).join("")}`;
}
