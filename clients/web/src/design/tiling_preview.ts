// A drawing of the shown design's structure, from the server's file.
import { h, replaceChanged, svg, uniqueId, writeAttribute, writeText } from "../base/dom";
import { digits, percent } from "../base/format";
import type { Client } from "../contract/client";
import { JobRunner } from "../contract/runner";
import type { Family } from "../contract/types";
import { judgedResponse } from "./judged";
import { axisArrow } from "./part_load";
import { DEFAULT_SPECIFICATION, orientationOf } from "./specification";
import { structurePath } from "./requests";
import type { DesignSession } from "./session";
import { isPolar, type TilingDesign } from "./state";
import type { Verification } from "./verification";

/** Cells of the requested patch along each translation. The patch is small because uniting its beams takes time; copies of it fill the window. */
const PATCH_CELLS = 2;
/** Upper limit of the number of copies on each side of the patch. */
const MAX_COPIES = 8;
/** Height of the frame over its width. */
const HEIGHT_RATIO = 3 / 4;
/** Length of the arrow along the load over the side of the window. */
const ARROW_LENGTH = 0.45;
/** Width of the beams in the server's file, in mm. */
const DRAWN_WIDTH = DEFAULT_SPECIFICATION.size.value;

/** Side of the square window in mm, for a few cells of a family. */
export function windowSize(family: Family): number {
  const longest = Math.max(...family.cell.lattice.map(([x, y]) => Math.hypot(x, y)));
  return Math.max(14, Math.min(48, 2.4 * longest));
}

/**
 * Offsets of the copies of a patch that cover, with it, a square around its centre. The arguments are the patch's translations a and b, the
 * side of the square, and half the width and the height of the patch, beyond which it has nothing.
 */
export function copiesOf([ax, ay, bx, by]: readonly number[], side: number, [halfWidth, halfHeight]: readonly number[] = [Infinity, Infinity]): [number, number][] {
  const area = Math.abs(ax * by - ay * bx);
  // Half extent of the square across the other translation, over the width of the patch there. A quarter is added because a patch consists of whole tiles.
  const count = (x: number, y: number) => Math.min(MAX_COPIES, Math.ceil((side * (Math.abs(x) + Math.abs(y))) / (2 * area) + 0.25));
  const [alongA, alongB] = [count(bx, by), count(ax, ay)];
  const places: [number, number][] = [];
  for (let i = -alongA; i <= alongA; ++i) {
    for (let j = -alongB; j <= alongB; ++j) {
      const [x, y] = [i * ax + j * bx, i * ay + j * by];
      // Copies of an oblique patch may lie beside the square. The browser would make each of them anew after every change.
      if ((i !== 0 || j !== 0) && Math.abs(x) < side / 2 + halfWidth && Math.abs(y) < side / 2 + halfHeight) places.push([x, y]);
    }
  }
  return places;
}

/** The two translations of the cell, from an attribute of the server's file. */
function translationsOf(file: Document): number[] | null {
  const numbers = file.documentElement.getAttribute("data-translations")?.split(" ").map(Number) ?? [];
  return numbers.length === 4 && numbers.every(Number.isFinite) ? numbers : null;
}

/** Half the width and the height of the patch, from the server's file, whose window is centred. Infinite if the file does not tell them. */
function halfSizeOf(file: Document): number[] {
  const window = file.documentElement.getAttribute("viewBox")?.split(" ").map(Number) ?? [];
  return window.length === 4 && window.every(Number.isFinite) ? [window[2] / 2, window[3] / 2] : [Infinity, Infinity];
}

/** The nearest round length: 1, 2 or 5 times a power of ten. */
function roundLength(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  const distance = (factor: number) => Math.abs(Math.log((factor * power) / length));
  return [1, 2, 5, 10].reduce((best, factor) => (distance(factor) < distance(best) ? factor : best)) * power;
}

/** The picture of a tiling in a window, with a scale bar. */
class TilingDrawing {
  private readonly shape = svg("path", { class: "solid", id: uniqueId("patch"), "fill-rule": "evenodd" });
  private readonly copies = svg("g", { class: "copies" });
  private readonly scaleBar = svg("path", { class: "scale-bar" });
  private readonly scaleWords = svg("text", { class: "scale-words" });
  private readonly loadHalo = svg("path", { class: "load-halo" });
  private readonly loadArrow = svg("path", { class: "load-arrow" });
  private readonly rotated = svg("g", {}, this.copies, this.shape);
  readonly element = svg("svg", { class: "tiling dims", role: "img", preserveAspectRatio: "xMidYMid slice" }, this.rotated, this.loadHalo, this.loadArrow, this.scaleBar,
    this.scaleWords);
  private loadAxis: number | null = null;
  /** Side of the drawn window in mm; 0 before the first drawing. */
  private side = 0;

  /** Draws a patch from the server's file. `turned`: whether the tiling is rotated, so that the corners of the window need more copies. */
  draw(text: string, side: number, turned: boolean): void {
    const file = new DOMParser().parseFromString(text, "image/svg+xml");
    writeAttribute(this.shape, "d", file.querySelector("path")?.getAttribute("d") ?? "");
    const translations = translationsOf(file)?.map((length) => PATCH_CELLS * length);
    // The window is a rotated square relative to the tiling.
    const places = translations ? copiesOf(translations, side * (turned ? Math.SQRT2 : 1), halfSizeOf(file)) : [];
    replaceChanged(this.copies, ...places.map(([x, y]) => svg("use", { href: `#${this.shape.id}`, x, y })));
    writeAttribute(this.element, "viewBox", `${-side / 2} ${-side / 2} ${side} ${side}`);
    this.side = side;
    this.load(this.loadAxis);
  }

  /** Draws an arrow along the load, whose direction is in radians; null for none. */
  load(axis: number | null): void {
    this.loadAxis = axis;
    const path = axis === null || this.side === 0 ? "" : axisArrow([0, 0], axis, ARROW_LENGTH * this.side);
    for (const one of [this.loadHalo, this.loadArrow]) writeAttribute(one, "d", path);
  }

  /** Names the picture for screen readers. */
  name(words: string): void {
    writeAttribute(this.element, "aria-label", words);
  }

  /** Rotates the tiling counterclockwise; the picture's y axis points down. */
  turn(angle: number): void {
    writeAttribute(this.rotated, "transform", `rotate(${(-angle * 180) / Math.PI})`);
  }

  /** Draws the scale bar. All structures are drawn with the same beam width; the bar shows the true scale for beams of `width` mm. */
  scale(width: number): void {
    const { side } = this;
    if (side === 0) return;
    const scale = width / DRAWN_WIDTH;
    const words = roundLength((side > 30 ? 10 : 5) * scale);
    const length = words / scale;
    // The frame is lower than wide and crops the square.
    const at = { x: side / 2 - length - side * 0.05, y: (HEIGHT_RATIO * side) / 2 - side * 0.05 };
    writeAttribute(this.scaleBar, "d", `M${at.x} ${at.y}h${length}`);
    writeAttribute(this.scaleBar, "stroke-width", String(side / 120));
    writeAttribute(this.scaleWords, "x", String(at.x));
    writeAttribute(this.scaleWords, "y", String(at.y - side * 0.02));
    writeAttribute(this.scaleWords, "font-size", String(side / 28));
    writeText(this.scaleWords, `${digits(words)} mm`);
  }
}

export function tilingPreview(session: DesignSession, verification: Verification, client: Client): HTMLElement {
  const drawing = new TilingDrawing();
  const caption = h("figcaption", {});
  // A short result below the drawing, because the card of the result is far away on a small screen.
  const live = h("p", { class: "live", "aria-hidden": "true" });
  const requests = new JobRunner<object>(client);
  let drawnKey = "";

  const isTurned = (): boolean => session.state.get().made.orientation !== 0;

  /** Width of the beams in mm. For a given cell size, it is known once the structure has been measured. */
  function widthNow(): number {
    const { size } = session.state.get().made;
    return (size.kind === "beam_width" ? size.value : session.results.shown.get()?.measures.beamWidth) ?? DRAWN_WIDTH;
  }

  function request(found: TilingDesign): void {
    const family = session.catalogue.family(found.family);
    if (!family) return;
    requests.follow(async (run) => {
      drawing.draw(await run.text(structurePath(found, "svg", [PATCH_CELLS, PATCH_CELLS])), windowSize(family), isTurned());
      drawing.name(`Tiling ${found.family} with parameters ${found.parameters.map((value) => digits(value)).join(", ")}`);
      drawing.scale(widthNow());
    }, () => {
      drawnKey = "";
      // The parameters give no structure: the last drawing stays, and the card of the result reports the fault.
      drawing.name("No picture of this tiling");
    });
  }

  // The drawing follows the state, whose design may be newer than the shown response.
  session.state.watch(({ found, made, task, direction }) => {
    drawing.load(isPolar(task) ? null : direction);
    if (!found) return;
    drawing.turn(orientationOf(made, found));
    drawing.scale(widthNow());
    const key = `${found.family} ${found.parameters.join()} ${isTurned()}`;
    if (key === drawnKey) return;
    drawnKey = key;
    writeText(caption, `${found.family}. ${session.catalogue.family(found.family)?.description ?? ""}`);
    request(found);
  });
  session.results.shown.watch(() => drawing.scale(widthNow()));
  session.redraws.follow([session.results.shown, verification.state], () => {
    const shown = session.results.shown.get();
    if (!shown) return;
    const off = judgedResponse(session, verification, shown).deviation ?? shown.deviation;
    writeText(live, `${shown.found.family}: ${percent(off)} from the target`);
  });
  return h("figure", { class: "card preview" }, drawing.element, live, caption);
}
