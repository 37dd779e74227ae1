import { describe, expect, it } from "vitest";
import type { MeshRepair } from "../src/contract/types";
import { afterChoice, repairsAgainst, mayBeRepaired, ordered, repairSentence, uploadPath } from "../src/mesh/repair";

const NONE: MeshRepair = {
  made: [],
  welded_vertices: 0,
  weld_distance: 0,
  dropped_degenerate_faces: 0,
  dropped_duplicate_faces: 0,
  split_edges: 0,
  split_vertices: 0,
  removed_vertices: 0,
  vertices: [0, 1, 2, 3],
  faces: [0, null],
};

describe("repairs at upload", () => {
  it("are offered by a click where a warning names one and none was made", () => {
    const cracks = "The surface is open along cracks: 2 vertices differ; uploaded with repair=weld they are joined.";
    expect(mayBeRepaired({ warnings: ["1 polygon was cut into triangles.", cracks] })).toBe(true);
    expect(mayBeRepaired({ warnings: ["1 polygon was cut into triangles."] })).toBe(false);
    expect(mayBeRepaired({ warnings: [cracks], repair: NONE })).toBe(false);
  });

  it("are offered where they help and were not made", () => {
    const problem = (code: string, detail = "2 faces are degenerate; uploaded with repair=drop_degenerate the mesh is sound.") => ({ code, detail });
    expect(repairsAgainst(problem("mesh.degenerate_face"), [])).toEqual(["automatic"]);
    expect(repairsAgainst(problem("mesh.non_manifold_vertex"), ["weld"])).toEqual(["automatic"]);
    expect(repairsAgainst(problem("mesh.non_manifold_edge"), ["automatic"])).toEqual([]);
    expect(repairsAgainst(problem("mesh.not_orientable", "5 edges keep the surface from being oriented; no repair removes this fault."), [])).toEqual([]);
    expect(repairsAgainst(problem("mesh.malformed"), [])).toEqual([]);
  });

  it("are chosen by name, or automatically, and not both", () => {
    expect(afterChoice(["weld", "drop_degenerate"], "automatic", true)).toEqual(["automatic"]);
    expect(afterChoice(["automatic"], "drop_degenerate", true)).toEqual(["drop_degenerate"]);
    expect(afterChoice(["automatic"], "automatic", false)).toEqual([]);
    expect(afterChoice(["drop_degenerate"], "weld", true)).toEqual(["weld", "drop_degenerate"]);
    expect(afterChoice(["weld", "drop_degenerate"], "weld", false)).toEqual(["drop_degenerate"]);
    expect(uploadPath(["automatic"])).toBe("/v1/meshes?repair=automatic");
  });

  it("are asked for once each, in the order in which they are made", () => {
    expect(ordered(["split_non_manifold", "weld", "weld"])).toEqual(["weld", "split_non_manifold"]);
    expect(uploadPath(["drop_duplicates", "drop_degenerate"])).toBe("/v1/meshes?repair=drop_degenerate,drop_duplicates");
    expect(uploadPath([])).toBe("/v1/meshes");
  });

  it("say what became of the mesh, or that it was sound", () => {
    expect(repairSentence({ vertices: 4, faces: 2 }, NONE)).toBe("Nothing had to be repaired.");
    expect(repairSentence({ vertices: 3, faces: 1 }, { ...NONE, dropped_degenerate_faces: 1, removed_vertices: 1 })).toBe(
      "Repaired: 4 vertices and 2 faces became 3 vertices and 1 face.",
    );
  });
});
