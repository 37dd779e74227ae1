// The drawing of the tiling at the shown parameters: beams, the tile with its handles, and marks where the check has found something.
import { announce } from "../base/announce";
import { h, svg, uniqueId, writeAttribute } from "../base/dom";
import { digits } from "../base/format";
import { Handles } from "../base/handles";
import { canDrag, type Handle, handlesOf, placeOf } from "./drags";
import { shapeName, withoutPoint } from "./edits";
import type { Vector } from "./expressions";
import { isShownAt } from "./findings";
import type { FamilySession } from "./session";
import { type Camera, cameraOn, copiesOf, isFiniteTiling, isInSight, nearestCopy, outlinesPath, shiftOf, toPixels, toPlane } from "./tiling_drawing";
import { areaOf, type DrawnFamily, selfCrossings, type Tiling, tilingAt } from "./tiling";

/** Distance of an edge's letter from the edge, in pixels. */
const LETTER_PIXELS = 15;
/** Where along its edge a letter stands, as a fraction: not in the middle, where handles are. */
const LETTER_PLACE = 0.72;
const MIN_SIDE = 200;
/** Limit of the marks of places where the tile crosses itself. */
const MAX_CROSSINGS = 12;

export class TilingView {
  readonly element: HTMLElement;
  private readonly cell = svg("path", { id: uniqueId("cell") });
  private readonly copies = svg("g", { class: "beams" });
  private readonly fill = svg("path", { class: "tile-fill" });
  private readonly outline = svg("path", { class: "tile-outline" });
  private readonly origin = svg("g", {}, this.fill, this.copies, this.outline);
  private readonly letters = svg("g", { class: "edge-letters", "aria-hidden": "true" });
  private readonly marks = svg("g", { class: "tile-marks" });
  private readonly drawing = svg("svg", { class: "family-tiling", role: "group" });
  private readonly handles: Handles;
  private camera: Camera = { width: 600, height: 400, centre: [0, 0], scale: 1 };
  private hasCamera = false;
  private items: readonly Handle[] = [];
  private places: readonly Vector[] = [];
  private isHeld: readonly boolean[] = [];
  /** Where the dragged handle was when its drag began. */
  private grabbed: { readonly index: number; readonly place: Vector } | null = null;
  /** Vector from the pointer to the handle that it has grabbed, in pixels. */
  private offset: Vector = [0, 0];
  private tiling: Tiling | null = null;

  constructor(private readonly session: FamilySession) {
    this.handles = new Handles(
      this.drawing,
      {
        toPixels: (point) => toPixels(this.camera, point),
        grab: (pixels, point) => {
          const [x, y] = toPixels(this.camera, point);
          this.offset = [x - pixels[0], y - pixels[1]];
        },
        toPoint: ([x, y]) => toPlane(this.camera, [x + this.offset[0], y + this.offset[1]]),
        isFixed: (point) => this.isHeld[this.places.indexOf(point)] ?? false,
        nudged: ([x, y], [right, up]) => [x + (right * this.camera.width) / this.camera.scale, y + (up * this.camera.height) / this.camera.scale],
        describe: ([x, y]) => `x ${digits(x)}, y ${digits(y)}`,
        heights: () => [toPlane(this.camera, [0, this.camera.height])[1], toPlane(this.camera, [0, 0])[1]],
        echoes: () => [],
      },
      {
        begin: () => {},
        move: (index, to) => this.move(index, to),
        end: () => this.end(),
        remove: (index) => this.remove(index),
        select: (index) => session.selected.set(index === null ? null : (this.items[index] ?? null)),
      },
      { group: "Vertices and points of edges of the tile", of: (index) => handleWords(this.items[index]) },
    );
    this.drawing.append(svg("defs", {}, this.cell), this.origin, this.letters, this.marks, this.handles.group);
    this.drawing.addEventListener("pointerdown", (event) => {
      if (event.target instanceof Element && !event.target.closest(".handle")) session.selected.set(null);
    });
    this.element = h("div", { class: "family-stage" }, this.drawing);
    new ResizeObserver(() => this.resize()).observe(this.element);
    // The drawing follows the pointer at once; cards are drawn through the session's redraws.
    session.state.watch(() => this.draw());
    session.mode.watch(() => this.draw());
    session.selected.watch(() => this.showHandles());
    session.checked.watch(() => this.drawMarks());
  }

  /** Brings the tile into the middle. */
  fit(): void {
    this.hasCamera = false;
    this.draw();
  }

  private resize(): void {
    const { width, height } = this.element.getBoundingClientRect();
    const [w, t] = [Math.max(MIN_SIDE, Math.floor(width)), Math.max(MIN_SIDE, Math.floor(height))];
    for (const [name, value] of [["viewBox", `0 0 ${w} ${t}`], ["width", String(w)], ["height", String(t)]] as const) writeAttribute(this.drawing, name, value);
    this.camera = { ...this.camera, width: w, height: t };
    this.fit();
  }

  private draw(): void {
    const { session } = this;
    const family = session.drawn.get();
    const { shown, definition } = session.state.get();
    const tiling = family && tilingAt(family, shown);
    this.tiling = tiling && isFiniteTiling(tiling) ? tiling : null;
    this.drawing.classList.toggle("empty", this.tiling === null);
    if (!family || !this.tiling) return;
    const isDragging = session.edited.isBeingChanged;
    if (!this.hasCamera || (!isDragging && !isInSight(this.tiling, this.camera))) {
      this.camera = cameraOn(this.tiling, this.camera.width, this.camera.height);
      this.hasCamera = true;
    }
    this.drawBeams(this.tiling);
    this.drawLetters(family);
    this.items = handlesOf(family);
    this.places = this.items.map((handle) => placeOf(family, handle, shown));
    // During a drag nothing else is grabbed, and to find out what is held takes longer than a frame may.
    if (!isDragging || this.isHeld.length !== this.items.length) this.isHeld = canDrag(family, session.state.get(), this.items, session.mode.get()).map((can) => !can);
    this.showHandles();
    this.drawMarks();
    writeAttribute(this.drawing, "aria-label", `Tiling of ${definition.id}${shown.length > 0 ? ` at ${shown.map((value) => digits(value)).join(", ")}` : ""}`);
  }

  private drawBeams(tiling: Tiling): void {
    const { scale } = this.camera;
    writeAttribute(this.cell, "d", outlinesPath(tiling.tiles, scale));
    const tile = outlinesPath([tiling.outline], scale);
    for (const part of [this.fill, this.outline]) writeAttribute(part, "d", tile);
    const [x, y] = toPixels(this.camera, [0, 0]);
    writeAttribute(this.origin, "transform", `translate(${x},${y})`);
    writeAttribute(this.copies, "stroke-width", String(Math.max(0, scale * tiling.beamWidth)));
    const copies = copiesOf(tiling, this.camera);
    const { children } = this.copies;
    while (children.length > copies.length) this.copies.lastElementChild?.remove();
    while (children.length < copies.length) this.copies.append(svg("use", { href: `#${this.cell.id}` }));
    copies.forEach((copy, k) => {
      const [dx, dy] = shiftOf(tiling, copy, scale);
      writeAttribute(children[k], "x", String(dx));
      writeAttribute(children[k], "y", String(dy));
    });
  }

  /** The letters of the shapes of edges, beside each edge of the tile. */
  private drawLetters({ tile: { edges = [], vertices }, shapes }: DrawnFamily): void {
    const { tiling } = this;
    if (!tiling) return;
    const named = shapes.length > 1 ? edges : [];
    while (this.letters.children.length > named.length) this.letters.lastElementChild?.remove();
    while (this.letters.children.length < named.length) this.letters.append(svg("text", { "text-anchor": "middle", "dominant-baseline": "central" }));
    const selected = this.session.selected.get();
    named.forEach(({ shape }, k) => {
      const end = k + 1 < vertices.length ? tiling.starts[k + 1] : tiling.outline.length;
      const points = [...tiling.outline.slice(tiling.starts[k], end), tiling.outline[end % tiling.outline.length]].map((point) => toPixels(this.camera, point));
      const piece = Math.min(points.length - 2, Math.floor(LETTER_PLACE * (points.length - 1)));
      const [from, to] = [points[piece], points[piece + 1]];
      const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
      const along = LETTER_PLACE * (points.length - 1) - piece;
      const length = Math.hypot(dx, dy) || 1;
      const letter = this.letters.children[k];
      // The tile is to the left of its edges, in a plane whose y points up.
      writeAttribute(letter, "x", String(from[0] + along * dx + (LETTER_PIXELS * dy) / length));
      writeAttribute(letter, "y", String(from[1] + along * dy - (LETTER_PIXELS * dx) / length));
      writeAttribute(letter, "class", selected && selected.kind !== "vertex" && selected.shape === shape ? "selected" : "");
      if (letter.textContent !== shapeName(shape)) letter.textContent = shapeName(shape);
    });
  }

  private showHandles(): void {
    const selected = this.session.selected.get();
    const index = selected ? this.items.findIndex((handle) => JSON.stringify(handle) === JSON.stringify(selected)) : -1;
    this.handles.update({ points: this.places, selected: index < 0 ? null : index, faulty: [] });
    const edgeHandles = this.items.map((handle) => handle.kind !== "vertex");
    this.handles.group.querySelectorAll(".handle").forEach((handle, k) => handle.classList.toggle("of-edge", edgeHandles[k] ?? false));
  }

  /** Marks the findings of the shown parameters, and where the shown tile crosses itself. */
  private drawMarks(): void {
    const { tiling, camera, session } = this;
    if (!tiling) return this.marks.replaceChildren();
    const { shown } = session.state.get();
    const numbered = (session.findings ?? []).map((finding, k) => ({ finding, number: k + 1 })).filter(({ finding }) => finding.point && isShownAt(finding, shown));
    const crossings = selfCrossings(tiling.outline).slice(0, MAX_CROSSINGS);
    this.marks.replaceChildren(
      ...crossings.map((place) => {
        const [x, y] = toPixels(camera, place);
        return svg("path", { class: "crossing-mark", d: "M-6,-6L6,6M-6,6L6,-6", transform: `translate(${x},${y})` });
      }),
      ...numbered.map(({ finding, number }) => {
        const [x, y] = toPixels(camera, nearestCopy(tiling, camera, finding.point ?? [0, 0]));
        return svg("g", { class: `finding-mark ${finding.kind}`, transform: `translate(${x},${y})` }, svg("title", {}, finding.sentence), svg("circle", { r: 11 }),
          svg("text", { "text-anchor": "middle", "dominant-baseline": "central" }, String(number)));
      }),
    );
  }

  /** What is wrong with the shown tile at a glance, before the server has checked it; empty if nothing is. */
  get faultWords(): string {
    const { tiling } = this;
    if (!tiling) return "";
    if (areaOf(tiling.outline) <= 0) return "The shown tile is turned inside out.";
    return selfCrossings(tiling.outline).length > 0 ? "The shown tile crosses itself where the crosses are." : "";
  }

  private move(index: number, to: Vector): void {
    const handle = this.items[index];
    if (!handle) return;
    if (this.grabbed?.index !== index) this.grabbed = { index, place: this.places[index] };
    const { place } = this.grabbed;
    this.session.dragBy(handle, [to[0] - place[0], to[1] - place[1]]);
  }

  private end(): void {
    if (!this.grabbed) return;
    const words = handleWords(this.items[this.grabbed.index]);
    this.grabbed = null;
    this.session.finish();
    const [x, y] = this.places[this.items.findIndex((handle) => handleWords(handle) === words)] ?? [0, 0];
    announce(`${words}: x ${digits(x)}, y ${digits(y)}.`, "change");
  }

  private remove(index: number): void {
    const handle = this.items[index];
    if (handle?.kind === "point") this.session.edit((family, edited) => withoutPoint(family, edited, handle.shape, handle.point));
  }
}

/** The name of a handle. Vertices and edges are counted from 1. */
export function handleWords(handle: Handle | undefined): string {
  if (!handle) return "";
  if (handle.kind === "vertex") return `Vertex ${handle.vertex + 1}`;
  return `${handle.kind === "point" ? `Point ${handle.point + 1}` : handle.leans ? "Lean" : "Height"} of the edges ${shapeName(handle.shape)}`;
}
