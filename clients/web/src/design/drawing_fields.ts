// The fields for a part whose shape is a drawing: file, size, outline, and the location of each region.
import { button, Select } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { digits } from "../base/format";
import { textOf } from "../base/text_file";
import { showText } from "../base/writing";
import { curveWords, type Drawing, layoutOf, regionsIn, REST_NAME, withRegionMoved, type RegionLocation } from "./drawing";
import { materialsNote, wallWidthOf } from "./fillings";
import type { Part } from "./part";
import { MAX_REGIONS, regionWords } from "./region_list";
import type { DesignSession } from "./session";

const FILE_TYPES = ".svg,.dxf,image/svg+xml,image/vnd.dxf";
const NO_DRAWING = "SVG or DXF (ASCII): a closed curve for the outline, and one for each region. A region lies in the curve of its name. Drop the file onto the page, or open it.";
const RESOLUTIONS = [["72", "72 (Adobe Illustrator)"], ["90", "90 (Inkscape before 0.92)"], ["96", "96 (browsers, Inkscape)"]] as const;
const LARGEST = "largest";
const OTHERS = "others";
const REGIONS = "regions";

/** The fields of one region: its location and the width of its walls. */
class RegionFields {
  readonly element: HTMLElement;
  private readonly list: Select<string>;
  private readonly walls: HTMLInputElement;

  constructor(private readonly part: Part, private readonly names: readonly string[], private readonly k: number, drawing: Drawing) {
    const name = names[k];
    this.list = new Select<string>(name, [
      { value: "rest", words: "The rest of the part" },
      ...drawing.curves.polygons.map((polygon, place) => ({ value: String(place), words: `Within ${curveWords(polygon, place)}` })),
      { value: "nowhere", words: "Nowhere" },
    ], (value) => this.move(value === "rest" || value === "nowhere" ? value : Number(value), drawing));
    this.walls = h("input", { type: "number", class: "number", min: 0, step: "any", "aria-label": `Wall thickness of ${name}, mm`, onchange: () => this.setWalls() });
    this.element = h("div", { class: "drawing-region" }, this.list.element,
      h("div", { class: "field" }, h("span", { class: "field-words", "aria-hidden": "true" }, "Walls, mm"), this.walls));
  }

  show(location: RegionLocation, walls: number): void {
    this.list.value = String(location);
    showText(this.walls, String(walls));
  }

  private move(to: RegionLocation, drawing: Drawing): void {
    const choices = this.part.choices.get();
    const now = this.part.drawing.get() ?? drawing; // the drawing may have been scaled since these fields were built
    this.part.choices.set({ ...choices, ...withRegionMoved(layoutOf(now, [...this.names], choices), choices, this.k, to) });
  }

  private setWalls(): void {
    const value = Number(this.walls.value);
    const choices = this.part.choices.get();
    const walls = this.names.map((_, place) => (place === this.k ? (this.walls.value !== "" && value > 0 ? value : undefined) : choices.walls[place]));
    this.part.choices.set({ ...choices, walls });
  }
}

/** A button that opens a file. */
function opener(part: Part): HTMLElement {
  const open = (): void => {
    const chosen = file.files?.[0];
    if (chosen) void chosen.arrayBuffer().then((bytes) => part.open(textOf(bytes), chosen.name));
    file.value = "";
  };
  const file = h("input", { type: "file", accept: FILE_TYPES, class: "visually-hidden", id: uniqueId("file"), onchange: open });
  return h("div", { class: "row" }, h("label", { class: "button", for: file.id }, "Open a drawing"), file);
}

/** The field of the drawing's width, and a function that shows the present one. */
function widthField(part: Part): { element: HTMLElement; show: () => void } {
  const show = (): void => {
    const { width = null, curves } = part.drawing.get() ?? {};
    showText(input, width === null ? "" : String(width));
    input.placeholder = curves ? digits(curves.size[0], 4) : "";
  };
  const read = (): void => {
    const value = Number(input.value);
    if (input.value === "" && !input.validity.badInput) part.scale(null);
    else if (value > 0) part.scale(value);
    else show();
  };
  const input = h("input", { type: "number", class: "number", id: uniqueId("width"), min: 0, step: "any", onchange: read });
  return { element: h("div", { class: "field" }, h("label", { for: input.id }, "Width of the drawing, mm"), input), show };
}

/** The fields; the caller shows them while the shape of the part is a drawing. */
export function drawingFields(session: DesignSession, part: Part): HTMLElement {
  const words = h("p", { class: "muted" }, NO_DRAWING);
  const problem = h("p", { class: "note problem", role: "alert", hidden: true });
  const width = widthField(part);
  const resolution = new Select<string>("Pixels per inch", [{ value: "", words: "Not said: 96" }, ...RESOLUTIONS.map(([value, words]) => ({ value, words }))],
    (value) => part.setResolution(value === "" ? null : Number(value)));
  const outline = new Select<string>("Outline of the part", [],
    (value) => part.choices.set({ ...part.choices.get(), outline: value === LARGEST ? undefined : value === OTHERS || value === REGIONS ? value : Number(value) }));
  const regions = h("div", { class: "drawing-regions", role: "group", "aria-label": "Regions of the drawing" });
  const note = h("p", { class: "note" });
  let namesFound: readonly string[] = [];
  const makeRegions = button("Make regions", () => session.regionEdits.make(namesFound), { kind: "primary" });
  const settings = h("div", { class: "drawing-settings" }, width.element, makeRegions, outline.element, regions, note);
  const element = h("div", { class: "drawing-fields" }, opener(part), words, problem, resolution.element, settings);

  let fields: RegionFields[] = [];
  let builtKey = "";
  /** Rebuilds the fields only if curves or regions have changed, because new fields lose the focus and unfinished input. */
  function build(drawing: Drawing, names: readonly string[]): void {
    const { polygons } = drawing.curves;
    const several = names.length > 1;
    const key = JSON.stringify([drawing.name, polygons.map(curveWords), names]);
    if (key === builtKey) return;
    builtKey = key;
    outline.setChoices([{ value: LARGEST, words: "The largest curve, with its holes" }, { value: OTHERS, words: several ? "All curves of no region" : "All curves" },
      ...(several ? [{ value: REGIONS, words: "None: the regions make the part" }] : []),
      ...polygons.map((polygon, place) => ({ value: String(place), words: curveWords(polygon, place) }))]);
    fields = several ? names.map((_, k) => new RegionFields(part, names, k, drawing)) : [];
    regions.hidden = !several;
    replace(regions, ...fields.map((one) => one.element));
  }

  function show(): void {
    const drawing = part.drawing.get();
    settings.hidden = drawing === null;
    if (!drawing) return;
    const all = session.regionEdits.all;
    const names = all.map(regionWords);
    note.textContent = materialsNote(all);
    const choices = part.choices.get();
    const layout = layoutOf(drawing, names, choices);
    words.textContent = drawingWords(drawing);
    namesFound = regionsIn(drawing).slice(0, MAX_REGIONS);
    makeRegions.hidden = namesFound.length === 0 || namesFound.every((name) => name === REST_NAME || names.some((one) => one.toLowerCase() === name.toLowerCase()));
    makeRegions.replaceChildren(h("span", {}, `Make ${namesFound.length} regions`));
    makeRegions.title = `A region with a design of its own for each of: ${namesFound.join(", ")}`;
    build(drawing, names);
    outline.value = String(choices.outline ?? (layout.outline.length === 0 ? REGIONS : LARGEST));
    fields.forEach((one, k) => one.show(layout.regions[k], choices.walls[k] ?? wallWidthOf(all[k], session.results.ofRegions[k])));
    resolution.value = drawing.resolution === null ? "" : String(drawing.resolution);
    width.show();
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
  for (const one of [part.drawing, part.choices, session.state, session.results.regionCache, session.results.all]) one.watch(show);
  return element;
}

function drawingWords({ name, curves: { polygons, size, warnings } }: Drawing): string {
  const count = `${polygons.length} closed curve${polygons.length === 1 ? "" : "s"}`;
  return [`${name}: ${count}, ${size.map((length) => digits(length, 4)).join(" × ")} mm.`, ...warnings].join(" ");
}
