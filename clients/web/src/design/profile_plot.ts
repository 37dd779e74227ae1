// What both plots of a profile share: size, layers, and what is drawn into which.
import { type Curve, pieces } from "../base/curve";
import { svg } from "../base/dom";
import { type Handles, pixelsOf } from "./handles";
import type { PlotView, PlotWishes } from "./plot";
import type { Band } from "./shown";
import type { ControlPoint } from "./state";

const DIAMOND = "M0,-5L5,0L0,5L-5,0Z";
const CROSS = "M-3.5,-3.5L3.5,3.5M-3.5,3.5L3.5,-3.5";

/** A place in the plot's picture, in pixels. */
export type Pixels = readonly [number, number];

export abstract class ProfilePlot {
  readonly element: SVGSVGElement;
  /** All that lies below the control points. A double click anywhere on it adds one, on a grid line or a curve too. */
  protected readonly sheet = svg("g");
  protected abstract readonly handles: Handles;
  protected width = 640;
  protected height = 420;
  protected view: PlotView | null = null;
  private readonly envelope = svg("path", { class: "envelope", "fill-rule": "evenodd" });
  private readonly envelopeRim = svg("path", { class: "envelope-rim" });
  private readonly doubt = svg("path", { class: "doubt", "fill-rule": "evenodd" });
  private readonly measured = svg("path", { class: "measured" });
  private readonly pins = svg("g", { class: "pinned" });
  private readonly before = svg("path", { class: "curve before" });
  private readonly target = svg("path", { class: "curve target" });
  private readonly achieved = svg("path", { class: "curve achieved" });
  private readonly verified = svg("g", { class: "verified" });
  private readonly missed = svg("g", { class: "missed" });
  private readonly guide = svg("path", { class: "guide" });

  protected constructor(kind: string, label: string, protected readonly wishes: PlotWishes) {
    this.element = svg("svg", { class: `plot ${kind}`, role: "group", "aria-label": label });
    this.sheet.addEventListener("dblclick", (event) => this.wishes.add(this.pointAt(pixelsOf(this.element, event))));
    this.sheet.addEventListener("pointerdown", () => this.wishes.select(null));
    this.element.addEventListener("pointermove", (event) => this.wishes.hover(this.pointAt(pixelsOf(this.element, event))[0]));
    this.element.addEventListener("pointerleave", () => this.wishes.hover(null));
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
    this.layOut();
    if (!view.dragging || this.view?.task !== view.task) {
      this.fitDomains(view, [view.achieved, view.before, view.verified, ...view.pins].filter((curve): curve is Curve => curve !== null));
    }
    this.view = view;
    this.drawAxes(view);
    const reach = view.envelope && this.bandPath(view.envelope);
    this.envelope.setAttribute("d", reach?.area ?? "");
    this.envelopeRim.setAttribute("d", reach?.rim ?? "");
    this.doubt.setAttribute("d", view.doubt ? this.bandPath(view.doubt).area : "");
    this.measured.setAttribute("d", view.measured.flatMap((point) => this.places(point)).map(([x, y]) => `M${x},${y}h0`).join(""));
    this.target.setAttribute("d", this.targetPath(view));
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
    this.drawMarks(this.verified, view.verified ? pieces(view.verified).flat() : [], DIAMOND);
    this.drawMarks(this.missed, view.missed, CROSS);
    this.guide.setAttribute("d", view.hovered === null ? "" : this.guidePath(view.hovered));
    this.handles.update(view);
  }

  /** What lies below the axes, and what above, from the lowest up. */
  protected get ground(): SVGElement[] {
    return [this.envelope, this.envelopeRim, this.measured];
  }
  protected get curves(): SVGElement[] {
    return [this.guide, this.doubt, this.pins, this.before, this.target, this.missed, this.achieved, this.verified];
  }

  /** Follows a new size. */
  protected abstract layOut(): void;
  /** Chooses the axes' ends so that control points and curves have room. */
  protected abstract fitDomains(view: PlotView, curves: readonly Curve[]): void;
  protected abstract drawAxes(view: PlotView): void;
  protected abstract targetPath(view: PlotView): string;
  protected abstract curvePath(curve: Curve): string;
  protected abstract bandPath(band: Band): { area: string; rim: string };
  /** The control point that is shown at a place. */
  protected abstract pointAt(pixels: Pixels): ControlPoint;
  /** A line through all that is shown at a strain or an angle. */
  protected abstract guidePath(x: number): string;
  /** Where a point is shown: once, or at every place that its period gives it. */
  protected abstract places(point: ControlPoint): readonly Pixels[];

  private draw(path: SVGPathElement, curve: Curve | null): void {
    path.setAttribute("d", curve ? this.curvePath(curve) : "");
  }

  private drawMarks(group: SVGGElement, points: readonly ControlPoint[], mark: string): void {
    group.replaceChildren(
      ...points.flatMap((point) => this.places(point)).map(([x, y]) => svg("path", { d: mark, transform: `translate(${x},${y})` })),
    );
  }
}
