// The samples of an atlas by two of their quantities, with those of other families behind them. A press, or keys on the mark, choose one.
import { axisBottom, axisLeft } from "d3-axis";
import { scaleLinear, scaleLog } from "d3-scale";
import { select } from "d3-selection";
import { svg } from "../base/dom";
import { digits } from "../base/format";
import { pixelsOf } from "../base/handles";
import type { AtlasSample } from "../contract/types";
import { PLACE_WORDS, type Quantity } from "./atlas_words";

const MARGIN = { top: 26, right: 16, bottom: 42, left: 58 };
/** Distance in pixels up to which a press chooses a sample. */
const REACH = 24;
/** Margin of the axes, as a part of the range of the values. */
const ROOM = 0.06;

export interface SampleView {
  readonly samples: readonly AtlasSample[];
  readonly others: readonly AtlasSample[];
  readonly x: Quantity;
  readonly y: Quantity;
  readonly chosen: number | null;
}

/** A sample with its place in the plot, in pixels. */
interface Dot {
  readonly index: number;
  readonly x: number;
  readonly y: number;
}

export class SamplePlot {
  readonly element = svg("svg", { class: "plot sample-plot", role: "group" });
  private readonly ground = svg("rect", { class: "ground" });
  private readonly xAxis = svg("g", { class: "axis" });
  private readonly yAxis = svg("g", { class: "axis" });
  private readonly xTitle = svg("text", { class: "axis-title", "text-anchor": "end" });
  private readonly yTitle = svg("text", { class: "axis-title", x: 8, y: 15 });
  private readonly others = svg("path", { class: "other-samples" });
  private readonly own = svg("g");
  private readonly mark = svg("g", { class: "handle sample-mark", role: "slider", tabindex: 0, "aria-valuemin": 1 }, svg("circle", { class: "halo", r: 12 }),
    svg("circle", { class: "dot", r: 6.5 }));
  private width = 480;
  private height = 320;
  private view: SampleView | null = null;
  private dots: readonly Dot[] = [];

  constructor(private readonly choose: (index: number) => void) {
    this.element.append(this.ground, this.xAxis, this.yAxis, this.others, this.own, this.mark, this.xTitle, this.yTitle);
    this.element.addEventListener("click", (event) => this.press(pixelsOf(this.element, event)));
    this.mark.addEventListener("keydown", (event) => this.key(event));
  }

  resize(width: number, height: number): void {
    [this.width, this.height] = [width, height];
    if (this.view) this.update(this.view);
  }

  update(view: SampleView): void {
    this.view = view;
    const { width, height } = this;
    for (const [name, value] of [["viewBox", `0 0 ${width} ${height}`], ["width", width], ["height", height]] as const) this.element.setAttribute(name, String(value));
    const all = [...view.samples, ...view.others];
    const x = this.scale(view.x, all, [MARGIN.left, width - MARGIN.right]);
    const y = this.scale(view.y, all, [height - MARGIN.bottom, MARGIN.top]);
    this.drawAxes(view, x, y);
    const place = (sample: AtlasSample): readonly [number, number] | null => {
      const [u, v] = [view.x.of(sample), view.y.of(sample)];
      return u === null || v === null ? null : [x(u), y(v)];
    };
    this.others.setAttribute("d", view.others.map(place).map((at) => (at ? `M${at[0].toFixed(1)},${at[1].toFixed(1)}h0` : "")).join(""));
    this.dots = view.samples.flatMap((sample, index): Dot[] => {
      const at = place(sample);
      return at ? [{ index, x: at[0], y: at[1] }] : [];
    }).sort((a, b) => a.x - b.x);
    this.own.replaceChildren(
      ...this.dots.map((dot) => svg("circle", { class: `sample ${view.samples[dot.index].place}`, cx: dot.x, cy: dot.y, r: 4 }, svg("title", {}, sampleWords(view, dot.index)))),
    );
    this.showChosen(view);
    this.element.setAttribute("aria-label", `${this.dots.length} samples: ${view.y.words} over ${view.x.words}`);
  }

  private showChosen(view: SampleView): void {
    const at = this.dots.findIndex(({ index }) => index === view.chosen);
    const dot = this.dots[Math.max(0, at)];
    this.mark.classList.toggle("selected", at >= 0);
    this.mark.setAttribute("visibility", dot ? "visible" : "hidden");
    if (!dot) return;
    this.mark.setAttribute("transform", `translate(${dot.x},${dot.y})`);
    this.mark.setAttribute("aria-label", "Sample of the atlas");
    this.mark.setAttribute("aria-valuemax", String(this.dots.length));
    this.mark.setAttribute("aria-valuenow", String(Math.max(0, at) + 1));
    this.mark.setAttribute("aria-valuetext", sampleWords(view, dot.index));
  }

  private scale(quantity: Quantity, samples: readonly AtlasSample[], range: readonly [number, number]) {
    const values = samples.map(quantity.of).filter((value): value is number => value !== null && (!quantity.isLogarithmic || value > 0));
    let [lower, upper] = values.reduce(([min, max], value) => [Math.min(min, value), Math.max(max, value)], [Infinity, -Infinity]);
    if (!(lower <= upper)) [lower, upper] = quantity.isLogarithmic ? [1, 10] : [0, 1];
    if (quantity.isLogarithmic) {
      const room = Math.max(1.05, (upper / lower) ** ROOM);
      return scaleLog().domain([lower / room, upper * room]).range(range);
    }
    const room = ROOM * (upper - lower) || 0.1 * Math.abs(upper) || 0.1;
    return scaleLinear().domain([lower - room, upper + room]).range(range);
  }

  private drawAxes(view: SampleView, x: ReturnType<SamplePlot["scale"]>, y: ReturnType<SamplePlot["scale"]>): void {
    const { width, height } = this;
    const [across, up] = [width - MARGIN.left - MARGIN.right, height - MARGIN.top - MARGIN.bottom];
    for (const [name, value] of [["x", MARGIN.left], ["y", MARGIN.top], ["width", Math.max(0, across)], ["height", Math.max(0, up)]] as const) {
      this.ground.setAttribute(name, String(value));
    }
    this.xAxis.setAttribute("transform", `translate(0,${height - MARGIN.bottom})`);
    this.yAxis.setAttribute("transform", `translate(${MARGIN.left},0)`);
    const label = (value: number | { valueOf(): number }) => digits(Number(value));
    select(this.xAxis).call(axisBottom(x).tickValues(ticksOf(x, Math.max(3, Math.round(across / 80)))).tickFormat(label).tickSize(-up).tickPadding(8));
    select(this.yAxis).call(axisLeft(y).tickValues(ticksOf(y, Math.max(3, Math.round(up / 50)))).tickFormat(label).tickSize(-across).tickPadding(8));
    this.xTitle.textContent = view.x.words;
    this.xTitle.setAttribute("x", String(width - MARGIN.right));
    this.xTitle.setAttribute("y", String(height - 6));
    this.yTitle.textContent = view.y.words;
  }

  private press([x, y]: readonly [number, number]): void {
    const distance = (dot: Dot) => Math.hypot(dot.x - x, dot.y - y);
    const nearest = this.dots.reduce<Dot | null>((best, dot) => (best && distance(best) <= distance(dot) ? best : dot), null);
    if (nearest && distance(nearest) <= REACH) this.choose(nearest.index);
  }

  private key(event: KeyboardEvent): void {
    const at = Math.max(0, this.dots.findIndex(({ index }) => index === this.view?.chosen));
    const last = this.dots.length - 1;
    const to = { ArrowLeft: at - 1, ArrowDown: at - 1, ArrowRight: at + 1, ArrowUp: at + 1, Home: 0, End: last, Enter: at, " ": at }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    const dot = this.dots[Math.max(0, Math.min(last, to))];
    if (dot) this.choose(dot.index);
  }
}

/** Ticks of an axis. A logarithmic one has many, of which those with the digits 1, 2 and 5 are enough. */
function ticksOf(scale: { ticks(count?: number): number[]; domain(): number[] }, count: number): number[] {
  const ticks = scale.ticks(count);
  if (ticks.length <= 1.6 * count) return ticks;
  const round = ticks.filter((tick) => /^[125]/.test(tick.toExponential()));
  return round.length <= 1.6 * count ? round : round.filter((tick) => /^1/.test(tick.toExponential()));
}

/** A sample in words. */
export function sampleWords({ samples, x, y }: Pick<SampleView, "samples" | "x" | "y">, index: number): string {
  const sample = samples[index];
  const value = (quantity: Quantity) => {
    const number = quantity.of(sample);
    return number === null ? "none" : digits(number);
  };
  const parameters = sample.parameters.length > 0 ? `parameters ${sample.parameters.map((one) => digits(one)).join(", ")}; ` : "";
  return `${parameters}${x.words} ${value(x)}, ${y.words} ${value(y)}, ${PLACE_WORDS[sample.place]}`;
}
