import { describe, expect, it } from "vitest";
import { Problem } from "../src/contract/client";
import type { ProblemDocument } from "../src/contract/types";
import { curvesAtFault, type Filling, type Product } from "../src/design/part";
import { faultyPoints } from "../src/mesh/network_faults";
import type { MeshActivity } from "../src/mesh/session";

function problemAt(...pointers: string[]): Problem {
  const errors = pointers.map((pointer) => ({ pointer, detail: "must differ" }));
  return new Problem({ type: "", status: 422, code: "x.y", title: "t", detail: "must differ", errors } as ProblemDocument);
}

describe("points of a network at fault", () => {
  const network = {
    points: [{ vertex: 0 }, { vertex: 1 }, { vertex: 2 }, { vertex: 3 }],
    pairs: [[0, 1], [2, 3]] as const,
    triangles: [[0, 1, 2], [1, 2, 3]] as const,
  };
  const marked = (...pointers: string[]) => faultyPoints({ kind: "failed", sentence: "", error: problemAt(...pointers) } as MeshActivity, { fixed: [7, 3, 1] }, network);

  it("are those that the refusal names, as points, fixed points, ends of springs and corners of triangles", () => {
    expect(marked("/points/2/barycentric/0")).toEqual([2]);
    expect(marked("/fixed_points/1"), "the points that do not exist were not sent").toEqual([1]);
    expect(marked("/springs/1/weight", "/points/0")).toEqual([0, 2, 3]);
    expect(marked("/triangles/1")).toEqual([1, 2, 3]);
    expect(marked("/host", "/points/9", "/springs/5")).toEqual([]);
  });

  it("are none where nothing has failed, or nothing was refused", () => {
    expect(faultyPoints({ kind: "idle" }, { fixed: [] }, network)).toEqual([]);
    expect(faultyPoints({ kind: "failed", sentence: "", error: new Error("x") }, { fixed: [] }, network)).toEqual([]);
    expect(faultyPoints({ kind: "failed", sentence: "", error: problemAt("/points/0") }, { fixed: [] }, null)).toEqual([]);
  });
});

describe("curves of a drawing at fault", () => {
  const filling = {} as Filling;
  const [outer, hole, left, right] = [0, 1, 2, 3].map((x) => [[x, 0], [x + 1, 0], [x, 1]] as [number, number][]);
  const product: Product = { outline: [outer, hole], rest: filling, regions: [{ outline: left, filling }, { outline: right, filling }] };

  it("are those that the refusal names, of the outline and of the regions", () => {
    expect(curvesAtFault(problemAt("/outline/polygons/1/4"), product)).toEqual([hole]);
    expect(curvesAtFault(problemAt("/regions/1/outline/2", "/outline/polygons/0"), product)).toEqual([outer, right]);
    expect(curvesAtFault(problemAt("/outline/polygons/7", "/thickness"), product)).toEqual([]);
    expect(curvesAtFault(new Error("x"), product)).toEqual([]);
    expect(curvesAtFault(problemAt("/outline/polygons/0"), null), "a coupon has no curves").toEqual([]);
  });
});
