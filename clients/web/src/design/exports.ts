// Files of what is shown.
import type { Curve } from "../base/curve";
import type { Shown } from "./shown";
import { isPolar } from "./state";

/** Target and response at each sample; the simulated curve follows with its own samples. */
export function csvOf(shown: Shown, before: Curve | null, verified: Curve | null): string {
  const x = isPolar(shown.task) ? "direction_rad" : "strain";
  const unit = shown.task === "poisson" ? "" : "_MPa";
  const rows = [[x, `target${unit}`, `achieved${unit}`, `error_bar${unit}`, `before${unit}`, "reached", "in_range"].join(",")];
  const aligned = before && before.x.length === shown.x.length && before.x.every((value, k) => value === shown.x[k]);
  shown.x.forEach((value, k) => {
    const earlier = aligned ? before.y[k] : null;
    rows.push([value, shown.target[k], shown.achieved[k] ?? "", shown.errorBar?.[k] ?? "", earlier ?? "", shown.reached[k], shown.inRange[k]].join(","));
  });
  if (verified) {
    rows.push("", [x, `simulated${unit}`].join(","));
    verified.x.forEach((value, k) => rows.push([value, verified.y[k] ?? ""].join(",")));
  }
  return `${rows.join("\n")}\n`;
}

/** Everything that makes the design again, and what came out. */
export function jsonOf(shown: Shown, verified: Curve | null): string {
  const { found, model, x, target, achieved, errorBar, reached, inRange, deviation, largest, stopped, message } = shown;
  const document = {
    task: shown.task,
    ...(isPolar(shown.task) ? { strain: shown.strain } : { direction: shown.direction }),
    strain_measure: shown.measure,
    target: { control_points: shown.points, interpolation: shown.interpolation },
    design: { family: found.family, model, parameters: found.parameters, by_hand: shown.byHand, stopped, message },
    error: { relative_rms: deviation, max: largest },
    profile: { x, target, achieved, error_bar: errorBar, reached, in_range: inRange },
    verified: verified && { x: verified.x, y: verified.y },
  };
  return `${JSON.stringify(document, null, 2)}\n`;
}
