// The points of a network at which the server has found a fault, for marks in the view.
import { Problem } from "../contract/client";
import { entriesAtFault } from "../contract/refusals";
import type { Network } from "./network";
import type { NetworkState } from "./network_state";
import type { MeshActivity } from "./session";

/** Indices of the points that a failed request names: by themselves, as fixed points, as ends of springs or as corners of triangles. */
export function faultyPoints(activity: MeshActivity, { fixed }: Pick<NetworkState, "fixed">, network: Pick<Network, "points" | "pairs" | "triangles"> | null): readonly number[] {
  if (activity.kind !== "failed" || !(activity.error instanceof Problem) || !network) return [];
  const { document } = activity.error;
  const count = network.points.length;
  const sent = fixed.filter((point) => point < count);
  const named = [
    ...entriesAtFault(document, "points"),
    ...entriesAtFault(document, "fixed_points").map((entry) => sent[entry]),
    ...entriesAtFault(document, "springs").flatMap((spring) => network.pairs[spring] ?? []),
    ...entriesAtFault(document, "triangles").flatMap((triangle) => network.triangles[triangle] ?? []),
  ];
  return [...new Set(named)].filter((point) => point !== undefined && point < count).sort((a, b) => a - b);
}
