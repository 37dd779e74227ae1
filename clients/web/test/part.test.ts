import { describe, expect, it } from "vitest";
import type { Client } from "../src/contract/client";
import { INITIAL_PART, fileName, Part, partRequest } from "../src/design/part";

const FOUND = { family: "IH21", parameters: [0.1, 0.6] };

describe("a part", () => {
  it("is asked for in each of its shapes", () => {
    expect(partRequest(FOUND, INITIAL_PART)).toEqual({
      outline: { coupon: { width: 30, length: 60, grip_length: 15 } },
      structure: { family: "IH21", parameters: [0.1, 0.6] },
      beam_width: 0.3,
      thickness: 1,
      frame: 0,
      rim: "clipped",
      material: { density: 1.2 },
    });
    expect(partRequest(FOUND, { ...INITIAL_PART, kind: "block", plate: 2, whole: true })).toMatchObject({ outline: { block: { width: 30, height: 60, plate: 2 } }, rim: "whole" });
    expect(partRequest(FOUND, { ...INITIAL_PART, kind: "rectangle" }).outline).toEqual({ rectangle: [30, 60] });
  });

  it("has the name that the server gives its file", () => {
    expect(fileName('attachment; filename="supple-IH21-20x90x4mm.stl"', "stl")).toBe("supple-IH21-20x90x4mm.stl");
    expect(fileName(null, "3mf")).toBe("part.3mf");
  });

  it("reads its drawing in a width and a resolution that were chosen one right after the other", async () => {
    const requests: any[] = [];
    const client = {
      post: async (_path: string, body: unknown) => {
        requests.push(body);
        return { format: "svg", unit_is_known: false, shapes: [] };
      },
    } as unknown as Client;
    const part = new Part(client);
    await part.open("<svg/>", "sole.svg");
    part.scale(80);
    part.setResolution(72);
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(requests.at(-1)).toEqual({ text: "<svg/>", width: 80, resolution: 72 });
    part.setResolution(90);
    part.scale(90);
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(requests.at(-1)).toEqual({ text: "<svg/>", width: 90, resolution: 90 });
  });

  it("is described with a picture, and says why it cannot be made", async () => {
    const requests: any[] = [];
    let answer: unknown = { size: [20, 90, 4] };
    const client = {
      post: async (path: string, body: unknown) => {
        requests.push([path, body]);
        if (answer instanceof Error) throw answer;
        return answer;
      },
    } as unknown as Client;
    const part = new Part(client);
    part.describe(FOUND);
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(requests[0][0]).toBe("/v1/parts");
    expect(requests[0][1].svg).toBe(true);
    expect(part.state.get()).toEqual({ kind: "made", answer });
    answer = new Error("too narrow");
    part.describe(FOUND);
    await new Promise((resolve) => setTimeout(resolve, 0));
    expect(part.state.get()).toEqual({ kind: "failed", sentence: "too narrow", curves: [] });
  });
});
