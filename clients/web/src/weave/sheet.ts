// A finite sheet of the weave: strands, crossings connected as in the cell, supports and load.
import { boxAround, latticeCoordinates, latticePoint } from "../base/plane";
import type { CrossingOverride, Weave, WeaveLayout, WeaveSimulation, WeaveSimulationRequest, WeaveStrands } from "../contract/types";
import { slidingMembers } from "./connections";
import { angleBetween, directionAt, periodicDistance } from "./geometry";
import { weaveOf, weaveSettings } from "./requests";
import { type FreeLayout, isPeriodic, type Lattice, type LoadKind, type Point, type SheetState, type Strand, type WeaveState } from "./state";

/** Number of states along the load path, without the state at rest. */
export const SHEET_STATES = 8;
/** Width of the band at a border in which crossings and ends are supports, as a fraction of the width or height of the sheet. */
const BORDER_FRACTION = 0.005;
/** Largest distance of a crossing of the sheet from the corresponding one of the cell, as a fraction of the shorter translation. */
const SAME_FRACTION = 0.05;
/** Displacement of the pushed strand of the rings at an amount of 1, in mm. */
const PUSH_LENGTH = 30;

export const LOAD_WORDS: Record<LoadKind, string> = { stretch_x: "Stretch along x", stretch_y: "Stretch along y", shear: "Shear", push: "Push the strand in" };

/** The sheet as a weave in a request. Crossings are those of the pattern's type; those of user-drawn strands are fused. */
export function sheetWeave(state: WeaveState): Weave {
  const { columns, rows } = state.sheet;
  if (!isPeriodic(state)) return weaveOf(state);
  const weave = weaveOf({ ...state, overrides: [] });
  if (!("pattern" in weave)) {
    const { crossings: _, lattice: __, ...others } = weave as WeaveStrands;
    return { ...others, strands: tiledStrands(state.layout, state.sheet) } as Weave;
  }
  // A cell of the regular weave has two strands in each direction.
  const strands = weave.pattern === "regular" ? 2 : 1;
  return { ...weave, sheet: { columns: strands * columns, rows: strands * rows } } as Weave;
}

/** Copies of the strands in all cells of a sheet. Periodic strands become open strands that end at the border. */
export function tiledStrands({ strands, lattice }: FreeLayout, { columns, rows }: Pick<SheetState, "columns" | "rows">): Strand[] {
  if (!lattice) return [...strands];
  const inside = (i: number, k: number) => i >= 0 && i < columns && k >= 0 && k < rows;
  const cells = Array.from({ length: rows }, (_, k) => Array.from({ length: columns }, (_, i): Point => [i, k])).flat();
  return strands.flatMap((strand) => {
    const { ends, translation, points, ...others } = strand;
    const copy = (i: number, k: number): number[][] => {
      const [x, y] = latticePoint(lattice, i, k);
      return points.map((point) => [point[0] + x, point[1] + y]);
    };
    if (ends !== "periodic" || !translation) return cells.map(([i, k]): Strand => ({ ...others, ...(ends && { ends }), points: copy(i, k) }));
    const [m, n] = latticeCoordinates(lattice, translation).map(Math.round);
    // A copy begins in each cell whose preceding cell along the strand lies outside.
    return cells.filter(([i, k]) => !inside(i - m, k - n)).map(([i, k]): Strand => {
      const line: number[][] = [];
      let [column, row] = [i, k];
      for (; inside(column, row); column += m, row += n) line.push(...copy(column, row));
      return { ...others, points: [...line, copy(column, row)[0]] };
    });
  });
}

/** The overrides that connect the crossings of a sheet as in the cell, and the number of crossings without a counterpart in the cell. */
export function sheetOverrides(cell: WeaveLayout, sheet: WeaveLayout): { overrides: CrossingOverride[]; unknown: number } {
  const lattice = cell.lattice as unknown as Lattice;
  const [from, to] = [cell.strands[0].polyline[0], sheet.strands[0].polyline[0]];
  const tolerance = SAME_FRACTION * Math.min(...lattice.map((translation) => Math.hypot(...translation)));
  const overrides: CrossingOverride[] = [];
  let unknown = 0;
  sheet.crossings.forEach((crossing, index) => {
    const place = [crossing.position[0] - to[0] + from[0], crossing.position[1] - to[1] + from[1]];
    const cellCrossing = nearest(cell, lattice, place, tolerance);
    if (!cellCrossing) return void ++unknown;
    const directions = crossing.members.map((member) => directionAt(sheet.strands[member.strand].polyline, member.coordinate));
    const slides = slidingMembers(cellCrossing).map((k) => {
      const { strand, coordinate } = cellCrossing.members[k];
      const direction = directionAt(cell.strands[strand].polyline, coordinate);
      const angles = directions.map((other) => angleBetween(other, direction));
      return angles.indexOf(Math.min(...angles));
    });
    const wanted = [...new Set(slides)].sort((a, b) => a - b);
    if (wanted.join() !== slidingMembers(crossing).join()) overrides.push({ crossing: index, slides: wanted });
  });
  return { overrides, unknown };
}

function nearest(cell: WeaveLayout, lattice: Lattice, place: readonly number[], maxDistance: number): WeaveLayout["crossings"][number] | null {
  let best: WeaveLayout["crossings"][number] | null = null;
  let minDistance = maxDistance;
  for (const crossing of cell.crossings) {
    const distance = periodicDistance(lattice, crossing.position, place);
    if (distance < minDistance) [minDistance, best] = [distance, crossing];
  }
  return best;
}

type Supports = WeaveSimulationRequest["supports"];

/** The supports of a sheet: two opposite borders, one fixed and one displaced; for the rings, the pushed strand. */
export function sheetSupports({ load, amount }: SheetState, sheet: WeaveLayout): Supports {
  if (load === "push") {
    return [
      { at: { strand: 2, share: 0.75 }, clamped: true },
      { at: { strand: sheet.strands.length - 1, share: 1 }, displacement: [0, PUSH_LENGTH * amount, 0] },
    ];
  }
  const ends = sheet.strands.filter((strand) => strand.ends === "open").flatMap(({ polyline }) => [polyline[0], polyline[polyline.length - 1]]);
  const { x, y, width, height } = boxAround([...sheet.crossings.map((crossing) => crossing.position), ...ends]);
  const [right, top] = [x + width, y + height];
  if (load === "stretch_x") {
    const band = BORDER_FRACTION * width;
    return [
      { at: { box: [[x - band, y - band], [x + band, top + band]] } },
      { at: { box: [[right - band, y - band], [right + band, top + band]] }, displacement: [amount * width, 0, 0] },
    ];
  }
  const band = BORDER_FRACTION * height;
  return [
    { at: { box: [[x - band, y - band], [right + band, y + band]] } },
    { at: { box: [[x - band, top - band], [right + band, top + band]] }, displacement: load === "shear" ? [amount * height, 0, 0] : [0, amount * height, 0] },
  ];
}

export function simulationRequest(state: WeaveState, weave: Weave, sheet: WeaveLayout): WeaveSimulationRequest {
  return {
    weave,
    supports: sheetSupports(state.sheet, sheet),
    states: SHEET_STATES,
    deformed: "json",
    ...weaveSettings(state),
  };
}

/** Force on the displaced border in the direction of its displacement, in N. */
export function loadForce(answer: WeaveSimulation, index: number, load: LoadKind): number {
  const axis = load === "stretch_x" || load === "shear" ? 0 : 1;
  const moved = answer.supports.flatMap((place, k) => (place.support === 1 ? [k] : []));
  return moved.reduce((sum, k) => sum + answer.states[index].reactions[k][axis], 0);
}
