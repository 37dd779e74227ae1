// The state as the text of a link: readable, and checked when it is read, since links come from anywhere.
import { plain } from "../base/format";
import type { CrossingOverride } from "../contract/types";
import { LayoutTextError, readLayoutText } from "./layout_text";
import { type LengthName, lengthLimits, type Lengths, PATTERN_IDS, PATTERNS } from "./patterns";
import { DEFAULT_STATE, type FreeLayout, type LoadKind, MAX_AMOUNT, MAX_CELLS, MAX_SEGMENTS, type SheetState, usableStrain, type WeaveState } from "./state";

/** Limit of the length of a link; some programs truncate longer ones. */
const MAX_LINK_LENGTH = 30_000;
const MAX_OVERRIDES = 5000;
const LOADS: readonly LoadKind[] = ["stretch_x", "stretch_y", "shear", "push"];

export function isShareable(state: WeaveState): boolean {
  return writeLink(state).length <= MAX_LINK_LENGTH;
}

export function writeLink(state: WeaveState): string {
  const { columns, rows, load, amount } = state.sheet;
  const pattern = PATTERNS[state.pattern];
  const fields: [string, string][] = [["pattern", state.pattern]];
  if (pattern.types.length > 0) fields.push(["type", String(state.type)]);
  for (const name of [...pattern.lengths, "radius"] as const) fields.push([name, plain(state.lengths[name])]);
  fields.push(["modulus", plain(state.youngsModulus)], ["strain", plain(state.strain)]);
  if (state.shear === "suppressed") fields.push(["shear", "suppressed"]);
  if (state.space === "off") fields.push(["space", "off"]);
  fields.push(["segments", String(state.segments)], ["sheet", [columns, rows, load, plain(amount)].join(",")]);
  if (state.overrides.length > 0) fields.push(["crossings", state.overrides.map(overrideText).join(";")]);
  if (state.pattern === "layout") fields.push(["layout", encodeURIComponent(JSON.stringify(state.layout))]);
  return fields.map(([name, value]) => `${name}=${value}`).join("&");
}

/** The state of a link; null if the text is no valid link. */
export function readLink(text: string): WeaveState | null {
  const fields = new Map(
    text.split("&").map((field): [string, string] => {
      const equals = field.indexOf("=");
      return [field.slice(0, equals), field.slice(equals + 1)];
    }),
  );
  const pattern = PATTERN_IDS.find((id) => id === fields.get("pattern"));
  if (!pattern) return null;
  const layout = pattern === "layout" ? readLayout(fields.get("layout") ?? "") : DEFAULT_STATE.layout;
  const overrides = readOverrides(fields.get("crossings") ?? "");
  if (!layout || !overrides) return null;
  const types = Math.max(1, PATTERNS[pattern].types.length);
  return {
    pattern,
    type: whole(fields.get("type"), 1, types, 1),
    lengths: readLengths(fields),
    youngsModulus: number(fields.get("modulus"), 1e-6, 1e7, DEFAULT_STATE.youngsModulus),
    layout,
    overrides,
    strain: usableStrain(number(fields.get("strain"), -0.5, 2, DEFAULT_STATE.strain)),
    shear: fields.get("shear") === "suppressed" ? "suppressed" : "free",
    space: fields.get("space") === "off" ? "off" : "automatic",
    segments: whole(fields.get("segments"), 1, MAX_SEGMENTS, DEFAULT_STATE.segments),
    sheet: readSheet(fields.get("sheet") ?? ""),
  };
}

/** An override as text: "3:0,1" for crossing 3 whose members 0 and 1 slide, followed by "~backward~forward" if limits are given. */
function overrideText({ crossing, slides, backward, forward }: CrossingOverride): string {
  const limits = backward === undefined && forward === undefined ? "" : `~${limitText(backward)}~${limitText(forward)}`;
  return `${crossing}:${slides.join(",")}${limits}`;
}

function limitText(limit: number | null | undefined): string {
  return limit === undefined ? "" : limit === null ? "none" : plain(limit);
}

function readOverrides(text: string): CrossingOverride[] | null {
  if (text === "") return [];
  const entries = text.split(";");
  if (entries.length > MAX_OVERRIDES) return null;
  const overrides: CrossingOverride[] = [];
  for (const entry of entries) {
    const match = /^(\d{1,9}):((?:\d{1,4})(?:,\d{1,4})*|)(?:~(none|[\d.e-]*)~(none|[\d.e-]*))?$/.exec(entry);
    if (!match) return null;
    const [, crossing, slides, backward, forward] = match;
    overrides.push({
      crossing: Number(crossing),
      slides: slides === "" ? [] : slides.split(",").map(Number),
      ...(backward && { backward: backward === "none" ? null : Number(backward) }),
      ...(forward && { forward: forward === "none" ? null : Number(forward) }),
    });
  }
  return overrides;
}

function readLayout(text: string): FreeLayout | null {
  try {
    return readLayoutText(decodeURIComponent(text)).layout;
  } catch (error) {
    if (error instanceof LayoutTextError || error instanceof URIError) return null;
    throw error;
  }
}

function readLengths(fields: ReadonlyMap<string, string>): Lengths {
  let lengths = DEFAULT_STATE.lengths;
  // The order matters, because the limits of a length depend on the lengths before it.
  for (const name of ["pitch", "side", "overlap", "circle_radius", "distance", "radius"] as const satisfies LengthName[]) {
    const [lower, upper] = lengthLimits(name, lengths);
    const fallback = Math.max(lower, Math.min(upper, lengths[name]));
    lengths = { ...lengths, [name]: number(fields.get(name), lower, upper, fallback) };
  }
  return lengths;
}

function readSheet(text: string): SheetState {
  const [columns, rows, load, amount] = text.split(",");
  const { sheet } = DEFAULT_STATE;
  return {
    columns: whole(columns, 1, MAX_CELLS, sheet.columns),
    rows: whole(rows, 1, MAX_CELLS, sheet.rows),
    load: LOADS.find((kind) => kind === load) ?? sheet.load,
    amount: number(amount, -MAX_AMOUNT, MAX_AMOUNT, sheet.amount),
  };
}

function number(text: string | undefined, lower: number, upper: number, fallback: number): number {
  const value = text === undefined || text === "" ? NaN : Number(text);
  // Links contain rounded values, so that a value at its limit may lie slightly beyond it.
  const tolerance = 1e-7 * Math.max(Math.abs(lower), Math.abs(upper));
  return value >= lower - tolerance && value <= upper + tolerance ? Math.max(lower, Math.min(upper, value)) : fallback;
}

function whole(text: string | undefined, lower: number, upper: number, fallback: number): number {
  return Math.round(number(text, lower, upper, fallback));
}
