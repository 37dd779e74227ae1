import { describe, expect, it } from "vitest";
import { DEFORMATION_RAMP, deformationColour, deformationOf, greatestFactor } from "../src/mesh/deformation";
import { type Host, hostFault, defaultHost, hostLimits, lowestVertices, connectedSupports, supportPosition, withMovedSupports, withToggledSupport } from "../src/mesh/host";
import { hostFacts } from "../src/mesh/host_legend";
import { readMoves, readSupports, writeMoves, writeSupports } from "../src/mesh/host_text";
import { readMeshLink, writeMeshLink } from "../src/mesh/link";
import type { MeshData, Vector } from "../src/mesh/mesh_data";
import { fileRequest, type Network, networkKey, relaxationRequest } from "../src/mesh/network";
import { DEFAULT_NETWORK, type NetworkState, onAnotherMesh } from "../src/mesh/network_state";

const MESH = "ab".repeat(32);
const network: Network = { points: [{ vertex: 0 }, { vertex: 1 }], positions: [[0, 0, 0], [1, 0, 0]], pairs: [[0, 1]], triangles: [] };
const shell: Host = { ...defaultHost(2), kind: "shell", thickness: 0.1, shellModulus: 50, poissonRatio: 0.25, supports: [3, 4, 5, 9] };
const on = (host: Host): NetworkState => ({ ...DEFAULT_NETWORK, host });

describe("the request of a network", () => {
  it("says what carries it, and nothing where that is rigid", () => {
    expect(relaxationRequest(MESH, on({ ...shell, kind: "rigid" }), network)).not.toHaveProperty("host");
    const request = relaxationRequest(MESH, on(shell), network);
    expect(request.host).toEqual({ kind: "shell", thickness: 0.1, youngs_modulus: 50, poisson_ratio: 0.25, fixed_vertices: [3, 4, 5, 9] });
    expect(request.effects?.bending).toBe("on");
    const kept = relaxationRequest(MESH, on({ ...shell, keepsVolume: true, volumeWeight: 7, volumeScale: 1.5, bends: false }), network);
    expect(kept.host).toMatchObject({ volume_weight: 7, volume_scale: 1.5 });
    expect(kept.effects?.bending).toBe("off");
  });

  it("has gravity downwards on a solid, where there is any", () => {
    const solid: Host = { ...shell, kind: "solid", solidModulus: 80, gravity: 0.5 };
    const request = relaxationRequest(MESH, on(solid), network);
    expect(request.host).toEqual({ kind: "solid", youngs_modulus: 80, poisson_ratio: 0.25, gravity: [0, 0, -0.5], fixed_vertices: [3, 4, 5, 9] });
    expect(request.effects).not.toHaveProperty("bending");
    expect(relaxationRequest(MESH, on({ ...solid, gravity: 0 }), network).host).not.toHaveProperty("gravity");
  });

  it("is sent once more for a file, since a host that gave way would move again", () => {
    const request = relaxationRequest(MESH, on(shell), network);
    expect(fileRequest(request, [{ vertex: 5 }, { vertex: 6 }])).toBe(request);
  });

  it("is about the same network whatever carries it", () => {
    expect(networkKey(MESH, on(shell), [])).toBe(networkKey(MESH, DEFAULT_NETWORK, []));
  });
});

describe("a host", () => {
  it("has lengths and moduli for the size of its mesh, within what the page offers", () => {
    for (const diagonal of [0.02, 1, 9, 400]) {
      const [host, limits] = [defaultHost(diagonal), hostLimits(diagonal)];
      expect(host.thickness / diagonal).toBeCloseTo(0.03, 2);
      for (const name of ["thickness", "shellModulus", "solidModulus", "volumeWeight", "gravity"] as const) {
        const [lower, upper] = limits[name];
        expect(host[name]).toBeGreaterThanOrEqual(lower);
        expect(host[name]).toBeLessThan(upper);
      }
    }
    const moved = onAnotherMesh(on({ ...shell, keepsVolume: true }), { area: 1, bounding_box: { lower: [], upper: [], diagonal: 20 } }).host;
    expect(moved).toMatchObject({ kind: "shell", thickness: 0.6, keepsVolume: true, poissonRatio: 0.25, supports: [] });
  });

  it("is held at a vertex, or let go", () => {
    expect(withToggledSupport(shell, 1).supports).toEqual([1, 3, 4, 5, 9]);
    expect(withToggledSupport(shell, 4).supports).toEqual([3, 5, 9]);
  });

  const mesh = { positions: Float64Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 5, 5, 5]), faces: Uint32Array.from([0, 1, 2, 1, 3, 2]) };

  it("takes supports elsewhere, those that edges join along, and forgets where they go when they are let go", () => {
    const supported = { ...shell, supports: [0, 1, 3, 4] };
    expect(connectedSupports(supported.supports, mesh, 0)).toEqual([0, 1, 3]);
    expect(connectedSupports([0, 3], mesh, 0)).toEqual([0]);
    expect(connectedSupports(supported.supports, mesh, 4)).toEqual([4]);
    const moved = withMovedSupports(supported, mesh, [0, 1], 1, [1, 0, 2]);
    expect(moved.moves).toEqual([{ vertex: 0, to: [0, 0, 2] }, { vertex: 1, to: [1, 0, 2] }]);
    expect(supportPosition(moved, mesh, 0)).toEqual([0, 0, 2]);
    expect(supportPosition(moved, mesh, 3)).toEqual([1, 1, 0]);
    const further = withMovedSupports(moved, mesh, [0], 0, [0, 1, 2]);
    expect(further.moves).toEqual([{ vertex: 0, to: [0, 1, 2] }, { vertex: 1, to: [1, 0, 2] }]);
    expect(withToggledSupport(further, 0).moves).toEqual([{ vertex: 1, to: [1, 0, 2] }]);
    expect(relaxationRequest(MESH, on(further), network).host).toMatchObject({
      fixed_vertices: [3, 4],
      moved_vertices: [{ vertex: 0, positions: [[0, 1, 2]] }, { vertex: 1, positions: [[1, 0, 2]] }],
    });
    expect(relaxationRequest(MESH, on(supported), network).host).not.toHaveProperty("moved_vertices");
    expect(hostFault({ ...further, supports: [0, 1] }, { boundary_loops: 0 })).toMatch(/needs three/);
    expect(hostFault(further, { boundary_loops: 0 })).toBeNull();
  });

  it("stands on the lowest tenth of its height", () => {
    expect(lowestVertices({ positions: Float64Array.from([0, 0, 1, 5, 0, -1, 0, 5, -0.81, 0, 0, -0.79]) })).toEqual([1, 2]);
  });

  it("that does not go with the mesh is told", () => {
    const [open, closed] = [{ boundary_loops: 1 }, { boundary_loops: 0 }];
    expect(hostFault(shell, open)).toBeNull();
    expect(hostFault({ ...shell, keepsVolume: true }, open)).toMatch(/no volume/);
    expect(hostFault({ ...shell, kind: "solid" }, open)).toMatch(/closed/);
    expect(hostFault({ ...shell, kind: "solid", gravity: 1, supports: [1, 2] }, closed)).toMatch(/three supports/);
    expect(hostFault({ ...shell, kind: "solid", gravity: 1 }, closed)).toBeNull();
  });
});

describe("held vertices as they are written", () => {
  it("are numbers and rows of them", () => {
    expect(readSupports("9, 3-5; 4")).toEqual([3, 4, 5, 9]);
    expect(readSupports("")).toEqual([]);
    expect(writeSupports([3, 4, 5, 9, 11, 12])).toBe("3-5, 9, 11, 12");
    for (const text of ["x", "5-3", "1-", "-2", "0-999999999"]) expect(readSupports(text)).toBeNull();
  });
});

describe("moved vertices as they are written", () => {
  it("are vertices with their places", () => {
    expect(readMoves("17: 0 -0.5 1e-3; 3: 1, 2, 3")).toEqual([{ vertex: 3, to: [1, 2, 3] }, { vertex: 17, to: [0, -0.5, 1e-3] }]);
    expect(readMoves("")).toEqual([]);
    expect(writeMoves([{ vertex: 3, to: [1, 2, 3] }, { vertex: 17, to: [0, -0.5, 1 / 3] }])).toBe("3: 1 2 3; 17: 0 -0.5 0.333333");
    for (const text of ["x", "3", "3: 1 2", "3: 1 2 x", "3: 1 2 3: 4", "-3: 1 2 3", "3: 1 2 Infinity"]) expect(readMoves(text)).toBeNull();
  });
});

describe("a link with a host", () => {
  const link = (network: NetworkState) => ({ mesh: MESH, tool: "network" as const, points: [], network });

  it("brings it back with its supports", () => {
    const moved: Host = { ...shell, moves: [{ vertex: 4, to: [0.25, -1e-5, 3] }, { vertex: 9, to: [0, 0, -2] }] };
    for (const host of [shell, moved, { ...shell, kind: "solid" as const, gravity: 0.25, keepsVolume: true, bends: false }]) {
      expect(readMeshLink(writeMeshLink(link(on(host))))?.network?.host).toEqual(host);
    }
    expect(writeMeshLink(link(on({ ...shell, kind: "rigid" })))).not.toContain("host=");
  });

  it("leaves out what is no value", () => {
    const read = readMeshLink(`mesh=${MESH}&tool=network&network=poisson_disk&host=shell,-1,x,3,0.9&supports=a`);
    expect(read?.network?.host).toEqual({ ...DEFAULT_NETWORK.host, kind: "shell", solidModulus: 3 });
    expect(readMeshLink(`mesh=${MESH}&tool=network&network=poisson_disk&host=jelly`)?.network?.host).toEqual(DEFAULT_NETWORK.host);
  });
});

describe("a surface that gave way", () => {
  const mesh: MeshData = { positions: Float64Array.from([0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0]), faces: Uint32Array.from([0, 1, 2, 1, 3, 2]) };
  const now: Vector[] = [[0, 0, 5], [2, 0, 5], [0, 1, 5], [2, 1, 5]];

  it("is measured by area and by stretch, whichever way it went", () => {
    for (const value of deformationOf(mesh, now, "area")) expect(value).toBeCloseTo(2, 12);
    const sheared: Vector[] = [[0, 0, 0], [2, 0, 0], [0, 0.5, 0], [2, 0.5, 0]];
    for (const value of deformationOf(mesh, sheared, "area")) expect(value).toBeCloseTo(1, 12);
    for (const value of deformationOf(mesh, sheared, "stretch")) expect(value).toBeCloseTo(2, 12);
  });

  it("is coloured alike for a half and a double, and neutrally where nothing changed", () => {
    expect(greatestFactor([1, 0.5, 1.25])).toBe(2);
    expect(greatestFactor([1, 0, Infinity])).toBeGreaterThan(1);
    expect(deformationColour(1, 2)).toEqual(DEFORMATION_RAMP[2]);
    expect(deformationColour(0.5, 2)).toEqual(DEFORMATION_RAMP[0]);
    expect(deformationColour(2, 2)).toEqual(DEFORMATION_RAMP[4]);
  });

  it("is told in numbers, term by term", () => {
    const terms = [{ name: "geodesic_springs", energy: 2 }, { name: "shell_bending", energy: 0.5 }, { name: "new_term", energy: -1 }];
    expect(hostFacts({ terms })).toEqual([]);
    expect(hostFacts({ terms, host: { vertices: [], largest_displacement: 0.25, volume_ratio: 0.9 } })).toEqual([
      ["Energy of springs", "2"],
      ["Energy of bending the shell", "0.5"],
      ["new term", "−1"],
      ["Largest displacement", "0.25"],
      ["Volume over that at rest", "0.9"],
    ]);
  });
});
