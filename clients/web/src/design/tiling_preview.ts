// The structure of the design shown, drawn from the server's file.
import { h, svg } from "../base/dom";
import { digits, percent } from "../base/format";
import { Latest } from "../base/latest";
import { type Client, isAbort } from "../contract/client";
import type { Family } from "../contract/types";
import { DEFAULT_MADE, orientationOf } from "./made";
import { structurePath } from "./requests";
import type { DesignSession } from "./session";
import type { Found } from "./state";

const MOST_CELLS = 16;
/** Height of the frame over its width. */
const HEIGHT_SHARE = 3 / 4;
/** Of the beams in the server's file, mm. */
const DRAWN_WIDTH = DEFAULT_MADE.size.value;
/** How much smaller than at the default parameters a family's cell may become, along a side. */
const SHRINKAGE = 1.6;

/** Side of the square that is shown, mm: some cells, whatever their size. */
export function windowSize(family: Family): number {
  const longest = Math.max(...family.cell.lattice.map(([x, y]) => Math.hypot(x, y)));
  return Math.max(14, Math.min(48, 2.4 * longest));
}

/** Cells along the two translations whose patch covers a square of this side around its centre. */
export function coveringCells(lattice: readonly (readonly number[])[], side: number): [number, number] {
  const [[ax, ay], [bx, by]] = lattice;
  const area = Math.abs(ax * by - ay * bx);
  // The square's reach across the other translation, over the cell's width there.
  const count = (x: number, y: number) => Math.min(MOST_CELLS, Math.ceil((side * (Math.abs(x) + Math.abs(y))) / area));
  return [count(bx, by), count(ax, ay)];
}

/** The length of 1, 2 or 5 times a power of ten that comes closest, so that it can be read. */
function roundLength(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  const distance = (factor: number) => Math.abs(Math.log((factor * power) / length));
  return [1, 2, 5, 10].reduce((best, factor) => (distance(factor) < distance(best) ? factor : best)) * power;
}

export function tilingPreview(session: DesignSession, client: Client): HTMLElement {
  const shape = svg("path", { class: "solid", "fill-rule": "evenodd" });
  const scaleBar = svg("path", { class: "scale-bar" });
  const scaleWords = svg("text", { class: "scale-words" });
  const turned = svg("g", {}, shape);
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
    const path = structurePath(found, "svg", coveringCells(family.cell.lattice, SHRINKAGE * side * (isTurned() ? Math.SQRT2 : 1)));
    const text = await (await client.send("GET", path, undefined, { signal })).text();
    const solid = new DOMParser().parseFromString(text, "image/svg+xml").querySelector("path");
    shape.setAttribute("d", solid?.getAttribute("d") ?? "");
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
