import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { explain, Problem } from "../src/contract/client";
import { inWords, placeWords, pointerWords } from "../src/contract/places";
import { entriesAtFault, faultsIn, hintWords, problemWords } from "../src/contract/refusals";
import type { ProblemDocument } from "../src/contract/types";

const read = (name: string) => readFileSync(new URL(`../../../api/${name}`, import.meta.url), "utf8");

/** All rows of the table of errors. */
const ROWS = [...read("errors.yaml").matchAll(/- code: (\S+)\n\s+status: \d+\n\s+title: (.*)\n\s+hint: (.*(?:\n {6,}.*)*)/g)].map(([, code, title, hint]) => ({
  code,
  title,
  hint: hint.replace(/\s*\n\s*/g, " ").replace(/^>-?\s*/, "").replace(/^"|"$|^'|'$/g, ""),
}));

/** All names of fields in the contract's schemas. */
const FIELDS = [...new Set([...read("openapi.yaml").matchAll(/^ {6,}([a-z][a-z0-9_]*):(?= |$)/gm)].map(([, name]) => name))];

/** Random numbers of a linear congruential generator, so that each run tests the same. */
function randomFrom(seed: number): (below: number) => number {
  let state = seed;
  return (below) => {
    state = (1664525 * state + 1013904223) % 2 ** 32;
    return Math.floor((state / 2 ** 32) * below);
  };
}

const POINTER = /(?<![\w.])\/[a-z~]/;
const SNAKE_CASE = /[a-z0-9]_[a-z0-9]/;
const PATH = /[a-z]{2,}\/\d/;

/** Whether a text shows a pointer, a path or the name of a field. */
function showsNames(text: string): boolean {
  return [POINTER, SNAKE_CASE, PATH].some((pattern) => pattern.test(text));
}

describe("what a page shows of a refusal", () => {
  it("has no pointer and no name of a field, for each code and random pointers", () => {
    expect(ROWS.length).toBeGreaterThan(150);
    expect(FIELDS.length).toBeGreaterThan(300);
    const random = randomFrom(42);
    const pick = <Value>(list: readonly Value[]): Value => list[random(list.length)];
    const found: string[] = [];
    for (const { code, title, hint } of ROWS) {
      for (let k = 0; k < 12; ++k) {
        const path = Array.from({ length: 1 + random(4) }, () => (random(3) === 0 ? `${pick(FIELDS)}/${random(30)}` : pick(FIELDS))).join("/");
        const field = pick(FIELDS);
        const detail = pick([`${path}: must be positive, in mm (and 2 more)`, `must lie within [0, 3] mm/min`, `${field} is 7, the limit is 3 (setting --max-body)`,
          `/${path} is not a field of this object`, `There is no ${field} here.`, `crossings/3 ${path} slides across strands/0`]);
        const errors = random(5) === 0 ? undefined : [{ pointer: pick([`/${path}`, path, "", "face 17", "edge 3 8", `query ${field}`]), detail }];
        const document = { type: "", status: 422, code, title, detail, hint, ...(errors && { errors }) } as ProblemDocument;
        found.push(...[explain(new Problem(document)), ...faultsIn(document).map(({ sentence }) => sentence)].filter(showsNames));
      }
    }
    expect(found).toEqual([]);
  });

  it("names the place as the page does", () => {
    expect(placeWords("/target/control_points/2")).toBe("control point 3");
    expect(placeWords("/regions/1/also/0/target/control_points/3/1")).toBe("the second value of control point 4 of target 2 of region 2");
    expect(placeWords("/printer/channel/apex")).toBe("the apex of the channel");
    expect(placeWords("/weave/strands/0/points/3")).toBe("point 3 of strand 1");
    expect(placeWords("/weave/crossings/1/members/0")).toBe("the first value of the members of crossing 2");
    expect(placeWords("/weave")).toBe("the weave");
    expect(placeWords("/text")).toBe("");
    expect(pointerWords("edge 3 8")).toBe("the edge between vertices 3 and 8");
  });

  it("is one sentence with the place, which is named once", () => {
    const problem = (detail: string, pointer: string, hint?: string) => ({ detail, errors: [{ pointer, detail }], ...(hint && { hint }) });
    const apart = "crossings/3 strands/1 must be lifted 3.2500 mm before and after it and has 2.4000 mm to where it lies on the bed: an end, a fused crossing or another channel";
    expect(problemWords(problem(apart, "/weave/crossings/3"))).toBe(
      "Crossing 4: strand 2 must be lifted 3.25 mm before and after it and has 2.4 mm to where it lies on the bed: an end, a fused crossing or another channel",
    );
    expect(problemWords(problem("must be positive", "/beam_width"))).toBe("The width of the beams must be positive");
    expect(problemWords(problem("It is no curve.", "/text", "Close the curves.")), "text of a file").toBe("It is no curve. Close the curves.");
    const units = "units/x: must be one of mm, N/cm^2, kgf/cm^2: the file names no unit. units/y: must be one of Pa, N/mm^2";
    expect(problemWords(problem(units, "/units/x"))).toBe(
      "The unit of strain must be one of mm, N/cm^2, kgf/cm^2: the file names no unit. The unit of stress must be one of Pa, N/mm^2",
    );
    expect(problemWords(problem("crossings/3 strands/1 must be lifted", "/weave"))).toBe("Crossing 4: strand 2 must be lifted");
    expect(entriesAtFault(problem("crossings/3 strands/1 must be lifted", "/weave"), "crossings")).toEqual([3]);
    expect(problemWords(problem("bed: reaches from 0 to 1.0000 mm", "/printer/bed"))).toBe("The bed reaches from 0 to 1 mm");
  });

  it("keeps names in quotation marks, which somebody has given", () => {
    expect(inWords('The material "soft_tpu/85" and the region “left/2 heel_pad” have no cell_size.')).toBe(
      'The material "soft_tpu/85" and the region “left/2 heel_pad” have no size of the cell.',
    );
    expect(inWords('It is "a b". cell_size/3 is missing')).toBe(inWords("It is x. cell_size/3 is missing").replace("x.", '"a b".'));
  });

  it("keeps units, kinds of files and settings of the server", () => {
    const kept = "At most 3000 mm/min and 2 N/mm; start the server with a higher --max-body and send application/json.";
    expect(inWords(kept)).toBe(kept);
  });

  it("keeps of a hint what helps a user", () => {
    expect(hintWords("Upload it with POST /v1/meshes; the answer's id names it.")).toBe("The answer's id names it.");
    expect(hintWords("Each entry of errors points to a field; the schemas are in /openapi.yaml.")).toBe("");
    expect(hintWords("Close the surface; the entries of errors name the edges.")).toBe("Close the surface.");
    expect(hintWords("Ask for a greater element_size, or give a mesh with longer edges.")).toBe("Ask for a greater size of the elements, or give a mesh with longer edges.");
  });

  it("tells which entries to mark", () => {
    const errors = ["/weave/crossings/3", "/weave/crossings/7", "/weave/crossings/3", "/printer/lift"].map((pointer) => ({ pointer, detail: "" }));
    expect(entriesAtFault({ errors }, "crossings")).toEqual([3, 7]);
    const points = ["/target/control_points/2/1", "/regions/1/target/control_points/4"].map((pointer) => ({ pointer, detail: "" }));
    expect(entriesAtFault({ errors: points }, "control_points", { list: "regions", index: 0 })).toEqual([2]);
  });
});
