import { describe, expect, it } from "vitest";
import { fieldCsv, fieldPly, pathsCsv, pathsObj } from "../src/mesh/finding_files";
import { isolineSpacing, rampTicks } from "../src/mesh/mesh_data";
import { distanceToFit } from "../src/scene/scene_view";

const mesh = { positions: Float64Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0]), faces: Uint32Array.from([0, 1, 2]) };
const paths = [[[0, 0, 0], [3, 4, 0], [3, 4, 1]], [[1, 1, 1], [2, 2, 2]]] as const;

describe("what was found, as files", () => {
  it("has each path as a polyline with vertices of its own", () => {
    expect(pathsObj(paths).split("\n").filter((line) => line.startsWith("l "))).toEqual(["l 1 2 3", "l 4 5"]);
    expect(pathsCsv(paths).split("\n").slice(0, 4)).toEqual(["path,point,x,y,z,length_from_start", "1,0,0,0,0,0", "1,1,3,4,0,5", "1,2,3,4,1,6"]);
  });

  it("has the distances with the mesh, and none where there is no path", () => {
    const ply = fieldPly(mesh, [0, 1, -1]);
    expect(ply).toMatch(/element vertex 3\n[\s\S]*property double distance\nelement face 1\n[\s\S]*end_header\n0 0 0 0\n1 0 0 1\n0 1 0 -1\n3 0 1 2\n$/);
    expect(fieldCsv(mesh, [0, 1, -1])).toBe("vertex,x,y,z,distance\n0,0,0,0,0\n1,1,0,0,1\n2,0,1,0,\n");
  });
});

describe("the scale of a field", () => {
  it("has round ticks up to its largest value, and isolines nearer together", () => {
    expect(rampTicks(7.3)).toEqual([0, 1, 2, 3, 4, 5, 6, 7]);
    expect(rampTicks(0.3)).toEqual([0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]);
    expect(isolineSpacing(7.3)).toBe(0.5);
  });
});

describe("the view of all of a surface", () => {
  it("goes farther away where the picture is higher than wide", () => {
    expect(distanceToFit(1, 1.6)).toBeCloseTo(distanceToFit(1, 1), 12);
    const half = Math.atan(Math.tan((17.5 * Math.PI) / 180) * 0.5);
    expect(distanceToFit(1, 0.5) * Math.sin(half)).toBeGreaterThanOrEqual(1);
  });
});
