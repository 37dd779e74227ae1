// Points and springs as text in fields, and the state of a network in a link.
import { readChoice, writeChoice } from "../base/accuracy_choice";
import { plain } from "../base/format";
import { choiceOf, type Fields, numberOf, readValues, wholeOf, writeValues } from "../base/link_fields";
import type { EffectSwitch } from "../contract/types";
import { readHost, writeHost } from "./host_text";
import { DEFAULT_NETWORK, type DrawnSpring, ELEMENTS, hasMembrane, METHODS, MAX_ITERATIONS, type NetworkState, POINT_SOURCES, SPRING_SOURCES, usualLevel,
  withExistingPoints } from "./network_state";

const MAX_POINTS = 100_000;
const SWITCHES: readonly EffectSwitch[] = ["automatic", "on", "off"];

/** Points from a text such as "0, 5, 17", ascending; null if the text is invalid. */
export function readFixed(text: string): readonly number[] | null {
  const pieces = splitList(text);
  if (!pieces.every((piece) => /^\d{1,6}$/.test(piece))) return null;
  return [...new Set(pieces.map(Number))].sort((a, b) => a - b);
}

export function writeFixed(fixed: readonly number[]): string {
  return fixed.join(", ");
}

/** Springs from a text such as "0-1, 1-2:0.5:3": two points, with optional rest length and weight. Null if the text is invalid. */
export function readSprings(text: string): readonly DrawnSpring[] | null {
  const springs = new Map<string, DrawnSpring>();
  for (const piece of splitList(text)) {
    const match = /^(\d{1,6})\s*[-–]\s*(\d{1,6})(?::([\d.e+-]*))?(?::([\d.e+-]+))?$/.exec(piece);
    if (!match || match[1] === match[2]) return null;
    const [a, b] = [Number(match[1]), Number(match[2])].sort((x, y) => x - y);
    const [restLength, weight] = [match[3], match[4]].map((value) => (value ? Number(value) : undefined));
    if ([restLength, weight].some((value) => value !== undefined && !(value >= 0 && value < Infinity))) return null;
    springs.set(`${a}-${b}`, { between: [a, b], ...(restLength !== undefined && { restLength }), ...(weight !== undefined && { weight }) });
  }
  return [...springs.values()];
}

export function writeSprings(springs: readonly DrawnSpring[]): string {
  return springs
    .map(({ between, restLength, weight }) => {
      const values = weight !== undefined ? [restLength, weight] : restLength !== undefined ? [restLength] : [];
      return [between.join("-"), ...values.map((value) => (value === undefined ? "" : plain(value)))].join(":");
    })
    .join(", ");
}

function splitList(text: string): string[] {
  return text.split(/[,;\n]/).map((piece) => piece.trim()).filter((piece) => piece !== "");
}

/** Values of a network in a link, in the order in which the links of version 0.1 have them. */
const NETWORK_VALUES = ["points", "radius", "seed", "springs", "rest-length", "weight", "method", "spring-length", "tolerance", "max-iterations", "mollifier", "mollifier-length",
  "kept-strips", "elements", "youngs-modulus", "poisson-ratio", "thickness", "rest-scale"];

/** The fields of a network in a link. */
export function writeNetwork(state: NetworkState): [string, string][] {
  const { points, radius, seed, springs, restLength, weight, method, springLength, tolerance, maxIterations, mollifier, mollifierLength, keptStrips, elements } = state;
  const { youngsModulus, poissonRatio, thickness, restScale } = state;
  const membrane = { elements, "youngs-modulus": youngsModulus, "poisson-ratio": poissonRatio, thickness, "rest-scale": restScale };
  const values = writeValues({
    points,
    radius,
    seed,
    springs,
    "rest-length": restLength,
    weight,
    method,
    "spring-length": springLength,
    tolerance,
    "max-iterations": maxIterations,
    mollifier,
    "mollifier-length": mollifierLength,
    "kept-strips": keptStrips,
    ...(hasMembrane(state) && membrane),
  });
  const fields: [string, string][] = [["network", values], ...writeChoice(state.accuracy, usualLevel(state))];
  if (state.fixed.length > 0) fields.push(["fixed", state.fixed.join(",")]);
  if (state.drawn.length > 0) fields.push(["springs", writeSprings(state.drawn).replace(/ /g, "")]);
  return [...fields, ...writeHost(state.host)];
}

/** The network from the fields of a link, with defaults for missing and invalid values; null if the link has no network. */
export function readNetwork(fields: Fields, picked: number): NetworkState | null {
  const text = fields.get("network");
  if (text === undefined) return null;
  const values = readValues(text, NETWORK_VALUES);
  const defaults = DEFAULT_NETWORK;
  const number = (name: string, lower: number, upper: number, otherwise: number) => numberOf(values.get(name), lower, upper, otherwise);
  const elements = choiceOf(values.get("elements"), ELEMENTS, defaults.elements);
  const own = { tolerance: number("tolerance", 1e-16, 1, defaults.tolerance), mollifierLength: number("mollifier-length", 1e-12, 0.5, defaults.mollifierLength) };
  const state: NetworkState = {
    points: choiceOf(values.get("points"), POINT_SOURCES, defaults.points),
    radius: number("radius", 1e-12, 1e12, defaults.radius),
    seed: wholeOf(values.get("seed"), 0, 2 ** 31 - 1, defaults.seed),
    springs: choiceOf(values.get("springs"), SPRING_SOURCES, defaults.springs),
    restLength: number("rest-length", 0, 1e12, defaults.restLength),
    weight: number("weight", 0, 1e12, defaults.weight),
    method: choiceOf(values.get("method"), METHODS, defaults.method),
    elements,
    youngsModulus: number("youngs-modulus", 1e-12, 1e12, defaults.youngsModulus),
    poissonRatio: number("poisson-ratio", -0.99, 0.4999, defaults.poissonRatio),
    thickness: number("thickness", 1e-12, 1e12, defaults.thickness),
    restScale: number("rest-scale", 1e-6, 1e6, defaults.restScale),
    springLength: values.get("spring-length") === "euclidean" && !hasMembrane({ elements }) ? "euclidean" : "geodesic",
    ...own,
    accuracy: readChoice(fields, usualLevel(own)),
    maxIterations: wholeOf(values.get("max-iterations"), 1, MAX_ITERATIONS, defaults.maxIterations),
    mollifier: choiceOf(values.get("mollifier"), SWITCHES, "automatic"),
    keptStrips: choiceOf(values.get("kept-strips"), SWITCHES, "automatic"),
    fixed: readFixed(fields.get("fixed") ?? "") ?? [],
    drawn: readSprings(fields.get("springs") ?? "") ?? [],
    host: readHost(fields),
  };
  return withExistingPoints(state, state.points === "picked" ? picked : MAX_POINTS);
}
