// The state of the family page: everything that the user has chosen. States are immutable, so that changes can be undone.
import type { FamilyDefinition, IsohedralType } from "../contract/types";
import { areaOf, drawnFamily, meanSide, tilingAt } from "./tiling";

export interface FamilyState {
  readonly definition: FamilyDefinition;
  /** Parameters of the tiling that is drawn, within their bounds. */
  readonly shown: readonly number[];
  /** What a training may cost, in hours of one core. */
  readonly coreHours: number;
  /** Mean error of the stress at which a training may end earlier, as a fraction; 0 for none. */
  readonly error: number;
}

/** How far the bounds of a new family's parameters are from their defaults, unless tiles would nearly vanish there. */
const REACH = 0.1;
/** Area of a tile over that of the default one below which it nearly vanishes, or is turned inside out. */
const MIN_AREA = 0.1;
/** Width of a new family's beams over the mean side of its tile. */
const RELATIVE_WIDTH = 0.1;
export const MAX_PARAMETERS = 8;
export const MAX_ID_LENGTH = 32;
export const MAX_WORDS_LENGTH = 500;
/** Limits of the hours of one core that a training may take. */
export const CORE_HOURS: readonly [number, number] = [0.25, 100];
export const ERRORS: readonly number[] = [0, 0.05, 0.02, 0.01];

/** The type with which the page opens without a link. */
export const FIRST_TYPE = 21;

export const DEFAULT_TRAINING = { coreHours: 4, error: 0 } as const;

/** Something to hold before the table of types has arrived. It is never drawn. */
export const EMPTY_STATE: FamilyState = {
  definition: { id: "family", description: "", parameters: [], beam_width: 0.1 },
  shown: [],
  ...DEFAULT_TRAINING,
};

/** The name of a type in the published table. */
export function typeName(number: number): string {
  return `IH${String(number).padStart(2, "0")}`;
}

/** A type in a list, with the number of its parameters. */
export function typeWords({ number, defaults }: Pick<IsohedralType, "number" | "defaults">): string {
  const count = defaults.length;
  return `${typeName(number)}, ${count === 0 ? "no parameters" : count === 1 ? "1 parameter" : `${count} parameters`}`;
}

export function defaultsOf({ parameters }: FamilyDefinition): number[] {
  return parameters.map((parameter) => parameter.default);
}

/** A family of all tilings of a type with straight edges whose parameters are near their defaults. */
export function familyOfType(type: IsohedralType): FamilyDefinition {
  const name = typeName(type.number);
  const within = (reach: number, beamWidth: number): FamilyDefinition => ({
    id: `my-${name.toLowerCase()}`,
    description: `Tilings of the isohedral type ${name}`,
    parameters: type.defaults.map((preset, k) => ({
      description: `Vertex parameter ${k + 1} of the type`,
      lower: rounded(preset - reach),
      upper: rounded(preset + reach),
      default: preset,
    })),
    beam_width: beamWidth,
    isohedral_type: type.number,
    shapes: type.classes.map((kind) => ({ class: kind })),
  });
  const drawn = drawnFamily(within(REACH, 1), [type]);
  if (!drawn) return within(REACH, 1);
  const area = (parameters: readonly number[]) => areaOf(tilingAt(drawn, parameters).outline);
  let reach = REACH;
  while (reach > REACH / 16 && cornersOf(type.defaults, reach).some((corner) => area(corner) < MIN_AREA * area(type.defaults))) reach /= 2;
  return within(reach, rounded(RELATIVE_WIDTH * meanSide(tilingAt(drawn, type.defaults))));
}

/** The corners of a box about a point. */
function cornersOf(middle: readonly number[], reach: number): number[][] {
  return middle.reduce<number[][]>((corners, value) => corners.flatMap((corner) => [[...corner, value - reach], [...corner, value + reach]]), [[]]);
}

/** Four significant digits, for numbers that the page chooses. */
export function rounded(value: number): number {
  return Number(value.toPrecision(4));
}

/** A state that begins with a definition, drawn at its defaults. */
export function stateOf(definition: FamilyDefinition, before: Pick<FamilyState, "coreHours" | "error"> = DEFAULT_TRAINING): FamilyState {
  return { definition, shown: defaultsOf(definition), coreHours: before.coreHours, error: before.error };
}

/** The parameters moved into the bounds, and as many as there are. */
export function withinBounds({ parameters }: FamilyDefinition, shown: readonly number[]): number[] {
  return parameters.map(({ lower, upper, default: preset }, k) => Math.max(lower, Math.min(upper, shown[k] ?? preset)));
}
