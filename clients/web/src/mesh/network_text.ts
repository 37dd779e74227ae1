// Points and springs as text in fields, and the state of a network in a link.
import { plain } from "../base/format";
import type { EffectSwitch } from "../contract/types";
import { readHost, writeHost } from "./host_text";
import { DEFAULT_NETWORK, type DrawnSpring, ELEMENTS, hasMembrane, METHODS, MAX_ITERATIONS, type NetworkState, POINT_SOURCES, SPRING_SOURCES, withExistingPoints } from "./network_state";

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

/** The fields of a network in a link. */
export function writeNetwork(state: NetworkState): string {
  const { points, radius, seed, springs, restLength, weight, method, springLength, tolerance, maxIterations, mollifier, mollifierLength, keptStrips, elements } = state;
  const membrane = [elements, ...[state.youngsModulus, state.poissonRatio, state.thickness, state.restScale].map(plain)];
  const fields = [points, plain(radius), seed, springs, plain(restLength), plain(weight), method, springLength, plain(tolerance), maxIterations, mollifier, plain(mollifierLength), keptStrips, ...(hasMembrane(state) ? membrane : [])];
  const lists = [state.fixed.length > 0 && `fixed=${state.fixed.join(",")}`, state.drawn.length > 0 && `springs=${writeSprings(state.drawn).replace(/ /g, "")}`];
  return [`network=${fields.join(",")}`, ...lists.filter((text) => text !== false), ...writeHost(state.host)].join("&");
}

/** The network from the fields of a link, with defaults for missing and invalid values; null if the link has no network. */
export function readNetwork(fields: ReadonlyMap<string, string>, picked: number): NetworkState | null {
  const values = fields.get("network")?.split(",");
  if (!values) return null;
  const [points, radius, seed, springs, restLength, weight, method, springLength, tolerance, maxIterations, mollifier, mollifierLength, keptStrips, elements, youngsModulus, poissonRatio, thickness, restScale] = values;
  const defaults = DEFAULT_NETWORK;
  const number = (text: string | undefined, lower: number, upper: number, otherwise: number) => {
    const value = Number(text);
    return text && value >= lower && value <= upper ? value : otherwise;
  };
  const state: NetworkState = {
    points: oneOf(POINT_SOURCES, points, defaults.points),
    radius: number(radius, 1e-12, 1e12, defaults.radius),
    seed: Math.round(number(seed, 0, 2 ** 31 - 1, defaults.seed)),
    springs: oneOf(SPRING_SOURCES, springs, defaults.springs),
    restLength: number(restLength, 0, 1e12, defaults.restLength),
    weight: number(weight, 0, 1e12, defaults.weight),
    method: oneOf(METHODS, method, defaults.method),
    elements: oneOf(ELEMENTS, elements, defaults.elements),
    youngsModulus: number(youngsModulus, 1e-12, 1e12, defaults.youngsModulus),
    poissonRatio: number(poissonRatio, -0.99, 0.4999, defaults.poissonRatio),
    thickness: number(thickness, 1e-12, 1e12, defaults.thickness),
    restScale: number(restScale, 1e-6, 1e6, defaults.restScale),
    springLength: springLength === "euclidean" && !hasMembrane({ elements: oneOf(ELEMENTS, elements, "springs") }) ? "euclidean" : "geodesic",
    tolerance: number(tolerance, 1e-16, 1, defaults.tolerance),
    maxIterations: Math.round(number(maxIterations, 1, MAX_ITERATIONS, defaults.maxIterations)),
    mollifier: oneOf(SWITCHES, mollifier, "automatic"),
    mollifierLength: number(mollifierLength, 1e-12, 0.5, defaults.mollifierLength),
    keptStrips: oneOf(SWITCHES, keptStrips, "automatic"),
    fixed: readFixed(fields.get("fixed") ?? "") ?? [],
    drawn: readSprings(fields.get("springs") ?? "") ?? [],
    host: readHost(fields),
  };
  return withExistingPoints(state, state.points === "picked" ? picked : MAX_POINTS);
}

function oneOf<Value extends string>(values: readonly Value[], text: string | undefined, otherwise: Value): Value {
  return values.find((value) => value === text) ?? otherwise;
}
