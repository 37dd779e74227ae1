// The settings of a print: the printer profile, and the position of the sheet on the bed. Each setting is identified by the JSON pointer
// of its field in the request, so that a fault that the server reports is shown at its field.
import { placeWords } from "../contract/places";
import type { Weave, WeaveToolpathRequest } from "../contract/types";

export type Value = number | string | boolean | null;
/** Values by JSON pointer; null for the server's default. */
export type PrintSettings = Readonly<Record<string, Value>>;

export interface Field {
  readonly pointer: string;
  readonly words: string;
  readonly unit?: string;
  readonly initial: Value;
  readonly kind: "number" | "text" | "lines" | "switch" | "choice";
  readonly choices?: readonly (readonly [value: string, words: string])[];
}

export interface FieldGroup {
  readonly title: string;
  readonly fields: readonly Field[];
  /** Whether the group is folded up, because its settings are seldom changed. */
  readonly isAdvanced: boolean;
}

const number = (pointer: string, words: string, initial: number | null, unit?: string): Field => ({ pointer, words, initial, unit, kind: "number" });

export const PRINT_FIELDS: readonly FieldGroup[] = [
  {
    title: "Printer",
    isAdvanced: false,
    fields: [
      { pointer: "/printer/name", words: "Name of the profile", initial: "Prusa i3 MK3S, PLA", kind: "text" },
      number("/printer/bed/0", "Bed along x", 250, "mm"),
      number("/printer/bed/1", "Bed along y", 210, "mm"),
      number("/printer/bed/2", "Height", 210, "mm"),
      number("/printer/nozzle_diameter", "Nozzle", 0.4, "mm"),
      number("/printer/filament_diameter", "Filament", 1.75, "mm"),
    ],
  },
  {
    title: "Temperatures",
    isAdvanced: false,
    fields: [number("/printer/nozzle_temperature", "Nozzle", 180, "°C"), number("/printer/bed_temperature", "Bed", 60, "°C")],
  },
  {
    title: "Sheet on the bed",
    isAdvanced: false,
    fields: [
      number("/overrun/start", "Overrun at starts", 0, "mm"),
      number("/overrun/end", "Overrun at ends", 0, "mm"),
      number("/loop_overlap", "Overlap of loops", 0, "mm"),
      { pointer: "/frame", words: "Frame around the sheet", initial: false, kind: "switch" },
      number("/frame/margin", "Distance of the frame", 0, "mm"),
      number("/frame/lead_in", "Lead-in of the frame", 0, "mm"),
    ],
  },
  {
    title: "Speeds",
    isAdvanced: true,
    fields: [
      number("/printer/strand_speed", "On the bed", 600, "mm/min"),
      number("/printer/lifted_speed", "Lifted parts", 600, "mm/min"),
      number("/printer/channel_speed", "Channels", 300, "mm/min"),
      number("/printer/travel_speed", "Travels", 3000, "mm/min"),
      number("/printer/retraction_speed", "Retraction", 2100, "mm/min"),
      number("/printer/retraction", "Retracted by", 0.4, "mm"),
    ],
  },
  {
    title: "Beads and heights",
    isAdvanced: true,
    fields: [
      number("/printer/strand_height", "Nozzle over the bed", 0.5, "mm"),
      number("/printer/travel_clearance", "Travels over the print", 1, "mm"),
      number("/printer/strand_width", "Width of a frame", 0.5, "mm"),
      number("/printer/bead_area", "Area of a bead", null, "mm²"),
      number("/printer/lifted_flow", "Flow of lifted parts", 1),
      number("/printer/channel_flow", "Flow of channels", 0.5),
    ],
  },
  {
    title: "Lifts over strands",
    isAdvanced: true,
    fields: [
      number("/printer/lift/height", "Height over a strand", 1, "mm"),
      number("/printer/lift/top", "Fully up within", 0.75, "mm"),
      number("/printer/lift/run", "Begins to rise at", 2, "mm"),
      number("/printer/lift/bridge", "Stays up for less than", 2.5, "mm"),
    ],
  },
  {
    title: "Channels",
    isAdvanced: true,
    fields: [
      { pointer: "/printer/channel/shape", words: "Shape", initial: "triangle", kind: "choice", choices: [["triangle", "Triangle"], ["arc", "Arc"]] },
      number("/printer/channel/half_width", "First foot to crossing", 1.2, "mm"),
      number("/printer/channel/longer", "Second half longer by", 0.2),
      number("/printer/channel/apex", "Apex over the feet", 2, "mm"),
    ],
  },
  {
    title: "Start and end",
    isAdvanced: true,
    fields: [
      number("/printer/priming_length", "Line that fills the nozzle", 60, "mm"),
      { pointer: "/printer/park", words: "Park the nozzle at the end", initial: true, kind: "switch" },
      { pointer: "/printer/startup_gcode", words: "After heating and homing", initial: "", kind: "lines" },
      { pointer: "/printer/footer_gcode", words: "Before the heaters are switched off", initial: "", kind: "lines" },
    ],
  },
];

/** A printer by name: its build volume in mm, and what its maker delivers it with. Both nozzle and filament can be others. */
export interface KnownPrinter {
  readonly name: string;
  readonly bed: readonly [x: number, y: number, z: number];
  /** Diameters in mm. */
  readonly nozzle: number;
  readonly filament: number;
}

/** Printers of several makers, by their makers' specifications; docs/notes/weaves.md says what they were compared with. Temperatures, speeds and lifts are not theirs: they stay as they are set. */
export const KNOWN_PRINTERS: readonly KnownPrinter[] = [
  { name: "Prusa i3 MK3S", bed: [250, 210, 210], nozzle: 0.4, filament: 1.75 },
  { name: "Prusa MK4", bed: [250, 210, 220], nozzle: 0.4, filament: 1.75 },
  { name: "Prusa MINI+", bed: [180, 180, 180], nozzle: 0.4, filament: 1.75 },
  { name: "Prusa XL", bed: [360, 360, 360], nozzle: 0.4, filament: 1.75 },
  { name: "Bambu Lab A1", bed: [256, 256, 256], nozzle: 0.4, filament: 1.75 },
  { name: "Bambu Lab A1 mini", bed: [180, 180, 180], nozzle: 0.4, filament: 1.75 },
  { name: "Bambu Lab X1 Carbon", bed: [256, 256, 256], nozzle: 0.4, filament: 1.75 },
  { name: "Creality Ender-3", bed: [220, 220, 250], nozzle: 0.4, filament: 1.75 },
  { name: "Ultimaker S3", bed: [230, 190, 200], nozzle: 0.4, filament: 2.85 },
  { name: "Ultimaker S5", bed: [330, 240, 300], nozzle: 0.4, filament: 2.85 },
];

/** What is assumed of every printer, because it depends on the material and not on the printer. */
export const ASSUMED_WORDS = "Build volume, nozzle and filament are the maker’s. Temperatures, speeds and lifts stay as they are set: they depend on the material.";

/** The settings for a printer. */
export function withPrinter(settings: PrintSettings, { name, bed, nozzle, filament }: KnownPrinter): PrintSettings {
  return {
    ...settings,
    "/printer/name": name,
    "/printer/bed/0": bed[0],
    "/printer/bed/1": bed[1],
    "/printer/bed/2": bed[2],
    "/printer/nozzle_diameter": nozzle,
    "/printer/filament_diameter": filament,
  };
}

/** The printer whose values the settings have; undefined if they are of another one. */
export function printerOf(settings: PrintSettings): KnownPrinter | undefined {
  return KNOWN_PRINTERS.find((printer) =>
    Object.entries(withPrinter(settings, printer)).every(([pointer, value]) => pointer === "/printer/name" || settings[pointer] === value)
    && String(settings["/printer/name"]).startsWith(printer.name)
  );
}

const ALL_FIELDS = PRINT_FIELDS.flatMap((group) => group.fields);
export const DEFAULT_SETTINGS: PrintSettings = Object.fromEntries(ALL_FIELDS.map(({ pointer, initial }) => [pointer, initial]));

type Document = { [name: string]: unknown };

/** The request for a toolpath. It contains all settings, so that equal requests have equal answers even if the server's defaults change. */
export function toolpathRequest(weave: Weave, settings: PrintSettings, include: WeaveToolpathRequest["include"]): WeaveToolpathRequest {
  const request: Document = { weave };
  for (const { pointer } of ALL_FIELDS) {
    const value = settings[pointer];
    // "/frame" is a switch of the page, not a field of the request.
    if (value === null || pointer === "/frame" || (pointer.startsWith("/frame/") && settings["/frame"] !== true)) continue;
    setAtPointer(request, pointer, value);
  }
  return { ...request, include } as unknown as WeaveToolpathRequest;
}

function setAtPointer(document: Document, pointer: string, value: Value): void {
  const names = pointer.slice(1).split("/");
  let place = document;
  names.slice(0, -1).forEach((name, k) => {
    place[name] ??= /^\d+$/.test(names[k + 1]) ? [] : {};
    place = place[name] as Document;
  });
  place[names[names.length - 1]] = value;
}

/** The printer profile as JSON, for a file that `supple weave print --profile` reads. */
export function profileText(settings: PrintSettings): string {
  const { printer } = toolpathRequest({} as Weave, settings, []);
  return `${JSON.stringify(printer, null, 2)}\n`;
}

/** Settings with the printer profile of a file; missing values are the default ones. Throws an Error with a sentence if the text is no profile. */
export function withProfile(settings: PrintSettings, text: string): PrintSettings {
  let printer: unknown;
  try {
    printer = JSON.parse(text);
  } catch {
    throw new Error("The file is no JSON.");
  }
  if (!isDocument(printer)) throw new Error('The file is no printer: an object such as {"nozzle_temperature": 200} is.');
  const others = Object.entries(settings).filter(([pointer]) => !pointer.startsWith("/printer/"));
  const found = { ...DEFAULT_SETTINGS, ...Object.fromEntries(others) };
  readDocument(printer, "/printer", found);
  return found;
}

function readDocument(document: Document, pointer: string, into: Record<string, Value>): void {
  for (const [name, value] of Object.entries(document)) {
    const place = `${pointer}/${name}`;
    const field = ALL_FIELDS.find((one) => one.pointer === place);
    if (field && isValueOf(field, value)) into[place] = value;
    else if (!field && typeof value === "object" && value !== null && ALL_FIELDS.some((one) => one.pointer.startsWith(`${place}/`))) readDocument(value as Document, place, into);
    else {throw new Error(
        field ? `The file has no ${field.kind === "number" ? "number" : "text"} for ${placeWords(place)}.` : `A printer does not have ${placeWords(place)}, which the file names.`,
      );}
  }
}

function isDocument(value: unknown): value is Document {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function isValueOf({ kind, choices, initial }: Field, value: unknown): value is Value {
  if (kind === "number") return (typeof value === "number" && Number.isFinite(value)) || (value === null && initial === null);
  if (kind === "switch") return typeof value === "boolean";
  return typeof value === "string" && (!choices || choices.some(([choice]) => choice === value));
}

/** Settings from the text in the browser's storage, which another version may have written: missing and invalid values are the default ones. */
export function storedSettings(text: string | null): PrintSettings {
  try {
    const stored: unknown = JSON.parse(text ?? "{}");
    const known = ALL_FIELDS.filter((field) => isDocument(stored) && isValueOf(field, stored[field.pointer]));
    return { ...DEFAULT_SETTINGS, ...Object.fromEntries(known.map(({ pointer }) => [pointer, (stored as Document)[pointer] as Value])) };
  } catch {
    return DEFAULT_SETTINGS;
  }
}

/** The fields to which a JSON pointer in a problem applies: the field itself, those below it, and those above it. */
export function fieldsAt(pointer: string): readonly Field[] {
  return ALL_FIELDS.filter((field) => field.pointer === pointer || field.pointer.startsWith(`${pointer}/`) || pointer.startsWith(`${field.pointer}/`)).filter((field) =>
    pointer.length > 1 && field.kind !== "switch"
  );
}
