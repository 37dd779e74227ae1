// Repairs of a mesh at its upload: which there are, which of them help against a refusal, and what they changed.
import type { Mesh, MeshRepair, ProblemDocument, Repair } from "../contract/types";

/** In the order in which the server makes them. */
export const REPAIRS: readonly Repair[] = ["weld", "drop_degenerate", "drop_duplicates", "split_non_manifold"];

export const REPAIR_WORDS: Record<Repair, string> = {
  weld: "Join vertices that all but coincide",
  drop_degenerate: "Drop faces without area",
  drop_duplicates: "Drop faces that are given twice",
  split_non_manifold: "Cut apart where more than two faces meet",
};

const HELP: Readonly<Record<string, readonly Repair[]>> = {
  "mesh.degenerate_face": ["drop_degenerate"],
  "mesh.non_manifold_edge": ["drop_duplicates", "split_non_manifold"],
  "mesh.non_manifold_vertex": ["split_non_manifold"],
};

/** Repairs that may help against a refusal beyond those that were made; none where no repair does. */
export function helpAgainst(problem: Pick<ProblemDocument, "code">, made: readonly Repair[]): readonly Repair[] {
  return (HELP[problem.code] ?? []).filter((repair) => !made.includes(repair));
}

export function ordered(repairs: Iterable<Repair>): Repair[] {
  const asked = new Set(repairs);
  return REPAIRS.filter((repair) => asked.has(repair));
}

export function uploadPath(repairs: readonly Repair[]): string {
  return repairs.length > 0 ? `/v1/meshes?repair=${ordered(repairs).join(",")}` : "/v1/meshes";
}

/** How the mesh compares with what was uploaded, in a sentence; the server's warnings say it repair by repair. */
export function repairSentence(mesh: Pick<Mesh, "vertices" | "faces">, repair: MeshRepair): string {
  const changed = repair.welded_vertices + repair.dropped_degenerate_faces + repair.dropped_duplicate_faces + repair.split_edges + repair.split_vertices + repair.removed_vertices;
  if (changed === 0) return "Nothing had to be repaired.";
  const vertices = (count: number) => `${count.toLocaleString("en")} ${count === 1 ? "vertex" : "vertices"}`;
  const faces = (count: number) => `${count.toLocaleString("en")} ${count === 1 ? "face" : "faces"}`;
  return `Repaired: ${vertices(repair.vertices.length)} and ${faces(repair.faces.length)} became ${vertices(mesh.vertices)} and ${faces(mesh.faces)}.`;
}
