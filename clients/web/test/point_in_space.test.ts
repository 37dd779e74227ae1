import { describe, expect, it } from "vitest";
import { projectedOnto, readPlace } from "../src/mesh/point_in_space";

describe("a point in space", () => {
  it("is read as it is typed", () => {
    expect(readPlace(" @1, -2.5,3e-1 ")).toEqual([1, -2.5, 0.3]);
    for (const text of ["1,2,3", "@1,2", "@1,2,3,4", "@1,,3", "@1,2,x", "@1,2,Infinity", "v3"]) expect(readPlace(text)).toBeNull();
  });

  it("stands for the nearest point of the surface, however far away it is", () => {
    const square = { positions: Float64Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]), faces: Uint32Array.from([0, 1, 2, 0, 2, 3]) };
    const { point, distance } = projectedOnto(square, [0.75, 0.25, 2]);
    expect(distance).toBeCloseTo(2, 12);
    expect(point).toEqual({ face: 0, barycentric: [0.25, 0.5, 0.25] });
    expect(projectedOnto(square, [4, 5, 0]).distance).toBeCloseTo(5, 12);
    expect(projectedOnto(square, [-3, 0.5, 4]).distance).toBeCloseTo(5, 12);
  });
});
