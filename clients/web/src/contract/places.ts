// Words for the places and fields that the server names: JSON pointers such as "/target/control_points/2", paths such as "crossings/3",
// and names of fields such as "beam_width". No page shows these themselves.

/** Lists whose entries have a number on the pages: the noun, and the number that the page gives to the first entry. */
const ENTRIES: Readonly<Record<string, readonly [noun: string, first: 0 | 1 | 2]>> = {
  control_points: ["control point", 1],
  regions: ["region", 1],
  also: ["target", 2],
  strands: ["strand", 1],
  crossings: ["crossing", 1],
  overrides: ["changed crossing", 1],
  overruns: ["overrun", 1],
  supports: ["support", 1],
  grips: ["grip", 1],
  parameters: ["parameter", 1],
  initial: ["start of parameter", 1],
  fixed: ["fixed parameter", 1],
  material: ["material", 1],
  polygons: ["curve", 1],
  holes: ["hole", 1],
  samples: ["sample", 1],
  pairs: ["pair", 1],
  points: ["point", 0],
  fixed_points: ["held point", 1],
  springs: ["spring", 0],
  triangles: ["triangle", 0],
  sites: ["site", 0],
  fixed_sites: ["held site", 1],
  fixed_vertices: ["held vertex", 1],
  moved_vertices: ["moved support", 1],
  sources: ["source", 0],
  weights: ["weight", 0],
  positions: ["position", 1],
  green_strain: ["strain", 1],
  stretches: ["stretch", 1],
  strains: ["strain", 1],
  directions: ["direction", 1],
  repair: ["repair", 1],
  columns: ["column", 1],
  cells: ["number of cells", 1],
  vertices: ["vertex", 1],
  edges: ["edge", 1],
  placements: ["copy of the tile", 1],
  translations: ["translation", 1],
  shapes: ["shape of edges", 1],
};

/** Words of fields whose names do not say it; the others are their names with spaces. */
const FIELDS: Readonly<Record<string, string>> = {
  youngs_modulus: "Young’s modulus",
  youngs_modulus_mpa: "Young’s modulus",
  poisson_ratio: "Poisson’s ratio",
  poisson: "Poisson’s ratio",
  fixed_points: "held points",
  fixed_sites: "held sites",
  fixed_vertices: "held vertices",
  moved_vertices: "moved supports",
  control_points: "control points",
  green_strain: "strain",
  rest_length: "rest length",
  strain_measure: "measure of strain",
  max_iterations: "limit of iterations",
  max_strains: "limit of strains",
  mesh_size: "size of the elements",
  element_size: "size of the elements",
  corner_size: "size of the elements at corners",
  beam_width: "width of the beams",
  cell_size: "size of the cell",
  loop_overlap: "overlap of loops",
  lead_in: "lead-in",
  chord_error: "deviation of arcs",
  bead_area: "area of a bead",
  strand_width: "width of a strand",
  strand_height: "height of a strand",
  nozzle_temperature: "temperature of the nozzle",
  bed_temperature: "temperature of the bed",
  nozzle_diameter: "diameter of the nozzle",
  filament_diameter: "diameter of the filament",
  startup_gcode: "G-code at the start",
  footer_gcode: "G-code at the end",
  gcode: "G-code",
  half_width: "half width",
  grip_length: "length of a grip",
  gauge_length: "gauge length",
  poisson_disk: "even spacing",
  sliding_share: "fraction that slides",
  circle_radius: "radius of the circles",
  known_path: "known path",
  isohedral_type: "isohedral type",
  core_seconds: "core time",
  verified_samples: "number of simulated samples",
  out_of_plane: "motion out of the plane",
  spring_length: "length of springs",
  mollifier_length: "length of the smoothing",
  border_deviation: "deviation of borders",
  weld_tolerance: "welding distance",
  decimal_separator: "decimal sign",
  loading: "loading",
  a: "first number",
};

/** Paths that have words of their own. */
const PATHS: Readonly<Record<string, string>> = { "units/x": "the unit of strain", "units/y": "the unit of stress" };

/** Parts of a request that only contain others: they are not named where something within them is. */
const CONTAINERS: ReadonlySet<string> = new Set(["weave", "target", "structure", "accuracy", "effects", "printer", "options", "text", "load", "uniaxial", "host", "layout",
  "definition", "tile", "budget"]);

const ORDINALS = ["first", "second", "third", "fourth", "fifth", "sixth"];

/** A step of a path that has a number: the name of the list and the index from 0. */
export interface Entry {
  readonly list: string;
  readonly index: number;
}

function segmentsOf(path: string): string[] {
  return path.split("/").filter((segment) => segment !== "").map((segment) => segment.replace(/~1/g, "/").replace(/~0/g, "~"));
}

/** The numbered entries that a pointer or path goes through, the outermost first. */
export function entriesOf(path: string): Entry[] {
  const segments = segmentsOf(path);
  return segments.flatMap((segment, k) => (/^\d+$/.test(segments[k + 1] ?? "") ? [{ list: segment, index: Number(segments[k + 1]) }] : []));
}

/** The words of a field's name. */
export function fieldWords(name: string): string {
  return FIELDS[name] ?? name.replace(/_/g, " ");
}

function entryWords(list: string, index: number): string | null {
  const entry = ENTRIES[list];
  return entry ? `${entry[0]} ${index + entry[1]}` : null;
}

function valueWords(index: number): string {
  return ORDINALS[index] ? `the ${ORDINALS[index]} value` : `value ${index + 1}`;
}

/**
 * A pointer or a path in words, the innermost part first: "control point 3 of region 2", "the apex of the channel". Empty for the whole
 * request and for a part that says nothing, such as the text of a file.
 */
export function placeWords(path: string): string {
  const segments = segmentsOf(path);
  const own = PATHS[segments.join("/")];
  if (own) return own;
  const parts: { readonly words: string; readonly isContainer: boolean }[] = [];
  for (let k = 0; k < segments.length; ++k) {
    const segment = segments[k];
    const next = segments[k + 1];
    if (/^\d+$/.test(segment)) {
      parts.push({ words: valueWords(Number(segment)), isContainer: false });
    } else if (next !== undefined && /^\d+$/.test(next)) {
      const words = entryWords(segment, Number(next));
      parts.push({ words: words ?? `${valueWords(Number(next))} of the ${fieldWords(segment)}`, isContainer: false });
      ++k;
    } else {
      parts.push({ words: `the ${fieldWords(segment)}`, isContainer: CONTAINERS.has(segment) });
    }
  }
  const last = parts.length - 1;
  const told = parts.filter(({ isContainer }, k) => !isContainer || (k === last && segments[segments.length - 1] !== "text"));
  return told.map(({ words }) => words).reverse().join(" of ");
}

/** Names of mesh elements as the server writes them, such as "face 17", or of a query's parameter. */
const ELEMENT = /^(face|edge|vertex|line|byte|query) /;

/** The place that an entry of a problem names, in words. */
export function pointerWords(pointer: string): string {
  if (pointer === "" || pointer === "/") return "";
  if (!ELEMENT.test(pointer)) return placeWords(pointer);
  const edge = /^edge (\d+) (\d+)$/.exec(pointer);
  if (edge) return `the edge between vertices ${edge[1]} and ${edge[2]}`;
  return pointer.startsWith("query ") ? placeWords(pointer.slice("query ".length)) : pointer;
}

/** Words with a slash that are no paths: units, and kinds of files. */
const NOT_PATHS = /^(mm|cm|m|g|kg|kN|N|mN|kgf|lbf|s|rad|J|mJ)\/(min|mm|cm|m|s|rad|kg)$|^(application|image|multipart|text|model)\/[a-z][a-z0-9+.-]*$|^(and|either|input|read)\//;
const PATH = /(?<![\w/.<])\/?[a-z][a-z0-9_]*(?:\/(?:[a-z][a-z0-9_]*|\d+))+(?![\w/])|(?<![\w/.<\d])\/[a-z][a-z0-9_]*(?![\w/])/g;
const FIELD_NAME = /(?<![\w-])[a-z][a-z0-9]*(?:_[a-z0-9]+)+(?!\w)/g;
const API_PATH = /\b(?:GET|POST|PUT|PATCH|DELETE) \/\S*\w|\/v1(?:\/[\w{}.-]+)*|\/(?:openapi\.yaml|readyz|healthz|metrics)/g;

/** Verbs with which a detail goes on the name of its place, so that both are one sentence: "must be positive". */
export const GOES_ON = /^(?:must|has|is|are|have|may|would|goes|lies|names|needs|takes|reaches|makes|gives|holds|exists|cannot|does)\b/;

/** The words of a path that is found at a place of a text; capitalized where a sentence begins. */
function pathWords(path: string, text: string, at: number): string {
  if (NOT_PATHS.test(path)) return path;
  const begins = /[.!?] $/.test(text.slice(0, at));
  const words = placeWords(path) || "the file";
  return begins ? capitalized(words) : words;
}

/** A sentence with words in place of pointers, paths, names of fields and addresses of the server's interface. */
export function inWords(sentence: string): string {
  return capitalized(rewritten(sentence));
}

/** What is quoted is a name that somebody has given, or a text of theirs. */
const QUOTED = /("[^"]*"|“[^”]*”)/;

/** The same for a part of a sentence. Names in quotation marks stay as they are. */
export function rewritten(text: string): string {
  return text.split(QUOTED).map((part, k, parts) => (k % 2 === 1 ? part : unquotedInWords(part, parts.slice(0, k).join("")))).join("");
}

/** `before`: the text that precedes the part. */
function unquotedInWords(text: string, before: string): string {
  return text.replace(/\brepair=([a-z_]+)/g, (_, name: string) => `the repair “${name.replace(/_/g, " ")}”`)
    .replace(API_PATH, "the server")
    .replace(PATH, (path: string, at: number, whole: string) => pathWords(path, before + whole, before.length + at))
    .replace(/(unit of (?:strain|stress)): (?=must\b)/g, "$1 ")
    .replace(FIELD_NAME, fieldWords)
    .replace(/(\d\.\d*?)0+(?= mm\b)/g, (_, digits: string) => digits.replace(/\.$/, ""));
}

export function capitalized(sentence: string): string {
  return sentence.charAt(0).toUpperCase() + sentence.slice(1);
}
