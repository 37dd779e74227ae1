// The base class of both plots of a profile: size, layers, and the elements of each layer.
import { type Curve, pieces } from "../base/curve";
import { replaceChanged, svg, writeAttribute } from "../base/dom";
import { type Handles, pixelsOf } from "../base/handles";
import type { PlotView, PlotActions } from "./plot";
import type { Band } from "./shown";
import { type AxisZoom, listenForZoom, WHOLE } from "../base/plot_zoom";
import type { ControlPoint } from "./state";

const DIAMOND = "M0,-5L5,0L0,5L-5,0Z";
const CROSS = "M-3.5,-3.5L3.5,3.5M-3.5,3.5L3.5,-3.5";

/** A position in the plot, in pixels. */
export type Pixels = readonly [number, number];

export abstract class ProfilePlot {
  readonly element: SVGSVGElement;
  /** Everything below the control points. A double click on it adds a control point, also on a grid line or a curve. */
  protected readonly backdrop = svg("g");
  protected abstract readonly handles: Handles;
  protected width = 640;
  protected height = 420;
  protected view: PlotView | null = null;
  /** The visible sections of the horizontal axis, and of the vertical or radial one. */
  protected across: AxisZoom = WHOLE;
  protected up: AxisZoom = WHOLE;
  private drawnAxes = "";
  private readonly envelope = svg("path", { class: "envelope", "fill-rule": "evenodd" });
  private readonly envelopeRim = svg("path", { class: "envelope-rim" });
  private readonly uncertainty = svg("path", { class: "doubt", "fill-rule": "evenodd" });
  private readonly measured = svg("path", { class: "measured" });
  private readonly pins = svg("g", { class: "pinned" });
  private readonly bound = svg("path", { class: "curve bound" });
  private readonly previous = svg("path", { class: "curve before" });
  private readonly target = svg("path", { class: "curve target" });
  private readonly achieved = svg("path", { class: "curve achieved" });
  private readonly verified = svg("g", { class: "verified" });
  private readonly rounds = svg("g", { class: "rounds" });
  private readonly missed = svg("g", { class: "missed" });
  private readonly guide = svg("path", { class: "guide" });

  protected constructor(kind: string, label: string, protected readonly actions: PlotActions) {
    this.element = svg("svg", { class: `plot ${kind}`, role: "group", "aria-label": label });
    this.backdrop.addEventListener("dblclick", (event) => this.actions.add(this.pointAt(pixelsOf(this.element, event))));
    this.backdrop.addEventListener("pointerdown", () => this.actions.select(null));
    // Captured, so that the place of the plot is read before a dragged control point changes the page: later the browser would have to arrange it at once.
    this.element.addEventListener("pointermove", (event) => this.actions.hover(this.pointAt(pixelsOf(this.element, event))[0]), { capture: true });
    this.element.addEventListener("pointerleave", () => this.actions.hover(null));
    listenForZoom(this.element, {
      zoom: (by, at, moved) => {
        this.zoomBy(by, at, moved);
        this.redraw();
      },
    });
  }

  protected get isZoomed(): boolean {
    return this.across.factor > 1 || this.up.factor > 1;
  }

  /** Shows the whole plot. */
  resetZoom(): void {
    this.across = this.up = WHOLE;
    this.redraw();
  }

  private redraw(): void {
    this.actions.zoomed(this.isZoomed);
    if (this.view) this.update(this.view);
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
    writeAttribute(this.element, "viewBox", `0 0 ${this.width} ${this.height}`);
    writeAttribute(this.element, "width", String(this.width));
    writeAttribute(this.element, "height", String(this.height));
    this.scaleToSize();
    this.element.classList.toggle("zoomed", this.isZoomed);
    if (!view.dragging || this.view?.task !== view.task) {
      this.fitDomains(view, [view.achieved, view.previous, view.bound, view.verified, ...view.pins].filter((curve): curve is Curve => curve !== null));
    }
    this.view = view;
    const axes = this.axesKey(view);
    if (axes !== this.drawnAxes) {
      this.drawnAxes = axes;
      this.layOut();
      this.drawAxes(view);
    }
    const reach = view.envelope && this.bandPath(view.envelope);
    this.element.classList.toggle("with-envelope", reach !== null);
    writeAttribute(this.envelope, "d", reach?.area ?? "");
    writeAttribute(this.envelopeRim, "d", reach?.rim ?? "");
    writeAttribute(this.uncertainty, "d", view.uncertainty ? this.bandPath(view.uncertainty).area : "");
    writeAttribute(this.measured, "d", view.measured.flatMap((point) => this.places(point)).map(([x, y]) => `M${x},${y}h0`).join(""));
    writeAttribute(this.target, "d", this.targetPath(view));
    this.draw(this.previous, view.previous);
    this.draw(this.bound, view.bound);
    this.draw(this.achieved, view.achieved);
    this.achieved.classList.toggle("provisional", view.provisional);
    replaceChanged(
      this.pins,
      ...view.pins.map((pin) => {
        const path = svg("path", { class: `curve pin pin-${pin.id % 6}` }, svg("title", {}, pin.name));
        this.draw(path, pin);
        return path;
      }),
    );
    replaceChanged(this.rounds, ...view.rounds.map((round) => svg("path", { class: `curve round ${round.isBest ? "best" : ""}`.trim(), d: this.curvePath(round) })));
    this.drawMarks(this.verified, view.verified ? pieces(view.verified).flat() : [], DIAMOND);
    this.drawMarks(this.missed, view.missed, CROSS);
    writeAttribute(this.guide, "d", view.hovered === null ? "" : this.guidePath(view.hovered));
    this.handles.update(view);
  }

  /** The layers below the axes, the lowest first. */
  protected get layersBelowAxes(): SVGElement[] {
    return [this.envelope, this.envelopeRim, this.measured];
  }
  /** The layers above the axes, the lowest first. */
  protected get layersAboveAxes(): SVGElement[] {
    return [this.guide, this.uncertainty, this.pins, this.rounds, this.previous, this.bound, this.target, this.missed, this.achieved, this.verified];
  }

  /** Makes the scales fit the plot's present size. */
  protected abstract scaleToSize(): void;
  /** Arranges the plot's frame for its present size. */
  protected abstract layOut(): void;
  /** What axes and frame depend on, as a text. They are drawn again only where it changes. */
  protected abstract axesKey(view: PlotView): string;
  /** Chooses the domains of the axes so that control points and curves fit. */
  protected abstract fitDomains(view: PlotView, curves: readonly Curve[]): void;
  /** Changes the visible section; `at` and `moved` in pixels. */
  protected abstract zoomBy(by: number, at: Pixels, moved: Pixels): void;
  protected abstract drawAxes(view: PlotView): void;
  protected abstract targetPath(view: PlotView): string;
  protected abstract curvePath(curve: Curve): string;
  protected abstract bandPath(band: Band): { area: string; rim: string };
  /** The value that is shown at a position. */
  protected abstract pointAt(pixels: Pixels): ControlPoint;
  /** A line across the plot at a strain or an angle, as the data of an SVG path. */
  protected abstract guidePath(x: number): string;
  /** The positions at which a point is shown: one, or two in a periodic plot. */
  protected abstract places(point: ControlPoint): readonly Pixels[];

  private draw(path: SVGPathElement, curve: Curve | null): void {
    writeAttribute(path, "d", curve ? this.curvePath(curve) : "");
  }

  private drawMarks(group: SVGGElement, points: readonly ControlPoint[], mark: string): void {
    replaceChanged(
      group,
      ...points.flatMap((point) => this.places(point)).map(([x, y]) => svg("path", { d: mark, transform: `translate(${x},${y})` })),
    );
  }
}
