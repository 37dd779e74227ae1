// The handles of the points of a plot or of a drawing, which pointer and keys move.
import { svg, writeAttribute } from "./dom";

export type HandlePoint = readonly [x: number, y: number];

/** What is shown of the points. */
export interface HandlesView {
  readonly points: readonly HandlePoint[];
  readonly selected: number | null;
  /** Indices of points that a refusal names. */
  readonly faulty: readonly number[];
}

export interface HandleActions {
  begin(): void;
  move(index: number, to: HandlePoint): void;
  end(): void;
  remove(index: number): void;
  select(index: number | null): void;
}

/** Names for screen readers: that of the group, and that of each handle. */
export interface HandleNames {
  readonly group: string;
  of(index: number): string;
}

/** The coordinate system of a plot: converts between values and pixels. */
export interface Plane {
  toPixels(point: HandlePoint): readonly [number, number];
  /** Called when the pointer grabs a point. */
  grab(pixels: readonly [number, number], point: HandlePoint): void;
  /** The new value of a dragged point when the pointer is at some pixels. */
  toPoint(pixels: readonly [number, number], from: HandlePoint): HandlePoint;
  /** Whether a point cannot be moved. */
  isFixed(point: HandlePoint): boolean;
  /** The point after a step of a key; `step` is in fractions of the plot's width and height. */
  nudged(point: HandlePoint, step: readonly [number, number]): HandlePoint;
  describe(point: HandlePoint): string;
  /** Smallest and largest y that is shown. */
  heights(): readonly number[];
  /** Further places in pixels where the same point is shown and can be grabbed: its copy after half a turn in a polar plot. */
  echoes(point: HandlePoint): readonly (readonly [number, number])[];
}

const KEY_PAUSE_MS = 450;

export class Handles {
  readonly group: SVGGElement;
  private readonly echoes = svg("g", { class: "echoes", "aria-hidden": "true" });
  private readonly handles = svg("g");
  private view: HandlesView | null = null;
  private dragged: number | null = null;
  private following = false;
  private keyTimer: ReturnType<typeof setTimeout> | undefined;

  constructor(
    private readonly root: SVGSVGElement,
    private readonly plane: Plane,
    private readonly actions: HandleActions,
    private readonly names: HandleNames,
  ) {
    this.group = svg("g", { class: "handles", role: "group", "aria-label": names.group });
    this.group.append(this.echoes, this.handles);
  }

  /** Called when the dragged point has got another index. */
  follow(index: number): void {
    if (this.dragged !== null) this.dragged = index;
    this.following = true;
    this.focus(index);
    this.following = false;
  }

  update(view: HandlesView): void {
    this.view = view;
    while (this.handles.children.length > view.points.length) this.handles.lastElementChild?.remove();
    while (this.handles.children.length < view.points.length) this.handles.append(this.makeHandle(this.handles.children.length));
    view.points.forEach((point, k) => this.place(this.handles.children[k], point, k));
    const mirrored = view.points.flatMap((point, k) => this.plane.echoes(point).map((pixels) => ({ pixels, k })));
    while (this.echoes.children.length > mirrored.length) this.echoes.lastElementChild?.remove();
    while (this.echoes.children.length < mirrored.length) this.echoes.append(this.makeEcho());
    mirrored.forEach(({ pixels, k }, n) => {
      const echo = this.echoes.children[n];
      writeAttribute(echo, "transform", `translate(${pixels[0]},${pixels[1]})`);
      writeAttribute(echo, "data-index", String(k));
    });
  }

  focus(index: number): void {
    (this.handles.children[index] as SVGElement | undefined)?.focus();
  }

  private place(handle: Element, point: HandlePoint, index: number): void {
    const [x, y] = this.plane.toPixels(point);
    writeAttribute(handle, "transform", `translate(${x},${y})`);
    writeAttribute(handle, "aria-label", this.names.of(index));
    const [min, max] = this.plane.heights();
    writeAttribute(handle, "aria-valuemin", Math.min(min, point[1]).toFixed(6));
    writeAttribute(handle, "aria-valuemax", Math.max(max, point[1]).toFixed(6));
    writeAttribute(handle, "aria-valuenow", point[1].toFixed(6));
    writeAttribute(handle, "aria-valuetext", this.plane.describe(point));
    handle.classList.toggle("selected", this.view?.selected === index);
    handle.classList.toggle("held", this.plane.isFixed(point));
    handle.classList.toggle("faulty", this.view?.faulty.includes(index) ?? false);
  }

  private makeHandle(index: number): SVGGElement {
    const handle = svg(
      "g",
      { class: "handle", tabindex: 0, role: "slider", "data-index": index },
      svg("circle", { class: "reach", r: 18 }),
      svg("circle", { class: "halo", r: 12 }),
      svg("circle", { class: "dot", r: 6.5 }),
    );
    this.listen(handle);
    handle.addEventListener("focus", () => this.actions.select(index));
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
      if (!point || this.plane.isFixed(point)) {
        this.dragged = null;
        return;
      }
      handle.setPointerCapture(event.pointerId);
      this.plane.grab(pixelsOf(this.root, event), point);
      this.actions.begin();
    });
    handle.addEventListener("pointermove", (event) => {
      const point = this.dragged === null ? undefined : this.view?.points[this.dragged];
      if (this.dragged !== null && point) this.actions.move(this.dragged, this.plane.toPoint(pixelsOf(this.root, event), point));
    });
    for (const end of ["pointerup", "pointercancel"]) {
      handle.addEventListener(end, () => {
        if (this.dragged === null) return;
        this.dragged = null;
        this.actions.end();
      });
    }
    handle.addEventListener("dblclick", (event) => {
      event.stopPropagation();
      this.actions.remove(Number(handle.dataset.index));
    });
  }

  private key(event: KeyboardEvent, index: number): void {
    const point = this.view?.points[index];
    if (!point) return;
    const step = keyStep(event);
    if (step && this.plane.isFixed(point)) event.preventDefault();
    else if (step) {
      event.preventDefault();
      this.actions.begin();
      this.actions.move(index, this.plane.nudged(point, step));
      clearTimeout(this.keyTimer);
      this.keyTimer = setTimeout(() => this.endKeys(), KEY_PAUSE_MS);
    } else if (event.key === "Delete" || event.key === "Backspace") {
      event.preventDefault();
      this.endKeys();
      this.actions.remove(index);
      this.focus(Math.max(0, index - 1));
    }
  }

  /** Ends a series of key presses, which is one change. */
  private endKeys(): void {
    if (this.keyTimer === undefined || this.following) return;
    clearTimeout(this.keyTimer);
    this.keyTimer = undefined;
    this.actions.end();
  }
}

/** The step of an arrow key, in fractions of the plot's width and height; null for other keys. */
export function keyStep(event: KeyboardEvent): readonly [number, number] | null {
  const size = event.shiftKey ? 0.05 : 0.01;
  switch (event.key) {
    case "ArrowLeft":
      return [-size, 0];
    case "ArrowRight":
      return [size, 0];
    case "ArrowUp":
      return [0, size];
    case "ArrowDown":
      return [0, -size];
    default:
      return null;
  }
}

/** Position of a pointer event relative to the drawing, in pixels. */
export function pixelsOf(root: SVGSVGElement, event: MouseEvent): readonly [number, number] {
  const box = root.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}
