// The structure of the design shown, drawn from the server's file.
import { h, replace, svg, uniqueId } from "../base/dom";
import { digits, percent } from "../base/format";
import { Latest } from "../base/latest";
import { type Client, isAbort } from "../contract/client";
import type { Family } from "../contract/types";
import { DEFAULT_MADE, orientationOf } from "./made";
import { structurePath } from "./requests";
import type { DesignSession } from "./session";
import type { Found } from "./state";

/** Of the patch that the server is asked for, along each translation: uniting its beams is what takes time. Copies of it fill the window. */
const PATCH_CELLS = 2;
/** Copies to either side of the patch. */
const MOST_COPIES = 8;
/** Height of the frame over its width. */
const HEIGHT_SHARE = 3 / 4;
/** Of the beams in the server's file, mm. */
const DRAWN_WIDTH = DEFAULT_MADE.size.value;

/** Side of the square that is shown, mm: some cells, whatever their size. */
export function windowSize(family: Family): number {
  const longest = Math.max(...family.cell.lattice.map(([x, y]) => Math.hypot(x, y)));
  return Math.max(14, Math.min(48, 2.4 * longest));
}

/** Where copies of a patch have to lie so that, with it, they cover a square of this side around its centre; `a` and `b` repeat the patch. */
export function copiesOf([ax, ay, bx, by]: readonly number[], side: number): [number, number][] {
  const area = Math.abs(ax * by - ay * bx);
  // The square's reach across the other translation, over the patch's width there; and since a patch is no parallelogram but whole tiles, some more.
  const count = (x: number, y: number) => Math.min(MOST_COPIES, Math.ceil((side * (Math.abs(x) + Math.abs(y))) / (2 * area) + 0.25));
  const [alongA, alongB] = [count(bx, by), count(ax, ay)];
  const places: [number, number][] = [];
  for (let i = -alongA; i <= alongA; ++i) {
    for (let j = -alongB; j <= alongB; ++j) if (i !== 0 || j !== 0) places.push([i * ax + j * bx, i * ay + j * by]);
  }
  return places;
}

/** The two translations that repeat the cell, of a file of the server. */
function translationsOf(file: Document): number[] | null {
  const numbers = file.documentElement.getAttribute("data-translations")?.split(" ").map(Number) ?? [];
  return numbers.length === 4 && numbers.every(Number.isFinite) ? numbers : null;
}

/** The length of 1, 2 or 5 times a power of ten that comes closest, so that it can be read. */
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
  const turned = svg("g", {}, copies, shape);
  const drawing = svg("svg", { class: "tiling dims", role: "img", preserveAspectRatio: "xMidYMid slice" }, turned, scaleBar, scaleWords);
  const caption = h("figcaption", {});
  // On a small screen the card of the design is far away while a point is dragged.
  const live = h("p", { class: "live", "aria-hidden": "true" });
  const requests = new Latest();
  let asked = "";
  let drawnSide = 0;

  /** Its corners reach further then. */
  function isTurned(): boolean {
    return session.state.get().made.orientation !== 0;
  }

  async function draw(found: Found, signal: AbortSignal): Promise<void> {
    const family = session.family(found.family);
    if (!family) return;
    const side = windowSize(family);
    const path = structurePath(found, "svg", [PATCH_CELLS, PATCH_CELLS]);
    const file = new DOMParser().parseFromString(await (await client.send("GET", path, undefined, { signal })).text(), "image/svg+xml");
    shape.setAttribute("d", file.querySelector("path")?.getAttribute("d") ?? "");
    const translations = translationsOf(file)?.map((length) => PATCH_CELLS * length);
    // The corners of a turned square reach further.
    const places = translations ? copiesOf(translations, side * (isTurned() ? Math.SQRT2 : 1)) : [];
    replace(copies, ...places.map(([x, y]) => svg("use", { href: `#${shape.id}`, x, y })));
    drawing.setAttribute("viewBox", `${-side / 2} ${-side / 2} ${side} ${side}`);
    drawing.setAttribute("aria-label", `Tiling ${found.family} with parameters ${found.parameters.map((value) => digits(value)).join(", ")}`);
    drawnSide = side;
    drawScale();
  }

  /** Structures of every size are drawn with beams of one width, and the bar says how large they are. */
  function drawScale(): void {
    if (drawnSide === 0) return;
    const side = drawnSide;
    const scale = (widthNow() ?? DRAWN_WIDTH) / DRAWN_WIDTH;
    const words = roundLength((side > 30 ? 10 : 5) * scale);
    const length = words / scale;
    // The frame is lower than wide: of the square only so much is seen.
    const at = { x: side / 2 - length - side * 0.05, y: (HEIGHT_SHARE * side) / 2 - side * 0.05 };
    scaleBar.setAttribute("d", `M${at.x} ${at.y}h${length}`);
    scaleBar.setAttribute("stroke-width", String(side / 120));
    scaleWords.setAttribute("x", String(at.x));
    scaleWords.setAttribute("y", String(at.y - side * 0.02));
    scaleWords.setAttribute("font-size", String(side / 28));
    scaleWords.textContent = `${digits(words)} mm`;
  }

  /** Width of the beams in mm; of a cell's size it follows once the design has been measured. */
  function widthNow(): number | null {
    const { size } = session.state.get().made;
    return size.kind === "beam_width" ? size.value : (session.shown.get()?.measures.beamWidth ?? null);
  }

  function turn(): void {
    const { made, found } = session.state.get();
    // The picture's y axis points down.
    turned.setAttribute("transform", `rotate(${(-orientationOf(made, found) * 180) / Math.PI})`);
  }

  // Of the design of the sliders, which may be ahead of its response.
  session.state.watch(({ found }) => {
    if (!found) return;
    turn();
    drawScale();
    const key = `${found.family} ${found.parameters.join()} ${isTurned()}`;
    if (key === asked) return;
    asked = key;
    caption.textContent = `${found.family}. ${session.family(found.family)?.description ?? ""}`;
    requests.submit(async (signal) => {
      try {
        await draw(found, signal);
      } catch (error) {
        asked = "";
        // Parameters that give no structure: the drawing stays, the card says what is wrong.
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
