// What repairs a sheet that cannot be printed: wider spacing, or fused crossings, from the numbers in the server's answer.
import type { ProblemDocument, WeaveLayout } from "../contract/types";
import { withConnection } from "./connections";
import { periodicDistance } from "./geometry";
import { PATTERNS } from "./patterns";
import { isPeriodic, type Lattice, type Point, type WeaveState } from "./state";

/** A spacing above this factor makes another weave, so that it is not offered. */
const MAX_SPREAD = 4;
/** Largest distance of a crossing of the sheet from the cell's, as a fraction of the shorter translation. */
const SAME_FRACTION = 0.05;

type Errors = Pick<ProblemDocument, "errors">;

/**
 * The factor by which all lengths of the weave but its radius have to grow until each crossing at fault has the room that it needs, rounded up
 * to a tenth. Null if a fault is of another kind, has no room at all, or needs too much. The flat part of a strand does not grow, so that
 * the factor is on the safe side.
 */
export function spreadFactor({ errors = [] }: Errors): number | null {
  let factor = 1;
  for (const { needed, available } of errors) {
    if (needed === undefined || available === undefined) return null;
    factor = Math.max(factor, needed / available);
  }
  const rounded = Math.ceil(10 * factor - 1e-9) / 10;
  return rounded > 1 && rounded <= MAX_SPREAD ? rounded : null;
}

/** The weave with all lengths but the radius of its strands multiplied; null for a pattern without lengths and for strands with crossings by hand. */
export function spreadWeave(state: WeaveState, factor: number): Pick<WeaveState, "lengths" | "layout"> | null {
  const round = (value: number) => Number((factor * value).toFixed(4));
  if (state.pattern === "layout") {
    const { strands, lattice, crossings } = state.layout;
    if (crossings) return null;
    const spread = (point: readonly number[]): Point => [round(point[0]), round(point[1])];
    return {
      lengths: state.lengths,
      layout: {
        ...state.layout,
        strands: strands.map((strand) => ({
          ...strand,
          points: strand.points.map((point) => [...spread(point)]),
          ...(strand.translation && { translation: [...spread(strand.translation)] }),
        })),
        lattice: lattice && [spread(lattice[0]), spread(lattice[1])],
      },
    };
  }
  const names = PATTERNS[state.pattern].lengths.filter((name) => name !== "radius");
  if (names.length === 0) return null;
  return { lengths: { ...state.lengths, ...Object.fromEntries(names.map((name) => [name, round(state.lengths[name])])) }, layout: state.layout };
}

/**
 * The weave's crossings of which some crossings of the sheet are copies, without repetition: of a weave that repeats, those of its cell. Null
 * if a crossing has no counterpart.
 */
export function ownCrossings(state: WeaveState, cell: WeaveLayout | null, sheet: WeaveLayout, indices: readonly number[]): number[] | null {
  if (!isPeriodic(state)) return [...indices];
  if (!cell?.lattice || cell.strands.length === 0) return null;
  const lattice = cell.lattice as unknown as Lattice;
  const [from, to] = [cell.strands[0].polyline[0], sheet.strands[0].polyline[0]];
  const tolerance = SAME_FRACTION * Math.min(...lattice.map((translation) => Math.hypot(...translation)));
  const own = new Set<number>();
  for (const index of indices) {
    const crossing = sheet.crossings[index];
    const place = crossing && [crossing.position[0] - to[0] + from[0], crossing.position[1] - to[1] + from[1]];
    const found = place ? cell.crossings.findIndex((other) => periodicDistance(lattice, other.position, place) < tolerance) : -1;
    if (found < 0) return null;
    own.add(found);
  }
  return [...own].sort((a, b) => a - b);
}

/** The connections of a weave after some of its crossings were fused. */
export function fused(overrides: WeaveState["overrides"], crossings: readonly number[]): WeaveState["overrides"] {
  return crossings.reduce<WeaveState["overrides"]>((all, crossing) => withConnection(all, crossing, []), overrides);
}
