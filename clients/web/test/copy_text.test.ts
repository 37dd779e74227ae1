import { describe, expect, it } from "vitest";
import { curlText } from "../src/base/curl";
import { commandOf, curlOf, pythonOf } from "../src/design/copy_text";
import { DEFAULT_STATE } from "../src/design/state";

const origin = "http://127.0.0.1:8080";
const state = { ...DEFAULT_STATE, points: [[-0.1, -0.5], [0, 0], [0.2, 1]] as const, family: "IH22", found: { family: "IH22", parameters: [0.3, 0.4] }, fixed: [true, false] };

describe("a search as text", () => {
  it("is a request by curl whose quotes the shell keeps", () => {
    expect(curlText(origin, "/v1/x", { a: "it's" })).toContain(`-d '{"a":"it'\\''s"}'`);
    const body = /-d '(.*)'\n$/.exec(curlOf(state, origin))?.[1] ?? "";
    expect(JSON.parse(body)).toMatchObject({ family: "IH22", fixed: [0.3, null], target: { control_points: [[-0.1, -0.5], [0, 0], [0.2, 1]] } });
    expect(body).not.toContain("session");
  });

  it("is a command whose values may begin with a minus", () => {
    const text = commandOf(state, origin);
    expect(text).toContain(`--target="-0.1,-0.5;0,0;0.2,1"`);
    expect(text).toContain(`--fixed="0.3,free"`);
    expect(text).not.toContain("--strain=");
  });

  it("is a program in Python", () => {
    const text = pythonOf({ ...state, task: "poisson", family: "any", fixed: [], points: [[0, 0.1], [1, 0.2], [2, 0.3]] }, origin);
    expect(text).toContain(`supple.Target("poisson", [[0, 0.1], [1, 0.2], [2, 0.3]], strain=0.05`);
    expect(text).toContain("design = client.design(target, options=options)");
    expect(pythonOf(state, origin)).toContain("fixed=[0.3, None]");
  });

  it("asks for the accuracy that was chosen", () => {
    const sure = { ...state, accuracy: { level: "sure", switches: { trust: "off" } } } as const;
    expect(JSON.parse(/-d '(.*)'\n$/.exec(curlOf(sure, origin))?.[1] ?? "")).toMatchObject({ effects: { polish: "on", trust: "off" } });
    expect(commandOf(sure, origin)).toContain(`--polish="on"`);
    expect(pythonOf(sure, origin)).toMatch(/DesignOptions\(.*polish="on", trust="off"\)/);
    expect(commandOf({ ...state, accuracy: { level: "draft", switches: {} } }, origin)).toMatch(/--ways-out="off"[\s\S]*--tolerance="0.0001"[\s\S]*--starts="1"/);
    expect(commandOf(state, origin)).not.toMatch(/--(polish|trust|starts|tolerance)/);
  });

  it("begins with what a simulation has said of the design, as a comment", () => {
    const said = "Simulated: 45 % off. The plateau is reached from 8 to 20 %, the rise is missed from 0 to 8 % (62 % off).";
    for (const write of [curlOf, commandOf, pythonOf]) {
      expect(write(state, origin, said)).toBe(`# ${said}\n${write(state, origin)}`);
      expect(write(state, origin)).not.toContain("#");
    }
    const several = { ...state, others: [{ ...state, direction: 1 }] };
    expect(commandOf(several, origin, said)).toBe(`# ${said}\n${commandOf(several, origin)}`);
  });
});
