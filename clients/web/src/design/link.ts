// The state as the text of a link: short, readable, and checked when it is read, since links come from anywhere.
import { readChoice, writeChoice } from "../base/accuracy_choice";
import { plain } from "../base/format";
import { choiceOf, type Fields, numberOf, readFields, writeFields } from "../base/link_fields";
import { type FoundSpecification, isRange, searchesModulus, type Specification, writeSpecification, readSpecification } from "./specification";
import { type ControlPoint, DEFAULT_STATE, type DesignState, isPolar, type Region, type Target, TASKS, WEIGHT_LIMITS } from "./state";
import { MAX_REGION_NAME_LENGTH, MAX_REGIONS, regionsOf, withRegions } from "./region_list";
import { MAX_NAME_LENGTH, MAX_TARGETS, targetsOf, withTargets } from "./target_list";
import { minPoints } from "./targets";

const MAX_POINTS = 64;
const MAX_VALUE = 1e6;

export function writeLink(state: DesignState): string {
  const regions = regionsOf(state);
  const accuracy = writeChoice(state.accuracy);
  if (regions.length === 1) return [regionText(state), ...(accuracy.length > 0 ? [writeFields(accuracy)] : [])].join("&");
  const fields = regions.map((region, k) => [`region${k + 1}`, encodeURIComponent(regionText(region))] as const);
  return writeFields([...fields, ["region-tab", String(state.regionAt + 1)], ...accuracy]);
}

function regionText(state: Region): string {
  const targets = targetsOf(state);
  const fields: [string, string][] = targets.flatMap((target, k) => targetFields(target, k === 0 ? "" : String(k + 1)));
  if (targets.length > 1) fields.push(["tab", String(state.at + 1)]);
  if (state.region !== "") fields.push(["region", encodeURIComponent(state.region)]);
  fields.push(...writeSpecification(state.made), ["family", state.family]);
  if (state.found) {
    fields.push(["design", state.found.family], ["parameters", state.found.parameters.map(plain).join(",")]);
    const { material, youngsModulus, orientation } = state.found;
    if (state.made.materials.length > 0 && material !== undefined) fields.push(["found-material", encodeURIComponent(material)]);
    if (searchesModulus(state.made) && youngsModulus !== undefined) fields.push(["found-modulus", plain(youngsModulus)]);
    if (isRange(state.made.orientation) && orientation !== undefined) fields.push(["found-orientation", plain(orientation)]);
    if (state.fixed.some(Boolean)) fields.push(["fixed", state.fixed.map(Number).join(",")]);
    if (state.byHand) fields.push(["hand", "1"]);
  }
  return writeFields(fields);
}

/** The fields of a target. `suffix`: appended to the names of the fields; the number of a further target. */
function targetFields(target: Target, suffix: string): [string, string][] {
  const fields: [string, string][] = [
    ["task", target.task],
    isPolar(target.task) ? ["strain", plain(target.strain)] : ["direction", plain(target.direction)],
    ["measure", target.measure],
    ["curve", target.interpolation],
    ["points", target.points.map((point) => point.map(plain).join(",")).join(";")],
  ];
  if (target.name !== "") fields.push(["name", encodeURIComponent(target.name)]);
  if (target.weight !== 1) fields.push(["weight", plain(target.weight)]);
  return fields.map(([name, value]) => [name + suffix, value]);
}

/** The state of a link; null if the text is no valid link. */
export function readLink(text: string): DesignState | null {
  const fields = readFields(text);
  const regions: Region[] = [];
  for (let k = 0; k < MAX_REGIONS && fields.has(`region${k + 1}`); ++k) {
    const region = readRegion(readFields(fields.get(`region${k + 1}`) ?? ""));
    if (!region) return null;
    regions.push(region);
  }
  const accuracy = readChoice(fields);
  if (regions.length > 0) return { ...withRegions(regions, numberOf(fields.get("region-tab"), 1, regions.length, 1) - 1), accuracy };
  const only = readRegion(fields);
  return only && { ...withRegions([only], 0), accuracy };
}

function readRegion(fields: Fields): Region | null {
  const targets: Target[] = [];
  for (let k = 0; k < MAX_TARGETS && (k === 0 || fields.has(`task${k + 1}`)); ++k) {
    const target = readTarget(fields, k === 0 ? "" : String(k + 1));
    if (!target) return null;
    targets.push(target);
  }
  const family = fields.get("family") ?? DEFAULT_STATE.family;
  const design = fields.get("design");
  const parameters = numbers(fields.get("parameters") ?? "", 32);
  if (!isName(family) || (design !== undefined && (!isName(design) || !parameters))) return null;
  const made = readSpecification(fields);
  const found = design && parameters ? { family: design, parameters, ...readFoundSpecification(fields, made) } : null;
  return {
    ...withTargets(targets, numberOf(fields.get("tab"), 1, targets.length, 1) - 1),
    region: (fields.get("region") ?? "").trim().slice(0, MAX_REGION_NAME_LENGTH),
    made,
    family,
    found,
    fixed: found ? found.parameters.map((_, k) => fields.get("fixed")?.split(",")[k] === "1") : [],
    byHand: found !== null && fields.get("hand") === "1",
  };
}

function readFoundSpecification(fields: Fields, made: Specification): FoundSpecification {
  const read = (name: string) => numberOf(fields.get(name), -MAX_VALUE, MAX_VALUE, NaN);
  const [modulus, angle] = [read("found-modulus"), read("found-orientation")];
  const material = made.materials.find(({ name }) => name === fields.get("found-material"))?.name;
  return {
    ...(material !== undefined && { material }),
    ...(searchesModulus(made) && modulus > 0 && { youngsModulus: modulus }),
    ...(isRange(made.orientation) && !Number.isNaN(angle) && { orientation: angle }),
  };
}

function readTarget(fields: Fields, suffix: string): Target | null {
  const field = (name: string) => fields.get(name + suffix);
  const task = TASKS.find((name) => name === field("task"));
  if (!task) return null;
  const points = readPoints(field("points") ?? "", isPolar(task));
  if (!points || points.length < minPoints(task)) return null;
  return {
    name: (field("name") ?? "").trim().slice(0, MAX_NAME_LENGTH),
    task,
    points,
    interpolation: choiceOf(field("curve"), ["cubic", "monotone", "linear"] as const, "cubic"),
    direction: numberOf(field("direction"), -1000, 1000, DEFAULT_STATE.direction),
    strain: numberOf(field("strain"), -0.49, 7.5, DEFAULT_STATE.strain),
    measure: choiceOf(field("measure"), ["green", "engineering"] as const, "green"),
    weight: numberOf(field("weight"), ...WEIGHT_LIMITS, DEFAULT_STATE.weight),
  };
}

function isName(text: string): boolean {
  return /^[A-Za-z0-9_-]{1,64}$/.test(text);
}

function numbers(text: string, max: number): number[] | null {
  const values = text.split(",").map(Number);
  const isValid = text !== "" && values.length <= max && values.every((value) => Math.abs(value) <= MAX_VALUE);
  return isValid ? values : null;
}

function readPoints(text: string, polar: boolean): ControlPoint[] | null {
  const points = text.split(";").map((pair) => numbers(pair, 2));
  if (points.length > MAX_POINTS || points.some((point) => point?.length !== 2)) return null;
  const checked = points as unknown as ControlPoint[];
  const increasing = checked.every((point, k) => k === 0 || point[0] > checked[k - 1][0]);
  const width = checked[checked.length - 1][0] - checked[0][0];
  return increasing && (!polar || width < Math.PI) ? checked : null;
}
