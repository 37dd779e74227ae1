// Repairs of a mesh at its upload: their names, the ones that may help after a refusal, and their effect.
import type { Mesh, MeshRepair, ProblemDocument, Repair } from "../contract/types";

/** All repairs: first `automatic`, with which the server chooses the needed ones, then the others in the order in which the server makes them. */
export const REPAIRS: readonly Repair[] = ["automatic", "weld", "drop_degenerate", "drop_duplicates", "split_non_manifold"];

export const REPAIR_WORDS: Record<Repair, string> = {
  automatic: "Whatever the mesh needs",
  weld: "Join the corners of cracks",
  drop_degenerate: "Drop faces without area",
  drop_duplicates: "Drop faces that are given twice",
  split_non_manifold: "Cut apart where more than two faces meet",
};

const REPAIRABLE = ["mesh.degenerate_face", "mesh.non_manifold_edge", "mesh.non_manifold_vertex", "mesh.not_orientable"];

/** Repairs that may help against a refusal, beyond those that were applied; none if the server says that no repair helps. */
export function repairsAgainst(problem: Pick<ProblemDocument, "code" | "detail">, applied: readonly Repair[]): readonly Repair[] {
  const isHopeless = applied.includes("automatic") || problem.detail.includes("no repair removes this fault");
  return REPAIRABLE.includes(problem.code) && !isHopeless ? ["automatic"] : [];
}

/** Whether a repair is to be offered: a warning names one, and none was applied. */
export function mayBeRepaired(mesh: Pick<Mesh, "warnings" | "repair">): boolean {
  return !mesh.repair && mesh.warnings.some((sentence) => sentence.includes("repair="));
}

/** The repairs without repetition, in the order of REPAIRS. `automatic` replaces all others. */
export function ordered(repairs: Iterable<Repair>): Repair[] {
  const asked = new Set(repairs);
  return asked.has("automatic") ? ["automatic"] : REPAIRS.filter((repair) => asked.has(repair));
}

/** The chosen repairs after one was selected or deselected: `automatic` excludes the others. */
export function afterChoice(repairs: readonly Repair[], chosen: Repair, asked: boolean): Repair[] {
  const others = repairs.filter((repair) => repair !== chosen && (!asked || repair !== "automatic"));
  return ordered(asked ? [...others, chosen] : others);
}

export function uploadPath(repairs: readonly Repair[]): string {
  return repairs.length > 0 ? `/v1/meshes?repair=${ordered(repairs).join(",")}` : "/v1/meshes";
}

/** A sentence that compares the repaired mesh with the uploaded one. The server's warnings describe each repair. */
export function repairSentence(mesh: Pick<Mesh, "vertices" | "faces">, repair: MeshRepair): string {
  const changed = repair.welded_vertices + repair.dropped_degenerate_faces + repair.dropped_duplicate_faces + repair.split_edges + repair.split_vertices + repair.removed_vertices;
  if (changed === 0) return "Nothing had to be repaired.";
  const vertices = (count: number) => `${count.toLocaleString("en")} ${count === 1 ? "vertex" : "vertices"}`;
  const faces = (count: number) => `${count.toLocaleString("en")} ${count === 1 ? "face" : "faces"}`;
  return `Repaired: ${vertices(repair.vertices.length)} and ${faces(repair.faces.length)} became ${vertices(mesh.vertices)} and ${faces(mesh.faces)}.`;
}
