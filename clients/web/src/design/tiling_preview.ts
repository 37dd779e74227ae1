// A drawing of the shown design's structure, from the server's file.
import { h, replace, svg, uniqueId } from "../base/dom";
import { digits, percent } from "../base/format";
import { Latest } from "../base/latest";
import { type Client, isAbort } from "../contract/client";
import type { Family } from "../contract/types";
import { DEFAULT_SPECIFICATION, orientationOf } from "./specification";
import { structurePath } from "./requests";
import type { DesignSession } from "./session";
import type { TilingDesign } from "./state";

/** Cells of the requested patch along each translation. The patch is small because uniting its beams takes time; copies of it fill the window. */
const PATCH_CELLS = 2;
/** Upper limit of the number of copies on each side of the patch. */
const MAX_COPIES = 8;
/** Height of the frame over its width. */
const HEIGHT_RATIO = 3 / 4;
/** Width of the beams in the server's file, in mm. */
const DRAWN_WIDTH = DEFAULT_SPECIFICATION.size.value;

/** Side of the square window in mm, for a few cells of a family. */
export function windowSize(family: Family): number {
  const longest = Math.max(...family.cell.lattice.map(([x, y]) => Math.hypot(x, y)));
  return Math.max(14, Math.min(48, 2.4 * longest));
}

/** Offsets of the copies of a patch that cover, with it, a square around its centre. The arguments are the patch's translations a and b, and the side of the square. */
export function copiesOf([ax, ay, bx, by]: readonly number[], side: number): [number, number][] {
  const area = Math.abs(ax * by - ay * bx);
  // Half extent of the square across the other translation, over the width of the patch there. A quarter is added because a patch consists of whole tiles.
  const count = (x: number, y: number) => Math.min(MAX_COPIES, Math.ceil((side * (Math.abs(x) + Math.abs(y))) / (2 * area) + 0.25));
  const [alongA, alongB] = [count(bx, by), count(ax, ay)];
  const places: [number, number][] = [];
  for (let i = -alongA; i <= alongA; ++i) {
    for (let j = -alongB; j <= alongB; ++j) if (i !== 0 || j !== 0) places.push([i * ax + j * bx, i * ay + j * by]);
  }
  return places;
}

/** The two translations of the cell, from an attribute of the server's file. */
function translationsOf(file: Document): number[] | null {
  const numbers = file.documentElement.getAttribute("data-translations")?.split(" ").map(Number) ?? [];
  return numbers.length === 4 && numbers.every(Number.isFinite) ? numbers : null;
}

/** The nearest round length: 1, 2 or 5 times a power of ten. */
function roundLength(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  const distance = (factor: number) => Math.abs(Math.log((factor * power) / length));
  return [1, 2, 5, 10].reduce((best, factor) => (distance(factor) < distance(best) ? factor : best)) * power;
}

export function tilingPreview(session: DesignSession, client: Client): HTMLElement {
  const shape = svg("path", { class: "solid", id: uniqueId("patch"), "fill-rule": "evenodd" });
  const copies = svg("g", { class: "copies" });
  const scaleBar = svg("path", { class: "scale-bar" });
  const scaleWords = svg("text", { class: "scale-words" });
  const rotated = svg("g", {}, copies, shape);
  const drawing = svg("svg", { class: "tiling dims", role: "img", preserveAspectRatio: "xMidYMid slice" }, rotated, scaleBar, scaleWords);
  const caption = h("figcaption", {});
  // A short result below the drawing, because the card of the result is far away on a small screen.
  const live = h("p", { class: "live", "aria-hidden": "true" });
  const requests = new Latest();
  let drawnKey = "";
  let drawnSide = 0;

  /** Whether the tiling is rotated, so that the corners of the window need more copies. */
  function isTurned(): boolean {
    return session.state.get().made.orientation !== 0;
  }

  async function draw(found: TilingDesign, signal: AbortSignal): Promise<void> {
    const family = session.family(found.family);
    if (!family) return;
    const side = windowSize(family);
    const path = structurePath(found, "svg", [PATCH_CELLS, PATCH_CELLS]);
    const file = new DOMParser().parseFromString(await (await client.send("GET", path, undefined, { signal })).text(), "image/svg+xml");
    shape.setAttribute("d", file.querySelector("path")?.getAttribute("d") ?? "");
    const translations = translationsOf(file)?.map((length) => PATCH_CELLS * length);
    // The window is a rotated square relative to the tiling.
    const places = translations ? copiesOf(translations, side * (isTurned() ? Math.SQRT2 : 1)) : [];
    replace(copies, ...places.map(([x, y]) => svg("use", { href: `#${shape.id}`, x, y })));
    drawing.setAttribute("viewBox", `${-side / 2} ${-side / 2} ${side} ${side}`);
    drawing.setAttribute("aria-label", `Tiling ${found.family} with parameters ${found.parameters.map((value) => digits(value)).join(", ")}`);
    drawnSide = side;
    drawScale();
  }

  /** Draws the scale bar. All structures are drawn with the same beam width; the bar shows the true scale. */
  function drawScale(): void {
    if (drawnSide === 0) return;
    const side = drawnSide;
    const scale = (widthNow() ?? DRAWN_WIDTH) / DRAWN_WIDTH;
    const words = roundLength((side > 30 ? 10 : 5) * scale);
    const length = words / scale;
    // The frame is lower than wide and crops the square.
    const at = { x: side / 2 - length - side * 0.05, y: (HEIGHT_RATIO * side) / 2 - side * 0.05 };
    scaleBar.setAttribute("d", `M${at.x} ${at.y}h${length}`);
    scaleBar.setAttribute("stroke-width", String(side / 120));
    scaleWords.setAttribute("x", String(at.x));
    scaleWords.setAttribute("y", String(at.y - side * 0.02));
    scaleWords.setAttribute("font-size", String(side / 28));
    scaleWords.textContent = `${digits(words)} mm`;
  }

  /** Width of the beams in mm; null for a given cell size until the structure has been measured. */
  function widthNow(): number | null {
    const { size } = session.state.get().made;
    return size.kind === "beam_width" ? size.value : (session.shown.get()?.measures.beamWidth ?? null);
  }

  function turn(): void {
    const { made, found } = session.state.get();
    // The picture's y axis points down.
    rotated.setAttribute("transform", `rotate(${(-orientationOf(made, found) * 180) / Math.PI})`);
  }

  // The drawing follows the state, whose design may be newer than the shown response.
  session.state.watch(({ found }) => {
    if (!found) return;
    turn();
    drawScale();
    const key = `${found.family} ${found.parameters.join()} ${isTurned()}`;
    if (key === drawnKey) return;
    drawnKey = key;
    caption.textContent = `${found.family}. ${session.family(found.family)?.description ?? ""}`;
    requests.submit(async (signal) => {
      try {
        await draw(found, signal);
      } catch (error) {
        drawnKey = "";
        // The parameters give no structure: the last drawing stays, and the card of the result reports the fault.
        if (!isAbort(error)) drawing.setAttribute("aria-label", "No picture of this tiling");
      }
    });
  });
  session.shown.watch((shown) => {
    drawScale();
    if (shown) live.textContent = `${shown.found.family}: ${percent(shown.deviation)} from the target`;
  });
  return h("figure", { class: "card preview" }, drawing, live, caption);
}
