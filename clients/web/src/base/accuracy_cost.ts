// The time that more or less accuracy costs, from the tables of the project's benchmarks, reduced to the rows of an endpoint and a family.
import designs from "../../../../docs/bench/designs-accuracy.csv?raw";
import simulations from "../../../../docs/bench/simulations-refinement.csv?raw";
import geodesics from "../../../../docs/bench/geodesics-accuracy.csv?raw";
import networks from "../../../../docs/bench/networks-accuracy.csv?raw";
import voronoi from "../../../../docs/bench/voronoi-accuracy.csv?raw";
import weaves from "../../../../docs/bench/weaves-segments.csv?raw";

export interface AccuracyCost {
  readonly caption: string;
  readonly head: readonly string[];
  readonly rows: readonly (readonly string[])[];
}

type Row = Readonly<Record<string, string>>;

interface Source {
  readonly text: string;
  readonly caption: string;
  readonly columns: readonly (readonly [column: string, words: string])[];
  readonly matches: (row: Row, family: string | null) => boolean;
}

const DESIGNS: Source = {
  text: designs,
  caption: "A search among the designs of a family, by what is asked of it",
  columns: [["knob", "Knob"], ["value", "Value"], ["median_error", "Median deviation"], ["p90_error", "In 90 of 100 below"], ["median_ms", "Median time (ms)"]],
  matches: (row, family) => row.family === (family ?? "IH01"),
};
const SIMULATIONS: Source = {
  text: simulations,
  caption: "Simulated stress that is not extrapolated, by the mesh: a side over the beam width, and corners over sides",
  columns: [["mesh", "Mesh"], ["nodes", "Nodes"], ["median_percent", "Median error (%)"], ["worst_percent", "Worst (%)"], ["ms_per_state", "Time of a state (ms)"]],
  matches: (row, family) => row.family === (family ?? "IH01"),
};
const GEODESICS: Source = {
  text: geodesics,
  caption: "Distances to a source on a mesh of 81,920 faces, by the error that is allowed",
  columns: [["method", "Method"], ["max_error", "Largest error"], ["mean_error", "Mean error"], ["ms", "Time (ms)"]],
  matches: (row) => row.mesh === "icosphere",
};
const WEAVES: Source = {
  text: weaves,
  caption: "Stiffness of a cell in one direction, by the pieces of rod between crossings",
  columns: [["cell", "Cell"], ["segments", "Pieces"], ["modulus_percent", "Error of the modulus (%)"], ["poisson", "Error of Poisson’s ratio"], ["ms", "Time (ms)"]],
  matches: () => true,
};
const NETWORKS: Source = {
  text: networks,
  caption: "A network at rest, by the tolerance of its gradient",
  columns: [["scene", "Scene"], ["tolerance", "Tolerance"], ["position_error", "Error of positions"], ["energy_error", "Error of the energy"], ["cpu_ms", "Time (ms)"]],
  matches: () => true,
};
const VORONOI: Source = {
  text: voronoi,
  caption: "A Voronoi diagram, by the error that its distances may have",
  columns: [["shape", "Surface"], ["method", "Distances"], ["area", "Error of areas"], ["ms", "Time (ms)"]],
  matches: () => true,
};

const SOURCES: Readonly<Record<string, Source>> = {
  "/v1/designs": DESIGNS,
  "/v1/simulations": SIMULATIONS,
  "/v1/geodesics": GEODESICS,
  "/v1/geodesic-fields": GEODESICS,
  "/v1/karcher-means": GEODESICS,
  "/v1/weave-homogenizations": WEAVES,
  "/v1/weave-simulations": WEAVES,
  "/v1/embedded-systems": NETWORKS,
  "/v1/voronoi-diagrams": VORONOI,
  "/v1/voronoi-optimizations": VORONOI,
};

/** The table of an endpoint and a family; null if no benchmark has measured them. */
export function accuracyCost(path: string, family: string | null): AccuracyCost | null {
  const source = SOURCES[path];
  if (!source) return null;
  const rows = readCsv(source.text).filter((row) => source.matches(row, family)).map((row) => source.columns.map(([column]) => row[column] ?? ""));
  return rows.length > 0 ? { caption: source.caption, head: source.columns.map(([, words]) => words), rows } : null;
}

/** The rows of a CSV text, each an object with the column names as keys. Fields may be quoted. */
export function readCsv(text: string): Row[] {
  const fieldsOf = (line: string) => [...`,${line}`.matchAll(/,(?:"((?:[^"]|"")*)"|([^,]*))/g)].map((field) => field[1]?.replace(/""/g, '"') ?? field[2] ?? "");
  const [head, ...lines] = text.trim().split(/\r?\n/).map(fieldsOf);
  return lines.map((fields) => Object.fromEntries(head.map((name, k) => [name, fields[k] ?? ""])));
}
