// The search of the design page as a curl command, as a command line and as a Python program.
import type { DesignRequest } from "../contract/types";
import { curlText } from "../base/curl";
import { isRange, specificationFields } from "./specification";
import { regionsOf } from "./region_list";
import { designRequest, regionsRequest } from "./requests";
import type { DesignState } from "./state";
import { targetsOf, withTargets } from "./target_list";

/** The request of a search of this state, without an editing session: all targets in the order of their tabs, and all regions. */
export function searchOf(state: DesignState): DesignRequest {
  const regions = regionsOf(state).map((region) => ({ ...region, ...withTargets(targetsOf(region), 0) }));
  const { session: _, ...request } = regions.length > 1 ? regionsRequest(regions, "", state.accuracy) : designRequest(regions[0], "search", "", state.accuracy);
  return request;
}

/** The verdict as a comment of shells and of Python; empty without one. */
function comment(verdict: string | null): string {
  return verdict === null ? "" : `# ${verdict}\n`;
}

/** `verdict`: what a simulation has said of the design; null if it was not simulated. */
export function curlOf(state: DesignState, origin: string, verdict: string | null = null): string {
  return comment(verdict) + curlText(origin, "/v1/designs", searchOf(state));
}

/** An option as name="value"; the equals sign is needed for values that begin with a minus. */
function option(name: string, value: string | number | undefined): string[] {
  return value === undefined ? [] : [`--${name}="${value}"`];
}

export function commandOf(state: DesignState, origin: string, verdict: string | null = null): string {
  const request = searchOf(state);
  // The command line has no options for further targets, regions, several materials and an initial orientation: they need a request file.
  if (request.also ?? request.regions ?? (Array.isArray(request.material) || request.initial_orientation !== undefined)) {
    return `${comment(verdict)}cat > design.json <<'END'\n${JSON.stringify(request)}\nEND\nsupple --server ${origin} design --request design.json\n`;
  }
  const { target } = request as { target: { control_points: readonly (readonly number[])[]; interpolation?: string } };
  const parts = [
    ...option("task", request.task),
    ...option("family", request.family),
    ...option("direction", request.direction),
    ...option("strain", request.strain),
    ...option("strain-measure", request.strain_measure),
    ...option("target", target.control_points.map((point) => point.join(",")).join(";")),
    ...option("interpolation", target.interpolation),
    ...option("samples", request.samples),
    ...specificationOptions(state),
    ...option("initial", request.initial?.join(",")),
    ...option("fixed", request.fixed?.map((value) => value ?? "free").join(",")),
    ...option("multi-start", request.effects?.multi_start),
    ...option("envelope", request.effects?.envelope),
    ...option("trust", request.effects?.trust),
    ...option("polish", request.effects?.polish),
    ...option("ways-out", request.effects?.ways_out),
    ...option("tolerance", request.accuracy?.tolerance),
    ...option("starts", request.accuracy?.starts),
  ];
  return `${comment(verdict)}supple --server ${origin} design \\\n  ${parts.join(" \\\n  ")}\n`;
}

function specificationOptions({ made }: DesignState): string[] {
  const { material, orientation, beam_width, cell_size, limits } = specificationFields(made);
  const { youngs_modulus, density } = (material ?? {}) as { youngs_modulus?: number | number[]; density?: number };
  const angles = isRange(made.orientation) ? made.orientation : [made.orientation];
  return [
    ...option("youngs-modulus", youngs_modulus?.toString()),
    ...option("density", density),
    ...option("orientation", orientation === undefined ? undefined : angles.map((angle) => `${angle}deg`).join(",")),
    ...option("beam-width", beam_width),
    ...option("cell-size", cell_size),
    ...option("relative-density", limits?.relative_density?.join(",")),
    ...option("beam-width-limits", limits?.beam_width?.join(",")),
    ...option("cell-size-limits", limits?.cell_size?.join(",")),
  ];
}

function pythonLiteral(value: unknown): string {
  if (value === null || value === undefined) return "None";
  if (Array.isArray(value)) return `[${value.map(pythonLiteral).join(", ")}]`;
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

function keywordArguments(values: Readonly<Record<string, unknown>>): string {
  return Object.entries(values).filter(([, value]) => value !== undefined).map(([name, value]) => `${name}=${pythonLiteral(value)}`).join(", ");
}

type RequestedMaterial = Readonly<Record<string, unknown>>;

interface RequestedSpecification {
  material?: RequestedMaterial | readonly RequestedMaterial[];
  orientation?: unknown;
  initial_orientation?: number;
  beam_width?: number;
  cell_size?: number;
  limits?: Readonly<Record<string, unknown>>;
}

type RequestedTarget = Omit<NonNullable<DesignRequest["also"]>[number], "target"> & { target: { control_points: unknown; interpolation?: string } };

/** Material, orientation, size and limits of the structure as keyword arguments. */
function pythonSpecification({ material, orientation, initial_orientation, beam_width, cell_size, limits }: RequestedSpecification): string {
  const one = (entry: RequestedMaterial): string => `supple.Material(${keywordArguments(entry)})`;
  const list = (entries: readonly RequestedMaterial[]): string => `[${entries.map(one).join(", ")}]`;
  return [
    material && `material=${Array.isArray(material) ? list(material) : one(material as RequestedMaterial)}`,
    keywordArguments({ orientation, initial_orientation, beam_width, cell_size }),
    limits && `limits=supple.Limits(${keywordArguments(limits)})`,
  ].filter((words) => words).join(", ");
}

function pythonTarget({ task, direction, strain, strain_measure, target, samples, weight }: RequestedTarget): string {
  const named = keywordArguments({ direction, strain, strain_measure, interpolation: target.interpolation, samples, weight });
  return `supple.Target(${pythonLiteral(task)}, ${pythonLiteral(target.control_points)}, ${named})`;
}

type RequestedRegion = RequestedTarget & RequestedSpecification & { name?: string; family?: string; also?: RequestedTarget[]; initial?: number[]; fixed?: (number | null)[] };

function pythonRegion(region: RequestedRegion): string {
  const { name, also, initial, fixed } = region;
  const others = [also && `also=[${also.map(pythonTarget).join(", ")}]`, keywordArguments({ name, family: region.family === "any" ? undefined : region.family, initial, fixed }),
    pythonSpecification(region)];
  return `supple.Region(${[pythonTarget(region), ...others].filter((words) => words).join(", ")})`;
}

export function pythonOf(state: DesignState, origin: string, verdict: string | null = null): string {
  const request = searchOf(state);
  const { effects = {}, accuracy = {}, also = [], regions } = request as Pick<DesignRequest, "effects" | "accuracy"> & { also?: RequestedTarget[]; regions?: RequestedRegion[] };
  const head = [...(verdict === null ? [] : [comment(verdict).trimEnd()]), "import supple", "", `client = supple.Client(${pythonLiteral(origin)})`];
  const options = `options = supple.DesignOptions(${keywordArguments({ ...effects, ...accuracy })})`;
  if (regions) {
    return [
      ...head,
      `regions = [\n    ${regions.map(pythonRegion).join(",\n    ")},\n]`,
      options,
      "for design in client.design_regions(regions, options=options).regions:",
      "    print(design.name, design.family, *design.parameters, design.error.relative_rms)",
      "",
    ].join("\n");
  }
  const search = { family: request.family === "any" ? undefined : request.family, initial: request.initial, fixed: request.fixed };
  const given = [also.length > 0 && "also=also", keywordArguments(search), pythonSpecification(request as RequestedSpecification), "options=options"].filter((words) => words);
  return [
    ...head,
    `target = ${pythonTarget(request as unknown as RequestedTarget)}`,
    ...(also.length > 0 ? [`also = [\n    ${also.map(pythonTarget).join(",\n    ")},\n]`] : []),
    options,
    `design = client.design(target, ${given.join(", ")})`,
    "print(design.family, *design.parameters, design.error.relative_rms)",
    "",
  ].join("\n");
}
