// The state in a link: readable, short, and checked when it comes back from a stranger.
import { plain } from "../base/format";
import { type ControlPoint, DEFAULT_STATE, type DesignState, isPolar, TASKS } from "./state";
import { fewestPoints } from "./targets";

const MOST_NUMBERS = 64;
const LARGEST = 1e6;

export function writeLink(state: DesignState): string {
  const fields: [string, string][] = [
    ["task", state.task],
    ["family", state.family],
    isPolar(state.task) ? ["strain", plain(state.strain)] : ["direction", plain(state.direction)],
    ["measure", state.measure],
    ["curve", state.interpolation],
    ["points", state.points.map((point) => point.map(plain).join(",")).join(";")],
  ];
  if (state.found) {
    fields.push(["design", state.found.family], ["parameters", state.found.parameters.map(plain).join(",")]);
    if (state.fixed.some(Boolean)) fields.push(["fixed", state.fixed.map(Number).join(",")]);
    if (state.byHand) fields.push(["hand", "1"]);
  }
  return fields.map(([name, value]) => `${name}=${value}`).join("&");
}

/** The state of a link; null where it is none. */
export function readLink(text: string): DesignState | null {
  const fields = new Map(
    text.split("&").map((field): [string, string] => {
      const equals = field.indexOf("=");
      return [field.slice(0, equals), decode(field.slice(equals + 1))];
    }),
  );
  const task = TASKS.find((name) => name === fields.get("task"));
  if (!task) return null;
  const points = readPoints(fields.get("points") ?? "", isPolar(task));
  if (!points || points.length < fewestPoints(task)) return null;
  const family = fields.get("family") ?? DEFAULT_STATE.family;
  const design = fields.get("design");
  const parameters = numbers(fields.get("parameters") ?? "", 32);
  if (!isName(family) || (design !== undefined && (!isName(design) || !parameters))) return null;
  const found = design && parameters ? { family: design, parameters } : null;
  return {
    task,
    points,
    interpolation: one(fields.get("curve"), ["cubic", "monotone", "linear"] as const, "cubic"),
    direction: number(fields.get("direction"), -1000, 1000, DEFAULT_STATE.direction),
    strain: number(fields.get("strain"), -0.49, 7.5, DEFAULT_STATE.strain),
    measure: one(fields.get("measure"), ["green", "engineering"] as const, "green"),
    family,
    found,
    fixed: found ? found.parameters.map((_, k) => fields.get("fixed")?.split(",")[k] === "1") : [],
    byHand: found !== null && fields.get("hand") === "1",
  };
}

function decode(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return "";
  }
}

function isName(text: string): boolean {
  return /^[A-Za-z0-9_-]{1,64}$/.test(text);
}

function numbers(text: string, most: number): number[] | null {
  const values = text.split(",").map(Number);
  const sound = text !== "" && values.length <= most && values.every((value) => Math.abs(value) <= LARGEST);
  return sound ? values : null;
}

function readPoints(text: string, polar: boolean): ControlPoint[] | null {
  const points = text.split(";").map((pair) => numbers(pair, 2));
  if (points.length > MOST_NUMBERS || points.some((point) => point?.length !== 2)) return null;
  const checked = points as unknown as ControlPoint[];
  const increasing = checked.every((point, k) => k === 0 || point[0] > checked[k - 1][0]);
  const width = checked[checked.length - 1][0] - checked[0][0];
  return increasing && (!polar || width < Math.PI) ? checked : null;
}

function number(text: string | undefined, lower: number, upper: number, otherwise: number): number {
  const value = text === undefined || text === "" ? NaN : Number(text);
  return value >= lower && value <= upper ? value : otherwise;
}

function one<Choice extends string>(text: string | undefined, choices: readonly Choice[], otherwise: Choice): Choice {
  return choices.find((choice) => choice === text) ?? otherwise;
}
