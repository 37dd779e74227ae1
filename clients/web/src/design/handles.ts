// The control points of a plot as handles: dragged by pointer, moved by keys.
import { svg } from "../base/dom";
import { keyStep, type PlotView, type PlotWishes } from "./plot";
import type { ControlPoint } from "./state";

/** How a plot turns its pixels into values and back. */
export interface Plane {
  toPixels(point: ControlPoint): readonly [number, number];
  /** A point is taken hold of at some pixels. */
  hold(pixels: readonly [number, number], point: ControlPoint): void;
  /** Where the point that is held goes with the pointer. */
  toPoint(pixels: readonly [number, number], from: ControlPoint): ControlPoint;
  /** Whether a point stays where it is. */
  isHeld(point: ControlPoint): boolean;
  /** The point a key moves to; shares of the plot's width and height. */
  nudged(point: ControlPoint, step: readonly [number, number]): ControlPoint;
  describe(point: ControlPoint): string;
  /** Least and greatest y that is shown. */
  heights(): readonly number[];
  /** Other places where the same point can be taken hold of. */
  echoes(point: ControlPoint): readonly (readonly [number, number])[];
}

const KEY_PAUSE_MS = 450;

export class Handles {
  readonly group = svg("g", { class: "handles", role: "group", "aria-label": "Control points of the target" });
  private readonly echoes = svg("g", { class: "echoes", "aria-hidden": "true" });
  private readonly handles = svg("g");
  private view: PlotView | null = null;
  private dragged: number | null = null;
  private following = false;
  private keyTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly root: SVGSVGElement,
    private readonly plane: Plane,
    private readonly wishes: PlotWishes,
  ) {
    this.group.append(this.echoes, this.handles);
  }

  /** The point that is held has got another place among the points. */
  follow(index: number): void {
    if (this.dragged !== null) this.dragged = index;
    this.following = true;
    this.focus(index);
    this.following = false;
  }

  update(view: PlotView): void {
    this.view = view;
    while (this.handles.children.length > view.points.length) this.handles.lastElementChild?.remove();
    while (this.handles.children.length < view.points.length) this.handles.append(this.makeHandle(this.handles.children.length));
    view.points.forEach((point, k) => this.place(this.handles.children[k], point, k));
    const spots = view.points.flatMap((point, k) => this.plane.echoes(point).map((pixels) => ({ pixels, k })));
    while (this.echoes.children.length > spots.length) this.echoes.lastElementChild?.remove();
    while (this.echoes.children.length < spots.length) this.echoes.append(this.makeEcho());
    spots.forEach(({ pixels, k }, n) => {
      const echo = this.echoes.children[n];
      echo.setAttribute("transform", `translate(${pixels[0]},${pixels[1]})`);
      echo.setAttribute("data-index", String(k));
    });
  }

  focus(index: number): void {
    (this.handles.children[index] as SVGElement | undefined)?.focus();
  }

  private place(handle: Element, point: ControlPoint, index: number): void {
    const [x, y] = this.plane.toPixels(point);
    handle.setAttribute("transform", `translate(${x},${y})`);
    const [least, most] = this.plane.heights();
    handle.setAttribute("aria-valuemin", Math.min(least, point[1]).toFixed(6));
    handle.setAttribute("aria-valuemax", Math.max(most, point[1]).toFixed(6));
    handle.setAttribute("aria-valuenow", point[1].toFixed(6));
    handle.setAttribute("aria-valuetext", this.plane.describe(point));
    handle.classList.toggle("selected", this.view?.selected === index);
    handle.classList.toggle("held", this.plane.isHeld(point));
  }

  private makeHandle(index: number): SVGGElement {
    const handle = svg(
      "g",
      { class: "handle", tabindex: 0, role: "slider", "aria-label": `Control point ${index + 1}`, "data-index": index },
      svg("circle", { class: "reach", r: 18 }),
      svg("circle", { class: "halo", r: 12 }),
      svg("circle", { class: "dot", r: 6.5 }),
    );
    this.listen(handle);
    handle.addEventListener("focus", () => this.wishes.select(index));
    handle.addEventListener("keydown", (event) => this.key(event, index));
    handle.addEventListener("blur", () => this.endKeys());
    return handle;
  }

  private makeEcho(): SVGGElement {
    const echo = svg("g", { class: "echo" }, svg("circle", { class: "reach", r: 16 }), svg("circle", { class: "dot", r: 4 }));
    this.listen(echo);
    return echo;
  }

  private listen(handle: SVGGElement): void {
    handle.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      event.preventDefault();
      event.stopPropagation();
      this.dragged = Number(handle.dataset.index);
      this.focus(this.dragged);
      const point = this.view?.points[this.dragged];
      if (!point || this.plane.isHeld(point)) return void (this.dragged = null);
      handle.setPointerCapture(event.pointerId);
      this.plane.hold(pixelsOf(this.root, event), point);
      this.wishes.begin();
    });
    handle.addEventListener("pointermove", (event) => {
      const point = this.dragged === null ? undefined : this.view?.points[this.dragged];
      if (this.dragged !== null && point) this.wishes.move(this.dragged, this.plane.toPoint(pixelsOf(this.root, event), point));
    });
    for (const end of ["pointerup", "pointercancel"]) {
      handle.addEventListener(end, () => {
        if (this.dragged === null) return;
        this.dragged = null;
        this.wishes.end();
      });
    }
    handle.addEventListener("dblclick", (event) => {
      event.stopPropagation();
      this.wishes.remove(Number(handle.dataset.index));
    });
  }

  private key(event: KeyboardEvent, index: number): void {
    const point = this.view?.points[index];
    if (!point) return;
    const step = keyStep(event);
    if (step && this.plane.isHeld(point)) event.preventDefault();
    else if (step) {
      event.preventDefault();
      this.wishes.begin();
      this.wishes.move(index, this.plane.nudged(point, step));
      clearTimeout(this.keyTimer);
      this.keyTimer = setTimeout(() => this.endKeys(), KEY_PAUSE_MS);
    } else if (event.key === "Delete" || event.key === "Backspace") {
      event.preventDefault();
      this.endKeys();
      this.wishes.remove(index);
      this.focus(Math.max(0, index - 1));
    }
  }

  /** Keys that follow one another are one change. */
  private endKeys(): void {
    if (this.keyTimer === undefined || this.following) return;
    clearTimeout(this.keyTimer);
    this.keyTimer = undefined;
    this.wishes.end();
  }
}

/** Where a pointer is, in the units of the drawing. */
export function pixelsOf(root: SVGSVGElement, event: MouseEvent): readonly [number, number] {
  const box = root.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}
