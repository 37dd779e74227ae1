// Drawings as the shape of a part, and dropped files: each is used by its type, and a refusal is shown where it was dropped.
import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { DesignPage, withDesign } from "./design_page.mjs";
import { picture, setUp, until } from "./harness.mjs";

setUp();

/** A plate of 60 mm by 40 mm with a round hole. */
const PLATE = `<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40"><rect id="plate" width="60" height="40"/><circle id="hole" cx="30" cy="20" r="8"/></svg>`;
const OPEN = `<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="40mm" viewBox="0 0 60 40"><polyline points="0,0 10,0 10,10" fill="none" stroke="black"/></svg>`;
/** A square plate of one inch, in pixels of 1/72 inch. */
const PIXELS = `<!-- Generator: Adobe Illustrator 15.0 --><svg xmlns="http://www.w3.org/2000/svg" width="72px" height="72px" viewBox="0 0 72 72"><rect id="plate" width="72" height="72"/></svg>`;
/** Three fields side by side, with no curve around them. */
const FIELDS = `<svg xmlns="http://www.w3.org/2000/svg" width="60mm" height="20mm" viewBox="0 0 60 20"><rect id="heel" width="20" height="20"/><rect id="arch" x="20" width="20" height="20"/><rect id="toes" x="40" y="3" width="18" height="14"/></svg>`;
/** A square of 20 mm in the DXF format of CAD programs. */
const SQUARE = [
  "0", "SECTION", "2", "HEADER", "9", "$INSUNITS", "70", "4", "0", "ENDSEC", "0", "SECTION", "2", "ENTITIES", "0", "LWPOLYLINE", "8", "square", "90", "4", "70", "1",
  ...[[0, 0], [20, 0], [20, 20], [0, 20]].flatMap(([x, y]) => ["10", x, "20", y]), "0", "ENDSEC", "0", "EOF", "",
].join("\n");

class DrawingPage extends DesignPage {
  get part() {
    return this.page.locator("details.part");
  }

  async saysOfThePart(words) {
    await until(async () => words.test(await this.part.textContent()), String(words));
  }

  /** The text of the refusal, and the class of the card above it. */
  async refusal() {
    const note = this.page.locator(".drop-problem");
    await note.waitFor();
    return [await note.textContent(), await note.evaluate((element) => element.previousElementSibling.className)];
  }
}

function withDrawings(act, options) {
  return withDesign(act, { Kind: DrawingPage, ...options });
}

describe("a drawing", () => {
  it("becomes the shape of the part wherever it is dropped, with its holes, and is scaled", () =>
    withDrawings(async (design, page) => {
      await design.drop(".preview", PLATE, "plate.svg");
      await design.saysOfThePart(/plate\.svg: 2 closed curves, 60 × 40 mm\./);
      assert.match(await page.evaluate(() => window.marked), /^card preview dropping$/, "the card under the file was marked");
      assert.equal(await page.locator(".dropping").count(), 0);
      await design.saysOfThePart(/Size60 × 40 × 1 mm/);
      assert.ok(await design.part.getByLabel("Width, mm", { exact: true }).isHidden(), "the drawing says how wide the part is");
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/parts") && request.postDataJSON().outline.polygons?.length === 1);
      await design.part.getByLabel("Outline of the part").selectOption("plate");
      assert.equal((await asked).postDataJSON().outline.polygons[0].length, 4, "the plate without its hole");
      await design.part.getByLabel("Width of the drawing, mm").fill("30");
      await design.part.getByLabel("Width of the drawing, mm").press("Tab");
      await design.saysOfThePart(/Size30 × 20 × 1 mm/);
      await picture(page, "design-drawing");
      await design.part.getByLabel("Coupon", { exact: true }).check();
      await design.saysOfThePart(/Size30 × 90 × 1 mm/);
    }));

  it("asks how large its pixels are if they were no 1/96 inch", () =>
    withDrawings(async (design) => {
      await design.drop("details.part summary", PIXELS, "old.svg");
      assert.match((await design.refusal())[0], /^old\.svg: .*Adobe Illustrator/);
      await design.part.locator("summary").click();
      await design.part.getByLabel("Drawing", { exact: true }).check();
      await design.part.getByLabel("Pixels per inch", { exact: true }).selectOption("72");
      await design.saysOfThePart(/old\.svg: 1 closed curve, 25\.4 × 25\.4 mm\./);
    }));

  it("is opened as a file too, in SVG and in DXF", () =>
    withDrawings(async (design, page) => {
      await design.part.locator("summary").click();
      await design.part.getByLabel("Drawing", { exact: true }).check();
      assert.ok(await design.part.locator(".part-drawing").isHidden(), "there is no drawing yet");
      const chosen = page.waitForEvent("filechooser");
      await design.part.getByText("Open a drawing").click();
      await (await chosen).setFiles({ name: "square.dxf", mimeType: "image/vnd.dxf", buffer: Buffer.from(SQUARE) });
      await design.saysOfThePart(/square\.dxf: 1 closed curve, 20 × 20 mm\./);
      await design.saysOfThePart(/Size20 × 20 × 1 mm/);
    }));

  it("has the regions of the product where a person wants them", () =>
    withDrawings(async (design, page) => {
      await page.getByTitle("Divide the product into regions").click();
      await page.locator(".regions-card li").nth(1).waitFor();
      await design.settled();
      await design.drop(".plot-card", PLATE, "plate.svg");
      const list = (name) => design.part.getByLabel(name, { exact: true });
      await list("Region 2").waitFor();
      assert.deepEqual([await list("Region 1").inputValue(), await list("Region 2").inputValue()], ["rest", "1"], "the second region lies within the hole");
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/parts") && request.postDataJSON().regions?.[0].name === "Region 1");
      await list("Region 1").selectOption("Within hole");
      assert.deepEqual((await asked).postDataJSON().outline.polygons.map((polygon) => polygon.length), [4]);
      assert.equal(await list("Region 2").inputValue(), "rest", "two regions do not lie at one place");
      await page.getByRole("button", { name: "Remove this region" }).click();
      await until(async () => !(await list("Region 1").isVisible()), "one region, which fills all");
    }));
});

describe("a drawing with named curves", () => {
  it("becomes regions by a click, which need no curve around them", () =>
    withDrawings(async (design, page) => {
      await design.drop(".preview", FIELDS, "fields.svg");
      await design.saysOfThePart(/fields\.svg: 3 closed curves/);
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/parts") && request.postDataJSON().regions?.length === 3);
      await design.part.getByRole("button", { name: "Make 3 regions" }).click();
      const { outline, regions } = (await asked).postDataJSON();
      assert.deepEqual(outline, { regions: true });
      assert.deepEqual(regions.map((region) => region.name), ["heel", "arch", "toes"]);
      const names = page.getByRole("tablist", { name: "Regions of the product" }).getByRole("tab").locator(".tab-name");
      assert.deepEqual(await names.allTextContents(), ["heel", "arch", "toes"]);
      // A frame holds what the tiles of small fields do not connect.
      await design.part.getByLabel("Frame, mm", { exact: true }).fill("1");
      await design.part.getByLabel("Frame, mm", { exact: true }).press("Tab");
      await design.saysOfThePart(/Size58 × 20 × 1 mm/);
      assert.equal(await design.part.locator(".sketch-regions path").count(), 3);
      assert.ok(await design.part.getByRole("button", { name: "Make 3 regions" }).isHidden(), "they are made");
      await picture(page, "design-drawing-regions");
    }));
});

describe("the shape of a part", () => {
  it("is drawn from the fields alone, with its ends, its outer size and the load", () =>
    withDrawings(async (design, page) => {
      let answer;
      const held = new Promise((resolve) => (answer = resolve));
      await page.route("**/v1/parts", async (route) => { await held; await route.continue(); });
      await design.part.locator("summary").click();
      const drawn = (name) => design.part.locator(`.part-drawing .${name}`).getAttribute("d");
      assert.match(await drawn("outline"), /^M-15 45L15 45/);
      assert.match(await drawn("load-arrow"), /^M0 9L0 -9/);
      assert.match(await design.part.locator(".part-size").textContent(), /with both grips: 30 × 90 × 1 mm/);
      await design.part.getByLabel("Block", { exact: true }).check();
      assert.match(await drawn("outline"), /^M-15 31L15 31/);
      assert.match(await design.part.locator(".part-size").textContent(), /with both plates: 30 × 62 × 1 mm/);
      assert.equal(await design.part.getByLabel("Each plate, mm").inputValue(), "1");
      assert.match(await page.locator(".tiling .load-arrow").getAttribute("d"), /^M-/, "the design is loaded along x");
      answer();
      await design.saysOfThePart(/Size30 × 62 × 1 mm/);
      await picture(page, "design-part-sketch");
    }));

  it("is turned towards the axis of a drawing that somebody gives", () =>
    withDrawings(async (design, page) => {
      await design.drop(".preview", PLATE, "plate.svg");
      await design.saysOfThePart(/Size60 × 40 × 1 mm/);
      assert.ok(await design.part.getByLabel("Loaded along, °").isHidden());
      assert.equal(await design.part.locator(".part-turn").textContent(), "");
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/parts") && request.postDataJSON().axis !== undefined);
      await design.part.getByLabel("Axis of the load, °").fill("60");
      await design.part.getByLabel("Axis of the load, °").press("Tab");
      const { axis, direction } = (await asked).postDataJSON();
      assert.ok(Math.abs(axis - Math.PI / 3) < 1e-9 && direction === 0, `${axis}, ${direction}`);
      assert.match(await design.part.locator(".part-turn").textContent(), /^Turned by 60 degrees/);
      await design.saysOfThePart(/Loadalong the design’s 0°/);
    }));
});

describe("a field that someone is writing in", () => {
  it("keeps what stands in it while answers come, and shows theirs if nothing was changed", () =>
    withDrawings(async (design, page) => {
      await design.drop(".preview", PLATE, "plate.svg");
      await design.saysOfThePart(/Size60 × 40 × 1 mm/);
      let answer;
      const held = new Promise((resolve) => (answer = resolve));
      await page.route("**/v1/outlines", async (route) => { await held; await route.continue(); }, { times: 1 });
      const width = design.part.getByLabel("Width of the drawing, mm");
      await width.fill("30");
      await width.press("Tab");
      // The answer to the width updates all fields of the part, except the one that is being edited.
      await design.part.getByLabel("Thickness, mm", { exact: true }).fill("8");
      answer();
      await design.saysOfThePart(/30 × 20 mm\./);
      const thickness = design.part.getByLabel("Thickness, mm", { exact: true });
      assert.equal(await thickness.inputValue(), "8");
      await thickness.press("Tab");
      await design.saysOfThePart(/Size30 × 20 × 8 mm/);
      // After an edit that was undone, the page updates the field again.
      await thickness.fill("9");
      await thickness.fill("8");
      await thickness.press("Tab");
      assert.equal(await thickness.inputValue(), "8");
      await thickness.fill("-1");
      await thickness.press("Tab");
      assert.equal(await thickness.inputValue(), "8", "a thickness that cannot be is not kept");
    }));

  it("keeps the walls of a region that are being written while the regions' places change", () =>
    withDrawings(async (design, page) => {
      await page.getByTitle("Divide the product into regions").click();
      await page.locator(".regions-card li").nth(1).waitFor();
      await design.settled();
      await design.drop(".plot-card", PLATE, "plate.svg");
      const walls = design.part.getByLabel("Wall thickness of Region 2, mm", { exact: true });
      await walls.waitFor();
      let answer;
      const held = new Promise((resolve) => (answer = resolve));
      await page.route("**/v1/outlines", async (route) => { await held; await route.continue(); }, { times: 1 });
      const width = design.part.getByLabel("Width of the drawing, mm");
      await width.fill("30");
      await width.press("Tab");
      await walls.fill("0.6");
      answer();
      await design.saysOfThePart(/30 × 20 mm\./);
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/parts") && request.postDataJSON().regions?.[0].beam_width === 0.6);
      await walls.press("Tab");
      await asked;
      assert.equal(await walls.inputValue(), "0.6");
    }));
});

describe("a file that is refused", () => {
  it("is told of beside the place where it was dropped, until another one is taken", () =>
    withDrawings(async (design, page) => {
      await design.drop(".plot-card .stage", "no numbers here", "notes.txt");
      const [words, card] = await design.refusal();
      assert.match(words, /^notes\.txt: .*two numbers/);
      assert.match(card, /plot-card/);
      await design.drop("details.part summary", OPEN, "open.svg");
      await until(async () => /^open\.svg: /.test((await design.refusal())[0]), "the other refusal");
      const [sentence, part] = await design.refusal();
      assert.match(sentence, /closed/);
      assert.match(part, /\bpart\b/);
      await picture(page, "design-refused");
      await design.drop("details.part summary", PLATE, "plate.svg");
      await design.saysOfThePart(/plate\.svg: 2 closed curves/);
      assert.ok(await page.locator(".drop-problem").isHidden());
    }));
});
