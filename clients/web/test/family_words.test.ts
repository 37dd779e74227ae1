// Sentences and texts of the family page: findings, refusals of files, links, names, atlases and trainings.
import { describe, expect, it } from "vitest";
import { Problem } from "../src/contract/client";
import { placeWords } from "../src/contract/places";
import type { FamilyAtlas, FamilyDefinition, Job, ProblemDocument } from "../src/contract/types";
import { gainOf, gainSentences, profileWords, QUANTITIES, shortProfileWords } from "../src/family/atlas_words";
import { commandOf, fileOf, pythonOf } from "../src/family/copy_text";
import { DefinitionError, readDefinition, readDefinitionText } from "../src/family/definition_reader";
import { findingSentence, findingsOf, isShownAt, summaryOf } from "../src/family/findings";
import { nameFault, withFreeName } from "../src/family/library";
import { isShareable, readLink, writeLink } from "../src/family/link";
import { stateOf, typeWords } from "../src/family/state";
import { errorsOf, stageWords, trainingRequest, trainsNoNetworks, withError } from "../src/family/training_session";
import { coreTimeWords, outcomeSentence, planSentence, runWords } from "../src/family/training_words";
import { bestWords, workWords } from "../src/jobs/job_words";
import { exampleCheck, SHIPPED } from "./family_fixtures";

const ARCHES = exampleCheck("arches").body.definition;

describe("what the check has found", () => {
  it("is a sentence without pointers and coordinates, which counts edges from 1 as the page does", () => {
    const sentences = [
      ["/definition/tile/vertices/1", "leaves a gap at (1.2, 0.5): no tile covers this place", "Vertex 2 leaves a gap: no tile covers this place."],
      ["/definition/tile/edges/2", "overlaps at (-1.5, 2e-05): 2 tiles cover this place", "Edge 3 overlaps: 2 tiles cover this place."],
      ["/definition/tile", "crosses itself: edges 0 and 3 meet at (0.1, -0.2) where the parameters are (0.3, 0.4); tiles cross themselves in 12 % of the box",
        "The tile crosses itself: edges 1 and 4 meet; tiles cross themselves in 12 % of the bounds."],
      ["/definition/tile/vertices/0", "begins a side of 0.489771 beam widths (slivers are below 1.5) where the parameters are (0.2); there are some in 0 % of the box",
        "Vertex 1 begins a side of 0.49 beam widths (slivers are below 1.5); there are some in less than 1 % of the bounds."],
      ["/definition/tile", "crosses itself: edge 2 meets itself at (0, 1) where the parameters are ()", "The tile crosses itself: edge 3 meets itself."],
      ["/definition/tile/edges/0", "has an edge near (0.5, 0.5) that is no edge of exactly one other tile", "Edge 1 has an edge that is no edge of exactly one other tile."],
      ["/definition/parameters/1", "is a parameter that nothing depends on", "Parameter 2 is a parameter that nothing depends on."],
      ["/definition/beam_width", "must be positive for all parameters within their bounds, but becomes -0.1",
        "The width of the beams must be positive for all parameters within their bounds, but becomes -0.1."],
    ];
    for (const [pointer, message, sentence] of sentences) expect(findingSentence({ pointer, message })).toBe(sentence);
    expect(placeWords("/definition/shapes/1/sines/0")).toBe("the first value of the sines of shape of edges 2");
  });

  it("is marked where its parameters are shown, and told as a whole", () => {
    const { faults } = exampleCheck("squares").response;
    const [finding] = findingsOf({ faults: faults.map((fault) => ({ ...fault, message: "leaves a gap", point: [1.2, 0.5] })), warnings: [] });
    expect(finding).toMatchObject({ kind: "fault", flaw: "gap", parameters: [1.4], point: [1.2, 0.5] });
    expect([isShownAt(finding, [1.4]), isShownAt(finding, [1.3]), isShownAt({ ...finding, parameters: null }, [1])]).toEqual([true, false, true]);
    expect(summaryOf([finding])).toBe("A fault: this is no family yet.");
    expect(summaryOf([{ ...finding, kind: "warning" }, { ...finding, kind: "warning" }])).toBe("The tiles fill the plane within all bounds. 2 places are to be avoided.");
    expect(summaryOf([])).toMatch(/^The tiles fill the plane within all bounds, and nothing/);
  });
});

describe("a definition from a file", () => {
  it("is read as it is, also from a request of the server", () => {
    expect(readDefinition(JSON.parse(JSON.stringify(ARCHES)))).toEqual(ARCHES);
    expect(readDefinitionText(JSON.stringify({ definition: ARCHES, parameters: [1] }))).toEqual(ARCHES);
    for (const definition of SHIPPED) expect(readDefinitionText(fileOf(definition)).tile?.vertices).toEqual(definition.tile?.vertices);
  });

  it("is refused with a sentence about the first place that is none", () => {
    const refused = (change: object): string => {
      try {
        readDefinition({ ...SHIPPED[1], ...change });
      } catch (error) {
        if (error instanceof DefinitionError) return error.message;
        throw error;
      }
      return "";
    };
    expect(refused({})).toBe("");
    expect(refused({ id: "a b" })).toBe("This is no definition of a family: the id must be 1 to 32 letters, digits, “_” or “-”.");
    expect(refused({ beam_width: "wide" })).toMatch(/the width of the beams must be a number/);
    expect(refused({ tile: { ...SHIPPED[1].tile, vertices: [[0, 0], [1]] } })).toMatch(/the vertices must be a list of 3 to 12/);
    expect(refused({ tile: { ...SHIPPED[1].tile, vertices: [[0, 0], [1, 0], [1]] } })).toMatch(/vertex 3 must be a list of 2/);
    expect(refused({ beam_width: [1, 2, 3, 4] })).toMatch(/must be a list of 1 to 3/);
    expect(refused({ isohedral_type: 21 })).toMatch(/must have either a tile or an isohedral type/);
    expect(refused({ shapes: [{ class: "K" }] })).toMatch(/shape of edges 1 must be of the class J, S, U or I/);
    expect(refused({ parameters: [{ lower: 0, upper: 1, default: Number.NaN }] })).toMatch(/default of parameter 1 must be a number/);
    expect(() => readDefinitionText("{")).toThrow("This is no definition of a family: it is not JSON.");
    expect(() => readDefinitionText("[]")).toThrow(/must be an object/);
  });

  it("is saved with a line for each point", () => {
    const lines = fileOf(SHIPPED[1]).split("\n").map((line) => line.trim());
    expect(lines).toContain("[1, 0],");
    expect(lines).toContain("[[-2.5, 0, 5], [-0.1, 5.1]],");
  });
});

describe("a link", () => {
  it("has the whole definition, the shown parameters and the budget of the training", () => {
    const state = { definition: ARCHES, shown: [0.35, 0.1, 0.3], coreHours: 2.5, error: 0.02 };
    expect(readLink(writeLink(state))).toEqual(state);
    expect(writeLink(stateOf(ARCHES))).not.toMatch(/core-hours|error=/);
    expect(isShareable(state)).toBe(true);
    expect(isShareable({ ...state, definition: { ...ARCHES, description: "%".repeat(10_000) } })).toBe(false);
  });

  it("that is none is refused, and numbers beyond bounds come back into them", () => {
    for (const text of ["", "definition=", "definition=%7B%7D", "definition=%", "task=stress_strain"]) expect(readLink(text)).toBeNull();
    const link = writeLink({ ...stateOf(ARCHES), shown: [9, 0, Number.NaN] });
    expect(readLink(link)?.shown).toEqual([0.4, 0.05, 0.2]);
    expect(readLink(writeLink({ ...stateOf(ARCHES), shown: [9, 0, 0.2] }))?.shown).toEqual([0.5, 0, 0.2]);
  });
});

describe("names and commands", () => {
  it("of families are free, and none of those that come with the server", () => {
    expect(nameFault("IH21", ["IH01", "IH21"])).toBe("IH21 comes with the server: choose another name.");
    expect(nameFault("ih21", ["IH21"])).toMatch(/^IH21/);
    expect(["any", "", "a b"].map((id) => nameFault(id, []) === "")).toEqual([false, false, false]);
    expect(nameFault("my-ih21", ["IH21"])).toBe("");
    const named = (id: string, taken: string[]) => withFreeName({ ...ARCHES, id }, taken).id;
    expect(named("arches", ["IH21"])).toBe("arches");
    expect(named("IH21", ["IH21"])).toBe("my-ih21-2");
    expect(named("my-ih21-2", ["my-ih21-2"])).toBe("my-ih21-3");
  });

  it("of types say how many parameters they have", () => {
    expect([0, 1, 4].map((count) => typeWords({ number: 3, defaults: Array(count).fill(0) }))).toEqual(["IH03, no parameters", "IH03, 1 parameter", "IH03, 4 parameters"]);
  });

  it("add the family in a shell and in Python", () => {
    expect(commandOf(ARCHES, "http://x")).toMatch(/^cat > arches\.json <<'END'\n\{.*\}\nEND\nsupple --server http:\/\/x families add arches\.json\n$/s);
    expect(pythonOf(ARCHES, "http://x")).toContain("client.add_family(definition)");
  });
});

describe("an atlas", () => {
  const profile = (deviation: number, other: number | null): FamilyAtlas["profiles"][number] => ({
    name: "poisson_-0.5",
    deviation,
    met: deviation <= 0.02,
    sample: 0,
    orientation: 0,
    others: other === null ? null : { family: "IH01", deviation: other, met: other <= 0.02 },
  });
  const sample = { parameters: [], place: "good" as const, relative_density: 0.3, compliance: null, stiffness: [1, 4], poisson_ratio: [-0.2, 0.3], error: null };

  it("says what the family adds", () => {
    expect([profile(0.01, 0.3), profile(0.01, 0.01), profile(0.01, null), profile(0.1, 0.3), profile(0.3, 0.1), profile(0.3, null)].map(gainOf)).toEqual([
      "new",
      "met",
      "met",
      "nearer",
      "no",
      "no",
    ]);
    const comparison = { families: ["IH01", "IH21"], median_distance: 0.1, largest_distance: 0.3, farthest_sample: 0, new_fraction: 0.42, same_as: null };
    expect(gainSentences({ profiles: [profile(0.01, 0.3), profile(0.1, 0.3)], comparison, samples: [sample] })).toEqual([
      "The family meets 1 of 2 reference profiles at rest, 1 of which no other family meets.",
      "It comes nearer than all others to 1 further one.",
      "42 % of its tilings are far from those of 2 other families.",
    ]);
    expect(gainSentences({ profiles: [], comparison: { ...comparison, same_as: "IH01" }, samples: [sample] }).at(-1)).toBe("It is the same as IH01 under another name.");
    expect(gainSentences({ profiles: [], comparison: null, samples: [{ ...sample, stiffness: null }] })[0]).toMatch(/^No tiling within the bounds could be solved/);
  });

  it("names its profiles and quantities", () => {
    expect(profileWords("poisson_-0.15")).toBe("Poisson’s ratio −0.15 in all directions");
    expect(shortProfileWords("poisson_0")).toBe("Poisson 0");
    expect(profileWords("stiffness_elliptic_10")).toBe("Stiffness 10 times as high along one axis");
    expect(profileWords("stiffness_one_way")).toBe("Stiffness high along one axis alone");
    expect(QUANTITIES.map(({ of }) => of(sample))).toEqual([-0.2, 0.3, 4, 1, 4, 0.3]);
    expect(QUANTITIES.map(({ of }) => of({ ...sample, stiffness: null, poisson_ratio: null, relative_density: 0 }))).toEqual([null, null, null, null, null, null]);
  });
});

describe("a training", () => {
  it("asks for the core time and the error of the state", () => {
    const state = { ...stateOf(ARCHES), coreHours: 2.5 };
    expect(trainingRequest(state)).toEqual({ family: "arches", budget: { core_seconds: 9000 } });
    expect(trainingRequest({ ...state, error: 0.02 })).toEqual({ family: "arches", budget: { core_seconds: 9000 }, accuracy: { error: 0.02 } });
  });

  it("tells its plan, its stage, the errors that it has reached, and its outcome", () => {
    expect([90, 3600, 14_400].map(coreTimeWords)).toEqual(["2 min", "1 h", "4 h"]);
    expect(planSentence({ estimate: { simulation: 7200, training: 1800, designs: 1440, chosen_designs: 720 } })).toBe(
      "About 2.5 h of one core: 2 h for simulations of 1,440 designs and 30 min for networks.",
    );
    expect(stageWords("committee")).toBe("Training: small networks choose designs");
    expect(stageWords("")).toBe("Training");
    const partial = { family: "arches", errors: [{ designs: 60, error: 0.08 }, { designs: 90, error: 0.051 }] };
    expect(errorsOf({ partial } as Job)).toEqual(partial.errors);
    expect(errorsOf({} as Job)).toEqual([]);
    expect(bestWords({ partial } as Job, "")).toBe("Best so far: a mean error of 5.1 %, with 90 designs");
    expect(withError(partial.errors, { designs: 90, error: 0.051 })).toHaveLength(2);
    expect(withError(partial.errors, { designs: 90, error: 0.03 })).toHaveLength(3);
    const run = { family: "arches", goal: 0, errors: partial.errors, answer: null, isCancelled: false };
    expect(runWords(run, true)).toBe("arches is being trained. So far: 5.1 % in the mean, with 90 designs.");
    expect(runWords({ ...run, isCancelled: true }, false)).toMatch(/is stopped\. What is done is kept/);
    expect(outcomeSentence({ model: "arches-1", error: 0.021, designs: 1200 })).toBe(
      "The network arches-1 has learned from 1,200 designs. On designs that were held out, its stress errs by 2.1 % in the mean.",
    );
  });

  it("says where a server trains no networks", () => {
    const problem = (code: string) => new Problem({ type: "", status: 503, code, title: "t", detail: "d" } as ProblemDocument);
    expect([trainsNoNetworks(problem("training.unavailable")), trainsNoNetworks(problem("http.not_found")), trainsNoNetworks(problem("training.small_budget"))]).toEqual([true,
      true, false]);
  });

  it("has its family's name in the tray of jobs, and so has an atlas", () => {
    expect(workWords("/v1/trainings", { family: "arches" })).toBe("Training of a network: arches");
    expect(workWords("/v1/family-atlases", { definition: { id: "arches" } as FamilyDefinition })).toBe("Atlas: arches");
    expect(workWords("/v1/family-atlases", { isohedral_type: 4 })).toBe("Atlas");
  });
});
