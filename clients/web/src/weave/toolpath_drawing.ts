// A drawing of a toolpath on the printer's bed from above: one layer, and faintly the layers below it.
import { h } from "../base/dom";
import { dark } from "../base/theme";
import type { PrintMove } from "../contract/types";
import { type Layer, widthOf } from "./toolpath";

export interface ToolpathView {
  readonly layers: readonly Layer[];
  /** Width and depth of the bed, in mm. */
  readonly bed: readonly [number, number];
  /** Bounding box of the print, in mm. */
  readonly box: readonly [left: number, bottom: number, right: number, top: number];
  /** Index of the layer. */
  readonly layer: number;
  /** Number of the layer's moves that are drawn. */
  readonly moves: number;
  readonly travels: boolean;
  /** Whether the whole bed is visible; otherwise the print alone. */
  readonly whole: boolean;
}

type Kind = PrintMove["kind"];
const COLOURS: Readonly<Record<Kind, string>> = {
  strand: "--achieved",
  lifted: "--target",
  channel: "--simulated",
  support: "--before",
  priming: "--before",
  travel: "--line-strong",
};
const KINDS = Object.keys(COLOURS) as Kind[];
/** Margin in pixels. */
const MARGIN = 14;
/** Minimum width of printed lines, in pixels. */
const MIN_WIDTH = 1.2;
const BELOW_OPACITY = 0.28;
/** Distances of the bed's grid lines in mm; the smallest one that leaves MIN_GRID_PIXELS between lines is used. */
const GRID = [1, 5, 10, 50, 100];
const MIN_GRID_PIXELS = 14;
/** Size of the inset that shows the bed, as a fraction of the width of the drawing. */
const INSET_FRACTION = 0.18;

/** The paths of moves by kind, in mm. */
type Paths = Readonly<Record<Kind, Path2D>>;

export class ToolpathDrawing {
  readonly element = h("canvas", { class: "toolpath", role: "img" });
  private view: ToolpathView | null = null;
  private readonly pathsByLayer = new WeakMap<Layer, Paths>();
  private scheduled = false;
  /** A cached picture of the bed and the layers below, which do not change while a slider goes through the moves of one layer. */
  private readonly background = h("canvas");
  private backgroundKey: readonly unknown[] = [];

  constructor() {
    dark.watch(() => this.schedule());
    new ResizeObserver(() => this.schedule()).observe(this.element);
  }

  show(view: ToolpathView | null): void {
    this.view = view;
    this.schedule();
  }

  /** Schedules one drawing before the next repaint of the browser. */
  private schedule(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.draw();
    });
  }

  private draw(): void {
    const { element, view } = this;
    const { clientWidth: width, clientHeight: height } = element;
    const context = element.getContext("2d");
    if (!context || width === 0) return;
    const ratio = window.devicePixelRatio || 1;
    const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (element.width !== wide || element.height !== high) [element.width, element.height] = [wide, high];
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, wide, high);
    if (!view) return;
    const [left, bottom, right, top] = view.whole ? [0, 0, ...view.bed] : view.box;
    const scale = Math.min((width - 2 * MARGIN) / Math.max(1, right - left), (height - 2 * MARGIN) / Math.max(1, top - bottom));
    // Converts mm with y upwards to pixels of the canvas.
    const toPixels = new DOMMatrix([ratio * scale, 0, 0, -ratio * scale, ratio * (width / 2 - (scale * (left + right)) / 2), ratio * (height / 2 + (scale * (bottom + top)) / 2)]);
    this.drawBackground(view, toPixels, scale, wide, high);
    context.drawImage(this.background, 0, 0);
    context.setTransform(toPixels);
    const layer = view.layers[view.layer];
    if (layer) {
      const made = layer.moves.slice(0, view.moves);
      this.drawMoves(context, made.length === layer.moves.length ? this.pathsOf(layer) : pathsOf(made), layer, scale, 1, view.travels);
      this.drawNozzle(context, made, scale);
    }
    if (!view.whole) this.drawInset(context, view, width, height, ratio);
  }

  private drawBackground(view: ToolpathView, toPixels: DOMMatrix, scale: number, wide: number, high: number): void {
    const key = [view.layers, view.layer, ...view.bed, wide, high, toPixels.toString(), dark.get()];
    if (key.every((part, k) => part === this.backgroundKey[k])) return;
    this.backgroundKey = key;
    [this.background.width, this.background.height] = [wide, high];
    const context = this.background.getContext("2d");
    if (!context) return;
    context.setTransform(toPixels);
    this.drawBed(context, view, scale);
    view.layers.slice(0, view.layer).forEach((layer) => this.drawMoves(context, this.pathsOf(layer), layer, scale, BELOW_OPACITY, false));
  }

  private pathsOf(layer: Layer): Paths {
    const cached = this.pathsByLayer.get(layer) ?? pathsOf(layer.moves);
    this.pathsByLayer.set(layer, cached);
    return cached;
  }

  private drawBed(context: CanvasRenderingContext2D, { bed: [width, depth] }: ToolpathView, scale: number): void {
    context.fillStyle = this.colour("--surface");
    context.fillRect(0, 0, width, depth);
    const step = GRID.find((distance) => distance * scale >= MIN_GRID_PIXELS) ?? GRID[GRID.length - 1];
    const lines = new Path2D();
    for (let k = 1; k * step < width; ++k) lines.rect(k * step, 0, 0, depth);
    for (let k = 1; k * step < depth; ++k) lines.rect(0, k * step, width, 0);
    context.strokeStyle = this.colour("--grid");
    context.lineWidth = 1 / scale;
    context.stroke(lines);
    context.strokeStyle = this.colour("--line-strong");
    context.lineWidth = 1.5 / scale;
    context.strokeRect(0, 0, width, depth);
  }

  private drawMoves(context: CanvasRenderingContext2D, paths: Paths, layer: Layer, scale: number, opacity: number, travels: boolean): void {
    context.lineCap = context.lineJoin = "round";
    context.globalAlpha = opacity;
    for (const kind of KINDS) {
      if (kind === "travel") continue;
      const move = layer.moves.find((one) => one.kind === kind);
      if (!move) continue;
      context.strokeStyle = this.colour(COLOURS[kind]);
      context.lineWidth = Math.max(widthOf(move), MIN_WIDTH / scale);
      context.stroke(paths[kind]);
    }
    if (travels) {
      context.strokeStyle = this.colour(COLOURS.travel);
      context.lineWidth = 1 / scale;
      context.setLineDash([4 / scale, 3 / scale]);
      context.stroke(paths.travel);
      context.setLineDash([]);
    }
    context.globalAlpha = 1;
  }

  /** Draws the nozzle at the end of the last move. */
  private drawNozzle(context: CanvasRenderingContext2D, made: readonly PrintMove[], scale: number): void {
    const point = made.at(-1)?.points.at(-1);
    if (!point) return;
    context.beginPath();
    context.arc(point[0], point[1], 5 / scale, 0, 2 * Math.PI);
    context.fillStyle = this.colour("--surface");
    context.fill();
    context.strokeStyle = this.colour("--ink");
    context.lineWidth = 2 / scale;
    context.stroke();
  }

  /** Draws the bed in a corner, with a rectangle at the position of the part. */
  private drawInset(context: CanvasRenderingContext2D, { bed, box: [left, bottom, right, top] }: ToolpathView, width: number, height: number, ratio: number): void {
    const scale = (INSET_FRACTION * Math.min(width, 600)) / Math.max(...bed);
    context.setTransform(ratio * scale, 0, 0, -ratio * scale, ratio * (width - MARGIN / 2 - scale * bed[0]), ratio * (height - MARGIN / 2));
    context.globalAlpha = 0.9;
    context.fillStyle = this.colour("--surface");
    context.fillRect(0, 0, bed[0], bed[1]);
    context.globalAlpha = 1;
    context.strokeStyle = this.colour("--line-strong");
    context.lineWidth = 1 / scale;
    context.strokeRect(0, 0, bed[0], bed[1]);
    context.fillStyle = this.colour("--achieved");
    context.fillRect(left, bottom, Math.max(right - left, 2 / scale), Math.max(top - bottom, 2 / scale));
  }

  private colour(name: string): string {
    return getComputedStyle(this.element).getPropertyValue(name).trim() || "#345";
  }
}

function pathsOf(moves: readonly PrintMove[]): Paths {
  const paths = Object.fromEntries(KINDS.map((kind) => [kind, new Path2D()])) as Record<Kind, Path2D>;
  for (const { kind, points } of moves) {
    points.forEach(([x, y], k) => (k === 0 ? paths[kind].moveTo(x, y) : paths[kind].lineTo(x, y)));
  }
  return paths;
}
