import { describe, expect, it } from "vitest";
import { decades, powerWords } from "../src/base/convergence_plot";
import { readMeshLink, writeMeshLink } from "../src/mesh/link";
import type { Vector } from "../src/mesh/mesh_data";
import { fileRequest, constructionRequest, type Network, networkKey, relaxationRequest, springsOf, straightValues } from "../src/mesh/network";
import { frameAt, Frames } from "../src/mesh/network_frames";
import { withChange, DEFAULT_NETWORK, type NetworkState, onAnotherMesh, withToggledFixed, withExistingPoints, withoutPoint, withToggledSpring } from "../src/mesh/network_state";
import { readFixed, readSprings, writeSprings } from "../src/mesh/network_text";
import { rampColour, rangeOf, fractionOf, SPRING_RAMP } from "../src/mesh/spring_colours";

const MESH = "ab".repeat(32);
const picked: NetworkState = {
  ...DEFAULT_NETWORK,
  points: "picked",
  springs: "drawn",
  drawn: [{ between: [0, 1] }, { between: [1, 2], restLength: 0.5, weight: 3 }],
  restLength: 0.25,
  weight: 2,
  fixed: [0, 2],
};
const network: Network = {
  points: [{ vertex: 0 }, { vertex: 1 }, { face: 0, barycentric: [0.2, 0.3, 0.5] }],
  positions: [[0, 0, 0], [3, 4, 0], [3, 4, 2]],
  pairs: [[0, 1], [1, 2]],
  triangles: [],
};

describe("a network’s state", () => {
  it("forgets fixed points once points have other numbers, and keeps them while only springs change", () => {
    const made: NetworkState = { ...DEFAULT_NETWORK, fixed: [3, 5] };
    expect(withChange(made, { radius: 0.5 }).fixed).toEqual([]);
    expect(withChange(made, { points: "per_face" }).fixed).toEqual([]);
    expect(withChange(made, { springs: "adjacent_faces", restLength: 0.1 }).fixed).toEqual([3, 5]);
    expect(withChange(made, { points: "picked" }).springs).toBe("voronoi_dual");
    expect(withChange(picked, { points: "poisson_disk" }).springs).toBe("voronoi_dual");
  });

  it("has springs along shortest paths beside a membrane, whose sides are", () => {
    const straight = withChange(picked, { springLength: "euclidean" });
    expect(withChange(straight, { elements: "both" }).springLength).toBe("geodesic");
    expect(withChange(straight, { restLength: 1 }).springLength).toBe("euclidean");
  });

  it("fixes a point or lets it go, and draws a spring or takes it away", () => {
    expect(withToggledFixed(withToggledFixed(picked, 1), 0).fixed).toEqual([1, 2]);
    expect(withToggledSpring(picked, 2, 0).drawn.at(-1)).toEqual({ between: [0, 2] });
    expect(withToggledSpring(picked, 2, 1).drawn).toEqual([{ between: [0, 1] }]);
    expect(withToggledSpring(picked, 1, 1)).toBe(picked);
  });

  it("has the numbers of its points once one is gone", () => {
    expect(withoutPoint(picked, 0)).toMatchObject({ fixed: [1], drawn: [{ between: [0, 1], restLength: 0.5, weight: 3 }] });
    expect(withExistingPoints(picked, 2)).toMatchObject({ fixed: [0], drawn: [{ between: [0, 1] }] });
  });

  it("goes to another mesh without lengths and numbers of the old one", () => {
    const other = onAnotherMesh({ ...picked, method: "lbfgs" }, { area: 100, bounding_box: { lower: [], upper: [], diagonal: 10 } });
    expect(other).toMatchObject({ method: "lbfgs", fixed: [], drawn: [], restLength: 0 });
    expect((4 * 0.7 * 100) / (Math.PI * other.radius ** 2)).toBeCloseTo(250, -1);
  });
});

describe("requests of a network", () => {
  it("make it without moving it", () => {
    expect(constructionRequest(MESH, DEFAULT_NETWORK, [])).toEqual({
      mesh: MESH,
      points: { kind: "poisson_disk", radius: 1, seed: 1 },
      springs: { kind: "voronoi_dual", weight: 0 },
      max_iterations: 1,
    });
    expect(constructionRequest(MESH, picked, network.points)).toMatchObject({ points: network.points, springs: [{ between: [0, 1], weight: 0 }, { between: [1, 2], weight: 0 }] });
  });

  it("relax it with the values that each spring has", () => {
    const request = relaxationRequest(MESH, picked, network);
    expect(request.springs).toEqual([{ between: [0, 1], rest_length: 0.25, weight: 2 }, { between: [1, 2], rest_length: 0.5, weight: 3 }]);
    expect(request).toMatchObject({
      points: network.points,
      fixed_points: [0, 2],
      method: "newton",
      paths: true,
      accuracy: { tolerance: 1e-9, mollifier_length: 1e-6 },
      effects: { mollifier: "automatic", kept_strips: "automatic" },
    });
    expect(springsOf({ ...picked, springs: "voronoi_dual" }, network.pairs)[1]).toEqual({ between: [1, 2], rest_length: 0.25, weight: 2 });
  });

  it("save it as it is, with every point held", () => {
    expect(fileRequest(relaxationRequest(MESH, picked, network), [{ vertex: 7 }, { vertex: 8 }, { vertex: 9 }])).toMatchObject({
      points: [{ vertex: 7 }, { vertex: 8 }, { vertex: 9 }],
      fixed_points: [0, 1, 2],
      max_iterations: 1,
    });
  });

  it("are the same network for another rest length, another one for another seed", () => {
    const key = (state: NetworkState) => networkKey(MESH, state, network.points);
    expect(key({ ...DEFAULT_NETWORK, restLength: 3, fixed: [1] })).toBe(key(DEFAULT_NETWORK));
    expect(key({ ...DEFAULT_NETWORK, seed: 2 })).not.toBe(key(DEFAULT_NETWORK));
    expect(key({ ...picked, drawn: [] })).not.toBe(key(picked));
  });
});

describe("springs on the way", () => {
  it("have the lengths of straight segments, and the energies of their own values", () => {
    const { lengths, energies } = straightValues(network.positions, springsOf(picked, network.pairs));
    expect(lengths).toEqual([5, 2]);
    expect(energies).toEqual([2 * 4.75 ** 2, 3 * 1.5 ** 2]);
  });

  it("are coloured from the least to the most, by one colour where all are equal", () => {
    const range = rangeOf([2, 6, 4]);
    expect([2, 4, 6].map((value) => fractionOf(value, range))).toEqual([0, 0.5, 1]);
    expect(fractionOf(1 + 1e-14, rangeOf([1, 1 + 1e-14]))).toBe(0);
    expect(rangeOf([])).toEqual({ min: 0, max: 0 });
    expect(rampColour(1)).toEqual(SPRING_RAMP.at(-1));
    expect(rampColour(0.125)[0]).toBeCloseTo((SPRING_RAMP[0][0] + SPRING_RAMP[1][0]) / 2, 12);
  });
});

describe("frames", () => {
  it("are thinned out evenly once they are too many for memory", () => {
    const frames = new Frames();
    const positions = Array.from({ length: 200_000 }, (): Vector => [0, 0, 0]);
    for (let iteration = 0; iteration < 40; ++iteration) frames.add({ iteration, positions });
    const kept = frames.all.map((frame) => frame.iteration);
    expect(kept.length).toBeLessThanOrEqual(5);
    expect(kept[0]).toBe(0);
    const gaps = kept.slice(1).map((iteration, k) => iteration - kept[k]);
    expect(new Set(gaps).size).toBe(1);
    expect(kept[kept.length - 1] + gaps[0]).toBeGreaterThan(39);
  });
});

describe("the frame of an iteration", () => {
  it("is the nearest that is known, or the end", () => {
    const frames = [0, 4, 9].map((iteration) => ({ iteration, positions: [] }));
    expect([0, 1, 3, 6, 7, 9, 10].map((iteration) => frameAt(frames, 10, iteration)?.iteration ?? "end")).toEqual([0, 0, 4, 4, 9, 9, "end"]);
    expect(frameAt([], 10, 3)).toBeNull();
  });
});

describe("the logarithmic axis", () => {
  it("holds every value in whole powers of ten, also where some are 0", () => {
    expect(decades([3, 0.02, 0, 1e-9])).toEqual([-9, 1]);
    expect(decades([1])).toEqual([0, 1]);
    expect(decades([0])).toEqual([-1, 0]);
    expect(powerWords(1e-12)).toBe("10⁻¹²");
    expect(powerWords(100)).toBe("10²");
  });
});

describe("what is written by hand", () => {
  it("is read as points and springs, or refused", () => {
    expect(readFixed(" 5, 0,5 ")).toEqual([0, 5]);
    expect(readFixed("")).toEqual([]);
    expect(readFixed("1, x")).toBeNull();
    expect(readSprings("2-0, 1-2:0.5:3, 0-1::4")).toEqual([{ between: [0, 2] }, { between: [1, 2], restLength: 0.5, weight: 3 }, { between: [0, 1], weight: 4 }]);
    expect(readSprings(writeSprings(picked.drawn))).toEqual(picked.drawn);
    for (const text of ["0", "1-1", "0-1:-2", "0-1:x"]) expect(readSprings(text)).toBeNull();
  });
});

describe("the accuracy of a relaxation", () => {
  const network = { points: [], positions: [], pairs: [], triangles: [] };
  const asked = (state: NetworkState) => relaxationRequest(MESH, state, network).accuracy;

  it("is that of its level, and that of its own values only where these are chosen", () => {
    const own: NetworkState = { ...DEFAULT_NETWORK, tolerance: 0.1, mollifierLength: 0.01 };
    expect(asked(own)).toEqual({ tolerance: 1e-9, mollifier_length: 1e-6 });
    expect(asked({ ...own, accuracy: { level: "sure", switches: {} } })).toEqual({ tolerance: 1e-12, mollifier_length: 1e-6 });
    expect(asked({ ...own, accuracy: { level: "own", switches: {} } })).toEqual({ tolerance: 0.1, mollifier_length: 0.01 });
    const draft: NetworkState = { ...own, accuracy: { level: "draft", switches: {} } };
    expect([asked(draft)?.tolerance, asked({ ...draft, host: { ...draft.host, kind: "shell" } })?.tolerance]).toEqual([1e-3, 1e-4]);
  });
});

describe("a link with a network", () => {
  it("brings it back", () => {
    const points = [...network.points];
    const link = { mesh: MESH, tool: "network" as const, points, network: { ...picked, method: "lbfgs" as const, tolerance: 1e-6, mollifier: "off" as const } };
    expect(readMeshLink(writeMeshLink(link))).toEqual(link);
    expect(writeMeshLink({ ...link, tool: "path" })).not.toContain("network=");
  });

  it("leaves out what is no value and what has no point", () => {
    const read = readMeshLink(`mesh=${MESH}&tool=network&points=v0;v1&network=picked,-1,x,drawn,2,1,simplex,euclidean,5,9e9,on,0.1,off&fixed=0,9&springs=0-1,0-7`);
    expect(read?.network).toEqual({
      ...DEFAULT_NETWORK,
      points: "picked",
      springs: "drawn",
      restLength: 2,
      weight: 1,
      springLength: "euclidean",
      accuracy: { level: "own", switches: {} },
      mollifier: "on",
      mollifierLength: 0.1,
      keptStrips: "off",
      fixed: [0],
      drawn: [{ between: [0, 1] }],
    });
    expect(readMeshLink(`mesh=${MESH}`)?.network).toBeNull();
  });
});
