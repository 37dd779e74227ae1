// The specification of a structure: material, orientation, size and limits.
import type { DesignRequest } from "../contract/types";
import { digits, plain } from "../base/format";
import { decoded, type Fields, type Marks, readValues, writeValues } from "../base/link_fields";

export type Range = readonly [min: number, max: number];

export interface Material {
  readonly name: string;
  /** In MPa. The search chooses a value from a range. */
  readonly youngsModulus: number | Range;
  /** In g/cm^3. */
  readonly density: number;
}

export interface Specification {
  /** In MPa. The search chooses a value from a range. */
  readonly youngsModulus: number | Range;
  /** In g/cm^3. */
  readonly density: number;
  /** Materials from which the search chooses one. If there are any, the modulus and the density above are ignored. */
  readonly materials: readonly Material[];
  /** Counterclockwise rotation of the tiling. The search chooses a value from a range. In degrees, so that 180 is exact in a link. */
  readonly orientation: number | Range;
  readonly size: Size;
  /** Limits of the solid fraction of the plane. */
  readonly relativeDensity: Range | null;
  /** Lower limit in mm. Only for a given cell size, from which the width of the beams follows. */
  readonly leastBeamWidth: number | null;
  /** Limits of the size of the cells in mm. Only for a given beam width, from which the size follows. */
  readonly cellSizes: Range | null;
}

/** The given length in mm: a beam width, or a cell size, which is the square root of the area of a cell. */
export interface Size {
  readonly kind: "beam_width" | "cell_size";
  readonly value: number;
}

/** Values that a search has chosen besides the parameters. Values that were given are undefined. */
export interface FoundSpecification {
  /** Name of the chosen material, if there are several. */
  readonly material?: string;
  /** In MPa. */
  readonly youngsModulus?: number;
  /** In radians. */
  readonly orientation?: number;
}

export const DEFAULT_SPECIFICATION: Specification = {
  youngsModulus: 26,
  density: 1.2,
  materials: [],
  orientation: 0,
  size: { kind: "beam_width", value: 0.3 },
  relativeDensity: null,
  leastBeamWidth: null,
  cellSizes: null,
};

export const MAX_MATERIALS = 16;
export const MAX_MATERIAL_NAME_LENGTH = 40;

/** The server's limits, with the orientation in degrees. */
export const SPECIFICATION_LIMITS = {
  youngsModulus: [1e-6, 1e6],
  density: [0.001, 25],
  orientation: [-360, 360],
  beam_width: [0.01, 100],
  cell_size: [0.01, 2000],
  relativeDensity: [0, 1],
  leastBeamWidth: [0.01, 100],
  cellSizes: [0, 2000],
} as const;

export interface Preset extends Material {
  readonly youngsModulus: number;
}

/** Typical values of printed materials. A certain filament has other values, and so does a print of it. */
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

/** A modulus in MPa as text; values in the thousands are shown as integers, since printed materials have them. */
export function modulusWords(modulus: number): string {
  return modulus >= 1000 && modulus < 1e5 ? String(Math.round(modulus)) : digits(modulus);
}

/** A found value clamped to a range; it may have been found for another range. */
function clamped(value: number, [min, max]: Range): number {
  return Math.max(min, Math.min(max, value));
}

function middle([min, max]: Range): number {
  return (min + max) / 2;
}

/** The material of a design. If there are several, it is the one that was found; before a search, the first. */
export function materialOf({ youngsModulus, density, materials }: Specification, found: FoundSpecification | null): Material {
  if (materials.length === 0) return { name: "", youngsModulus, density };
  return materials.find(({ name }) => name === found?.material) ?? materials[0];
}

/** Young's modulus of a design in MPa; the middle of its range before a search. */
export function modulusOf(made: Specification, found: FoundSpecification | null): number {
  const { youngsModulus } = materialOf(made, found);
  return isRange(youngsModulus) ? clamped(found?.youngsModulus ?? middle(youngsModulus), youngsModulus) : youngsModulus;
}

/** Whether the search chooses the modulus. */
export function searchesModulus({ youngsModulus, materials }: Specification): boolean {
  return materials.length > 1 || isRange(materials[0]?.youngsModulus ?? youngsModulus);
}

/** Orientation of a design in radians; the middle of its range before a search. */
export function orientationOf({ orientation }: Specification, found: FoundSpecification | null): number {
  if (!isRange(orientation)) return radians(orientation);
  return clamped(found?.orientation ?? radians(middle(orientation)), [radians(orientation[0]), radians(orientation[1])]);
}

/** The specification of one design: ranges and lists are replaced by the found values, and limits are dropped. */
export function withFoundValues(made: Specification, found: FoundSpecification): Specification {
  const orientation = isRange(made.orientation) ? (orientationOf(made, found) * 180) / Math.PI : made.orientation;
  const { density } = materialOf(made, found);
  return { ...made, youngsModulus: modulusOf(made, found), density, materials: [], orientation, relativeDensity: null, leastBeamWidth: null, cellSizes: null };
}

/** The part of an answer that the search has chosen; values that were given are left out. */
export function foundSpecification(
  made: Specification,
  material: { readonly name?: string; readonly youngs_modulus: number } | undefined,
  orientation: number | undefined,
): FoundSpecification {
  return {
    ...(made.materials.length > 0 && material && { material: material.name ?? "" }),
    ...(searchesModulus(made) && { youngsModulus: material?.youngs_modulus }),
    ...(isRange(made.orientation) && { orientation }),
  };
}

type SpecificationFields = Pick<DesignRequest, "material" | "orientation" | "beam_width" | "cell_size" | "limits">;

/** The fields of a request whose values differ from the server's defaults. */
export function specificationFields({ youngsModulus, density, materials, orientation, size, relativeDensity, leastBeamWidth, cellSizes }: Specification): SpecificationFields {
  const copy = (range: Range): [number, number] => [range[0], range[1]];
  const number = (value: number | Range): number | [number, number] => (isRange(value) ? copy(value) : value);
  const material = {
    ...(youngsModulus !== DEFAULT_SPECIFICATION.youngsModulus && { youngs_modulus: number(youngsModulus) }),
    ...(density !== DEFAULT_SPECIFICATION.density && { density }),
  };
  const limits = {
    ...(relativeDensity && { relative_density: copy(relativeDensity) }),
    ...(leastBeamWidth !== null && size.kind === "cell_size" && { beam_width: copy([leastBeamWidth, SPECIFICATION_LIMITS.leastBeamWidth[1]]) }),
    ...(cellSizes && size.kind === "beam_width" && { cell_size: copy(cellSizes) }),
  };
  return {
    ...(materials.length > 0
      ? { material: materials.map((one) => ({ name: one.name, youngs_modulus: number(one.youngsModulus), density: one.density })) }
      : Object.keys(material).length > 0 && { material }),
    ...(orientation !== 0 && { orientation: isRange(orientation) ? [radians(orientation[0]), radians(orientation[1])] : radians(orientation) }),
    ...((size.kind === "cell_size" || size.value !== DEFAULT_SPECIFICATION.size.value) && { [size.kind]: size.value }),
    ...(Object.keys(limits).length > 0 && { limits }),
  };
}

const MATERIAL_VALUES = ["name", "modulus", "density"];
const MATERIAL_MARKS: Marks = [":", "="];

/** The fields of a link whose values differ from the defaults. */
export function writeSpecification({ youngsModulus, density, materials, orientation, size, relativeDensity, leastBeamWidth, cellSizes }: Specification): [string, string][] {
  const text = (value: number | Range) => (isRange(value) ? value.map(plain).join(",") : plain(value));
  const fields: [string, string][] = [];
  if (youngsModulus !== DEFAULT_SPECIFICATION.youngsModulus) fields.push(["modulus", text(youngsModulus)]);
  if (density !== DEFAULT_SPECIFICATION.density) fields.push(["density", text(density)]);
  const entry = (one: Material) => writeValues({ name: encodeURIComponent(one.name), modulus: text(one.youngsModulus), density: text(one.density) }, MATERIAL_MARKS);
  if (materials.length > 0) fields.push(["materials", encodeURIComponent(materials.map(entry).join(";"))]);
  if (orientation !== 0) fields.push(["orientation", text(orientation)]);
  if (size.kind === "cell_size") fields.push(["cell-size", text(size.value)]);
  else if (size.value !== DEFAULT_SPECIFICATION.size.value) fields.push(["beam-width", text(size.value)]);
  if (relativeDensity) fields.push(["relative-density", text(relativeDensity)]);
  if (leastBeamWidth !== null) fields.push(["least-beam-width", text(leastBeamWidth)]);
  if (cellSizes) fields.push(["cell-sizes", text(cellSizes)]);
  return fields;
}

/** The specification from the fields of a link; the default one if a value is outside its limits. */
export function readSpecification(fields: Fields): Specification {
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
  const made: Specification = {
    youngsModulus: read("modulus") ?? DEFAULT_SPECIFICATION.youngsModulus,
    density: single("density") ?? DEFAULT_SPECIFICATION.density,
    materials: readMaterials(fields.get("materials") ?? ""),
    orientation: read("orientation") ?? DEFAULT_SPECIFICATION.orientation,
    size: cellSize === undefined ? { kind: "beam_width", value: single("beam-width") ?? DEFAULT_SPECIFICATION.size.value } : { kind: "cell_size", value: cellSize },
    relativeDensity: range("relative-density"),
    leastBeamWidth: single("least-beam-width") ?? null,
    cellSizes: range("cell-sizes"),
  };
  return faultOf(made) ? DEFAULT_SPECIFICATION : made;
}

function readValue(text: string): number | Range {
  const [first, second] = text.split(",").map((part) => (part === "" ? NaN : Number(part)));
  return second === undefined ? first : [first, second];
}

function readMaterials(text: string): Material[] {
  return text === "" ? [] : text.split(";").map((entry) => {
    const values = readValues(entry, MATERIAL_VALUES, MATERIAL_MARKS);
    const density = readValue(values.get("density") ?? "");
    // A name that cannot be decoded is empty, which is reported as a fault.
    return { name: decoded(values.get("name") ?? ""), youngsModulus: readValue(values.get("modulus") ?? ""), density: isRange(density) ? NaN : density };
  });
}

export function sameSpecification(a: Specification, b: Specification): boolean {
  return a === b || String(writeSpecification(a)) === String(writeSpecification(b));
}

export type SpecificationField = keyof Specification;

export interface Fault {
  readonly field: SpecificationField;
  readonly sentence: string;
  /** Index of the material at fault, if it is in the list of materials. */
  readonly at?: number;
  /** Its field at fault. */
  readonly part?: keyof Material;
}

/** The first value that the server would refuse, with its limits; null if all are valid. */
export function faultOf(made: Specification): Fault | null {
  const { size, relativeDensity, leastBeamWidth, cellSizes } = made;
  return rangeFault("youngsModulus", "Young’s modulus", made.youngsModulus, SPECIFICATION_LIMITS.youngsModulus, " MPa")
    ?? rangeFault("density", "The density", made.density, SPECIFICATION_LIMITS.density, " g/cm³")
    ?? materialsFault(made.materials)
    ?? rangeFault("orientation", "The orientation", made.orientation, SPECIFICATION_LIMITS.orientation, "°")
    ?? orientationRangeFault(made.orientation)
    ?? rangeFault("size", size.kind === "cell_size" ? "The size of a cell" : "The width of the beams", size.value, SPECIFICATION_LIMITS[size.kind], " mm")
    ?? (relativeDensity && rangeFault("relativeDensity", "The relative density", [100 * relativeDensity[0], 100 * relativeDensity[1]], [0, 100], " %"))
    ?? (leastBeamWidth === null ? null : rangeFault("leastBeamWidth", "The least width of the beams", leastBeamWidth, SPECIFICATION_LIMITS.leastBeamWidth, " mm"))
    ?? (cellSizes && rangeFault("cellSizes", "The size of a cell", cellSizes, SPECIFICATION_LIMITS.cellSizes, " mm"));
}

function materialsFault(materials: readonly Material[]): Fault | null {
  if (materials.length > MAX_MATERIALS) return { field: "materials", sentence: `There are at most ${MAX_MATERIALS} materials.` };
  for (const [at, { name, youngsModulus, density }] of materials.entries()) {
    const of = (part: keyof Material, fault: Omit<Fault, "field"> | null): Fault | null => fault && { ...fault, field: "materials", at, part };
    const isNamed = name.trim() !== "" && name.length <= MAX_MATERIAL_NAME_LENGTH && materials.findIndex((other) => other.name === name) === at;
    const fault = of("name", isNamed ? null : { sentence: `Each material has a name of its own, of at most ${MAX_MATERIAL_NAME_LENGTH} characters.` })
      ?? of("youngsModulus", rangeFault("materials", `Young’s modulus of ${name}`, youngsModulus, SPECIFICATION_LIMITS.youngsModulus, " MPa"))
      ?? of("density", rangeFault("materials", `The density of ${name}`, density, SPECIFICATION_LIMITS.density, " g/cm³"));
    if (fault) return fault;
  }
  return null;
}

function rangeFault(field: SpecificationField, subject: string, value: number | Range, [min, max]: Range, unit: string): Fault | null {
  const values = isRange(value) ? value : [value];
  const words = (limit: number) => `${limit.toLocaleString("en", { maximumFractionDigits: 6 })}${unit}`;
  if (!values.every((one) => one >= min && one <= max)) return { field, sentence: `${subject} is a number from ${words(min)} to ${words(max)}.` };
  if (isRange(value) && value[0] > value[1]) return { field, sentence: `${subject}: the greatest value is at least the least one, ${words(value[0])}.` };
  return null;
}

/** A range of more than half a turn is refused, since tilings that differ by half a turn respond alike. */
function orientationRangeFault(orientation: number | Range): Fault | null {
  if (!isRange(orientation) || orientation[1] - orientation[0] <= 180) return null;
  return { field: "orientation", sentence: "The orientation: the greatest angle is at most 180° beyond the least one." };
}
