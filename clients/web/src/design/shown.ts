// The responses of a design to its targets, in the form that plot, cards and exports show. They are made from several kinds of answers.
import type { Design, DesignCandidate, DesignProfile, DesignStop, Effect, Model, PartialDesign, Profile, StructureAnswer } from "../contract/types";
import { foundSpecification, isRange, searchesModulus, type Specification, materialOf, modulusOf, orientationOf, sameSpecification } from "./specification";
import { type TilingDesign, isPolar, type ProfileKind, sameProfile, type Region, type Target } from "./state";
import { relativeDeviation, targetCurve } from "./spline";
import { askedOrder, sameTargets, targetOf, targetsOf } from "./target_list";
import { toleranceOf } from "./verdict_ranges";
import type { Grade, Source } from "./verdict_words";

export interface Band {
  readonly x: readonly number[];
  readonly lower: readonly number[];
  readonly upper: readonly number[];
}

export interface Envelope extends ProfileKind, Band {
  readonly family: string;
}

/** The requirements on a design. */
export interface Requirements {
  /** In the order of the tabs. */
  readonly targets: readonly Target[];
  readonly made: Specification;
}

/** Material, orientation and dimensions of a design; null for values that are not known. */
export interface Measures {
  /** Name of the material; empty if there is only one. */
  readonly material: string;
  /** In MPa; null while a search has not chosen it. */
  readonly youngsModulus: number | null;
  /** Density of the material, in g/cm^3. */
  readonly materialDensity: number;
  /** In radians. */
  readonly orientation: number;
  /** In mm. */
  readonly beamWidth: number | null;
  /** In mm. */
  readonly cellSize: number | null;
  readonly relativeDensity: number | null;
  /** Density of the structure including its holes, in g/cm^3. */
  readonly density: number | null;
}

/** The verdict of an answer, which the server has made by the page's rules and with its words. */
export interface AnsweredVerdict {
  readonly grade: Grade;
  readonly source: Source;
  /** Deviation from the worst target; null if a value is missing. */
  readonly deviation: number | null;
  readonly sentence: string;
}

/** The nearest that any material comes to a target at rest; to all targets of the design together, where there are several. */
export interface NearestPossible {
  /** Relative root mean square deviation from the target. */
  readonly deviation: number;
  readonly x: readonly number[];
  readonly y: readonly number[];
  /** What no material can have at rest of the design's targets, in the server's words; empty if some material reaches them. */
  readonly sentence: string;
}

/** The response of a design to one of its targets. */
export interface TargetResponse extends Target, Requirements {
  readonly found: TilingDesign;
  readonly model: string;
  readonly measures: Measures;
  readonly x: readonly number[];
  readonly achieved: readonly (number | null)[];
  /** Largest difference from a simulated value in 90 of 100 cases; null if it is not known. */
  readonly errorBar: readonly (number | null)[] | null;
  /** The target at the samples. */
  readonly target: readonly number[];
  /** Whether the model is trusted at each sample. */
  readonly inRange: readonly boolean[];
  /** Whether each sample of the target is reached. */
  readonly reached: readonly boolean[];
  /** Relative root mean square deviation from this target. */
  readonly deviation: number;
  /** Weighted deviation from all targets. */
  readonly overall: number;
  /** Largest absolute deviation from this target, in the unit of y. */
  readonly largest: number;
  readonly message: string;
  readonly stopped: DesignStop | null;
  readonly iterations: number;
  readonly ranking: readonly DesignCandidate[];
  readonly seconds: number;
  readonly byHand: boolean;
  /** Whether the search is running and this is its best design so far. */
  readonly provisional: boolean;
  /** Optional parts of the computation. */
  readonly effects?: readonly Effect[];
  /** Null for profiles that have no bound, and where no search has told it. */
  readonly bound: NearestPossible | null;
  /** The server's verdict on the design; null for one that was set by hand or is not final. */
  readonly answered: AnsweredVerdict | null;
}

/** Deviations of Poisson's ratio are relative to at least this value, since a target of zeros has no scale. */
const MIN_POISSON = 0.1;

/** Relative error of a model on designs that it was not trained with: the mean, and the 99th percentile of the states. */
export interface ModelError {
  readonly mean: number;
  readonly percentile99: number;
}

/** The error of a model; null if it is not known, and for Poisson's ratio, because it is the error of the stress. */
export function modelError(model: Model | undefined, { task }: ProfileKind): ModelError | null {
  const error = model?.errors.design_split?.gradient;
  return error && task !== "poisson" ? { mean: error.mean, percentile99: error.percentile_99 } : null;
}

/**
 * The expected deviation of a simulation, which ranks families: a deviation far below the error of the model does not describe the
 * structure. An unknown error counts as 100 %.
 */
export function expectedDeviation({ error, model_error }: DesignCandidate): number {
  return Math.hypot(error.relative_rms, model_error ?? 1);
}

/** The error to be expected of the deviation by the model, over the target's root mean square; null if the model has no error bars. */
export function modelUncertainty({ errorBar, target }: Pick<TargetResponse, "errorBar" | "target">): number | null {
  if (!errorBar || errorBar.length === 0 || !errorBar.every((bar): bar is number => bar !== null)) return null;
  const size = Math.hypot(...target);
  return size > 0 ? Math.hypot(...errorBar) / size : null;
}

/**
 * The band in which a simulation is expected: the error bars on either side of the profile, or the mean error for a model without
 * error bars. Null if the profile has gaps, or if no error is known.
 */
export function errorBand({ x, achieved, errorBar }: TargetResponse, error: ModelError | null): Band | null {
  const known = achieved.filter((y): y is number => y !== null);
  if (known.length < achieved.length) return null;
  const halfWidths = errorBar ?? (error && known.map((y) => Math.abs(y) * error.mean));
  if (!halfWidths?.every((bar): bar is number => bar !== null)) return null;
  return { x, lower: known.map((y, k) => y - halfWidths[k]), upper: known.map((y, k) => y + halfWidths[k]) };
}

/** The fields of the kind, without the others of an object. */
export function kindOf({ task, direction, strain, measure }: ProfileKind): ProfileKind {
  return { task, direction, strain, measure };
}

/** The requirements of a region. */
export function requirementsOf(state: Region): Requirements {
  return { targets: targetsOf(state), made: state.made };
}

export function sameRequirements(a: Requirements, b: Requirements): boolean {
  return sameTargets(a.targets, b.targets) && sameSpecification(a.made, b.made);
}

export function sameTilingDesign(a: TilingDesign, b: TilingDesign): boolean {
  const sameParameters = a.parameters.length === b.parameters.length && a.parameters.every((value, k) => value === b.parameters[k]);
  return a.family === b.family && sameParameters && a.material === b.material && a.youngsModulus === b.youngsModulus && a.orientation === b.orientation;
}

/**
 * Whether a response belongs to the present state. `outdated`: it is of an earlier target or of earlier parameters. `other`: it is of
 * another kind of profile or of another family, and must not be shown with the state.
 */
export type Freshness = "current" | "outdated" | "other";

export function freshness(shown: TargetResponse | null, state: Region): Freshness {
  if (!shown || !sameProfile(shown, state) || shown.found.family !== state.found?.family) return "other";
  return shown.points === state.points && sameRequirements(shown, requirementsOf(state)) && sameTilingDesign(shown.found, state.found) ? "current" : "outdated";
}

/** A design of an answer, the only one or that of a region, with the cost of the computation. */
export type CostedDesign = Design & { readonly cost: { readonly seconds: number }; readonly effects?: readonly Effect[] };

/** The design of an answer, with the values that the search has chosen. */
export function designOf(
  { family, parameters, material, orientation }: Pick<Design, "family" | "parameters" | "orientation" | "material">,
  { made }: Pick<Region, "made">,
): TilingDesign {
  return { family, parameters, ...foundSpecification(made, material, orientation) };
}

/** The measures of a design whose structure is not known: only the given beam width or cell size is set. */
function estimatedMeasures(made: Specification, found: TilingDesign): Measures {
  const { size } = made;
  const { name, density } = materialOf(made, found);
  const isKnown = !searchesModulus(made) || found.youngsModulus !== undefined;
  return {
    material: isKnown ? name : "",
    youngsModulus: isKnown ? modulusOf(made, found) : null,
    materialDensity: density,
    orientation: orientationOf(made, found),
    beamWidth: size.kind === "beam_width" ? size.value : null,
    cellSize: size.kind === "cell_size" ? size.value : null,
    relativeDensity: null,
    density: null,
  };
}

/** The measures of a design with its structure, scaled to the given beam width or cell size. */
function structureMeasures(made: Specification, found: TilingDesign, structure: StructureAnswer): Measures {
  const known = estimatedMeasures(made, found);
  const { beam_width, cell_area, relative_density } = structure;
  const scale = made.size.value / (made.size.kind === "beam_width" ? beam_width : Math.sqrt(cell_area));
  return {
    ...known,
    beamWidth: scale * beam_width,
    cellSize: scale * Math.sqrt(cell_area),
    relativeDensity: relative_density,
    density: relative_density * known.materialDensity,
  };
}

function measuresOf({ material, orientation, structure }: CostedDesign): Measures {
  return {
    material: material.name ?? "",
    youngsModulus: material.youngs_modulus,
    materialDensity: material.density,
    orientation,
    beamWidth: structure?.beam_width ?? null,
    cellSize: structure?.cell_size ?? null,
    relativeDensity: structure?.relative_density ?? null,
    density: structure?.density ?? null,
  };
}

function nearestPossible({ verdict }: CostedDesign, { x, bound }: DesignProfile): NearestPossible | null {
  const nearest = bound && (bound.together ?? bound);
  return nearest ? { deviation: nearest.deviation, x, y: nearest.y, sentence: verdict.bound } : null;
}

/** The response to a target with what an earlier search has told of the same target and its material. */
export function withBoundOf(response: TargetResponse, before: TargetResponse | null): TargetResponse {
  return response.bound === null && before && sameRequirements(before, response) ? { ...response, bound: before.bound } : response;
}

/** The responses of a design that was found, to all targets in the order of the tabs. */
export function designResponses(answer: CostedDesign, asked: Region): readonly TargetResponse[] {
  const targets = targetsOf(asked);
  const profiles = [answer.profile, ...answer.also];
  const order = askedOrder(asked);
  return targets.map((target, place): TargetResponse => {
    const profile = profiles[order.indexOf(place)];
    const compared = comparison(profile.x, profile.achieved, target);
    return {
      ...target,
      targets,
      made: asked.made,
      found: designOf(answer, asked),
      model: answer.model,
      measures: measuresOf(answer),
      x: profile.x,
      achieved: profile.achieved,
      errorBar: profile.error_bar,
      target: profile.target,
      inRange: profile.in_range,
      reached: profile.reached,
      deviation: targets.length === 1 ? answer.error.relative_rms : compared.deviation,
      overall: answer.error.relative_rms,
      largest: place === asked.at ? answer.error.max : compared.largest,
      message: answer.message,
      stopped: answer.stopped,
      iterations: answer.iterations,
      ranking: answer.ranking,
      seconds: answer.cost.seconds,
      byHand: false,
      provisional: false,
      ...(answer.effects && { effects: answer.effects }),
      bound: nearestPossible(answer, profile),
      answered: (answer as { verdict?: AnsweredVerdict }).verdict ?? null,
    };
  });
}

/** The responses of a design with given parameters, from its profiles for all targets in the order of the tabs. `structure`: null if the parameters give none. */
export function profileResponses(profiles: readonly Profile[], asked: Region, structure: StructureAnswer | null = null): readonly TargetResponse[] {
  const targets = targetsOf(asked);
  const compared = targets.map((target, place) => comparison(profiles[place].x, profiles[place].y, target));
  const overall = overallDeviation(compared.map(({ deviation }, place) => ({ deviation, weight: targets[place].weight })));
  return targets.map((target, place): TargetResponse => {
    const profile = profiles[place];
    // The requested design is used, because it has the values that a search has found besides the parameters.
    const found = asked.found ?? { family: profile.family, parameters: profile.parameters };
    return {
      ...target,
      targets,
      made: asked.made,
      found,
      model: profile.model,
      measures: structure ? structureMeasures(asked.made, found, structure) : estimatedMeasures(asked.made, found),
      ...compared[place],
      overall,
      errorBar: profile.error_bar,
      inRange: profile.in_range,
      message: profile.y.includes(null) ? "In some samples no equilibrium was found." : "",
      stopped: null,
      iterations: 0,
      ranking: [],
      seconds: profiles.reduce((sum, { cost }) => sum + cost.seconds, 0),
      byHand: true,
      provisional: false,
      bound: null,
      answered: null,
    };
  });
}

/** The response of the best design so far of a running search, to the target that was selected when the search began. */
export function partialResponse(partial: PartialDesign, asked: Region): TargetResponse {
  const { family, parameters, orientation } = partial;
  const found: TilingDesign = { family, parameters, ...(isRange(asked.made.orientation) && { orientation }) };
  return {
    ...targetOf(asked),
    ...requirementsOf(asked),
    found,
    model: partial.model,
    measures: estimatedMeasures(asked.made, found),
    ...comparison(partial.x, partial.achieved, asked),
    overall: partial.error.relative_rms,
    errorBar: null,
    inRange: partial.x.map(() => true),
    message: "",
    stopped: null,
    iterations: partial.iteration,
    ranking: [],
    seconds: 0,
    byHand: false,
    provisional: true,
    bound: null,
    answered: null,
  };
}

/** The deviation from all targets, as a search computes it: the weighted root mean square. */
export function overallDeviation(all: readonly { deviation: number; weight: number }[]): number {
  const totalWeight = all.reduce((sum, { weight }) => sum + weight, 0);
  return Math.sqrt(all.reduce((sum, { deviation, weight }) => sum + weight * deviation * deviation, 0) / totalWeight);
}

/** A profile compared with its target, sample by sample. */
function comparison(x: readonly number[], y: readonly (number | null)[], asked: Target): Pick<TargetResponse, "x" | "achieved" | "target" | "reached" | "deviation" | "largest"> {
  const target = x.map(targetCurve(isPolar(asked.task), asked.points, asked.interpolation));
  const tolerance = toleranceOf({ task: asked.task, target });
  const deviations = y.map((value, k) => (value === null ? Infinity : Math.abs(value - target[k])));
  const finite = deviations.filter(Number.isFinite);
  return {
    x,
    achieved: y,
    target,
    reached: deviations.map((value) => value <= tolerance),
    deviation: relativeDeviation(y, target, asked.task === "poisson" ? MIN_POISSON : 0),
    largest: finite.length > 0 ? Math.max(...finite) : 0,
  };
}
