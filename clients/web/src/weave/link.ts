// The state as the text of a link: readable, and checked when it is read, since links come from anywhere.
import { type AccuracyChoice, readChoice, writeChoice } from "../base/accuracy_choice";
import { plain } from "../base/format";
import { choiceOf, type Fields, type Marks, numberOf, readFields, readValues, wholeOf, writeFields, writeValues } from "../base/link_fields";
import type { CrossingOverride } from "../contract/types";
import { LayoutTextError, readLayoutText } from "./layout_text";
import { type LengthName, lengthLimits, type Lengths, PATTERN_IDS, PATTERNS } from "./patterns";
import { DEFAULT_STATE, type FreeLayout, type LoadKind, MAX_AMOUNT, MAX_CELLS, MAX_SEGMENTS, type SheetState, usableStrain, type WeaveState } from "./state";

/** Limit of the length of a link; some programs truncate longer ones. */
const MAX_LINK_LENGTH = 30_000;
const MAX_OVERRIDES = 5000;
const LOADS: readonly LoadKind[] = ["stretch_x", "stretch_y", "shear", "push"];
const SHEET_VALUES = ["columns", "rows", "load", "amount"];
const LIMITS = ["backward", "forward"];
const LIMIT_MARKS: Marks = ["~", "="];

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
  if (state.space !== "automatic") fields.push(["space", state.space]);
  fields.push(...writeChoice(state.accuracy, usualLevel(state.segments)));
  fields.push(["segments", String(state.segments)], ["sheet", writeValues({ columns, rows, load, amount })]);
  if (state.overrides.length > 0) fields.push(["crossings", state.overrides.map(overrideText).join(";")]);
  if (state.pattern === "layout") fields.push(["layout", encodeURIComponent(JSON.stringify(state.layout))]);
  return writeFields(fields);
}

/** The state of a link; null if the text is no valid link. */
export function readLink(text: string): WeaveState | null {
  const fields = readFields(text);
  const pattern = PATTERN_IDS.find((id) => id === fields.get("pattern"));
  if (!pattern) return null;
  const layout = pattern === "layout" ? readLayout(fields.get("layout") ?? "") : DEFAULT_STATE.layout;
  const overrides = readOverrides(fields.get("crossings") ?? "");
  if (!layout || !overrides) return null;
  const types = Math.max(1, PATTERNS[pattern].types.length);
  const segments = wholeOf(fields.get("segments"), 1, MAX_SEGMENTS, DEFAULT_STATE.segments);
  return {
    pattern,
    type: wholeOf(fields.get("type"), 1, types, 1),
    lengths: readLengths(fields),
    youngsModulus: numberOf(fields.get("modulus"), 1e-6, 1e7, DEFAULT_STATE.youngsModulus),
    layout,
    overrides,
    strain: usableStrain(numberOf(fields.get("strain"), -0.5, 2, DEFAULT_STATE.strain)),
    shear: fields.get("shear") === "suppressed" ? "suppressed" : "free",
    space: choiceOf(fields.get("space"), ["on", "off"] as const, "automatic"),
    accuracy: readChoice(fields, usualLevel(segments)),
    segments,
    sheet: readSheet(fields.get("sheet") ?? ""),
  };
}

/** The level of a link that names none, as those of earlier versions: a number of segments of one's own counts. */
function usualLevel(segments: number): AccuracyChoice["level"] {
  return segments === DEFAULT_STATE.segments ? "normal" : "own";
}

/** An override as text: "3:0,1" for crossing 3 whose members 0 and 1 slide, followed by "~backward=0.5~forward=none" if limits are given. */
function overrideText({ crossing, slides, backward, forward }: CrossingOverride): string {
  const limits = { ...(backward !== undefined && { backward: backward ?? "none" }), ...(forward !== undefined && { forward: forward ?? "none" }) };
  return [`${crossing}:${slides.join(",")}`, ...(Object.keys(limits).length > 0 ? [writeValues(limits, LIMIT_MARKS)] : [])].join("~");
}

function readOverrides(text: string): CrossingOverride[] | null {
  if (text === "") return [];
  const entries = text.split(";");
  if (entries.length > MAX_OVERRIDES) return null;
  const overrides = entries.map(readOverride);
  return overrides.every((override): override is CrossingOverride => override !== null) ? overrides : null;
}

function readOverride(text: string): CrossingOverride | null {
  const match = /^(\d{1,9}):((?:\d{1,4})(?:,\d{1,4})*|)(?:~(.*))?$/.exec(text);
  if (!match) return null;
  const [, crossing, slides, limits = ""] = match;
  const values = readValues(limits, LIMITS, LIMIT_MARKS);
  if (![...values].every(([name, value]) => limits === "" || (LIMITS.includes(name) && /^(none|[\d.e-]*)$/.test(value)))) return null;
  const limit = (name: "backward" | "forward") => {
    const value = values.get(name);
    return value ? { [name]: value === "none" ? null : Number(value) } : {};
  };
  return { crossing: Number(crossing), slides: slides === "" ? [] : slides.split(",").map(Number), ...limit("backward"), ...limit("forward") };
}

function readLayout(text: string): FreeLayout | null {
  try {
    return readLayoutText(text).layout;
  } catch (error) {
    if (error instanceof LayoutTextError) return null;
    throw error;
  }
}

function readLengths(fields: Fields): Lengths {
  let lengths = DEFAULT_STATE.lengths;
  // The order matters, because the limits of a length depend on the lengths before it.
  for (const name of ["pitch", "side", "overlap", "circle_radius", "distance", "radius"] as const satisfies LengthName[]) {
    const [lower, upper] = lengthLimits(name, lengths);
    const fallback = Math.max(lower, Math.min(upper, lengths[name]));
    lengths = { ...lengths, [name]: numberOf(fields.get(name), lower, upper, fallback) };
  }
  return lengths;
}

function readSheet(text: string): SheetState {
  const values = readValues(text, SHEET_VALUES);
  const { sheet } = DEFAULT_STATE;
  return {
    columns: wholeOf(values.get("columns"), 1, MAX_CELLS, sheet.columns),
    rows: wholeOf(values.get("rows"), 1, MAX_CELLS, sheet.rows),
    load: choiceOf(values.get("load"), LOADS, sheet.load),
    amount: numberOf(values.get("amount"), -MAX_AMOUNT, MAX_AMOUNT, sheet.amount),
  };
}
