// The card for a part to print or cut, made of the shown design: settings, picture, measures and files.
import { button, Checkbox, Segments } from "../base/controls";
import { h, replace, svg, uniqueId } from "../base/dom";
import { download } from "../base/download";
import { digits } from "../base/format";
import { debounce } from "../base/debounce";
import { showText } from "../base/writing";
import { explain } from "../contract/client";
import type { PartAnswer } from "../contract/types";
import { layoutOf } from "./drawing";
import { drawingFields } from "./drawing_fields";
import { fillingsOf } from "./fillings";
import { type Part, type PartFormat, type PartSettings, type PartState, type Product, productOf, settingsOf } from "./part";
import { radians } from "./specification";
import { regionWords } from "./region_list";
import type { DesignSession } from "./session";

const PAUSE_MS = 400;
type NumberSetting = "width" | "length" | "end" | "beamWidth" | "thickness" | "frame" | "density" | "orientation" | "direction";
const LABELS: Record<NumberSetting, string> = {
  width: "Width, mm",
  length: "Length, mm",
  end: "Grips, mm",
  beamWidth: "Wall thickness, mm",
  thickness: "Thickness, mm",
  frame: "Frame, mm",
  density: "Density, g/cm³",
  orientation: "Orientation, °",
  direction: "Loaded along, °",
};
const END_WORDS = { rectangle: "", coupon: "Each grip, mm", block: "Each plate, mm", drawing: "" } as const;
/** Settings that a drawing replaces by the size of its curves. */
const SIZE_SETTINGS: readonly NumberSetting[] = ["width", "length", "end"];
/** Settings that each region has for itself, if there are several. */
const STRUCTURE_SETTINGS: readonly NumberSetting[] = ["beamWidth", "orientation"];
/** Settings that are angles. */
const ANGLE_SETTINGS: readonly NumberSetting[] = ["orientation", "direction"];

/** Why the part cannot be made, or the server's message about it. */
function noteOf(state: PartState): string {
  if (state.kind === "failed") return state.sentence;
  return state.kind === "made" ? state.answer.message : "";
}

/** The narrowest wall, and how many narrower places the server has widened or cut. */
function wallWords({ smallest_neck, smallest_wall, widened_necks, cut_necks }: PartAnswer["checks"]): string {
  const narrowest = `at least ${digits(smallest_neck ?? smallest_wall, 2)} mm`;
  const done = [widened_necks > 0 ? `${widened_necks} widened` : "", cut_necks > 0 ? `${cut_necks} cut` : ""].filter((words) => words !== "");
  return done.length > 0 ? `${narrowest}; narrow places: ${done.join(", ")}` : narrowest;
}

export function partCard(session: DesignSession, part: Part): HTMLElement {
  const shape = svg("path", { class: "solid", "fill-rule": "evenodd" });
  const drawing = svg("svg", { class: "part-drawing", role: "img", "aria-label": "The part" }, shape);
  const facts = h("dl", { class: "facts compact" });
  const note = h("p", { class: "note", role: "status" });
  const kind = new Segments<PartSettings["kind"]>("Shape", [{ value: "coupon", words: "Coupon" }, { value: "block", words: "Block" }, { value: "rectangle", words: "Sheet" }, {
    value: "drawing",
    words: "Drawing",
  }], (value) => change({ kind: value }));
  const whole = new Checkbox("Whole tiles only", (value) => change({ whole: value }));
  const fields = new Map<NumberSetting, { field: HTMLElement; label: HTMLElement; input: HTMLInputElement }>();
  for (const name of Object.keys(LABELS) as NumberSetting[]) {
    const id = uniqueId("part");
    const input = h("input", {
      type: "number",
      id,
      class: "number",
      min: ANGLE_SETTINGS.includes(name) ? null : 0,
      step: "any",
      onchange: () => {
        const value = Number(input.value);
        if (input.value === "" && name === "direction" && input.validity.valid) change({ direction: null });
        else if (input.value !== "" && Number.isFinite(value) && (value >= 0 || ANGLE_SETTINGS.includes(name))) change({ [name]: value });
        else show();
      },
    });
    const label = h("label", { for: id }, LABELS[name]);
    fields.set(name, { field: h("div", { class: "field" }, label, input), label, input });
  }
  const fromDrawing = drawingFields(session, part);
  const formats = (["stl", "3mf", "step", "dxf", "svg"] as const).map((format) =>
    button(format.toUpperCase(), () => void save(format), { title: `Download the part as ${format.toUpperCase()}` })
  );
  const result = h("div", { class: "part-result" }, drawing, facts, note, h("div", { class: "row", role: "group", "aria-label": "Files of the part" }, ...formats));
  const element = h("details", { class: "card controls part", "aria-label": "Part" }, h("summary", {}, "Part to make"), kind.element, fromDrawing,
    h("div", { class: "part-fields" }, ...[...fields.values()].map((entry) => entry.field)), whole.element, result);

  const later = debounce(() => describe(), PAUSE_MS);

  function change(values: Partial<PartSettings>): void {
    part.settings.set({ ...part.settings.get(), ...values });
    later.schedule();
  }

  function show(): void {
    const settings = part.settings.get();
    kind.value = settings.kind;
    whole.value = settings.whole;
    const isDrawing = settings.kind === "drawing";
    for (const [name, { field, label, input }] of fields) {
      showText(input, String(settings[name] ?? ""));
      field.hidden = isDrawing && (SIZE_SETTINGS.includes(name) || (STRUCTURE_SETTINGS.includes(name) && session.regions.length > 1));
      if (name === "direction") {
        field.hidden = isDrawing || settings.kind === "rectangle";
        input.title = "The direction of the design that lies along the length of the part; without one the design's 90°";
      }
      if (name === "end") {
        field.hidden ||= settings.kind === "rectangle";
        label.textContent = END_WORDS[settings.kind];
      }
    }
    fromDrawing.hidden = !isDrawing;
    // Until a drawing has been read, the last result belongs to another shape.
    result.hidden = isDrawing && part.drawing.get() === null;
  }

  /** The contents of a part whose shape is a drawing; null for the other shapes. */
  function product(): Product | null {
    const drawing = part.drawing.get();
    const settings = part.settings.get();
    if (settings.kind !== "drawing" || !drawing) return null;
    const { regions } = session;
    const choices = part.choices.get();
    const fillings = fillingsOf(regions, session.regionShown, choices.walls);
    const one = regions.length === 1;
    return productOf(drawing, layoutOf(drawing, regions.map(regionWords), choices),
      fillings.map((filling) => filling && (one ? { ...filling, beamWidth: settings.beamWidth, orientation: radians(settings.orientation) } : filling)));
  }

  function describe(): void {
    const shown = session.shown.get();
    if (!element.open || !shown || shown.provisional || result.hidden) return;
    part.describe(shown.found, product());
  }

  async function save(format: PartFormat): Promise<void> {
    const shown = session.shown.get();
    if (!shown) return;
    try {
      const file = await part.file(shown.found, format, product());
      download(file.name, file.type, file.content);
    } catch (error) {
      note.textContent = explain(error);
    }
  }

  // The user's settings stay until the design's own values change.
  let lastSettings = "";
  session.shown.watch((shown) => {
    if (shown && !shown.provisional) {
      const settings = settingsOf(shown);
      const now = JSON.stringify(settings);
      if (now !== lastSettings) part.settings.set({ ...part.settings.get(), ...settings });
      lastSettings = now;
    }
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
    if (several === otherRegions.length > 0) return;
    several = !several;
    show();
  });
  // A part whose shape is a drawing depends on the designs of all regions.
  for (const one of [part.choices, session.regionCache, session.all]) one.watch(() => part.settings.get().kind === "drawing" && later.schedule());
  element.addEventListener("toggle", () => describe());
  part.state.watch((state) => {
    note.textContent = noteOf(state);
    drawing.classList.toggle("old", state.kind === "failed");
    if (state.kind !== "made") return;
    const { answer } = state;
    const solid = new DOMParser().parseFromString(answer.svg ?? "", "image/svg+xml");
    shape.setAttribute("d", solid.querySelector("path")?.getAttribute("d") ?? "");
    drawing.setAttribute("viewBox", solid.documentElement.getAttribute("viewBox") ?? "0 0 1 1");
    drawing.setAttribute("aria-label", `The part, ${answer.size.map((value) => digits(value)).join(" by ")} mm`);
    const rows: [string, string][] = [
      ["Size", `${answer.size.map((value) => digits(value)).join(" × ")} mm`],
      ["Mass", `${digits(answer.mass)} g`],
      ["Density", `${digits(100 * answer.relative_density)} % solid`],
      ["Walls", wallWords(answer.checks)],
      ...(answer.tested_direction === null ? [] : [["Load", `along the design’s ${digits((answer.tested_direction * 180) / Math.PI)}°`] as [string, string]]),
      ["Pieces", answer.checks.crumbs > 0 ? `one; ${answer.checks.crumbs} loose left out` : "one"],
    ];
    replace(facts, ...rows.flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
  });
  return element;
}
