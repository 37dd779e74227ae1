// What a structure is made of, how it lies and how large it is; and what it may measure.
import type { DesignRequest } from "../contract/types";
import { digits, plain } from "../base/format";

export type Range = readonly [least: number, most: number];

export interface Material {
  readonly name: string;
  /** In MPa; a range leaves it to the search. */
  readonly youngsModulus: number | Range;
  /** In g/cm^3. */
  readonly density: number;
}

export interface Made {
  /** In MPa; a range leaves it to the search. */
  readonly youngsModulus: number | Range;
  /** In g/cm^3. */
  readonly density: number;
  /** Where there are any, the search chooses one of them, and the modulus and the density above count for nothing. */
  readonly materials: readonly Material[];
  /** Angle by which the tiling is turned counterclockwise; a range leaves it to the search. In degrees, so that half a turn stays one in a link. */
  readonly orientation: number | Range;
  readonly size: Size;
  /** Least and greatest share of the plane that is solid. */
  readonly relativeDensity: Range | null;
  /** In mm; of cells of a given size, from which the width of the beams follows. */
  readonly leastBeamWidth: number | null;
  /** Least and greatest size of the cells in mm; of beams of a given width, from which it follows. */
  readonly cellSizes: Range | null;
}

/** In mm. The size of a cell is the square root of its area. */
export interface Size {
  readonly kind: "beam_width" | "cell_size";
  readonly value: number;
}

/** What a search finds besides the parameters, where it is left to find it. */
export interface FoundMade {
  /** Name of the material, of several. */
  readonly material?: string;
  /** In MPa. */
  readonly youngsModulus?: number;
  /** In radians. */
  readonly orientation?: number;
}

export const DEFAULT_MADE: Made = {
  youngsModulus: 26, density: 1.2, materials: [], orientation: 0, size: { kind: "beam_width", value: 0.3 }, relativeDensity: null, leastBeamWidth: null, cellSizes: null,
};

export const MOST_MATERIALS = 16;
export const MOST_MATERIAL_NAME = 40;

/** As the server takes them; the orientation in degrees. */
export const MADE_LIMITS = {
  youngsModulus: [1e-6, 1e6], density: [0.001, 25], orientation: [-360, 360], beam_width: [0.01, 100], cell_size: [0.01, 2000], relativeDensity: [0, 1], leastBeamWidth: [0.01, 100], cellSizes: [0, 2000],
} as const;

export interface Preset extends Material {
  readonly youngsModulus: number;
}

/** Typical values of what is printed; those of a spool and of a print differ. */
export const PRESETS: readonly Preset[] = [
  { name: "TPU", youngsModulus: 26, density: 1.21 },
  { name: "PLA", youngsModulus: 2500, density: 1.24 },
  { name: "PETG", youngsModulus: 2000, density: 1.27 },
  { name: "ABS", youngsModulus: 2100, density: 1.05 },
  { name: "PA12", youngsModulus: 1600, density: 1.01 },
];

export function isRange(value: number | Range): value is Range {
  return typeof value !== "number";
}

export function radians(angle: number): number {
  return (angle * Math.PI) / 180;
}

/** Of a modulus in MPa: materials that are printed have thousands of them. */
export function modulusWords(modulus: number): string {
  return modulus >= 1000 && modulus < 1e5 ? String(Math.round(modulus)) : digits(modulus);
}

/** What was found may be of another range. */
function within(value: number, [least, most]: Range): number {
  return Math.max(least, Math.min(most, value));
}

function middle([least, most]: Range): number {
  return (least + most) / 2;
}

/** The material of a design: of several the one that was found, before that the first. */
export function materialOf({ youngsModulus, density, materials }: Made, found: FoundMade | null): Material {
  if (materials.length === 0) return { name: "", youngsModulus, density };
  return materials.find(({ name }) => name === found?.material) ?? materials[0];
}

/** Young's modulus of a design in MPa; before any was found the middle of its range. */
export function modulusOf(made: Made, found: FoundMade | null): number {
  const { youngsModulus } = materialOf(made, found);
  return isRange(youngsModulus) ? within(found?.youngsModulus ?? middle(youngsModulus), youngsModulus) : youngsModulus;
}

/** Whether the search chooses the modulus. */
export function leavesModulus({ youngsModulus, materials }: Made): boolean {
  return materials.length > 1 || isRange(materials[0]?.youngsModulus ?? youngsModulus);
}

/** Orientation of a design in radians; before any was found the middle of its range. */
export function orientationOf({ orientation }: Made, found: FoundMade | null): number {
  if (!isRange(orientation)) return radians(orientation);
  return within(found?.orientation ?? radians(middle(orientation)), [radians(orientation[0]), radians(orientation[1])]);
}

/** The same of one design as it is: what was found is given, and whether it keeps within limits is not asked. */
export function settled(made: Made, found: FoundMade): Made {
  const orientation = isRange(made.orientation) ? (orientationOf(made, found) * 180) / Math.PI : made.orientation;
  const { density } = materialOf(made, found);
  return { ...made, youngsModulus: modulusOf(made, found), density, materials: [], orientation, relativeDensity: null, leastBeamWidth: null, cellSizes: null };
}

/** Of what was found, that which had been left to the search. */
export function foundMade(made: Made, material: { readonly name?: string; readonly youngs_modulus: number } | undefined, orientation: number | undefined): FoundMade {
  return {
    ...(made.materials.length > 0 && material && { material: material.name ?? "" }),
    ...(leavesModulus(made) && { youngsModulus: material?.youngs_modulus }),
    ...(isRange(made.orientation) && { orientation }),
  };
}

type MadeRequest = Pick<DesignRequest, "material" | "orientation" | "beam_width" | "cell_size" | "limits">;

/** The fields of a request, where they differ from what the server takes without them. */
export function madeRequest({ youngsModulus, density, materials, orientation, size, relativeDensity, leastBeamWidth, cellSizes }: Made): MadeRequest {
  const copy = (range: Range): [number, number] => [range[0], range[1]];
  const number = (value: number | Range): number | [number, number] => (isRange(value) ? copy(value) : value);
  const material = {
    ...(youngsModulus !== DEFAULT_MADE.youngsModulus && { youngs_modulus: number(youngsModulus) }),
    ...(density !== DEFAULT_MADE.density && { density }),
  };
  const limits = {
    ...(relativeDensity && { relative_density: copy(relativeDensity) }),
    ...(leastBeamWidth !== null && size.kind === "cell_size" && { beam_width: copy([leastBeamWidth, MADE_LIMITS.leastBeamWidth[1]]) }),
    ...(cellSizes && size.kind === "beam_width" && { cell_size: copy(cellSizes) }),
  };
  return {
    ...(materials.length > 0
      ? { material: materials.map((one) => ({ name: one.name, youngs_modulus: number(one.youngsModulus), density: one.density })) }
      : Object.keys(material).length > 0 && { material }),
    ...(orientation !== 0 && { orientation: isRange(orientation) ? [radians(orientation[0]), radians(orientation[1])] : radians(orientation) }),
    ...((size.kind === "cell_size" || size.value !== DEFAULT_MADE.size.value) && { [size.kind]: size.value }),
    ...(Object.keys(limits).length > 0 && { limits }),
  };
}

/** The fields of a link, where they differ from what a link without them means. */
export function madeLink({ youngsModulus, density, materials, orientation, size, relativeDensity, leastBeamWidth, cellSizes }: Made): [string, string][] {
  const text = (value: number | Range) => (isRange(value) ? value.map(plain).join(",") : plain(value));
  const fields: [string, string][] = [];
  if (youngsModulus !== DEFAULT_MADE.youngsModulus) fields.push(["modulus", text(youngsModulus)]);
  if (density !== DEFAULT_MADE.density) fields.push(["density", text(density)]);
  if (materials.length > 0) fields.push(["materials", encodeURIComponent(materials.map((one) => [encodeURIComponent(one.name), text(one.youngsModulus), text(one.density)].join(":")).join(";"))]);
  if (orientation !== 0) fields.push(["orientation", text(orientation)]);
  if (size.kind === "cell_size") fields.push(["cell-size", text(size.value)]);
  else if (size.value !== DEFAULT_MADE.size.value) fields.push(["beam-width", text(size.value)]);
  if (relativeDensity) fields.push(["relative-density", text(relativeDensity)]);
  if (leastBeamWidth !== null) fields.push(["least-beam-width", text(leastBeamWidth)]);
  if (cellSizes) fields.push(["cell-sizes", text(cellSizes)]);
  return fields;
}

/** Of the fields of a link; what is out of its limits is as in a link without any of them. */
export function readMade(fields: ReadonlyMap<string, string>): Made {
  const read = (name: string): number | Range | undefined => {
    const text = fields.get(name);
    return text === undefined ? undefined : readValue(text);
  };
  const range = (name: string): Range | null => {
    const value = read(name);
    return value === undefined ? null : isRange(value) ? value : [NaN, NaN];
  };
  const single = (name: string): number | undefined => {
    const value = read(name);
    return value === undefined || !isRange(value) ? value : NaN;
  };
  const cellSize = single("cell-size");
  const made: Made = {
    youngsModulus: read("modulus") ?? DEFAULT_MADE.youngsModulus,
    density: single("density") ?? DEFAULT_MADE.density,
    materials: readMaterials(fields.get("materials") ?? ""),
    orientation: read("orientation") ?? DEFAULT_MADE.orientation,
    size: cellSize === undefined ? { kind: "beam_width", value: single("beam-width") ?? DEFAULT_MADE.size.value } : { kind: "cell_size", value: cellSize },
    relativeDensity: range("relative-density"),
    leastBeamWidth: single("least-beam-width") ?? null,
    cellSizes: range("cell-sizes"),
  };
  return faultOf(made) ? DEFAULT_MADE : made;
}

function readValue(text: string): number | Range {
  const [first, second] = text.split(",").map((part) => (part === "" ? NaN : Number(part)));
  return second === undefined ? first : [first, second];
}

function readMaterials(text: string): Material[] {
  return text === "" ? [] : text.split(";").map((entry) => {
    const [name, modulus = "", density = ""] = entry.split(":");
    const value = readValue(density);
    return { name: decoded(name), youngsModulus: readValue(modulus), density: isRange(value) ? NaN : value };
  });
}

function decoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return ""; // no name, which is a fault
  }
}

export function sameMade(a: Made, b: Made): boolean {
  return a === b || String(madeLink(a)) === String(madeLink(b));
}

export type MadeField = keyof Made;

export interface Fault {
  readonly field: MadeField;
  readonly sentence: string;
  /** Of which of several materials, from 0, and where in its row. */
  readonly at?: number;
  readonly part?: keyof Material;
}

/** What the server would refuse, and its limit; null where there is nothing. */
export function faultOf(made: Made): Fault | null {
  const { size, relativeDensity, leastBeamWidth, cellSizes } = made;
  return rangeFault("youngsModulus", "Young’s modulus", made.youngsModulus, MADE_LIMITS.youngsModulus, " MPa")
    ?? rangeFault("density", "The density", made.density, MADE_LIMITS.density, " g/cm³")
    ?? materialsFault(made.materials)
    ?? rangeFault("orientation", "The orientation", made.orientation, MADE_LIMITS.orientation, "°")
    ?? widthFault(made.orientation)
    ?? rangeFault("size", size.kind === "cell_size" ? "The size of a cell" : "The width of the beams", size.value, MADE_LIMITS[size.kind], " mm")
    ?? (relativeDensity && rangeFault("relativeDensity", "The relative density", [100 * relativeDensity[0], 100 * relativeDensity[1]], [0, 100], " %"))
    ?? (leastBeamWidth === null ? null : rangeFault("leastBeamWidth", "The least width of the beams", leastBeamWidth, MADE_LIMITS.leastBeamWidth, " mm"))
    ?? (cellSizes && rangeFault("cellSizes", "The size of a cell", cellSizes, MADE_LIMITS.cellSizes, " mm"));
}

function materialsFault(materials: readonly Material[]): Fault | null {
  if (materials.length > MOST_MATERIALS) return { field: "materials", sentence: `There are at most ${MOST_MATERIALS} materials.` };
  for (const [at, { name, youngsModulus, density }] of materials.entries()) {
    const of = (part: keyof Material, fault: Omit<Fault, "field"> | null): Fault | null => fault && { ...fault, field: "materials", at, part };
    const isNamed = name.trim() !== "" && name.length <= MOST_MATERIAL_NAME && materials.findIndex((other) => other.name === name) === at;
    const fault = of("name", isNamed ? null : { sentence: `Each material has a name of its own, of at most ${MOST_MATERIAL_NAME} characters.` })
      ?? of("youngsModulus", rangeFault("materials", `Young’s modulus of ${name}`, youngsModulus, MADE_LIMITS.youngsModulus, " MPa"))
      ?? of("density", rangeFault("materials", `The density of ${name}`, density, MADE_LIMITS.density, " g/cm³"));
    if (fault) return fault;
  }
  return null;
}

function rangeFault(field: MadeField, subject: string, value: number | Range, [least, most]: Range, unit: string): Fault | null {
  const values = isRange(value) ? value : [value];
  const words = (limit: number) => `${limit.toLocaleString("en", { maximumFractionDigits: 6 })}${unit}`;
  if (!values.every((one) => one >= least && one <= most)) return { field, sentence: `${subject} is a number from ${words(least)} to ${words(most)}.` };
  if (isRange(value) && value[0] > value[1]) return { field, sentence: `${subject}: the greatest value is at least the least one, ${words(value[0])}.` };
  return null;
}

/** A tiling that was turned by half a turn responds as before. */
function widthFault(orientation: number | Range): Fault | null {
  if (!isRange(orientation) || orientation[1] - orientation[0] <= 180) return null;
  return { field: "orientation", sentence: "The orientation: the greatest angle is at most 180° beyond the least one." };
}
