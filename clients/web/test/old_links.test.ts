// Links that version 0.1 wrote, and stored in pins: they list values by their position. Present links name each value.
import { describe, expect, it } from "vitest";
import { readValues, writeValues } from "../src/base/link_fields";
import { readLink as readDesign, writeLink as writeDesign } from "../src/design/link";
import { readMeshLink, writeMeshLink } from "../src/mesh/link";
import { readLink as readWeave, writeLink as writeWeave } from "../src/weave/link";

const MESH = "ab".repeat(32);

describe("a link of version 0.1", () => {
  it("opens a network on a shell, as it was shared", () => {
    const old = `mesh=${MESH}&tool=network&points=v3;2:0.5,0.25,0.25&network=picked,0.25,7,drawn,0.5,2,lbfgs,geodesic,0.000001,50,on,0.01,off,both,3,0.4,0.1,0.8&fixed=0` +
      "&springs=0-1:0.5:3&host=shell,0.03,4000,5000,0.2,10,1.5,0.5,volume,limp&supports=1-3,9&moves=9:0:1.5:2";
    const read = readMeshLink(old);
    expect(read?.points).toEqual([{ vertex: 3 }, { face: 2, barycentric: [0.5, 0.25, 0.25] }]);
    expect(read?.network).toEqual({
      points: "picked",
      radius: 0.25,
      seed: 7,
      springs: "drawn",
      restLength: 0.5,
      weight: 2,
      method: "lbfgs",
      springLength: "geodesic",
      accuracy: { level: "own", switches: {} },
      tolerance: 1e-6,
      maxIterations: 50,
      mollifier: "on",
      mollifierLength: 0.01,
      keptStrips: "off",
      elements: "both",
      youngsModulus: 3,
      poissonRatio: 0.4,
      thickness: 0.1,
      restScale: 0.8,
      fixed: [0],
      drawn: [{ between: [0, 1], restLength: 0.5, weight: 3 }],
      host: {
        kind: "shell",
        thickness: 0.03,
        shellModulus: 4000,
        solidModulus: 5000,
        poissonRatio: 0.2,
        volumeWeight: 10,
        volumeScale: 1.5,
        gravity: 0.5,
        keepsVolume: true,
        bends: false,
        supports: [1, 2, 3, 9],
        moves: [{ vertex: 9, to: [0, 1.5, 2] }],
      },
    });
    expect(read && readMeshLink(writeMeshLink(read))).toEqual(read);
    const free = readMeshLink(old.replace("volume,limp", "free,bends"))?.network?.host;
    expect(free).toMatchObject({ keepsVolume: false, bends: true });
  });

  it("opens a Voronoi diagram with its objectives and fixed sites", () => {
    const read = readMeshLink(`mesh=${MESH}&tool=voronoi&voronoi=12,3,1,bounded,1,2,0.5,3,4,0.2,lbfgs,0.000001,30,0.0001&held=0,4`);
    expect(read?.voronoi).toEqual({
      count: 12,
      seed: 3,
      scattered: true,
      accuracy: { level: "own", switches: {} },
      exactness: "bounded",
      weights: { centroidal: 1, regularity: 2, equal_area: 0.5, edge_length: 3, planarity: 4 },
      targetLength: 0.2,
      minimizer: "lbfgs",
      tolerance: 1e-6,
      maxIterations: 30,
      deviation: 1e-4,
      fixed: [0, 4],
    });
    expect(read && readMeshLink(writeMeshLink(read))).toEqual(read);
  });

  it("opens a weave with its sheet and the limits of its crossings", () => {
    const read = readWeave(
      "pattern=interlacing_squares&type=2&side=12&overlap=3&radius=0.25&modulus=3500&strain=0.1&segments=4&sheet=4,2,shear,0.3&crossings=3:0,1~none~0.5;5:~~0.25",
    );
    expect(read?.sheet).toEqual({ columns: 4, rows: 2, load: "shear", amount: 0.3 });
    expect(read?.overrides).toEqual([{ crossing: 3, slides: [0, 1], backward: null, forward: 0.5 }, { crossing: 5, slides: [], forward: 0.25 }]);
    expect(read && readWeave(writeWeave(read))).toEqual(read);
  });

  it("opens a design with its materials", () => {
    const read = readDesign(
      "task=stress_strain&direction=0&measure=green&curve=cubic&points=0,0;0.1,0.5&materials=TPU%253A%2520soft%3A20%2C30%3A1.2%3BPLA%3A2500%3A1.24&family=IH21" +
        "&design=IH21&parameters=0.1,0.7&found-material=PLA&found-modulus=2500&fixed=1,0",
    );
    expect(read?.made.materials).toEqual([{ name: "TPU: soft", youngsModulus: [20, 30], density: 1.2 }, { name: "PLA", youngsModulus: 2500, density: 1.24 }]);
    expect(read).toMatchObject({ family: "IH21", found: { family: "IH21", parameters: [0.1, 0.7], material: "PLA", youngsModulus: 2500 }, fixed: [true, false] });
    expect(read && readDesign(writeDesign(read))).toEqual(read);
  });
});

describe("values of a link", () => {
  it("are found by their names, wherever they stand and whichever are left out", () => {
    const names = ["columns", "rows", "load"];
    expect(writeValues({ columns: 3, load: "shear", amount: 0.1 + 0.2 })).toBe("columns:3,load:shear,amount:0.3");
    expect([...readValues("load:shear,columns:3", names)]).toEqual([["load", "shear"], ["columns", "3"]]);
    expect(readValues("3,2", names).get("rows")).toBe("2");
    expect(readValues("3", names).has("rows")).toBe(false);
  });

  it("name every value of a present link", () => {
    const network = readMeshLink(`mesh=${MESH}&tool=network&network=poisson_disk&host=solid`)?.network ?? null;
    const link = writeMeshLink({ mesh: MESH, tool: "network", points: [], network });
    for (const field of ["network", "host"]) {
      const values = new URLSearchParams(link).get(field)?.split(",") ?? [];
      expect(values.length).toBeGreaterThan(8);
      expect(values.every((value) => /^[a-z-]+:\S+$/.test(value))).toBe(true);
    }
  });
});
