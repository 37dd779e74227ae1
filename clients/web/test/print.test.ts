import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import type { PrintMove, Weave } from "../src/contract/types";
import { duration, longWords, printFacts } from "../src/weave/print_facts";
import type { Plan } from "../src/weave/print_session";
import { DEFAULT_SETTINGS, fieldsAt, KNOWN_PRINTERS, printerOf, storedSettings, PRINT_FIELDS, profileText, toolpathRequest, withPrinter, withProfile } from "../src/weave/printer";
import { layersOf, widthOf } from "../src/weave/toolpath";

const contract = readFileSync(new URL("../../../api/openapi.yaml", import.meta.url), "utf8");
const weave = { pattern: "regular" } as Weave;

/** The default of a field of a schema, as the text in the contract. */
function contractDefault(schema: string, name: string): string | undefined {
  const from = contract.indexOf(`\n    ${schema}:\n`);
  const block = contract.slice(from, contract.indexOf("\n    PrintLength:", from));
  return new RegExp(`^ +${name}: \\{.*?default: ("[^"]*"|\\[[^\\]]*\\]|[^,}]+)`, "m").exec(block)?.[1];
}

describe("the settings of a print", () => {
  it("begin with the printer that the contract describes", () => {
    const fields = PRINT_FIELDS.flatMap((group) => group.fields).filter(({ pointer }) => pointer.startsWith("/printer/") && !pointer.startsWith("/printer/bed/"));
    expect(fields.length).toBeGreaterThan(25);
    for (const { pointer, initial } of fields) {
      const written = contractDefault("PrinterProfile", pointer.split("/").at(-1) ?? "");
      if (initial === null) expect(written, pointer).toBeUndefined();
      else expect(written?.replace(/^"|"$/g, ""), pointer).toBe(String(initial));
    }
    expect(contract).toMatch(/BuildVolume: \{.*default: \[250, 210, 210\]/);
    expect([0, 1, 2].map((axis) => DEFAULT_SETTINGS[`/printer/bed/${axis}`])).toEqual([250, 210, 210]);
  });

  it("are all of them in the request, without a frame where there is none", () => {
    const request = toolpathRequest(weave, { ...DEFAULT_SETTINGS, "/printer/lift/run": 3, "/overrun/end": 24 }, ["moves"]);
    expect(request).toMatchObject({ weave, include: ["moves"], overrun: { start: 0, end: 24 }, loop_overlap: 0 });
    expect(request.printer).toMatchObject({ bed: [250, 210, 210], nozzle_temperature: 180, lift: { run: 3, height: 1 }, park: true, priming_length: 60 });
    expect(request.printer).not.toHaveProperty("bead_area");
    expect(request).not.toHaveProperty("frame");
    expect(toolpathRequest(weave, { ...DEFAULT_SETTINGS, "/frame": true, "/frame/margin": 2 }, ["gcode"]).frame).toEqual({ margin: 2, lead_in: 0 });
  });

  it("go into a file and come back, and refuse what is no printer", () => {
    const changed = { ...DEFAULT_SETTINGS, "/printer/bed/1": 300, "/printer/name": "Mine", "/printer/channel/shape": "arc", "/overrun/start": 5 };
    expect(withProfile({ ...DEFAULT_SETTINGS, "/overrun/start": 5, "/printer/retraction": 9 }, profileText(changed))).toEqual(changed);
    expect(withProfile({ ...DEFAULT_SETTINGS, "/printer/retraction": 9 }, '{"nozzle_temperature": 210}')).toEqual({ ...DEFAULT_SETTINGS, "/printer/nozzle_temperature": 210 });
    const refused = {
      "{": "no JSON",
      "[]": "no printer",
      '{"colour": "red"}': "does not have the colour",
      '{"lift": {"run": "far"}}': "no number for the run of the lift",
      '{"channel": {"shape": "loop"}}': "no text for the shape of the channel",
      '{"lift": 3}': "does not have the lift",
    };
    for (const [text, words] of Object.entries(refused)) {
      expect(() => withProfile(DEFAULT_SETTINGS, text), text).toThrow(words);
    }
  });

  it("are those of a printer by name, which is recognized until one of its values changes", () => {
    expect(printerOf(DEFAULT_SETTINGS)?.name).toBe("Prusa i3 MK3S");
    for (const printer of KNOWN_PRINTERS) {
      const settings = withPrinter({ ...DEFAULT_SETTINGS, "/printer/bed_temperature": 70 }, printer);
      expect(printerOf(storedSettings(JSON.stringify(settings)))).toBe(printer);
      expect(settings["/printer/bed_temperature"]).toBe(70);
      expect(printerOf({ ...settings, "/printer/bed/0": 100 })).toBeUndefined();
    }
    const ultimaker = KNOWN_PRINTERS.find(({ name }) => name === "Ultimaker S3");
    expect(ultimaker).toEqual({ name: "Ultimaker S3", bed: [230, 190, 200], nozzle: 0.4, filament: 2.85 });
  });

  it("that a browser has kept are taken where they are sound", () => {
    expect(storedSettings(JSON.stringify({ "/printer/bed_temperature": 70, "/printer/nozzle_temperature": "hot", "/frame": true, "/unknown": 1 }))).toEqual({
      ...DEFAULT_SETTINGS,
      "/printer/bed_temperature": 70,
      "/frame": true,
    });
    for (const text of [null, "", "{", "3", "null", "[1]"]) expect(storedSettings(text)).toEqual(DEFAULT_SETTINGS);
  });

  it("are found at the place that a problem names", () => {
    expect(fieldsAt("/printer/bed").map((field) => field.pointer)).toEqual(["/printer/bed/0", "/printer/bed/1", "/printer/bed/2"]);
    expect(fieldsAt("/printer/lift/run").map((field) => field.words)).toEqual(["Begins to rise at"]);
    for (const pointer of ["", "/", "/weave/strands/3", "does not have the colour", "/frame"]) {
      expect(fieldsAt(pointer).map((field) => field.pointer), pointer).toEqual(pointer === "/frame" ? ["/frame/margin", "/frame/lead_in"] : []);
    }
  });
});

const move = (kind: PrintMove["kind"], strand: number | null, points: number[][], speed = 600): PrintMove => ({
  kind,
  strand,
  points,
  speed,
  area: kind === "travel" ? 0 : Math.PI / 16,
  crossing: null,
});

describe("layers of a toolpath", () => {
  const moves = [
    move("travel", null, [[0, 0, 1.5], [1, 0, 0.5]], 3000),
    move("support", null, [[0, 0, 0.5], [30, 0, 0.5]]),
    move("travel", null, [[0, 0, 1.5], [1, 0, 0.5]]),
    move("strand", 0, [[0, 0, 0.5], [0, 40, 0.5]]),
    move("travel", null, [[0, 0, 1.5], [1, 0, 0.5]]),
    move("strand", 1, [[0, 0, 0.5], [10, 0, 0.5]]),
    move("lifted", 1, [[10, 0, 0.5], [13, 0, 1.25]]),
    move("strand", 1, [[13, 0, 0.5], [20, 0, 0.5]]),
    move("travel", null, [[0, 0, 2], [1, 0, 0.5]]),
    move("channel", 0, [[0, 0, 0.5], [0, 1, 2.25], [0, 2, 0.5]]),
    move("travel", null, [[0, 2, 0.5], [0, 2, 50]]),
  ];

  it("are what lies on the bed, what rises over it, and what is bridged, with the travels that lead there", () => {
    const layers = layersOf(moves);
    expect(layers.map((layer) => [layer.stage, layer.moves.length, layer.travels])).toEqual([["bed", 4, 2], ["sliding", 4, 1], ["channels", 3, 2]]);
    expect(layers.flatMap((layer) => layer.moves)).toEqual(moves);
    expect(layers.map((layer) => [layer.lowest, layer.highest])).toEqual([[0.5, 0.5], [0.5, 1.25], [0.5, 2.25]]);
    expect(layers[0].length).toBe(70);
    expect(layers[0].minutes).toBeCloseTo(70 / 600 + Math.SQRT2 / 3000 + Math.SQRT2 / 600, 12);
    expect(layersOf([])).toEqual([]);
  });

  it("have beads as wide as their area is round", () => {
    expect(widthOf(moves[1])).toBeCloseTo(0.5, 12);
    expect(widthOf(moves[0])).toBe(0);
  });
});

describe("what a print takes", () => {
  it("is said in units that one can read", () => {
    expect([0.01, 0.5, 2.25, 59.7, 96, 125].map(duration)).toEqual(["1 s", "30 s", "2.3 min", "1 h 0 min", "1 h 36 min", "2 h 5 min"]);
    expect([74.2, 1480].map(longWords)).toEqual(["74.2 mm", "1.48 m"]);
    const statistics = {
      filament: 1000,
      minutes: 3,
      lowest: [100, 90, 0.5],
      highest: [130, 110, 2.25],
      extruded_length: 2000,
      travel_length: 500,
      travels: 7,
      channels: 1,
      heights: [0.5, 1.25],
    };
    const facts = new Map(printFacts({ settings: DEFAULT_SETTINGS, toolpath: { statistics } } as unknown as Plan));
    expect(facts.get("Filament")).toBe("1 m, 2.41 cm³");
    expect(facts.get("Size")).toBe("30 × 20 mm, up to 2.25 mm high");
    expect(facts.get("Printed")).toBe("2 m, 1 channel");
  });
});
