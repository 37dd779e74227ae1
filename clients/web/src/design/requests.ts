// The requests of the design page, made from its state.
import { type AccuracyChoice, NORMAL } from "../base/accuracy_choice";
import { atLevel } from "../base/accuracy_levels";
import type { DesignRequest, ProfileRequest, SimulationRequest, StructureRequest } from "../contract/types";
import { DEFAULT_SPECIFICATION, isRange, type Specification, specificationFields, modulusOf, orientationOf, withFoundValues } from "./specification";
import { ANY, type DesignState, type TilingDesign, isPolar, type ProfileKind, type Region, type Target } from "./state";
import { regionWords } from "./region_list";
import { askedOrder, targetsOf } from "./target_list";
import { convertedStrain } from "./targets";

/** Samples of a target over strain, ends included; few enough that a search follows the pointer. */
const STRAIN_SAMPLES = 31;
const DIRECTION_SAMPLES = 60;
const VERIFIED_SAMPLES = 12;
/** Number of states of the deformed patch in tension, and in compression. */
const PATCH_STATES = 5;

/**
 * `follow`: a quick search while the pointer drags, which starts from the shown design and stays in its family.
 * `search`: a thorough search in all families that the state allows.
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

/** The family to which a search of this state is restricted; undefined for all families. */
export function searchedFamily(state: Region, effort: Effort): string | undefined {
  if (state.family !== ANY) return state.family;
  return effort === "follow" || state.fixed.some(Boolean) ? state.found?.family : undefined;
}

type Problem = NonNullable<DesignRequest["regions"]>[number];

/** The design problem of a region: all targets, the selected one first, with family, specification and start of the search. */
function problemOf(region: Region, effort: Effort): Problem {
  const targets = targetsOf(region);
  const [main, ...also] = askedOrder(region).map((place) => requestedTarget(targets[place]));
  const family = searchedFamily(region, effort);
  const begin = region.found && region.found.family === family ? region.found : undefined;
  const start = begin?.parameters;
  return {
    ...main,
    ...(also.length > 0 && { also }),
    family: family ?? ANY,
    ...specificationFields(region.made),
    ...(start && { initial: [...start] }),
    ...(begin?.orientation !== undefined && isRange(region.made.orientation) && { initial_orientation: orientationOf(region.made, begin) }),
    ...(start && region.fixed.some(Boolean) && { fixed: start.map((value, k) => (region.fixed[k] ? value : null)) }),
  };
}

const SEARCH: Pick<DesignRequest, "effects" | "accuracy"> = { effects: { multi_start: "automatic", envelope: "on" }, accuracy: {} };
const FOLLOW: Pick<DesignRequest, "effects" | "accuracy"> = { effects: { multi_start: "off", envelope: "off" }, accuracy: { tolerance: 1e-4, max_iterations: 20 } };

/** The request for the design of one region. Only a thorough search has the chosen accuracy: a quick one is to follow the pointer. */
export function designRequest(state: Region, effort: Effort, session: string, accuracy: AccuracyChoice = NORMAL): DesignRequest {
  const problem = problemOf(state, effort);
  if (effort === "follow") return { ...problem, ...(problem.initial ? FOLLOW : SEARCH), session };
  return atLevel({ ...problem, ...SEARCH, session }, "designs", accuracy);
}

/** The request for the designs of all regions. Designs that were set by hand are fixed. */
export function regionsRequest(regions: readonly Region[], session: string, accuracy: AccuracyChoice = NORMAL): DesignRequest {
  const problems = regions.map((region, place): Problem => {
    const { found, byHand } = region;
    const fixedDesign = found && byHand ? { family: found.family, initial: [...found.parameters], fixed: [...found.parameters] } : {};
    const asked = found && byHand ? { ...region, made: withFoundValues(region.made, found) } : region;
    return { name: regionWords(region, place), ...problemOf(asked, "search"), ...fixedDesign };
  });
  return atLevel({ regions: problems, ...SEARCH, session }, "designs", accuracy);
}

/** The request for a design's profile at the samples of the state's target. */
export function profileRequest(state: ProfileKind & Pick<DesignState, "points">, found: TilingDesign, made: Specification): ProfileRequest {
  const { points } = state;
  const { material, orientation } = specificationFields(withFoundValues(made, found));
  return {
    ...(kindOf(state) as Pick<ProfileRequest, "task" | "direction" | "strain" | "strain_measure">),
    family: found.family,
    parameters: [...found.parameters],
    ...({ ...(material && { material }), ...(orientation !== undefined && { orientation }) } as Pick<ProfileRequest, "material" | "orientation">),
    ...((isPolar(state.task) || points.length > 1) && { samples: samplesOf(state) }),
    ...(!isPolar(state.task) && points.length > 1 && { range: [points[0][0], points[points.length - 1][0]] }),
  };
}

/** The request for the measures of a design's structure. */
export function structureRequest(found: TilingDesign, { size }: Specification): StructureRequest {
  return { family: found.family, parameters: [...found.parameters], ...(size.kind === "beam_width" && { beam_width: size.value }) };
}

/** What goes first on a busy server: what somebody waits for, or what was begun without being asked for. */
export type Priority = "normal" | "background";

/** The request to simulate the shown design at its native scale along the profile of the target. Its parameters are fixed. */
export function verificationRequest(state: DesignState, found: TilingDesign, priority: Priority = "normal"): DesignRequest {
  return {
    ...designRequest({ ...state, made: withFoundValues(state.made, found), family: found.family, found, fixed: [] }, "follow", "unused"),
    fixed: [...found.parameters],
    verify: true,
    effects: { multi_start: "off", envelope: "off", ways_out: "off" },
    accuracy: { verified_samples: VERIFIED_SAMPLES },
    session: undefined,
    ...(priority !== "normal" && { priority }),
  } as DesignRequest;
}

/** The request to correct the shown design by simulations until they follow the target. Fixed parameters stay. */
export function polishRequest(state: DesignState, found: TilingDesign): DesignRequest {
  return {
    ...designRequest({ ...state, family: found.family, found }, "search", "unused"),
    effects: { multi_start: "off", envelope: "off", polish: "on", ways_out: "off" },
    accuracy: { verified_samples: VERIFIED_SAMPLES },
    session: undefined,
  } as DesignRequest;
}

/** The request for what would bring a design to a target that is missed. It has no session, so that no search replaces it or is replaced by it. */
export function waysOutRequest(state: DesignState): DesignRequest {
  return {
    ...designRequest(state, "search", "unused"),
    effects: { multi_start: "automatic", envelope: "off", ways_out: "on" },
    session: undefined,
    priority: "background",
  } as DesignRequest;
}

/** Direction of the load in radians, from the x axis of the tiling, which may be rotated. */
export function patchDirection({ task, direction, made }: DesignState, found: TilingDesign): number {
  return (isPolar(task) ? 0 : direction) - orientationOf(made, found);
}

/** The mesh is uniform and not refined, since the result is a picture, unless its error is to be known. */
const PATCH_SETTINGS: Record<AccuracyChoice["level"], Pick<SimulationRequest, "accuracy" | "effects">> = {
  draft: { accuracy: { mesh_size: 1 }, effects: { refinement: "off" } },
  normal: { accuracy: { mesh_size: 0.5 }, effects: { refinement: "off" } },
  own: { accuracy: { mesh_size: 0.5 }, effects: { refinement: "off" } },
  sure: { accuracy: { mesh_size: 0.5 } },
};

/** The request to simulate the deformed patch: from rest to the largest strain, then from rest to the smallest. */
export function patchRequest(state: DesignState, found: TilingDesign): SimulationRequest {
  const strains = isPolar(state.task) ? [state.strain] : state.points.map((point) => point[0]);
  const toStretch = (strain: number) => 1 + (state.measure === "engineering" ? strain : convertedStrain(strain, "engineering"));
  const path = (end: number) => Array.from({ length: PATCH_STATES }, (_, k) => toStretch((end * (k + 1)) / PATCH_STATES));
  const [smallest, largest] = [Math.min(...strains), Math.max(...strains)];
  const modulus = modulusOf(state.made, found);
  const stretches = [1, ...(largest > 0 ? path(largest) : []), ...(smallest < 0 ? path(smallest) : [])];
  return {
    family: found.family,
    parameters: [...found.parameters],
    ...(modulus !== DEFAULT_SPECIFICATION.youngsModulus && { material: { youngs_modulus: modulus } }),
    load: { uniaxial: { direction: patchDirection(state, found), frame: "material", stretches } },
    tangents: false,
    deformed: "json",
    ...PATCH_SETTINGS[state.accuracy.level],
  } as SimulationRequest;
}

/** Path of the server's file of a structure. */
export function structurePath(found: TilingDesign, format: "svg" | "dxf" | "stl", cells: readonly [number, number], beamWidth: number | null = null): string {
  const parameters = found.parameters.map((value) => String(value)).join(",");
  const width = beamWidth === null || beamWidth === DEFAULT_SPECIFICATION.size.value ? "" : `&beam_width=${beamWidth}`;
  return `/v1/families/${encodeURIComponent(found.family)}/structure?parameters=${parameters}${width}&cells=${cells.join(",")}&format=${format}`;
}
