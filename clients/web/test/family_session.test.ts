// The family session with a mock of the server: drawing at once, checks after a pause, steps of the history, and what is stored.
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { Client } from "../src/contract/client";
import type { FamilyDefinition, Model } from "../src/contract/types";
import { AtlasSession } from "../src/family/atlas_session";
import { Library } from "../src/family/library";
import { FamilySession } from "../src/family/session";
import { stateOf } from "../src/family/state";
import { TrainingSession } from "../src/family/training_session";
import { exampleCheck, SHIPPED, TYPES } from "./family_fixtures";

const SLANTED = exampleCheck("slanted").body.definition;
const SVG = "<svg xmlns='http://www.w3.org/2000/svg'><path d='M0 0 H100 L130 80 H30 Z'/></svg>";
const COST = { seconds: 0.1, stages: [], quantities: {} };

/** What the server has, and what was asked of it. */
let families: { id: string; definition: FamilyDefinition | null; created: string | null }[];
let models: { id: string; family: string }[];
let asked: { name: string; body: any }[];
/** The answers to some requests, in place of those of an ordinary server. */
let answers: Record<string, () => Response>;

const problem = (code: string, status: number) =>
  new Response(JSON.stringify({ type: "", title: "t", status, detail: "The reason.", code }), { status, headers: { "Content-Type": "application/problem+json" } });

async function serve(url: string, init: RequestInit = {}): Promise<Response> {
  const name = `${init.method ?? "GET"} ${String(url)}`;
  const body = typeof init.body === "string" ? JSON.parse(init.body) : null;
  asked.push({ name, body });
  if (answers[name]) return answers[name]();
  switch (name) {
    case "GET /v1/isohedral-types":
      return Response.json({ types: TYPES });
    case "GET /v1/families":
      return Response.json({ families });
    case "GET /v1/models":
      return Response.json({ models });
    case "POST /v1/family-checks":
      return Response.json({ good: true, faults: [], warnings: [], tiling: null, effects: [], cost: COST });
    case "POST /v1/families": {
      const definition = body.definition ?? { ...SLANTED, id: body.id };
      const family = { id: definition.id, definition, created: "2026-01-01T00:00:00Z" };
      families = [...families.filter(({ id }) => id !== family.id), family];
      return Response.json({ family, warnings: [] }, { status: 201 });
    }
    default:
      if (name.startsWith("DELETE /v1/families/")) {
        families = families.filter(({ id }) => name !== `DELETE /v1/families/${id}`);
        return new Response(null, { status: 204 });
      }
      return problem("http.not_found", 404);
  }
}

const count = (name: string): number => asked.filter((one) => one.name === name).length;

let session: FamilySession;

beforeEach(async () => {
  vi.useFakeTimers();
  vi.stubGlobal("fetch", serve);
  vi.stubGlobal("requestAnimationFrame", (draw: () => void) => setTimeout(draw, 0));
  [families, models, asked, answers] = [SHIPPED.map((definition) => ({ id: definition.id, definition, created: null })), [{ id: "ih21", family: "IH21" }], [], {}];
  session = new FamilySession(new Client());
  await session.start(null);
});
afterEach(() => {
  vi.useRealTimers();
  vi.unstubAllGlobals();
});

const rest = () => vi.advanceTimersByTimeAsync(1000);

describe("the family page", () => {
  it("begins with a type, which is drawn before the server has checked it", async () => {
    expect(session.state.get().definition).toMatchObject({ id: "my-ih21", isohedral_type: 21 });
    expect(session.drawn.get()?.tile.vertices).toHaveLength(5);
    expect(session.findings).toBeNull();
    await rest();
    expect(session.findings).toEqual([]);
    expect(count("POST /v1/family-checks")).toBe(1);
  });

  it("begins with the family of a link, and tells why it cannot begin", async () => {
    const other = new FamilySession(new Client());
    await other.start(stateOf(SLANTED));
    expect(other.drawn.get()?.definition).toBe(SLANTED);
    answers["GET /v1/isohedral-types"] = () => problem("http.not_found", 404);
    const refused = new FamilySession(new Client());
    await refused.start(null);
    expect([refused.isStarted, refused.fault.get()]).toEqual([false, "The reason."]);
  });

  it("checks a definition once its changes pause, and the newest alone", async () => {
    await rest();
    session.open(SLANTED);
    session.mode.set("tile");
    for (const x of [0.01, 0.02, 0.03]) session.dragBy({ kind: "vertex", vertex: 1 }, [x, 0]);
    session.finish();
    expect(count("POST /v1/family-checks")).toBe(1);
    await rest();
    expect(count("POST /v1/family-checks")).toBe(2);
    expect(asked.at(-1)?.body.definition.tile.vertices[1]).toEqual([1.03, 0]);
  });

  it("does not check a definition again whose parameters alone are shown in another way", async () => {
    await rest();
    session.preview({ shown: [0.11, 0.66] });
    session.finish();
    await rest();
    expect(count("POST /v1/family-checks")).toBe(1);
    expect(session.findings).toEqual([]);
  });

  it("makes one step of a drag, which begins anew with another handle, and undoes it", async () => {
    session.open(SLANTED);
    session.mode.set("tile");
    for (const x of [0.1, 0.2]) session.dragBy({ kind: "vertex", vertex: 1 }, [x, 0]);
    session.dragBy({ kind: "vertex", vertex: 3 }, [0, 0.1]);
    session.finish();
    session.undo();
    expect(session.state.get().definition.tile?.vertices[1]).toEqual([1.2, 0]);
    session.undo();
    expect(session.state.get().definition).toBe(SLANTED);
    expect(session.drawn.get()?.definition).toBe(SLANTED);
    session.redo();
    expect(session.state.get().definition.tile?.vertices[1]).toEqual([1.2, 0]);
  });

  it("offers a drag of the tile as a parameter until something else is changed", () => {
    session.open(SLANTED);
    session.mode.set("tile");
    session.dragBy({ kind: "vertex", vertex: 1 }, [0.1, 0]);
    session.finish();
    expect(session.lastDrag.get()).toMatchObject({ vertex: 1, before: { definition: SLANTED } });
    session.apply({ coreHours: 3 });
    expect(session.lastDrag.get()).toBeNull();
    session.mode.set("parameters");
    session.dragBy({ kind: "vertex", vertex: 2 }, [0.1, 0]);
    session.finish();
    expect(session.lastDrag.get()).toBeNull();
  });
});

describe("the server", () => {
  it("has a family under its name, and a network of this very definition alone", () => {
    session.open(families[1].definition as FamilyDefinition);
    expect([session.isStored, session.model?.id]).toEqual([true, "ih21"]);
    session.apply({ definition: { ...session.state.get().definition, beam_width: 0.07 } });
    expect([session.namesake?.id, session.isStored, session.model]).toEqual(["IH21", false, null]);
  });

  it("gets a family, replaces it, and loses it again", async () => {
    const library = new Library(session, new Client());
    session.open(SLANTED);
    await library.add();
    expect(session.isStored).toBe(true);
    expect(library.outcome.get()).toEqual({ sentence: "slanted is on the server.", isFault: false });
    session.apply({ definition: { ...session.state.get().definition, beam_width: 0.2 } });
    await library.add(true);
    expect(asked.filter(({ name }) => /families/.test(name) && !name.startsWith("GET")).map(({ name }) => name)).toEqual([
      "POST /v1/families",
      "DELETE /v1/families/slanted",
      "POST /v1/families",
    ]);
    await library.remove();
    expect([session.isStored, session.namesake]).toEqual([false, null]);
  });

  it("refuses one with a sentence", async () => {
    const library = new Library(session, new Client());
    answers["POST /v1/families"] = () => problem("family.faulty", 422);
    await library.add();
    expect(library.outcome.get()).toEqual({ sentence: "The reason.", isFault: true });
    expect(library.isBusy.get()).toBe(false);
  });

  it("makes a family of a drawing, whose type is asked for; other files are definitions or refused", async () => {
    const library = new Library(session, new Client());
    expect(library.open(SVG, "tile.svg")).toBe("");
    expect(library.drawing.get()?.name).toBe("tile.svg");
    await library.addDrawing({ type: 41, id: "drawn", shapeParameters: true });
    expect(asked.find(({ name }) => name === "POST /v1/families")?.body).toMatchObject({ type: "IH41", id: "drawn", shape_parameters: true, svg: SVG });
    expect([library.drawing.get(), session.state.get().definition.id, session.isStored]).toEqual([null, "drawn", true]);
    expect(library.open(JSON.stringify(SLANTED), "slanted.json")).toBe("");
    expect(session.state.get().definition).toEqual(SLANTED);
    expect(library.open("{}", "x.json")).toMatch(/^This is no definition of a family/);
  });
});

describe("an atlas", () => {
  const ATLAS = { family: "slanted", samples: [{ parameters: [0.2] }, { parameters: [0.4] }], profiles: [], comparison: { families: ["IH01"] } };

  it("is that of the definition, or of the stored family, with those of the others; a sample is drawn", async () => {
    answers["POST /v1/family-atlases"] = () => Response.json(ATLAS);
    answers["GET /v1/families/IH01/atlas"] = () => Response.json({ family: "IH01", samples: [] });
    const atlas = new AtlasSession(session, new Client());
    session.open(SLANTED);
    await atlas.make();
    expect(asked.find(({ name }) => name === "POST /v1/family-atlases")?.body).toEqual({ definition: SLANTED });
    expect(atlas.others.get().map(({ family }) => family)).toEqual(["IH01"]);
    atlas.choose(1);
    expect([session.state.get().shown, atlas.isCurrent]).toEqual([[0.4], true]);
    families.push({ id: "slanted", definition: SLANTED, created: "" });
    await session.loadFamilies();
    await atlas.make();
    expect(asked.filter(({ name }) => name === "POST /v1/family-atlases").at(-1)?.body).toEqual({ family: "slanted" });
    session.apply({ definition: { ...SLANTED, beam_width: 0.2 } });
    atlas.choose(0);
    expect([session.state.get().shown, atlas.isCurrent], "samples of another family are not drawn").toEqual([[0.4], false]);
  });
});

describe("a training", () => {
  const JOB = { id: "j", kind: "trainings", state: "running", progress: 0.4, stage: "committee", priority: "background", created: "", deadline: 1, remaining_seconds: null };

  it("shows the errors of its job, is cancelled, and goes on with the same request", async () => {
    const training = new TrainingSession(session, new Client());
    session.open(SLANTED);
    answers["POST /v1/trainings"] = () => Response.json(JOB, { status: 202 });
    answers["GET /v1/jobs/j"] = () => Response.json({ ...JOB, partial: { family: "slanted", errors: [{ designs: 60, error: 0.1 }] } });
    answers["DELETE /v1/jobs/j"] = () => Response.json({ ...JOB, state: "dismissed" });
    void training.train();
    await rest();
    expect(training.activity.get()).toMatchObject({ kind: "busy", words: "Training: small networks choose designs", progress: 0.4 });
    expect(training.run.get()?.errors).toEqual([{ designs: 60, error: 0.1 }]);
    training.cancel();
    await rest();
    expect(count("DELETE /v1/jobs/j")).toBe(1);
    expect(training.run.get()).toMatchObject({ isCancelled: true, answer: null });
    const answer = { model: "slanted-1", family: "slanted", error: 0.03, designs: 120, estimate: { simulation: 1, training: 1 }, effects: [], cost: COST };
    answers["POST /v1/trainings"] = () => Response.json(answer);
    models = [...models, { id: "slanted-1", family: "slanted" }];
    families.push({ id: "slanted", definition: SLANTED, created: "" });
    await training.train();
    expect(training.run.get()).toMatchObject({ errors: [{ designs: 60, error: 0.1 }, { designs: 120, error: 0.03 }], answer: { model: "slanted-1" }, isCancelled: false });
    expect((session.model as Model | null)?.id).toBe("slanted-1");
    const requests = asked.filter(({ name }) => name === "POST /v1/trainings").map(({ body }) => body);
    expect(requests[1]).toEqual(requests[0]);
    expect(requests[0]).toEqual({ family: "slanted", budget: { core_seconds: 14_400 }, priority: "background" });
  });

  it("has a plan as long as its budget is the same, and says where the server has no program for it", async () => {
    const training = new TrainingSession(session, new Client());
    session.open(SLANTED);
    answers["POST /v1/training-plans"] = () => Response.json({ family: "slanted", estimate: { simulation: 100, training: 50 }, effects: [], cost: COST });
    await training.estimate();
    expect(training.currentPlan?.estimate).toEqual({ simulation: 100, training: 50 });
    session.apply({ coreHours: 8 });
    expect(training.currentPlan).toBeNull();
    answers["POST /v1/training-plans"] = () => problem("training.unavailable", 503);
    await training.estimate();
    expect(training.planActivity.get()).toMatchObject({ kind: "failed" });
  });
});
