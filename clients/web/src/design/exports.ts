// The shown design as CSV and JSON files.
import type { Curve } from "../base/curve";
import type { TargetResponse } from "./shown";
import { isPolar } from "./state";

/** CSV with target and response at each sample, followed by the simulated curve at its own samples. */
export function csvOf(shown: TargetResponse, previous: Curve | null, verified: Curve | null): string {
  const x = isPolar(shown.task) ? "direction_rad" : "strain";
  const unit = shown.task === "poisson" ? "" : "_MPa";
  const rows = [[x, `target${unit}`, `achieved${unit}`, `error_bar${unit}`, `before${unit}`, "reached", "in_range"].join(",")];
  const aligned = previous && previous.x.length === shown.x.length && previous.x.every((value, k) => value === shown.x[k]);
  shown.x.forEach((value, k) => {
    const previousValue = aligned ? previous.y[k] : null;
    rows.push([value, shown.target[k], shown.achieved[k] ?? "", shown.errorBar?.[k] ?? "", previousValue ?? "", shown.reached[k], shown.inRange[k]].join(","));
  });
  if (verified) {
    rows.push("", [x, `simulated${unit}`].join(","));
    verified.x.forEach((value, k) => rows.push([value, verified.y[k] ?? ""].join(",")));
  }
  return `${rows.join("\n")}\n`;
}

/** JSON with everything that is needed to repeat the design, and its results. `also`: the responses to the other targets. */
export function jsonOf(shown: TargetResponse, verified: Curve | null, also: readonly TargetResponse[] = []): string {
  const { found, model, stopped, message } = shown;
  const document = {
    ...targetDocument(shown),
    design: { family: found.family, model, parameters: found.parameters, by_hand: shown.byHand, stopped, message },
    ...specificationDocument(shown),
    verified: verified && { x: verified.x, y: verified.y },
    ...(also.length > 0 && { also: also.map(targetDocument), overall: { relative_rms: shown.overall } }),
  };
  return `${JSON.stringify(document, null, 2)}\n`;
}

function specificationDocument({ measures }: TargetResponse): Record<string, unknown> {
  const { material, youngsModulus, materialDensity, orientation, beamWidth, cellSize, relativeDensity, density } = measures;
  return {
    material: { ...(material !== "" && { name: material }), youngs_modulus: youngsModulus, density: materialDensity },
    orientation,
    structure: { beam_width: beamWidth, cell_size: cellSize, relative_density: relativeDensity, density },
  };
}

function targetDocument(shown: TargetResponse): Record<string, unknown> {
  const { x, target, achieved, errorBar, reached, inRange, deviation, largest } = shown;
  return {
    ...(shown.name !== "" && { name: shown.name }),
    task: shown.task,
    ...(isPolar(shown.task) ? { strain: shown.strain } : { direction: shown.direction }),
    strain_measure: shown.measure,
    ...(shown.weight !== 1 && { weight: shown.weight }),
    target: { control_points: shown.points, interpolation: shown.interpolation },
    error: { relative_rms: deviation, max: largest },
    profile: { x, target, achieved, error_bar: errorBar, reached, in_range: inRange },
  };
}
