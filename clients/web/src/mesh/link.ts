// The state of the mesh page in a link: mesh, tool, points, network and Voronoi diagram.
import { type AccuracyChoice, NORMAL, readChoice, writeChoice } from "../base/accuracy_choice";
import { choiceOf, readFields, writeFields } from "../base/link_fields";
import type { SurfacePoint } from "../contract/types";
import type { NetworkState } from "./network_state";
import { readNetwork, writeNetwork } from "./network_text";
import { MAX_STARTS, type Tool, TOOLS } from "./session";
import { readVoronoi, type VoronoiState, writeVoronoi } from "./voronoi_state";

/** Limit of the number of points in a link. Further ones are dropped; random sites are not listed at all. */
const MAX_POINTS = 200;

export interface MeshLink {
  mesh: string;
  tool: Tool;
  points: SurfacePoint[];
  /** Number of starts of the search for a mean, if there are several. */
  starts?: number;
  /** Accuracy of a distance field, if that is the tool. */
  accuracy?: AccuracyChoice;
  /** State of the network, if it is the tool. */
  network: NetworkState | null;
  /** State of the Voronoi diagram, if it is the tool. Its sites are the points, unless they are random. */
  voronoi?: VoronoiState | null;
}

export function writeMeshLink({ mesh, tool, points, starts = 1, accuracy = NORMAL, network, voronoi }: MeshLink): string {
  const fields: [string, string][] = [["mesh", mesh], ["tool", tool]];
  if (points.length > 0) fields.push(["points", points.slice(0, MAX_POINTS).map(pointText).join(";")]);
  if (tool === "mean" && starts > 1) fields.push(["starts", String(starts)]);
  if (tool === "distance") fields.push(...writeChoice(accuracy));
  if (tool === "network" && network) fields.push(...writeNetwork(network));
  if (tool === "voronoi" && voronoi) fields.push(...writeVoronoi(voronoi));
  return writeFields(fields);
}

/** The state of a link; null if the text names no mesh. Invalid points are left out. */
export function readMeshLink(text: string): MeshLink | null {
  const fields = readFields(text);
  const mesh = fields.get("mesh") ?? "";
  if (!/^[0-9a-f]{64}$/.test(mesh)) return null;
  const places = (fields.get("points") ?? "").split(";").slice(0, MAX_POINTS);
  const points = places.map(readPoint).filter((point): point is SurfacePoint => point !== null);
  const starts = /^\d{1,3}$/.test(fields.get("starts") ?? "") ? Math.min(MAX_STARTS, Number(fields.get("starts"))) : 1;
  const voronoi = readVoronoi(fields);
  const tool = choiceOf(fields.get("tool"), TOOLS, "path");
  return {
    mesh,
    tool,
    points,
    ...(tool === "distance" && fields.has("accuracy") && { accuracy: readChoice(fields) }),
    ...(starts > 1 && { starts }),
    network: readNetwork(fields, points.length),
    ...(voronoi && { voronoi }),
  };
}

/** A point as text: a vertex as "v12", or a point of a face as "12:0.2,0.3,0.5" with barycentric coordinates. */
function pointText(point: SurfacePoint): string {
  return "vertex" in point ? `v${point.vertex}` : `${point.face}:${point.barycentric.map((value) => Number(value.toFixed(6))).join(",")}`;
}

/** A point from its text; null if the text is invalid. */
export function readPoint(text: string): SurfacePoint | null {
  const vertex = /^v(\d{1,9})$/.exec(text.trim());
  if (vertex) return { vertex: Number(vertex[1]) };
  const place = /^(\d{1,9}):([\d.]+),([\d.]+),([\d.]+)$/.exec(text.trim());
  if (!place) return null;
  const weights = place.slice(2).map(Number);
  const sum = weights[0] + weights[1] + weights[2];
  if (!weights.every((value) => value >= 0) || !(Math.abs(sum - 1) < 1e-3)) return null;
  const [a, b] = [weights[0] / sum, weights[1] / sum];
  return { face: Number(place[1]), barycentric: [a, b, Math.max(0, 1 - a - b)] };
}

export function pointWords(point: SurfacePoint): string {
  return "vertex" in point ? `Vertex ${point.vertex}` : `Face ${point.face} at ${point.barycentric.map((value) => value.toFixed(2)).join(", ")}`;
}
