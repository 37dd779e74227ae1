// What the plot, the cards and the exports show: answers of the server in one form.
import type { Design, DesignCandidate, DesignStop, Model, PartialDesign, Profile, StructureAnswer } from "../contract/types";
import { foundMade, isRange, leavesModulus, type Made, materialOf, modulusOf, orientationOf, sameMade } from "./made";
import { type Found, isPolar, type ProfileKind, sameProfile, type Region, type Target } from "./state";
import { relativeDeviation, targetCurve } from "./spline";
import { askedOrder, sameTargets, targetOf, targetsOf } from "./target_list";

export interface Band {
  readonly x: readonly number[];
  readonly lower: readonly number[];
  readonly upper: readonly number[];
}

export interface Envelope extends ProfileKind, Band {
  readonly family: string;
}

/** What is wanted of a design. */
export interface Wanted {
  /** In the order of their tabs. */
  readonly targets: readonly Target[];
  readonly made: Made;
}

/** What a design is made of, how it lies and what it measures; null where nobody has measured it. */
export interface Measures {
  /** Name of the material, of several. */
  readonly material: string;
  /** In MPa; null while a search has not told which of several it is. */
  readonly youngsModulus: number | null;
  /** Of the material, in g/cm^3. */
  readonly materialDensity: number;
  /** In radians. */
  readonly orientation: number;
  /** In mm. */
  readonly beamWidth: number | null;
  /** In mm. */
  readonly cellSize: number | null;
  readonly relativeDensity: number | null;
  /** Of the structure with its holes, in g/cm^3. */
  readonly density: number | null;
}

/** What a design does about one of its targets. */
export interface Shown extends Target, Wanted {
  readonly found: Found;
  readonly model: string;
  readonly measures: Measures;
  readonly x: readonly number[];
  readonly achieved: readonly (number | null)[];
  /** The simulated value differs by no more, in 90 of 100 cases; null where nobody can say. */
  readonly errorBar: readonly (number | null)[] | null;
  /** The wanted curve at the samples. */
  readonly target: readonly number[];
  readonly inRange: readonly boolean[];
  /** Which samples of the target are reached. */
  readonly reached: readonly boolean[];
  /** Of this target. */
  readonly deviation: number;
  /** Of all targets together, with their weights. */
  readonly overall: number;
  /** Largest deviation, in the unit of y. */
  readonly largest: number;
  readonly message: string;
  readonly stopped: DesignStop | null;
  readonly iterations: number;
  readonly ranking: readonly DesignCandidate[];
  readonly seconds: number;
  readonly byHand: boolean;
  /** A search still runs; this is its best so far. */
  readonly provisional: boolean;
}

/** Poisson's ratio is compared with at least this: a target of zeros has no size. */
const LEAST_POISSON = 0.1;
/** A sample counts as reached within this share of the target's root mean square. */
const REACHED = 0.01;

/** What a model is off by, as a share: in the mean and of 99 in 100 states of designs that it has not seen. */
export interface ModelError {
  readonly mean: number;
  readonly percentile99: number;
}

/** Null where the model does not know, and for Poisson's ratio, of which an error of the stress says little. */
export function modelError(model: Model | undefined, { task }: ProfileKind): ModelError | null {
  const error = model?.errors.design_split?.gradient;
  return error && task !== "poisson" ? { mean: error.mean, percentile99: error.percentile_99 } : null;
}

/** By which families are ranked: a deviation far below the model's own error says nothing about the structure. */
export function expectedDeviation({ error, model_error }: DesignCandidate): number {
  return Math.hypot(error.relative_rms, model_error ?? 1);
}

/**
 * Where a simulation is to be expected: the error bars on either side of the profile, or for a model without them its
 * mean error. Null beside gaps.
 */
export function errorBand({ x, achieved, errorBar }: Shown, error: ModelError | null): Band | null {
  const known = achieved.filter((y): y is number => y !== null);
  if (known.length < achieved.length) return null;
  const away = errorBar ?? (error && known.map((y) => Math.abs(y) * error.mean));
  if (!away || !away.every((bar): bar is number => bar !== null)) return null;
  return { x, lower: known.map((y, k) => y - away[k]), upper: known.map((y, k) => y + away[k]) };
}

/** The kind alone, of what has more. */
export function kindOf({ task, direction, strain, measure }: ProfileKind): ProfileKind {
  return { task, direction, strain, measure };
}

/** What a state wants. */
export function wantedOf(state: Region): Wanted {
  return { targets: targetsOf(state), made: state.made };
}

export function sameWanted(a: Wanted, b: Wanted): boolean {
  return sameTargets(a.targets, b.targets) && sameMade(a.made, b.made);
}

export function sameFound(a: Found, b: Found): boolean {
  const sameParameters = a.parameters.length === b.parameters.length && a.parameters.every((value, k) => value === b.parameters[k]);
  return a.family === b.family && sameParameters && a.material === b.material && a.youngsModulus === b.youngsModulus && a.orientation === b.orientation;
}

/**
 * Whether an answer belongs to what was decided. `other`: it is of another kind of profile or of another family, and
 * may not stand beside what is decided now. `outdated`: it is of an earlier target or of earlier parameters.
 */
export type Freshness = "current" | "outdated" | "other";

export function freshness(shown: Shown | null, state: Region): Freshness {
  if (!shown || !sameProfile(shown, state) || shown.found.family !== state.found?.family) return "other";
  return shown.points === state.points && sameWanted(shown, wantedOf(state)) && sameFound(shown.found, state.found) ? "current" : "outdated";
}

/** A design that was found, by itself or as one of several regions. */
export type FoundDesign = Design & { readonly cost: { readonly seconds: number } };

/** The design of an answer, with what had been left to the search. */
export function foundOf({ family, parameters, material, orientation }: Pick<Design, "family" | "parameters" | "orientation" | "material">, { made }: Pick<Region, "made">): Found {
  return { family, parameters, ...foundMade(made, material, orientation) };
}

/** What is known of a design without its structure: beams have the width that was given, all else follows from the structure. */
function unmeasured(made: Made, found: Found): Measures {
  const { size } = made;
  const { name, density } = materialOf(made, found);
  const isKnown = !leavesModulus(made) || found.youngsModulus !== undefined;
  return {
    material: isKnown ? name : "", youngsModulus: isKnown ? modulusOf(made, found) : null, materialDensity: density, orientation: orientationOf(made, found),
    beamWidth: size.kind === "beam_width" ? size.value : null, cellSize: size.kind === "cell_size" ? size.value : null, relativeDensity: null, density: null,
  };
}

/** The same with its structure, whose beams may have any width: a structure scales. */
function measured(made: Made, found: Found, structure: StructureAnswer): Measures {
  const known = unmeasured(made, found);
  const { beam_width, cell_area, relative_density } = structure;
  const scale = made.size.value / (made.size.kind === "beam_width" ? beam_width : Math.sqrt(cell_area));
  return {
    ...known, beamWidth: scale * beam_width, cellSize: scale * Math.sqrt(cell_area),
    relativeDensity: relative_density, density: relative_density * known.materialDensity,
  };
}

function measuresOf({ material, orientation, structure }: FoundDesign): Measures {
  return {
    material: material.name ?? "", youngsModulus: material.youngs_modulus, materialDensity: material.density, orientation, beamWidth: structure?.beam_width ?? null, cellSize: structure?.cell_size ?? null,
    relativeDensity: structure?.relative_density ?? null, density: structure?.density ?? null,
  };
}

/** What a design that was found does, one for each target in the order of the tabs. */
export function shownDesigns(answer: FoundDesign, asked: Region): readonly Shown[] {
  const targets = targetsOf(asked);
  const profiles = [answer.profile, ...answer.also];
  const order = askedOrder(asked);
  return targets.map((target, place): Shown => {
    const profile = profiles[order.indexOf(place)];
    const compared = comparison(profile.x, profile.achieved, target);
    return {
      ...target,
      targets,
      made: asked.made,
      found: foundOf(answer, asked),
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
    };
  });
}

/** What a design of given parameters does: one profile for each target in the order of the tabs. `structure`: null where it has none. */
export function shownProfiles(profiles: readonly Profile[], asked: Region, structure: StructureAnswer | null = null): readonly Shown[] {
  const targets = targetsOf(asked);
  const compared = targets.map((target, place) => comparison(profiles[place].x, profiles[place].y, target));
  const overall = overallDeviation(compared.map(({ deviation }, place) => ({ deviation, weight: targets[place].weight })));
  return targets.map((target, place): Shown => {
    const profile = profiles[place];
    // The very one that was asked for, with what a search has found besides its parameters.
    const found = asked.found ?? { family: profile.family, parameters: profile.parameters };
    return {
      ...target,
      targets,
      made: asked.made,
      found,
      model: profile.model,
      measures: structure ? measured(asked.made, found, structure) : unmeasured(asked.made, found),
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
    };
  });
}

/** The best that a search has found so far, against the target in sight when it was asked: nothing of it is of an earlier answer. */
export function shownPartial(partial: PartialDesign, asked: Region): Shown {
  const { family, parameters, orientation } = partial;
  const found: Found = { family, parameters, ...(isRange(asked.made.orientation) && { orientation }) };
  return {
    ...targetOf(asked),
    ...wantedOf(asked),
    found,
    model: partial.model,
    measures: unmeasured(asked.made, found),
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
  };
}

/** As a search weighs the deviations of several targets: the root of their mean square, each as often as its weight says. */
export function overallDeviation(all: readonly { deviation: number; weight: number }[]): number {
  const whole = all.reduce((sum, { weight }) => sum + weight, 0);
  return Math.sqrt(all.reduce((sum, { deviation, weight }) => sum + weight * deviation * deviation, 0) / whole);
}

/** A profile beside the target that was asked for, sample by sample. */
function comparison(x: readonly number[], y: readonly (number | null)[], asked: Target): Pick<Shown, "x" | "achieved" | "target" | "reached" | "deviation" | "largest"> {
  const target = x.map(targetCurve(isPolar(asked.task), asked.points, asked.interpolation));
  const size = Math.sqrt(target.reduce((sum, value) => sum + value * value, 0) / target.length);
  const away = y.map((value, k) => (value === null ? Infinity : Math.abs(value - target[k])));
  const finite = away.filter(Number.isFinite);
  return {
    x,
    achieved: y,
    target,
    reached: away.map((value) => value <= REACHED * size),
    deviation: relativeDeviation(y, target, asked.task === "poisson" ? LEAST_POISSON : 0),
    largest: finite.length > 0 ? Math.max(...finite) : 0,
  };
}
