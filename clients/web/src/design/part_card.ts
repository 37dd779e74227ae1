// The card for a part to print or cut, made of the shown design: settings, picture, measures and files.
import { button, Checkbox, Segments } from "../base/controls";
import { h, writeText } from "../base/dom";
import { download } from "../base/download";
import { debounce } from "../base/debounce";
import { explain } from "../contract/client";
import { cellsOf, cellWords } from "./part_cells";
import { layoutOf, type PartLayout } from "./drawing";
import { drawingFields } from "./drawing_fields";
import { fillingsOf } from "./fillings";
import { type Part, type PartFormat, type PartSettings, type Product, productOf, settingsOf } from "./part";
import { PartFields } from "./part_fields";
import { loadWords } from "./part_load";
import { partResult } from "./part_result";
import { axisOf, type Sketch, sizeWords, sketchOf } from "./part_sketch";
import { radians } from "./specification";
import { regionWords } from "./region_list";
import type { DesignSession } from "./session";

const PAUSE_MS = 400;
const SHAPES = [{ value: "coupon", words: "Coupon" }, { value: "block", words: "Block" }, { value: "rectangle", words: "Sheet" }, { value: "drawing", words: "Drawing" }] as const;

/** The curves of the drawing that bound the part and its regions; null for the other shapes. */
function layoutShown(session: DesignSession, part: Part): PartLayout | null {
  const drawing = part.drawing.get();
  if (part.settings.get().kind !== "drawing" || !drawing) return null;
  return layoutOf(drawing, session.regionEdits.all.map(regionWords), part.choices.get());
}

/** Says how the structures are turned in the part. */
function turnShown(session: DesignSession, settings: PartSettings): string {
  const axis = axisOf(settings);
  if (settings.kind === "drawing" && axis !== null && session.regionEdits.all.length > 1) {
    return "Each region is turned so that its design’s load runs along the part.";
  }
  return loadWords(settings.direction === null ? null : radians(settings.direction), axis);
}

/** The contents of a part whose shape is a drawing; null for the other shapes. */
function productShown(session: DesignSession, part: Part): Product | null {
  const drawing = part.drawing.get();
  const settings = part.settings.get();
  const layout = layoutShown(session, part);
  if (!drawing || !layout) return null;
  const regions = session.regionEdits.all;
  const fillings = fillingsOf(regions, session.results.ofRegions, part.choices.get().walls);
  const own = { beamWidth: settings.beamWidth, orientation: radians(settings.orientation), direction: settings.direction === null ? null : radians(settings.direction) };
  return productOf(drawing, layout, fillings.map((filling) => filling && (regions.length === 1 ? { ...filling, ...own } : filling)));
}

/** The sketch of a part from the fields alone, before the server has made it: `sketch` draws it and says its outer size and how it is turned. */
function partSketch(session: DesignSession, part: Part, draw: (shape: Sketch | null) => void): { size: HTMLElement; turned: HTMLElement; sketch: () => void } {
  const size = h("p", { class: "muted part-size" });
  const turned = h("p", { class: "note plain part-turn", role: "status" });
  const sketch = (): void => {
    const settings = part.settings.get();
    const shape = sketchOf(settings, part.drawing.get(), layoutShown(session, part), session.regionEdits.all.map(regionWords));
    draw(shape);
    size.textContent = shape ? sizeWords(settings, shape) : "";
    turned.textContent = shape ? turnShown(session, settings) : "";
  };
  return { size, turned, sketch };
}

/** Says where the part has so few cells that its edges count, with a button that makes it larger. */
function cellHint(session: DesignSession, part: Part, change: (values: Partial<PartSettings>) => void): { element: HTMLElement; show: () => void } {
  const words = h("p");
  const enlarge = button("", () => {
    const better = cells()?.better;
    if (better) change(better);
  });
  const element = h("div", { class: "note plain part-cells", role: "status" }, words, enlarge);
  const cells = () => cellsOf(part.settings.get(), session.results.shown.get()?.measures ?? null);
  const show = (): void => {
    const known = cells();
    element.hidden = !known?.better;
    if (!known?.better) return;
    writeText(words, cellWords(known));
    writeText(enlarge, `Make it ${known.better.width} × ${known.better.length} mm`);
  };
  return { element, show };
}

async function save(session: DesignSession, part: Part, format: PartFormat, tell: (sentence: string) => void): Promise<void> {
  const shown = session.results.shown.get();
  if (!shown) return;
  try {
    const file = await part.file(shown.found, format, productShown(session, part));
    download(file.name, file.type, file.content);
  } catch (error) {
    tell(explain(error));
  }
}

/** The buttons that save the part. They stay in sight at the lower edge of the window while the settings above them are scrolled. */
function fileButtons(session: DesignSession, part: Part, tell: (sentence: string) => void): HTMLElement {
  const formats = (["stl", "3mf", "step", "dxf", "svg"] as const).map((format) =>
    button(format.toUpperCase(), () => void save(session, part, format, tell), { title: `Download the part as ${format.toUpperCase()}` })
  );
  return h("div", { class: "part-files", role: "group", "aria-label": "Files of the part" }, h("span", { class: "muted" }, "Save"), ...formats);
}

export function partCard(session: DesignSession, part: Part): HTMLElement {
  const kind = new Segments<PartSettings["kind"]>("Shape", SHAPES, (value) => change({ kind: value }));
  const whole = new Checkbox("Whole tiles only", (value) => change({ whole: value }));
  const fields = new PartFields(change, show);
  const fromDrawing = drawingFields(session, part);
  const result = partResult(part);
  const files = fileButtons(session, part, result.tell);
  const { size, turned, sketch } = partSketch(session, part, result.sketch);
  const hint = cellHint(session, part, change);
  const element = h("details", { class: "card controls part", "aria-label": "Part" }, h("summary", {}, "Part to make"), kind.element, fromDrawing, fields.element, whole.element,
    size, hint.element, turned, files, result.element);

  const later = debounce(() => describe(), PAUSE_MS);

  function change(values: Partial<PartSettings>): void {
    part.settings.set({ ...part.settings.get(), ...values });
    later.schedule();
  }

  function show(): void {
    const settings = part.settings.get();
    kind.value = settings.kind;
    whole.value = settings.whole;
    fields.show(settings, session.regionEdits.all.length > 1);
    const isDrawing = settings.kind === "drawing";
    fromDrawing.hidden = !isDrawing;
    // Until a drawing has been read, the last result belongs to another shape.
    files.hidden = result.element.hidden = isDrawing && part.drawing.get() === null;
    sketch();
    hint.show();
  }

  function describe(): void {
    const shown = session.results.shown.get();
    if (!element.open || !shown || shown.provisional || result.element.hidden) return;
    part.describe(shown.found, productShown(session, part));
  }

  // The user's settings stay until the design's own values change.
  let lastSettings = "";
  session.results.shown.watch((shown) => {
    if (shown && !shown.provisional) {
      const settings = settingsOf(shown);
      const now = JSON.stringify(settings);
      if (now !== lastSettings) part.settings.set({ ...part.settings.get(), ...settings });
      lastSettings = now;
    }
    hint.show();
    later.schedule();
  });
  part.settings.watch(() => show());
  part.drawing.watch((read) => {
    show();
    if (!read) return;
    element.open = true;
    later.flush();
  });
  let several = false;
  session.state.watch(({ otherRegions }) => {
    // The names of regions say in which curves they lie.
    if (part.settings.get().kind === "drawing") sketch();
    if (several === otherRegions.length > 0) return;
    several = !several;
    show();
  });
  // A part whose shape is a drawing depends on the designs of all regions.
  const redraw = (): void => {
    if (part.settings.get().kind !== "drawing") return;
    sketch();
    later.schedule();
  };
  for (const one of [part.choices, session.results.regionCache, session.results.all]) one.watch(redraw);
  element.addEventListener("toggle", () => describe());
  return element;
}
