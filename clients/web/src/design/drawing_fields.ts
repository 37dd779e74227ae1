// The fields for a part whose shape is a drawing: file, size, outline, and the location of each region.
import { Select } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { digits } from "../base/format";
import { textOf } from "../base/text_file";
import { showText } from "../base/writing";
import { curveWords, type Drawing, layoutOf, withRegionMoved, type RegionLocation } from "./drawing";
import { materialsNote, wallWidthOf } from "./fillings";
import type { Part } from "./part";
import { regionWords } from "./region_list";
import type { DesignSession } from "./session";

const FILE_TYPES = ".svg,.dxf,image/svg+xml,image/vnd.dxf";
const NO_DRAWING = "SVG or DXF (ASCII): a closed curve for the outline, and one for each region. A region lies in the curve of its name. Drop the file onto the page, or open it.";
const RESOLUTIONS = [["72", "72 (Adobe Illustrator)"], ["90", "90 (Inkscape before 0.92)"], ["96", "96 (browsers, Inkscape)"]] as const;
const LARGEST = "largest";
const OTHERS = "others";

/** The fields of one region: its location and the width of its walls. */
interface RegionFields {
  readonly element: HTMLElement;
  readonly list: Select<string>;
  readonly walls: HTMLInputElement;
}

/** The fields; the caller shows them while the shape of the part is a drawing. */
export function drawingFields(session: DesignSession, part: Part): HTMLElement {
  const file = h("input", {
    type: "file",
    accept: FILE_TYPES,
    class: "visually-hidden",
    id: uniqueId("file"),
    onchange: () => {
      const chosen = file.files?.[0];
      if (chosen) void chosen.arrayBuffer().then((bytes) => part.open(textOf(bytes), chosen.name));
      file.value = "";
    },
  });
  const words = h("p", { class: "muted" }, NO_DRAWING);
  const problem = h("p", { class: "note problem", role: "alert", hidden: true });
  const width = h("input", {
    type: "number",
    class: "number",
    id: uniqueId("width"),
    min: 0,
    step: "any",
    onchange: () => {
      const value = Number(width.value);
      if (width.value === "" && !width.validity.badInput) part.scale(null);
      else if (value > 0) part.scale(value);
      else showWidth();
    },
  });
  const resolution = new Select<string>("Pixels per inch", [{ value: "", words: "Not said: 96" }, ...RESOLUTIONS.map(([value, words]) => ({ value, words }))],
    (value) => part.setResolution(value === "" ? null : Number(value)));
  const outline = new Select<string>("Outline of the part", [],
    (value) => part.choices.set({ ...part.choices.get(), outline: value === LARGEST ? undefined : value === OTHERS ? OTHERS : Number(value) }));
  const regions = h("div", { class: "drawing-regions", role: "group", "aria-label": "Regions of the drawing" });
  const note = h("p", { class: "note" });
  const settings = h("div", { class: "drawing-settings" }, h("div", { class: "field" }, h("label", { for: width.id }, "Width of the drawing, mm"), width), outline.element, regions,
    note);
  const element = h("div", { class: "drawing-fields" }, h("div", { class: "row" }, h("label", { class: "button", for: file.id }, "Open a drawing"), file), words, problem,
    resolution.element, settings);

  function showWidth(): void {
    const { width: chosenWidth = null, curves } = part.drawing.get() ?? {};
    showText(width, chosenWidth === null ? "" : String(chosenWidth));
    width.placeholder = curves ? digits(curves.size[0], 4) : "";
  }

  function region(drawing: Drawing, k: number): RegionFields {
    const name = regionWords(session.regions[k], k);
    const list = new Select<string>(name, [
      { value: "rest", words: "The rest of the part" },
      ...drawing.curves.polygons.map((polygon, place) => ({ value: String(place), words: `Within ${curveWords(polygon, place)}` })),
      { value: "nowhere", words: "Nowhere" },
    ], (value) => {
      const to: RegionLocation = value === "rest" || value === "nowhere" ? value : Number(value);
      const choices = part.choices.get();
      const now = part.drawing.get() ?? drawing; // the drawing may have been scaled since these fields were built
      part.choices.set({ ...choices, ...withRegionMoved(layoutOf(now, names(), choices), choices, k, to) });
    });
    const walls = h("input", {
      type: "number",
      class: "number",
      min: 0,
      step: "any",
      "aria-label": `Wall thickness of ${name}, mm`,
      onchange: () => {
        const value = Number(walls.value);
        const { walls: before } = part.choices.get();
        const after = session.regions.map((_, place) => (place === k ? (walls.value !== "" && value > 0 ? value : undefined) : before[place]));
        part.choices.set({ ...part.choices.get(), walls: after });
      },
    });
    const element = h("div", { class: "drawing-region" }, list.element,
      h("div", { class: "field" }, h("span", { class: "field-words", "aria-hidden": "true" }, "Walls, mm"), walls));
    return { element, list, walls };
  }

  function names(): string[] {
    return session.regions.map(regionWords);
  }

  let fields: RegionFields[] = [];
  let builtKey = "";
  /** Rebuilds the fields only if curves or regions have changed, because new fields lose the focus and unfinished input. */
  function build(drawing: Drawing): void {
    const { polygons } = drawing.curves;
    const several = names().length > 1;
    const key = JSON.stringify([drawing.name, polygons.map(curveWords), names()]);
    if (key === builtKey) return;
    builtKey = key;
    outline.setChoices([{ value: LARGEST, words: "The largest curve, with its holes" }, { value: OTHERS, words: several ? "All curves of no region" : "All curves" },
      ...polygons.map((polygon, place) => ({ value: String(place), words: curveWords(polygon, place) }))]);
    fields = several ? names().map((_, k) => region(drawing, k)) : [];
    regions.hidden = !several;
    replace(regions, ...fields.map(({ element }) => element));
  }

  function show(): void {
    const drawing = part.drawing.get();
    settings.hidden = drawing === null;
    if (!drawing) return;
    note.textContent = materialsNote(session.regions);
    const choices = part.choices.get();
    const { polygons, size, warnings } = drawing.curves;
    const layout = layoutOf(drawing, names(), choices);
    const count = `${polygons.length} closed curve${polygons.length === 1 ? "" : "s"}`;
    words.textContent = [`${drawing.name}: ${count}, ${size.map((length) => digits(length, 4)).join(" × ")} mm.`, ...warnings].join(" ");
    build(drawing);
    outline.value = String(choices.outline ?? LARGEST);
    fields.forEach(({ list, walls }, k) => {
      list.value = String(layout.regions[k]);
      showText(walls, String(choices.walls[k] ?? wallWidthOf(session.regions[k], session.regionShown[k])));
    });
    resolution.value = drawing.resolution === null ? "" : String(drawing.resolution);
    showWidth();
  }

  part.drawingProblem.watch((sentence) => {
    problem.textContent = sentence;
    problem.hidden = sentence === "";
  });
  part.resolutionAsked.watch((isAsked) => (resolution.element.hidden = !isAsked));
  let count = 1;
  session.state.watch(({ otherRegions }) => {
    // Choices refer to regions by index, so that they are void once a region was added or removed.
    if (otherRegions.length + 1 !== count) part.choices.set({ ...part.choices.get(), regions: [], walls: [] });
    count = otherRegions.length + 1;
  });
  for (const one of [part.drawing, part.choices, session.state, session.regionCache, session.all]) one.watch(show);
  return element;
}
