// From what the person decided to what the server is asked.
import type { Weave, WeaveHomogenizationRequest, WeaveLayoutRequest, WeaveStrands } from "../contract/types";
import type { WeaveState } from "./state";

/** Directions over half a turn: enough to see what a change does while it is made, and for the plot. */
export const COARSE_DIRECTIONS = 24;
export const FINE_DIRECTIONS = 200;

type Connections = NonNullable<Extract<Weave, { pattern: "regular" }>["connections"]>;
const REGULAR: readonly Connections[] = ["fused", "slides_x", "slides_y", [["slides_x", "slides_y"], ["slides_y", "slides_x"]]];

/** The periodic cell, or the sheet where there is none. */
export function weaveOf(state: WeaveState): Weave {
  const { lengths, pattern, type } = state;
  const common = {
    radius: lengths.radius,
    material: { youngs_modulus: state.youngsModulus },
    ...(state.overrides.length > 0 && { overrides: [...state.overrides] }),
  };
  switch (pattern) {
    case "regular": return { pattern, connections: REGULAR[type - 1], pitch: lengths.pitch, ...common };
    case "interlacing_squares": return { pattern, type, side: lengths.side, overlap: lengths.overlap, ...common } as Weave;
    case "interlacing_circles": return { pattern, type, circle_radius: lengths.circle_radius, distance: lengths.distance, ...common } as Weave;
    case "actuated_rings": return { pattern, ...common };
    case "layout": {
      const { strands, lattice, crossings, sliding_share } = state.layout;
      return {
        strands: [...strands],
        ...(lattice && { lattice: lattice.map((translation) => [...translation]) }),
        ...(crossings && { crossings }),
        ...(sliding_share !== undefined && { sliding_share }),
        ...common,
      } as WeaveStrands;
    }
  }
}

/** Whether there is anything to ask about. */
export function hasStrands(state: WeaveState): boolean {
  return state.pattern !== "layout" || state.layout.strands.length > 0;
}

export function layoutRequest(state: WeaveState): WeaveLayoutRequest {
  return { weave: weaveOf(state) };
}

/** Stiffness and Poisson's ratio over `directions`: how many over half a turn, or which, in radians. */
export function homogenizationRequest(state: WeaveState, directions: number | readonly number[]): WeaveHomogenizationRequest {
  return {
    weave: weaveOf(state),
    strain: state.strain,
    directions: typeof directions === "number" ? directions : [...directions],
    shear: state.shear,
    accuracy: { segments: state.segments },
    effects: { out_of_plane: state.space },
  };
}

/** The same along one direction, with the deformed cell. */
export function cellRequest(state: WeaveState, direction: number): WeaveHomogenizationRequest {
  return { ...homogenizationRequest(state, [direction]), deformed: [0] };
}
