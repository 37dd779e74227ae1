import { describe, expect, it } from "vitest";
import type { EmbeddedSystem } from "../src/contract/types";
import { readMeshLink, writeMeshLink } from "../src/mesh/link";
import { energyDensity, sidesOf, stretchesOf, type Triple } from "../src/mesh/membrane";
import { drape } from "../src/mesh/membrane_drape";
import type { MeshData, Vector } from "../src/mesh/mesh_data";
import { SurfaceGrid } from "../src/mesh/nearest_on_surface";
import { exactTriangles, fileRequest, constructionRequest, materialOf, type Network, networkKey, relaxationRequest, straightTriangles } from "../src/mesh/network";
import { DEFAULT_NETWORK, type NetworkState } from "../src/mesh/network_state";

const MESH = "ab".repeat(32);
const membrane: NetworkState = { ...DEFAULT_NETWORK, elements: "membrane", youngsModulus: 2, poissonRatio: 0.25, thickness: 0.5, restScale: 0.8, fixed: [1] };
const network: Network = {
  points: [{ vertex: 0 }, { vertex: 1 }, { vertex: 2 }, { vertex: 3 }],
  positions: [[0, 0, 0], [4, 0, 0], [0, 3, 0], [4, 3, 0]],
  pairs: [],
  triangles: [[0, 1, 2], [1, 3, 2]],
};
const material = { youngs_modulus: 2, poisson_ratio: 0.25, thickness: 0.5 };

/** An octahedron of radius 1, subdivided and projected to the sphere `times` times. */
function sphere(times: number): MeshData {
  let places: Vector[] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
  let faces: Triple[] = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
  for (let k = 0; k < times; ++k) {
    const refined: Vector[] = [...places];
    const middles = new Map<string, number>();
    const middle = (a: number, b: number) => {
      const key = `${Math.min(a, b)}-${Math.max(a, b)}`;
      const sum = [0, 1, 2].map((axis) => places[a][axis] + places[b][axis]);
      if (!middles.has(key)) middles.set(key, refined.push(sum.map((value) => value / Math.hypot(...sum)) as unknown as Vector) - 1);
      return middles.get(key) as number;
    };
    faces = faces.flatMap(([a, b, c]): Triple[] => {
      const [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
      return [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
    });
    places = refined;
  }
  return { positions: Float64Array.from(places.flatMap((place) => [...place])), faces: Uint32Array.from(faces.flatMap((face) => [...face])) };
}

describe("a triangle of a membrane", () => {
  it("has the principal stretches of the linear map between two flat triangles", () => {
    const [greater, lesser] = stretchesOf([4, 5, 3], [8, Math.hypot(8, 1.5), 1.5]);
    expect(greater).toBeCloseTo(2, 12);
    expect(lesser).toBeCloseTo(0.5, 12);
    // The principal stretches of a shear by 1 are the golden ratio and its inverse.
    const sheared = stretchesOf([1, Math.SQRT2, 1], [1, 1, Math.SQRT2]);
    expect(sheared[0]).toBeCloseTo((1 + Math.sqrt(5)) / 2, 12);
    expect(sheared[0] * sheared[1]).toBeCloseTo(1, 12);
    expect(stretchesOf([3, 4, 5], [3, 4, 7])[1]).toBe(0);
  });

  it("has no energy at rest, that of the law elsewhere, and infinite energy without area", () => {
    expect(energyDensity([1, 1], material)).toBeCloseTo(0, 15);
    // With mu = 0.8, lambda = 0.8 and stretches 2 and 0.5, the density is 0.5 (0.4 (4.25 - 2 - 2 log 1) + 0.4 log(1)^2).
    expect(energyDensity([2, 0.5], material)).toBeCloseTo(0.45, 12);
    expect(energyDensity([2, 1], material)).toBeCloseTo(0.5 * (0.4 * (3 - 2 * Math.log(2)) + 0.4 * Math.log(2) ** 2), 12);
    expect(energyDensity([2, 0], material)).toBe(Infinity);
  });

  it("shares its sides with its neighbours", () => {
    expect(sidesOf(network.triangles)).toEqual([[0, 1], [1, 2], [0, 2], [1, 3], [2, 3]]);
  });
});

describe("requests of a membrane", () => {
  it("make it of the points’ Voronoi dual, with springs only where they are wanted", () => {
    expect(constructionRequest(MESH, membrane, [])).toEqual({
      mesh: MESH,
      points: { kind: "poisson_disk", radius: 1, seed: 1 },
      springs: [],
      triangles: { kind: "voronoi_dual" },
      max_iterations: 1,
    });
    expect(constructionRequest(MESH, { ...membrane, elements: "both" }, [])).toMatchObject({ springs: { kind: "voronoi_dual", weight: 0 }, triangles: { kind: "voronoi_dual" } });
    expect(constructionRequest(MESH, DEFAULT_NETWORK, [])).not.toHaveProperty("triangles");
  });

  it("relax it with its material, from where it is at rest", () => {
    const request = relaxationRequest(MESH, membrane, network);
    expect(request).toMatchObject({
      springs: [],
      triangles: [[0, 1, 2], [1, 3, 2]],
      fixed_points: [1],
      membrane: { youngs_modulus: 2, poisson_ratio: 0.25, thickness: 0.5, rest_scale: 0.8 },
    });
    expect(materialOf(request).rest_scale).toBe(0.8);
    expect(relaxationRequest(MESH, DEFAULT_NETWORK, network)).not.toHaveProperty("triangles");
  });

  it("save it by relaxing it once more: held at its end it would be at rest there", () => {
    const request = relaxationRequest(MESH, membrane, network);
    expect(fileRequest(request, [{ vertex: 9 }, { vertex: 8 }, { vertex: 7 }, { vertex: 6 }])).toEqual(request);
  });

  it("are the same network for another material, another one with springs", () => {
    const key = (state: NetworkState) => networkKey(MESH, state, []);
    expect(key({ ...membrane, youngsModulus: 7, restScale: 1.5, springs: "adjacent_faces" })).toBe(key(membrane));
    expect(key({ ...membrane, elements: "both" })).not.toBe(key(membrane));
    expect(key(DEFAULT_NETWORK)).not.toBe(key({ ...DEFAULT_NETWORK, elements: "both" }));
  });
});

describe("a membrane’s stretches", () => {
  it("are on the way those of straight sides, against the start and the rest scale", () => {
    const moved: Vector[] = [[0, 0, 0], [8, 0, 0], [0, 3, 0], [8, 3, 0]];
    const start = straightTriangles(network, network.positions, material, 0.8);
    expect(start.stretches.flat().map((value) => value.toFixed(12))).toEqual(Array(4).fill((1.25).toFixed(12)));
    const { stretches, densities, exact } = straightTriangles(network, moved, material, 0.8);
    expect(stretches[1][0]).toBeCloseTo(2.5, 12);
    expect(stretches[1][1]).toBeCloseTo(1.25, 12);
    expect(densities[1]).toBeCloseTo(energyDensity([2.5, 1.25], material), 12);
    expect(exact).toBe(false);
  });

  it("are in the end those of the answer", () => {
    const answer = { membrane: [{ energy: 1, stretches: [1.5, 0.9], at_cut_locus: false }] } as unknown as EmbeddedSystem;
    expect(exactTriangles(answer, material)).toEqual({ stretches: [[1.5, 0.9]], densities: [energyDensity([1.5, 0.9], material)], exact: true });
  });
});

describe("a link with a membrane", () => {
  it("brings it back, and leaves out what is no value", () => {
    const link = { mesh: MESH, tool: "network" as const, points: [], network: membrane };
    expect(readMeshLink(writeMeshLink(link))).toEqual(link);
    const read = readMeshLink(`mesh=${MESH}&tool=network&network=poisson_disk,1,1,voronoi_dual,0,1,newton,euclidean,1e-9,200,on,0.1,off,both,-1,0.55,3,x`);
    expect(read?.network).toMatchObject({ elements: "both", youngsModulus: 1, poissonRatio: 0.3, thickness: 3, restScale: 0.9, springLength: "geodesic" });
  });
});

describe("the nearest point of a surface", () => {
  const ball = sphere(3);
  const grid = new SurfaceGrid(ball);

  it("is that of all faces, near the surface and far from it", () => {
    const corner = (face: number, k: number) => ball.positions.slice(3 * ball.faces[3 * face + k], 3 * ball.faces[3 * face + k] + 3);
    for (let trial = 0; trial < 60; ++trial) {
      const far = trial < 40 ? 0.9 + 0.2 * Math.abs(Math.sin(9 * trial)) : 5;
      const direction = [Math.sin(2 * trial), Math.sin(3 * trial + 1), Math.cos(5 * trial)];
      const place = direction.map((value) => (far * value) / Math.hypot(...direction)) as unknown as Vector;
      const { face, barycentric, position } = grid.nearest(place);
      const distance = Math.hypot(...[0, 1, 2].map((axis) => position[axis] - place[axis]));
      expect(
        [0, 1, 2].map((axis) => [0, 1, 2].reduce((sum, k) => sum + barycentric[k] * corner(face, k)[axis], 0)).every((value, axis) => Math.abs(value - position[axis]) < 1e-12),
      ).toBe(true);
      let minDistance = Infinity;
      for (let other = 0; other < ball.faces.length / 3; ++other) {
        for (const [u, v] of [[0, 0], [1, 0], [0, 1], [0.5, 0.5], [0.5, 0], [0, 0.5], [1 / 3, 1 / 3]]) {
          const sample = [0, 1, 2].map((axis) => (1 - u - v) * corner(other, 0)[axis] + u * corner(other, 1)[axis] + v * corner(other, 2)[axis]);
          minDistance = Math.min(minDistance, Math.hypot(...[0, 1, 2].map((axis) => sample[axis] - place[axis])));
        }
      }
      expect(minDistance).toBeGreaterThanOrEqual(distance - 1e-12);
    }
  });

  it("is found on a surface without depth too", () => {
    const square: MeshData = { positions: Float64Array.from([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), faces: Uint32Array.from([0, 1, 2, 0, 2, 3]) };
    expect(new SurfaceGrid(square).nearest([0.25, -0.5, 0.3]).position).toEqual([0.25, -0.5, 0]);
    expect(new SurfaceGrid(square).nearest([3, 0.5, 0]).position).toEqual([1, 0.5, 0]);
  });
});

describe("a membrane laid onto a surface", () => {
  it("lies on it, whole, with the surface’s normals", () => {
    const ball = sphere(4);
    const places: Vector[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0]];
    const { positions, normals, sides, perTriangle } = drape(ball, new SurfaceGrid(ball), ball.positions, places, [[0, 1, 2], [1, 3, 2]], 8);
    expect(perTriangle).toBe(64);
    expect(positions).toHaveLength(2 * 64 * 9);
    expect(sides).toHaveLength(5 * 8 * 6);
    const radii = Array.from({ length: positions.length / 3 }, (_, k) => Math.hypot(...positions.slice(3 * k, 3 * k + 3)));
    expect(Math.min(...radii)).toBeGreaterThan(0.98);
    let area = 0;
    for (let k = 0; k < positions.length; k += 9) {
      const [u, v] = [3, 6].map((to) => [0, 1, 2].map((axis) => positions[k + to + axis] - positions[k + axis]));
      const cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
      area += Math.hypot(...cross) / 2;
      // All triangles are oriented outwards.
      expect(cross.reduce((sum, value, axis) => sum + value * normals[k + axis], 0)).toBeGreaterThan(0);
    }
    expect(area).toBeGreaterThan(0.97 * Math.PI);
    expect(area).toBeLessThan(Math.PI);
  });
});
