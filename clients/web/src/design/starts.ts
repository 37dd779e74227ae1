// Example targets. Each is the response of a structure that a search has found and a simulation has confirmed.
import { DEFAULT_STATE, type DesignState } from "./state";

export interface Start {
  readonly name: string;
  readonly words: string;
  readonly state: Pick<DesignState, "task" | "points" | "interpolation"> & Partial<Pick<DesignState, "direction" | "strain">>;
}

export const STARTS: readonly Start[] = [
  {
    name: "Quasi-linear",
    words: "A straight line up to 20 % of strain.",
    state: {
      task: "stress_strain",
      interpolation: "monotone",
      direction: 1.570796,
      points: [[0, 0], [0.0667, 0.17], [0.1333, 0.332], [0.2, 0.489]],
    },
  },
  {
    name: "Plateau",
    words: "Under compression the stress rises, then stays: beams that buckle.",
    state: {
      task: "stress_strain",
      interpolation: "monotone",
      direction: 1.570796,
      points: [[-0.12, -0.12], [-0.08, -0.113], [-0.04, -0.108], [-0.034, -0.111], [-0.03, -0.107], [-0.026, -0.095], [-0.016, -0.057], [0, 0]],
    },
  },
  {
    name: "J-curve",
    words: "Like skin: soft at first, gradually stiffer.",
    state: {
      task: "stress_strain",
      interpolation: "monotone",
      direction: 0.785398,
      points: [[0, 0], [0.0233, 0.000654], [0.0667, 0.0024], [0.1133, 0.00743], [0.1333, 0.0139], [0.16, 0.03], [0.17, 0.0376], [0.1833, 0.0476], [0.2, 0.0593]],
    },
  },
  {
    name: "Soft, then stiff",
    words: "Almost no stress up to a strain of 10 %, then a steep rise.",
    state: {
      task: "stress_strain",
      interpolation: "monotone",
      direction: 0,
      points: [[0, 0], [0.0667, 0.00064], [0.1033, 0.00258], [0.1133, 0.00494], [0.1333, 0.0165], [0.1667, 0.0414], [0.2, 0.0643]],
    },
  },
  {
    name: "Auxetic",
    words: "Pulled in any direction, it does not become narrower; in most it becomes wider.",
    state: {
      task: "poisson",
      interpolation: "cubic",
      strain: 0.02,
      points: [[0, 0.000834], [0.5236, -0.0848], [0.7854, -0.192], [1.0472, -0.364], [1.1519, -0.477], [1.2828, -0.731], [1.3614, -1.02], [1.4399, -1.43], [1.4923, -1.43], [1.5184,
        -1.05], [1.5708, -0.104], [1.6232, -1.05], [1.6493, -1.43], [1.6755, -1.51], [1.7017, -1.43], [1.7541, -1.15], [1.8326, -0.814], [1.9635, -0.516], [2.0944, -0.364], [2.33,
        -0.206], [2.618, -0.085]],
    },
  },
  {
    name: "Isotropic",
    words: "The same stiffness in every direction.",
    state: {
      task: "stiffness",
      interpolation: "cubic",
      strain: 0.005,
      points: [[0, 1], [1.0472, 1], [2.0944, 1]],
    },
  },
  {
    name: "Orthotropic",
    words: "Stiff along two directions at right angles, eight times softer between them.",
    state: {
      task: "stiffness",
      interpolation: "cubic",
      strain: 0.05,
      points: [[0, 2], [0.1571, 1.72], [0.2618, 1.13], [0.3142, 0.863], [0.5236, 0.365], [0.7854, 0.251], [1.0472, 0.318], [1.309, 0.727], [1.4399, 1.19], [1.5708, 1.51], [1.7017,
        1.19], [1.8326, 0.728], [2.0944, 0.318], [2.3562, 0.251], [2.618, 0.364], [2.8274, 0.859], [2.8798, 1.12], [2.9845, 1.71]],
    },
  },
];

/** What this is, in one sentence. */
export const WELCOME_SENTENCE = "Draw how something soft should respond to a load, and Supple finds a pattern of holes that does it, ready to print.";
/** The examples of a first visit by name, which differ most. */
export const WELCOME_STARTS: readonly string[] = ["J-curve", "Plateau", "Auxetic"];

/** The change of the state for an example: its target, and a search in all families. */
export function startState({ state }: Start): Partial<DesignState> {
  return { name: "", direction: DEFAULT_STATE.direction, strain: DEFAULT_STATE.strain, ...state, measure: "green", family: "any", fixed: [], byHand: false };
}
