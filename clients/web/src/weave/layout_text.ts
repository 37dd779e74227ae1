// Layouts as JSON text, which the user pastes or a link contains. Only the form is checked here; the server checks the rest.
import type { CrossingOverride } from "../contract/types";
import type { FreeLayout, Lattice, Point, Strand } from "./state";

const MAX_STRANDS = 2000;
const MAX_POINTS = 20_000;
const MAX_OVERRIDES = 100_000;

export class LayoutTextError extends Error {}

export interface PastedLayout {
  readonly layout: FreeLayout;
  readonly overrides: readonly CrossingOverride[];
  /** Radius of all strands in mm; null if the text has none. */
  readonly radius: number | null;
  /** In MPa; null if the text has none. */
  readonly youngsModulus: number | null;
}

type Fields = Record<string, unknown>;

/** A layout of strands from JSON: the layout itself, or a request with the layout in its field `weave`. Throws LayoutTextError. */
export function readLayoutText(text: string): PastedLayout {
  let document: unknown;
  try {
    document = JSON.parse(text);
  } catch (error) {
    throw new LayoutTextError(`This is no JSON: ${(error as Error).message}.`);
  }
  const outer = fields(document, "The text");
  const weave = "weave" in outer ? fields(outer.weave, "weave") : outer;
  if ("pattern" in weave) throw new LayoutTextError("This names a pattern; choose it in the list of patterns.");
  if (!Array.isArray(weave.strands)) throw new LayoutTextError("strands is missing: a list of strands with their points.");
  const strands = weave.strands.map(readStrand);
  const points = strands.reduce((sum, strand) => sum + strand.points.length, 0);
  if (strands.length > MAX_STRANDS || points > MAX_POINTS) {
    throw new LayoutTextError(`The page takes up to ${MAX_STRANDS} strands with ${MAX_POINTS} points, not ${strands.length} with ${points}.`);
  }
  const material = weave.material === undefined ? {} : fields(weave.material, "material");
  return {
    layout: {
      strands,
      lattice: weave.lattice === undefined || weave.lattice === null ? null : readLattice(weave.lattice),
      ...(weave.crossings !== undefined && { crossings: list(weave.crossings, "crossings") as FreeLayout["crossings"] }),
      ...(weave.sliding_share !== undefined && { sliding_share: number(weave.sliding_share, "sliding_share") }),
    },
    overrides: weave.overrides === undefined ? [] : readOverrides(weave.overrides),
    radius: weave.radius === undefined ? null : number(weave.radius, "radius"),
    youngsModulus: material.youngs_modulus === undefined ? null : number(material.youngs_modulus, "material/youngs_modulus"),
  };
}

/** A layout as JSON with one line for each strand. */
export function writeLayoutText({ strands, lattice, crossings, sliding_share }: FreeLayout): string {
  const lines = [
    ...(lattice ? [`  "lattice": ${JSON.stringify(lattice)}`] : []),
    ...(sliding_share !== undefined ? [`  "sliding_share": ${sliding_share}`] : []),
    ...(crossings ? [`  "crossings": ${JSON.stringify(crossings)}`] : []),
    `  "strands": [\n${strands.map((strand) => `    ${JSON.stringify(strand)}`).join(",\n")}\n  ]`,
  ];
  return `{\n${lines.join(",\n")}\n}`;
}

function readStrand(value: unknown, index: number): Strand {
  const name = `strands/${index}`;
  const strand = fields(value, name);
  const ends = strand.ends ?? "open";
  if (ends !== "open" && ends !== "closed" && ends !== "periodic") throw new LayoutTextError(`${name}/ends must be open, closed or periodic.`);
  return {
    points: list(strand.points, `${name}/points`).map((point, k) => [...readPoint(point, `${name}/points/${k}`)]),
    ...(ends !== "open" && { ends }),
    ...(strand.translation !== undefined && { translation: [...readPoint(strand.translation, `${name}/translation`)] }),
    ...(strand.radius !== undefined && { radius: number(strand.radius, `${name}/radius`) }),
  };
}

function readLattice(value: unknown): Lattice {
  const [a, b, ...rest] = list(value, "lattice");
  if (b === undefined || rest.length > 0) throw new LayoutTextError("lattice must be two translations.");
  return [readPoint(a, "lattice/0"), readPoint(b, "lattice/1")];
}

function readOverrides(value: unknown): CrossingOverride[] {
  const overrides = list(value, "overrides");
  if (overrides.length > MAX_OVERRIDES) throw new LayoutTextError(`overrides may have ${MAX_OVERRIDES} entries.`);
  return overrides.map((entry, k) => {
    const override = fields(entry, `overrides/${k}`);
    const slides = list(override.slides, `overrides/${k}/slides`).map((member) => number(member, `overrides/${k}/slides`));
    return { ...override, crossing: number(override.crossing, `overrides/${k}/crossing`), slides } as CrossingOverride;
  });
}

function readPoint(value: unknown, name: string): Point {
  const [x, y, ...rest] = list(value, name);
  if (rest.length > 0) throw new LayoutTextError(`${name} must be two numbers.`);
  return [number(x, name), number(y, name)];
}

function fields(value: unknown, name: string): Fields {
  if (typeof value !== "object" || value === null || Array.isArray(value)) throw new LayoutTextError(`${name} must be an object.`);
  return value as Fields;
}

function list(value: unknown, name: string): unknown[] {
  if (!Array.isArray(value)) throw new LayoutTextError(`${name} must be a list.`);
  return value;
}

function number(value: unknown, name: string): number {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new LayoutTextError(`${name} must be a number.`);
  return value;
}
