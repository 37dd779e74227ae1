import { describe, expect, it } from "vitest";
import type { MeshRepair } from "../src/contract/types";
import { helpAgainst, ordered, repairSentence, uploadPath } from "../src/mesh/repair";

const NONE: MeshRepair = {
  welded_vertices: 0, weld_distance: 0, dropped_degenerate_faces: 0, dropped_duplicate_faces: 0, split_edges: 0, split_vertices: 0, removed_vertices: 0,
  vertices: [0, 1, 2, 3], faces: [0, null],
};

describe("repairs at upload", () => {
  it("are offered where they help and were not made", () => {
    expect(helpAgainst({ code: "mesh.degenerate_face" }, [])).toEqual(["drop_degenerate"]);
    expect(helpAgainst({ code: "mesh.non_manifold_edge" }, ["drop_duplicates"])).toEqual(["split_non_manifold"]);
    expect(helpAgainst({ code: "mesh.non_manifold_vertex" }, ["split_non_manifold"])).toEqual([]);
    expect(helpAgainst({ code: "mesh.not_orientable" }, [])).toEqual([]);
  });

  it("are asked for once each, in the order in which they are made", () => {
    expect(ordered(["split_non_manifold", "weld", "weld"])).toEqual(["weld", "split_non_manifold"]);
    expect(uploadPath(["drop_duplicates", "drop_degenerate"])).toBe("/v1/meshes?repair=drop_degenerate,drop_duplicates");
    expect(uploadPath([])).toBe("/v1/meshes");
  });

  it("say what became of the mesh, or that it was sound", () => {
    expect(repairSentence({ vertices: 4, faces: 2 }, NONE)).toBe("Nothing had to be repaired.");
    expect(repairSentence({ vertices: 3, faces: 1 }, { ...NONE, dropped_degenerate_faces: 1, removed_vertices: 1 })).toBe("Repaired: 4 vertices and 2 faces became 3 vertices and 1 face.");
  });
});
