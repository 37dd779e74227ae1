// Complete workflows from data to a file to print: from a measured curve to a coupon, and from the outline of a product to a solid whose
// regions have their own designs.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { describe, it } from "node:test";
import { DesignPage, withDesign } from "./design_page.mjs";
import { picture, server, setUp, until } from "./harness.mjs";
import { watertight } from "./stl.mjs";

const SIMULATION_MS = 150_000;
/** Rounding error of the single-precision coordinates in an STL file, in mm. */
const ROUNDING_MM = 1e-3;

setUp();

const SOLE = await readFile(new URL("../../api/examples/parts/sole.svg", import.meta.url), "utf8");

class WholeWayPage extends DesignPage {
  get part() {
    return this.page.locator("details.part");
  }

  /** Enters a value into a field of the part. */
  async write(label, value) {
    const field = this.part.getByLabel(label, { exact: true });
    await field.fill(String(value));
    await field.press("Tab");
  }

  /** The part as STL: its file name, size and volume. */
  async solid() {
    const saved = this.page.waitForEvent("download");
    await this.part.getByRole("button", { name: "STL" }).click();
    const file = await saved;
    return { name: file.suggestedFilename(), ...watertight(await readFile(await file.path())) };
  }
}

function near(measured, wanted, what) {
  wanted.forEach((value, axis) => assert.ok(Math.abs(measured[axis] - value) < ROUNDING_MM, `${what}: ${measured} instead of ${wanted} mm`));
}

async function ask(path, body) {
  const answer = await fetch(server.url + path, { method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) });
  assert.equal(answer.status, 200, await answer.clone().text());
  return answer.json();
}

/** A table in the format of a tensile tester, for a structure of a material with a modulus: 500 rows of engineering strain and stress, with semicolons and decimal commas. */
async function measuredTable(modulus) {
  const { x, y } = await ask("/v1/profiles", {
    task: "stress_strain", family: "IH29", parameters: [0.25], strain_measure: "engineering", range: [0, 0.04], samples: 500, material: { youngs_modulus: modulus },
  });
  const words = (value) => value.toFixed(6).replace(".", ",");
  return ["Specimen 17", "Strain [%];Stress [kPa]", ...x.map((strain, k) => `${words(100 * strain)};${words(1000 * y[k])}`)].join("\r\n");
}

describe("the whole way", () => {
  it("goes from a measured curve of 500 rows and a material of one's own to a verified design and a coupon to print", () =>
    withDesign(async (design, page) => {
      const modulus = 64;
      await page.locator("details.made summary").click();
      await page.getByLabel("Young’s modulus, MPa", { exact: true }).fill(String(modulus));
      await page.keyboard.press("Tab");
      await design.settled();
      await page.getByLabel("Density of the material, g/cm³", { exact: true }).fill("1.1");
      await page.keyboard.press("Tab");
      await design.settled();

      await design.drop(".plot-card .stage", await measuredTable(modulus), "specimen.csv");
      await until(async () => /follow 500 measured ones within/.test(await page.locator("details.measured").textContent()), "the reduced curve");
      await design.settled();
      const asked = page.designs.asked.at(-1);
      assert.deepEqual([asked.material, asked.strain_measure], [{ youngs_modulus: modulus, density: 1.1 }, "engineering"]);
      assert.ok((await design.deviation()) < 2, `a structure of this material was measured, and the design is ${await design.deviation()} % away`);
      assert.match(await page.locator(".result .facts").textContent(), /Young’s modulus64 MPa/);

      await design.button("Verify by simulation").click();
      await page.locator(".verdict").waitFor({ timeout: SIMULATION_MS });
      const [, apart] = /differ by ([\d.]+) %/.exec(await page.locator(".verdict").textContent());
      assert.ok(Number(apart) < 15, `simulation and model differ by ${apart} %`);
      await picture(page, "whole-way-verified");

      await design.part.locator("summary").click();
      await design.write("Width, mm", 40);
      await design.write("Length between grips, mm", 50);
      await design.write("Each grip, mm", 12);
      await design.write("Thickness, mm", 3);
      await design.write("Wall thickness, mm", 0.6);
      await until(async () => /40 × 74 × 3 mm/.test(await design.part.locator(".facts").textContent()), "the size of the coupon");
      assert.equal(await design.part.locator(".part-result .note").textContent(), "", "nothing of it is missing");
      await picture(page, "whole-way-coupon");
      const { name, size, volume } = await design.solid();
      assert.match(name, /^supple-IH\d+-40x74x3mm\.stl$/);
      near(size, [40, 74, 3], "the coupon");
      const grips = 2 * 40 * 12 * 3;
      assert.ok(volume > grips && volume < 40 * 74 * 3, `${volume} mm^3 are the grips' ${grips} and beams between them`);
    }, { Kind: WholeWayPage }));

  it("goes from the outline of a sole to a solid of three regions, each with a design of its own", () =>
    withDesign(async (design, page) => {
      const tabs = page.getByRole("tablist", { name: "Regions of the product" }).getByRole("tab");
      const last = (await design.handles.count()) - 1;
      const rename = async (name) => {
        await page.getByRole("button", { name: "Rename this region" }).click();
        await page.getByLabel("Name of this region").fill(name);
        await page.keyboard.press("Enter");
      };
      // Each further region is softer than the one before, so that the sole is stiffest at the heel.
      await page.getByTitle("Divide the product into regions").click();
      await until(async () => (await tabs.count()) === 2, "two regions");
      await rename("Midfoot");
      await design.drag(last, 0, 60);
      await design.settled();
      await page.getByTitle("Add a further region").click();
      await until(async () => (await tabs.count()) === 3, "three regions");
      await rename("Forefoot");
      await design.drag(last, 0, 60);
      await design.settled();
      await tabs.first().click();
      await rename("Heel");
      await design.settled();

      await design.drop(".plot-card .stage", SOLE, "sole.svg");
      await until(async () => /sole\.svg: 3 closed curves, 100 × 270 mm/.test(await design.part.textContent()), "the drawing's curves");
      assert.equal(await page.locator("details.part").getAttribute("open"), "", "the part is in sight");
      const where = (region) => design.part.getByLabel(region, { exact: true }).evaluate((list) => list.selectedOptions[0].textContent);
      assert.deepEqual([await where("Heel"), await where("Midfoot"), await where("Forefoot")], ["Within heel", "The rest of the part", "Within forefoot"]);
      // The drawing is scaled to about half of its size, and the heel gets walls of 0.5 mm.
      await design.write("Width of the drawing, mm", 50);
      await design.write("Frame, mm", 1.2);
      await design.write("Wall thickness of Heel, mm", 0.5);
      const asked = page.waitForRequest((request) => request.url().endsWith("/v1/parts") && request.postDataJSON().thickness === 8);
      await design.write("Thickness, mm", 8);
      const request = (await asked).postDataJSON();
      await until(async () => /41\.6 × 129 × 8 mm/.test(await design.part.locator(".facts").textContent()), "the size of the sole");
      await design.part.locator(".part-drawing").scrollIntoViewIfNeeded();
      await picture(page, "whole-way-sole");
      assert.equal(request.outline.polygons.length, 1);
      assert.deepEqual(request.regions.map((region) => [region.name, region.beam_width, region.outline.length]), [["Heel", 0.5, 4], ["Forefoot", 0.3, 4]]);
      const parameters = [request.structure, ...request.regions.map((region) => region.structure)].map((one) => `${one.family} ${one.parameters}`);
      assert.equal(new Set(parameters).size, 3, `three designs: ${parameters.join("; ")}`);

      const { name, size, volume } = await design.solid();
      assert.match(name, /^supple-.*-41.61x128.98x8mm\.stl$/);
      // The sole in the drawing is 83.22 mm by 257.96 mm.
      near(size, [83.22 / 2, 257.96 / 2, 8], "the sole");
      assert.ok(volume > 0.05 * 83.22 * 257.96 * 2 && volume < 83.22 * 257.96 * 2, `${volume} mm^3`);
    }, { Kind: WholeWayPage }));
});
