// The requests of the weave page, made from its state.
import { atLevel } from "../base/accuracy_levels";
import type { Weave, WeaveHomogenizationRequest, WeaveLayoutRequest, WeaveStrands } from "../contract/types";
import { DEFAULT_STATE, type WeaveState } from "./state";

/** Numbers of directions over half a turn: for a preview during changes, and for the final plot. */
export const COARSE_DIRECTIONS = 24;
export const FINE_DIRECTIONS = 200;

type Connections = NonNullable<Extract<Weave, { pattern: "regular" }>["connections"]>;
const REGULAR: readonly Connections[] = ["fused", "slides_x", "slides_y", [["slides_x", "slides_y"], ["slides_y", "slides_x"]]];

/** The weave in a request: the periodic cell, or the sheet if there is none. */
export function weaveOf(state: WeaveState): Weave {
  const { lengths, pattern, type } = state;
  const common = {
    radius: lengths.radius,
    material: { youngs_modulus: state.youngsModulus },
    ...(state.overrides.length > 0 && { overrides: [...state.overrides] }),
  };
  switch (pattern) {
    case "regular":
      return { pattern, connections: REGULAR[type - 1], pitch: lengths.pitch, ...common };
    case "interlacing_squares":
      return { pattern, type, side: lengths.side, overlap: lengths.overlap, ...common } as Weave;
    case "interlacing_circles":
      return { pattern, type, circle_radius: lengths.circle_radius, distance: lengths.distance, ...common } as Weave;
    case "actuated_rings":
      return { pattern, ...common };
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

/** Whether the weave has strands, so that there is anything to compute. */
export function hasStrands(state: WeaveState): boolean {
  return state.pattern !== "layout" || state.layout.strands.length > 0;
}

export function layoutRequest(state: WeaveState): WeaveLayoutRequest {
  return { weave: weaveOf(state) };
}

/** The request for stiffness and Poisson's ratio. `directions`: their number over half a turn, or their angles in radians. */
export function homogenizationRequest(state: WeaveState, directions: number | readonly number[]): WeaveHomogenizationRequest {
  return {
    weave: weaveOf(state),
    strain: state.strain,
    directions: typeof directions === "number" ? directions : [...directions],
    shear: state.shear,
    ...weaveSettings(state),
  };
}

/** Accuracy and effects of a cell or a sheet at the chosen level. */
export function weaveSettings(state: WeaveState): Pick<WeaveHomogenizationRequest, "accuracy" | "effects"> {
  const segments = state.accuracy.level === "own" ? state.segments : DEFAULT_STATE.segments;
  return atLevel({ accuracy: { segments }, effects: { out_of_plane: state.space } }, "weaves", state.accuracy);
}

/** The request for what is shown while the user still drags. It has no estimated error, which would take up to 1.7 times as long. */
export function previewRequest(state: WeaveState, directions: number | readonly number[]): WeaveHomogenizationRequest {
  const request = homogenizationRequest(state, directions);
  return { ...request, effects: { ...request.effects, error_estimate: "off" } };
}

/** The request for one direction, with the deformed cell. */
export function cellRequest(state: WeaveState, direction: number): WeaveHomogenizationRequest {
  return { ...previewRequest(state, [direction]), deformed: [0] };
}
