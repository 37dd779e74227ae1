import { describe, expect, it } from "vitest";
import type { DesignAnswer, Profile, StructureAnswer } from "../src/contract/types";
import { commandOf, curlOf, pythonOf, searchOf } from "../src/design/copy_text";
import { readLink, writeLink } from "../src/design/link";
import { DEFAULT_SPECIFICATION, faultOf, searchesModulus, type Specification, specificationFields, modulusOf, sameSpecification } from "../src/design/specification";
import { INITIAL_PART, partRequest, settingsOf } from "../src/design/part";
import { regionOf, regionsOf, withRegions } from "../src/design/region_list";
import { designRequest, patchRequest, polishRequest, profileRequest, regionsRequest, structurePath, verificationRequest } from "../src/design/requests";
import { freshness, designResponses, profileResponses } from "../src/design/shown";
import { DEFAULT_STATE, type DesignState } from "../src/design/state";

const origin = "http://127.0.0.1:8080";
const found = { family: "IH22", parameters: [0.3, 0.4] };
const plain: DesignState = { ...DEFAULT_STATE, points: [[-0.1, -0.5], [0, 0], [0.2, 1]], found, fixed: [false, false] };
const given: Specification = { ...DEFAULT_SPECIFICATION, youngsModulus: 2500, density: 1.24, orientation: 30, size: { kind: "beam_width", value: 0.5 } };
const open: Specification = {
  ...DEFAULT_SPECIFICATION,
  youngsModulus: [20, 60],
  density: 1.21,
  orientation: [0, 180],
  size: { kind: "cell_size", value: 5 },
  relativeDensity: [0.1, 0.35],
  leastBeamWidth: 0.4,
};
/** The state after a search that has chosen the modulus and the orientation. */
const searched: DesignState = { ...plain, made: open, family: "IH22", found: { ...found, youngsModulus: 41, orientation: 1.25 } };

describe("a request", () => {
  it("has nothing of what is as the server takes it anyway", () => {
    expect(specificationFields(DEFAULT_SPECIFICATION)).toEqual({});
    const request = designRequest(plain, "search", "s");
    for (const field of ["material", "orientation", "initial_orientation", "beam_width", "cell_size", "limits"]) expect(request).not.toHaveProperty(field);
    expect(profileRequest(plain, found, DEFAULT_SPECIFICATION)).not.toHaveProperty("material");
    expect(patchRequest(plain, found)).not.toHaveProperty("material");
  });

  it("has what is given, with angles in radians", () => {
    expect(designRequest({ ...plain, made: given }, "follow", "s")).toMatchObject({ material: { youngs_modulus: 2500, density: 1.24 }, orientation: Math.PI / 6, beam_width: 0.5 });
    expect(designRequest({ ...plain, made: { ...DEFAULT_SPECIFICATION, density: 1.3 } }, "search", "s").material).toEqual({ density: 1.3 });
  });

  it("leaves ranges to the search, which begins where the last one ended", () => {
    const request = designRequest(searched, "search", "s");
    expect(request).toMatchObject({
      material: { youngs_modulus: [20, 60], density: 1.21 },
      orientation: [0, Math.PI],
      initial: [0.3, 0.4],
      initial_orientation: 1.25,
      cell_size: 5,
      limits: { relative_density: [0.1, 0.35], beam_width: [0.4, 100] },
    });
    expect(request).not.toHaveProperty("beam_width");
    const narrowed = designRequest({ ...searched, made: { ...open, orientation: [0, 45] } }, "search", "s");
    expect(narrowed.initial_orientation).toBe(Math.PI / 4);
    expect(designRequest({ ...searched, family: "any" }, "search", "s")).not.toHaveProperty("initial_orientation");
  });

  it("for a profile, a simulation or what was set by hand has what was found", () => {
    expect(profileRequest(searched, searched.found ?? found, open)).toMatchObject({ material: { youngs_modulus: 41, density: 1.21 }, orientation: expect.closeTo(1.25, 12) });
    expect(profileRequest(searched, found, open)).toMatchObject({ material: { youngs_modulus: 40 }, orientation: Math.PI / 2 });
    expect(verificationRequest(searched, searched.found ?? found)).toMatchObject({ material: { youngs_modulus: 41 }, orientation: expect.closeTo(1.25, 12) });
    expect(verificationRequest(searched, searched.found ?? found)).not.toHaveProperty("limits");
    expect(polishRequest(searched, searched.found ?? found)).toMatchObject({ material: { youngs_modulus: [20, 60] }, orientation: [0, Math.PI] });
    const patch = patchRequest({ ...searched, direction: 0.5 }, searched.found ?? found);
    expect(patch).toMatchObject({ material: { youngs_modulus: 41 }, load: { uniaxial: { direction: -0.75 } } });
    const two = withRegions([{ ...searched, byHand: true }, { ...plain, region: "Heel" }], 1);
    const { regions } = regionsRequest(regionsOf(two), "s");
    expect(regions?.[0]).toMatchObject({ material: { youngs_modulus: 41 }, orientation: expect.closeTo(1.25, 12), fixed: [0.3, 0.4] });
    expect(regions?.[1]).not.toHaveProperty("material");
  });

  it("for a file of the structure has the width of its beams", () => {
    expect(structurePath(found, "stl", [2, 2], 0.5)).toBe("/v1/families/IH22/structure?parameters=0.3,0.4&beam_width=0.5&cells=2,2&format=stl");
    expect(structurePath(found, "stl", [2, 2], 0.3)).toBe(structurePath(found, "stl", [2, 2]));
  });
});

describe("several materials", () => {
  const list: Specification = {
    ...DEFAULT_SPECIFICATION,
    materials: [{ name: "TPU & co: soft", youngsModulus: [20, 60], density: 1.21 }, { name: "PLA", youngsModulus: 2500, density: 1.24 }],
    cellSizes: [2, 8],
  };
  const chosen: DesignState = { ...plain, made: list, family: "IH22", found: { ...found, material: "PLA", youngsModulus: 2500 } };

  it("are in a request, and one of them is that of a design", () => {
    expect(designRequest(chosen, "search", "s")).toMatchObject({
      material: [{ name: "TPU & co: soft", youngs_modulus: [20, 60], density: 1.21 }, { name: "PLA", youngs_modulus: 2500, density: 1.24 }],
      limits: { cell_size: [2, 8] },
    });
    expect(profileRequest(chosen, chosen.found ?? found, list)).toMatchObject({ material: { youngs_modulus: 2500, density: 1.24 } });
    expect(verificationRequest(chosen, chosen.found ?? found)).not.toHaveProperty("limits");
    expect(modulusOf(list, null)).toBe(40);
    expect(modulusOf(list, { material: "ABS", youngsModulus: 2100 })).toBe(60);
    expect([searchesModulus(list), searchesModulus({ ...list, materials: [list.materials[1]] }), searchesModulus(DEFAULT_SPECIFICATION)]).toEqual([true, false, false]);
    expect(specificationFields({ ...list, size: { kind: "cell_size", value: 5 } })).not.toHaveProperty("limits");
  });

  it("are in links and in what is copied", () => {
    expect(readLink(writeLink(chosen))).toEqual(chosen);
    const two = { ...chosen, ...withRegions([regionOf(chosen), { ...regionOf(plain), region: "Heel" }], 0) };
    expect(readLink(writeLink(two))).toEqual(two);
    expect(readLink(writeLink(chosen).replace("materials=", "materials=x%3B"))?.made).toEqual(DEFAULT_SPECIFICATION);
    expect(JSON.parse(/<<'END'\n(.*)\nEND\n/.exec(commandOf(chosen, origin))?.[1] ?? "").material).toHaveLength(2);
    expect(commandOf({ ...plain, made: { ...DEFAULT_SPECIFICATION, cellSizes: [2, 8] } }, origin)).toContain('--cell-size-limits="2,8"');
    expect(pythonOf(chosen, origin)).toContain(
      'material=[supple.Material(name="TPU & co: soft", youngs_modulus=[20, 60], density=1.21), supple.Material(name="PLA", youngs_modulus=2500, density=1.24)]',
    );
  });

  it("have names of their own, moduli and densities", () => {
    const fault = (change: object) => faultOf({ ...list, materials: [list.materials[0], { ...list.materials[1], ...change }] });
    expect(fault({})).toBeNull();
    expect(fault({ name: "TPU & co: soft" })).toMatchObject({
      field: "materials",
      at: 1,
      part: "name",
      sentence: "Each material has a name of its own, of at most 40 characters.",
    });
    expect(fault({ youngsModulus: [60, 20] })).toMatchObject({
      at: 1,
      part: "youngsModulus",
      sentence: "Young’s modulus of PLA: the greatest value is at least the least one, 60 MPa.",
    });
    expect(fault({ density: 30 })).toMatchObject({ at: 1, part: "density" });
    expect(faultOf({ ...list, cellSizes: [8, 2] })?.field).toBe("cellSizes");
  });
});

describe("a link", () => {
  it.each([given, open, { ...open, leastBeamWidth: null, orientation: -20 }])("brings back what a structure is made of", (made) => {
    const state = { ...searched, made, ...(typeof made.orientation === "number" && { found: { ...found, ...(typeof made.youngsModulus !== "number" && { youngsModulus: 41 }) } }) };
    expect(readLink(writeLink(state))).toEqual(state);
  });

  it("is as before where nothing of it was changed", () => {
    expect(writeLink(plain)).not.toMatch(/modulus|density|orientation|width|cell/);
    expect(readLink(writeLink(plain))?.made).toEqual(DEFAULT_SPECIFICATION);
  });

  it("keeps the material of each region", () => {
    const two = { ...plain, ...withRegions([{ ...plain, made: given }, { ...plain, region: "Heel", made: open }], 1) };
    expect(regionsOf(readLink(writeLink(two)) ?? DEFAULT_STATE).map(({ made }) => made)).toEqual([given, open]);
  });

  it.each(["modulus=-3", "modulus=60,20", "modulus=x", "density=1,2", "orientation=0,270", "orientation=9e9", "beam-width=0", "cell-size=nan", "relative-density=0.3",
    "relative-density=0.1,7", "least-beam-width=0"])(
      "has the defaults for what no server would take: %s",
      (field) => {
        expect(readLink(`task=stress_strain&points=0,0;1,1&${field}`)?.made).toEqual(DEFAULT_SPECIFICATION);
      },
    );
});

describe("a search as text", () => {
  it("is a command with ranges as pairs and angles in degrees", () => {
    const state = { ...searched, family: "any" };
    const text = commandOf(state, origin);
    for (const option of ['youngs-modulus="20,60"', 'density="1.21"', 'orientation="0deg,180deg"', 'cell-size="5"', 'relative-density="0.1,0.35"', 'beam-width-limits="0.4,100"']) {
      expect(text).toContain(`--${option}`);
    }
    expect(commandOf({ ...plain, made: given }, origin)).toMatch(/--youngs-modulus="2500" \\\n {2}--density="1.24" \\\n {2}--orientation="30deg" \\\n {2}--beam-width="0.5"/);
    expect(commandOf(plain, origin)).not.toMatch(/--(youngs|density|orientation|beam|cell|relative)/);
    // The command line has no option for the initial orientation.
    expect(JSON.parse(/<<'END'\n(.*)\nEND\n/.exec(commandOf(searched, origin))?.[1] ?? "").initial_orientation).toBe(1.25);
  });

  it("is a request by curl and a program in Python", () => {
    const body = JSON.parse(/-d '(.*)'\n$/.exec(curlOf({ ...searched, family: "any" }, origin))?.[1] ?? "");
    expect(body).toEqual(searchOf({ ...searched, family: "any" }));
    expect(body.limits.beam_width).toEqual([0.4, 100]);
    const program = pythonOf(searched, origin);
    expect(program).toContain("material=supple.Material(youngs_modulus=[20, 60], density=1.21), orientation=[0, 3.141592653589793], initial_orientation=1.25, cell_size=5");
    expect(program).toContain("limits=supple.Limits(relative_density=[0.1, 0.35], beam_width=[0.4, 100]), options=options");
    expect(pythonOf(plain, origin)).not.toMatch(/material|orientation|limits/);
    expect(pythonOf({ ...plain, ...withRegions([{ ...plain, made: given }, plain], 0) }, origin)).toMatch(
      /supple\.Region\(.*material=supple\.Material\(youngs_modulus=2500, density=1\.24\), orientation=0\.52.*, beam_width=0\.5\)/,
    );
  });
});

describe("what a design is made of", () => {
  const profile = {
    x: [-0.1, 0, 0.2],
    target: [-0.5, 0, 1],
    achieved: [-0.5, 0, 1],
    initial: [0, 0, 0],
    error_bar: null,
    in_range: [true, true, true],
    reached: [true, true, true],
    verified: null,
    envelope: null,
  };
  const answer = {
    ...found,
    model: "m",
    orientation: 1.25,
    material: { youngs_modulus: 41, density: 1.21, law: "neo_hookean", poisson_ratio: 0.48 },
    error: { relative_rms: 0, max: 0 },
    message: "",
    stopped: "converged",
    iterations: 3,
    ranking: [],
    cost: { seconds: 1 },
    profile,
    also: [],
    structure: { svg: "", dxf: "", stl: "", beam_width: 0.45, cell_size: 5, relative_density: 0.2, density: 0.242 },
  } as unknown as DesignAnswer;

  it("is that of the answer, and of an earlier decision once another is wanted", () => {
    const [shown] = designResponses(answer, searched);
    expect(shown.found).toEqual(searched.found);
    expect(shown.measures).toEqual({
      material: "",
      youngsModulus: 41,
      materialDensity: 1.21,
      orientation: 1.25,
      beamWidth: 0.45,
      cellSize: 5,
      relativeDensity: 0.2,
      density: 0.242,
    });
    expect(freshness(shown, searched)).toBe("current");
    expect(freshness(shown, { ...searched, made: { ...open, density: 1.3 } })).toBe("outdated");
    expect(freshness(shown, { ...searched, made: { ...open } })).toBe("current");
    expect(designResponses(answer, plain)[0].found).toEqual(found);
  });

  it("is known of parameters set by hand as far as it was given", () => {
    const byHand = { ...searched, made: { ...open, size: given.size, leastBeamWidth: null }, byHand: true };
    const [shown] = profileResponses([{ ...found, model: "m", x: [-0.1, 0, 0.2], y: [-0.5, 0, 1], error_bar: [], in_range: [], cost: { seconds: 1 } } as unknown as Profile],
      byHand);
    expect(freshness(shown, byHand)).toBe("current");
    expect(shown.measures).toMatchObject({ youngsModulus: 41, orientation: 1.25, beamWidth: 0.5, cellSize: null, density: null });
  });

  it("is measured on the structure of parameters set by hand, whatever its size", () => {
    const profiles = [{ ...found, model: "m", x: [-0.1, 0, 0.2], y: [-0.5, 0, 1], error_bar: [], in_range: [], cost: { seconds: 1 } } as unknown as Profile];
    const structure = { beam_width: 0.3, cell_area: 9, relative_density: 0.25 } as StructureAnswer;
    const [cells] = profileResponses(profiles, { ...searched, byHand: true }, structure);
    expect(cells.measures).toMatchObject({ cellSize: 5, beamWidth: 0.5, relativeDensity: 0.25, density: 0.3025, materialDensity: 1.21 });
    const [beams] = profileResponses(profiles, { ...plain, byHand: true }, structure);
    expect(beams.measures).toMatchObject({ cellSize: 3, beamWidth: 0.3, density: 0.3 });
    expect(profileResponses(profiles, { ...plain, byHand: true }, null)[0].measures).toMatchObject({ beamWidth: 0.3, cellSize: null, density: null });
  });

  it("is what a part begins with", () => {
    const [shown] = designResponses(answer, searched);
    expect(settingsOf(shown)).toEqual({ beamWidth: 0.45, density: 1.21, orientation: 71.62, direction: 0 });
    expect(settingsOf({ ...shown, measures: { ...shown.measures, beamWidth: null } }).beamWidth).toBe(INITIAL_PART.beamWidth);
    expect(partRequest(found, { ...INITIAL_PART, ...settingsOf(shown) })).toMatchObject({
      beam_width: 0.45,
      material: { density: 1.21 },
      orientation: expect.closeTo(1.25, 4),
      direction: 0,
    });
    expect(partRequest(found, INITIAL_PART)).not.toHaveProperty("orientation");
  });

  it("is loaded in a part along its own direction, where it has one alone", () => {
    const [shown] = designResponses(answer, searched);
    const along = (direction: number) => ({ ...shown.targets[0], direction });
    const settings = (...targets: (typeof shown)["targets"][number][]) => ({ ...INITIAL_PART, ...settingsOf({ ...shown, targets }) });
    expect(settings(along(Math.PI / 6)).direction).toBe(30);
    expect(partRequest(found, settings(along(Math.PI / 6)))).toMatchObject({ direction: expect.closeTo(Math.PI / 6, 4) });
    expect(partRequest(found, { ...settings(along(Math.PI / 6)), kind: "rectangle" })).not.toHaveProperty("direction");
    expect(partRequest(found, { ...settings(along(Math.PI / 6)), kind: "rectangle", axis: 90 })).toMatchObject({
      axis: expect.closeTo(Math.PI / 2, 8),
      direction: expect.closeTo(Math.PI / 6, 4),
    });
    for (const several of [settings(along(0), along(1)), settings({ ...along(0), task: "stiffness" }), settings(along(0), { ...along(0), task: "poisson" })]) {
      expect(several.direction).toBeNull();
      expect(partRequest(found, several)).not.toHaveProperty("direction");
    }
  });
});

describe("what the server would refuse", () => {
  it("is told with the limit, in the field that it stands in", () => {
    expect(faultOf(open)).toBeNull();
    expect(faultOf({ ...open, youngsModulus: 0 })).toEqual({ field: "youngsModulus", sentence: "Young’s modulus is a number from 0.000001 MPa to 1,000,000 MPa." });
    expect(faultOf({ ...open, youngsModulus: [60, 20] })).toEqual({ field: "youngsModulus", sentence: "Young’s modulus: the greatest value is at least the least one, 60 MPa." });
    expect(faultOf({ ...open, orientation: [-20, 170] })?.sentence).toMatch(/at most 180° beyond/);
    expect(faultOf({ ...open, size: { kind: "cell_size", value: NaN } })).toEqual({ field: "size", sentence: "The size of a cell is a number from 0.01 mm to 2,000 mm." });
    expect(faultOf({ ...open, relativeDensity: [0.1, 1.2] })?.sentence).toBe("The relative density is a number from 0 % to 100 %.");
    expect(faultOf({ ...open, leastBeamWidth: 0 })?.field).toBe("leastBeamWidth");
    expect(sameSpecification(open, { ...open })).toBe(true);
    expect(sameSpecification(open, { ...open, leastBeamWidth: null })).toBe(false);
  });
});
