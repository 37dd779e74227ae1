// From what the person decided to what the server is asked.
import type { DesignRequest, ProfileRequest, SimulationRequest } from "../contract/types";
import { ANY, type DesignState, type Found, isPolar, type ProfileKind, type Target } from "./state";
import { askedOrder, targetsOf } from "./target_list";
import { convertedStrain } from "./targets";

/** Samples of a target over strain, ends included: at most this many, few enough to follow a pointer. */
const STRAIN_SAMPLES = 31;
const DIRECTION_SAMPLES = 60;
const VERIFIED_SAMPLES = 12;
/** States of the deformed patch in either direction from rest. */
const PATCH_STATES = 5;

/**
 * `follow`: a pointer is being dragged; the search starts from the design shown and stays in its family.
 * `search`: everything that the state allows.
 */
export type Effort = "follow" | "search";

function samplesOf(kind: ProfileKind): number {
  return isPolar(kind.task) ? DIRECTION_SAMPLES : STRAIN_SAMPLES;
}

type RequestedTarget = NonNullable<DesignRequest["also"]>[number];

function requestedTarget(target: Target): RequestedTarget {
  return {
    ...(kindOf(target) as Pick<RequestedTarget, "task" | "direction" | "strain" | "strain_measure">),
    target: { control_points: target.points.map(([x, y]) => [x, y]), interpolation: target.interpolation },
    samples: samplesOf(target),
    ...(target.weight !== 1 && { weight: target.weight }),
  };
}

function kindOf(state: ProfileKind): Pick<DesignRequest, "task" | "direction" | "strain" | "strain_measure"> {
  return {
    task: state.task,
    strain_measure: state.measure,
    ...(isPolar(state.task) ? { strain: state.strain } : { direction: state.direction }),
  };
}

/** The family that a search of this state looks in; undefined for all. */
export function searchedFamily(state: DesignState, effort: Effort): string | undefined {
  if (state.family !== ANY) return state.family;
  return effort === "follow" || state.fixed.some(Boolean) ? state.found?.family : undefined;
}

/** All targets in one request, the one in sight first. */
export function designRequest(state: DesignState, effort: Effort, session: string): DesignRequest {
  const targets = targetsOf(state);
  const [main, ...also] = askedOrder(state).map((place) => requestedTarget(targets[place]));
  const family = searchedFamily(state, effort);
  const start = state.found && state.found.family === family ? state.found.parameters : undefined;
  const follow = effort === "follow" && start !== undefined;
  return {
    ...main,
    ...(also.length > 0 && { also }),
    family: family ?? ANY,
    ...(start && { initial: [...start] }),
    ...(start && state.fixed.some(Boolean) && { fixed: start.map((value, k) => (state.fixed[k] ? value : null)) }),
    effects: follow ? { multi_start: "off", envelope: "off" } : { multi_start: "automatic", envelope: "on" },
    accuracy: follow ? { tolerance: 1e-4, max_iterations: 20 } : {},
    session,
  };
}

/** A design's profile at the samples of the state's target. */
export function profileRequest(state: ProfileKind & Pick<DesignState, "points">, found: Found): ProfileRequest {
  const { points } = state;
  return {
    ...(kindOf(state) as Pick<ProfileRequest, "task" | "direction" | "strain" | "strain_measure">),
    family: found.family,
    parameters: [...found.parameters],
    ...((isPolar(state.task) || points.length > 1) && { samples: samplesOf(state) }),
    ...(!isPolar(state.task) && points.length > 1 && { range: [points[0][0], points[points.length - 1][0]] }),
  };
}

/** The design shown, as it is, simulated at its native scale along the target's profile. */
export function verificationRequest(state: DesignState, found: Found): DesignRequest {
  return {
    ...designRequest({ ...state, family: found.family, found, fixed: [] }, "follow", "unused"),
    fixed: [...found.parameters],
    verify: true,
    accuracy: { verified_samples: VERIFIED_SAMPLES },
    session: undefined,
  };
}

/** The design shown, corrected by simulations until they follow the target; held parameters stay. */
export function polishRequest(state: DesignState, found: Found): DesignRequest {
  return {
    ...designRequest({ ...state, family: found.family, found }, "search", "unused"),
    effects: { multi_start: "off", envelope: "off", polish: "on" },
    accuracy: { verified_samples: VERIFIED_SAMPLES },
    session: undefined,
  };
}

/** Simulation of the deformed patch: rest to the largest strain, then back to the smallest. */
export function patchRequest(state: DesignState, found: Found): SimulationRequest {
  const strains = isPolar(state.task) ? [state.strain] : state.points.map((point) => point[0]);
  const toStretch = (strain: number) =>
    1 + (state.measure === "engineering" ? strain : convertedStrain(strain, "engineering"));
  const path = (end: number) => Array.from({ length: PATCH_STATES }, (_, k) => toStretch((end * (k + 1)) / PATCH_STATES));
  const [smallest, largest] = [Math.min(...strains), Math.max(...strains)];
  const stretches = [1, ...(largest > 0 ? path(largest) : []), ...(smallest < 0 ? path(smallest) : [])];
  return {
    family: found.family,
    parameters: [...found.parameters],
    load: { uniaxial: { direction: isPolar(state.task) ? 0 : state.direction, frame: "material", stretches } },
    tangents: false,
    deformed: "json",
  } as SimulationRequest;
}

/** Path of the structure as a file of the server. */
export function structurePath(found: Found, format: "svg" | "dxf" | "stl", cells: readonly [number, number]): string {
  const parameters = found.parameters.map((value) => String(value)).join(",");
  return `/v1/families/${encodeURIComponent(found.family)}/structure?parameters=${parameters}&cells=${cells.join(",")}&format=${format}`;
}
