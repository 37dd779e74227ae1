// The search of the design page as a command of a shell and as a program in Python.
import type { DesignRequest } from "../contract/types";
import { curlText } from "../base/curl";
import { isRange, madeRequest } from "./made";
import { regionsOf } from "./region_list";
import { designRequest, regionsRequest } from "./requests";
import type { DesignState } from "./state";
import { targetsOf, withTargets } from "./target_list";

/** What a search of this state asks for, by itself: its targets in the order of their tabs, and all regions where there are several. */
export function searchOf(state: DesignState): DesignRequest {
  const regions = regionsOf(state).map((region) => ({ ...region, ...withTargets(targetsOf(region), 0) }));
  const { session: _, ...request } = regions.length > 1 ? regionsRequest(regions, "") : designRequest(regions[0], "search", "");
  return request;
}

export function curlOf(state: DesignState, origin: string): string {
  return curlText(origin, "/v1/designs", searchOf(state));
}

/** A pair that is written with "=", since values may begin with a minus. */
function option(name: string, value: string | number | undefined): string[] {
  return value === undefined ? [] : [`--${name}="${value}"`];
}

export function commandOf(state: DesignState, origin: string): string {
  const request = searchOf(state);
  // The command line takes further targets, regions, several materials and the orientation to begin with from a request.
  if (request.also ?? request.regions ?? (Array.isArray(request.material) || request.initial_orientation !== undefined)) return `cat > design.json <<'END'\n${JSON.stringify(request)}\nEND\nsupple --server ${origin} design --request design.json\n`;
  const { target } = request as { target: { control_points: readonly (readonly number[])[]; interpolation?: string } };
  const parts = [
    ...option("task", request.task), ...option("family", request.family), ...option("direction", request.direction), ...option("strain", request.strain),
    ...option("strain-measure", request.strain_measure),
    ...option("target", target.control_points.map((point) => point.join(",")).join(";")), ...option("interpolation", target.interpolation),
    ...option("samples", request.samples), ...madeOptions(state),
    ...option("initial", request.initial?.join(",")), ...option("fixed", request.fixed?.map((value) => value ?? "free").join(",")),
    ...option("multi-start", request.effects?.multi_start), ...option("envelope", request.effects?.envelope),
  ];
  return `supple --server ${origin} design \\\n  ${parts.join(" \\\n  ")}\n`;
}

function madeOptions({ made }: DesignState): string[] {
  const { material, orientation, beam_width, cell_size, limits } = madeRequest(made);
  const { youngs_modulus, density } = (material ?? {}) as { youngs_modulus?: number | number[]; density?: number };
  const angles = isRange(made.orientation) ? made.orientation : [made.orientation];
  return [
    ...option("youngs-modulus", youngs_modulus?.toString()), ...option("density", density),
    ...option("orientation", orientation === undefined ? undefined : angles.map((angle) => `${angle}deg`).join(",")),
    ...option("beam-width", beam_width), ...option("cell-size", cell_size),
    ...option("relative-density", limits?.relative_density?.join(",")), ...option("beam-width-limits", limits?.beam_width?.join(",")),
    ...option("cell-size-limits", limits?.cell_size?.join(",")),
  ];
}

function python(value: unknown): string {
  if (value === null || value === undefined) return "None";
  if (Array.isArray(value)) return `[${value.map(python).join(", ")}]`;
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

function keywords(values: Readonly<Record<string, unknown>>): string {
  return Object.entries(values).filter(([, value]) => value !== undefined).map(([name, value]) => `${name}=${python(value)}`).join(", ");
}

type RequestedMaterial = Readonly<Record<string, unknown>>;

interface RequestedMade {
  material?: RequestedMaterial | readonly RequestedMaterial[];
  orientation?: unknown;
  initial_orientation?: number;
  beam_width?: number;
  cell_size?: number;
  limits?: Readonly<Record<string, unknown>>;
}

type RequestedTarget = Omit<NonNullable<DesignRequest["also"]>[number], "target"> & { target: { control_points: unknown; interpolation?: string } };

/** What the structure is made of, how it lies and how large it is, as keywords. */
function pythonMade({ material, orientation, initial_orientation, beam_width, cell_size, limits }: RequestedMade): string {
  const one = (entry: RequestedMaterial): string => `supple.Material(${keywords(entry)})`;
  const list = (entries: readonly RequestedMaterial[]): string => `[${entries.map(one).join(", ")}]`;
  return [
    material && `material=${Array.isArray(material) ? list(material) : one(material as RequestedMaterial)}`, keywords({ orientation, initial_orientation, beam_width, cell_size }),
    limits && `limits=supple.Limits(${keywords(limits)})`,
  ].filter((words) => words).join(", ");
}

function pythonTarget({ task, direction, strain, strain_measure, target, samples, weight }: RequestedTarget): string {
  return `supple.Target(${python(task)}, ${python(target.control_points)}, ${keywords({ direction, strain, strain_measure, interpolation: target.interpolation, samples, weight })})`;
}

type RequestedRegion = RequestedTarget & RequestedMade & { name?: string; family?: string; also?: RequestedTarget[]; initial?: number[]; fixed?: (number | null)[] };

function pythonRegion(region: RequestedRegion): string {
  const { name, also, initial, fixed } = region;
  const others = [also && `also=[${also.map(pythonTarget).join(", ")}]`, keywords({ name, family: region.family === "any" ? undefined : region.family, initial, fixed }), pythonMade(region)];
  return `supple.Region(${[pythonTarget(region), ...others].filter((words) => words).join(", ")})`;
}

export function pythonOf(state: DesignState, origin: string): string {
  const request = searchOf(state);
  const { effects, also = [], regions } = request as { effects?: { multi_start?: string; envelope?: string }; also?: RequestedTarget[]; regions?: RequestedRegion[] };
  const head = ["import supple", "", `client = supple.Client(${python(origin)})`];
  const options = `options = supple.DesignOptions(${keywords({ multi_start: effects?.multi_start, envelope: effects?.envelope })})`;
  if (regions) {
    return [
      ...head,
      `regions = [\n    ${regions.map(pythonRegion).join(",\n    ")},\n]`,
      options,
      "for design in client.design_regions(regions, options=options).regions:",
      "    print(design.name, design.family, *design.parameters, design.error.relative_rms)", "",
    ].join("\n");
  }
  const search = { family: request.family === "any" ? undefined : request.family, initial: request.initial, fixed: request.fixed };
  const given = [also.length > 0 && "also=also", keywords(search), pythonMade(request as RequestedMade), "options=options"].filter((words) => words);
  return [
    ...head,
    `target = ${pythonTarget(request as unknown as RequestedTarget)}`,
    ...(also.length > 0 ? [`also = [\n    ${also.map(pythonTarget).join(",\n    ")},\n]`] : []),
    options,
    `design = client.design(target, ${given.join(", ")})`,
    "print(design.family, *design.parameters, design.error.relative_rms)", "",
  ].join("\n");
}
